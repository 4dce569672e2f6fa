# SPDX-License-Identifier: BSD-3-Clause
"""What a .blend file keeps for Glint: the convention of axes and units, the request, and the frames with their errors."""
import json

import bpy
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty,
                       StringProperty)
from bpy_extras.io_utils import axis_conversion

from . import views
from .failures import InputError

MODELS = [("limit-angle", "Limit Angle", "A light and one limit angle; the contour is its level set on the surface"),
          ("canonical", "Canonical", "An ellipsoid and a light, from contours carried to the tangent planes"),
          ("reflectance", "Reflectance", "A light, a lobe and its roughness; slow where pictures are fitted"),
          ("dual", "Dual", "An ellipsoid whose outlines are seen by the virtual cameras"),
          ("primal", "Primal", "An ellipsoid whose outlines are seen by the cameras")]
TRAINING = [("SPREAD", "Spread", "This many frames, evenly spread"), ("FIRST", "First", "The first frames"),
            ("CHOSEN", "Chosen", "The frames that are ticked in the list"),
            ("PER_SURFACE", "Per Surface", "Every surface its own model from all of its frames")]
AXES = [(a, f"{a} {kind}", "") for kind in ("Forward",) for a in ("X", "Y", "Z", "-X", "-Y", "-Z")]
UPS = [(a, f"{a} Up", "") for a in ("X", "Y", "Z", "-X", "-Y", "-Z")]


def world_from(scene, forward, up, scale):
    """The World of a choice of axes. Raises InputError where both name the same axis."""
    try:
        axes = axis_conversion(from_forward="Y", from_up="Z", to_forward=forward, to_up=up)
    except Exception:
        axes = None
    if axes is None or forward[-1] == up[-1]:
        raise InputError("axes", "", f"forward ({forward}) and up ({up}) must be two different axes")
    units = scene.unit_settings
    # The property is single precision: seven digits are what the user typed.
    length = float(f"{units.scale_length:.7g}") if units.system != "NONE" else 1.0
    return views.World(axes, float(f"{scale:.7g}") * length)


class GlintFrame(bpy.types.PropertyGroup):
    """A frame of the scene file, in its order."""
    frame_id: StringProperty(name="Id", description="Id of the frame in the scene file")
    frame: IntProperty(name="Frame", description="Blender's frame that shows it")
    camera: StringProperty(name="Camera", description="Camera object of the frame")
    picture: StringProperty(name="Picture", description="Photograph or render of the frame", subtype="FILE_PATH")
    train: BoolProperty(name="Train", description="Fit the models to this frame (training: Chosen)", default=False)
    errors: StringProperty(default="{}", options={"HIDDEN"})  # by model: role, px, pct, reason

    def of_model(self, model):
        """role (training, held out or ""), px, pct, reason of a model; px is None where nothing was measured."""
        try:
            return json.loads(self.errors).get(model, {})
        except ValueError:
            return {}


def shown_models(self, context):
    models = [m for m in json.loads(self.models_with_results or "[]")]
    shown = {m[0]: m for m in MODELS}
    # Blender needs the texts to stay alive.
    shown_models.kept = [shown.get(m, (m, m, "")) for m in models] or [("NONE", "No Results", "Run Glint first")]
    return shown_models.kept


def show_model(scene):
    """Shows the objects of the model whose errors the list shows, and hides those of others: their lamps must not add up in a render."""
    for collection in bpy.data.collections:
        if "glint_model" in collection:
            collection.hide_viewport = collection.hide_render = collection["glint_model"] != scene.glint.shown_model


def step_to_chosen(self, context):
    """Choosing a row of the list shows its frame; a list that is filled anew does not."""
    if not step_to_chosen.quiet and 0 <= self.active < len(self.frames) and context is not None and context.scene is not None:
        if context.scene.frame_current != self.frames[self.active].frame:
            context.scene.frame_set(self.frames[self.active].frame)


step_to_chosen.quiet = False


class GlintSettings(bpy.types.PropertyGroup):
    """scene.glint"""
    origin: EnumProperty(name="Scene", description="What Glint reads",
                         items=[("BLENDER", "This Blender Scene", "Export this scene before each run"),
                                ("FILE", "Scene File", "The scene.json that was imported, as it is")], default="BLENDER")
    input: StringProperty(name="Input", description="Scene file that Glint reads", subtype="FILE_PATH")
    folder: StringProperty(name="Folder", description="Where the run writes its files: scene, session, predictions, evaluation",
                           subtype="DIR_PATH")
    surfaces: EnumProperty(name="Surface", description="What the glossy surface is",
                           items=[("SELECTED", "Selected Objects", "The selected objects, together"),
                                  ("VISIBLE", "All Rendered Objects", "Every object with faces that a render shows"),
                                  ("COLLECTION", "A Collection", "All objects with faces of a collection")], default="SELECTED")
    surface: PointerProperty(name="Collection", description="Collection of the glossy surface", type=bpy.types.Collection)
    pictures: EnumProperty(name="Pictures",
                           description="Where the pictures of the frames are; they are copied into the folder of the run",
                           items=[("RENDER", "Render Output", "Files that a render of this scene writes"),
                                  ("FOLDER", "Folder", "Pictures of a folder, in the order of their names"),
                                  ("BACKGROUND", "Camera Background", "The background image of each frame's camera")],
                           default="RENDER")
    pictures_folder: StringProperty(name="Pictures From", description="Folder of the pictures", subtype="DIR_PATH")
    axis_forward: EnumProperty(name="Forward", description="Blender's forward (Y) becomes this axis of Glint's world",
                               items=AXES, default="Y")
    axis_up: EnumProperty(name="Up", description="Blender's up (Z) becomes this axis of Glint's world", items=UPS, default="Z")
    scale: FloatProperty(name="Metres per Unit",
                         description="Length of one Blender unit in metres, on top of the scene's unit scale", default=1.0,
                         min=1e-6, max=1e6)
    models: EnumProperty(name="Models", description="Models to fit; several with Shift", items=MODELS, options={"ENUM_FLAG"},
                         default={"limit-angle", "canonical"})
    training: EnumProperty(name="Training", description="Frames that the models are fitted to", items=TRAINING, default="SPREAD")
    count: IntProperty(name="Frames", description="How many training frames", default=6, min=1, soft_max=50)
    source: EnumProperty(name="Highlights In", description="Which pictures are searched, where frames have both",
                         items=[("radiance", "Radiance", "Linear pictures, where a frame has one"),
                                ("image", "Image", "What a camera captured")],
                         default="radiance")
    level: FloatProperty(name="Level", description="Level of the contours, as a fraction of the peak above the background",
                         default=0.5, min=0.05,
                         max=0.95)
    more: StringProperty(name="Settings", description="More settings, KEY=VALUE with blanks between; `glint settings` lists them")
    shown_model: EnumProperty(name="Show", description="Model whose errors and objects are shown", items=shown_models,
                              update=lambda self, context: show_model(self.id_data))
    frames: CollectionProperty(name="Frames", description="Frames of the scene file, in its order", type=GlintFrame)
    active: IntProperty(name="Frame", description="Row of the list; choosing one shows its frame", default=0,
                        update=step_to_chosen)
    models_with_results: StringProperty(default="[]", options={"HIDDEN"})
    stage: StringProperty(name="Stage", options={"HIDDEN", "SKIP_SAVE"})
    part: FloatProperty(name="Part", description="Part of the run that is done", min=0, max=100, subtype="PERCENTAGE",
                        options={"HIDDEN", "SKIP_SAVE"})
    running: BoolProperty(default=False, options={"HIDDEN", "SKIP_SAVE"})
    message: StringProperty(name="Message", description="How the last run ended", options={"HIDDEN"})

    def world(self):
        return world_from(self.id_data, self.axis_forward, self.axis_up, self.scale)

    def remember(self, forward, up, scale):
        self.axis_forward, self.axis_up, self.scale = forward, up, scale

    def set_frames(self, rows, path):
        """The frames of a scene file, in its order; ticks stay by id."""
        ticked = {f.frame_id for f in self.frames if f.train}
        self.frames.clear()
        for row in rows:
            item = self.frames.add()
            item.frame_id, item.frame, item.camera = row["id"], row["frame"], row["camera"]
            item.picture, item.train = row["picture"], row["id"] in ticked
        self.input = path
        self.models_with_results = "[]"
        step_to_chosen.quiet = True
        self.active = min(self.active, max(len(rows) - 1, 0))
        step_to_chosen.quiet = False

    def train_spec(self):
        """--train of the command line. Raises InputError where no frame is chosen."""
        if self.training == "PER_SURFACE":
            return "per-surface"
        if self.training == "CHOSEN":
            numbers = [str(i) for i, f in enumerate(self.frames) if f.train]
            if not numbers:
                raise InputError("training", "", "no frame is ticked in the list")
            return ",".join(numbers)
        return f"{'spread' if self.training == 'SPREAD' else 'first'}:{self.count}"


classes = (GlintFrame, GlintSettings)


def register():
    bpy.types.Scene.glint = PointerProperty(type=GlintSettings)


def unregister():
    del bpy.types.Scene.glint
