# SPDX-License-Identifier: BSD-3-Clause
"""What the tests in Blender share: the add-on switched on, empty scenes, projections of their own, and how they end."""
import os
import random
import struct
import sys
import unittest

import addon_utils
import bpy

ROOT = os.environ["GLINT_ROOT"]
FOLDER = os.environ["GLINT_TEST_FOLDER"]
GLINT = os.environ.get("GLINT_PROGRAM", "")
sys.path.insert(0, os.path.join(ROOT, "plugins", "blender"))


def enable():
    """Switches the add-on on, as the preferences do, and names the program."""
    addon_utils.enable("glint_blender", default_set=True)
    bpy.context.preferences.addons["glint_blender"].preferences.program = GLINT


def empty():
    """An empty scene."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    enable()
    return bpy.context.scene


def folder(name):
    path = os.path.join(FOLDER, name)
    os.makedirs(path, exist_ok=True)
    return path


def camera(name="Camera", location=(0, 0, 0), rotation=(0, 0, 0), **lens):
    """A new camera object that is the scene's camera."""
    data = bpy.data.cameras.new(name)
    for key, value in lens.items():
        setattr(data, key, value)
    made = bpy.data.objects.new(name, data)
    made.location, made.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(made)
    bpy.context.scene.camera = made
    bpy.context.view_layer.update()
    return made


def mesh(name, vertices, faces):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.update()
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.update()
    return made


def select(*objects):
    for object_ in bpy.context.scene.objects:
        object_.select_set(object_ in objects)
    if objects:
        bpy.context.view_layer.objects.active = objects[0]


def project(view, pose, point):
    """Pixel of a point: K (R X + t), written down here and nowhere else in the tests."""
    x, y, z = (sum(row[j] * point[j] for j in range(3)) + row[3] for row in pose[:3])
    return view["fx"] * x / z + view.get("skew", 0.0) * y / z + view["cx"], view["fy"] * y / z + view["cy"]


def camera_of(document, frame):
    return frame.get("camera") or document["camera"]


def read_ply(path):
    """Vertices and normals (lists of 3), triangles of a binary PLY of doubles with int faces."""
    with open(path, "rb") as file:
        data = file.read()
    head, _, body = data.partition(b"end_header\n")
    words = head.decode("ascii").split()
    n, m = (int(words[words.index(kind) + 1]) for kind in ("vertex", "face"))
    assert words.count("double") == 6 and "binary_little_endian" in words, head
    rows = [struct.unpack_from("<6d", body, 48 * i) for i in range(n)]
    faces = [struct.unpack_from("<B3i", body, 48 * n + 13 * i) for i in range(m)]
    assert len(body) == 48 * n + 13 * m
    assert all(f[0] == 3 for f in faces)
    return [r[:3] for r in rows], [r[3:] for r in rows], [f[1:] for f in faces]


def rng(name):
    """Random numbers seeded by a name."""
    return random.Random(name)


def main():
    """Runs the tests of the script that calls; Blender ends with an error where one fails."""
    enable()
    names = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    if names:
        suite = unittest.defaultTestLoader.loadTestsFromNames(names, sys.modules["__main__"])
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    if not result.wasSuccessful() or result.testsRun == 0:
        raise RuntimeError("a test failed")
    print("glint test: all passed", flush=True)
