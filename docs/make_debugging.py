#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Asks `glint diagnose` about sequences that are hard to fit, and writes the table of docs/debugging.md.

Usage: docs/make_debugging.py --glint PROGRAM --times PROGRAM [--keep DIR] [--write]
       docs/make_debugging.py --glint PROGRAM --pictures INSPECTOR [--keep DIR]

Every figure of the table is what a program printed: the held-out errors and those after the first remedy by `glint evaluate`, the verdict and the
processor time by diagnose_times (bench/), which runs what *Find out why* runs. The sequences: a body with two thin ears and a fin, which is made
here; sessions/vase; and, where they are there, ../shared/data/cycles/torus and two of ../shared/data/ladder.
--keep DIR       leave the sequence that is made there, or take it from there
--pictures FILE  draw the picture with this glint-inspector instead of the table (needs xvfb-run and mogrify)
--write          put the table into docs/debugging.md; else print it"""
import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/debugging.md"
CAMERA = {"width": 480, "height": 360, "fx": 600, "fy": 600, "cx": 239.5, "cy": 179.5}
SHARED = ROOT.parent / "shared/data"
MODELS = ("primal", "dual", "canonical", "limit-angle", "reflectance")


def ellipsoid(axes, centre, turn, rings=48, spokes=96):
    """Vertices and triangles; turn = (axis, degrees)."""
    axis, angle = turn
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    rows = {"x": ((1, 0, 0), (0, c, -s), (0, s, c)), "y": ((c, 0, s), (0, 1, 0), (-s, 0, c))}[axis]
    vertices, faces = [], []
    for i in range(rings + 1):
        for j in range(spokes):
            t, p = math.pi * i / rings, 2 * math.pi * j / spokes
            local = (axes[0] * math.sin(t) * math.cos(p), axes[1] * math.sin(t) * math.sin(p), axes[2] * math.cos(t))
            vertices.append(tuple(sum(r[k] * local[k] for k in range(3)) + o for r, o in zip(rows, centre)))
    for i in range(rings):
        for j in range(spokes):
            a, b = i * spokes + j, i * spokes + (j + 1) % spokes
            if i > 0:
                faces.append((a, a + spokes, b))
            if i < rings - 1:
                faces.append((b, a + spokes, b + spokes))
    return vertices, faces


def write_mesh(file, parts):
    vertices, faces = [], []
    for v, f in parts:
        faces += [tuple(i + len(vertices) for i in face) for face in f]
        vertices += v
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {a}" for a in "xyz"),
             f"element face {len(faces)}",
             "property list uchar int vertex_indices", "end_header",
             *("%.17g %.17g %.17g" % v for v in vertices), *("3 %d %d %d" % f for f in faces)]
    file.write_text("\n".join(lines) + "\n")


def specification(folder):
    parts = [ellipsoid((0.5, 0.42, 0.4), (0, 0, 0), ("x", 0)), ellipsoid((0.05, 0.03, 0.35), (0.2, 0, 0.55), ("y", 20)),
             ellipsoid((0.05, 0.03, 0.35), (-0.2, 0, 0.55), ("y", -20)), ellipsoid((0.25, 0.02, 0.12), (0, -0.45, 0), ("x", 15))]
    write_mesh(folder / "ears.ply", parts)
    return {"glint_scene": 1, "name": "ears", "units": "m", "camera": CAMERA, "surfaces": {"body": {"mesh": "ears.ply"}},
            "lights": [{"id": "lamp", "position": [1.2, -1.4, 2.2], "radius": 0.05}],
            "path": {"orbit": {"centre": [0, 0, 0.1], "radius": 3, "from": -110, "to": -30, "height": 0.9, "count": 16}},
            "render": {"reflectance": "torrance-sparrow", "roughness": 0.12, "diffuse": [0.6, 0.8, 1.2], "bits": 8, "samples": 2,
                       "seed": 1}}


class Failed(Exception):
    pass


def run(arguments, codes=(0,)):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        raise Failed(f"{' '.join(map(str, arguments))}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def make(glint, folder):
    """The sequence as a camera would leave it: photographs, poses, surface; nothing that only a synthesis knows."""
    file = folder / "ears/scene.json"
    if file.exists():
        return file
    (folder / "ears.json").write_text(json.dumps(specification(folder)))
    run([glint, "synth", folder / "ears.json", "-o", folder / "ears"])
    scene = json.loads(file.read_text())
    for frame in scene["frames"]:
        for key in ("lights_on", "radiance", "mask", "highlights", "depth", "normals"):
            frame.pop(key, None)
    file.write_text(json.dumps(scene))
    return file


def held_out(glint, scene, flags):
    """Mean held-out contour errors of the models, % of the diameter, with what is missed and spurious."""
    models = json.loads(run([glint, "evaluate", scene, *flags, "--json", "-"], codes=(0, 3)))["models"]
    cells = {}
    for name, model in models.items():
        s = model["summary"]
        pct = s["contour_error_pct"]["mean"]
        cells[name] = "-" if not s["matched"] else f"{pct:.3g}" + "".join(f", {s[k]} {k}" for k in ("missed", "spurious") if s[k])
    return cells


def row(glint, times, name, scene):
    before = held_out(glint, scene, [])
    seconds, model, verdict, flags = run([times, scene]).splitlines()[:4]
    word, first, end = (float(v) for v in seconds.split())
    words = flags.split()
    best = words[words.index("--model") + 1] if "--model" in words else model
    after = held_out(glint, scene, words if "--model" in words else [*words, "--model", model])[best] if words else ""
    return "| " + " | ".join([name, *(before[m] for m in MODELS), verdict, f"`{flags}`: {after}" if words else "",
                              f"{word:.1f} s", f"{first:.1f} s" if words else "", f"{end:.0f} s"]) + " |"


def table(glint, times, sequences):
    lines = ["| sequence | " + " | ".join(MODELS) + " | verdict | after the first remedy | first word | first remedy | all |",
             "|---|" + "---|" * (len(MODELS) + 5)]
    return "\n".join(lines + [row(glint, times, name, scene) for name, scene in sequences.items()])


def picture(inspector):
    """The window after *Find out why*: what its button does, the menu's action does, too."""
    target = ROOT / "docs/pictures/debugging-vase.png"
    run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24 -noreset", "env", "QT_QPA_PLATFORM=xcb", "LIBGL_ALWAYS_SOFTWARE=1",
         inspector,
         ROOT / "sessions/vase", "--theme", "dark", "--size", "1500x940", "--run", "plots.diagnose", "--screenshot", target,
         "--wait-idle"])
    run(["mogrify", "-strip", "-colors", "128", "-define", "png:compression-level=9", target])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", required=True, type=pathlib.Path)
    parser.add_argument("--times", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if bool(options.times) == bool(options.pictures):
        parser.error("give either --times or --pictures")
    if options.pictures:
        return picture(options.pictures.resolve())
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        os.makedirs(folder, exist_ok=True)
        glint = options.glint.resolve()
        sequences = {"ears": make(glint, folder)}
        for name, scene in {"vase": ROOT / "sessions/vase", "torus": SHARED / "cycles/torus", "panel": SHARED / "ladder/panel",
                            "plastic": SHARED / "ladder/plastic"}.items():
            if (scene / "scene.json").exists():
                sequences[name] = scene / "scene.json"
        text = table(glint, options.times.resolve(), sequences)
    if not options.write:
        print(text)
        return
    page = PAGE.read_text()
    mark = re.compile(r"(<!-- table -->\n).*?(\n<!-- end -->)", re.S)
    if not mark.search(page):
        raise Failed("docs/debugging.md has no place for the table")
    PAGE.write_text(mark.sub(lambda m: m[1] + text + m[2], page))


try:
    main()
except Failed as failure:
    sys.exit(f"make_debugging.py: {failure}")
