#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/captures.md about surfaces from clouds: what bench/cloud_surfaces.cpp prints, a row for each cloud.

  docs/make_clouds.py --bench build/release/bin/cloud_surfaces
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/captures.md"
BEGIN, END = "<!-- table: docs/make_clouds.py -->\n", "<!-- end of table -->\n"
WAYS = {"facets": "facets through the points", "fitted normals": "fitted normals, points as they are",
        "greedy": "PCL's greedy triangulation of the fitted points, as in its tutorial",
        "along the ray": "moving least squares along each ray",
        "glint": "Glint: fitted points, triangles between tangent-plane neighbours"}


def two(value):
    """Two digits, without an exponent."""
    digits = 0 if value >= 10 else 1 if value >= 1 else 2
    return f"{value:.{digits}f}"


def cell(row, first):
    text = two(row["rms_deg"]) + (" degrees" if first else "")
    if row["missed_pct"] > 0:
        text += f", {row['missed_pct']:.2g} % missed"
    if row["way"] == "along the ray":
        text += f", {row['us_per_ray'] / 1000:.1f} ms a ray"
    return text


def table(rows):
    lines = ["| 20,000 points, noise in units of their distance | " + " | ".join(WAYS.values()) + " |",
             "|---" * (1 + len(WAYS)) + "|"]
    for shape, noise in dict.fromkeys((row["shape"], row["noise"]) for row in rows):
        found = {row["way"]: row for row in rows if (row["shape"], row["noise"]) == (shape, noise)}
        cells = [cell(found[way], len(lines) == 2 and i == 0) for i, way in enumerate(WAYS)]
        lines.append(f"| {shape}, {noise:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", required=True, help="the program cloud_surfaces")
    arguments = parser.parse_args()
    done = subprocess.run([arguments.bench], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"make_clouds.py: {arguments.bench} ended with {done.returncode}: {done.stderr.strip()}")
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    text = PAGE.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or END not in text.split(BEGIN)[1]:
        sys.exit(f"make_clouds.py: {PAGE} has no place for the table")
    head, rest = text.split(BEGIN)
    temporary = PAGE.with_name(PAGE.name + ".new")
    temporary.write_text(head + BEGIN + table(rows) + END + rest.split(END, 1)[1], encoding="utf-8")
    os.replace(temporary, PAGE)


main()
