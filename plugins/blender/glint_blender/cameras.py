# SPDX-License-Identifier: BSD-3-Clause
"""Blender's cameras to Glint's and back.

Matrices and lenses of Blender are single precision, which moves pixels by about 2e-4. A camera that came from a Glint scene therefore keeps the
exact numbers as text in its custom property `glint_exact`, with the single-precision state that belongs to them; export uses them while that
state is still the camera's."""
import json

import bpy

from . import linear, views
from .failures import InputError

EXACT = "glint_exact"
# Relative: four units in the last place of single precision. Blender computes the same state again to one or two; a hand moves things further.
SAME = 5e-7


def image_size(scene):
    """Width and height of a render, px. Blender cuts off what the percentage leaves over."""
    render = scene.render
    return render.resolution_x * render.resolution_percentage // 100, render.resolution_y * render.resolution_percentage // 100


def state_of(scene, evaluated):
    """What decides what an evaluated camera object sees: 16 numbers of its matrix, then its lens and the image. List of floats."""
    lens = evaluated.data
    render = scene.render
    width, height = image_size(scene)
    fit = {"AUTO": 0.0, "HORIZONTAL": 1.0, "VERTICAL": 2.0}[lens.sensor_fit]
    return [float(v) for row in evaluated.matrix_world for v in row] + [
        lens.lens, lens.sensor_width, lens.sensor_height, fit, lens.shift_x, lens.shift_y, float(width), float(height),
        render.pixel_aspect_x, render.pixel_aspect_y]


def same_state(a, b):
    """Matrices by the size of their parts (rotation, position), everything else one by one."""
    if len(a) != len(b):
        return False
    place = max(abs(v) for v in (a[3], a[7], a[11], 1e-3))  # units; nearer to the origin than a thousandth counts as there
    turn = max(abs(v) for i, v in enumerate(a[:12]) if i % 4 != 3)
    for i, (x, y) in enumerate(zip(a, b)):
        size = (place if i % 4 == 3 else turn) if i < 16 else max(abs(x), 1.0)
        if not abs(x - y) <= SAME * size:
            return False
    return True


def evaluated(scene, camera):
    return camera.evaluated_get(bpy.context.evaluated_depsgraph_get() if scene == bpy.context.scene
                                else bpy.context.view_layer.depsgraph)


def exact_entry(scene, camera):
    """The stored entry that is right now: of the scene's frame, else the one of a camera that stands still. None where it has moved or has none."""
    try:
        entries = json.loads(camera.get(EXACT, "{}"))
        entry = entries.get(str(scene.frame_current)) or entries.get("still")
        if entry and same_state(entry["state"], state_of(scene, evaluated(scene, camera))):
            return entry
    except (ValueError, KeyError, TypeError, AttributeError):
        pass  # the property was edited: the camera that Blender shows counts
    return None


def keep_exact(scene, camera, pose, view, world, frame_id, frame=None):
    """Stores the exact numbers at a camera whose state is final for the scene's frame. frame: its number, None for one that stands still."""
    entries = json.loads(camera.get(EXACT, "{}"))
    entries["still" if frame is None else str(frame)] = {
        "id": frame_id, "camera_from_world": pose, "camera": view, "axes": world.axes, "scale": world.scale,
        "state": state_of(scene, evaluated(scene, camera))}
    camera[EXACT] = json.dumps(entries)


def check_camera(scene, camera):
    """Refuses by name what a Glint camera cannot be."""
    if camera is None:
        raise InputError("scene", f"frame {scene.frame_current}", "has no active camera")
    if camera.type != "CAMERA":
        raise InputError(camera.name, "", "is the scene's camera but no camera object")
    if camera.data.type != "PERSP":
        kind = {"ORTHO": "orthographic", "PANO": "panoramic"}.get(camera.data.type, camera.data.type)
        raise InputError(camera.name, "", f"is {kind}; Glint needs a perspective camera")
    if scene.render.use_border and scene.render.use_crop_to_border:
        raise InputError("render", "Crop to Render Region", "is on: the image is not the camera's; turn it off")


def glint_camera(scene, camera, world, use_exact=True):
    """(camera_from_world, Glint camera, whether they are the exact numbers, id of the frame they came from or "") at the scene's frame."""
    check_camera(scene, camera)
    entry = exact_entry(scene, camera) if use_exact else None
    if entry is not None:
        stored = views.World(entry["axes"], entry["scale"])
        return world.pose_from(entry["camera_from_world"], stored), entry["camera"], True, entry.get("id", "")
    shown = evaluated(scene, camera)
    lens, render = shown.data, scene.render
    width, height = image_size(scene)
    view = views.calibration(width, height, lens.lens, lens.sensor_width, lens.sensor_height, lens.sensor_fit, lens.shift_x,
                             lens.shift_y,
                             render.pixel_aspect_x, render.pixel_aspect_y)
    try:
        return views.camera_from_world(shown.matrix_world, world), view, False, ""
    except ValueError as e:
        raise InputError(camera.name, "", str(e)) from None


def set_lens(lens, view):
    """Gives camera data the calibration of a Glint camera; the image's size and the aspect of its pixels belong to the scene."""
    lens.type = "PERSP"
    lens.sensor_fit = "HORIZONTAL"
    lens.sensor_width = 36.0
    lens.lens, lens.shift_x, lens.shift_y, _ = views.lens_of(view, 36.0)


def set_image(scene, view):
    """Gives the scene's render settings the image of a Glint camera."""
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = view["width"], view["height"], 100
    render.pixel_aspect_x, render.pixel_aspect_y = views.lens_of(view)[3]


def blender_matrix(pose, world):
    """matrix_world of a camera for a Glint pose, rounded by Blender."""
    import mathutils
    return mathutils.Matrix(views.matrix_world_of(pose, world))


def keyed(object_, matrices, numbers):
    """Keys of an object's location and rotation: its matrix in each frame."""
    object_.rotation_mode, previous = "QUATERNION", None
    for matrix, number in zip(matrices, numbers):
        object_.location, turn, _ = matrix.decompose()
        if previous is not None:
            turn.make_compatible(previous)
        object_.rotation_quaternion = previous = turn
        for path in ("location", "rotation_quaternion"):
            object_.keyframe_insert(path, frame=number)


def largest_rounding_px(pose, view, rounded_pose, rounded_view, points):
    """By how many pixels rounded numbers move the images of points (of Glint's world); 0 where none is in view."""
    worst = 0.0
    for point in points:
        a, b = views.project(view, pose, point), views.project(rounded_view, rounded_pose, point)
        if a and b:
            worst = max(worst, linear.length(linear.difference(a, b)))
    return worst
