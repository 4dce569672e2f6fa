#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/performance.md: CPU times of the benchmarks, against the aims, and cost curves."""
import argparse
import json
import pathlib
import subprocess
import sys

# (program, benchmark, what it is, aim in milliseconds or None)
ROWS = [
    ("bench_predict", "canonicalPredictionMesh", "canonical prediction, 36 directions, mesh of 1 million triangles", 0.12),
    ("bench_predict", "canonicalPredictionMeshHints",
     "the same, brightest point from the training views' (`predict.search=hints`)", 0.12),
    ("bench_predict", "canonicalPredictionMeshQuadric", "the same, walks on the local quadric (`predict.query=local-quadric`)",
     0.01),
    ("bench_predict", "canonicalPredictionAnalytic", "the same on the analytic surface", None),
    ("bench_predict", "partBrightestPointMesh", "of it: search of the brightest point", None),
    ("bench_predict", "partWalkMesh", "of it: the 36 walks", None),
    ("bench_predict", "dualPredictionMesh", "dual prediction, the same mesh", None),
    ("bench_predict", "limitAnglePredictionMesh", "limit-angle prediction, the same mesh", None),
    ("bench_predict", "limitAnglePredictionMeshStarGrid", "the same by 36 walks (`predict.contour=star`)", 0.06),
    ("bench_predict", "limitAnglePredictionMeshStar", "the same, brightest point from hints", 0.06),
    ("bench_predict", "limitAnglePredictionMeshQuadric", "the same, walks on the local quadric", 0.06),
    ("bench_predict", "limitAnglePredictionAnalytic", "limit-angle prediction, analytic surface", None),
    ("bench_predict", "reflectancePredictionMesh", "reflectance prediction, mesh of 1 million triangles, level set", None),
    ("bench_predict", "reflectancePredictionMeshStar", "the same by walks (`predict.contour=star`)", 0.15),
    ("bench_predict", "reflectancePredictionMeshStarDisc", "the same, a lamp of 0.15 m radius", None),
    ("bench_predict", "reflectancePredictionAnalytic", "reflectance prediction, analytic surface, level set", None),
    ("bench_predict", "reflectancePredictionAnalyticStar", "the same by walks", None),
    ("bench_predict", "fitLinear", "ellipsoid from 6 views of 72 points, linear", 2),
    ("bench_predict", "fitAnchored", "the same, anchored", None),
    ("bench_predict", "fitRefined", "the same, refined, the prior weighed by the residuals", None),
    ("bench_predict", "bundleAnalytic", "light by the bundle, 6 views of 72 points, analytic surface", 10),
    ("bench_predict", "bundleMesh", "the same, mesh of 1 million triangles", 10),
    ("bench_predict", "refinedWithBundleAnalytic", "bundle, canonical contours and refined ellipsoid, analytic surface", 50),
    ("bench_predict", "refinedWithBundleMesh", "the same, mesh of 1 million triangles", 50),
    ("bench_predict", "canonicalContourOfOneView", "canonical contour of one view, mesh of 1 million triangles", None),
    ("bench_predict", "compareOneFrame", "comparison of one frame's prediction with its contour", None),
    ("bench_predict", "detectOneFrame", "detection in one frame of 640 x 480", None),
    ("bench_reconstruct", "linear/6", "linear reconstruction alone, 6 views", 2),
    ("bench_reconstruct", "linear/1000", "linear reconstruction alone, 1000 views", None),
]
# Cost curves: (heading, unit of the argument, [(program, benchmark, label)], arguments)
SIZES = [1000, 10000, 100000, 1000000]
CURVES = [
    ("By the size of the mesh", "triangles", [
        ("bench_predict", "buildByTriangles", "building the surface"),
        ("bench_predict", "firstSearchByTriangles", "first search: builds the tree of normals"),
        ("bench_predict", "searchByTriangles", "every other search"),
        ("bench_predict", "dualByTriangles", "dual"),
        ("bench_predict", "canonicalByTriangles", "canonical"),
        ("bench_predict", "canonicalQuadricByTriangles", "canonical, quadric, hints"),
        ("bench_predict", "starByTriangles", "limit-angle, star, hints"),
        ("bench_predict", "levelSetByTriangles", "limit-angle, level set")], SIZES),
    ("By the number of directions, 1 million triangles", "directions", [
        ("bench_predict", "canonicalByDirections", "canonical"),
        ("bench_predict", "canonicalQuadricByDirections", "canonical, quadric, hints"),
        ("bench_predict", "starByDirections", "limit-angle, star, hints")], [6, 36, 120, 360]),
    ("By the number of training views, 72 points each", "views", [
        ("bench_predict", "bundleByViews", "light and limit angle by the bundle, mesh of 1 million triangles"),
        ("bench_predict", "fitLinearByViews", "ellipsoid, linear"),
        ("bench_predict", "fitAnchoredByViews", "anchored"),
        ("bench_predict", "fitRefinedByViews", "refined"),
        ("bench_predict", "fitReflectanceByViews", "reflectance, all lobes")], [3, 6, 20, 60, 1000]),
    ("Detection by the width of the picture, 4:3", "pixels", [
        ("bench_predict", "detectByWidth", "detection")], [320, 640, 1280, 1920]),
    ("Frames predicted and compared, 1 million triangles, all cores, wall time", "frames", [
        ("bench_predict", "framesCanonical", "canonical"),
        ("bench_predict", "framesCanonicalQuadric", "canonical, quadric, hints"),
        ("bench_predict", "framesStar", "limit-angle, star, hints")], [1, 10, 100, 1000, 1410]),
]
BEGIN, END = "<!-- alternatives: begin -->", "<!-- alternatives: end -->"
TO_MS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


def number(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", default="build/release/bin", help="folder of the benchmark programs")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--min-time", type=float, default=0.1, help="seconds per repetition")
    parser.add_argument("--output", help="default: docs/performance.md; - prints it")
    a = parser.parse_args()
    times, context = {}, {}
    curves = [(program, f"{name}/{x}" + ("/real_time" if heading.startswith("Frames") else ""))
              for heading, _, series, xs in CURVES for program, name, _ in series for x in xs]
    for program in sorted({r[0] for r in ROWS}):
        wanted = "|".join(f"^{name}$" for p, name in [r[:2] for r in ROWS] + curves if p == program)
        done = subprocess.run(
            [str(pathlib.Path(a.programs) / program), f"--benchmark_filter={wanted}", f"--benchmark_repetitions={a.repetitions}",
             f"--benchmark_min_time={a.min_time}", "--benchmark_format=json"], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{program}: {done.stderr.strip()}")
        result = json.loads(done.stdout)
        context = result["context"]
        runs = {}
        for b in result["benchmarks"]:
            if b.get("run_type") == "iteration" and not b.get("error_occurred"):
                runs.setdefault(b["run_name"],
                                []).append(b["real_time" if b["run_name"].endswith("real_time")
                                             else "cpu_time"] * TO_MS[b["time_unit"]])
        for name, values in runs.items():
            times[program, name] = sorted(values)

    lines = ["""# Performance

How long each stage takes, how the cost grows, and what bounds it. A program writes this page; do not edit it. After a release build, from the root
of the project:

    python3 bench/make_performance.py --programs build/release/bin
"""]
    lines.append(f"CPU time of one thread (not wall time), median of {a.repetitions} repetitions, and the fastest of them. Machine: "
                 f"{context['num_cpus']} cores at {context['mhz_per_cpu']} MHz, shared with other work (load average {context['load_avg'][0]:.1f} "
                 "at the start): caches and clock were shared, so an idle machine is faster.\n")
    lines += ["| what | median ms | fastest ms | aim ms | |", "| --- | --- | --- | --- | --- |"]
    for program, name, text, aim in ROWS:
        values = times.get((program, name))
        if not values:
            sys.exit(f"{program} has no benchmark {name}")
        median = values[len(values) // 2]
        verdict = "" if aim is None else "met" if median <= aim else f"**missed by {number(100 * (median / aim - 1))} %**"
        lines.append(f"| {text} (`{name}`) | {number(median)} | {number(values[0])} | {'' if aim is None else '≤ ' + str(aim)} | {verdict} |")
    for heading, unit, series, xs in CURVES:
        lines += [f"\n## {heading}\n", "Microseconds (median).\n",
                  f"| {unit} | " + " | ".join(label for _, _, label in series) + " |",
                  "| --- |" + " --- |" * len(series)]
        for x in xs:
            cells = []
            for program, name, _ in series:
                values = times.get((program, f"{name}/{x}")) or times.get((program, f"{name}/{x}/real_time"))
                cells.append(number(1e3 * values[len(values) // 2]) if values else "")
            lines.append(f"| {x} | " + " | ".join(cells) + " |")
    folder = pathlib.Path(__file__).resolve().parent
    lines.append("\n" + (folder / "performance_notes.md").read_text().strip())
    output = None if a.output == "-" else pathlib.Path(a.output) if a.output else folder.parent / "docs" / "performance.md"
    # The table of the alternatives is another program's: it stays.
    old = output.read_text() if output and output.exists() else ""
    kept = old[old.index(BEGIN) + len(BEGIN):old.index(END)].strip() if BEGIN in old and END in old else "Not measured yet."
    lines.append(f"""
## Compared with alternatives

The same contours of a sphere, from a path tracer and from a plain NumPy program, one after the other on the same computer, one thread:

    python3 bench/compare_alternatives.py FOLDER_OF_CYCLES_SPHERE

Errors are mean distances to the reference contours, as a share of their diameter. The path tracer is given what the models must
find: light, material and level.

{BEGIN}
{kept}
{END}""")
    text = "\n".join(lines) + "\n"
    if a.output == "-":
        print(text, end="")
    else:
        output.write_text(text)


if __name__ == "__main__":
    main()
