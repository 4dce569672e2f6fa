#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does the correction that `glint info` proposes give back the scene, or the mesh, that was written?

  tests/formats/fixes.py GLINT FOLDER       FOLDER: what write_scene.py wrote with --wrong for one mistake

Takes the fix that info proposes, lets `glint convert --fix` make it, compares cameras and depth scales with truth.json as
read_back.py does, and asks info about the corrected scene: it must find nothing.
"""
import json
import math
import pathlib
import struct
import subprocess
import sys

from exact_scene import add, ellipsoid_mesh, length, product, rotation_of, scaled, sub, times, transposed
from read_back import compare


def report_of(glint, path):
    run = subprocess.run([glint, "info", str(path), "--json", "-"], capture_output=True, text=True, timeout=300, check=False)
    if not run.stdout.startswith("{"):
        sys.exit(f"glint info ended with {run.returncode}: {run.stderr.strip()}")
    return json.loads(run.stdout)


def turned_onto_itself(rotation):
    """Whether it turns an ellipsoid about its own axes onto itself: no turn, or half a one."""
    return all(abs(abs(rotation[i][k]) - (i == k)) < 0.02 for i in range(3) for k in range(3))


def complaints_about_similarity(fix, corrected, root):
    """The mesh is in its own frame, with the points on the true ellipsoid and the facets a thousandth of its size inside of it: so much
    may be missing. Four turns of an ellipsoid are one surface."""
    tolerance = 3e-3
    truth = json.loads((root / "truth.json").read_text())
    centre, axes = truth["ellipsoid"]["centre"], truth["ellipsoid"]["world_from_ellipsoid"]
    scale, *numbers = map(float, fix.split("=")[1].split(","))
    turn, shift = numbers[:3], numbers[3:]
    angle = length(turn)
    rotation = rotation_of(math.cos(angle / 2), *scaled(turn, math.sin(angle / 2) / angle if angle else 0.5))
    self_turn = product(transposed(axes), rotation)
    found = []
    if abs(scale - 1) > tolerance or length(sub(shift, centre)) > tolerance * length(truth["ellipsoid"]["semi_axes"]):
        found.append(f"scale {scale} and shift {shift}, not 1 and {centre}")
    if not turned_onto_itself(self_turn):
        found.append(f"the rotation is off by {self_turn}")
    # The corrected cameras, taken to the true world by the true place of the mesh and that self-turn, which the shape does not tell.
    back = [[round(x) for x in row] for row in self_turn]
    for frame in corrected["frames"]:
        pose = frame["camera_from_world"]
        centre_in_mesh = [-math.fsum(pose[k][i] * pose[k][3] for k in range(3)) for i in range(3)]
        expected = truth["images"][frame["id"]]["centre"]
        off = length(sub(add(centre, times(axes, times(back, centre_in_mesh))), expected)) / truth["size"]
        if off > 2 * tolerance:
            found.append(f"camera {frame['id']} is off by {off:.2g} of the scene's size")
    return found


def ply_doubles(path):
    """Vertices, normals and corners of the binary PLY that Glint writes: doubles, triangles."""
    header, _, data = path.read_bytes().partition(b"end_header\n")
    vertices, faces = (int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element"))
    rows = [struct.unpack_from("<6d", data, 48 * i) for i in range(vertices)]
    corners = [struct.unpack_from("<B3i", data, 48 * vertices + 13 * i)[1:] for i in range(faces)]
    if len(data) != 48 * vertices + 13 * faces:
        sys.exit(f"{path} has {len(data)} bytes of {vertices} vertices and {faces} triangles")
    return [row[:3] for row in rows], [row[3:] for row in rows], corners


def complaints_about_mesh(corrected, folder):
    """It must be the mesh that was written before its sides were turned."""
    right = ellipsoid_mesh()
    (surface,) = corrected["surfaces"].values()
    vertices, normals, corners = ply_doubles(folder / surface["mesh"])
    found = []
    if [tuple(v) for v in right.vertices] != vertices:
        found.append("vertices are others")
    if max(length(sub(a, b)) for a, b in zip(right.normals, normals)) > 1e-12:  # brought to length 1 once more
        found.append("normals are others")
    if [cycle(f) for f in right.faces] != [cycle(f) for f in corners]:
        found.append("facets are others")
    return found


def cycle(face):
    """The corners in their sense, from the smallest."""
    at = face.index(min(face))
    return tuple(face[at:] + face[:at])


def main():
    glint, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    (case,) = json.loads((root / "truth.json").read_text())["cases"].values()
    report = report_of(glint, root / case["input"])
    if len(report["fixes"]) != 1:
        sys.exit(f"expected one fix, got {report['fixes']} for {report['findings']}")
    fix = report["fixes"][0]["fix"]
    print(f"{report['findings'][report['fixes'][0]['finding']]}\n  --fix {fix}")
    output = root / "corrected.json"
    subprocess.run([glint, "convert", str(root / case["input"]), "--fix", fix, "-o", str(output)], check=True)
    if fix.startswith("mesh-similarity"):
        complaints = complaints_about_similarity(fix, json.loads(output.read_text(encoding="utf-8")), root)
    elif fix == "flip-faces":
        complaints = complaints_about_mesh(json.loads(output.read_text(encoding="utf-8")), output.parent)
    else:
        if fix.startswith("depth-scale"):
            case["depth_scale"] *= 5  # wrong_conventions.py: 1000 units for 5000
        centre, pixel, complaints = compare(json.loads(output.read_text(encoding="utf-8")), case, output.parent, root)
        print(f"centres {centre:.2g} of the scene's size, pixels {pixel:.2g}")
    complaints += report_of(glint, output)["findings"]
    print("\n".join(complaints) or "agrees")
    sys.exit(1 if complaints else 0)


main()
