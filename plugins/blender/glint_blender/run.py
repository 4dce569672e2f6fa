# SPDX-License-Identifier: BSD-3-Clause
"""Glint > Run: fits, predicts and scores beside Blender, with progress and an end on request, and shows the results."""
import json
import os
import re

import bpy
from bpy.props import BoolProperty, IntProperty

from . import export_scene, import_results, module_run, program
from .failures import InputError
from .preferences import program_path, uses_module

INTERVAL = 0.1  # s between two looks at the program
DEFAULT_KINDS = {"ELLIPSOIDS", "LIGHTS", "PLANES", "CONTOURS", "MATERIAL"}
NO_HIGHLIGHT = 3  # exit code: the data cannot answer


def absolute(path):
    """A path of the panel, absolute: it is stored in the .blend file, whose author must not be able to write an option of `glint` there."""
    if path.startswith("//") and not bpy.data.filepath:
        raise InputError(path, "", "is relative to the .blend file, which is not saved yet")
    return os.path.abspath(bpy.path.abspath(path))


def folder_of(settings):
    """The folder of the run, absolute; InputError where the user has not said one."""
    if not settings.folder:
        raise InputError("folder", "", "choose the folder of the run")
    path = absolute(settings.folder)
    try:
        os.makedirs(path, exist_ok=True)
    except OSError as e:
        raise InputError(path, "", e.strerror or str(e)) from None
    return path


def export_for_run(context, folder):
    """Writes this Blender scene into the folder; its path."""
    settings = context.scene.glint
    scene = context.scene
    request = export_scene.Request(
        export_scene.surface_objects(context, settings.surfaces, settings.surface),
        range(scene.frame_start, scene.frame_end + 1, scene.frame_step),
        settings.world(), settings.pictures, settings.pictures_folder)
    path = os.path.join(folder, "scene.json")
    _, rows, warnings = export_scene.write_scene(context, path, request)
    settings.set_frames(rows, path)
    scene["glint_surface_objects"] = json.dumps([o.name for o in request.objects])
    return path, warnings


def asked_of(settings):
    """What the panel asks for: models, and settings by their dotted names."""
    models = [m for m in ("limit-angle", "canonical", "reflectance", "dual", "primal") if m in settings.models]
    if not models:
        raise InputError("models", "", "choose a model")
    level = float(f"{settings.level:.7g}")  # the property is single precision
    values = {"detect.level": repr(level)} if abs(level - 0.5) > 1e-6 else {}
    for word in settings.more.split():
        if not re.fullmatch(r"[A-Za-z0-9_.]+=\S+", word):
            raise InputError("settings", word, "must be KEY=VALUE")
        key, _, value = word.partition("=")
        values[key] = value
    return models, values


def commands(program_file, settings, scene_path, folder):
    """The steps of a run, as Sequence takes them. What the .blend file names is the value of an option, or behind "--"."""
    models, values = asked_of(settings)
    models = ",".join(models)
    common = ["--train", settings.train_spec(), "--source", settings.source]
    for key, value in values.items():
        common += ["--set", f"{key}={value}"]
    session, evaluation = os.path.join(folder, "run.glint"), os.path.join(folder, "evaluation.json")
    predictions = os.path.join(folder, "predictions")
    # Blender shows no bands, and they take several fits.
    without_bands = [] if "predict.band" in values else ["--set", "predict.band=false"]
    return [("Fit", [program_file, "reconstruct", "--model", models, *common, "-o", session, "--", scene_path], {0}),
            ("Predict", [program_file, "predict", *without_bands, "--out", predictions, "--", session], {0, NO_HIGHLIGHT}),
            ("Evaluate", [program_file, "evaluate", "--models", models, *common, "--json", evaluation, "--", session],
             {0, NO_HIGHLIGHT})]


class GLINT_OT_run(bpy.types.Operator):
    """Fit the models to the training frames, predict and score all others. Esc or Cancel stops it"""
    bl_idname = "glint.run"
    bl_label = "Run Glint"
    bl_options = {"REGISTER", "UNDO"}
    shows: BoolProperty(name="Show Results", description="Make objects of what was found", default=True)

    sequence = timer = None
    running = None  # the operator that runs, for Cancel

    @classmethod
    def poll(cls, context):
        settings = context.scene.glint
        if settings.running and GLINT_OT_run.running is not None:
            cls.poll_message_set("Glint is running")
            return False
        if not settings.folder:
            cls.poll_message_set("Choose the folder of the run first")
            return False
        if settings.origin == "FILE" and not settings.input:
            cls.poll_message_set("Choose or import a scene file first")
            return False
        if settings.origin == "BLENDER" and context.scene.camera is None:
            cls.poll_message_set("The scene has no camera")
            return False
        return True

    def prepare(self, context):
        """Exports where asked for, and starts the first command."""
        settings = context.scene.glint
        found = None if uses_module(context) else program_path(context)
        if found is None:
            module_run.module()  # before anything is written
        folder = folder_of(settings)
        warnings = []
        if settings.origin == "BLENDER":
            path, warnings = export_for_run(context, folder)
        else:
            path = absolute(settings.input)
        self.folder, self.scene_path = folder, path
        if found is None:
            models, values = asked_of(settings)
            self.sequence = module_run.InProcess(path, folder,
                                                 {"models": models, "train": settings.train_spec(), "source": settings.source,
                                                  **values})
        else:
            self.sequence = program.Sequence(commands(found, settings, path, folder))
        export_scene.told(self, warnings)

    def finish(self, context):
        """After the end of all commands: errors into the list, objects into the scene."""
        settings = context.scene.glint
        if self.sequence.cancelled or self.sequence.failed:
            settings.message = "stopped" if self.sequence.cancelled else self.sequence.failed
            self.report({"INFO"} if self.sequence.cancelled else {"ERROR"}, settings.message)
            return {"CANCELLED"}
        export_scene.told(self, list(dict.fromkeys(self.sequence.warnings)))
        predictions = os.path.join(self.folder, "predictions", "predictions.json")
        try:
            made, warnings = import_results.show_results(context, os.path.join(self.folder, "evaluation.json"), predictions,
                                                         self.scene_path,
                                                         DEFAULT_KINDS if self.shows else set(),
                                                         overlays=self.folder if self.shows else "")
        except InputError as e:
            settings.message = str(e)
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        export_scene.told(self, warnings)
        settings.message = f"done: {len(made)} objects and materials"
        self.report({"INFO"}, settings.message)
        return {"FINISHED"}

    def execute(self, context):
        """Without a window to look at (scripts, blender -b): waits for the end."""
        try:
            self.prepare(context)
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        self.sequence.finish()
        return self.finish(context)

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.prepare(context)
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        context.scene.glint.running = True
        GLINT_OT_run.running = self
        manager = context.window_manager
        self.timer = manager.event_timer_add(INTERVAL, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.sequence.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        settings = context.scene.glint
        done = self.sequence.done()
        settings.stage, part = self.sequence.progress()
        settings.part = 100 * part
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
        if not done:
            return {"RUNNING_MODAL"}
        self.leave(context)
        return self.finish(context)

    def leave(self, context):
        context.window_manager.event_timer_remove(self.timer)
        context.scene.glint.running = False
        GLINT_OT_run.running = None

    def cancel(self, context):
        """Blender closes, or opens another file."""
        self.sequence.cancel()
        self.leave(context)


class GLINT_OT_cancel(bpy.types.Operator):
    """Stop the run; no half-written file stays"""
    bl_idname = "glint.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context):
        if GLINT_OT_run.running is None:
            cls.poll_message_set("Glint is not running")
            return False
        return True

    def execute(self, context):
        GLINT_OT_run.running.sequence.cancel()
        return {"FINISHED"}


class GLINT_OT_step(bpy.types.Operator):
    """Go to another frame of Glint's list, and show it through its camera's overlay"""
    bl_idname = "glint.step"
    bl_label = "Step Frame"
    bl_options = {"REGISTER", "UNDO"}
    by: IntProperty(name="By", description="Rows of the list to go on; negative: back", default=1)
    worst: BoolProperty(name="Worst", description="Go to the frame with the largest error of the model shown", default=False)

    @classmethod
    def poll(cls, context):
        if not context.scene.glint.frames:
            cls.poll_message_set(import_results.NEEDS_A_SCENE)
            return False
        return True

    def execute(self, context):
        settings = context.scene.glint
        if self.worst:
            errors = [(f.of_model(settings.shown_model).get("pct") or -1.0, i) for i, f in enumerate(settings.frames)]
            if max(errors)[0] < 0:
                self.report({"WARNING"}, "No frame has an error yet")
                return {"CANCELLED"}
            settings.active = max(errors)[1]
        else:
            settings.active = (settings.active + self.by) % len(settings.frames)
        context.scene.frame_set(settings.frames[settings.active].frame)
        return {"FINISHED"}


classes = (GLINT_OT_run, GLINT_OT_cancel, GLINT_OT_step)
