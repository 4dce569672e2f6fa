# SPDX-License-Identifier: BSD-3-Clause
"""A million triangles to measure on: an ellipsoid with vertex normals, as binary PLY."""
import array
import json
import math
import pathlib
import shutil
import sys

ROWS, COLUMNS = 500, 1000
IDENTITY = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def write_ellipsoid(file, semi_axes, world_from_surface=None):
    """2 x ROWS x COLUMNS triangles; semi-axes in m, world_from_surface a 4 x 4 pose."""
    pose = world_from_surface or IDENTITY
    vertices, faces = array.array("f"), bytearray()
    for i in range(ROWS + 1):
        for j in range(COLUMNS):
            t, p = math.pi * i / ROWS, 2 * math.pi * j / COLUMNS
            u = (math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t))
            local, normal = [a * x for a, x in zip(semi_axes, u)], [x / a for a, x in zip(semi_axes, u)]
            length = math.sqrt(sum(x * x for x in normal))
            vertices.extend(sum(pose[r][k] * local[k] for k in range(3)) + pose[r][3] for r in range(3))
            vertices.extend(sum(pose[r][k] * normal[k] for k in range(3)) / length for r in range(3))
    if sys.byteorder != "little":
        vertices.byteswap()
    count = 0
    for i in range(ROWS):
        for j in range(COLUMNS):
            a, b = i * COLUMNS + j, i * COLUMNS + (j + 1) % COLUMNS
            for triangle in ((a, a + COLUMNS, b), (b, a + COLUMNS, b + COLUMNS)):
                faces += b"\x03" + b"".join(v.to_bytes(4, "little") for v in triangle)
                count += 1
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {(ROWS + 1) * COLUMNS}\n" +
              "".join(f"property float {k}\n" for k in ("x", "y", "z", "nx", "ny", "nz")) +
              f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n")
    file.write_bytes(header.encode() + vertices.tobytes() + faces)


def large_mesh(folder):
    """The scene of sessions/ellipsoid with the ellipsoid as a mesh of a million triangles with vertex normals."""
    session = pathlib.Path(__file__).resolve().parent.parent / "sessions" / "ellipsoid"
    scene = json.loads((session / "scene.json").read_text("utf-8"))
    (name, surface), = scene["surfaces"].items()
    analytic = surface["analytic"]
    write_ellipsoid(folder / "body.ply", analytic["semi_axes"], analytic.get("world_from_surface"))
    scene["surfaces"] = {name: {"mesh": "body.ply"}}
    shutil.copytree(session / "frames", folder / "frames")
    (folder / "scene.json").write_text(json.dumps(scene), "utf-8")
    return folder / "scene.json"
