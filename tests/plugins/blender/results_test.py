# SPDX-License-Identifier: BSD-3-Clause
"""A run of glint on shipped sessions, and its results as objects: number by number against the JSON, shapes against their equations."""
import json
import math
import os
import subprocess
import sys
import unittest

import bpy
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

SINGLE = 2e-6  # m: objects are single precision, a few metres away


def glint(*words, codes=(0,)):
    done = subprocess.run([host.GLINT, *words], capture_output=True, text=True, check=False)
    assert done.returncode in codes, done.stderr
    return done.stdout


def run(session, models, folder, train=None):
    """What a run leaves, made by the command line alone: (scene, evaluation, predictions) as documents, and the folder."""
    scene = os.path.join(host.ROOT, "sessions", session, "scene.json")
    out = host.folder(folder)
    file = os.path.join(out, "run.glint")
    if not os.path.exists(file):
        spec = ["--train", train or "spread:6"]
        glint("reconstruct", scene, "--model", models, *spec, "--set", "fit.most_residual=0.3", "-o", file)
        glint("predict", file, "--out", os.path.join(out, "predictions"))
        glint("evaluate", file, "--models", models, *spec, "--set", "fit.most_residual=0.3", "--json", os.path.join(out, "evaluation.json"))
    documents = []
    for path in (scene, os.path.join(out, "evaluation.json"), os.path.join(out, "predictions", "predictions.json")):
        with open(path, encoding="utf-8") as opened:
            documents.append(json.load(opened))
    return documents, out, scene


def made(kind, model):
    rows = []
    for object_ in bpy.context.scene.objects:
        numbers = json.loads(object_.get("glint_result", "{}"))
        if numbers.get("kind") == kind and numbers.get("model") == model:
            rows.append((object_, numbers))
    return rows


def importing(session, models, folder, how="EACH", axes=("Y", "Z"), scale=1.0, train=None, **options):
    documents, out, scene_path = run(session, models, folder, train)
    host.empty()
    assert bpy.ops.glint.import_scene(filepath=scene_path, cameras=how, axis_forward=axes[0], axis_up=axes[1], scale=scale) == {"FINISHED"}
    kinds = {"ELLIPSOIDS", "LIGHTS", "CAMERAS", "PLANES", "CONTOURS", "MATERIAL"}
    assert bpy.ops.glint.import_results(filepath=os.path.join(out, "evaluation.json"), kinds=kinds, **options) == {"FINISHED"}
    return documents


class World:
    """Glint's world of a convention, by its definition (tested in cameras_test.py)."""

    def __init__(self, axes, scale):
        unit = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1), "-X": (-1, 0, 0), "-Y": (0, -1, 0), "-Z": (0, 0, -1)}
        f, u = Vector(unit[axes[0]]), Vector(unit[axes[1]])
        self.turn, self.scale = Matrix((f.cross(u), f, u)).transposed(), scale

    def glint(self, point):
        return self.turn @ Vector(point) * self.scale


class Ellipsoid(unittest.TestCase):
    """The shipped session `ellipsoid`, in two conventions."""
    MODELS = "canonical,limit-angle"

    def check(self, axes, scale):
        scene, evaluation, predictions = importing("ellipsoid", self.MODELS, "ellipsoid", axes=axes, scale=scale)
        world = World(axes, scale)
        bpy.context.view_layer.update()
        self.check_ellipsoid(evaluation["models"]["canonical"]["fits"], world)
        for model in ("canonical", "limit-angle"):
            self.check_lamp(evaluation["models"][model]["fits"], model, world)
            rows = {(r["index"], r["light"]): r for r in predictions["models"][model]}
            self.assertEqual(len(rows), 24)
            self.check_planes(rows, model, world)
            self.check_cameras(rows, model, scene, world)
            self.check_contours(rows, model, scene, world)
        self.check_list(evaluation)

    def check_ellipsoid(self, fits, world):
        (object_, numbers), = made("ellipsoid", "canonical")
        e = fits[0]["ellipsoid"]
        self.assertEqual(numbers["ellipsoid"], e)
        back = [[e["world_from_ellipsoid"][j][i] for j in range(3)] for i in range(3)]
        worst, seen = 0.0, [0.0, 0.0, 0.0]
        for vertex in object_.data.vertices:
            x = world.glint(object_.matrix_world @ vertex.co)
            local = [sum(back[i][j] * (x[j] - e["centre"][j]) for j in range(3)) for i in range(3)]
            seen = [max(a, abs(b)) for a, b in zip(seen, local)]
            on = [local[i] / e["semi_axes"][i] if e["semi_axes"][i] > 0 else 0.0 for i in range(3)]
            worst = max(worst, *(abs(local[i]) for i in range(3) if e["semi_axes"][i] == 0.0), 0.0)
            self.assertLessEqual(sum(c * c for c in on), 1 + 1e-4)
            if all(a > 0 for a in e["semi_axes"]):
                self.assertAlmostEqual(sum(c * c for c in on), 1, 4)
        self.assertLess(worst, SINGLE)
        for a, b in zip(seen, e["semi_axes"]):
            self.assertAlmostEqual(a, b, 5)

    def check_lamp(self, fits, model, world):
        (object_, numbers), = made("light", model)
        self.assertEqual(numbers["light_position"], fits[0]["light_position"])
        self.assertEqual(object_.data.type, "POINT")
        self.assertLess((world.glint(object_.matrix_world.translation) - Vector(fits[0]["light_position"][:3])).length, SINGLE)

    def check_planes(self, rows, model, world):
        planes = made("tangent plane", model)
        self.assertEqual(len(planes), sum(len(r["highlights"]) for r in rows.values()))
        for object_, numbers in planes:
            h, = rows[numbers["index"], numbers["light"]]["highlights"]
            self.assertEqual((numbers["point"], numbers["normal"]), (h["brightest_point"], h["normal"]))
            corners = [world.glint(object_.matrix_world @ v.co) for v in object_.data.vertices]
            for corner in corners:
                self.assertLess(abs((corner - Vector(h["brightest_point"])).dot(Vector(h["normal"]))), SINGLE)
            self.assertLess((sum(corners, Vector()) / 4 - Vector(h["brightest_point"])).length, SINGLE)

    def check_cameras(self, rows, model, scene, world):
        """A virtual camera sees a point where the camera sees its mirror image (Eq. mirror)."""
        cameras = made("virtual camera", model)
        self.assertEqual(len(cameras), 24)
        for object_, numbers in cameras[:8]:
            h, = rows[numbers["index"], numbers["light"]]["highlights"]
            p, n = Vector(h["brightest_point"]), Vector(h["normal"])
            pose = scene["frames"][numbers["index"]]["camera_from_world"]
            m = object_.matrix_world
            self.assertLess(m.to_3x3().determinant(), 0)  # left-handed
            mirrored = world.glint(m.translation)
            centre = [-sum(pose[k][i] * pose[k][3] for k in range(3)) for i in range(3)]
            expected = Vector(centre) - 2 * (Vector(centre) - p).dot(n) * n
            self.assertLess((mirrored - expected).length, 1e-5)
            for point in (Vector((0.3, 0.1, 0.9)), Vector((-0.2, 0.4, 1.4))):
                image = point - 2 * (point - p).dot(n) * n
                a = host.project(scene["camera"], pose, image)
                b = host.project(scene["camera"], numbers["camera_from_world"], point)
                self.assertLess(math.dist(a, b), 1e-3)
                # The object itself: a Blender camera looks along its -z, y up.
                local = m.inverted() @ (world.turn.transposed() @ point / world.scale)
                c = (800 * local.x / -local.z + 319.5, 800 * -local.y / -local.z + 239.5)
                self.assertLess(math.dist(a, c), 0.02)

    def check_contours(self, rows, model, scene, world):
        """Each point of a curve lies on the ellipsoid (but for the facets of its mesh) and is seen at the point of the contour."""
        curves = made("contour", model)
        self.assertEqual(len(curves), 24)
        for object_, numbers in curves:
            h, = rows[numbers["index"], numbers["light"]]["highlights"]
            self.assertEqual((numbers["points"], numbers["hits"]), (len(h["contour"]),) * 2)
            points = [world.glint(object_.matrix_world @ p.co.to_3d()) for s in object_.data.splines for p in s.points]
            self.assertEqual((len(points), [s.use_cyclic_u for s in object_.data.splines]), (len(h["contour"]), [True]))
            pose = scene["frames"][numbers["index"]]["camera_from_world"]
            for pixel, x in zip(h["contour"], points):
                self.assertLess(math.dist(host.project(scene["camera"], pose, x), pixel), 0.01)
                level = (x[0] / 0.6) ** 2 + (x[1] / 0.35) ** 2 + (x[2] / 0.25) ** 2
                self.assertLess(level, 1 + 1e-5)  # a chord lies inside
                self.assertGreater(level, math.cos(math.pi / 96) ** 4 - 1e-5)  # 192 steps around, 96 from pole to pole

    def check_list(self, evaluation):
        settings = bpy.context.scene.glint
        self.assertEqual([f.frame_id for f in settings.frames], [f"{i:04d}" for i in range(24)])
        for model in ("canonical", "limit-angle"):
            rows = {r["index"]: r for r in evaluation["models"][model]["frames"]}
            residuals = dict(zip(evaluation["train"], evaluation["models"][model]["fits"][0]["residual_px"]))
            for i, item in enumerate(settings.frames):
                shown = item.of_model(model)
                if i in rows:
                    self.assertEqual((shown["role"], shown["px"], shown["pct"]), ("held out", rows[i]["contour_error_px"], rows[i]["contour_error_pct"]))
                else:
                    self.assertEqual((shown["role"], shown["px"]), ("training", residuals[i]))

    def test_every_number_in_blenders_world(self):
        self.check(("Y", "Z"), 1.0)

    def test_every_number_in_another_world(self):
        self.check(("-Z", "Y"), 0.1)

    def test_objects_show_in_their_own_frame(self):
        importing("ellipsoid", self.MODELS, "ellipsoid")
        scene = bpy.context.scene
        for frame in (1, 7, 24):
            scene.frame_set(frame)
            for kind in ("contour", "tangent plane", "canonical ellipse", "virtual camera"):
                rows = made(kind, "canonical")
                self.assertEqual(len(rows), 24)
                self.assertEqual([n["index"] for o, n in rows if not o.hide_viewport], [frame - 1], kind)
        # Helpers never show in a render, lamps do.
        self.assertTrue(all(o.hide_render for kind in ("contour", "ellipsoid") for o, _ in made(kind, "canonical")))
        self.assertFalse(any(o.hide_render for o, _ in made("light", "canonical")))

    def test_overlays_are_in_the_views(self):
        importing("ellipsoid", self.MODELS, "ellipsoid")
        scene = bpy.context.scene
        _, out, _ = run("ellipsoid", self.MODELS, "ellipsoid")
        for frame in (1, 24):
            scene.frame_set(frame)
            shown = {b.image["glint_slot"]: b for b in scene.camera.data.background_images}
            self.assertEqual({k: b.display_depth for k, b in shown.items()}, {"photograph": "BACK", "overlay": "FRONT"})
            path = os.path.realpath(bpy.path.abspath(shown["overlay"].image.filepath))
            self.assertEqual(path, os.path.realpath(os.path.join(out, "overlays", f"{frame - 1:04d}.png")))
        importing("ellipsoid", self.MODELS, "ellipsoid", how="ONE")
        background = next(b for b in bpy.context.scene.camera.data.background_images if b.image["glint_slot"] == "overlay")
        for frame in (1, 13, 24):
            bpy.context.scene.frame_set(frame)
            path = background.image.filepath_from_user(image_user=background.image_user)
            self.assertEqual(os.path.basename(path), f"{frame - 1:04d}.png")

    def test_overlays_have_the_contours_at_their_pixels(self):
        """Centre of mass of what is drawn, against that of the contours' lengths; the size of the picture is the photograph's."""
        import numpy
        _, _, predictions = importing("ellipsoid", "limit-angle", "ellipsoid_one")
        _, out, _ = run("ellipsoid", "limit-angle", "ellipsoid_one")
        for index in (0, 11, 23):
            image = bpy.data.images.load(os.path.join(out, "overlays", f"{index:04d}.png"))
            self.assertEqual(tuple(image.size), (640, 480))
            alpha = numpy.array(image.pixels[:]).reshape(480, 640, 4)[::-1, :, 3]
            contour = predictions["models"]["limit-angle"][index]["highlights"][0]["contour"]
            ends = list(zip(contour, contour[1:] + contour[:1]))
            lengths = [math.dist(a, b) for a, b in ends]
            expected = [sum(l * (a[k] + b[k]) / 2 for l, (a, b) in zip(lengths, ends)) / sum(lengths) for k in (0, 1)]
            y, x = numpy.mgrid[:480, :640]
            drawn = (x * alpha).sum() / alpha.sum(), (y * alpha).sum() / alpha.sum()
            self.assertLess(math.dist(drawn, expected), 0.1)
            for px, py in contour[::10]:
                self.assertGreater(alpha[round(py), round(px)], 0.5)
            self.assertLess(alpha.sum(), 4 * sum(lengths))

    def test_only_one_model_shines(self):
        importing("ellipsoid", self.MODELS, "ellipsoid")
        settings = bpy.context.scene.glint
        for model in ("canonical", "limit-angle"):
            settings.shown_model = model
            hidden = {c["glint_model"]: (c.hide_viewport, c.hide_render) for c in bpy.data.collections if "glint_model" in c}
            self.assertEqual(hidden, {m: (m != model,) * 2 for m in ("canonical", "limit-angle")})

    def test_undo_takes_everything_back(self):
        _, out, _ = run("ellipsoid", self.MODELS, "ellipsoid")
        _, _, scene_path = run("ellipsoid", self.MODELS, "ellipsoid")
        host.empty()
        bpy.ops.ed.undo_push(message="before")
        self.assertEqual(bpy.ops.glint.import_scene("EXEC_DEFAULT", True, filepath=scene_path), {"FINISHED"})
        count = len(bpy.data.objects)
        self.assertEqual(bpy.ops.glint.import_results("EXEC_DEFAULT", True, filepath=os.path.join(out, "evaluation.json")), {"FINISHED"})
        self.assertGreater(len(bpy.data.objects), count)
        bpy.ops.ed.undo()
        self.assertEqual(len(bpy.data.objects), count)
        self.assertEqual(bpy.context.scene.glint.models_with_results, "[]")
        bpy.ops.ed.undo()
        self.assertEqual((len(bpy.data.objects), len(bpy.context.scene.glint.frames)), (0, 0))
        bpy.ops.ed.redo()
        self.assertEqual(len(bpy.data.objects), count)

    def test_importing_again_replaces_and_clear_removes(self):
        importing("ellipsoid", self.MODELS, "ellipsoid")
        _, out, _ = run("ellipsoid", self.MODELS, "ellipsoid")
        count = len(bpy.data.objects)
        bpy.ops.glint.import_results(filepath=os.path.join(out, "evaluation.json"), kinds={"CONTOURS"}, model="canonical")
        self.assertEqual(sum("glint_result" in o for o in bpy.data.objects), 24)
        self.assertEqual(bpy.ops.glint.clear_results(), {"FINISHED"})
        self.assertEqual(len(bpy.data.objects), 24 + 2)  # cameras, surface, lamp
        self.assertLess(len(bpy.data.objects), count)
        self.assertFalse(bpy.ops.glint.clear_results.poll())
        self.assertNotIn("Glint results", bpy.data.collections)

    def test_results_of_another_scene_or_damaged_ones_are_refused(self):
        _, out, _ = run("ellipsoid", self.MODELS, "ellipsoid")
        importing("plane", "limit-angle", "plane", train="0-3")
        before = len(bpy.data.objects)
        with self.assertRaisesRegex(RuntimeError, "is about frame '00.*another scene"):
            bpy.ops.glint.import_results(filepath=os.path.join(out, "evaluation.json"))
        folder = host.folder("damaged")
        _, plane, _ = run("plane", "limit-angle", "plane", train="0-3")
        with open(os.path.join(plane, "evaluation.json"), encoding="utf-8") as file:
            right = json.load(file)
        damages = [("must be a list of 4 numbers", lambda d: d["models"]["limit-angle"]["fits"][0].update(light_position=[1, 2, 3])),
                   ("must be a number", lambda d: d["models"]["limit-angle"]["fits"][0].update(light_position=[1, 2, 3, "x"])),
                   ("must be a list of objects", lambda d: d["models"]["limit-angle"].update(fits="none")),
                   ("has no key glint_evaluation", lambda d: d.pop("glint_evaluation"))]
        for words, damage in damages:
            wrong = json.loads(json.dumps(right))
            damage(wrong)
            with open(os.path.join(folder, "evaluation.json"), "w", encoding="utf-8") as file:
                json.dump(wrong, file)
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.glint.import_results(filepath=os.path.join(folder, "evaluation.json"))
        with open(os.path.join(folder, "evaluation.json"), "w", encoding="utf-8") as file:
            file.write("[" * 100000)
        with self.assertRaisesRegex(RuntimeError, "is not JSON"):
            bpy.ops.glint.import_results(filepath=os.path.join(folder, "evaluation.json"))
        self.assertEqual(len(bpy.data.objects), before)


def to_segment(p, a, b):
    """Distance of a point from a segment."""
    d = (b[0] - a[0], b[1] - a[1])
    t = min(1.0, max(0.0, ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2)))
    return math.dist(p, (a[0] + t * d[0], a[1] + t * d[1]))


class Canonical(unittest.TestCase):
    def test_ellipse_is_where_lines_from_the_virtual_camera_touch_the_ellipsoid(self):
        """A point of the plane is on the outline where the line through it from the mirrored centre meets the ellipsoid twice at one place."""
        from glint_blender import linear, views
        random, seen = host.rng("canonical ellipse"), 0
        for _ in range(200):
            axes = [random.uniform(0.05, 0.4) for _ in range(3)]
            turn = linear.nearest_rotation([[random.uniform(-1, 1) for _ in range(3)] for _ in range(3)])
            if linear.determinant3(turn) < 0:
                turn = [linear.scaled(row, -1) for row in turn]
            centre = [random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(1.0, 2.0)]
            shape = [[sum(turn[i][k] * axes[k] ** 2 * turn[j][k] for k in range(3)) for j in range(3)] for i in range(3)]
            q = [[centre[i] * centre[j] - shape[i][j] for j in range(3)] + [centre[i]] for i in range(3)] + [centre + [1.0]]
            normal = linear.unit([random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1.0])
            point = [random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.0]
            eye = [random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 3)]
            back = linear.unit(linear.difference(eye, point))
            right, down = linear.frame_around(linear.scaled(back, -1))
            rows = [right, down, linear.scaled(back, -1)]
            pose = linear.with_translation(rows, linear.scaled(linear.product(rows, eye), -1))
            found = views.canonical_ellipse(pose, point, normal, q)
            away = 2 * linear.dot(linear.difference(eye, point), normal)
            mirrored = [e - away * n for e, n in zip(eye, normal)]
            if found is None:
                continue
            seen += 1
            for k in range(12):
                t = 2 * math.pi * k / 12
                x = [found[0][i] + math.cos(t) * found[1][i] + math.sin(t) * found[2][i] for i in range(3)]
                self.assertLess(abs(linear.dot(linear.difference(x, point), normal)), 1e-12)
                unit_ball = lambda v: [sum(turn[k][i] * v[k] for k in range(3)) / axes[i] for i in range(3)]
                o, d = unit_ball(linear.difference(mirrored, centre)), unit_ball(linear.unit(linear.difference(x, mirrored)))
                gap = linear.dot(o, d) ** 2 - linear.dot(d, d) * (linear.dot(o, o) - 1)
                self.assertLess(abs(gap), 1e-9 * linear.dot(o, o) * linear.dot(d, d))
        self.assertGreater(seen, 150)

    def test_no_ellipse_where_there_is_none(self):
        from glint_blender import linear, views
        pose = [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 2], [0, 0, 0, 1]]
        # The mirrored centre, (0, 0, -2), lies inside: every line meets the ellipsoid.
        q = [[-9.0, 0, 0, 0], [0, -9.0, 0, 0], [0, 0, -9.0, 0], [0, 0, 0, 1.0]]
        self.assertIsNone(views.canonical_ellipse(pose, [0, 0, 0], [0, 0, 1], q))
        self.assertIsNone(views.canonical_ellipse(pose, [0, 0, 0], [0, 0, 1], [[0.0] * 4] * 4))
        self.assertIsNone(linear.ellipse_of_conic([[1, 0, 0], [0, -1, 0], [0, 0, -1]]))  # hyperbola
        self.assertIsNone(linear.ellipse_of_conic([[1, 0, 0], [0, 1, 0], [0, 0, 1]]))    # imaginary
        centre, axes, angle = linear.ellipse_of_conic([[-1 / 9, 0, 2 / 9], [0, -1, 3], [2 / 9, 3, -8 - 4 / 9]])  # (x - 2)^2 / 9 + (y - 3)^2 = 1
        self.assertEqual([round(v, 9) for v in centre + axes + [math.sin(angle) + 0.0]], [2, 3, 3, 1, 0])

    def test_on_a_plane_it_is_the_contour(self):
        """On a flat surface the canonical contour is the contour itself: prediction and ellipse come from different parts of the program."""
        scene, _, predictions = importing("plane", "canonical", "plane_canonical", train="0-3")
        rows = {r["index"]: r for r in predictions["models"]["canonical"]}
        ellipses = made("canonical ellipse", "canonical")
        self.assertEqual(len(ellipses), 6)
        worst = 0.0
        for _, numbers in ellipses:
            pose = scene["frames"][numbers["index"]]["camera_from_world"]
            contour = rows[numbers["index"]]["highlights"][0]["contour"]
            points = [[c + math.cos(t) * a + math.sin(t) * b for c, a, b in zip(numbers["centre"], *numbers["half_axes"])]
                      for t in (2 * math.pi * k / 360 for k in range(360))]
            pixels = [host.project(scene["camera"], pose, p) for p in points]
            worst = max(worst, *(min(to_segment(p, a, b) for a, b in zip(pixels, pixels[1:] + pixels[:1])) for p in contour[::4]))
        print(f"largest distance of a predicted contour from its canonical ellipse: {worst:.3f} px")
        self.assertLess(worst, 0.02)


class Material(unittest.TestCase):
    def test_roughness_is_the_square_root_of_the_width(self):
        from glint_blender import materials
        host.empty()
        made_one = materials.material("m", "torrance-sparrow", 0.09)
        node = next(n for n in made_one.node_tree.nodes if n.type.startswith("BSDF_GLOSSY") or "Glossy" in n.bl_idname)
        self.assertAlmostEqual(node.inputs["Roughness"].default_value, 0.3, 6)  # as the shared data were rendered: 0.3, alpha 0.09
        self.assertEqual(node.distribution, "BECKMANN")
        self.assertEqual(next(n for n in materials.material("g", "ggx", 0.04).node_tree.nodes if "Glossy" in n.bl_idname).distribution, "GGX")


if __name__ == "__main__":
    host.main()
