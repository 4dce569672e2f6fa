# SPDX-License-Identifier: BSD-3-Clause
"""The program beside Blender: found or not, too old, its messages, its progress, and its end on request; the operator from start to end."""
import json
import os
import shutil
import stat
import sys
import tempfile
import time
import unittest

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

ELLIPSOID = os.path.join(host.ROOT, "sessions", "ellipsoid", "scene.json")


def script(name, text):
    """A program of its own in place of glint."""
    path = os.path.join(host.folder("programs"), name)
    with open(path, "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\n" + text)
    os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    return path


def alive(pid):
    """Whether a process runs (one that has ended but was not waited for does not)."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class Program(unittest.TestCase):
    def setUp(self):
        host.empty()
        self.preferences = bpy.context.preferences.addons["glint_blender"].preferences

    def check(self, words):
        with self.assertRaisesRegex(RuntimeError, words):
            bpy.ops.glint.check_program()
        bpy.context.scene.glint.folder = host.folder("refused")
        bpy.context.scene.glint.origin, bpy.context.scene.glint.input = "FILE", ELLIPSOID
        with self.assertRaisesRegex(RuntimeError, words):
            bpy.ops.glint.run()
        self.assertEqual(os.listdir(host.folder("refused")), [])

    def test_right_one(self):
        self.assertEqual(bpy.ops.glint.check_program(), {"FINISHED"})
        self.preferences.program = os.path.dirname(host.GLINT)  # its folder will do
        self.assertEqual(bpy.ops.glint.check_program(), {"FINISHED"})

    def test_missing_old_or_another(self):
        self.preferences.program = os.path.join(host.FOLDER, "nowhere", "glint")
        self.check("nowhere/glint: is no program; name the program glint in the add-on's preferences")
        path, os.environ["PATH"] = os.environ["PATH"], host.folder("nothing")
        self.preferences.program = ""
        self.check("was not found on PATH; name the program in the add-on's preferences")
        os.environ["PATH"] = path
        self.preferences.program = script("old", "echo glint 0.0.9\n")
        self.check(r"is glint 0\.0\.9; this add-on needs 0\.1\.0 or newer")
        self.preferences.program = script("other", "echo something 1.2.3\n")
        self.check("it is another program")
        self.preferences.program = script("fails", "exit 5\n")
        self.check("it is another program")
        self.preferences.program = script("newer", "echo glint 0.10.0-beta\n")
        self.assertEqual(bpy.ops.glint.check_program(), {"FINISHED"})


class Jobs(unittest.TestCase):
    def test_progress_messages_and_code(self):
        from glint_blender import program
        job = program.Job(["/bin/sh", "-c", "printf '\\r\\033[Kfitting 3 of 12' >&2; sleep 0.4; printf '\\r\\033[Kglint: warning: careful\\n' >&2; "
                                            "printf '\\r\\033[Ksome stage ...' >&2; sleep 0.4; printf '\\r\\033[K' >&2; "
                                            "echo 'glint: FILE: PLACE: reason' >&2; echo out; exit 3"])
        seen = set()
        while job.poll() is None:
            seen.add(job.progress())
            time.sleep(0.02)
        self.assertIn(("fitting", 0.25), seen)
        self.assertIn(("some stage", None), seen)
        self.assertEqual((job.poll(), job.messages, job.output), (3, ["warning: careful", "FILE: PLACE: reason"], b"out\n"))

    def test_glint_shows_progress_to_it(self):
        from glint_blender import program
        sequence = program.Sequence([("Fit", [host.GLINT, "evaluate", ELLIPSOID, "--models", "reflectance,limit-angle", "--train", "spread:6"], {0})])
        stages = set()
        while not sequence.done():
            text, part = sequence.progress()
            stages.add(text)
            self.assertTrue(0 <= part <= 1)
            time.sleep(0.02)
        self.assertEqual(sequence.failed, "")
        self.assertGreater(len(stages), 2, stages)

    def test_more_output_than_a_pipe_holds(self):
        from glint_blender import program
        job = program.Job(["/bin/sh", "-c", "head -c 3000000 /dev/zero | tr '\\0' x; head -c 3000000 /dev/zero | tr '\\0' y >&2"])
        self.assertEqual(job.wait(60), 0)
        self.assertEqual(len(job.output), program.KEPT)

    def test_a_failed_step_ends_the_sequence_with_its_message(self):
        from glint_blender import program
        mark = os.path.join(host.folder("sequence"), "third")
        steps = [("One", ["/bin/sh", "-c", "exit 3"], {0, 3}), ("Two", [host.GLINT, "info", "/nowhere/scene.json"], {0}), ("Three", ["touch", mark], {0})]
        sequence = program.Sequence(steps)
        sequence.finish()
        self.assertRegex(sequence.failed, "^Two: /nowhere/scene.json: ")
        self.assertFalse(os.path.exists(mark))

    def test_cancel_ends_glint_and_leaves_nothing(self):
        from glint_blender import program
        out = host.folder("cancelled")
        command = [host.GLINT, "tradeoff", ELLIPSOID, "--train", "spread:6", "--json", os.path.join(out, "t.json"), "--work", os.path.join(out, "w")]
        job = program.Job(command)
        time.sleep(1.0)
        self.assertIsNone(job.poll())
        pid = job.process.pid
        self.assertTrue(alive(pid))
        start = time.monotonic()
        job.cancel()
        self.assertEqual(job.wait(10), 130)
        self.assertLess(time.monotonic() - start, 3)
        self.assertFalse(alive(pid))
        self.assertFalse(os.path.exists(os.path.join(out, "t.json")))

    def test_what_does_not_end_is_killed_with_its_children(self):
        from glint_blender import program
        note = os.path.join(host.folder("stubborn"), "child")
        job = program.Job(["/bin/sh", "-c", f"trap '' TERM; sleep 300 & echo $! > {note}; wait; wait; sleep 300"])
        while not os.path.exists(note) or not os.path.getsize(note):
            time.sleep(0.02)
        time.sleep(0.2)
        with open(note, encoding="ascii") as file:
            child = int(file.read())
        self.assertTrue(alive(child))
        job.cancel()
        start = time.monotonic()
        while job.poll() is None:
            self.assertLess(time.monotonic() - start, 20)
            time.sleep(0.05)
        for _ in range(100):
            if not alive(child):
                break
            time.sleep(0.05)
        self.assertFalse(alive(child))


class Operator(unittest.TestCase):
    def setUp(self):
        self.scene = host.empty()
        self.assertEqual(bpy.ops.glint.import_scene(filepath=ELLIPSOID), {"FINISHED"})

    def test_from_scene_file_to_errors(self):
        settings = self.scene.glint
        self.assertFalse(bpy.ops.glint.run.poll())  # no folder yet
        settings.folder = host.folder("run")
        settings.models, settings.training = {"limit-angle"}, "CHOSEN"
        with self.assertRaisesRegex(RuntimeError, "no frame is ticked"):
            bpy.ops.glint.run()
        for i in (0, 5, 10, 15, 20):
            settings.frames[i].train = True
        self.assertEqual(bpy.ops.glint.run(), {"FINISHED"})
        with open(os.path.join(settings.folder, "evaluation.json"), encoding="utf-8") as file:
            document = json.load(file)
        self.assertEqual(document["train"], [0, 5, 10, 15, 20])
        errors = {r["index"]: r["contour_error_pct"] for r in document["models"]["limit-angle"]["frames"]}
        self.assertEqual({i: f.of_model("limit-angle").get("pct") for i, f in enumerate(settings.frames) if i not in document["train"]}, errors)
        self.assertEqual(bpy.ops.glint.step(worst=True), {"FINISHED"})
        worst = max(errors, key=errors.get)
        self.assertEqual((settings.active, self.scene.frame_current, self.scene.camera.name), (worst, worst + 1, f"{worst:04d}"))
        bpy.ops.glint.step(by=1)
        self.assertEqual(settings.active, (worst + 1) % 24)
        settings.active = 3  # as a click into the list
        self.assertEqual(self.scene.frame_current, 4)
        bpy.ops.glint.step(by=-4)
        self.assertEqual(settings.active, 23)

    def test_failures_of_glint_are_told(self):
        settings = self.scene.glint
        settings.folder = host.folder("failing")
        settings.more = "detect.level=2"
        with self.assertRaisesRegex(RuntimeError, "Fit: .*detect.level"):
            bpy.ops.glint.run()
        settings.more = "rm -rf"
        with self.assertRaisesRegex(RuntimeError, "settings: rm: must be KEY=VALUE"):
            bpy.ops.glint.run()
        settings.more, settings.models, settings.count, settings.training = "", {"canonical"}, 2, "FIRST"
        with self.assertRaisesRegex(RuntimeError, "Fit: too few views"):
            bpy.ops.glint.run()
        self.assertEqual(sum("glint_result" in o for o in bpy.data.objects), 0)
        settings.folder = "//here"
        with self.assertRaisesRegex(RuntimeError, "is relative to the .blend file, which is not saved yet"):
            bpy.ops.glint.run()

    def test_paths_of_a_stranger_s_file_are_no_options(self):
        from glint_blender import run
        for word in ("--plugin=/nowhere/evil.png", "relative/scene.json"):
            self.assertEqual(run.absolute(word), os.path.join(os.getcwd(), word))

    def test_what_is_written_follows_no_link(self):
        from glint_blender import module_run, overlays
        with tempfile.TemporaryDirectory() as folder:
            victim = os.path.join(folder, "victim")
            with open(victim, "w", encoding="ascii") as file:
                file.write("precious")
            for name in (".evaluation.json.tmp", "evaluation.json", "overlays"):
                os.symlink(victim, os.path.join(folder, name))
            module_run.write(os.path.join(folder, "evaluation.json"), "{}")
            with self.assertRaisesRegex(Exception, "is not of an earlier run"):
                overlays.prepared(folder)
            with open(victim, encoding="ascii") as file:
                self.assertEqual(file.read(), "precious")
            self.assertEqual(sorted(os.listdir(folder)), [".evaluation.json.tmp", "evaluation.json", "overlays", "victim"])

    def test_presets_keep_the_request(self):
        settings = self.scene.glint
        asked = {"models": {"dual", "reflectance"}, "training": "FIRST", "count": 9, "source": "image", "more": "fit.lobe=ggx"}
        before = {name: getattr(settings, name) for name in asked}
        for name, value in asked.items():
            setattr(settings, name, value)
        self.assertEqual(bpy.ops.glint.preset_add(name="Shiny"), {"FINISHED"})
        for name, value in before.items():
            setattr(settings, name, value)
        path = os.path.join(os.environ["BLENDER_USER_SCRIPTS"], "presets", "glint", "run", "Shiny.py")
        bpy.ops.script.execute_preset(filepath=path, menu_idname="GLINT_MT_presets")
        self.assertEqual({name: getattr(settings, name) for name in asked}, asked)

    def test_commands_say_what_the_panel_says(self):
        from glint_blender import run
        settings = self.scene.glint
        settings.models, settings.training, settings.count, settings.level = {"canonical", "dual"}, "FIRST", 4, 0.3
        settings.more, settings.source = "fit.solver=linear surface.normals=facet", "image"
        steps = run.commands("glint", settings, "scene.json", "out")
        common = ["--train", "first:4", "--source", "image", "--set", "detect.level=0.3", "--set", "fit.solver=linear", "--set", "surface.normals=facet"]
        self.assertEqual(steps[0][1], ["glint", "reconstruct", "--model", "canonical,dual", *common, "-o", os.path.join("out", "run.glint"), "--", "scene.json"])
        self.assertEqual(steps[1][1], ["glint", "predict", "--set", "predict.band=false", "--out", os.path.join("out", "predictions"), "--",
                                       os.path.join("out", "run.glint")])
        self.assertEqual(steps[2][1], ["glint", "evaluate", "--models", "canonical,dual", *common, "--json",
                                       os.path.join("out", "evaluation.json"), "--", os.path.join("out", "run.glint")])
        settings.training = "PER_SURFACE"
        self.assertIn("per-surface", run.commands("glint", settings, "scene.json", "out")[0][1])
        settings.models = set()
        with self.assertRaisesRegex(Exception, "choose a model"):
            run.commands("glint", settings, "scene.json", "out")


class Module(unittest.TestCase):
    """The Python module in place of the program, where the build has one."""

    def setUp(self):
        self.scene = host.empty()
        self.preferences = bpy.context.preferences.addons["glint_blender"].preferences
        self.preferences.use_module, self.preferences.program = True, "/nowhere/glint"
        self.assertEqual(bpy.ops.glint.import_scene(filepath=ELLIPSOID), {"FINISHED"})
        self.settings = self.scene.glint
        self.settings.models, self.settings.source, self.settings.more = {"limit-angle", "canonical"}, "image", "fit.most_residual=0.3"
        self.path = list(sys.path)

    def tearDown(self):
        self.preferences.use_module = False
        sys.path[:] = self.path
        sys.modules.pop("glint", None)

    def test_missing_or_another_module_is_said(self):
        self.settings.folder = host.folder("no_module")
        with self.assertRaisesRegex(RuntimeError, "module glint: cannot be imported: .*switch off Use the Python Module"):
            bpy.ops.glint.run()
        with open(os.path.join(host.folder("another"), "glint.py"), "w", encoding="ascii") as file:
            file.write("pass")
        sys.path.insert(0, host.folder("another"))
        with self.assertRaisesRegex(RuntimeError, "is another module of this name"):
            bpy.ops.glint.run()
        self.assertEqual(os.listdir(host.folder("no_module")), [])

    def test_the_same_numbers_as_the_program(self):
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(host.GLINT)), "python"))
        try:
            import glint
        except ImportError:
            self.skipTest("there is no Python module glint in this build")
        documents = []
        for use in (True, False):
            self.preferences.use_module, self.preferences.program = use, "/nowhere/glint" if use else host.GLINT
            self.settings.folder = host.folder(f"module_{use}")
            self.assertEqual(bpy.ops.glint.run(), {"FINISHED"})
            read = []
            for name in ("evaluation.json", "predictions/predictions.json"):
                with open(os.path.join(self.settings.folder, name), encoding="utf-8") as file:
                    read.append(json.load(file)["models"])
            documents.append((read, sorted(json.loads(o["glint_result"])["kind"] for o in bpy.data.objects if "glint_result" in o)))
        (a, objects_a), (b, objects_b) = documents
        self.assertEqual(objects_a, objects_b)
        for model in ("limit-angle", "canonical"):
            for x, y in zip(a[0][model]["fits"], b[0][model]["fits"]):
                self.assertEqual({k: v for k, v in x.items() if k != "time_us"}, {k: v for k, v in y.items() if k != "time_us"})
            for x, y in zip(a[0][model]["frames"], b[0][model]["frames"]):
                self.assertEqual({k: v for k, v in x.items() if k != "time_us"}, {k: v for k, v in y.items() if k != "time_us"})
            self.assertEqual(len(a[1][model]), len(b[1][model]))
            for x, y in zip(a[1][model], b[1][model]):
                self.assertEqual([h["contour"] for h in x["highlights"]], [h["contour"] for h in y["highlights"]])
                self.assertEqual([(h["brightest_point"], h["normal"], h["peak"]) for h in x["highlights"]],
                                 [(h["brightest_point"], h["normal"], h["peak"]) for h in y["highlights"]])

    def test_it_stops_on_request(self):
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(host.GLINT)), "python"))
        try:
            import glint
        except ImportError:
            self.skipTest("there is no Python module glint in this build")
        from glint_blender import module_run
        out = host.folder("module_stopped")
        run = module_run.InProcess(ELLIPSOID, out, {"models": ["reflectance", "limit-angle"], "train": "spread:6", "source": "image"})
        time.sleep(0.3)
        self.assertFalse(run.done())
        run.cancel()
        run.finish()
        self.assertTrue(run.cancelled)
        self.assertEqual((run.failed, os.listdir(out)), ("", []))


class AddOn(unittest.TestCase):
    def test_zip_installs_and_every_operator_has_a_tooltip(self):
        import addon_utils
        import subprocess
        addon_utils.disable("glint_blender", default_set=True)
        for name in [m for m in sys.modules if m.split(".")[0] == "glint_blender"]:
            del sys.modules[name]
        ours = os.path.join(host.ROOT, "plugins", "blender")
        sys.path.remove(ours)
        try:
            file = os.path.join(host.folder("zip"), "glint_blender.zip")
            for target in (file, file + ".again"):
                subprocess.run(["python3", "-B", os.path.join(ours, "make_zip.py"), target], check=True, stdout=subprocess.DEVNULL)
            with open(file, "rb") as a, open(file + ".again", "rb") as b:
                self.assertEqual(a.read(), b.read())
            self.assertEqual(bpy.ops.preferences.addon_install(filepath=file), {"FINISHED"})
            self.assertEqual(bpy.ops.preferences.addon_enable(module="glint_blender"), {"FINISHED"})
            import glint_blender
            self.assertTrue(glint_blender.__file__.startswith(os.environ["BLENDER_USER_SCRIPTS"]))
            with open(os.path.join(os.path.dirname(glint_blender.__file__), "blender_manifest.toml"), "rb") as manifest:
                import tomllib
                manifest = tomllib.load(manifest)
            self.assertEqual(manifest["version"], ".".join(map(str, glint_blender.bl_info["version"])))
            self.assertEqual(manifest["id"], "glint_blender")
            for module in glint_blender.MODULES:
                for class_ in module.classes:
                    if issubclass(class_, bpy.types.Operator):
                        self.assertTrue(class_.__doc__, class_)
                    for name, prop in getattr(class_, "bl_rna", class_).properties.items():
                        if class_.__module__.startswith("glint_blender") and name in class_.__annotations__ and not prop.is_hidden:
                            if name not in ("filepath", "filter_glob", "filename_ext", "axis_forward", "axis_up"):
                                self.assertTrue(prop.description, (class_, name))
            self.assertEqual(bpy.ops.preferences.addon_disable(module="glint_blender"), {"FINISHED"})
            self.assertFalse(hasattr(bpy.types.Scene, "glint"))
            shutil.rmtree(os.path.dirname(glint_blender.__file__))  # Blender's own operator for this needs a window
        finally:
            for name in [m for m in sys.modules if m.split(".")[0] == "glint_blender"]:
                del sys.modules[name]
            sys.path.insert(0, ours)
            host.enable()


if __name__ == "__main__":
    host.main()
