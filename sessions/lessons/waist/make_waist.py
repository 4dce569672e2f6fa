#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes waist.ply (a piece of a turned vase, binary, with exact normals) and spec.json in the folder that is given.

The radius is r(z) = r0 - a cos(2 pi z / period): a waist at z = 0, a belly below it. Where the profile turns from belly to waist
(z = -period / 4) the Gaussian curvature is 0: there the normal leans most, and highlights are born and split.
"""
import json
import math
import struct
import sys

R0, A, PERIOD = 0.22, 0.05, 0.6
FROM_Z, TO_Z, ROWS = -0.36, 0.28, 65
FROM_AZIMUTH, TO_AZIMUTH, COLUMNS = -152.0, -28.0, 42  # degrees: the side that the cameras see
ELEVATIONS = [25, 22, 20, 18, 17, 16, 13, 10, 6, 2]  # degrees, of the cameras


def unit(v):
    n = math.sqrt(sum(x * x for x in v))
    return [x / n for x in v]


def around(azimuth, elevation, distance):
    a, e = math.radians(azimuth), math.radians(elevation)
    return [distance * math.cos(e) * math.cos(a), distance * math.cos(e) * math.sin(a), distance * math.sin(e)]


def looking(eye, target):
    """camera_from_world: x right, y down, z forward; image up is world +z."""
    z = unit([t - e for t, e in zip(target, eye)])
    x = unit([z[1], -z[0], 0.0])
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return [[round(v, 12) for v in (*row, -sum(p * q for p, q in zip(row, eye)))] for row in (x, y, z)] + [[0, 0, 0, 1]]


def mesh(file):
    vertices, triangles = [], []
    for i in range(ROWS):
        z = FROM_Z + (TO_Z - FROM_Z) * i / (ROWS - 1)
        r = R0 - A * math.cos(2 * math.pi * z / PERIOD)
        slope = A * 2 * math.pi / PERIOD * math.sin(2 * math.pi * z / PERIOD)
        for j in range(COLUMNS):
            a = math.radians(FROM_AZIMUTH + (TO_AZIMUTH - FROM_AZIMUTH) * j / (COLUMNS - 1))
            vertices.append((r * math.cos(a), r * math.sin(a), z, *unit([math.cos(a), math.sin(a), -slope])))
    for i in range(ROWS - 1):
        for j in range(COLUMNS - 1):
            k = i * COLUMNS + j
            triangles += [(k, k + 1, k + COLUMNS + 1), (k, k + COLUMNS + 1, k + COLUMNS)]
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
              f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    with open(file, "wb") as out:
        out.write(header.encode())
        for v in vertices:
            out.write(struct.pack("<6f", *v))
        for t in triangles:
            out.write(struct.pack("<B3i", 3, *t))


def main():
    folder = sys.argv[1]
    mesh(folder + "/waist.ply")
    target = [0.0, -0.15, -0.13]
    cameras = [looking([t + p for t, p in zip(target, around(-110, e, 1.25))], target) for e in ELEVATIONS]
    spec = {"glint_scene": 1, "name": "waist", "units": "m",
            "camera": {"width": 320, "height": 240, "fx": 640, "fy": 640, "cx": 159.5, "cy": 119.5},
            "surfaces": {"vase": {"mesh": "waist.ply"}},
            "lights": [{"id": "lamp", "position": [round(v, 3) for v in around(-70, 22, 2.2)]}],
            "path": {"cameras": cameras}, "contour": "limit-angle", "limit_angle_deg": 4.7703,
            "render": {"reflectance": "torrance-sparrow", "roughness": 0.1, "specular": 0.2, "diffuse": [0.9, 0.8, 0.7],
                       "bits": 8, "samples": 2, "seed": 1}}
    with open(folder + "/spec.json", "w") as out:
        out.write("{\n" + ",\n".join(f"  {json.dumps(k)}: {json.dumps(v)}" for k, v in spec.items()) + "\n}\n")


main()
