#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes two sequences that are hard to fit, lets `glint diagnose` lead out of them, and writes the tables of docs/debugging.md.

Usage: docs/make_debugging.py --glint PROGRAM --times PROGRAM [--keep DIR] [--write]
       docs/make_debugging.py --glint PROGRAM --pictures INSPECTOR [--keep DIR]

Every command of the page is run; every figure is what one printed. The two sequences:
  unequal   an ellipsoid under a small and a wide lamp; no frame says which lamps are on
  ears      a body with two thin ears and a thin fin, as a mesh; two of 16 frames are hard to tell by eye
--times PROGRAM  diagnose_times of the same build (bench/): seconds until the first remedy
--keep DIR       leave the sequences there
--pictures FILE  draw the pictures of each step with this glint-inspector instead of the tables (needs xvfb-run and mogrify)
--write          put the tables into docs/debugging.md; else print them"""
import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/debugging.md"
CAMERA = {"width": 480, "height": 360, "fx": 600, "fy": 600, "cx": 239.5, "cy": 179.5}
ASK, TRY = "plots.diagnose", "plots.try-remedy"
STEPS = {"unequal": [ASK, TRY], "ears": [ASK, TRY, ASK, TRY]}
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
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {a}" for a in "xyz"), f"element face {len(faces)}",
             "property list uchar int vertex_indices", "end_header", *("%.17g %.17g %.17g" % v for v in vertices), *("3 %d %d %d" % f for f in faces)]
    file.write_text("\n".join(lines) + "\n")


def specifications(folder):
    render = {"reflectance": "torrance-sparrow", "roughness": 0.08, "diffuse": [0.6, 0.8, 1.2], "bits": 8, "samples": 2, "seed": 1}
    unequal = {"glint_scene": 1, "name": "unequal", "units": "m", "camera": CAMERA,
               "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.45, 0.3]}}},
               "lights": [{"id": "small", "position": [-1.0, -1.0, 2.0], "radius": 0.02}, {"id": "wide", "position": [1.3, -0.8, 1.8], "radius": 0.35}],
               "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.7, "from": -2.4, "to": -0.8, "height": 1.1, "count": 12}}, "render": render}
    turned = [ellipsoid((0.5, 0.42, 0.4), (0, 0, 0), ("x", 0)), ellipsoid((0.05, 0.03, 0.35), (0.2, 0, 0.55), ("y", 20)),
              ellipsoid((0.05, 0.03, 0.35), (-0.2, 0, 0.55), ("y", -20)), ellipsoid((0.25, 0.02, 0.12), (0, -0.45, 0), ("x", 15))]
    write_mesh(folder / "ears.ply", turned)
    ears = {"glint_scene": 1, "name": "ears", "units": "m", "camera": CAMERA, "surfaces": {"body": {"mesh": "ears.ply"}},
            "lights": [{"id": "lamp", "position": [1.2, -1.4, 2.2], "radius": 0.05}],
            "path": {"orbit": {"centre": [0, 0, 0.1], "radius": 3, "from": -110, "to": -30, "height": 0.9, "count": 16}},
            "render": {**render, "roughness": 0.12}}
    return {"unequal": unequal, "ears": ears}


class Failed(Exception):
    pass


def run(arguments, codes=(0,)):
    start = time.perf_counter()
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        raise Failed(f"{' '.join(map(str, arguments))}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout, time.perf_counter() - start


def make(glint, folder):
    """The sequences as a camera would leave them: photographs, poses, surface; nothing that only a synthesis knows."""
    scenes = {}
    for name, spec in specifications(folder).items():
        (folder / f"{name}.json").write_text(json.dumps(spec))
        run([glint, "synth", folder / f"{name}.json", "-o", folder / name])
        file = folder / name / "scene.json"
        scene = json.loads(file.read_text())
        for frame in scene["frames"]:
            for key in ("lights_on", "radiance", "mask", "highlights", "depth", "normals"):
                frame.pop(key, None)
        file.write_text(json.dumps(scene))
        scenes[name] = file
    return scenes


def held_out(glint, scene, flags):
    """Mean held-out error of the models, % of the diameter, and how many frames were predicted."""
    out, _ = run([glint, "evaluate", scene, *flags, "--json", "-"], codes=(0, 3))
    result = {}
    for name, model in json.loads(out)["models"].items():
        s = model["summary"]
        result[name] = (s["contour_error_pct"]["mean"], s["predicted"], s["frames"])
    return result


def shown(entry):
    pct, predicted, frames = entry
    return f"{pct:.3g} % ({predicted} of {frames})" if predicted and pct is not None else f"no answer (0 of {frames})"


def first_remedy(times, scene):
    """One sentence: how long a user of the inspector waits."""
    words = run([times, scene])[0].split(maxsplit=4)
    if words[4].strip() == "none":
        return f"*Find out why* finds no remedy; it ends after {words[3]} s."
    model, change = words[4].strip().split(": ", 1)
    return f"*Find out why* shows its first remedy after {words[1]} s (`{change}` for {model}) and ends after {words[3]} s."


def table(glint, times, name, scene):
    before = held_out(glint, scene, ["--models", ",".join(MODELS)])
    out, seconds = run([glint, "diagnose", scene, "--json", "-"], codes=(0, 3))
    diagnosis = json.loads(out)["models"]
    lines = [f"`glint diagnose {name}/scene.json` (all models): {seconds:.0f} s. On results that are there, {first_remedy(times, scene)}", "",
             "| model | status | held-out frames, before | first cause | best remedy | views that the fit did not see | held-out frames, after |",
             "|---|---|---|---|---|---|---|"]
    for model in MODELS:
        d = diagnosis[model]
        row = [model, d["status"], shown(before[model])]
        if d["status"] == "ok":
            lines.append("| " + " | ".join([*row, "", "", "", ""]) + " |")
            continue
        if not d["remedies"]:
            lines.append("| " + " | ".join([*row, d["cause"], "nothing helps", "", ""]) + " |")
            continue
        best = d["remedies"][0]
        flags = best["flags"].split()
        if "--model" not in flags:
            flags += ["--model", model]
        effect = best["effect"]
        after = held_out(glint, scene, flags)
        gain = f"{effect['after_pct']:.3g} %"
        gain = f"{effect['before_pct']:.3g} % to {gain}" if effect["answered_before"] else f"no prediction before, {gain} after"
        row += [d["cause"].replace("|", "/"), f"`{best['flags']}`", gain,
                shown(next(iter(after.values())))]
        lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines)


def pictures(inspector, name, scene):
    """The window after each step that the page tells: what its buttons do, the menu's actions do, too."""
    for step in range(1, len(STEPS[name]) + 1):
        target = ROOT / "docs/pictures" / f"debugging-{name}-{step}.png"
        run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24 -noreset", "env", "QT_QPA_PLATFORM=xcb", "LIBGL_ALWAYS_SOFTWARE=1", inspector, scene,
             "--theme", "dark", "--size", "1500x940", "--run", ",".join(STEPS[name][:step]), "--screenshot", target, "--wait-idle"])
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
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        os.makedirs(folder, exist_ok=True)
        scenes = make(options.glint.resolve(), folder)
        if options.pictures:
            for name, scene in scenes.items():
                pictures(options.pictures.resolve(), name, scene)
            return
        tables = {name: table(options.glint.resolve(), options.times.resolve(), name, scene) for name, scene in scenes.items()}
    if not options.write:
        print("\n\n".join(f"{name}\n\n{text}" for name, text in tables.items()))
        return
    page = PAGE.read_text()
    for name, text in tables.items():
        mark = re.compile(f"(<!-- {name} -->\n).*?(\n<!-- end -->)", re.S)
        if not mark.search(page):
            raise Failed(f"docs/debugging.md has no place for {name}")
        page = mark.sub(lambda m, text=text: m[1] + text + m[2], page)
    PAGE.write_text(page)


try:
    main()
except Failed as failure:
    sys.exit(f"make_debugging.py: {failure}")
