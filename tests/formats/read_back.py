#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does glint read what write_scene.py wrote? Converts every case to a scene file and compares that with truth.json.

  tests/formats/read_back.py GLINT FOLDER [--case NAME ...]      exit code 1 where one differs or is not read
  tests/formats/read_back.py GLINT FOLDER --expect-difference    exit code 1 where one agrees: for write_scene.py --wrong

Compared are ids and order of frames, the files of photographs and depth, the depth scale, lenses, the cameras' centres, and the
pixels of ten points through the camera that was read. Scene files are left in FOLDER/read_back.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

CENTRE_TOLERANCE = 1e-9  # of the scene's size: the digits of the files say more, inverting a pose loses a few ulp
PIXEL_TOLERANCE = 1e-6
SCALE_TOLERANCE = 1e-12  # relative: a product of two doubles or so
NO_LENS = {"OPENCV", "FULL_OPENCV", "SIMPLE_RADIAL", "RADIAL", "VISUALSFM"}  # bend nothing when their parameters are 0
MOST_LINES = 8  # of complaints about a case


def centre_of(pose):
    return [-math.fsum(pose[k][i] * pose[k][3] for k in range(3)) for i in range(3)]


def pixel_of(camera, pose, point):
    x, y, z = (math.fsum([*(a * b for a, b in zip(row, point)), row[3]]) for row in pose[:3])
    return [(camera["fx"] * x + camera.get("skew", 0.0) * y) / z + camera["cx"], camera["fy"] * y / z + camera["cy"]]


def distance(a, b):
    return math.dist(a, b) if all(map(math.isfinite, [*a, *b])) else math.inf


def file_complaint(kind, named, expected, folder, root):
    """Nothing, or why the file that the scene names is not the one that was written."""
    if expected is None:
        return f"has a {kind} that nobody wrote: {named}" if named else None
    if not named:
        return f"names no {kind}"
    place = folder / named
    if not place.exists():
        return f"{kind} {named} is not there"
    return None if place.samefile(root / expected) else f"{kind} is {named}, not {expected}"


def complaints_of(frame, camera, truth, case, folder, root):
    """What is wrong with a frame besides numbers."""
    found = [file_complaint(kind, frame.get(kind), truth[kind], folder, root) for kind in ("image", "depth")]
    if truth["depth"]:
        scale = frame.get("depth_scale", math.nan)
        if not abs(scale - case["depth_scale"]) <= SCALE_TOLERANCE * case["depth_scale"]:
            found.append(f"depth_scale {scale:.17g}, not {case['depth_scale']:.17g}")
    if camera.get("model", "OPENCV") not in NO_LENS or any(camera.get("distortion", [])):
        found.append(f"has a lens: {camera.get('model', 'OPENCV')} {camera.get('distortion')}")
    width, height = (round(2 * truth["K"][i][2] + 1) for i in range(2))  # the principal point is the middle
    if (camera["width"], camera["height"]) != (width, height):
        found.append(f"is {camera['width']} x {camera['height']}, not {width} x {height}")
    return [f"{truth['id']}: {text}" for text in found if text]


def compare(scene, case, folder, root):
    """Largest error of a centre (of the scene's size), of a pixel, and complaints, one line each."""
    ids, expected = [f["id"] for f in scene["frames"]], [f["id"] for f in case["frames"]]
    complaints = []
    if ids != expected:
        what = "in another order" if sorted(ids) == sorted(expected) else "are others"
        complaints.append(f"frames {what}: {' '.join(ids)}, expected {' '.join(expected)}")
    frames = {f["id"]: f for f in scene["frames"]}
    centre_error = pixel_error = 0.0
    for truth in case["frames"]:
        frame = frames.get(truth["id"])
        if frame is None:
            continue
        camera, pose = frame.get("camera", scene.get("camera")), frame["camera_from_world"]
        complaints += complaints_of(frame, camera, truth, case, folder, root)
        centre_error = max(centre_error, distance(centre_of(pose), truth["centre"]) / case["size"])
        for point, pixel in zip(case["points"], truth["pixels"]):
            pixel_error = max(pixel_error, distance(pixel_of(camera, pose, point), pixel))
    if not centre_error <= CENTRE_TOLERANCE:
        complaints.append(f"centres are off by up to {centre_error:.3g} of the scene's size")
    if not pixel_error <= PIXEL_TOLERANCE:
        complaints.append(f"pixels are off by up to {pixel_error:.3g}")
    return centre_error, pixel_error, complaints


def converted(glint, case, root, output):
    """The scene that glint makes of a case, or its words why not."""
    output.parent.mkdir(exist_ok=True)
    output.unlink(missing_ok=True)  # what an earlier run left must not be mistaken for this one's
    arguments = [str(root / a["file"]) if isinstance(a, dict) else a for a in case["arguments"]]
    command = [glint, "convert", str(root / case["input"]), "-o", str(output), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace", check=False)
    if done.returncode:
        return None, [f"exit code {done.returncode} of: {' '.join(command)}", *done.stderr.strip().splitlines()]
    return json.loads(output.read_text(encoding="utf-8")), []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("glint")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--case", action="append", dest="cases")
    parser.add_argument("--expect-difference", action="store_true")
    a = parser.parse_args()
    root = a.folder.resolve()
    cases = json.loads((root / "truth.json").read_text())["cases"]
    if unknown := set(a.cases or []) - set(cases):
        parser.error(f"no case {', '.join(sorted(unknown))} in truth.json; there are {', '.join(cases)}")
    failed = False
    print(f"{'case':20} {'frames':>6} {'centres':>9} {'pixels':>9}")
    for name in a.cases or cases:
        output = root / "read_back" / f"{name}.json"
        scene, complaints = converted(a.glint, cases[name], root, output)
        if scene:
            centre, pixel, complaints = compare(scene, cases[name], output.parent, root)
            print(f"{name:20} {len(scene['frames']):6} {centre:9.2g} {pixel:9.2g}  {'differs' if complaints else 'agrees'}")
        else:
            print(f"{name:20} {'':6} {'':9} {'':9}  not read")
        print("".join(f"  {line}\n" for line in complaints[:MOST_LINES]), end="")
        if len(complaints) > MOST_LINES:
            print(f"  and {len(complaints) - MOST_LINES} more lines")
        # A mistake must be seen in what was read: a case that is not read at all proves nothing.
        failed |= scene is None or bool(complaints) != a.expect_difference
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
