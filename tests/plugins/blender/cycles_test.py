# SPDX-License-Identifier: BSD-3-Clause
"""Blender's path tracer as a truth that shares no code with Glint: a glossy ellipsoid is rendered, exported, fitted and predicted.

Cycles renders few samples of a small image; what is left of its noise, and the facets of the mesh, are part of the errors."""
import json
import math
import os
import subprocess
import sys
import unittest

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

LAMP = (1.6, -1.8, 3.0)
FRAMES = 8
ALPHA = 0.16  # the width of the lobe; Blender's roughness is its square root


def render_scene(folder):
    """An ellipsoid of semi-axes 0.6, 0.5, 0.3 with a Beckmann lobe, a small lamp, and a camera that moves around; OpenEXR."""
    from glint_blender import materials
    scene = host.empty()
    scene.frame_start, scene.frame_end = 1, FRAMES
    bpy.ops.mesh.primitive_uv_sphere_add(segments=192, ring_count=96)
    body = bpy.context.active_object
    body.name, body.scale = "Body", (0.6, 0.5, 0.3)
    bpy.ops.object.shade_smooth()
    body.data.materials.append(materials.material("Shiny", "torrance-sparrow", ALPHA, 0.5, (0.05, 0.05, 0.05)))
    data = bpy.data.lights.new("lamp", "POINT")
    data.energy, data.shadow_soft_size = 60.0, 0.02
    lamp = bpy.data.objects.new("lamp", data)
    lamp.location = LAMP
    scene.collection.objects.link(lamp)
    camera = host.camera(lens=50, shift_x=0.02, shift_y=-0.03)
    camera.rotation_mode = "QUATERNION"
    for frame in range(1, FRAMES + 1):
        angle = -1.9 + 1.1 * (frame - 1) / (FRAMES - 1)
        camera.location = (2.4 * math.cos(angle), 2.4 * math.sin(angle), 1.5)
        camera.rotation_quaternion = (-camera.location).to_track_quat("-Z", "Y")
        camera.keyframe_insert("location", frame=frame)
        camera.keyframe_insert("rotation_quaternion", frame=frame)
    render = scene.render
    render.engine, render.film_transparent = "CYCLES", True  # alpha is the object's silhouette
    scene.cycles.samples, scene.cycles.max_bounces, scene.cycles.use_denoising, scene.cycles.seed = 32, 0, False, 1
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_direct = 0.0
    render.resolution_x, render.resolution_y, render.resolution_percentage = 480, 360, 50
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = os.path.join(folder, "render", "")
    render.threads_mode, render.threads = "FIXED", 2
    bpy.ops.render.render(animation=True)
    return scene, body


class Cycles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = host.folder("cycles")
        cls.scene, cls.body = render_scene(cls.folder)
        host.select(cls.body)
        cls.path = os.path.join(cls.folder, "scene.json")
        assert bpy.ops.glint.export_scene(filepath=cls.path, pictures="RENDER") == {"FINISHED"}
        with open(cls.path, encoding="utf-8") as file:
            cls.document = json.load(file)

    def evaluate(self, models, *options):
        done = subprocess.run([host.GLINT, "evaluate", self.path, "--models", models, "--train", "spread:5", "--json", "-", *options], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["models"]

    def test_linear_pictures_of_the_right_size_were_exported(self):
        self.assertTrue(all(f["radiance"].endswith(".exr") for f in self.document["frames"]))
        self.assertEqual((self.document["camera"]["width"], self.document["camera"]["height"]), (240, 180))
        self.assertEqual(self.document["lights"], [{"id": "lamp", "position": [Vector(LAMP)[i] for i in range(3)], "radius": 0.019999999552965164}])

    def test_cameras_put_the_silhouette_where_cycles_drew_it(self):
        """The box around the object in the picture against the box around the vertices' projections: half a pixel would be seen."""
        from glint_blender import meshes
        import numpy
        depsgraph = bpy.context.evaluated_depsgraph_get()
        from glint_blender import views
        vertices, _, _ = meshes.triangles_of(self.body, depsgraph, views.World(), self.body.evaluated_get(depsgraph).matrix_world)
        worst = 0.0
        for frame in self.document["frames"]:
            image = bpy.data.images.load(os.path.join(self.folder, frame["radiance"]))
            pixels = numpy.array(image.pixels[:]).reshape(180, 240, image.channels)[::-1]
            covered = pixels[:, :, 3]
            seen = numpy.array([host.project(self.document["camera"], frame["camera_from_world"], v) for v in vertices])
            for axis, count in ((0, 240), (1, 180)):
                # Alpha is the covered part of a pixel: the edge lies within the first pixel that is not empty.
                most = covered.max(axis=axis)
                first, last = numpy.flatnonzero(most > 0)[[0, -1]]
                low, high = seen[:, axis].min(), seen[:, axis].max()
                worst = max(worst, first - 0.5 - low, low - (first + 0.5), last - 0.5 - high, high - (last + 0.5))
        print(f"silhouette: at most {worst:.2f} px outside of the pixels where it was drawn")
        self.assertLess(worst, 0.1)

    def test_highlights_are_predicted_and_the_lamp_is_found(self):
        found = self.evaluate("limit-angle,reflectance")
        for name, most_pct, most_px, most_m in (("limit-angle", 0.5, 0.1, None), ("reflectance", 0.5, 0.1, 0.01)):
            summary, fit = found[name]["summary"], found[name]["fits"][0]
            away = math.dist(fit["light_position"][:3], LAMP)
            print(f"{name}: {summary['predicted']} of {summary['frames']} predicted, {summary['contour_error_pct']['mean']:.2f} %, "
                  f"{summary['contour_error_px']['mean']:.2f} px; peak {summary['peak_offset_px']['mean']:.2f} px; lamp {1000 * away:.0f} mm off "
                  f"in {math.dist(LAMP, (0, 0, 0)):.1f} m; roughness {fit['roughness']}")
            self.assertEqual((summary["predicted"], summary["matched"]), (FRAMES - 5, FRAMES - 5))
            self.assertLess(summary["contour_error_pct"]["mean"], most_pct)
            self.assertLess(summary["contour_error_px"]["mean"], most_px)
            if most_m is not None:  # the light of limit-angle absorbs what its one angle does not say of so wide a lobe
                self.assertLess(away, most_m)
        fit = found["reflectance"]["fits"][0]
        self.assertEqual(fit["lobe"], "torrance-sparrow")
        # Blender's roughness is the root of Glint's m; with m itself as roughness, the lobe would be 0.0256 wide.
        self.assertLess(abs(fit["roughness"] - ALPHA), 0.01 * ALPHA)

    def test_a_wrong_convention_shows(self):
        """Cameras with y and z turned round: nothing is predicted right any more."""
        wrong = json.loads(json.dumps(self.document))
        for frame in wrong["frames"]:
            m = frame["camera_from_world"]
            frame["camera_from_world"] = [m[0], [-v for v in m[1]], [-v for v in m[2]], m[3]]
        path = os.path.join(self.folder, "wrong.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(wrong, file)
        done = subprocess.run([host.GLINT, "evaluate", path, "--models", "limit-angle", "--train", "spread:5", "--json", "-"], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 3, done.stdout[:300])


if __name__ == "__main__":
    host.main()
