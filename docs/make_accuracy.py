#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/accuracy.md: what `glint evaluate` measures on the sequences with known truth.

Every number of that page comes from a run of the program here, or is quoted from SHARED/method.md (the prototype's and the
paper's figures). Only the bounds below are written down in this file.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

MODELS = ["primal", "dual", "canonical", "limit-angle", "reflectance"]

# Which runs. SCENES of a sequence: (name in the tables, file).
MESH_AND_ANALYTIC = [("mesh", "scene.json"), ("analytic", "scene-analytic.json")]
CYCLES = [
    ("plane_to_cylinder", MESH_AND_ANALYTIC, ["per-surface", "0-5"]),
    ("sphere", MESH_AND_ANALYTIC, ["first:6", "spread:6"]),
    ("vase", MESH_AND_ANALYTIC[:1], ["first:6", "spread:6"]),
]
SOURCES = ["radiance", "radiance, truth", "image", "image, truth"]
SYNTHETIC = [
    ("plane_to_cylinder_300", ["per-surface", "0-5"]),
    ("ellipsoid_80", ["first:6", "spread:6"]),
]
TRAIN_TEXT = {
    "per-surface": "own models for each surface, from all of its frames; all frames count",
    "0-5": "frames 0 to 5 (the plane) train; all others count",
    "first:6": "the first 6 frames train; all others count",
    "spread:6": "6 frames spread over the sequence train; all others count",
}

# Bounds: (sequence, training, model, most mean contour error in percent). They count only where every frame is predicted, mean
# coverage is at least 0.99 and no observed highlight stays unmatched.
CYCLES_BOUNDS = [
    ("plane_to_cylinder", "per-surface", "canonical", 0.4),
    ("plane_to_cylinder", "per-surface", "limit-angle", 0.3),
    ("plane_to_cylinder", "0-5", "canonical", 0.5),
    ("plane_to_cylinder", "0-5", "limit-angle", 0.4),
    ("sphere", "first:6", "limit-angle", 0.8),
    ("sphere", "spread:6", "limit-angle", 0.3),
    ("plane_to_cylinder", "0-5", "reflectance", {"mesh": 0.12, "analytic": 0.03, "image": 0.25}),
    ("sphere", "first:6", "reflectance", {"mesh": 0.12, "analytic": 0.06, "image": 0.25}),
    ("sphere", "spread:6", "reflectance", {"mesh": 0.12, "analytic": 0.06, "image": 0.25}),
]
VASE_LEAST_IOU = 0.97  # reflectance, radiance
DUAL_OVER_CANONICAL = ("plane_to_cylinder", "0-5", 20.0)
SYNTHETIC_BOUNDS = [
    ("plane_to_cylinder_300", "per-surface", "canonical", 1.0),
    ("plane_to_cylinder_300", "0-5", "canonical", 0.6),
    ("plane_to_cylinder_300", "per-surface", "limit-angle", 0.01),
    ("plane_to_cylinder_300", "0-5", "limit-angle", 0.01),
    ("ellipsoid_80", "first:6", "limit-angle", 0.01),
    ("ellipsoid_80", "spread:6", "limit-angle", 0.01),
]
LEAST_COVERAGE = 0.99


def number(value, digits=3):
    """Significant digits without an exponent where that stays short; a dash for nothing."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if abs(value) < 1e-4 or abs(value) >= 1e5:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


class Run:
    """One call of `glint evaluate`."""

    def __init__(self, scene, train, source, truth):
        self.scene, self.train, self.source, self.truth = scene, train, source, truth
        self.result, self.error = None, ""

    def arguments(self):
        a = ["evaluate", str(self.scene), "--models", ",".join(MODELS), "--train", self.train]
        if self.source:
            a += ["--source", self.source]
        if self.truth:
            a += ["--truth", str(self.truth)]
        return a

    def run(self, glint):
        done = subprocess.run([glint] + self.arguments() + ["--json", "-"], capture_output=True, text=True)
        if done.returncode in (0, 3) and done.stdout.strip().startswith("{"):
            self.result = json.loads(done.stdout)
        else:
            self.error = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        return self

    def model(self, name):
        return self.result["models"].get(name) if self.result else None

    def summary(self, name):
        model = self.model(name)
        return model["summary"] if model else None

    def error_pct(self, name):
        summary = self.summary(name)
        return summary["contour_error_pct"]["mean"] if summary else None

    def uncounted(self, name):
        """Why a bound does not count for this run; empty when it does."""
        if not self.result:
            return self.error
        s, model = self.summary(name), self.model(name)
        if model["status"] != "ok":
            return model["reason"]
        why = []
        if s["predicted"] < s["frames"]:
            why.append(f"{s['predicted']} of {s['frames']} frames predicted")
        if s["coverage"]["mean"] is None or s["coverage"]["mean"] < LEAST_COVERAGE:
            why.append(f"coverage {number(s['coverage']['mean'])}")
        if s["missed"]:
            why.append(f"{s['missed']} unmatched")
        return ", ".join(why)

    def unanswered(self, frames):
        """Frames that have neither a number nor a named reason in some model."""
        bad = []
        for name in MODELS:
            rows = {}
            for f in self.model(name)["frames"]:
                rows.setdefault(f["index"], []).append(f)
            for i in set(range(frames)) - held_in(self):
                ok = i in rows and all(
                    f["status"] == "spurious" or f.get("contour_error_pct") is not None or f["reason"] for f in rows[i])
                if not ok:
                    bad.append(f"{name} {i}")
        return bad


def model_rows(label, run):
    rows = []
    for name in MODELS:
        if not run.result:
            rows.append(label + [name] + ["–"] * 11 + [run.error])
            continue
        model, s = run.model(name), run.summary(name)
        e = s["contour_error_pct"]
        reasons = {}
        for f in model["frames"]:
            if f["reason"] and f["status"] != "spurious" and f["index"] not in held_in(run):
                reason = f["reason"].split("; ")[0]  # what follows is of this highlight alone
                reasons[reason] = reasons.get(reason, 0) + 1
        poor = "poor: " if model["status"] == "poor" else ""
        remark = poor + model["reason"] if model["status"] != "ok" else "; ".join(f"{n} × {r}" for r, n in sorted(reasons.items()))
        rows.append(label + [
            name, number(e["mean"]), number(e["median"]), number(e["p95"]), number(e["max"]),
            number(s["contour_error_px"]["mean"]), number(s["ellipse_error_pct"]["mean"]), number(s["iou"]["mean"], 4),
            number(s["peak_offset_px"]["mean"], 2), f"{s['predicted']}/{s['frames']}", number(s["coverage"]["mean"], 4),
            f"{s['matched']}/{s['missed']}/{s['spurious']}", remark,
        ])
    return rows


def held_in(run):
    """Frames that train and therefore do not count."""
    return set() if run.train == "per-surface" else set(run.result["train"])


MODEL_HEADER = ["model", "mean %", "median %", "p95 %", "max %", "mean px", "ellipse %", "IoU", "peak px", "predicted",
                "coverage",
                "matched/missed/spurious", "reasons"]


def fit_rows(label, run, lamp):
    """What was estimated: the light against the true one, the limit angle, and the ellipsoids."""
    rows = []
    if not run.result:
        return rows
    for name in MODELS[1:]:
        fits = [f for f in run.model(name)["fits"] if f["status"] == "ok"]
        failed = [f["reason"] for f in run.model(name)["fits"] if f["status"] != "ok"]
        distances, angles, residuals, gaps, axes = [], [], [], [], []
        for f in fits:
            p = f.get("light_position")
            centre = (f.get("ellipsoid") or {}).get("centre")
            where = p[:3] if p and p[3] else centre
            if where and lamp:
                distances.append(1e3 * math.dist(where, lamp))
            if f.get("limit_angle_deg") is not None:
                angles.append(f["limit_angle_deg"])
            residuals += [r for r in f["residual_px"] if r is not None]
            if f.get("ellipsoid"):
                gaps.append(1e3 * math.dist(centre, lamp) if lamp else None)
                axes.append(f["ellipsoid"]["semi_axes"])
        spread = lambda v, d=3: "–" if not v else number(v[0],
                                                         d) if len(v) == 1 else f"{number(min(v), d)} to {number(max(v), d)}"
        rows.append(label + [
            name, ", ".join(sorted({f["solver"] for f in fits})) or "–",
            str(len(fits)) + (f" of {len(fits) + len(failed)}" if failed else ""),
            spread(distances), spread(angles, 4), spread(gaps),
            " × ".join(number(1e3 * a) for a in axes[0]) if axes else "–",
            spread(residuals), "; ".join(sorted(set(failed))),
        ])
    return rows


FIT_HEADER = ["model", "solver", "fits", "light off by, mm", "limit angle, degrees", "centre of the ellipsoid off by, mm",
              "semi-axes (first fit), mm", "residual per view, px", "failed fits"]


def bound_of(bound, kind, source):
    """A bound may differ between meshes, analytic surfaces and photographs."""
    if not isinstance(bound, dict):
        return bound
    return bound["image"] if source.startswith("image") else bound[kind]


def bound_text(bound):
    return "≤ " + (", ".join(f"{v} {k}" for k, v in bound.items()) if isinstance(bound, dict) else str(bound))


def judged(run, model, bound):
    value, uncounted = run.error_pct(model), run.uncounted(model)
    if uncounted:
        return f"{number(value)} – does not count: {uncounted}"
    return f"{number(value)} – {'met' if value <= bound else '**missed**'}"


def quoted(method, first_words):
    """Lines of method.md section 9 that start so, and what follows of their table or paragraph."""
    lines = method.splitlines()
    for i, line in enumerate(lines):
        if line.startswith(first_words):
            block = []
            for following in lines[i:]:
                if not following.strip() or (block and line.startswith("|") != following.startswith("|")):
                    break
                block.append(following)
                if not line.startswith("|"):
                    break
            return "\n".join(block) + "\n"
    sys.exit(f"make_accuracy.py: method.md has no line that starts with '{first_words}'")


def as_tables(block):
    """Bullet-free quoting: table lines stay, a header row without names gets its separator right after it."""
    return re.sub(r"\n\|(-+\|)+", lambda m: "\n|" + " --- |" * (m.group(0).count("|") - 1), block)


def lamp_of(scene):
    lights = json.loads(pathlib.Path(scene).read_text())["lights"]
    return lights[0].get("position") if len(lights) == 1 else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--glint", default="build/release/bin/glint", help="the program to run")
    parser.add_argument("--shared", default="../shared", help="folder with data/cycles and method.md")
    parser.add_argument("--output", help="default: accuracy.md beside this script; - prints it")
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_args()
    here = pathlib.Path(__file__).resolve().parent
    specs = here.parent / "resources" / "specs"
    shared = pathlib.Path(a.shared)
    method = (shared / "method.md").read_text()
    glint = str(pathlib.Path(a.glint).resolve())

    runs = {}
    with tempfile.TemporaryDirectory() as scratch:
        for name, trains in SYNTHETIC:
            folder = pathlib.Path(scratch) / name
            subprocess.run([glint, "synth", str(specs / f"{name}.json"), "-o", str(folder)], check=True, capture_output=True)
            for train in trains:
                runs[name, "analytic", train, "exact"] = Run(folder / "scene.json", train, None, None)
        for name, scenes, trains in CYCLES:
            folder = shared / "data" / "cycles" / name
            for kind, file in scenes:
                for train in trains:
                    for source in SOURCES:
                        truth = folder / "contours" if "truth" in source else None
                        runs[name, kind, train, source] = Run(folder / file, train, source.split(",")[0], truth)
        with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
            list(pool.map(lambda run: run.run(glint), runs.values()))
        lamps = {key: lamp_of(run.scene) for key, run in runs.items()}
        frames = {key: len(json.loads(run.scene.read_text())["frames"]) for key, run in runs.items()}
    text = page(runs, lamps, frames, method)
    if a.output == "-":
        print(text, end="")
    else:
        pathlib.Path(a.output or here / "accuracy.md").write_text(text)
    broken = [f"{key}: {run.error}" for key, run in runs.items() if not run.result]
    if broken:
        sys.exit("make_accuracy.py: " + "; ".join(broken))


def page(runs, lamps, frames, method):
    settings = next(run.result["settings"] for run in runs.values() if run.result)
    out = ["""# Accuracy

How far predicted highlights lie from the observed ones, on sequences with known truth. A program writes this page; do not edit it. After a release build, from the root of the
project:

    python3 docs/make_accuracy.py --glint build/release/bin/glint --shared ../shared

It runs `glint evaluate` on path-traced sequences with known truth, rendered by another program (`../shared/data/cycles`),
and on the paper's two synthetic experiments, which `glint synth` makes exactly (`resources/specs`).

## How to read the tables
- **contour error** (`mean %`, `median %`, `p95 %`, `max %`): symmetric mean distance between the predicted and the observed contour, as a
  percentage of the equivalent diameter of the observed region, per matched highlight; `mean px` is the same in pixels. `ellipse %` compares
  ellipses fitted to both, as the paper does.
- `predicted`: frames with a prediction, of those that should have one. `coverage`: share of directions (or of the outline) that gave a
  point. `matched/missed/spurious` counts highlights. Read these first: a mean says little where frames, coverage or matches are missing.
- `IoU`: over the union of all regions of a frame. `peak px`: predicted brightest point to observed peak. The observed peak is the maximum of a
  log-quadratic fit; a path-traced highlight has its peak beside the mirror point (off-specular shift), so this is not only an error of the geometry.
- **Training** frames never count, except with `per-surface`, where each surface's models are trained and tested on the same six frames.
- **Source**: `radiance` = contours and peaks detected in the 32-bit float specular radiance; `image` = in the 8-bit sRGB photograph,
  background removed. Without `truth` the error is against Glint's own detection in the same images. `..., truth` = trained on the same
  detections, but scored against contours that another program traced on the radiance (`contours/`): quote this column.
- **Surface**: `mesh` = the rendered triangles, with interpolated vertex normals; `analytic` = the exact surface.
- **Level**: a contour lies at a fraction of the strongest peak of its frame above the background, the same fraction everywhere (`detect.level` below).
- Two renderings with different random seeds differ by about 0.01 px, so differences below 0.02 px mean nothing.

## Settings
All runs use the defaults; the tables name what a run changes.

"""]
    out.append(table(["setting", "value"],
                     [[f"`{k}`", f"`{v}`" if isinstance(v, str) else f"`{json.dumps(v)}`"] for k, v in settings.items()]))

    out.append("\n## Bounds\nMean contour error in percent. A bound counts only where every frame is predicted, mean coverage is at least "
               f"{LEAST_COVERAGE} and no observed highlight stays unmatched.\n\nPath-traced sequences:\n\n")
    columns = [(kind, source) for kind, _ in MESH_AND_ANALYTIC for source in SOURCES]
    rows = []
    for name, train, model, bound in CYCLES_BOUNDS:
        rows.append([name, f"`{train}`", model, bound_text(bound)] +
                    [judged(runs[name, k, train, s], model, bound_of(bound, k, s)) for k, s in columns])
    name, train, ratio = DUAL_OVER_CANONICAL
    cells = []
    for k, s in columns:
        run = runs[name, k, train, s]
        dual, canonical = run.error_pct("dual"), run.error_pct("canonical")
        value = dual / canonical if dual and canonical else None
        uncounted = run.uncounted("canonical") or run.uncounted("dual")
        cells.append(f"{number(value)} – "
                     + (f"does not count: {uncounted}" if uncounted else "met" if value >= ratio else "**missed**"))
    rows.append([name, f"`{train}`", "dual / canonical", f"≥ {number(ratio, 2)}"] + cells)
    out.append(table(["sequence", "training", "model", "bound"] + [f"{k}, {s}" for k, s in columns], rows))

    answers = []
    for key, run in runs.items():
        if run.result:
            answers.append((key, run.unanswered(frames[key])))
    silent = [f"{key}: {bad}" for key, bad in answers if bad]
    out.append("\nEvery frame has a number or a named reason in each model: " +
               (f"**missed**: {'; '.join(silent)}.\n" if silent else f"met in all {len(answers)} runs.\n"))
    rows = []
    for key, run in runs.items():
        if key[0] == "vase":
            for model in ["limit-angle", "reflectance"]:
                s = run.summary(model)
                iou = s["iou"]["mean"]
                verdict = ""
                if model == "reflectance" and key[3] == "radiance":
                    verdict = f" – {'met' if not run.uncounted(model) and iou >= VASE_LEAST_IOU else '**missed**'} (≥ {VASE_LEAST_IOU})"
                rows.append([f"`{key[2]}`", key[3], model, f"{s['predicted']}/{s['frames']}",
                             f"{s['matched']}/{s['missed']}/{s['spurious']}",
                             number(iou, 4) + verdict])
    out.append("\nVase (highlights that split and merge):\n\n" +
               table(["training", "source", "model", "predicted", "matched/missed/spurious", "IoU"], rows))
    out.append("\nExact synthetic data:\n\n")
    out.append(table(["sequence", "training", "model", "bound", "measured"],
                     [[n, f"`{t}`", m, f"≤ {b}", judged(runs[n, "analytic", t, "exact"], m, b)]
                      for n, t, m, b in SYNTHETIC_BOUNDS]))

    out.append("\n## Compared with the prototype and the paper\nAn independent prototype (Python, analytic surfaces) and the paper, quoted from "
               "section 9 of method.md. On exact data, plane to cylinder:\n\n")
    out.append(as_tables(quoted(method, "| | exp 1")))
    out.append("\nEllipsoid, 80 frames:\n\n" + as_tables(quoted(method, "| model | training frames")))
    out.append("\nPath-traced frames, from the radiance, held-out frames where there are any:\n\n" +
               as_tables(quoted(method, "| sequence | training |")))
    out.append("\n" + quoted(method, "The paper reports"))

    for name, scenes, trains in CYCLES:
        out.append(f"\n## {name} (path-traced)\n")
        for train in trains:
            rows, fits = [], []
            for kind, _ in scenes:
                for source in SOURCES:
                    run = runs[name, kind, train, source]
                    rows += model_rows([kind, source], run)
                    fits += fit_rows([kind, source], run, lamps[name, kind, train, source]) if "truth" not in source else []
            out.append(f"\n### `--train {train}`: {TRAIN_TEXT[train]}\n\n" + table(["surface", "source"] + MODEL_HEADER, rows) +
                       "\nWhat was estimated:\n\n" + table(["surface", "source"] + FIT_HEADER, fits))
    for name, trains in SYNTHETIC:
        out.append(f"\n## {name} (exact synthetic, analytic surface, exact contours of the limit angle)\n")
        for train in trains:
            run = runs[name, "analytic", train, "exact"]
            out.append(f"\n### `--train {train}`: {TRAIN_TEXT[train]}\n\n" + table(MODEL_HEADER, model_rows([], run)) +
                       "\nWhat was estimated:\n\n"
                       + table(FIT_HEADER, fit_rows([], run, lamps[name, "analytic", train, "exact"])))
    return "".join(out)


if __name__ == "__main__":
    main()
