#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/performance.md: CPU times of the benchmarks, against the aims."""
import argparse
import json
import pathlib
import subprocess
import sys

# (program, benchmark, what it is, aim in milliseconds or None)
ROWS = [
    ("bench_predict", "canonicalPredictionMesh", "canonical prediction, 36 directions, mesh of 1 million triangles", 0.3),
    ("bench_predict", "canonicalPredictionAnalytic", "the same on the analytic surface", None),
    ("bench_predict", "partBrightestPointMesh", "of it: search of the brightest point", None),
    ("bench_predict", "partWalkMesh", "of it: the 36 walks", None),
    ("bench_predict", "dualPredictionMesh", "dual prediction, the same mesh", None),
    ("bench_predict", "limitAnglePredictionMesh", "limit-angle prediction, the same mesh", None),
    ("bench_predict", "limitAnglePredictionAnalytic", "limit-angle prediction, analytic surface", None),
    ("bench_predict", "fitLinear", "ellipsoid from 6 views of 72 points, linear", 2),
    ("bench_predict", "fitAnchored", "the same, anchored", None),
    ("bench_predict", "fitRefined", "the same, refined; the prior chosen by leave-one-view-out", None),
    ("bench_predict", "bundleAnalytic", "light by the bundle, 6 views of 72 points, analytic surface", 10),
    ("bench_predict", "bundleMesh", "the same, mesh of 1 million triangles", 10),
    ("bench_predict", "refinedWithBundleAnalytic", "bundle, canonical contours and refined ellipsoid, analytic surface", 50),
    ("bench_predict", "refinedWithBundleMesh", "the same, mesh of 1 million triangles", 50),
    ("bench_predict", "canonicalContourOfOneView", "canonical contour of one view, mesh of 1 million triangles", None),
    ("bench_predict", "detectOneFrame", "detection in one frame of 640 x 480", None),
    ("bench_reconstruct", "linear/6", "linear reconstruction alone, 6 views", 2),
    ("bench_reconstruct", "linear/1000", "linear reconstruction alone, 1000 views", None),
]
TO_MS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


def number(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", default="build/release/bin", help="folder of the benchmark programs")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--output", help="default: docs/performance.md; - prints it")
    a = parser.parse_args()
    times, context = {}, {}
    for program in sorted({r[0] for r in ROWS}):
        wanted = "|".join(f"^{r[1]}$" for r in ROWS if r[0] == program)
        done = subprocess.run(
            [str(pathlib.Path(a.programs) / program), f"--benchmark_filter={wanted}", f"--benchmark_repetitions={a.repetitions}",
             "--benchmark_min_time=0.1", "--benchmark_format=json"], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{program}: {done.stderr.strip()}")
        result = json.loads(done.stdout)
        context = result["context"]
        runs = {}
        for b in result["benchmarks"]:
            if b.get("run_type") == "iteration" and not b.get("error_occurred"):
                runs.setdefault(b["run_name"], []).append(b["cpu_time"] * TO_MS[b["time_unit"]])
        for name, values in runs.items():
            times[program, name] = sorted(values)

    lines = ["""# Performance

This page is written by a program; do not edit it. After a release build, from the root of the project:

    python3 bench/make_performance.py --programs build/release/bin
"""]
    lines.append(f"CPU time of one thread (not wall time), median of {a.repetitions} repetitions, and the fastest of them. Machine: "
                 f"{context['num_cpus']} cores at {context['mhz_per_cpu']} MHz, shared with other work (load average {context['load_avg'][0]:.1f} "
                 "at the start): caches and clock were not ours alone, so a quiet machine is faster than this.\n")
    lines += ["| what | median ms | fastest ms | aim ms | |", "| --- | --- | --- | --- | --- |"]
    for program, name, text, aim in ROWS:
        values = times.get((program, name))
        if not values:
            sys.exit(f"{program} has no benchmark {name}")
        median = values[len(values) // 2]
        verdict = "" if aim is None else "met" if median <= aim else f"**missed by {number(100 * (median / aim - 1))} %**"
        lines.append(f"| {text} (`{name}`) | {number(median)} | {number(values[0])} | {'' if aim is None else '≤ ' + str(aim)} | {verdict} |")
    text = "\n".join(lines) + "\n"
    if a.output == "-":
        print(text, end="")
    else:
        output = pathlib.Path(a.output) if a.output else pathlib.Path(__file__).resolve().parent.parent / "docs" / "performance.md"
        output.write_text(text)


if __name__ == "__main__":
    main()
