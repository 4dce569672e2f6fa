# SPDX-License-Identifier: BSD-3-Clause
"""The add-on in Blender's window: a run with progress, Cancel, a second run to its end, steps; and pictures of the panel.

Blender draws on a virtual display. The pictures panel.png and overlay.png stay in the test's folder; docs/pictures has them."""
import os
import shutil
import sys
import time
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import host

ELLIPSOID = os.path.join(host.ROOT, "sessions", "ellipsoid")
LONGEST = 2500  # s on the clock, for a hang on a machine that is busy with other things; alone it takes 40


def expect(right, words):
    if not right:
        raise AssertionError(words)


def view_3d():
    window = bpy.context.window_manager.windows[0]
    area = max((a for a in window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width * a.height)
    return {"window": window, "screen": window.screen, "area": area, "region": next(r for r in area.regions if r.type == "WINDOW"),
            "scene": bpy.context.scene}


def only_our_tab():
    """The sidebar cannot be told which tab to show: the others are taken away."""
    for class_ in list(bpy.types.Panel.__subclasses__()):
        if getattr(class_, "bl_space_type", "") == "VIEW_3D" and getattr(class_, "bl_region_type", "") == "UI" and class_.is_registered:
            if getattr(class_, "bl_category", "") != "Glint":
                bpy.utils.unregister_class(class_)


def prepare():
    host.enable()
    capture = os.path.join(host.FOLDER, "capture")
    shutil.copytree(ELLIPSOID, capture)
    with bpy.context.temp_override(**view_3d()):
        for object_ in list(bpy.data.objects):
            bpy.data.objects.remove(object_)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(host.FOLDER, "ellipsoid.blend"))
        bpy.ops.glint.import_scene(filepath=os.path.join(capture, "scene.json"))
    settings = bpy.context.scene.glint
    settings.input, settings.folder = "//capture/scene.json", "//run"
    settings.models, settings.source = {"limit-angle", "canonical"}, "image"
    place = view_3d()
    space = place["area"].spaces.active
    space.show_region_ui = True
    space.shading.type = "SOLID"
    only_our_tab()


def start():
    with bpy.context.temp_override(**view_3d()):
        answer = bpy.ops.glint.run("INVOKE_DEFAULT")
    expect(answer == {"RUNNING_MODAL"}, answer)
    expect(bpy.context.scene.glint.running, "does not say that it runs")
    expect(not bpy.ops.glint.run.poll(), "a second run could start")


def screenshot(name):
    """What the window shows."""
    path = os.path.join(host.FOLDER, name)
    with bpy.context.temp_override(**view_3d()):
        bpy.ops.screen.screenshot(filepath=path)
    image = bpy.data.images.load(path)
    colours = len(set(image.pixels[:400000]))
    bpy.data.images.remove(image)
    expect(colours > 50, f"{name}: {colours} values of pixels, nothing is drawn")


def session():
    """The test as steps; each yield waits until its condition holds (or for some seconds) while Blender works."""
    from glint_blender import run
    prepare()
    yield 1.0
    start()
    settings = bpy.context.scene.glint
    yield lambda: settings.stage != ""
    process = run.GLINT_OT_run.running.sequence.job.process
    expect(process.poll() is None, "the program does not run")
    bpy.ops.glint.cancel()
    yield lambda: not settings.running
    expect(process.poll() is not None, "the program still runs after Cancel")
    expect(settings.message == "stopped", settings.message)
    expect(not any("glint_result" in o for o in bpy.data.objects), "a stopped run left results")
    expect(not os.path.exists(os.path.join(host.FOLDER, "run", "evaluation.json")), "a stopped run left its last file")
    expect(not bpy.ops.glint.cancel.poll(), "Cancel without a run")
    start()
    parts = set()
    yield lambda: parts.add(round(settings.part)) or not settings.running
    expect(settings.message.startswith("done: "), settings.message)
    expect(len(parts) > 2, f"progress showed {parts}")
    expect(sum("glint_result" in o for o in bpy.data.objects) > 100, "no results")
    settings.shown_model = "canonical"
    bpy.ops.glint.step(worst=True)
    place = view_3d()
    place["area"].spaces.active.region_3d.view_perspective = "PERSP"
    with bpy.context.temp_override(**place):
        for object_ in bpy.context.scene.objects:
            object_.select_set("glint_surface" in object_ or "glint_result" in object_ and object_.type in ("LIGHT", "MESH"))
        bpy.ops.view3d.view_selected()
        for object_ in bpy.context.scene.objects:
            object_.select_set(False)
    yield 4.0
    screenshot("panel.png")
    place["area"].spaces.active.region_3d.view_perspective = "CAMERA"
    place["area"].spaces.active.overlay.show_floor = False
    for object_ in bpy.context.scene.objects:
        object_.hide_set("glint_surface" in object_ or object_.name.startswith("Contour"))  # the photograph shows the surface
    yield 4.0
    screenshot("overlay.png")


class Player:
    def __init__(self):
        self.steps, self.condition, self.begun = session(), 2.0, time.monotonic()
        self.since = self.begun

    def __call__(self):
        try:
            if time.monotonic() - self.begun > LONGEST:
                raise AssertionError("hangs")
            ready = self.condition() if callable(self.condition) else time.monotonic() - self.since > self.condition
            if ready:
                self.condition, self.since = next(self.steps), time.monotonic()
            return 0.1
        except StopIteration:
            print("glint test: all passed", flush=True)
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(1)


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(Player(), first_interval=1.0)
