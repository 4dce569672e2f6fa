# SPDX-License-Identifier: BSD-3-Clause
"""One mistake at a time, as people and programs make them. Each takes the exact scene with its pictures and gives a wrong one."""
import copy
import dataclasses

from exact_scene import CENTRE, WORLD_FROM_BODY, Mesh, World, enlarged, scaled, times, transposed
from pictures import Pictures


@dataclasses.dataclass
class Mistake:
    what: str
    make: object  # wrong scene of a right one
    cameras: bool  # are the cameras wrong, too? Else it is the mesh or the pictures


def with_views(scene, change):
    """The scene with a changed copy of every view."""
    views = [copy.copy(view) for view in scene.views]
    for view in views:
        change(view)
    return dataclasses.replace(scene, views=views)


def half_pixel(scene):
    def change(view):
        view.cx, view.cy = view.cx + 0.5, view.cy + 0.5
    return with_views(scene, change)


def camera_to_world(scene):
    def change(view):
        view.rotation, view.translation = transposed(view.rotation), view.centre()
    return with_views(scene, change)


def axes(scene):
    def change(view):
        view.rotation = [view.rotation[0], scaled(view.rotation[1], -1), scaled(view.rotation[2], -1)]
        view.translation = [view.translation[0], -view.translation[1], -view.translation[2]]
    return with_views(scene, change)


def millimetres(scene):
    return dataclasses.replace(scene, mesh=scene.mesh.moved(enlarged(1000.0)), mesh_comment="ellipsoid in millimetres")


def mirrored(scene):
    def change(view):
        view.pictures = view.pictures.mirrored()
    return with_views(scene, change)


def mirrored_photographs(scene):
    def change(view):
        right = view.pictures
        view.pictures = Pictures(right.width, right.height, right.mirrored().photograph, right.depth)
    return with_views(scene, change)


def depth_scale(scene):
    def change(view):
        view.pictures = view.pictures.with_depth(1000 / 5000)
    return with_views(scene, change)


def flipped_normals(scene):
    right = scene.mesh
    flipped = Mesh(right.vertices, [scaled(n, -1) for n in right.normals], [(a, c, b) for a, b, c in right.faces])
    return dataclasses.replace(scene, mesh=flipped)


def other_frame(scene):
    body_from_world = transposed(WORLD_FROM_BODY)
    return dataclasses.replace(scene, mesh=scene.mesh.moved(World(body_from_world, scaled(times(body_from_world, CENTRE), -1))))


MISTAKES = {
    "half-pixel": Mistake("the principal point is half a pixel too far right and down, as counted from a pixel's corner",
                          half_pixel, True),
    "camera-to-world": Mistake("poses are those from camera to world", camera_to_world, True),
    "axes": Mistake("the camera's y and z axes are those of OpenGL: upwards and backwards", axes, True),
    "millimetres": Mistake("the mesh is in millimetres, the cameras are in metres, nothing says so", millimetres, False),
    "mirrored": Mistake("all pictures (photograph, depth, mask) are mirrored left to right", mirrored, False),
    "mirrored-photographs": Mistake("the photographs are mirrored left to right, depth and mask are not", mirrored_photographs,
                                    False),
    "depth-scale": Mistake("depth is stored with a fifth of the units per metre that are said: 1000 for 5000", depth_scale,
                           False),
    "flipped-normals": Mistake("normals and corners of the mesh are those of its inside", flipped_normals, False),
    "other-frame": Mistake("the mesh is in its own frame (centre at the origin, semi-axes along x, y, z), not in that of the "
                           "cameras", other_frame, False),
}
