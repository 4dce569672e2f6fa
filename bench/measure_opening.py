#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How long it takes from the start of the inspector to the first picture of a capture with many photographs.

    bench/measure_opening.py [--build build/release] [--frames 1410] [--runs 3]

A COLMAP text folder: cameras around an ellipsoid, a mesh of it, full-HD JPEG photographs that all show one rendered view (their content
does not count here; their number and size do). The files have just been written, so they are in memory. Software rendering on a
virtual display (xvfb-run). Prints a table in Markdown; each run is a program of its own.
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

from large_scene import write_ellipsoid

SEMI_AXES = [0.6, 0.35, 0.25]
CAMERA = {"width": 1920, "height": 1080, "fx": 2000, "fy": 2000, "cx": 959.5, "cy": 539.5}


def photograph(glint, folder):
    """One rendered photograph: its bytes, and the pose of its camera."""
    spec = {"glint_scene": 1, "name": "one", "units": "m", "camera": CAMERA,
            "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": SEMI_AXES}}},
            "lights": [{"id": "lamp", "position": [1.2, -1.0, 2.2]}],
            "path": {"orbit": {"centre": [0, 0, 0], "radius": 2.0, "from": -1.2, "to": -1.1, "height": 0.9, "count": 2}},
            "render": {"reflectance": "torrance-sparrow", "roughness": 0.1, "diffuse": 0.6, "bits": 8, "samples": 1,
                       "noise": 0.01, "seed": 1,
                       "jpeg_quality": 95}}
    (folder / "spec.json").write_text(json.dumps(spec))
    subprocess.run([glint, "synth", folder / "spec.json", "-o", folder / "one"], check=True, stdout=subprocess.DEVNULL)
    frame = json.loads((folder / "one/scene.json").read_text())["frames"][0]
    return (folder / "one" / frame["image"]).read_bytes(), frame["camera_from_world"]


def quaternion(m):
    """w x y z of a rotation; of those used here w is not near 0, or x, y or z is the largest."""
    squares = [1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2],
               1 - m[0][0] - m[1][1] + m[2][2]]
    wx, wy, wz = m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]
    xy, xz, yz = m[0][1] + m[1][0], m[0][2] + m[2][0], m[1][2] + m[2][1]
    k = max(range(4), key=lambda i: squares[i])
    row = [[squares[0], wx, wy, wz], [wx, squares[1], xy, xz], [wy, xy, squares[2], yz], [wz, xz, yz, squares[3]]][k]
    size = math.sqrt(sum(v * v for v in row))
    return [v / size for v in row]


def capture(folder, picture, pose, frames):
    """All cameras at nearly the place of the rendered one, so that every photograph is of the object."""
    (folder / "images").mkdir(parents=True)
    lines = []
    w, x, y, z = quaternion(pose)
    for i in range(frames):
        (folder / "images" / f"{i:05}.jpg").write_bytes(picture)
        t = [pose[r][3] for r in range(3)]
        t[0] += 1e-4 * i
        lines.append(f"{i + 1} {w!r} {x!r} {y!r} {z!r} {t[0]!r} {t[1]!r} {t[2]!r} 1 {i:05}.jpg\n\n")
    (folder / "images.txt").write_text("".join(lines))
    c = CAMERA
    (folder / "cameras.txt").write_text(f"1 PINHOLE {c['width']} {c['height']} {c['fx']} {c['fy']} {c['cx'] + 0.5} {c['cy'] + 0.5}\n")
    (folder / "points3D.txt").write_text("")
    write_ellipsoid(folder / "mesh.ply", SEMI_AXES)


def open_it(args, folder, scratch):
    environment = dict(os.environ, QT_QPA_PLATFORM="xcb", LIBGL_ALWAYS_SOFTWARE="1", XDG_DATA_HOME=scratch,
                       XDG_CONFIG_HOME=scratch)
    command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", args.build / "bin/bench_inspector", folder]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(done.stderr.strip() or done.stdout.strip())
    return json.loads(done.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default="build/release")
    parser.add_argument("--frames", type=int, default=1410)
    parser.add_argument("--runs", type=int, default=3)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        root = pathlib.Path(scratch)
        picture, pose = photograph(args.build / "bin/glint", root)
        capture(root / "capture", picture, pose, args.frames)
        runs = [open_it(args, root / "capture", scratch) for _ in range(args.runs)]
    size = len(picture) * args.frames / 1e6
    print(f"| {args.frames} photographs of 1920 x 1080, {size:.0f} MB, {args.runs} runs | median s | most s |\n|---|---|---|")
    for key, words in (("first_photograph_ms", "from the start to the first photograph"),
                       ("first_overlay_ms", "to its first overlay")):
        s = [r[key] / 1000 for r in runs]
        print(f"| {words} | {statistics.median(s):.2f} | {max(s):.2f} |")


if __name__ == "__main__":
    main()
