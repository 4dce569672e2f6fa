# SPDX-License-Identifier: BSD-3-Clause
"""File > Import > Glint Results: ellipsoids, lamps, virtual cameras, tangent planes, contours and errors of a run."""
import json
import os

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from . import export_scene, overlays as overlays_, results as results_, show
from .failures import InputError
from .properties import show_model

NEEDS_A_SCENE = "The scene has no frames of Glint: export or import a Glint scene first"


def frame_numbers(scene, found):
    """Blender's frame of every frame of the results; refused where the scene's own frames are others."""
    items = scene.glint.frames
    if [f.frame_id for f in items] != [f["id"] for f in found.frames]:
        raise InputError(scene.glint.input, "frames",
                         f"has {len(found.frames)} frames, but this Blender scene was exported or imported with "
                                                      f"{len(items)} others; export or import it again")
    return [f.frame for f in items]


def surface_finder(context):
    """A function from a surface's id to the objects that are it: those that were imported, else those of the panel's choice."""
    imported = [o for o in context.scene.objects if show.SURFACE in o]
    if imported:
        return lambda surface: [o for o in imported if o[show.SURFACE] == surface or surface is None]
    named = [bpy.data.objects[n] for n in json.loads(context.scene.get("glint_surface_objects", "[]")) if n in bpy.data.objects]
    return lambda surface: named


def fill_errors(scene, found):
    """Puts the errors of all models into the list of frames."""
    tables = {m: results_.errors_of(found, m) for m in found.models()}
    for i, item in enumerate(scene.glint.frames):
        item.errors = json.dumps({m: table[i] for m, table in tables.items() if i in table})
    scene.glint.models_with_results = json.dumps(found.models())
    best = found.answered() or found.models()
    if best:
        scene.glint.shown_model = best[0]


def show_results(context, evaluation, predictions, scene_path, kinds, models=None, only_own_frame=True, overlays=""):
    """Reads a run and shows it. Returns (objects made, warnings). Nothing changes where the files are refused.

    overlays: folder of the run, which gets a folder of overlays; "": none."""
    scene = context.scene
    found = results_.read(scene_path, evaluation or None, predictions or None)
    numbers = frame_numbers(scene, found)
    world = scene.glint.world()
    paths = overlays_.write(found, [m for m in found.models() if not models or m in models], overlays) if overlays else {}
    show.remove_results(scene)
    fill_errors(scene, found)
    made, warnings = [], []
    for model in found.models():
        if models and model not in models:
            continue
        shower = show.Shower(scene, found, model, world, numbers, surface_finder(context), only_own_frame)
        made += shower.show(kinds)
        warnings += shower.warnings
    show_model(scene)
    if paths and overlays_.attach(scene, paths):
        warnings.append("no overlays: the frames of one camera are not Blender's frames one after the other")
    return made, warnings


class GLINT_OT_import_results(bpy.types.Operator, ImportHelper):
    """Show what Glint found: choose the evaluation.json of a run"""
    bl_idname = "glint.import_results"
    bl_label = "Import Glint Results"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    scene_file: StringProperty(name="Scene", description="Scene file that the results are of; empty: the one of the Glint panel",
                               subtype="FILE_PATH")
    kinds: EnumProperty(name="Show", description="What to make objects of", items=show.KINDS, options={"ENUM_FLAG"},
                        default={"ELLIPSOIDS", "LIGHTS", "PLANES", "CONTOURS", "MATERIAL"})
    model: StringProperty(name="Model", description="Only this model; empty: all")
    own_frame: BoolProperty(name="Only in Their Frame",
                            description="Show what belongs to one frame in that frame alone (keys of the visibility)",
                            default=True)
    overlays: BoolProperty(name="Overlays",
                           description="Write pictures of the contours into the folder `overlays` of the run, and show them in the cameras' views", default=True)

    @classmethod
    def poll(cls, context):
        if not context.scene.glint.frames:
            cls.poll_message_set(NEEDS_A_SCENE)
            return False
        return True

    def execute(self, context):
        folder = os.path.dirname(self.filepath)
        evaluation, predictions = results_.files_in(folder)
        if os.path.basename(self.filepath) != "predictions.json" and os.path.isfile(self.filepath):
            evaluation = self.filepath
        elif os.path.isfile(self.filepath):
            predictions = self.filepath
        scene_path = bpy.path.abspath(self.scene_file or context.scene.glint.input)
        try:
            if not evaluation and not predictions:
                raise InputError(folder, "", "has no evaluation.json and no predictions.json")
            made, warnings = show_results(context, evaluation, predictions, scene_path, self.kinds,
                                          {self.model} if self.model else None,
                                          self.own_frame, folder if self.overlays else "")
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        export_scene.told(self, warnings)
        self.report({"INFO"}, f"{len(made)} objects and materials")
        return {"FINISHED"}


class GLINT_OT_clear_results(bpy.types.Operator):
    """Remove all objects that show results of Glint"""
    bl_idname = "glint.clear_results"
    bl_label = "Clear Results"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not any(show.RESULT in o for o in context.scene.objects):
            cls.poll_message_set("There are no results")
            return False
        return True

    def execute(self, context):
        count = show.remove_results(context.scene)
        self.report({"INFO"}, f"{count} objects removed")
        return {"FINISHED"}


def menu(self, context):
    self.layout.operator(GLINT_OT_import_results.bl_idname, text="Glint Results (evaluation.json)")


classes = (GLINT_OT_import_results, GLINT_OT_clear_results)


def register():
    bpy.types.TOPBAR_MT_file_import.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu)
