#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/selection.md: what `glint evaluate --models auto` chooses on scenes where the right answer is known.

    docs/make_selection.py --glint build/release/bin/glint [--shared ../shared]

Exit code 1 if a choice is not among those that the assumptions of the models allow.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LEVEL_SET = {"limit-angle", "reflectance"}
# Scene, training, and which choices are right: without a tolerance, with 0.5 %, with 1 px noise on contours and peaks.
SYNTHETIC = [
    # With noise a model of fewer numbers is more accurate than `primal`, though leaving one out cannot tell: any but `dual` is right.
    ("plane", "spread:8", {"primal"}, {"primal"}, {"primal", "canonical"} | LEVEL_SET),
    ("sphere", "spread:8", LEVEL_SET, {"primal", "dual", "canonical"}, {"canonical"} | LEVEL_SET),
    ("cylinder", "spread:8", LEVEL_SET, {"dual", "canonical"}, {"canonical"} | LEVEL_SET),
    ("plane_to_cylinder", "spread:10", LEVEL_SET, {"canonical"}, {"canonical"} | LEVEL_SET),
    ("plane_to_cylinder", "0-5", {"canonical"} | LEVEL_SET, {"canonical"}, {"canonical"} | LEVEL_SET),
    ("ellipsoid", "spread:8", {"canonical"} | LEVEL_SET, {"canonical", "limit-angle"}, {"canonical"} | LEVEL_SET),
    ("two_lights", "spread:8", LEVEL_SET, {"dual", "canonical"}, {"canonical"} | LEVEL_SET),
    ("tube_light", "spread:8", {"canonical"} | LEVEL_SET, {"canonical"} | LEVEL_SET, {"dual", "canonical"} | LEVEL_SET),
]
CYCLES = [
    ("plane_to_cylinder", "spread:12", {"reflectance"}, {"canonical"}, {"canonical"} | LEVEL_SET),
    ("sphere", "spread:6", {"reflectance"}, LEVEL_SET, LEVEL_SET),
    ("vase", "spread:6", {"reflectance"}, {"reflectance"}, LEVEL_SET),
]
RUNS = [("no tolerance", []), ("tolerance 0.5 %", ["--good-enough-pct", "0.5"]),
        ("1 px noise", ["--noise-px", "1", "--seed", "3"])]


def choose(glint, scene, train, more):
    run = subprocess.run([glint, "evaluate", scene, "--models", "auto", "--train", train, "--json", "-", *more],
                         capture_output=True, text=True)
    if run.returncode not in (0, 3):
        sys.exit(f"{scene}: {run.stderr}")
    return json.loads(run.stdout)


def percent(value):
    return "–" if value is None else f"{value:.2g} %" if value < 1 else f"{value:.3g} %"


def patchText(patches):
    if patches is None:
        return "–"
    variation = patches["curvature_variation"]
    return ("yes" if patches["good_enough"] else "no") + ("" if variation is None else f" ({variation:.2g})")


def write(out, tables):
    models = ["primal", "dual", "canonical", "limit-angle", "reflectance"]
    text = ("# Automatic choice\n"
            "\n"
            "What `glint evaluate --models auto` chooses on scenes where the right answer is known, and at what cost. Written by `docs/make_selection.py`. `glint synth` makes the first scenes\n"
            "from `resources/specs/auto`: exact contours under one limit angle (the tube light: rendered radiance). The rule is in [method.md](method.md), section 11.\n"
            "\n"
            "Columns of models: error on training frames, each left out in turn. \\* the choice; – not tried (a simpler model met the tolerance, or the surface is a plane and nothing could be better); (k of n) answered k of n views (one for each highlight of a training frame).\n"
            "Where a model could no longer become the best, fewer views than there are were tried, and none (0 of 0) where its fit to all views fails. Further columns: whether walks on local quadrics are good enough for the choice, with the largest\n"
            "variation of curvature seen (– it does not walk); error expected for the choice, and found on the held-out frames, whose contours it has not seen; time of the whole choice.\n")
    for run, _ in RUNS:
        text += f"\n## {run[0].upper() + run[1:]}\n| scene | training | " + " | ".join(models) + " | local quadric | expected | held out | seconds |\n|---|---|" + "---|" * (len(models) + 4) + "\n"
        for name, train, chosen, errors, patches, held_out, seconds in tables[run]:
            cells = []
            for m in models:
                c = errors.get(m)
                if c is None:
                    cells.append("–")
                    continue
                partial = "" if c["answered"] == c["views"] else f" ({c['answered']} of {c['tried']})"
                cells.append(percent(c["mean_pct"]) + partial + (" **\\***" if m == chosen else ""))
            text += f"| {name} | `{train}` | " + " | ".join(cells) + f" | {patchText(patches)} | {percent(errors[chosen]['expected_pct'] if chosen else None)} | {percent(held_out)} | {seconds:.1f} |\n"
    out.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", default=ROOT / "build/release/bin/glint", type=pathlib.Path)
    parser.add_argument("--shared", default=ROOT.parent / "shared", type=pathlib.Path)
    parser.add_argument("--out", default=ROOT / "docs/selection.md", type=pathlib.Path)
    args = parser.parse_args()
    wrong = []
    tables = {name: [] for name, _ in RUNS}
    with tempfile.TemporaryDirectory() as folder:
        scenes = []
        for name, train, *right in SYNTHETIC:
            made = pathlib.Path(folder) / name
            if not made.exists():
                subprocess.run([args.glint, "synth", ROOT / f"resources/specs/auto/{name}.json", "-o", made], check=True,
                               stdout=subprocess.DEVNULL)
            scenes.append((name, made, train, right))
        for name, train, *right in CYCLES:
            file = args.shared / "data/cycles" / name / "scene.json"
            if file.exists():
                scenes.append((f"{name} (path-traced)", file, train, right))
        for name, scene, train, right in scenes:
            for (run, more), allowed in zip(RUNS, right):
                result = choose(args.glint, scene, train, more)
                chosen = result["chosen_model"]
                if chosen not in allowed:
                    wrong.append(f"{name}, {train}, {run}: {chosen}, expected {' or '.join(sorted(allowed))}")
                errors = {c["model"]: c for c in result["selection"]["candidates"]}
                held_out = result["models"][chosen]["summary"]["contour_error_pct"]["mean"] if chosen else None
                seconds = sum(c["time_us"] for c in errors.values()) * 1e-6
                tables[run].append((name, train, chosen, errors, result["selection"]["local_quadric"], held_out, seconds))
                print(f"{name}, {train}, {run}: {chosen}", file=sys.stderr)
            write(args.out, tables)  # what is there so far is true whatever happens next
    for line in wrong:
        print("WRONG: " + line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
