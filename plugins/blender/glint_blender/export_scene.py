# SPDX-License-Identifier: BSD-3-Clause
"""File > Export > Glint Scene: cameras, surfaces, lamps and pictures of a range of frames, as scene.json."""
import os

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, orientation_helper

from . import cameras, images, lamps, linear, meshes, scene_file
from .failures import InputError
from .properties import world_from

SURFACES = [("SELECTED", "Selected Objects", "The selected objects are the glossy surface, together"),
            ("VISIBLE", "All Rendered Objects", "Every object with faces that a render shows"),
            ("COLLECTION", "A Collection", "All objects with faces in the collection that the Glint panel names")]
IMAGES = [("NONE", "None", "Cameras, surfaces and lamps alone"),
          ("RENDER", "Render Output", "The files that a render of this scene writes, where they exist"),
          ("FOLDER", "Folder", "The pictures of a folder, in the order of their names: the first belongs to the first frame"),
          ("BACKGROUND", "Camera Background", "The background image of each frame's camera")]


class Request:
    """What to export. objects: the glossy surface. frames: numbers of Blender's frames. world: a views.World. named: the user has just said which
    folder, no .blend file did."""

    def __init__(self, objects, frames, world, pictures="NONE", folder="", lights=True, exact=True, named=False):
        self.objects, self.frames, self.world = objects, list(frames), world
        self.pictures, self.folder, self.lights, self.exact, self.named = pictures, folder, lights, exact, named


def surface_objects(context, which, collection=None):
    """The objects of an entry of SURFACES."""
    if which == "SELECTED":
        chosen = context.selected_objects
    elif which == "COLLECTION":
        chosen = collection.all_objects if collection else []
    else:
        chosen = [o for o in context.scene.objects if not o.hide_render]
    return [o for o in chosen if o.type in meshes.KINDS and "glint_result" not in o]


def pictures_of(scene, request):
    """Path of the picture of each frame, by frame; what is missing is left out."""
    if request.pictures == "FOLDER":
        found = images.in_folder(bpy.path.abspath(request.folder))
        if len(found) != len(request.frames):
            raise InputError(request.folder, "",
                             f"holds {len(found)} pictures for {len(request.frames)} frames; there must be one for each")
        return dict(zip(request.frames, found))
    if request.pictures == "RENDER":
        return {f: images.rendered(scene, f) for f in request.frames}
    return {}


def picture_of(scene, request, pictures, frame):
    """(path of the picture to copy or None, why it is missing). A .blend file may come from others, and the export may be passed on: what it
    names is copied only where it is a picture and lies in the folder of the .blend file, or where the user says that it may lie anywhere."""
    path = images.behind(scene.camera, frame) if request.pictures == "BACKGROUND" else pictures.get(frame)
    if not path:
        return None, "no picture"
    if not (request.named and request.pictures == "FOLDER") and not images.may_copy(path):
        return None, f"{path} lies outside of the folder of the .blend file and is left out; Allow Pictures from Other Folders takes it"
    if not os.path.isfile(path):
        return None, f"no picture at {path}"
    if not images.is_picture(path):
        return None, f"{path} is no picture and is left out"
    return path, ""


class Collected:
    """Frames, surfaces and lamps while the scene is played."""

    def __init__(self):
        self.frames, self.rows, self.surfaces, self.lights, self.moved = [], [], {}, {}, set()
        self.carried, self.loose = {}, set()  # lamps as the camera sees them, names of those that do not move with it
        self.distinct, self.stand = meshes.Surfaces(), None  # stand: matrices of the objects in the first frame
        self.exact = 0


def collect_frame(scene, request, pictures, folder, found, warnings):
    """Adds what the scene shows at its current frame."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    frame = scene.frame_current
    pose, view, exact, known = cameras.glint_camera(scene, scene.camera, request.world, request.exact)
    found.exact += exact
    taken = {f["id"] for f in found.frames}
    frame_id = known if known and known not in taken else f"{frame:04d}"
    while frame_id in taken:
        frame_id += "'"
    entry = {"id": frame_id, "camera": view, "camera_from_world": pose}
    picture, missing = picture_of(scene, request, pictures, frame)
    if picture:
        entry[images.key_for(picture)] = images.put_into(folder, picture, f"{folder.stem}_frames/{len(found.frames):04d}")
    elif request.pictures != "NONE":
        warnings.append(f"frame {frame}: {missing}")
    now = [linear.rows(o.evaluated_get(depsgraph).matrix_world) for o in request.objects]
    found.stand = found.stand or now
    motion = meshes.motion(found.stand, now)
    number, data = found.distinct.number_of(request.objects, depsgraph, request.world, now if motion is None else found.stand)
    name = f"surface_{number:04d}"
    if data is not None:
        found.surfaces[name] = f"{folder.stem}_meshes/{name}.ply"
        with open(folder.path(found.surfaces[name]), "wb") as file:
            file.write(data)
    entry["surface"] = name
    if motion not in (None, linear.identity()):
        entry["world_from_object"] = request.world.motion_to_glint(motion)
    if request.lights:
        collect_lamps(scene, depsgraph, request.world, entry, found, warnings)
    found.frames.append(entry)
    found.rows.append({"id": frame_id, "frame": frame, "camera": scene.camera.name, "picture": picture or "", "exact": exact})


def collect_lamps(scene, depsgraph, world, entry, found, warnings):
    """Lamps that are on in this frame. Glint's lamps stand still, in the world or before the camera: any other is left out, by name."""
    on = []
    for lamp in lamps.lamp_objects(scene):
        if "glint_result" in lamp or not lamps.shines(lamp, depsgraph):
            continue
        said = []
        light = lamps.light_of(lamp, depsgraph, world, said)
        carried, far = lamps.seen_from(light, entry["camera_from_world"]), linear.length(linear.column(entry["camera_from_world"], 3))
        if lamp.name not in found.lights:
            found.lights[lamp.name], found.carried[lamp.name] = light, carried
            warnings.extend(said)
        else:
            if not lamps.same_light(found.lights[lamp.name], light):
                found.moved.add(lamp.name)
            if not lamps.same_light(found.carried[lamp.name], carried, max(far, 1.0)):
                found.loose.add(lamp.name)
        on.append(lamp.name)
    entry["lights_on"] = on


def shared_camera(frames):
    """Moves the camera that all frames have to the top of the document; None where they differ."""
    first = frames[0]["camera"]
    if any(f["camera"] != first for f in frames):
        return None
    for f in frames:
        del f["camera"]
    return first


def document_of(scene, found, request, warnings):
    left_out = found.moved & found.loose
    lights = [{**found.carried[name], "frame": "camera"} if name in found.moved else light
              for name, light in found.lights.items() if name not in left_out]
    for name in sorted(left_out):
        warnings.append(f"{name}: moves from frame to frame, and not with the camera: Glint has no such lamps, so it is left out of the truth")
    for f in found.frames:
        if "lights_on" in f:
            # Without a name of every lamp that is on, nothing is stated: Glint then tells lamps apart itself.
            if left_out & set(f["lights_on"]) or not f["lights_on"]:
                del f["lights_on"]
    moving = any("world_from_object" in f for f in found.frames)
    for f in found.frames if moving else ():
        f.setdefault("world_from_object", linear.identity())
    document = {"glint_scene": 2 if moving or found.moved - left_out else 1, "name": scene.name, "units": "m"}
    shared = shared_camera(found.frames)
    if shared:
        document["camera"] = shared
    document["surfaces"] = {name: {"mesh": path} for name, path in found.surfaces.items()}
    document["lights"] = lights
    document["frames"] = found.frames
    return document


def write_scene(context, path, request):
    """Writes scene.json and its files. Returns (document, rows of frames, warnings); the scene's frame is as before.

    rows: dicts with id, frame (Blender's), camera, picture, exact. Raises InputError; then nothing is written."""
    scene = context.scene
    if not request.objects:
        raise InputError("surface", "", "no object with faces is chosen: select the glossy object")
    if not request.frames:
        raise InputError("frames", "", "the range of frames is empty")
    warnings, found, before = [], Collected(), (scene.frame_current, scene.frame_subframe)
    pictures = pictures_of(scene, request)
    manager = context.window_manager
    manager.progress_begin(0, len(request.frames))
    try:
        with scene_file.Folder(path) as folder:
            for i, frame in enumerate(request.frames):
                scene.frame_set(frame)
                collect_frame(scene, request, pictures, folder, found, warnings)
                manager.progress_update(i + 1)
            if request.pictures == "RENDER":
                copied = [row["picture"] for row in found.rows if row["picture"]]
                colour = images.colour_warning(scene, copied)
                if colour and copied:
                    warnings.append(colour)
            document = document_of(scene, found, request, warnings)
            folder.finish(document)
    finally:
        manager.progress_end()
        scene.frame_set(before[0], subframe=before[1])
    return document, found.rows, warnings


def told(operator, warnings, most=4):
    """Reports warnings, the first ones by name."""
    for line in warnings[:most]:
        operator.report({"WARNING"}, line)
    if len(warnings) > most:
        operator.report({"WARNING"}, f"{len(warnings) - most} more warnings of this kind")


@orientation_helper(axis_forward="Y", axis_up="Z")
class GLINT_OT_export_scene(bpy.types.Operator, ExportHelper):
    """Write cameras, the glossy surface, lamps and pictures of a range of frames as a Glint scene"""
    bl_idname = "glint.export_scene"
    bl_label = "Export Glint Scene"
    bl_options = {"PRESET"}
    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    scale: FloatProperty(name="Metres per Unit",
                         description="Length of one Blender unit in metres, on top of the scene's unit scale", default=1.0,
                         min=1e-6, max=1e6, soft_min=0.001, soft_max=1000)
    surfaces: EnumProperty(name="Surface", description="What the glossy surface is", items=SURFACES, default="SELECTED")
    pictures: EnumProperty(name="Pictures", description="Where the pictures of the frames are; they are copied beside the scene",
                           items=IMAGES,
                           default="RENDER")
    folder: StringProperty(name="Folder", description="Folder of the pictures", subtype="DIR_PATH")
    whole_range: BoolProperty(name="Whole Frame Range", description="Frames of the scene, from its start to its end by its step",
                              default=True)
    first: IntProperty(name="First", description="First frame", default=1)
    last: IntProperty(name="Last", description="Last frame", default=1)
    step: IntProperty(name="Step", description="Every how many frames", default=1, min=1)
    lights: BoolProperty(name="Lamps", description="Write lamps as the truth that results are compared with; no fit reads them",
                         default=True)
    exact: BoolProperty(name="Exact Cameras",
                        description="Use the exact numbers of cameras that came from a Glint scene and have not moved",
                        default=True)

    @classmethod
    def poll(cls, context):
        if context.scene.camera is None:
            cls.poll_message_set("The scene has no camera")
            return False
        return True

    def execute(self, context):
        scene = context.scene
        frames = range(scene.frame_start, scene.frame_end + 1,
                       scene.frame_step) if self.whole_range else range(self.first, self.last + 1, self.step)
        try:
            world = world_from(scene, self.axis_forward, self.axis_up, self.scale)
            request = Request(surface_objects(context, self.surfaces, scene.glint.surface), frames, world, self.pictures,
                              self.folder, self.lights,
                              self.exact, named=True)
            document, rows, warnings = write_scene(context, self.filepath, request)
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        scene.glint.remember(self.axis_forward, self.axis_up, self.scale)
        scene.glint.set_frames(rows, self.filepath)
        told(self, warnings)
        exact = sum(r["exact"] for r in rows)
        self.report({"INFO"}, f"{len(rows)} frames, {len(document['surfaces'])} meshes, {len(document['lights'])} lamps; "
                              f"{exact} cameras with exact numbers")
        return {"FINISHED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "surfaces")
        layout.prop(self, "pictures")
        if self.pictures == "FOLDER":
            layout.prop(self, "folder")
        if self.pictures != "NONE" and images.GLINT_OT_trust_pictures.poll(context):
            layout.operator(images.GLINT_OT_trust_pictures.bl_idname)
        column = layout.column(align=True)
        column.prop(self, "whole_range")
        if not self.whole_range:
            for name in ("first", "last", "step"):
                column.prop(self, name)
        layout.prop(self, "lights")
        layout.prop(self, "exact")
        column = layout.column(align=True)
        column.prop(self, "axis_forward")
        column.prop(self, "axis_up")
        column.prop(self, "scale")


def menu(self, context):
    self.layout.operator(GLINT_OT_export_scene.bl_idname, text="Glint Scene (.json)")


classes = (GLINT_OT_export_scene,)


def register():
    bpy.types.TOPBAR_MT_file_export.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(menu)
