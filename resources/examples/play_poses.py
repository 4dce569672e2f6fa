#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plays the poses of a session's scene through `glint predict --stream`, one after the other, as a tracker does, and says how long
each answer took. --check compares the contours with those of `glint predict --json`: exit code 1 when they differ by more than
1e-9 px (TUM lines: 1e-6 px). Needs Python alone."""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import time

MOST_PX = 1e-9
MOST_TUM_PX = 1e-6  # a pose that became a quaternion and back is another one in its last digits


class Glint:
    """One running `glint predict --stream`: a pose in, an answer out."""

    def __init__(self, program, session, more):
        self.process = subprocess.Popen([program, "predict", session, "--stream", *more], text=True, encoding="utf-8",
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def answer(self, pose):
        self.process.stdin.write((pose if isinstance(pose, str) else json.dumps(pose)) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            sys.exit("glint ended with exit code %d" % self.process.wait())
        return json.loads(line)

    def close(self):
        self.process.stdin.close()
        return self.process.wait()


def tum_line(stamp, pose):
    """TUM writes where the camera is: the inverse of camera_from_world, as a position and a quaternion with w last."""
    r = [row[:3] for row in pose[:3]]
    t = [row[3] for row in pose[:3]]
    centre = [-sum(r[k][i] * t[k] for k in range(3)) for i in range(3)]
    m = [[r[k][i] for k in range(3)] for i in range(3)]  # world from camera
    # The largest of the four squares is the one that loses no digits (Shepperd, 1978).
    squares = [m[0][0] - m[1][1] - m[2][2], m[1][1] - m[0][0] - m[2][2], m[2][2] - m[0][0] - m[1][1], m[0][0] + m[1][1] + m[2][2]]
    most = squares.index(max(squares))
    s = 2 * math.sqrt(1 + squares[most])
    if most == 3:
        q = [(m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s, s / 4]
    else:
        i, j, k = most, (most + 1) % 3, (most + 2) % 3
        q = [0.0, 0.0, 0.0, (m[k][j] - m[j][k]) / s]
        q[i], q[j], q[k] = s / 4, (m[j][i] + m[i][j]) / s, (m[k][i] + m[i][k]) / s
    return " ".join(repr(v) for v in [stamp, *centre, *q])


def farthest(answer, predictions, frame):
    """Largest distance between the vertices of an answer and those of `predict --json`; infinity where their number differs."""
    expected = [(row["light"], model, h) for model, rows in predictions["models"].items()
                for row in rows if row["index"] == frame for h in row["highlights"]]
    if [(light, model) for light, model, _ in expected] != [(h["light"], h["model"]) for h in answer["highlights"]]:
        return math.inf
    worst = 0.0
    for (_, _, want), got in zip(expected, answer["highlights"]):
        if len(want["contour"]) != len(got["contour"]) or want["coverage"] != got["coverage"]:
            return math.inf
        for p, q in zip([want["peak"], *want["contour"]], [got["peak"], *got["contour"]]):
            worst = max(worst, math.dist(p, q))
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("session", help="a session whose input is a scene.json")
    parser.add_argument("--glint", default="glint", help="the program (default: the one on the path)")
    parser.add_argument("--tum", action="store_true", help="send TUM lines instead of JSON")
    parser.add_argument("--check", action="store_true", help="compare with `glint predict --json`")
    parser.add_argument("--preset", help="passed on")
    arguments = parser.parse_args()
    session = pathlib.Path(arguments.session)
    scene = json.loads((session.parent / json.loads(session.read_text("utf-8"))["input"]["path"]).read_text("utf-8"))
    more = ["--preset", arguments.preset] if arguments.preset else []
    predictions = None
    if arguments.check:
        predictions = json.loads(subprocess.run([arguments.glint, "predict", str(session), "--json", "-", *more], check=True,
                                                stdout=subprocess.PIPE).stdout)
    glint = Glint(arguments.glint, str(session), more)
    worst, highlights, inside, outside = 0.0, 0, [], []
    for number, frame in enumerate(scene["frames"]):
        pose = {"id": frame["id"], "time": number / 30, "camera_from_world": frame["camera_from_world"]}
        start = time.perf_counter()
        answer = glint.answer(tum_line(number / 30, frame["camera_from_world"]) if arguments.tum else pose)
        outside.append((time.perf_counter() - start) * 1e6)
        inside.append(answer["time_us"])
        highlights += len(answer["highlights"])
        if answer["status"] == "error":
            sys.exit("frame %s: %s" % (frame["id"], answer["reason"]))
        if predictions:
            worst = max(worst, farthest(answer, predictions, number))
    code = glint.close()
    middle = len(inside) // 2
    print("%d poses, %d highlights; from pose to contour %.0f us (median), with both pipes %.0f us" %
          (len(inside), highlights, sorted(inside)[middle], sorted(outside)[middle]))
    if predictions:
        print("farthest vertex from `predict --json`: %.3g px" % worst)
    if not highlights:
        sys.exit("no highlight in any answer")
    return code or (1 if worst > (MOST_TUM_PX if arguments.tum else MOST_PX) else 0)


if __name__ == "__main__":
    sys.exit(main())
