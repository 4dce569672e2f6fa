# SPDX-License-Identifier: BSD-3-Clause
"""Import of scenes: surfaces against their equations, meshes of every format, lamps; files that are wrong are refused; out and in again."""
import json
import math
import os
import struct
import subprocess
import sys
import unittest

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

CAMERA = {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5}
POSE = [[1, 0, 0, 0.1], [0, -1, 0, 0.2], [0, 0, -1, 3], [0, 0, 0, 1]]
# A quarter turn about x, then a shift: local (x, y, z) is (x, -z, y) + (1, 2, 3) in the world.
PLACE = [[1, 0, 0, 1], [0, 0, -1, 2], [0, 1, 0, 3], [0, 0, 0, 1]]


def local(point):
    """The inverse of PLACE."""
    x, y, z = point[0] - 1, point[1] - 2, point[2] - 3
    return x, z, -y


def scene_with(surfaces, lights=(), frames=None):
    first = next(iter(surfaces), None)
    return {"glint_scene": 1, "name": "made", "camera": dict(CAMERA), "surfaces": surfaces, "lights": list(lights),
            "frames": frames or [{"id": "a", "camera_from_world": POSE, "surface": first}]}


def write(folder, document, name="scene.json"):
    path = os.path.join(host.folder(folder), name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document, file)
    return path


def read(path, **options):
    host.empty()
    assert bpy.ops.glint.import_scene(filepath=path, **options) == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.scene


def vertices_of(surface):
    return [o.matrix_world @ v.co for o in bpy.context.scene.objects if o.get("glint_surface") == surface for v in o.data.vertices]


class Analytic(unittest.TestCase):
    """|f| of every vertex, and how far the shape reaches."""
    SHAPES = {
        "sphere": ({"type": "sphere", "radius": 0.7}, lambda x, y, z: math.hypot(x, y, z) - 0.7, 0.7),
        "ellipsoid": ({"type": "ellipsoid", "semi_axes": [0.6, 0.4, 0.2]}, lambda x, y, z: (x / 0.6) ** 2 + (y / 0.4) ** 2 + (z / 0.2) ** 2 - 1, 0.6),
        "cylinder": ({"type": "cylinder", "radius": 0.5}, lambda x, y, z: math.hypot(x, z) - 0.5, None),
        "plane": ({"type": "plane"}, lambda x, y, z: z, None),
        "torus": ({"type": "torus", "major_radius": 1.0, "minor_radius": 0.3}, lambda x, y, z: math.hypot(math.hypot(x, y) - 1, z) - 0.3, 1.3),
        "bent": ({"type": "sheet", "curvature": 2.0, "length": 1.0, "width": 0.8}, lambda x, y, z: 2 * (x * x + z * z) + 2 * z, math.hypot(math.sin(0.5), 0.4)),
        "hollow": ({"type": "sheet", "curvature": -2.0, "length": 1.0, "width": 0.8}, lambda x, y, z: -2 * (x * x + z * z) + 2 * z,
                   math.hypot(math.sin(0.5), 0.4)),  # the chord of an arc of one radian
        "flat": ({"type": "sheet", "curvature": 0.0, "length": 1.0, "width": 0.8}, lambda x, y, z: z, math.hypot(0.5, 0.4)),
        "endless": ({"type": "sheet", "curvature": 0.5}, lambda x, y, z: 0.5 * (x * x + z * z) + 2 * z, None)}

    def test_every_type_lies_on_its_equation(self):
        for name, (value, equation, reach) in self.SHAPES.items():
            path = write(f"analytic_{name}", scene_with({name: {"analytic": {**value, "world_from_surface": PLACE}}}))
            for axes, scale in ((("Y", "Z"), 1.0), (("-Z", "Y"), 0.5)):
                read(path, axis_forward=axes[0], axis_up=axes[1], scale=scale)
                points = vertices_of(name)
                if axes == ("-Z", "Y"):  # Blender's (x, y, z) is Glint's (x, z, -y)
                    points = [(0.5 * p[0], 0.5 * p[2], -0.5 * p[1]) for p in points]
                points = [local(p) for p in points]
                self.assertGreater(len(points), 50, name)
                self.assertLess(max(abs(equation(*p)) for p in points), 5e-6, name)
                if reach:
                    self.assertAlmostEqual(max(math.hypot(*p) for p in points), reach, 2, name)
                if "width" in value:
                    self.assertAlmostEqual(max(p[1] for p in points), 0.4, 5)

    def test_normals_of_closed_shapes_point_outwards(self):
        for name in ("sphere", "ellipsoid", "torus", "cylinder"):
            value, _, _ = self.SHAPES[name]
            read(write(f"outwards_{name}", scene_with({name: {"analytic": value}})))
            object_, = [o for o in bpy.context.scene.objects if o.get("glint_surface") == name]
            for face in object_.data.polygons:
                c = face.center
                if name == "torus":
                    around = math.hypot(c.x, c.y)
                    inside = (c.x / around, c.y / around, 0.0)
                elif name == "cylinder":
                    inside = (0.0, c.y, 0.0)
                else:
                    inside = (0.0, 0.0, 0.0)
                self.assertGreater(sum((c[i] - inside[i]) * face.normal[i] for i in range(3)), 0, name)

    def test_normals_of_open_shapes_are_along_local_z(self):
        for name in ("plane", "bent", "hollow", "flat"):
            read(write(f"upwards_{name}", scene_with({name: {"analytic": self.SHAPES[name][0]}})))
            object_, = [o for o in bpy.context.scene.objects if o.get("glint_surface") == name]
            self.assertTrue(all(face.normal.z > 0.5 for face in object_.data.polygons), name)

    def test_a_shape_without_mesh_is_left_out_with_a_warning(self):
        from glint_blender import import_scene, views
        path = write("quadric", scene_with({"q": {"analytic": {"type": "quadric", "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]}}}))
        host.empty()
        importer = import_scene.Importer(bpy.context, path, views.World())
        importer.run()
        self.assertRegex(" ".join(importer.warnings), "q: a surface of type quadric has no mesh here")


class MeshFiles(unittest.TestCase):
    """One tetrahedron in every format, at the same places."""
    POINTS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)]
    FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]

    def ply(self, path):
        with open(path, "w", encoding="ascii") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
                       "property list uchar int vertex_indices\nend_header\n")
            file.writelines(f"{x} {y} {z}\n" for x, y, z in self.POINTS)
            file.writelines(f"3 {a} {b} {c}\n" for a, b, c in self.FACES)

    def obj(self, path):
        with open(path, "w", encoding="ascii") as file:
            file.writelines(f"v {x} {y} {z}\n" for x, y, z in self.POINTS)
            file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in self.FACES)

    def stl(self, path):
        with open(path, "wb") as file:
            file.write(b"\0" * 80 + struct.pack("<I", 4))
            for face in self.FACES:
                file.write(struct.pack("<12fH", 0, 0, 0, *(v for i in face for v in self.POINTS[i]), 0))

    def gltf(self, path):
        data = b"".join(struct.pack("<3f", *p) for p in self.POINTS) + b"".join(struct.pack("<3H", *f) for f in self.FACES)
        with open(os.path.join(os.path.dirname(path), "mesh.bin"), "wb") as file:
            file.write(data)
        document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3]},
                                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
                    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
                    "buffers": [{"byteLength": 72, "uri": "mesh.bin"}]}
        with open(path, "w", encoding="ascii") as file:
            json.dump(document, file)

    def test_every_format_lies_at_the_same_place(self):
        for kind in ("ply", "obj", "stl", "gltf"):
            folder = host.folder(f"mesh_{kind}")
            getattr(self, kind)(os.path.join(folder, f"mesh.{kind}"))
            path = write(f"mesh_{kind}", scene_with({"body": {"mesh": f"mesh.{kind}", "units": "cm"}}))
            if kind == "gltf" and not hasattr(numpy, "bool"):
                # The glTF reader of Debian's Blender 3.4 does not run with Debian's NumPy 1.24: the message says so.
                host.empty()
                with self.assertRaisesRegex(RuntimeError, "Blender's reader fails: AttributeError: module 'numpy' has no attribute 'bool'"):
                    bpy.ops.glint.import_scene(filepath=path)
                numpy.bool = bool  # with this mended, it must read
            read(path)
            found = {tuple(round(100 * c, 4) + 0.0 for c in p) for p in vertices_of("body")}
            self.assertEqual(found, set(self.POINTS), kind)
            read(path, axis_forward="-Z", axis_up="Y", scale=0.01)
            found = {(round(p[0], 4) + 0.0, round(p[2], 4) + 0.0, round(-p[1], 4) + 0.0) for p in vertices_of("body")}
            self.assertEqual(found, set(self.POINTS), kind)

    def test_meshes_that_are_wrong_are_refused_and_leave_nothing(self):
        folder = host.folder("wrong_mesh")
        self.ply(os.path.join(folder, "right.ply"))
        with open(os.path.join(folder, "cloud.ply"), "w", encoding="ascii") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n")
        with open(os.path.join(folder, "noise.obj"), "wb") as file:
            file.write(bytes(range(256)) * 4)
        with open(os.path.join(folder, "mesh.xyz"), "w", encoding="ascii") as file:
            file.write("0 0 0\n")
        outside = os.path.join(host.FOLDER, "outside.ply")
        self.ply(outside)
        os.symlink(outside, os.path.join(folder, "link.ply"))
        for mesh, words in (("none.ply", "surfaces.b.mesh: none.ply does not exist"), ("../outside.ply", "is outside of the folder"),
                            (outside, "is outside of the folder"), ("link.ply", "is outside of the folder"), ("cloud.ply", "has no faces"),
                            ("noise.obj", "has no faces"), ("mesh.xyz", "is no PLY, OBJ, STL or glTF")):
            path = write("wrong_mesh", scene_with({"a": {"mesh": "right.ply"}, "b": {"mesh": mesh}}))
            host.empty()
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.glint.import_scene(filepath=path)
            self.assertEqual((len(bpy.data.objects), len(bpy.context.scene.glint.frames)), (0, 0), mesh)


class Lamps(unittest.TestCase):
    LIGHTS = [{"id": "ball", "position": [1, 2, 3], "radius": 0.05}, {"id": "sun", "direction": [0, 0, 2]},
              {"id": "tube", "segment": [[0, 0, 2], [0.6, 0, 2]], "radius": 0.015}]

    def test_places_and_sizes(self):
        read(write("lamps", scene_with({"p": {"analytic": {"type": "plane"}}}, self.LIGHTS)), scale=0.1)
        made = {o.name: o for o in bpy.context.scene.objects if o.type == "LIGHT"}
        rounded = lambda v: [round(c, 5) + 0.0 for c in v]
        self.assertEqual((made["ball"].data.type, rounded(made["ball"].matrix_world.translation)), ("POINT", [10, 20, 30]))
        self.assertAlmostEqual(made["ball"].data.shadow_soft_size, 0.5, 6)
        # A sun shines along its -z.
        self.assertEqual((made["sun"].data.type, rounded(made["sun"].matrix_world.to_3x3().col[2])), ("SUN", [0, 0, 1]))
        tube = made["tube"]
        self.assertEqual((tube.data.type, tube.data.shape, rounded(tube.matrix_world.translation)), ("AREA", "RECTANGLE", [3, 0, 20]))
        self.assertAlmostEqual(tube.data.size, 6.0, 5)
        self.assertAlmostEqual(tube.data.size_y, 0.3, 5)
        self.assertEqual(rounded(map(abs, tube.matrix_world.to_3x3().col[0])), [1, 0, 0])
        self.assertLess(-tube.matrix_world.to_3x3().col[2][2], -0.9)  # towards the scene
        self.assertGreater(tube.matrix_world.to_3x3().determinant(), 0)

    def test_corners_are_an_area(self):
        """A shape that has its place by corners, whatever its key is called."""
        panel = {"id": "panel", "corners": [[0, 0, 2], [0.6, 0, 2], [0.6, 0.4, 2], [0, 0.4, 2]]}
        read(write("corners", scene_with({"p": {"analytic": {"type": "plane"}}}, [panel])), scale=0.1)
        light, = (o for o in bpy.context.scene.objects if o.type == "LIGHT")
        self.assertEqual((light.data.type, light.data.shape), ("AREA", "RECTANGLE"))
        self.assertAlmostEqual(light.data.size, 6.0, 5)
        self.assertAlmostEqual(light.data.size_y, 4.0, 5)
        self.assertEqual([round(c, 5) for c in light.matrix_world.translation], [3, 2, 20])
        self.assertEqual([round(c, 5) for c in -light.matrix_world.to_3x3().col[2]], [0, 0, -1])  # it shines down

    def test_out_again(self):
        scene = read(write("lamps_out", scene_with({"p": {"analytic": {"type": "plane"}}}, self.LIGHTS)), axis_forward="X", axis_up="Y", scale=0.1)
        host.select(*[o for o in scene.objects if "glint_surface" in o])
        path = os.path.join(host.folder("lamps_again"), "scene.json")
        bpy.ops.glint.export_scene(filepath=path, pictures="NONE", axis_forward="X", axis_up="Y", scale=0.1)
        with open(path, encoding="utf-8") as file:
            lights = {light["id"]: light for light in json.load(file)["lights"]}
        close = lambda a, b: all(abs(x - y) < 1e-5 for x, y in zip(a, b))
        self.assertTrue(close(lights["ball"]["position"], [1, 2, 3]) and abs(lights["ball"]["radius"] - 0.05) < 1e-6)
        self.assertTrue(close(lights["sun"]["direction"], [0, 0, 1]))
        ends = sorted(lights["tube"]["segment"])
        self.assertTrue(close(ends[0], [0, 0, 2]) and close(ends[1], [0.6, 0, 2]))


class Refusals(unittest.TestCase):
    def test_by_place(self):
        plane = {"p": {"analytic": {"type": "plane"}}}
        cases = [("frames: is empty", lambda d: d.update(frames=[])), ("frames: must be a list", lambda d: d.update(frames={})),
                 (r"frames\[0\].id: must be a text", lambda d: d["frames"][0].update(id=3)),
                 (r"frames\[0\].camera_from_world: must be 4 rows", lambda d: d["frames"][0].update(camera_from_world=[1])),
                 (r"camera_from_world: is not a rotation", lambda d: d["frames"][0].update(camera_from_world=[[2, 0, 0, 0]] + POSE[1:])),
                 (r"camera.fx: must be above 0", lambda d: d["camera"].update(fx=0)), (r"camera.width", lambda d: d["camera"].update(width=1e9)),
                 (r"camera.cx: must be a number", lambda d: d["camera"].update(cx=float("nan"))), (r"camera: must be an object", lambda d: d.pop("camera")),
                 ("has no key glint_scene", lambda d: d.pop("glint_scene")), (r"lights\[0\]: must have a position", lambda d: d.update(lights=[{"id": "x"}])),
                 ("surfaces.p: must be an object", lambda d: d.update(surfaces={"p": 1})),
                 ("radius: must be above 0", lambda d: d.update(surfaces={"p": {"analytic": {"type": "sphere", "radius": -1}}}))]
        for words, damage in cases:
            document = scene_with(json.loads(json.dumps(plane)))
            document = json.loads(json.dumps(document))
            damage(document)
            path = write("refused", document)
            host.empty()
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.glint.import_scene(filepath=path)
            self.assertEqual(len(bpy.data.objects), 0)

    def test_damaged_files_never_end_in_anything_else(self):
        """Values of a right file replaced by others, at random: it is read or refused as InputError."""
        from glint_blender import import_scene, views
        from glint_blender.failures import InputError
        random = host.rng("damaged scenes")
        values = [None, True, -1, 0, 1e300, float("nan"), "", "x", "../x", [], {}, [[]], [1, 2, 3], "é\u0000", 2**70]
        right = scene_with({"s": {"analytic": {"type": "sheet", "curvature": 1.0, "length": 1, "width": 1, "world_from_surface": PLACE}},
                            "m": {"mesh": "none.ply"}}, Lamps.LIGHTS)
        right["frames"][0].update(image="a.png", world_from_object=PLACE)

        def places(value):
            found = []
            if isinstance(value, (dict, list)):
                for key in (value if isinstance(value, dict) else range(len(value))):
                    found += [(value, key)] + places(value[key])
            return found
        refused = 0
        for _ in range(400):
            document = json.loads(json.dumps(right))
            if random.random() < 0.5:
                del document["surfaces"]["m"]
            for _ in range(random.randint(1, 2)):
                container, key = random.choice(places(document))
                container[key] = random.choice(values)
            path = write("damaged", document)
            host.empty()
            try:
                import_scene.Importer(bpy.context, path, views.World()).run()
            except InputError:
                refused += 1
        self.assertGreater(refused, 150)
        self.assertLess(refused, 400)


class RoundTrip(unittest.TestCase):
    def test_the_same_answers_from_a_scene_that_went_through_blender(self):
        """Analytic surface, photographs and cameras in; mesh, photographs and exact cameras out: the errors of glint on both."""
        session = os.path.join(host.ROOT, "sessions", "ellipsoid", "scene.json")
        scene = read(session)
        host.select(*[o for o in scene.objects if "glint_surface" in o])
        path = os.path.join(host.folder("round_trip"), "scene.json")
        self.assertEqual(bpy.ops.glint.export_scene(filepath=path, pictures="BACKGROUND"), {"FINISHED"})
        summaries = []
        for file in (session, path):
            done = subprocess.run([host.GLINT, "evaluate", file, "--models", "limit-angle", "--train", "spread:6", "--json", "-"], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            model = json.loads(done.stdout)["models"]["limit-angle"]
            summaries.append((model["summary"], model["fits"][0]["light_position"]))
        (a, lamp_a), (b, lamp_b) = summaries
        print(f"before: {a['contour_error_px']['mean']:.4f} px, after: {b['contour_error_px']['mean']:.4f} px; the lamp moved by "
              f"{1000 * math.dist(lamp_a, lamp_b):.1f} mm")
        self.assertEqual((a["predicted"], a["matched"]), (b["predicted"], b["matched"]))
        self.assertLess(abs(a["contour_error_px"]["mean"] - b["contour_error_px"]["mean"]), 0.02)
        self.assertLess(math.dist(lamp_a, lamp_b), 0.02)  # the facets and normals of the mesh


if __name__ == "__main__":
    host.main()
