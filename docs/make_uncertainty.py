#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/uncertainty.md: how often the truth lies inside the predicted 95 % band, by noisy trials."""
import argparse
import math
import pathlib
import subprocess
import sys

STATED, LOW, HIGH = 0.95, 0.93, 0.97
LEVEL_SETS = ("limit-angle", "reflectance")  # exact models: compared with the true contour and bound to LOW .. HIGH


def number(value):
    return f"{value:.3g}"


def trials(program, count, models, earlier):
    """Rows of the program's table: run now, or printed before into one of the files `earlier`."""
    printed = "".join(pathlib.Path(f).read_text() for f in earlier)
    missing = [m for m in models if not any(line.split("\t")[0] == m for line in printed.splitlines())]
    if missing:
        done = subprocess.run([program, str(count), *missing], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{program}: {done.stderr.strip()}")
        printed += done.stdout
    rows = []
    for line in printed.splitlines():
        model, scene, *values = line.split("\t")
        if model not in models:
            continue
        noise, count, failed, share, spread, sigma, error, estimated = map(float, values)
        rows.append(dict(model=model, scene=scene, noise=noise, trials=int(count), failed=int(failed), share=share, spread=spread,
                         sigma=sigma, error=error, estimated=estimated))
    return rows


def table(rows, judged):
    out = "| model | scene | noise, px | trials | failed | inside | standard error | mean sigma, px | RMS error, px | estimated noise, px |"
    out += (" 93 to 97 % |" if judged else "") + "\n" + "| --- " * (11 if judged else 10) + "|\n"
    for r in rows:
        error = r["spread"] / math.sqrt(max(1, r["trials"] - r["failed"]))
        cells = [r["model"], r["scene"], f"{r['noise']:g}", r["trials"], r["failed"], f"{100 * r['share']:.1f} %",
                 f"{100 * error:.1f} %",
                 number(r["sigma"]), number(r["error"]), number(r["estimated"])]
        if judged:
            cells.append("met" if LOW <= r["share"] <= HIGH else "**missed**")
        out += "| " + " | ".join(map(str, cells)) + " |\n"
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/bin/coverage_trials")
    parser.add_argument("--trials", type=int, default=1000, help="for level-set models")
    parser.add_argument("--ellipsoid-trials", type=int, default=100, help="for ellipsoid models, whose bands take longer")
    parser.add_argument("--models", default="limit-angle,reflectance")
    parser.add_argument("--output", default="docs/uncertainty.md", help="file to write; - prints it")
    parser.add_argument("--earlier", nargs="*", default=[],
                        help="files with earlier output of the program: their models are not tried again")
    a = parser.parse_args()
    models = a.models.split(",")
    exact = trials(a.program, a.trials, [m for m in models if m in LEVEL_SETS], a.earlier)
    fits = trials(a.program, a.ellipsoid_trials, [m for m in models if m not in LEVEL_SETS], a.earlier)
    met = sum(LOW <= r["share"] <= HIGH for r in exact)
    text = f"""# Uncertainty

How often the truth lies inside the predicted 95 % band. A program writes this page; do not edit it. From the root of the project, after
`cmake --build --preset release --target coverage_trials`:

    python3 docs/make_uncertainty.py

## What is checked
Every fit carries the covariance of its parameters ([method.md](method.md), section 8a). This page checks only that covariance: the effect of noise in single points. A 95 %
band is the standard deviation across the contour times Student's factor for the degrees of freedom of the fit. The band that `glint predict` writes (`sigma_px`) starts from it and adds the errors of
whole frames, the surface and the lobe; [audit.md](audit.md), section 1.4, checks that band.
A trial adds Gaussian noise per coordinate to 72 points of each training contour and to its peak (like `--noise-px`), estimates everything from them, and predicts a frame that was not
used. 36 directions of its contour are compared with the truth; a pair (trial, direction) counts as inside if the distance is within the band.
Directions of one trial move together, so the standard error of a share is that of the mean over trials.
`mean sigma` and `RMS error` are over all pairs; `estimated noise` is the contours' noise according to the residuals.

## Level sets
The contours are exact level sets of the limit angle, or of the radiance of the fitted lobe (`reflectance`), so the model is right and the share should be 95 %. {met} of {len(exact)} lie between 93 and 97 %.

{table(exact, True)}
## Ellipsoids
The bands of the ellipsoid models (`--models limit-angle,canonical` adds their table here) have no promised coverage. An ellipsoid is not exact on a curved surface, so here the truth is the same model's prediction from noise-free contours: the band covers noise only, not
the model's own error, which is usually larger ([accuracy.md](accuracy.md)). Light and ellipsoid are treated as independent although the same noise enters both, and where the ellipsoid does not
fit, its residuals are not noise.

{table(fits, False) if fits else ""}
## What the covariance misses
- Errors of the model: an off-specular shift, an extended light, an inaccurate surface or pose. Residuals correlated along a contour show some of it
  and widen the covariance; the band of `glint predict` holds more of it. A bias that every training frame shares stays invisible to both.
- Second order: noise displaces a curved contour outwards on average by sigma^2 / (2 radius). The bundle corrects this, but a poorly determined
  light moves the contour along a curve.
- Solvers without a Jacobian at the end (`linear`, `anchored`, `triangulated`) have no band.
"""
    if a.output == "-":
        print(text)
    else:
        pathlib.Path(a.output).write_text(text)


if __name__ == "__main__":
    main()
