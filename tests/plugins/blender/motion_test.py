# SPDX-License-Identifier: BSD-3-Clause
"""Objects that move and lamps that move with the camera, out of Blender and in: against closed forms and what glint says of the same scene."""
import json
import math
import os
import subprocess
import sys
import unittest

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host
from glint_blender import meshes

SPEC = os.path.join(host.ROOT, "tests", "plugins", "moving.json")
CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
SINGLE = 3e-6  # m: Blender's numbers are single precision, a few metres away
TURN = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # to the axes forward -Z, up Y: Blender's (x, y, z) is (x, z, -y)


def document_of(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def place_of(frame):
    """Where the surface of a frame stands."""
    return frame.get("world_from_object", numpy.eye(4).tolist())


def export(name, **options):
    path = os.path.join(host.folder(name), "scene.json")
    assert bpy.ops.glint.export_scene(filepath=path, **{"pictures": "NONE", **options}) == {"FINISHED"}
    return document_of(path), path


def keyed(object_, path, values):
    for frame, value in values.items():
        setattr(object_, path, value)
        object_.keyframe_insert(path, frame=frame)


def at(matrix, points):
    m = numpy.array(matrix)
    return numpy.array(points) @ m[:3, :3].T + m[:3, 3]


def corners(object_, frame):
    """Where the vertices of an object are in a frame, by Blender."""
    bpy.context.scene.frame_set(frame)
    shown = object_.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return numpy.array([shown.matrix_world @ v.co for v in shown.data.vertices])


def farthest(points, others):
    """The largest distance of a point from the nearest of others."""
    return max(numpy.linalg.norm(numpy.array(others) - p, axis=1).min() for p in points)


class Out(unittest.TestCase):
    def setUp(self):
        self.scene = host.empty()
        self.scene.frame_start, self.scene.frame_end = 1, 4
        self.camera = host.camera(location=(0, -8, 0), rotation=(math.pi / 2, 0, 0))
        self.cube = host.mesh("Cube", CUBE, FACES)
        self.cube.scale, self.cube.location = (2, 1, 0.5), (0.3, 0.2, 0.1)
        host.select(self.cube)

    def turning(self, object_):
        keyed(object_, "rotation_euler", {1: (0.1, 0.2, 0.3), 4: (0.5, -0.3, 1.4)})
        keyed(object_, "location", {1: (0.3, 0.2, 0.1), 4: (-0.4, 0.6, 0.3)})

    def check_places(self, document, path, objects, world=numpy.eye(3), scale=1.0):
        for i, frame in enumerate(document["frames"]):
            place = numpy.array(frame["world_from_object"])
            self.assertLess(abs(place[:3, :3] @ place[:3, :3].T - numpy.eye(3)).max(), 1e-12)
            mesh = document["surfaces"][frame["surface"]]["mesh"]
            vertices, _, _ = host.read_ply(os.path.join(os.path.dirname(path), mesh))
            wanted = numpy.concatenate([corners(o, i + 1) for o in objects]) @ world.T * scale
            self.assertLess(farthest(at(place, vertices), wanted), SINGLE)
            self.assertLess(farthest(wanted, at(place, vertices)), SINGLE)

    def test_a_moving_object_is_one_mesh_with_places(self):
        self.turning(self.cube)
        for name, world, scale, options in (("places", numpy.eye(3), 1.0, {}),
                                            ("places_in_other_axes", TURN, 0.5, {"axis_forward": "-Z", "axis_up": "Y", "scale": 0.5})):
            document, path = export(name, **options)
            self.assertEqual((document["glint_scene"], len(document["surfaces"])), (2, 1))
            self.check_places(document, path, [self.cube], world, scale)
            done = subprocess.run([host.GLINT, "info", path, "--json", "-"], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, json.loads(done.stdout)["warnings"]), (0, []), done.stderr)

    def test_objects_that_move_together_and_a_shape_that_changes_on_the_way(self):
        other = host.mesh("Other", CUBE, FACES)
        other.parent, other.location = self.cube, (3, 0.5, 1)
        self.turning(self.cube)
        host.select(self.cube, other)
        document, path = export("together")
        self.assertEqual(len(document["surfaces"]), 1)
        self.check_places(document, path, [self.cube, other])
        self.cube.shape_key_add(name="Basis")
        wide = self.cube.shape_key_add(name="Wide")
        wide.data[0].co.x -= 1
        keyed(wide, "value", {1: 0.0, 3: 1.0})
        document, path = export("changing")
        self.assertEqual([f["surface"] for f in document["frames"]], [f"surface_{i:04d}" for i in (0, 1, 2, 2)])
        self.check_places(document, path, [self.cube, other])

    def test_what_is_no_rigid_motion_of_all_is_a_mesh_for_each_shape(self):
        keyed(self.cube, "scale", {1: (2, 1, 0.5), 2: (2, 1, 0.6)})
        document, _ = export("stretched")
        self.assertEqual((document["glint_scene"], [f["surface"] for f in document["frames"]]),
                         (1, ["surface_0000"] + ["surface_0001"] * 3))
        other = host.mesh("Other", CUBE, FACES)  # stays
        self.cube.animation_data_clear()
        self.turning(self.cube)
        host.select(self.cube, other)
        document, path = export("apart")
        self.assertEqual((document["glint_scene"], len(document["surfaces"])), (1, 4))
        self.assertFalse(any("world_from_object" in f for f in document["frames"]))

    def test_motions_of_stretched_and_flat_objects(self):
        random = host.rng("motions")
        for _ in range(200):
            turn = numpy.linalg.qr([[random.gauss(0, 1) for _ in range(3)] for _ in range(3)])[0]
            turn = numpy.array(turn * numpy.sign(numpy.linalg.det(turn)))
            wanted, before = numpy.eye(4), numpy.eye(4)
            wanted[:3, :3], wanted[:3, 3] = turn, [random.uniform(-3, 3) for _ in range(3)]
            before[:3, :3] = numpy.diag([10 ** random.uniform(-1, 1) for _ in range(3)])
            before[:3, 3] = [random.uniform(-3, 3) for _ in range(3)]
            before = before.astype(numpy.float32).astype(float)
            now = (wanted @ before).astype(numpy.float32).astype(float)
            found = meshes.motion([before.tolist()], [now.tolist()])
            self.assertLess(abs(numpy.array(found) - wanted).max(), 1e-4)  # single precision, a hundredfold by the scales
            bent = now.copy()
            bent[:3, 0] *= 1 + 1e-2
            self.assertIsNone(meshes.motion([before.tolist()], [bent.tolist()]))
        flat = numpy.diag([1.0, 1.0, 0.0, 1.0])
        self.assertIsNone(meshes.motion([flat.tolist()], [numpy.eye(4).tolist()]))
        self.assertIsNone(meshes.motion([numpy.eye(4).tolist()], [numpy.diag([-1.0, 1, 1, 1]).tolist()]))

    def lamp(self, kind, name, parent=None, **values):
        made = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
        self.scene.collection.objects.link(made)
        made.parent = parent
        for key, value in values.items():
            setattr(made, key, value)
        return made

    def test_lamps_of_the_camera(self):
        keyed(self.camera, "location", {1: (0, -8, 0), 4: (3, -7, 1)})
        keyed(self.camera, "rotation_euler", {1: (1.5, 0, 0), 4: (1.4, 0.1, 0.4)})
        self.lamp("POINT", "flash", self.camera, location=(0.2, 0.3, -0.1)).data.shadow_soft_size = 0.02
        self.lamp("SUN", "ray", self.camera, rotation_euler=(math.pi / 2, 0, 0))  # its light comes along the camera's own down
        tube = self.lamp("AREA", "tube", self.camera, location=(0, 0.5, 0))
        tube.data.shape, tube.data.size, tube.data.size_y = "RECTANGLE", 2.0, 0.1
        self.lamp("POINT", "still", location=(1, 2, 3))
        keyed(self.lamp("POINT", "loose"), "location", {1: (0, 0, 4), 4: (1, 0, 4)})
        document, path = export("carried", axis_forward="-Z", axis_up="Y", scale=0.5)
        lights = {light["id"]: light for light in document["lights"]}
        self.assertEqual(document["glint_scene"], 2)
        self.assertEqual({name: light.get("frame") for name, light in lights.items()},
                         {"flash": "camera", "ray": "camera", "tube": "camera", "still": None})
        close = lambda a, b: numpy.testing.assert_allclose(a, b, atol=SINGLE)
        close(lights["flash"]["position"], [0.1, -0.15, 0.05])  # x right, y down, z forward, half a metre a unit
        close(lights["ray"]["direction"], [0, 1, 0])
        close(sorted(lights["tube"]["segment"]), [[-0.5, -0.25, 0], [0.5, -0.25, 0]])
        self.assertTrue(all("lights_on" not in f for f in document["frames"]))  # `loose` is on, too
        bpy.data.objects.remove(bpy.data.objects["loose"])
        document, _ = export("carried_alone")
        self.assertEqual({tuple(sorted(f["lights_on"])) for f in document["frames"]}, {("flash", "ray", "still", "tube")})

    def test_a_camera_that_rests_carries_nothing(self):
        self.lamp("POINT", "flash", self.camera, location=(0.2, 0.3, -0.1))
        document, _ = export("resting")
        self.assertEqual(document["glint_scene"], 1)
        self.assertNotIn("frame", document["lights"][0])


def made(name, **lights):
    """glint synth of tests/plugins/moving.json: the path of its scene."""
    folder = host.folder(name)
    if not os.path.exists(os.path.join(folder, "scene.json")):
        spec = {**document_of(SPEC), **lights}
        with open(os.path.join(folder, "spec.json"), "w", encoding="utf-8") as file:
            json.dump(spec, file)
        subprocess.run([host.GLINT, "synth", os.path.join(folder, "spec.json"), "-o", folder], check=True)
    return os.path.join(folder, "scene.json")


def evaluated(path, models, out="-"):
    words = [host.GLINT, "evaluate", path, "--models", models, "--train", "spread:6", "--json", out]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout) if out == "-" else document_of(out)


def read(path, how, **options):
    host.empty()
    assert bpy.ops.glint.import_scene(filepath=path, cameras=how, **options) == {"FINISHED"}
    return bpy.context.scene


LIGHTS = [{"id": "flash", "frame": "camera", "position": [0.35, -0.25, 0.1], "radius": 0.01},
          {"id": "ray", "frame": "camera", "direction": [0, 0.6, -0.8]},
          {"id": "bar", "frame": "camera", "segment": [[-0.3, 0.2, 0], [0.3, 0.2, 0.1]], "radius": 0.01},
          {"id": "lamp", "position": [1.2, -1.0, 2.2]}]


class In(unittest.TestCase):
    def test_surfaces_and_lamps_move(self):
        document = document_of(made("moving"))
        document["lights"] = LIGHTS
        path = os.path.join(host.folder("moving"), "lamps.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(document, file)
        for how in ("ONE", "EACH"):
            for axes, world, scale in ((("Y", "Z"), numpy.eye(3), 1.0), (("-Z", "Y"), TURN, 0.5)):
                scene = read(path, how, axis_forward=axes[0], axis_up=axes[1], scale=scale)
                body, = (o for o in scene.objects if "glint_surface" in o)
                for i, frame in enumerate(document["frames"]):
                    points = corners(body, i + 1) @ world.T * scale
                    local = at(numpy.linalg.inv(place_of(frame)), points) / [0.6, 0.35, 0.25]
                    self.assertLess(abs((local ** 2).sum(axis=1) - 1).max(), 3e-5)
                    back = numpy.linalg.inv(frame["camera_from_world"])
                    where = lambda name: numpy.array(bpy.data.objects[name].matrix_world)
                    place = lambda name: world @ where(name)[:3, 3] * scale
                    numpy.testing.assert_allclose(place("flash"), at(back, [LIGHTS[0]["position"]])[0], atol=SINGLE)
                    numpy.testing.assert_allclose(world @ where("ray")[:3, 2], back[:3, :3] @ LIGHTS[1]["direction"], atol=SINGLE)
                    ends = at(back, LIGHTS[2]["segment"])
                    numpy.testing.assert_allclose(place("bar"), ends.mean(axis=0), atol=SINGLE)
                    along = world @ where("bar")[:3, 0] * bpy.data.objects["bar"].data.size * scale
                    self.assertLess(min(abs(along - s * (ends[1] - ends[0])).max() for s in (1, -1)), SINGLE)
                    numpy.testing.assert_allclose(place("lamp"), LIGHTS[3]["position"], atol=SINGLE)
                self.assertEqual(bpy.data.objects["flash"].parent, scene.camera if how == "ONE" else None)

    def test_another_frame_is_refused(self):
        document = document_of(made("moving"))
        document["lights"][0]["frame"] = "object"
        path = os.path.join(host.folder("moving"), "refused.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(document, file)
        host.empty()
        with self.assertRaisesRegex(RuntimeError, r"lights\[0\].frame: must be world or camera"):
            bpy.ops.glint.import_scene(filepath=path)

    def test_through_blender_and_out_again(self):
        """A lamp on the camera, and one that stands still, over the object that turns: what glint says of both scenes."""
        for name, lights in (("moving", {}), ("turning", {"lights": [{"id": "lamp", "position": [1.2, -1.0, 2.2]}]})):
            path = made(name, **lights)
            before = document_of(path)
            scene = read(path, "ONE" if name == "moving" else "EACH")
            host.select(*[o for o in scene.objects if "glint_surface" in o])
            pictures = os.path.join(os.path.dirname(path), "frames")
            document, out = export(f"{name}_again", pictures="FOLDER", folder=pictures)
            self.assertEqual((document["glint_scene"], len(document["surfaces"])), (2, 1))
            for old, new in zip(before["frames"], document["frames"]):
                self.assertEqual(old["camera_from_world"], new["camera_from_world"])  # exact cameras
                # The mesh lies where the object stood in the first frame, which `moving.json` calls the identity.
                numpy.testing.assert_allclose(new["world_from_object"], place_of(old), atol=SINGLE)
            for old, new in zip(before["lights"], document["lights"]):
                self.assertEqual(old.get("frame"), new.get("frame"))
                numpy.testing.assert_allclose(new["position"], old["position"], atol=SINGLE)
            a, b = (evaluated(f, "limit-angle")["models"]["limit-angle"] for f in (path, out))
            fits = a["fits"][0], b["fits"][0]
            lamps = [f["light_position"] for f in fits]
            px = [m["summary"]["contour_error_px"]["mean"] for m in (a, b)]
            print(f"{name}: before {px[0]:.4f} px, after {px[1]:.4f} px; the lamp, in the {fits[0]['frame']}, moved by "
                  f"{1000 * math.dist(*lamps):.1f} mm")
            self.assertEqual([f["frame"] for f in fits], ["camera" if name == "moving" else "world"] * 2)
            self.assertLess(abs(px[0] - px[1]), 0.02)
            self.assertLess(math.dist(*lamps), 0.02)  # the facets and normals of the mesh


class Results(unittest.TestCase):
    MODELS = "canonical,limit-angle"

    def shown(self, name, how, **lights):
        path = made(name, **lights)
        folder = os.path.dirname(path)
        evaluation = evaluated(path, self.MODELS, os.path.join(folder, "evaluation.json"))
        session = os.path.join(folder, "run.glint")
        if not os.path.exists(session):
            subprocess.run([host.GLINT, "reconstruct", path, "--model", self.MODELS, "--train", "spread:6", "-o", session], check=True)
            subprocess.run([host.GLINT, "predict", session, "--out", os.path.join(folder, "predictions")], check=True)
        read(path, how)
        kinds = {"ELLIPSOIDS", "LIGHTS", "CAMERAS", "PLANES", "CONTOURS"}
        assert bpy.ops.glint.import_results(filepath=os.path.join(folder, "evaluation.json"), kinds=kinds) == {"FINISHED"}
        return document_of(path), evaluation, document_of(os.path.join(folder, "predictions", "predictions.json"))

    def made(self, kind, model):
        rows = ((o, json.loads(o.get("glint_result", "{}"))) for o in bpy.context.scene.objects)
        return [(o, n) for o, n in rows if n.get("kind") == kind and n.get("model") == model]

    def check(self, name, how, **lights):
        scene, evaluation, predictions = self.shown(name, how, **lights)
        carried = name == "moving"
        for model in self.MODELS.split(","):
            fit = evaluation["models"][model]["fits"][0]
            (lamp, numbers), = self.made("light", model)
            self.assertEqual((numbers["frame"], numbers["light_position"]), ("camera" if carried else "world", fit["light_position"]))
            rows = {r["index"]: r["highlights"] for r in predictions["models"][model]}
            bpy.context.scene.glint.shown_model = model  # Blender moves what is hidden when it is shown
            for i, frame in enumerate(scene["frames"]):
                bpy.context.scene.frame_set(i + 1)
                back = numpy.linalg.inv(frame["camera_from_world"]) if carried else numpy.eye(4)
                numpy.testing.assert_allclose(lamp.matrix_world.translation, at(back, [fit["light_position"][:3]])[0], atol=SINGLE)
                for body, said in self.made("ellipsoid", model):
                    e = said["ellipsoid"]
                    local = at(numpy.linalg.inv(back @ e["world_from_ellipsoid"]), [body.matrix_world @ v.co for v in body.data.vertices])
                    reach = abs(local).max(axis=0)
                    numpy.testing.assert_allclose(reach, e["semi_axes"], atol=1e-4)
                self.check_frame(i, frame, model, rows[i][0], scene)

    def check_frame(self, index, frame, model, highlight, scene):
        """Planes touch the moved object where its peak is seen; contours lie on it and are seen at their pixels."""
        into = numpy.linalg.inv(place_of(frame))
        level = lambda points: ((at(into, points) / [0.6, 0.35, 0.25]) ** 2).sum(axis=1)
        (plane, numbers), = ((o, n) for o, n in self.made("tangent plane", model) if n["index"] == index)
        self.assertLess(abs(level([numbers["point"]])[0] - 1), 1e-9)
        pixel = host.project(scene["camera"], frame["camera_from_world"], numbers["point"])
        self.assertLess(math.dist(pixel, highlight["peak"]), 1e-6)
        outward = into[:3, :3].T @ (at(into, [numbers["point"]])[0] / numpy.array([0.36, 0.1225, 0.0625]))  # the gradient of the ellipsoid
        numpy.testing.assert_allclose(numbers["normal"], outward / numpy.linalg.norm(outward), atol=1e-9)
        corners_ = [plane.matrix_world @ v.co for v in plane.data.vertices]
        numpy.testing.assert_allclose(numpy.mean(corners_, axis=0), numbers["point"], atol=SINGLE)
        (curve, numbers), = ((o, n) for o, n in self.made("contour", model) if n["index"] == index)
        self.assertEqual(numbers["hits"], len(highlight["contour"]))
        points = [p.co.to_3d() for s in curve.data.splines for p in s.points]
        self.assertLess(abs(level(points) - 1).max(), 2e-3)  # facets
        for point, pixel in zip(points, highlight["contour"]):
            self.assertLess(math.dist(host.project(scene["camera"], frame["camera_from_world"], point), pixel), 0.01)

    def test_a_lamp_on_one_animated_camera(self):
        self.check("moving", "ONE")
        for model in self.MODELS.split(","):
            (lamp, _), = self.made("light", model)
            self.assertEqual(lamp.parent, bpy.context.scene.camera)

    def test_predictions_alone(self):
        """Their file does not say in whose coordinates it is."""
        scene, _, predictions = self.shown("moving", "ONE")
        bpy.ops.glint.clear_results()
        path = os.path.join(host.FOLDER, "moving", "predictions", "predictions.json")
        self.assertEqual(bpy.ops.glint.import_results(filepath=path, kinds={"PLANES", "CONTOURS"}, overlays=False), {"FINISHED"})
        for row in predictions["models"]["limit-angle"]:
            self.check_frame(row["index"], scene["frames"][row["index"]], "limit-angle", row["highlights"][0], scene)

    def test_a_lamp_on_the_cameras_of_all_frames(self):
        self.check("moving", "EACH")

    def test_a_lamp_that_stands_still_over_a_moving_object(self):
        self.check("turning", "ONE", lights=[{"id": "lamp", "position": [1.2, -1.0, 2.2]}])

    def test_the_canonical_ellipse_is_where_the_outline_is_seen(self):
        """The ellipse of a tangent plane, seen by the virtual camera, is the outline of the ellipsoid that the camera carries."""
        scene, evaluation, _ = self.shown("moving", "ONE")
        q = numpy.array(evaluation["models"]["canonical"]["fits"][0]["q_dual"])
        virtual = {n["index"]: n for _, n in self.made("virtual camera", "canonical")}
        ellipses = self.made("canonical ellipse", "canonical")
        self.assertEqual(len(ellipses), len(scene["frames"]))
        for _, numbers in ellipses:
            pose = numpy.array(scene["frames"][numbers["index"]]["camera_from_world"])
            back = numpy.linalg.inv(pose)
            seen = numpy.array(virtual[numbers["index"]]["camera_from_world"])[:3]
            outline = numpy.linalg.inv(seen @ back @ q @ back.T @ seen.T)
            for t in numpy.linspace(0, 2 * math.pi, 24):
                point = numpy.array(numbers["centre"]) + numpy.array([math.cos(t), math.sin(t)]) @ numpy.array(numbers["half_axes"])
                x = seen @ numpy.append(point, 1)
                self.assertLess(abs(x @ outline @ x) / (abs(x) @ abs(outline) @ abs(x)), 1e-9)


if __name__ == "__main__":
    host.main()
