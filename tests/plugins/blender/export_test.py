# SPDX-License-Identifier: BSD-3-Clause
"""Export: surfaces, lamps, pictures and frames, and what is refused. Shapes are checked against their equations, files with `glint info`."""
import json
import math
import os
import shutil
import subprocess
import sys
import unittest

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host
from glint_blender import run

CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def export(name, **options):
    """Exports into a new folder; the document and the folder."""
    folder = host.folder(name)
    path = os.path.join(folder, "scene.json")
    options.setdefault("pictures", "NONE")
    answer = bpy.ops.glint.export_scene(filepath=path, **options)
    assert answer == {"FINISHED"}, answer
    with open(path, encoding="utf-8") as file:
        return json.load(file), folder


def ball(name="Ball", radius=1.0, segments=32):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, segments=segments, ring_count=segments // 2)
    made = bpy.context.active_object
    made.name = name
    bpy.ops.object.shade_smooth()
    return made


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Meshes(unittest.TestCase):
    def setUp(self):
        self.scene = host.empty()
        self.scene.frame_start, self.scene.frame_end = 1, 4
        host.camera(location=(0, -8, 0), rotation=(math.pi / 2, 0, 0))

    def test_a_still_object_is_one_mesh_with_its_modifiers(self):
        cube = host.mesh("Cube", CUBE, CUBE_FACES)
        cube.modifiers.new("Subdivision", "SUBSURF").levels = 2
        cube.location = (0.5, 0.25, -1)
        host.select(cube)
        document, folder = export("still")
        self.assertEqual(len(document["frames"]), 4)
        self.assertEqual({f["surface"] for f in document["frames"]}, {"surface_0000"})
        vertices, _, triangles = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
        self.assertEqual(len(triangles), 6 * 16 * 2)  # each face four times into four
        # Catmull-Clark: a corner of valence 3 goes to (F + 2 R + (3 - 3) P) / 3 = F / 3 + 2 R / 3 in the first step.
        shown = cube.evaluated_get(bpy.context.evaluated_depsgraph_get())
        expected = {tuple(round(c, 5) for c in shown.matrix_world @ v.co) for v in shown.data.vertices}
        self.assertEqual({tuple(round(c, 5) for c in v) for v in vertices}, expected)
        self.assertLess(max(abs(v[0] - 0.5) for v in vertices), 1.0)  # smoothed, so smaller than the cube

    def test_a_deforming_object_is_one_mesh_for_each_frame(self):
        # z = 0.1 (frame - 1) x^2 in frames 1 to 4, by a shape key that is linear in the frame.
        steps = [i / 10 for i in range(-10, 11)]
        sheet = host.mesh("Sheet", [(x, y, 0) for x in steps for y in (-1, 1)], [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(20)])
        sheet.shape_key_add(name="Basis")
        bent = sheet.shape_key_add(name="Bent")
        for point, vertex in zip(bent.data, sheet.data.vertices):
            point.co = (vertex.co.x, vertex.co.y, vertex.co.x ** 2)
        for frame in (1, 4):
            bent.value = 0.1 * (frame - 1)
            bent.keyframe_insert("value", frame=frame)
        for point in sheet.data.shape_keys.animation_data.action.fcurves[0].keyframe_points:
            point.interpolation = "LINEAR"
        host.select(sheet)
        document, folder = export("deforming")
        self.assertEqual([f["surface"] for f in document["frames"]], [f"surface_{i:04d}" for i in range(4)])
        for i in range(4):
            vertices, _, _ = host.read_ply(os.path.join(folder, document["surfaces"][f"surface_{i:04d}"]["mesh"]))
            self.assertLess(max(abs(v[2] - 0.1 * i * v[0] ** 2) for v in vertices), 1e-6)
            self.assertAlmostEqual(max(v[2] for v in vertices), 0.1 * i, 6)

    def test_what_comes_back_to_the_same_shape_is_written_once(self):
        cube = host.mesh("Cube", CUBE, CUBE_FACES)
        for frame, x in ((1, 1.0), (2, 2.0), (3, 1.0), (4, 2.0)):
            cube.scale.x = x
            cube.keyframe_insert("scale", frame=frame)
        host.select(cube)
        document, _ = export("twice")
        self.assertEqual([f["surface"] for f in document["frames"]], ["surface_0000", "surface_0001"] * 2)

    def test_normals_are_those_that_are_shaded(self):
        cube = host.mesh("Cube", CUBE, CUBE_FACES)
        host.select(cube)
        document, folder = export("flat")
        vertices, normals, triangles = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
        self.assertEqual((len(vertices), len(triangles)), (24, 12))  # each corner once for each of its three faces
        for v, n in zip(vertices, normals):
            self.assertAlmostEqual(max(abs(c) for c in n), 1.0, 6)
            self.assertAlmostEqual(dot(v, n), 1.0, 6)  # the face's plane
        round_one = ball()
        host.select(round_one)
        document, folder = export("smooth")
        vertices, normals, triangles = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
        self.assertEqual(len(vertices), 32 * 15 + 2)  # shared
        for v, n in zip(vertices, normals):
            self.assertGreater(dot(v, n), 0.999)

    def test_mirrored_turned_and_stretched_objects_keep_their_outside(self):
        made = ball(segments=48)
        for scale in ((2, 1, 0.5), (-2, 1, 0.5), (-1, -1, -1)):
            made.scale, made.rotation_euler = scale, (0.3, 0.5, -0.2)
            host.select(made)
            document, folder = export("mirrored")
            vertices, normals, triangles = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
            back = made.matrix_world.to_3x3().inverted()
            for v, n in zip(vertices, normals):
                local = back @ Vector(v)
                expected = (back.transposed() @ local).normalized()  # the gradient of |M^-1 x|^2
                self.assertGreater(dot(expected, n), 0.998, scale)
            for a, b, c in triangles:
                across = cross([q - p for p, q in zip(vertices[a], vertices[b])], [q - p for p, q in zip(vertices[a], vertices[c])])
                self.assertGreater(dot(across, vertices[a]), 0, scale)

    def test_axes_and_units_of_vertices(self):
        cube = host.mesh("Cube", [(1, 2, 3), (2, 2, 3), (1, 3, 3)], [(0, 1, 2)])
        host.select(cube)
        document, folder = export("axes", axis_forward="-Z", axis_up="Y", scale=0.01)
        vertices, normals, _ = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
        self.assertIn((0.01, 0.03, -0.02), [tuple(round(c, 9) for c in v) for v in vertices])  # (x, z, -y)
        self.assertEqual([round(c, 6) for c in normals[0]], [0, 1, 0])  # Blender's up is y there

    def test_results_are_no_surface(self):
        cube, shown = host.mesh("Cube", CUBE, CUBE_FACES), host.mesh("Ellipsoid", CUBE, CUBE_FACES)
        shown["glint_result"] = "{}"
        host.select(cube, shown)
        for which in ("SELECTED", "VISIBLE"):
            document, folder = export("no_results", surfaces=which)
            vertices, _, _ = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
            self.assertEqual(len(vertices), 24)

    def test_several_objects_are_one_surface(self):
        a, b = host.mesh("A", CUBE, CUBE_FACES), host.mesh("B", CUBE, CUBE_FACES)
        b.location.x = 5
        host.select(a, b)
        document, folder = export("both")
        vertices, _, triangles = host.read_ply(os.path.join(folder, document["surfaces"]["surface_0000"]["mesh"]))
        self.assertEqual((len(vertices), len(triangles)), (48, 24))
        self.assertEqual((min(v[0] for v in vertices), max(v[0] for v in vertices)), (-1.0, 6.0))


class Lamps(unittest.TestCase):
    def setUp(self):
        self.scene = host.empty()
        self.scene.frame_end = 2
        host.camera(location=(0, -8, 0), rotation=(math.pi / 2, 0, 0))
        host.select(host.mesh("Cube", CUBE, CUBE_FACES))

    def lamp(self, kind, name, **values):
        data = bpy.data.lights.new(name, kind)
        for key, value in values.items():
            setattr(data, key, value)
        made = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(made)
        return made

    def test_places_sizes_and_directions(self):
        self.lamp("POINT", "point", shadow_soft_size=0.25).location = (1, 2, 3)
        # A sun shines along its -z; turned about x by 90 degrees it shines along +y, so its light comes from -y.
        self.lamp("SUN", "sun").rotation_euler = (math.pi / 2, 0, 0)
        tube = self.lamp("AREA", "tube", shape="RECTANGLE", size=2.0, size_y=0.1)
        tube.location, tube.rotation_euler = (0, 0, 4), (0, 0, math.pi / 2)  # its x is the world's y
        self.lamp("AREA", "panel", shape="SQUARE", size=0.5).location = (3, 0, 0)
        document, _ = export("lamps", axis_forward="-Z", axis_up="Y", scale=0.5)
        lights = {light["id"]: light for light in document["lights"]}
        rounded = lambda v: [round(c, 6) + 0.0 for c in v]
        self.assertEqual(rounded(lights["point"]["position"]), [0.5, 1.5, -1.0])
        self.assertEqual(lights["point"]["radius"], 0.125)
        self.assertEqual(rounded(lights["sun"]["direction"]), [0, 0, 1])
        self.assertEqual(sorted(map(rounded, lights["tube"]["segment"])), [[0, 2, -0.5], [0, 2, 0.5]])
        self.assertAlmostEqual(lights["tube"]["radius"], 0.025, 7)
        self.assertAlmostEqual(math.pi * lights["panel"]["radius"] ** 2, 0.25 ** 2, 7)

    def test_lamps_that_are_off_or_move(self):
        on, off = self.lamp("POINT", "on"), self.lamp("POINT", "sometimes")
        on.location = off.location = (0, -5, 5)
        for frame, hidden in ((1, False), (2, True)):
            off.hide_render = hidden
            off.keyframe_insert("hide_render", frame=frame)
        document, _ = export("off")
        self.assertEqual([f["lights_on"] for f in document["frames"]], [["on", "sometimes"], ["on"]])
        for frame, x in ((1, 0), (2, 1)):
            on.location.x = x
            on.keyframe_insert("location", frame=frame)
        document, _ = export("moves")
        self.assertEqual([light["id"] for light in document["lights"]], ["sometimes"])
        self.assertTrue(all("lights_on" not in f for f in document["frames"]))  # a lamp without a name is on


class Frames(unittest.TestCase):
    def setUp(self):
        self.scene = host.empty()
        self.scene.frame_start, self.scene.frame_end = 10, 13
        self.scene.render.resolution_x, self.scene.render.resolution_y = 64, 48
        self.camera = host.camera(location=(0, -8, 0), rotation=(math.pi / 2, 0, 0))
        self.cube = host.mesh("Cube", CUBE, CUBE_FACES)
        host.select(self.cube)

    def pictures(self, folder, names):
        image = bpy.data.images.new("picture", 64, 48)
        for name in names:
            image.filepath_raw, image.file_format = os.path.join(folder, name), "PNG"
            image.save()

    def test_glint_reads_it(self):
        document, folder = export("read", whole_range=False, first=10, last=13, step=3)
        self.assertEqual([f["id"] for f in document["frames"]], ["0010", "0013"])
        done = subprocess.run([host.GLINT, "info", os.path.join(folder, "scene.json"), "--json", "-"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        self.assertEqual(info["warnings"], [])
        self.assertEqual([(f["vertices"], f["vertices_in_image"]) for f in info["frames"]], [(24, 24)] * 2)

    def test_animated_camera_and_markers(self):
        other = host.camera("Other", location=(0, -6, 0), rotation=(math.pi / 2, 0, 0), lens=85)
        self.scene.camera = self.camera
        for frame, camera in ((10, self.camera), (12, other)):
            self.scene.timeline_markers.new("m", frame=frame).camera = camera
        for frame, y in ((10, -8), (11, -7)):
            self.camera.location.y = y
            self.camera.keyframe_insert("location", frame=frame)
        document, _ = export("animated")
        self.assertEqual([round(f["camera_from_world"][2][3], 5) for f in document["frames"]], [8, 7, 6, 6])
        self.assertEqual([round(f["camera"]["fx"], 4) for f in document["frames"]], [88.8889, 88.8889, 151.1111, 151.1111])

    def test_the_scenes_frame_stays(self):
        self.scene.frame_set(12)
        export("stays")
        self.assertEqual(self.scene.frame_current, 12)

    def test_pictures_of_a_folder_must_be_as_many(self):
        folder = host.folder("shots")
        self.pictures(folder, ["b.png", "a.png", "d.png", "c.png"])
        document, out = export("with_pictures", pictures="FOLDER", folder=folder)
        self.assertEqual([f["image"] for f in document["frames"]], [f"scene_frames/{i:04d}.png" for i in range(4)])
        self.assertTrue(all(os.path.isfile(os.path.join(out, f["image"])) for f in document["frames"]))
        os.remove(os.path.join(folder, "d.png"))
        with self.assertRaisesRegex(RuntimeError, "holds 3 pictures for 4 frames"):
            bpy.ops.glint.export_scene(filepath=os.path.join(out, "other.json"), pictures="FOLDER", folder=folder)
        self.assertFalse(os.path.exists(os.path.join(out, "other.json")))

    def test_a_blend_file_names_pictures_of_its_folder_only(self):
        home, elsewhere = host.folder("received"), host.folder("private")
        self.pictures(elsewhere, [f"{n:04d}.png" for n in range(10, 14)])
        os.makedirs(os.path.join(home, "own"), exist_ok=True)
        shutil.copy(os.path.join(elsewhere, "0010.png"), os.path.join(home, "own", "0010.png"))
        with open(os.path.join(home, "own", "0011.png"), "w", encoding="utf-8") as file:
            file.write("-----BEGIN PRIVATE KEY-----")
        os.symlink(os.path.join(elsewhere, "0012.png"), os.path.join(home, "own", "0012.png"))
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(home, "received.blend"))
        host.select(bpy.data.objects["Cube"])
        scene = bpy.context.scene

        def copied(name, **options):
            document, out = export(name, **options)
            return [os.path.isfile(os.path.join(out, f["image"])) if "image" in f else None for f in document["frames"]]

        scene.render.filepath = "//own/"
        self.assertEqual(copied("of_the_folder", pictures="RENDER"), [True, None, None, None])  # a picture, a key, a link that leaves, none
        scene.render.filepath = elsewhere + "/"
        self.assertEqual(copied("elsewhere", pictures="RENDER"), [None] * 4)
        background = scene.camera.data.background_images.new()
        background.image = bpy.data.images.load(os.path.join(elsewhere, "0010.png"))
        self.assertEqual(copied("background", pictures="BACKGROUND"), [None] * 4)
        settings = scene.glint
        settings.pictures, settings.pictures_folder, settings.surfaces = "FOLDER", elsewhere, "VISIBLE"
        path, warnings = run.export_for_run(bpy.context, host.folder("by_run"))
        with open(path, encoding="utf-8") as file:
            self.assertTrue(all("image" not in f for f in json.load(file)["frames"]))
        self.assertIn("lies outside of the folder of the .blend file", warnings[0])
        self.assertEqual(copied("named_now", pictures="FOLDER", folder=elsewhere), [True] * 4)  # in the dialog, by the user
        self.assertEqual(bpy.ops.glint.trust_pictures(), {"FINISHED"})
        self.assertEqual(copied("trusted", pictures="RENDER"), [True] * 4)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(home, "other.blend"))
        self.assertEqual(copied("another_file", pictures="RENDER"), [None] * 4)

    def test_nothing_is_half_written_and_nothing_of_others_replaced(self):
        out = host.folder("guarded")
        with open(os.path.join(out, "scene.json"), "w", encoding="utf-8") as file:
            file.write('{"something": "else"}')
        with self.assertRaisesRegex(RuntimeError, "has no key glint_scene"):
            bpy.ops.glint.export_scene(filepath=os.path.join(out, "scene.json"), pictures="NONE")
        self.assertEqual(os.listdir(out), ["scene.json"])
        os.makedirs(os.path.join(out, "mine_meshes"))
        precious = os.path.join(out, "mine_meshes", "surface_0000.ply")
        with open(precious, "w", encoding="utf-8") as file:
            file.write("precious")
        with self.assertRaisesRegex(RuntimeError, "exists already and is not of an earlier export"):
            bpy.ops.glint.export_scene(filepath=os.path.join(out, "mine.json"), pictures="NONE")
        with open(precious, encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")
        self.assertEqual(sorted(os.listdir(out)), ["mine_meshes", "scene.json"])
        # Half way: the third frame has another camera.
        self.scene.timeline_markers.new("m", frame=10).camera = self.camera
        bad = bpy.data.cameras.new("Bad")
        bad.type = "ORTHO"
        other = bpy.data.objects.new("Bad", bad)
        self.scene.collection.objects.link(other)
        self.scene.timeline_markers.new("m", frame=12).camera = other
        with self.assertRaisesRegex(RuntimeError, "Bad: is orthographic"):
            bpy.ops.glint.export_scene(filepath=os.path.join(out, "half.json"), pictures="NONE")
        self.assertEqual(sorted(os.listdir(out)), ["mine_meshes", "scene.json"])
        shutil.rmtree(out)
        self.scene.timeline_markers.clear()
        # An earlier export of its own is replaced.
        for _ in range(2):
            export("again")

    def test_what_cannot_be_exported_is_said(self):
        host.select()
        out = os.path.join(host.folder("said"), "scene.json")
        with self.assertRaisesRegex(RuntimeError, "no object with faces is chosen"):
            bpy.ops.glint.export_scene(filepath=out, pictures="NONE")
        host.select(self.cube)
        self.cube.data.clear_geometry()
        with self.assertRaisesRegex(RuntimeError, "Cube: has no faces"):
            bpy.ops.glint.export_scene(filepath=out, pictures="NONE")
        bpy.data.objects.remove(self.camera)
        self.assertFalse(bpy.ops.glint.export_scene.poll())


if __name__ == "__main__":
    host.main()
