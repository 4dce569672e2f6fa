#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Time of `glint predict --stream` from the end of a pose's line to its contours, and through both pipes, on a mesh of a million
triangles: poses of an orbit, one after the other, the first 20 not counted. Prints a Markdown row for each setting: the medians
and the 99th percentiles.

    bench/measure_stream.py build/release/bin/glint [--poses N] [--preset NAME] [--moving]

The photographs are those of sessions/ellipsoid. The settings are what the preset `balanced` is in docs/tradeoff.md, of the mesh of a million
triangles and of the vase, without and with standard deviations (predict.band); --preset measures the trade-off of this very scene first (minutes),
and takes that preset. --moving turns the object by a degree before each pose. Exit code 1 when a median without them is above a millisecond."""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "resources" / "examples")]
from large_scene import COLUMNS, ROWS, large_mesh  # noqa: E402
from play_poses import Glint  # noqa: E402

SETTINGS = [("limit-angle, contour star", ["--model", "limit-angle", "--set", "predict.contour=star"]),
            ("canonical", ["--model", "canonical"])]
BANDS = [(title + ", bands", [*options, "--set", "predict.band=true"]) for title, options in SETTINGS]
RADIUS, HEIGHT, FROM, TO = 2.0, 0.9, -2.2, 0.8  # of the orbit of sessions/ellipsoid
WARM_UP = 20
MOST_US = 1000


def looking_at_centre(angle):
    """A camera on the orbit of sessions/ellipsoid/spec.json, y down."""
    eye = [RADIUS * math.cos(angle), RADIUS * math.sin(angle), HEIGHT]
    norm = math.dist(eye, [0, 0, 0])
    forward = [-x / norm for x in eye]
    right = [forward[1], -forward[0], 0]
    length = math.hypot(*right)
    right = [x / length for x in right]
    down = [forward[1] * right[2] - forward[2] * right[1], forward[2] * right[0] - forward[0] * right[2],
            forward[0] * right[1] - forward[1] * right[0]]
    rows = [right, down, forward]
    return [row + [-sum(a * b for a, b in zip(row, eye))] for row in rows] + [[0, 0, 0, 1]]


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def turned(degrees):
    """The object about the world's z axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def measure(program, session, more, poses, moving=False):
    glint = Glint(program, str(session), more)
    inside, outside, highlights = [], [], 0
    for n in range(WARM_UP + poses):
        pose = {"id": "live-%d" % n, "time": n / 30, "camera_from_world": looking_at_centre(FROM + (TO - FROM) * (n % 97) / 97)}
        if moving:
            pose["world_from_object"] = turned(n)
        start = time.perf_counter()
        answer = glint.answer(pose)
        seconds = time.perf_counter() - start
        if n < WARM_UP:
            continue
        inside.append(answer["time_us"])
        outside.append(seconds * 1e6)
        highlights += len(answer["highlights"])
    glint.close()
    return inside, outside, highlights


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("glint")
    parser.add_argument("--poses", type=int, default=300)
    parser.add_argument("--preset")
    parser.add_argument("--moving", action="store_true")
    arguments = parser.parse_args()
    slow = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = large_mesh(folder)
        runs = []
        if arguments.preset:
            session = folder / "tradeoff.glint"
            subprocess.run([arguments.glint, "tradeoff", str(scene), "--train", "spread:6", "-o", str(session)], check=True,
                           stdout=subprocess.DEVNULL)
            runs.append(("preset " + arguments.preset, session, ["--preset", arguments.preset]))
        else:
            for number, (title, options) in enumerate(SETTINGS + BANDS):
                session = folder / ("%d.glint" % number)
                subprocess.run([arguments.glint, "reconstruct", str(scene), "--train", "spread:6", *options, "-o", str(session)],
                               check=True,
                               stdout=subprocess.DEVNULL)
                runs.append((title, session, []))
        print("| settings | triangles | poses | highlights | line to contours, median us | 99 % us | through both pipes, median us | 99 % us |")
        print("|---|---|---|---|---|---|---|---|")
        for title, session, more in runs:
            inside, outside, highlights = measure(arguments.glint, session, more, arguments.poses, arguments.moving)
            print("| %s | %d | %d | %d | %.0f | %.0f | %.0f | %.0f |" % (
                title, 2 * ROWS * COLUMNS, len(inside), highlights, percentile(inside, 0.5), percentile(inside, 0.99),
                percentile(outside, 0.5), percentile(outside, 0.99)))
            bars = not title.endswith(", bands")
            slow = slow or highlights == 0 or (bars and percentile(inside, 0.5) > MOST_US)
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
