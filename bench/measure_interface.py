#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How long the inspector lets one wait: from its start to the first picture, and from a slider's movement to the overlay.

    bench/measure_interface.py [--build build/release] [--frames 100] [--events 100] [--page docs/inspector.md]

A million triangles, 100 cameras, a preset that `glint tradeoff` measures first, software rendering on a virtual
display (xvfb-run). Every slider is moved ten times a second whether the window keeps up or not, and a wait counts from the movement to the end
of the event that painted the first overlay for that position or a later one: the observed contour where the slider changes what is
observed, else those of the models, whose wait is listed beside it. Then a test tells for how long the interface stood still (STANDSTILLS),
several times over. --page writes the tables into the page.
"""
import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

from large_scene import write_ellipsoid

SLIDERS = [("predict.directions", "prediction"), ("predict.walk_tolerance", "prediction"), ("light.robust_px", "light and fit"),
           ("detect.level", "detection in every frame")]
SEMI_AXES = [0.6, 0.35, 0.25]
PRESETS = ["fast", "balanced"]
TELLING = ["detect.background", "fit.evidence"]  # what else says how much a preset computes
STANDSTILLS = {"opening": r"opening: .* at most (\d+) ms", "computing": r"computing: .* at most (\d+) ms",
               "first results": r"showing the first results: at most (\d+) ms",
               "another frame": r"another frame: at most (\d+) ms",
               "from *Stop* to the end of the run": r"stopped (?:while \w+ )?after (\d+) ms"}
STANDSTILL_TEST = ["session", "stopAndInterfaceOnAWholeSequence"]
RUNS = 5
BEGIN, END = "<!-- waits begin -->", "<!-- waits end -->"


def make_sessions(glint, folder, frames):
    spec = {"glint_scene": 1, "name": "million", "units": "m",
            "camera": {"width": 640, "height": 480, "fx": 800, "fy": 800, "cx": 319.5, "cy": 239.5},
            "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": SEMI_AXES}}},
            "lights": [{"id": "lamp", "position": [1.2, -1.0, 2.2]}],
            "path": {"orbit": {"centre": [0, 0, 0], "radius": 2.0, "from": -2.2, "to": 0.8, "height": 0.9, "count": frames}},
            "render": {"reflectance": "torrance-sparrow", "roughness": 0.1, "diffuse": [0.6, 0.8, 1.2], "bits": 8, "samples": 1}}
    (folder / "spec.json").write_text(json.dumps(spec))
    subprocess.run([glint, "synth", folder / "spec.json", "-o", folder], check=True, stdout=subprocess.DEVNULL)
    write_ellipsoid(folder / "body.ply", SEMI_AXES)
    scene = json.loads((folder / "scene.json").read_text())
    scene["surfaces"] = {"body": {"mesh": "body.ply"}}
    for frame in scene["frames"]:  # what a user has: photographs
        for key in ("highlights", "radiance", "depth", "normals", "mask"):
            frame.pop(key, None)
    (folder / "scene.json").write_text(json.dumps(scene))
    measured = folder / "tradeoff.glint"
    subprocess.run([glint, "tradeoff", folder / "scene.json", "--train", "spread:6", "--source", "image", "-o", measured],
                   check=True,
                   stdout=subprocess.DEVNULL)
    for preset in PRESETS:
        subprocess.run([glint, "reconstruct", measured, "--preset", preset, "-o", folder / f"{preset}.glint"], check=True,
                       stdout=subprocess.DEVNULL)


def on_display(command, scratch):
    environment = dict(os.environ, QT_QPA_PLATFORM="xcb", LIBGL_ALWAYS_SOFTWARE="1", XDG_DATA_HOME=scratch,
                       XDG_CONFIG_HOME=scratch)
    command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", *(str(c) for c in command)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(done.stderr.strip() or done.stdout.strip())
    return done


def standstills(args, scratch):
    found = {what: [] for what in STANDSTILLS}
    for _ in range(RUNS):
        done = on_display([args.build / "bin/test_gui", *STANDSTILL_TEST], scratch)
        for what, pattern in STANDSTILLS.items():
            found[what].append(max(int(ms) for ms in re.findall(pattern, done.stdout + done.stderr)))
    lines = [f"| {RUNS} runs on 60 rendered frames | median ms | most ms |", "|---|---|---|"]
    lines += [f"| {what} | {statistics.median(ms):.0f} | {max(ms)} |" for what, ms in found.items()]
    return "\n".join(lines)


def measured(args, session, preset, scratch):
    request = json.loads(session.read_text())["request"]
    asked = ", ".join([*request["models"], *(f"`{key} = {request['settings'][key]}`" for key in TELLING)])
    result = json.loads(on_display([args.build / "bin/bench_inspector", session, args.events,
                                    *(f"slider:{name}" for name, _ in SLIDERS)],
                                   scratch).stdout)
    lines = [f"Preset `{preset}` ({asked}): from the start to the first photograph {result['first_photograph_ms']:.0f} ms, to the "
             f"first overlay {result['first_overlay_ms']:.0f} ms, to everything {result['everything_ms']:.0f} ms.", "",
             "| slider | recomputes | positions | first overlay: median ms | 95 % ms | most ms | every model: median ms | 95 % ms |",
             "|---|---|---|---|---|---|---|---|"]
    for name, what in SLIDERS:
        s = result["sliders"][f"slider:{name}"]
        lines.append(f"| `{name}` | {what} | {s['answered']} | {s['median_ms']:.0f} | {s['p95_ms']:.0f} | {s['max_ms']:.0f} | "
                     f"{s['all_median_ms']:.0f} | {s['all_p95_ms']:.0f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default="build/release")
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--events", type=int, default=100)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the scene; used again when it is there")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = args.keep or pathlib.Path(scratch)
        folder.mkdir(exist_ok=True)
        if not (folder / f"{PRESETS[-1]}.glint").exists():
            make_sessions(args.build / "bin/glint", folder, args.frames)
        table = "\n\n".join(measured(args, folder / f"{preset}.glint", preset, scratch) for preset in PRESETS)
        table += ("\n\nHow long the interface stands still:\n\n" + standstills(args, scratch))
    print(table)
    if args.page:
        text = args.page.read_text()
        args.page.write_text(re.sub(re.escape(BEGIN) + ".*?" + re.escape(END), lambda _: f"{BEGIN}\n{table}\n{END}", text,
                                    flags=re.S))


if __name__ == "__main__":
    main()
