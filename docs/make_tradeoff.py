#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tables of docs/tradeoff.md between its markers: `glint tradeoff` with all models on the shipped sessions, on
path-traced frames with their meshes, and on a mesh of a million triangles.

    docs/make_tradeoff.py [--glint build/release/bin/glint] [--shared ../shared] [--only NAME ...]

Scenes missing from --shared are skipped; with --only the other tables stay as they are.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
from large_scene import large_mesh  # noqa: E402

PAGE = ROOT / "docs/tradeoff.md"
BEGIN, END = "<!-- {} begin -->", "<!-- {} end -->"


def setting(point):
    return ", ".join([point["settings"]["model"], *(f"{key.split('.')[-1]} {value}" for key, value in point["set"].items())])


def table(glint, title, scene, train):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "t.json"
        start = time.monotonic()
        subprocess.run([glint, "tradeoff", scene, "--models", "primal,dual,canonical,limit-angle,reflectance", "--train", train,
                        "--json", file],
                       check=True, stdout=subprocess.DEVNULL)
        seconds = time.monotonic() - start
        t = json.loads(file.read_text())
    marks = {}
    for preset, index in t["presets"].items():
        marks.setdefault(index, []).append(preset)
    text = f"### {title}\n`--train {train}`, {seconds:.0f} s: {t['trials']} settings tried on few frames, {len(t['points'])} measured in full, {len(t['pruned'])} dropped.\n\n"
    text += "| front | µs a frame | error % | found | error of those found % | IoU | fit ms | peak MB | setting | preset |\n|---|---|---|---|---|---|---|---|---|---|\n"
    number = lambda v, digits=3: "–" if v is None else f"{v:.{digits}g}" if abs(v) < 1000 else f"{v:.0f}"
    for i, p in enumerate(t["points"]):
        text += (f"| {'*' if p['pareto'] else ''} | {number(p['predict_us'])} | {number(p['ranked_error_pct'])} | {p['matched']}/{p['matched'] + p['missed']} | {number(p['contour_error_pct'])} | {number(p['iou'], 4)} | "
                 f"{number(None if p['fit_us'] is None else p['fit_us'] / 1000)} | {number(p['peak_mb'])} | {setting(p)} | {', '.join(marks.get(i, []))} |\n")
    return text + f"\n{t['reason']}\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", default=ROOT / "build/release/bin/glint", type=pathlib.Path)
    parser.add_argument("--shared", default=ROOT.parent / "shared", type=pathlib.Path)
    parser.add_argument("--only", nargs="*")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scenes = [("ellipsoid", "Ellipsoid, rendered images (`sessions/ellipsoid`)",
                   lambda: ROOT / "sessions/ellipsoid/scene.json", "spread:6"),
                  ("million", "The same on a mesh of a million triangles", lambda: large_mesh(pathlib.Path(folder)), "spread:6"),
                  ("vase", "Vase, path-traced, its mesh (`sessions/vase`)", lambda: ROOT / "sessions/vase/scene.json",
                   "spread:6"),
                  ("sphere", "Sphere, path-traced (`data/cycles/sphere`)", lambda: args.shared / "data/cycles/sphere/scene.json",
                   "spread:6")]
        for name, title, scene, train in scenes:
            if (args.only and name not in args.only) or not (file := scene()).exists():
                continue
            begin, end = BEGIN.format(name), END.format(name)
            page = PAGE.read_text()
            if begin not in page:
                page = page.rstrip() + f"\n\n{begin}\n{end}\n"
            made = f"{begin}\n{table(args.glint, title, file, train)}{end}"
            page = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: made, page, flags=re.S)
            PAGE.write_text(page)  # what is there so far is true whatever happens next
            print(name, flush=True)


if __name__ == "__main__":
    main()
