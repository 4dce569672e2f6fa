# SPDX-License-Identifier: BSD-3-Clause
"""Blender's meshes as PLY files, and the analytic surfaces of Glint as meshes."""
import hashlib
import math

import bpy
import numpy

from . import linear
from .failures import InputError

SINGLE = 4e-6  # of a size: single precision leaves 1e-7 of it in a matrix, more where an object is stretched along one side
KINDS = {"MESH", "CURVE", "SURFACE", "META", "FONT"}  # what Blender can turn into a mesh


def corner_normals(mesh):
    """Unit normals of all corners of faces, (n, 3), as Blender shades them: smooth, flat, by angle or custom."""
    normals = numpy.empty(len(mesh.loops) * 3, dtype=numpy.float32)
    if hasattr(mesh, "corner_normals"):  # from Blender 4.1 on
        mesh.corner_normals.foreach_get("vector", normals)
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals)
    return normals.reshape(-1, 3).astype(numpy.float64)


def motion(before, now):
    """The rigid 4x4 that carries every one of some objects from its matrix `before` to the one it has `now` (Blender's world); None where no single
    one does."""
    if before == now:
        return linear.identity()
    b, n = numpy.array(before), numpy.array(now)
    try:
        u, _, v = numpy.linalg.svd(n[0, :3, :3] @ numpy.linalg.inv(b[0, :3, :3]))
    except numpy.linalg.LinAlgError:  # a scale of 0
        return None
    m = numpy.eye(4)
    m[:3, :3] = u @ v
    m[:3, 3] = n[0, :3, 3] - m[:3, :3] @ b[0, :3, 3]
    size = numpy.abs(n[:, :3]).max(axis=1)  # of each column
    size = numpy.concatenate([size[:, :3].max(axis=1, keepdims=True).repeat(3, axis=1), size[:, 3:].clip(1e-3)], axis=1)
    fits = (numpy.abs(m @ b - n)[:, :3] <= SINGLE * size[:, None]).all()
    return m.tolist() if fits and numpy.linalg.det(m) > 0 else None


def triangles_of(object_, depsgraph, world, matrix):
    """Vertices (n, 3), normals (n, 3) and triangles (m, 3) of an object with its modifiers applied, where `matrix` puts it, in Glint's world, in
    double precision.

    A vertex whose corners have different normals (flat faces, sharp edges) becomes one vertex for each normal."""
    shown = object_.evaluated_get(depsgraph)
    mesh = shown.to_mesh()
    try:
        if mesh is None or not len(mesh.polygons):
            return numpy.empty((0, 3)), numpy.empty((0, 3)), numpy.empty((0, 3), dtype=numpy.int64)
        mesh.calc_loop_triangles()
        places = numpy.empty(len(mesh.vertices) * 3, dtype=numpy.float32)
        mesh.vertices.foreach_get("co", places)
        of_corner = numpy.empty(len(mesh.loops), dtype=numpy.int32)
        mesh.loops.foreach_get("vertex_index", of_corner)
        corners = numpy.empty(len(mesh.loop_triangles) * 3, dtype=numpy.int32)
        mesh.loop_triangles.foreach_get("loops", corners)
        normals = corner_normals(mesh)
    finally:
        shown.to_mesh_clear()
    matrix = numpy.array(matrix)
    turn = numpy.array(world.axes)
    places = places.reshape(-1, 3).astype(numpy.float64)
    places = (places @ matrix[:3, :3].T + matrix[:3, 3]) @ turn.T * world.scale
    a, b, c = matrix[:3, :3]
    cofactors = numpy.array([numpy.cross(b, c), numpy.cross(c, a),
                             numpy.cross(a, b)])  # carry normals as the matrix carries points
    mirrored = numpy.linalg.det(matrix[:3, :3]) < 0
    # A vertex is its place and its normal, rounded to what single precision holds of it.
    keys = numpy.concatenate([of_corner[:, None], numpy.round(normals * 2**20).astype(numpy.int64)], axis=1)
    _, first, of_key = numpy.unique(keys, axis=0, return_index=True, return_inverse=True)
    normals = normals @ cofactors.T @ turn.T * (-1 if mirrored else 1)
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    triangles = of_key.reshape(-1)[corners].reshape(-1, 3)
    if mirrored:
        triangles = triangles[:, ::-1]
    return places[of_corner[first]], normals[first], triangles


def joined(parts):
    """Several (vertices, normals, triangles) as one."""
    shift, triangles = 0, []
    for vertices, _, faces in parts:
        triangles.append(faces + shift)
        shift += len(vertices)
    return numpy.concatenate([p[0] for p in parts]), numpy.concatenate([p[1] for p in parts]), numpy.concatenate(triangles)


def ply_bytes(vertices, normals, triangles):
    """A binary PLY with double coordinates."""
    head = ("ply\nformat binary_little_endian 1.0\ncomment written by the Glint add-on for Blender\n"
            f"element vertex {len(vertices)}\n"
            + "".join(f"property double {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) +
            f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    faces = numpy.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"] = 3
    faces["corners"] = triangles
    return head.encode("ascii") + numpy.concatenate([vertices, normals], axis=1).astype("<f8").tobytes() + faces.tobytes()


class Surfaces:
    """The different surfaces of an export, each written once."""

    def __init__(self):
        self.known = []  # (SHA-256 of vertices and triangles, normals in single precision)

    def number_of(self, objects, depsgraph, world, matrices):
        """The number of the surface that these objects are together where `matrices` put them, and its PLY where it is a new one, else None."""
        vertices, normals, triangles = joined([triangles_of(o, depsgraph, world, m) for o, m in zip(objects, matrices)])
        if not len(triangles):
            raise InputError(", ".join(o.name for o in objects), "", "has no faces")
        if not (numpy.isfinite(vertices).all() and numpy.isfinite(normals).all()):
            raise InputError(", ".join(o.name for o in objects), "", "has coordinates that are not finite")
        digest = hashlib.sha256(vertices.tobytes() + triangles.tobytes()).hexdigest()
        for i, (other, their_normals) in enumerate(self.known):
            # Blender adds up normals in several threads: their last digits differ from one evaluation to the next.
            if other == digest and numpy.abs(their_normals - normals).max() < 1e-5:
                return i, None
        self.known.append((digest, normals.astype(numpy.float32)))
        return len(self.known) - 1, ply_bytes(vertices, normals, triangles)


def grid(point_of, across, along, close_across, close_along):
    """Vertices and quads of a surface given by point_of(s, t), s and t from 0 to 1; their normals lie along d/ds x d/dt."""
    rows = across if close_across else across + 1
    columns = along if close_along else along + 1
    vertices = [point_of(i / across, j / along) for i in range(rows) for j in range(columns)]
    quads = []
    for i in range(across):
        for j in range(along):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            c, d = ((i + 1) % rows) * columns + (j + 1) % columns, ((i + 1) % rows) * columns + j
            quads.append((a, d, c, b))
    return vertices, quads


def ball(radii, steps=192):
    """Vertices and faces of an ellipsoid with these semi-axes around the origin, poles at +-z."""
    half = steps // 2
    vertices = [(0.0, 0.0, radii[2])]
    for i in range(1, half):
        for j in range(steps):
            a, b = math.pi * i / half, 2 * math.pi * j / steps
            vertices.append((radii[0] * math.sin(a) * math.cos(b), radii[1] * math.sin(a) * math.sin(b), radii[2] * math.cos(a)))
    vertices.append((0.0, 0.0, -radii[2]))
    last = len(vertices) - 1
    faces = [(0, 1 + j, 1 + (j + 1) % steps) for j in range(steps)]
    for i in range(half - 2):
        a, b = 1 + i * steps, 1 + (i + 1) * steps
        faces += [(a + j, b + j, b + (j + 1) % steps, a + (j + 1) % steps) for j in range(steps)]
    end = 1 + (half - 2) * steps
    faces += [(end + j, last, end + (j + 1) % steps) for j in range(steps)]
    return vertices, faces


def sheet_point(curvature, length, width):
    """A function of s along the arc and t along y: points of the sheet k (x^2 + z^2) + 2 z = 0 around the origin."""
    def point(s, t):
        arc = (s - 0.5) * length
        if abs(curvature) < 1e-12:  # flatter than any sheet that a file means: the plane itself
            return (arc, (t - 0.5) * width, 0.0)
        angle = arc * curvature
        return (math.sin(angle) / curvature, (t - 0.5) * width, (math.cos(angle) - 1) / curvature)
    return point


def analytic(kind, value, size, file, place):
    """Vertices and faces of an analytic surface in its own frame, m. size: side of what has no end, m."""
    from .scene_file import number, vector

    def of(key):
        n = number(value.get(key), file, f"{place}.{key}")
        if not n > 0:
            raise InputError(file, f"{place}.{key}", "must be above 0")
        return n
    if kind == "plane":
        return grid(lambda s, t: ((s - 0.5) * size, (t - 0.5) * size, 0.0), 8, 8, False, False)
    if kind == "sphere":
        return ball([of("radius")] * 3)
    if kind == "ellipsoid":
        radii = vector(value.get("semi_axes"), 3, file, f"{place}.semi_axes")
        if not min(radii) > 0:
            raise InputError(file, f"{place}.semi_axes", "must be above 0")
        return ball(radii)
    if kind == "cylinder":
        r = of("radius")
        return grid(lambda s, t: (r * math.sin(2 * math.pi * s), (t - 0.5) * size, r * math.cos(2 * math.pi * s)), 192, 8, True,
                    False)
    if kind == "sheet":
        k = number(value.get("curvature"), file, f"{place}.curvature")
        arc = of("length") if value.get("length") is not None else min(size, math.pi / abs(k) if k else size)
        return grid(sheet_point(k, arc, of("width") if value.get("width") is not None else size), 128, 8, False, False)
    if kind == "torus":
        major, minor = of("major_radius"), of("minor_radius")

        def point(s, t):
            a, b = 2 * math.pi * s, 2 * math.pi * t
            return ((major + minor * math.cos(b)) * math.cos(a), (major + minor * math.cos(b)) * math.sin(a), minor * math.sin(b))
        return grid(point, 192, 96, True, True)
    return None


def mesh_object(name, vertices, faces, world, world_from_surface=None, smooth=True):
    """A new object with these vertices (m, Glint's frame of the surface), moved into Blender's world; not linked yet."""
    place = numpy.array(linear.product(world.as_matrix(), world_from_surface or linear.identity()))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((numpy.array(vertices) @ place[:3, :3].T + place[:3, 3]).tolist(), [], [tuple(f) for f in faces])
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.update()
    return bpy.data.objects.new(name, mesh)
