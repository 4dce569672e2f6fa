#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The JSON Schemas of resources say what the program reads: every scene and session that is shipped, stands in docs/formats.md or is written by
the program is valid, and what a schema refuses the program refuses, too.

    tests/schemas/schemas_test.py --program build/ci/bin/glint [unittest's arguments]

Exit code 77 (skipped) where the Python module jsonschema is missing."""
import copy
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

root = pathlib.Path(__file__).resolve().parent.parent.parent
program = None

try:
    import jsonschema
except ImportError:
    print("schemas: the Python module jsonschema is missing (Debian: python3-jsonschema)")
    sys.exit(77)


def validator(name):
    schema = json.loads((root / "resources" / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


VALID = {name: validator(name) for name in ("scene", "session")}


def complaints(document):
    """What the schema of a scene or session has against it, one line each."""
    kind = "session" if "glint_session" in document else "scene"
    return [f"{e.json_path}: {e.message[:200]}" for e in VALID[kind].iter_errors(document)]


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def glint(*arguments, cwd=None):
    return subprocess.run([program, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, encoding="utf-8", check=False)


def examples():
    """The scenes and sessions of docs/formats.md, in its order."""
    blocks = re.findall(r"^```json\n(.*?)^```$", (root / "docs/formats.md").read_text(encoding="utf-8"), re.M | re.S)
    documents = [json.loads(block) for block in blocks]
    return [d for d in documents if "glint_scene" in d or "glint_session" in d]


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def assertValid(self, path):
        self.assertEqual(complaints(read(path)), [], path)

    def run_glint(self, *arguments):
        done = glint(*arguments, cwd=self.folder)
        self.assertEqual(done.returncode, 0, f"glint {' '.join(map(str, arguments))}: {done.stderr}")


class Shipped(InFolder):
    def check(self, paths, least):
        paths = sorted(paths)
        self.assertGreaterEqual(len(paths), least, "files are missing")
        for path in paths:
            with self.subTest(path=path.relative_to(root)):
                self.assertValid(path)

    def test_scenes(self):
        self.check((root / "sessions").rglob("scene.json"), 11)

    def test_sessions(self):
        self.check((root / "sessions").rglob("*.glint"), 11)

    def test_scenes_that_tests_read(self):
        # very_deep.json is damaged on purpose.
        self.check([p for p in (root / "tests/fuzz/corpus/scene").glob("*.json") if p.name != "very_deep.json"], 11)

    def test_sessions_that_tests_read(self):
        self.check((root / "tests/core/app/fixtures").glob("*.glint"), 4)
        self.check([p for p in (root / "tests/fuzz/corpus/session").glob("*.json") if "-damaged" not in p.name], 8)

    def test_damaged_sessions_of_the_corpus_are_refused(self):
        damaged = sorted((root / "tests/fuzz/corpus/session").glob("*-damaged*.json"))
        self.assertGreaterEqual(len(damaged), 5)
        for path in damaged:
            with self.subTest(path=path.name):
                self.assertNotEqual(complaints(read(path)), [])
                shutil.copy(path, self.folder / "damaged.glint")
                done = glint("replay", "damaged.glint", cwd=self.folder)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr, r"damaged\.glint: (request\.what_if\.edits|plugins)")


class Page(InFolder):
    """docs/formats.md: its examples are valid, and what it says about the first one holds."""

    def test_examples(self):
        self.assertEqual(len(examples()), 3)
        for document in examples():
            self.assertEqual(complaints(document), [])

    def test_first_scene_and_its_session(self):
        scene, other, session = examples()
        (self.folder / "scene.json").write_text(json.dumps(scene), encoding="utf-8")
        (self.folder / "run.glint").write_text(json.dumps(session), encoding="utf-8")
        self.run_glint("info", "scene.json")
        self.run_glint("evaluate", "scene.json", "--models", "limit-angle", "--train", "left,front", "--json", "a.json")
        self.run_glint("evaluate", "run.glint", "--json", "b.json")
        for name in ("a.json", "b.json"):
            model = read(self.folder / name)["models"]["limit-angle"]
            fit = model["fits"][0]
            for value, said in zip(fit["light_position"], (0, 0, 1, 1)):
                self.assertAlmostEqual(value, said, delta=0.005)
            self.assertAlmostEqual(fit["limit_angle_deg"], 3, delta=0.05)
            self.assertAlmostEqual(model["summary"]["contour_error_pct"]["mean"], 2.7, delta=0.1)
        (self.folder / "scene.json").write_text(json.dumps(other), encoding="utf-8")
        self.run_glint("info", "scene.json")


class Written(InFolder):
    def test_synth(self):
        # The contours of a tube take a minute.
        specs = sorted(p for p in (root / "resources/specs/auto").glob("*.json") if p.stem != "tube_light")
        self.assertGreaterEqual(len(specs), 6)
        for spec in specs:
            with self.subTest(spec=spec.name):
                self.run_glint("synth", spec, "-o", spec.stem)
                self.assertValid(self.folder / spec.stem / "scene.json")

    def test_synth_with_images(self):
        spec = {key: examples()[0][key] for key in ("surfaces", "frames")}
        spec["camera"] = {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5, "distortion": [0.01, 0, 0, 0, 0]}
        spec["lights"] = [{"id": "lamp", "position": [0, 0, 1], "radius": 0.01}]
        spec["render"] = {"roughness": 0.05, "diffuse": 0.2}
        (self.folder / "spec.json").write_text(json.dumps(spec), encoding="utf-8")
        self.run_glint("synth", "spec.json", "-o", "made")
        self.assertValid(self.folder / "made/scene.json")
        for key in ("image", "radiance", "depth", "normals", "mask"):
            self.assertTrue((self.folder / "made" / read(self.folder / "made/scene.json")["frames"][0][key]).is_file())

    def test_convert(self):
        for name in ("ellipsoid", "vase", "two-lamps"):
            with self.subTest(name=name):
                out = self.folder / f"{name}.json"
                self.run_glint("convert", root / "sessions" / name / f"{name}.glint", "-o", out)
                self.assertValid(out)

    def test_reconstruct_and_tradeoff(self):
        (self.folder / "scene.json").write_text(json.dumps(examples()[0]), encoding="utf-8")
        self.run_glint("reconstruct", "scene.json", "--model", "limit-angle", "--train", "left,front", "-o", "run.glint")
        self.assertValid(self.folder / "run.glint")
        self.run_glint("tradeoff", "run.glint", "--max-trials", "2", "--repeats", "1", "-o", "fast.glint")
        self.assertValid(self.folder / "fast.glint")
        self.assertIsNotNone(read(self.folder / "fast.glint")["tradeoff"])


def put(*path_and_value):
    """A change of a document: the value at a path, or ... to remove it."""
    *path, last, value = path_and_value

    def change(document):
        at = document
        for key in path:
            at = at[key]
        if value is ...:
            del at[last]
        else:
            at[last] = value

    return change


FRAME, SHAPE, GIVEN = ("frames", 0), ("surfaces", "plate", "analytic"), ("frames", 0, "highlights", 0)
SCENES_REFUSED = {
    "version": put("glint_scene", 3),
    "no version": put("glint_scene", ...),
    "units": put("units", "mm"),
    "no camera": put("camera", ...),
    "no frames": put("frames", []),
    "id is a number": put(*FRAME, "id", 3),
    "id is empty": put(*FRAME, "id", ""),
    "id with a line end": put(*FRAME, "id", "a\nb"),
    "empty path": put(*FRAME, "image", ""),
    "depth scale 0": put(*FRAME, "depth_scale", 0),
    "pose of three rows": lambda d: d["frames"][0]["camera_from_world"].pop(),
    "pose with a last row of its own": put(*FRAME, "camera_from_world", 3, [0, 0, 1, 1]),
    "pose too far": put(*FRAME, "camera_from_world", 0, 3, 1e16),
    "null camera": put(*FRAME, "camera", None),
    "width of half a pixel": put("camera", "width", 640.5),
    "too wide": put("camera", "width", 65537),
    "negative focal length": put("camera", "fx", -800),
    "principal point too far": put("camera", "cx", 1e10),
    "three distortions": put("camera", "distortion", [0, 0, 0]),
    "another model": put("camera", "model", "DIVISION"),
    "model in small letters": put("camera", "model", "opencv"),
    "no model": put("camera", "model", None),
    "one term too few": lambda d: d["camera"].update(model="OPENCV_FISHEYE", distortion=[0, 0, 0]),
    "one term too many": lambda d: d["camera"].update(model="OPENCV_FISHEYE", distortion=[0, 0, 0, 0, 0]),
    "five terms of eight": lambda d: d["camera"].update(model="FULL_OPENCV", distortion=[0, 0, 0, 0, 0]),
    "seven terms of eight": lambda d: d["camera"].update(model="THIN_PRISM_FISHEYE", distortion=[0] * 7),
    "two terms of one": lambda d: d["camera"].update(model="SIMPLE_RADIAL", distortion=[0, 0]),
    "one term of two": lambda d: d["camera"].update(model="RADIAL", distortion=[0]),
    "a field of view of a full turn": lambda d: d["camera"].update(model="FOV", distortion=[6.2831853]),
    "four points": put(*GIVEN, "contour", [[0, 0], [9, 0], [9, 9], [0, 9]]),
    "no peak": put(*GIVEN, "peak", ...),
    "point of three": put(*GIVEN, "peak", [1, 2, 3]),
    "level 1": put(*GIVEN, "level", 1),
    "light without a name": put(*GIVEN, "light", ""),
    "mesh and analytic": put("surfaces", "plate", {"mesh": "a.ply", "analytic": {"type": "plane"}}),
    "surface of nothing": put("surfaces", "plate", {}),
    "surface without a name": put("surfaces", "", {"analytic": {"type": "plane"}}),
    "another shape": put(*SHAPE, "type", "cone"),
    "sphere without radius": put(*SHAPE, "type", "sphere"),
    "negative radius": put("surfaces", "plate", "analytic", {"type": "cylinder", "radius": -1}),
    "flat ellipsoid": put("surfaces", "plate", "analytic", {"type": "ellipsoid", "semi_axes": [1, 1, 0]}),
    "sheet without curvature": put(*SHAPE, "type", "sheet"),
    "sheet of no length": put("surfaces", "plate", "analytic", {"type": "sheet", "curvature": 1, "length": 0}),
    "torus of one radius": put("surfaces", "plate", "analytic", {"type": "torus", "major_radius": 1}),
    "quadric without matrix": put(*SHAPE, "type", "quadric"),
    "pose of a shape": put(*SHAPE, "world_from_surface", [[1, 0, 0, 0]] * 4),
    "lamp in two places": put("lights", [{"id": "a", "position": [0, 0, 1], "direction": [0, 0, 1]}]),
    "lamp nowhere": put("lights", [{"id": "a"}]),
    "segment of one end": put("lights", [{"id": "a", "segment": [[0, 0, 1]]}]),
    "negative size": put("lights", [{"id": "a", "position": [0, 0, 1], "radius": -1}]),
}
SCENES_ACCEPTED = {
    "as it is": lambda d: None,
    "null paths": lambda d: d["frames"][0].update(image=None, radiance=None, depth=None, normals=None, mask=None, surface=None),
    "unknown keys": lambda d: (d.update(note=1), d["frames"][0].update(exif={"f": 2}), d["camera"].update(response="linear")),
    "cameras of frames": lambda d: ([f.update(camera=d["camera"]) for f in d["frames"]], d.pop("camera")),
    "four distortions": put("camera", "distortion", [0.01, 0, 0, 0]),
    "a model without distortion": put("camera", "model", "OPENCV_FISHEYE"),
    "the default model": put("camera", "model", "OPENCV"),
    "one term": lambda d: d["camera"].update(model="FOV", distortion=[0.1]),
    "two terms": lambda d: d["camera"].update(model="RADIAL_FISHEYE", distortion=[0.1, 0]),
    "four terms": lambda d: d["camera"].update(model="OPENCV_FISHEYE", distortion=[0.1, 0, 0, 0]),
    "eight terms": lambda d: d["camera"].update(model="THIN_PRISM_FISHEYE", distortion=[0.1, 0, 0, 0, 0, 0, 0, 0]),
    "a term of NVM": lambda d: d["camera"].update(model="VISUALSFM", distortion=[0.1]),
    "whole number with a point": put("camera", "width", 640.0),
    "every shape": lambda d: (
        d["surfaces"].update({
            "b": {"analytic": {"type": "sphere", "radius": 1}}, "c": {"analytic": {"type": "ellipsoid", "semi_axes": [1, 2, 3]}},
            "d": {"analytic": {"type": "cylinder", "radius": 1}}, "e": {"analytic": {"type": "sheet", "curvature": 0, "width": 1}},
            "f": {"analytic": {"type": "torus", "major_radius": 2, "minor_radius": 1}},
            "g": {"analytic": {"type": "quadric", "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]}}}),
        [f.update(surface="plate") for f in d["frames"]]),
    "every light": put("lights", [{"id": "a", "position": [0, 0, 1], "radius": 0}, {"id": "b", "direction": [0, 0, 5]},
                                  {"id": "c", "segment": [[0, 0, 1], [1, 0, 1]], "radius": 0.1}]),
}
SESSIONS_REFUSED = {
    "a newer version": put("glint_session", 5),
    "version 0": put("glint_session", 0),
    "no input": put("input", ...),
    "no path": put("input", "path", ...),
    "empty path": put("input", "path", ""),
    "folder of another kind": put("input", "folders", [{"of": "meshes", "folder": "a"}]),
    "short hash": put("input", "files", 0, "sha256", "abc"),
    "no models": put("request", "models", ...),
    "no training frames": put("request", "train", ...),
    "excluded by name": put("request", "excluded", ["left"]),
    "another source": put("request", "source", "raw"),
    "negative noise": put("request", "noise_px", -1),
    "seed of half": put("request", "seed", 0.5),
    "setting is a list": put("request", "settings", "detect.level", [0.5]),
    "frames without held out ones": put("frames", "held_out", ...),
    "camera without up": put("view", "cameras", {"scene": {"position": [0, 0, 1], "focal_point": [0, 0, 0], "view_angle_deg": 30}}),
    "field of view": put("view", "cameras", {"scene": {"position": [0, 0, 1], "focal_point": [0, 0, 0], "up": [0, 1, 0], "view_angle_deg": 180}}),
    "layer is a number": put("view", "layers", {"rays": 1}),
    "notes are a list": put("notes", []),
    "key result is text": put("results", "key_results", {"a": "1"}),
    "no digest": put("results", "digest", ...),
    "a lamp switched in no frame": put("request", "what_if", {"lights_switched": [{"light": "lamp", "on": True}]}),
    "an unknown lobe": put("request", "what_if", {"synthesise": {"lobe": "gloss", "roughness": 0.1}}),
    "trade-off without points": put("tradeoff", {"glint_tradeoff": 1}),
}
SESSIONS_ACCEPTED = {
    "as it is": lambda d: None,
    "nulls": lambda d: (d.update(tradeoff=None, results=None, recovery=None), d["request"].update(truth=None), d["input"].update(photographs=None, meshes=None)),
    "unknown keys": put("mine", {"a": 1}),
    "version 1": put("glint_session", 1),
    "a lamp switched off": put("request", "what_if", {"lights_switched": [{"frame": 2, "light": "light", "on": False}]}),
}


class SameVerdict(InFolder):
    """Documents that differ by one thing from a good one: schema and program refuse, or accept, the same ones."""

    def check(self, base, cases, name, command, accepted):
        for what, change in cases.items():
            with self.subTest(case=what):
                document = copy.deepcopy(base)
                change(document)
                (self.folder / name).write_text(json.dumps(document), encoding="utf-8")
                done = glint(*command, cwd=self.folder)
                by_schema = complaints(document)
                self.assertEqual(by_schema == [], accepted, f"by the schema: {by_schema}")
                self.assertEqual(done.returncode, 0 if accepted else 2, f"by the program: {done.stderr}")

    def scene(self):
        return examples()[0]

    def session(self):
        (self.folder / "scene.json").write_text(json.dumps(self.scene()), encoding="utf-8")
        self.run_glint("reconstruct", "scene.json", "--model", "limit-angle", "--train", "left,front", "-o", "run.glint")
        return read(self.folder / "run.glint")

    def test_scenes_refused(self):
        self.check(self.scene(), SCENES_REFUSED, "scene.json", ("convert", "scene.json", "-o", "out.json"), False)

    def test_scenes_accepted(self):
        self.check(self.scene(), SCENES_ACCEPTED, "scene.json", ("convert", "scene.json", "-o", "out.json"), True)

    def test_keys_that_would_change_the_geometry(self):
        schema = VALID["scene"].schema
        places = {(): schema, ("camera",): schema["$defs"]["camera"], FRAME: schema["$defs"]["frame"],
                  ("surfaces", "plate"): schema["$defs"]["surface"]}
        for path, part in places.items():
            keys = part["propertyNames"]["not"]["enum"]
            self.assertGreater(len(keys), 10)
            key = keys[0]  # the program looks the others up in the same list
            self.check(self.scene(), {f"{path} {key}": put(*path, key, 1)}, "scene.json", ("convert", "scene.json", "-o", "out.json"), False)

    def test_every_such_key_of_the_program_is_in_the_schema(self):
        text = "".join((root / file).read_text(encoding="utf-8") for file in ("core/scene/scene_json.cpp", "core/geometry/camera_json.cpp"))
        schema = VALID["scene"].schema
        for name, part in (("Scene", schema), ("Camera", schema["$defs"]["camera"]), ("Frame", schema["$defs"]["frame"]),
                           ("Surface", schema["$defs"]["surface"])):
            with self.subTest(part=name):
                found = re.search(rf"k{name}Geometry = \{{(.*?)\}};", text, re.S)
                self.assertIsNotNone(found)
                self.assertEqual(set(re.findall(r'"(\w+)"', found[1])), set(part["propertyNames"]["not"]["enum"]))

    def test_sessions_refused(self):
        self.check(self.session(), SESSIONS_REFUSED, "run.glint", ("render", "run.glint", "--view", "plots", "-o", "out.png"), False)

    def test_sessions_accepted(self):
        self.check(self.session(), SESSIONS_ACCEPTED, "run.glint", ("predict", "run.glint", "--json", "out.json"), True)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if arguments[:1] != ["--program"] or len(arguments) < 2:
        sys.exit("schemas_test.py: --program FILE is missing (see the first lines of the script)")
    program = str(pathlib.Path(arguments[1]).resolve())
    unittest.main(argv=[sys.argv[0], *arguments[2:]])
