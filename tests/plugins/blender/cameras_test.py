# SPDX-License-Identifier: BSD-3-Clause
"""Cameras: what is exported, against Blender's own projections, and exact cameras against the scene file they came from."""
import itertools
import json
import math
import os
import sys
import unittest

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

# Blender's own projections are single precision: eight units in the last place of 1, relative to the focal length and the size of the image.
SINGLE = 1e-6
EXACT_PX = 1e-6


def identity_world():
    from glint_blender import views
    return views.World()


def exported(scene, world=None, exact=True):
    from glint_blender import cameras
    bpy.context.view_layer.update()
    return cameras.glint_camera(scene, scene.camera, world or identity_world(), exact)


def blender_pixel(scene, point, width, height):
    """Where bpy_extras says that a point is, in Glint's pixels."""
    seen = world_to_camera_view(scene, scene.camera, Vector(point))
    return seen.x * width - 0.5, (1 - seen.y) * height - 0.5


def single_px(view):
    return SINGLE * (max(view["fx"], view["fy"]) + max(view["width"], view["height"]))


def off(a, b):
    return math.hypot(a[0] - b[0], a[1] - b[1])


def points_before(camera, random):
    """Points of the world in front of a camera."""
    m = camera.matrix_world.normalized()
    return [m @ Vector((random.uniform(-0.3, 0.3) * d, random.uniform(-0.2, 0.2) * d, -d)) for d in (random.uniform(1, 9) for _ in range(5))]


class Lens(unittest.TestCase):
    def random_view(self, scene, random, fit):
        """A camera with any lens, pose and pixels; the size of its image is whole."""
        for old in [o for o in scene.objects]:
            bpy.data.objects.remove(old)
        render = scene.render
        render.resolution_x, render.resolution_y = 2 * random.randint(100, 900), 2 * random.randint(100, 900)
        render.resolution_percentage = random.choice([50, 100])
        aspect = random.choice([1.0, 1.0, 1.3, 2.0])
        render.pixel_aspect_x, render.pixel_aspect_y = random.choice([(aspect, 1.0), (1.0, aspect)])
        return host.camera(location=[random.uniform(-5, 5) for _ in range(3)], rotation=[random.uniform(-3, 3) for _ in range(3)],
                           lens=random.uniform(15, 150), sensor_width=random.uniform(8, 40), sensor_height=random.uniform(6, 40), sensor_fit=fit,
                           shift_x=random.uniform(-0.3, 0.3), shift_y=random.uniform(-0.3, 0.3))

    def test_every_fit_shift_and_pixel_agrees_with_blender(self):
        scene, random, worst = host.empty(), host.rng("every fit"), 0.0
        seen = set()
        for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            for _ in range(100):
                camera = self.random_view(scene, random, fit)
                pose, view, exact, _ = exported(scene)
                self.assertFalse(exact)
                self.assertEqual((view["width"], view["height"]), (scene.render.resolution_x * scene.render.resolution_percentage // 100,
                                                                   scene.render.resolution_y * scene.render.resolution_percentage // 100))
                seen.add((fit, view["width"] > view["height"], scene.render.pixel_aspect_x > 1, scene.render.pixel_aspect_y > 1))
                for point in points_before(camera, random):
                    distance = off(host.project(view, pose, point), blender_pixel(scene, point, view["width"], view["height"]))
                    worst = max(worst, distance)
                    self.assertLess(distance, single_px(view), (fit, view))
        print(f"largest difference from world_to_camera_view: {worst:.1e} px")
        self.assertEqual(len(seen), 18)  # 3 fits, wide and tall, square, wide and tall pixels

    def test_closed_form(self):
        # 36 mm wide, 50 mm, 1920 x 1080: f = 1920 * 50 / 36 = 2666.67 px; shift 0.1 of the width moves the image by 192 px.
        scene = host.empty()
        scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
        host.camera(lens=50, sensor_width=36, shift_x=0.1, shift_y=-0.05)
        _, view, _, _ = exported(scene)
        self.assertAlmostEqual(view["fx"], 2666.6666666666665, 9)
        self.assertAlmostEqual(view["fy"], 2666.6666666666665, 9)
        self.assertAlmostEqual(view["cx"], 959.5 - 192, 4)
        self.assertAlmostEqual(view["cy"], 539.5 - 96, 4)

    def test_percentage_that_leaves_a_part_of_a_pixel(self):
        # Blender cuts off: 33 % of 101 x 77 are 33 x 25 pixels, whose sides are no longer in the ratio of 101 and 77.
        scene = host.empty()
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 101, 77, 33
        camera = host.camera(lens=35, sensor_fit="VERTICAL", shift_y=0.1)
        _, view, _, _ = exported(scene)
        self.assertEqual((view["width"], view["height"]), (33, 25))
        # The matrix that Blender renders with takes x to [-1, 1].
        m = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=33, y=25)
        for x, y, z in ((0.1, -0.2, -1.0), (-0.3, 0.1, -1.5)):
            clip = m @ Vector((x, y, z, 1))
            expected = (clip.x / clip.w + 1) / 2 * 33 - 0.5, (1 - clip.y / clip.w) / 2 * 25 - 0.5
            self.assertLess(off((view["fx"] * x / -z + view["cx"], view["fy"] * -y / -z + view["cy"]), expected), single_px(view))

    def test_parents_and_scale_of_a_camera(self):
        scene = host.empty()
        parent = bpy.data.objects.new("Parent", None)
        scene.collection.objects.link(parent)
        parent.location, parent.rotation_euler, parent.scale = (1, 2, 3), (0.3, -0.2, 1.0), (2.5, 2.5, 2.5)
        camera = host.camera(location=(0.5, 0.2, 4), rotation=(0.2, 0.1, 0.3))
        camera.parent, camera.scale = parent, (0.3, 0.3, 0.3)
        pose, view, _, _ = exported(scene)
        for i, j in itertools.product(range(3), range(3)):  # rigid to double precision
            self.assertAlmostEqual(sum(pose[k][i] * pose[k][j] for k in range(3)), float(i == j), 14)
        for point in points_before(camera, host.rng("parents")):
            self.assertLess(off(host.project(view, pose, point), blender_pixel(scene, point, view["width"], view["height"])), single_px(view))

    def test_refusals_have_names(self):
        from glint_blender.failures import InputError
        scene = host.empty()
        with self.assertRaisesRegex(InputError, "has no active camera"):
            exported_without = __import__("glint_blender.cameras", fromlist=["cameras"])
            exported_without.glint_camera(scene, scene.camera, identity_world())
        camera = host.camera()
        for change, undo, words in (
                (lambda: setattr(camera.data, "type", "ORTHO"), lambda: setattr(camera.data, "type", "PERSP"), "Camera: is orthographic"),
                (lambda: setattr(camera.data, "type", "PANO"), lambda: setattr(camera.data, "type", "PERSP"), "Camera: is panoramic"),
                (lambda: setattr(camera, "scale", (-1, 1, 1)), lambda: setattr(camera, "scale", (1, 1, 1)), "Camera: .*mirrors"),
                (lambda: setattr(camera, "scale", (0, 1, 1)), lambda: setattr(camera, "scale", (1, 1, 1)), "Camera: its scale is zero")):
            change()
            with self.assertRaisesRegex(InputError, words):
                exported(scene)
            undo()
        scene.render.use_border = scene.render.use_crop_to_border = True
        with self.assertRaisesRegex(InputError, "Crop to Render Region"):
            exported(scene)


class Axes(unittest.TestCase):
    def test_every_convention_maps_forward_up_and_right(self):
        """By definition: Blender's Y becomes the forward axis, its Z the up axis, and the world stays right-handed."""
        from glint_blender.properties import world_from
        scene, count = host.empty(), 0
        unit = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1), "-X": (-1, 0, 0), "-Y": (0, -1, 0), "-Z": (0, 0, -1)}
        for forward, up in itertools.product(unit, unit):
            if forward[-1] == up[-1]:
                with self.assertRaisesRegex(Exception, "two different axes"):
                    world_from(scene, forward, up, 1.0)
                continue
            world = world_from(scene, forward, up, 1.0)
            f, u = unit[forward], unit[up]
            right = [f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0]]
            for vector, expected in (((1, 0, 0), right), ((0, 1, 0), f), ((0, 0, 1), u)):
                self.assertEqual([round(v) for v in world.to_glint(vector)], list(expected), (forward, up))
                self.assertEqual(world.to_blender(world.to_glint(vector)), [float(v) for v in vector])
            count += 1
        self.assertEqual(count, 24)

    def test_pictures_do_not_depend_on_the_convention(self):
        """Cameras and points turn together; a camera that was not turned, or turned the other way, is hundreds of pixels off."""
        from glint_blender.properties import world_from
        scene, random = host.empty(), host.rng("axes")
        scene.unit_settings.system, scene.unit_settings.scale_length = "METRIC", 0.01
        camera = host.camera(location=(3, -4, 2), rotation=(1.1, 0.1, 0.6))
        points = points_before(camera, random)
        before = [blender_pixel(scene, p, 1920, 1080) for p in points]
        for forward, up, scale in (("Y", "Z", 1.0), ("-Z", "Y", 1.0), ("X", "-Y", 100.0), ("-Y", "-Z", 0.25)):
            world = world_from(scene, forward, up, scale)
            self.assertAlmostEqual(world.scale, 0.01 * scale, 15)
            pose, view, _, _ = exported(scene, world)
            for point, expected in zip(points, before):
                self.assertLess(off(host.project(view, pose, world.to_glint(point)), expected), single_px(view))
            if forward != "Y":
                wrong, _, _, _ = exported(scene, world_from(scene, "Y", "Z", scale))
                self.assertGreater(max(off(host.project(view, wrong, world.to_glint(p)), e) for p, e in zip(points, before)), 100)


class Exact(unittest.TestCase):
    """The cameras of a scene file, through Blender and out again."""
    SCENE = os.path.join(host.ROOT, "sessions", "ellipsoid", "scene.json")

    def setUp(self):
        with open(self.SCENE, encoding="utf-8") as file:
            self.document = json.load(file)

    def largest_px(self, scene, world, exact):
        """Over frames and points of the object: the exported camera against the file's; and how many were exact."""
        worst, count = 0.0, 0
        points = [(x, y, z) for x in (-0.6, 0, 0.6) for y in (-0.35, 0.35) for z in (-0.25, 0.25)]
        for number, frame in enumerate(self.document["frames"]):
            scene.frame_set(scene.frame_start + number)
            pose, view, used, known = exported(scene, world, exact)
            count += used
            if used:
                self.assertEqual(known, frame["id"])
            for point in points:
                turned = world.to_glint(self.original.to_blender(point))
                worst = max(worst, off(host.project(view, pose, turned), host.project(self.document["camera"], frame["camera_from_world"], point)))
        return worst, count

    def check(self, how, axes=("Y", "Z"), scale=1.0, out=("Y", "Z"), out_scale=1.0):
        from glint_blender.properties import world_from
        scene = host.empty()
        self.assertEqual(bpy.ops.glint.import_scene(filepath=self.SCENE, cameras=how, axis_forward=axes[0], axis_up=axes[1], scale=scale), {"FINISHED"})
        self.original = world_from(scene, *axes, scale)
        path = os.path.join(host.folder("exact"), "kept.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)  # what is kept must be in the file
        scene = bpy.context.scene
        world = world_from(scene, *out, out_scale)
        worst, count = self.largest_px(scene, world, True)
        rounded, none = self.largest_px(scene, world, False)
        print(f"{how} {axes} -> {out}: with exact cameras {worst:.1e} px, without {rounded:.1e} px")
        self.assertEqual((count, none), (24, 0))
        self.assertLess(worst, EXACT_PX)
        self.assertLess(rounded, 1e-3)     # single precision
        self.assertGreater(rounded, 1e-5)  # else there would be nothing to keep
        return scene

    def test_one_camera_for_each_frame(self):
        self.check("EACH")

    def test_one_animated_camera(self):
        self.check("ONE")

    def test_another_convention_on_the_way_in_and_out(self):
        self.check("EACH", ("-Z", "Y"), 0.01, ("X", "-Y"), 10.0)
        self.check("ONE", ("-Y", "Z"), 2.0, ("Z", "X"), 1.0)

    def test_a_camera_that_was_moved_is_no_longer_exact(self):
        from glint_blender import cameras
        scene = self.check("EACH")
        scene.frame_set(scene.frame_start)
        camera = scene.camera
        changes = [lambda: setattr(camera, "location", camera.location + Vector((2e-6, 0, 0))),
                   lambda: setattr(camera, "matrix_world", camera.matrix_world @ Matrix.Rotation(1e-5, 4, "X")),
                   lambda: setattr(camera.data, "lens", camera.data.lens * 1.00001), lambda: setattr(camera.data, "shift_y", 1e-5),
                   lambda: setattr(scene.render, "resolution_x", 641)]
        for change in changes:
            before = camera.matrix_world.copy(), camera.data.lens, camera.data.shift_y
            self.assertTrue(exported(scene)[2])
            change()
            pose, view, exact, _ = exported(scene)
            self.assertFalse(exact)
            camera.matrix_world, camera.data.lens, camera.data.shift_y = before
            scene.render.resolution_x = 640
        self.assertTrue(exported(scene)[2])
        camera[cameras.EXACT] = "{no json"
        self.assertFalse(exported(scene)[2])  # an edited property is passed over

    def test_the_lens_that_blender_cannot_bend_is_kept(self):
        scene = host.empty()
        folder = host.folder("bent")
        document = json.loads(json.dumps(self.document))
        document["camera"]["distortion"] = [-0.1, 0.02, 1e-3, 2e-3, 0.0]
        document["frames"] = [{k: f[k] for k in ("id", "camera_from_world", "surface")} for f in document["frames"][:2]]
        path = os.path.join(folder, "scene.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(document, file)
        self.assertEqual(bpy.ops.glint.import_scene(filepath=path), {"FINISHED"})
        _, view, exact, _ = exported(scene)
        self.assertTrue(exact)
        self.assertEqual(view["distortion"], document["camera"]["distortion"])


if __name__ == "__main__":
    host.main()
