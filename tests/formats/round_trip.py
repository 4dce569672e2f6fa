#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What `glint convert` writes for other programs (transforms.json, COLMAP's text model), read back by Glint: the same cameras.

round_trip.py GLINT FOLDER WORK    FOLDER: a right scene of write_scene.py (scene.json); WORK: emptied and written
"""
import json
import pathlib
import shutil
import subprocess
import sys

TOLERANCE = 1e-12  # of elements of poses and of relative intrinsics: 17 digits are written


def glint(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"glint {' '.join(map(str, arguments))} ended with {done.returncode}: {done.stderr.strip()}")


def cameras(scene):
    found = {}
    for frame in scene["frames"]:
        camera = frame.get("camera", scene.get("camera"))
        numbers = [camera[k] / camera["width"] for k in ("fx", "fy", "cx", "cy")]
        numbers += [x for row in frame["camera_from_world"] for x in row]
        found[frame["id"]] = (camera["width"], camera["height"], numbers)
    return found


def main():
    program, folder, work = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3])
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(folder, work)
    wanted = cameras(json.loads((work / "scene.json").read_text()))
    failed = False
    for output, arguments in (("transforms.json", []), ("sparse", ["--as", "colmap"])):
        glint(program, "convert", work / "scene.json", "-o", work / output)
        back = work / "back.json"
        back.unlink(missing_ok=True)
        source = work / output if output.endswith(".json") else work
        glint(program, "convert", source, "-o", back, *arguments)
        got = cameras(json.loads(back.read_text()))
        worst = max((abs(a - b) for name in wanted for a, b in zip(wanted[name][2], got.get(name, (0, 0, []))[2])), default=1)
        same = set(got) == set(wanted) and all(got[n][:2] == wanted[n][:2] for n in wanted) and worst <= TOLERANCE
        print(f"{output:16} {len(got):3} frames, largest difference {worst:.2g}: {'agrees' if same else 'differs'}")
        failed |= not same
    sys.exit(1 if failed else 0)


main()
