#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What `glint info` says of captures that were made wrong on purpose, 40 of them and some more, and of 20 right ones.

run.py GLINT DATA SESSIONS [--only WORD] [--part K/N]

Right captures become wrong ones by what people do (mistakes.py) and are written as scene files, COLMAP models and nerfstudio folders without Glint. A wrong
one passes where `info` names the cause, or says that nothing fits; a right one where it finds nothing. Prints a line for each, with its processor time.
Exit code: 0 all passed, 1 one failed, 77 there is no such data.
"""
import argparse
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import mistakes as m
from capture import WRITERS, read_scene, read_transforms

NOTHING = "no light explains"
AWAY = "do not see their surface"
ELSEWHERE = ("of the capture", "sparse points")  # a finding about them
WRONG_SECONDS, RIGHT_SECONDS = 10, 3


def turned_mesh(axis):
    return f"degrees about its {axis} axis"


# base, writer, mistake, and the words of which one must be said
WRONG = [
    ("report", "mesh", m.turned(0, -90), ["y up against z up"]),
    ("report", "nerfstudio", m.turned(0, 90), ["y up against z up"]),
    ("report", "colmap", m.turned(1, 90), [turned_mesh("y"), "moved to where the sparse points show it"]),
    ("report", "mesh", m.turned(2, -90), [turned_mesh("z")]),
    ("torus", "mesh", m.turned(0, 90), ["y up against z up"]),
    ("torus", "nerfstudio", m.turned(1, -90), [turned_mesh("y"), turned_mesh("x")]),  # which differ by a turn about its own axis
    ("vase", "mesh", m.turned(0, -90), ["y up against z up"]),
    ("vase", "colmap", m.turned(1, 90), [turned_mesh("y"), turned_mesh("x"), "moved to where the sparse points show it"]),
    ("plastic", "nerfstudio", m.turned(0, -90), ["y up against z up"]),
    ("plastic", "colmap", m.turned(2, 90), [turned_mesh("z"), "moved to where the sparse points show it"]),
    ("report", "mesh", m.scaled(1000), ["in millimetres"]),
    ("report", "colmap", m.scaled(100), ["in centimetres", "moved to where the sparse points show it"]),
    ("torus", "nerfstudio", m.scaled(1 / 0.0254), ["in inches"]),
    ("plastic", "mesh", m.scaled(1 / 0.3048), ["in feet"]),
    ("ellipsoid", "mesh", m.scaled(100), ["in centimetres"]),
    ("report", "nerfstudio", m.poses_in(1000), ["poses are in millimetres"]),
    ("vase", "mesh", m.poses_in(100), ["poses are in centimetres"]),
    ("report", "nerfstudio", m.halved(), ["half as large"]),
    ("plastic", "colmap", m.halved(True), ["half as large", *ELSEWHERE]),
    ("torus", "mesh", m.scaled(2), ["twice as large"]),
    ("report", "mesh", m.shifted(0.25, 0, 0), ["the mesh seems to be shifted by"]),
    ("vase", "nerfstudio", m.shifted(0, 0.1, 0), ["the mesh seems to be shifted by"]),
    ("torus", "colmap", m.shifted(0, 0, 0.3), [NOTHING, *ELSEWHERE]),
    ("ellipsoid", "nerfstudio", m.shifted(0.1, 0.1, 0), ["the mesh seems to be shifted by"]),
    ("report", "mesh", m.other_mesh("box"), [NOTHING]),
    ("plastic", "nerfstudio", m.other_mesh("pear"), [NOTHING]),
    ("torus", "mesh", m.other_mesh("lying"), [NOTHING]),
    ("ellipsoid", "colmap", m.other_mesh("box"), [NOTHING, *ELSEWHERE]),
    ("report", "mesh", m.mirrored, ["mirrored left-right"]),
    ("torus", "nerfstudio", m.upside_down, ["mirrored upside down"]),
    ("plastic", "colmap", m.turned_180, ["turned by 180 degrees"]),
    ("report", "nerfstudio", m.turned_90, ["turned by 90 degrees", "frames have a file that cannot be used"]),
    ("report", "nerfstudio", m.inverse_poses, ["camera to world"]),
    ("plastic", "mesh", m.opengl_axes, ["OpenGL"]),
    ("vase", "colmap", m.inverse_opengl, ["OpenGL", "sparse points"]),
    ("torus", "mesh", m.order_of_poses(2), [NOTHING]),
    ("plastic", "mesh", m.focal(1.3), [NOTHING, "focal length"]),
    ("report", "colmap", m.focal(0.7), [NOTHING, "focal length", *ELSEWHERE]),
    ("report", "nerfstudio", m.no_highlight, ["no highlight was found", NOTHING]),
    ("report", "mesh", m.other_mesh("flat"), [NOTHING]),
    ("ellipsoid", "mesh", m.shifted(0.03, 0.02, 0), ["the mesh seems to be shifted by"]),
    ("board", "mesh", m.scaled(1 / 0.3048), ["in feet"]),
    ("vase", "nerfstudio", m.turned(0, 180), ["turned by 180 degrees about its x axis"]),
    ("linear", "mesh", m.swapped(2, 7), ["share one lamp; those of 1 do not"]),
    ("linear", "mesh", m.scaled(1.1), ["one light explains the highlights of 8 frames poorly"]),
    ("plastic", "mesh", m.shifted(0, 0.02, 0), ["poorly"]),
    ("plastic", "nerfstudio", m.shifted(0.02, 0, 0), ["the mesh seems to be shifted by"]),
    ("sphere", "mesh", m.scaled(1000), ["in millimetres", "cameras are inside the surface"]),
    ("report", "mesh", m.mostly_dark, ["show no highlight"]),
]
RIGHT = [(base, writer, None, []) for base, writer in [
    ("report", "mesh"), ("report", "colmap"), ("report", "nerfstudio"), ("plastic", "mesh"), ("plastic", "colmap"), ("panel", "nerfstudio"),
    ("board", "mesh"), ("board", "nerfstudio"), ("torus", "mesh"), ("torus", "colmap"), ("ellipsoid", "mesh"), ("ellipsoid", "colmap"),
    ("vase", "mesh"), ("vase", "nerfstudio"), ("lobes", "colmap"), ("lobes", "nerfstudio"), ("ceiling", "mesh"), ("ceiling", "nerfstudio"),
    ("sphere", "nerfstudio"), ("linear", "mesh")]]  # fmt: skip
# Right ones whose lamp moves with the camera, of which this must be said and nothing be found.
CARRIED = [("flash", "nerfstudio", None, ["the lamp moves with the camera"]), ("turntable", "colmap", None, ["the lamp moves with the camera"])]


class Bases:
    """Right captures of other programs and of the shipped sessions, read once."""

    def __init__(self, data, sessions):
        scenes = {name: data / "ladder" / name for name in ("plastic", "panel", "board", "ceiling", "flash", "turntable")}
        scenes |= {"torus": data / "cycles" / "torus", "sphere": data / "cycles" / "sphere", "ellipsoid": sessions / "ellipsoid"}
        scenes |= {"vase": sessions / "vase", "lobes": data / "exact" / "coat", "linear": data / "exact" / "lin8_unstated"}
        self.readers = {name: lambda folder=folder: read_scene(folder) for name, folder in scenes.items()}
        self.readers["report"] = lambda: m.turned(0, 90)(read_transforms(data / "reports" / "mesh-y-up"))  # whose fault is undone
        self.known = {}

    def __getitem__(self, name):
        if name not in self.known:
            self.known[name] = self.readers[name]()
        right = self.known[name].copy()
        right.points = None  # those of its own mesh
        return right


def asked(glint, capture, writer):
    """What `info` finds, and its processor time in seconds."""
    with tempfile.TemporaryDirectory() as scratch:
        given = WRITERS[writer](capture, pathlib.Path(scratch) / "capture")
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([glint, "info", str(given)], capture_output=True, text=True, timeout=600)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return [line for line in done.stdout.splitlines() if line.startswith("finding: ")], seconds, done.stdout + done.stderr


def main():
    parser = argparse.ArgumentParser()
    for name in ("glint", "data", "sessions"):
        parser.add_argument(name)
    parser.add_argument("--only", default="", help="cases whose line contains this word")
    parser.add_argument("--part", default="0/1", help="K/N: every N-th case from the K-th on")
    a = parser.parse_args()
    if not pathlib.Path(a.data, "ladder").is_dir():
        print("no data beside the project; skipped")
        return 77
    bases, failed, slow = Bases(pathlib.Path(a.data), pathlib.Path(a.sessions)), [], []
    names = {value: name for name, value in vars(m).items() if callable(value)}
    assert len(WRONG) >= 40 and len(RIGHT) == 20
    part, parts = map(int, a.part.split("/"))
    for number, (base, writer, mistake, words) in enumerate([*WRONG, *RIGHT, *CARRIED]):
        wrong = number < len(WRONG)
        label = f"{number:2d} {base:10s}{writer:11s}{names.get(mistake, '') or (getattr(mistake, '__qualname__', 'as it is')).split('.')[0]:15s}"
        if number % parts != part or a.only not in label:
            continue
        right = bases[base]
        findings, seconds, text = asked(a.glint, (mistake or (lambda c: c))(right), writer)
        good = any(w in line for w in words for line in findings) if wrong else not findings and all(w in text for w in ["no problems found", *words])
        if not good:
            failed.append(label)
        if seconds > (WRONG_SECONDS if wrong else RIGHT_SECONDS):
            slow.append(label)
        print(f"{'ok    ' if good else 'FAILED'} {label}{seconds:5.1f} s  {' | '.join(findings)[:400] or text.splitlines()[-1][:200]}", flush=True)
    print(f"{len(failed)} failed; {len(slow)} took more than {WRONG_SECONDS} s (wrong) or {RIGHT_SECONDS} s (right) of processor time")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
