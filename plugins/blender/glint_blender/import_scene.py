# SPDX-License-Identifier: BSD-3-Clause
"""File > Import > Glint Scene: cameras with their photographs, surfaces and lamps of a scene.json."""
import json
import math
import os
import re

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper, orientation_helper
from mathutils import Matrix

from . import cameras, images, lamps, linear, meshes, results, scene_file, show, views
from .export_scene import told
from .failures import InputError
from .properties import world_from

MOST_FRAMES = 10_000  # camera objects; Blender gets slow far below


def chosen(listing, before):
    return [o for o in listing if o not in before]


def run_reader(path):
    """Objects that Blender's own readers make of a mesh file, with the axes of the file."""
    before = set(bpy.data.objects)
    kind = os.path.splitext(path)[1].lower()
    try:
        if kind == ".ply":
            if hasattr(bpy.types, "WM_OT_ply_import"):
                bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")
            else:
                bpy.ops.import_mesh.ply(filepath=path)
        elif kind == ".obj":
            bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
        elif kind == ".stl":
            if hasattr(bpy.types, "WM_OT_stl_import"):
                bpy.ops.wm.stl_import(filepath=path, forward_axis="Y", up_axis="Z")
            else:
                bpy.ops.import_mesh.stl(filepath=path, axis_forward="Y", axis_up="Z")
        elif kind in (".glb", ".gltf"):
            bpy.ops.import_scene.gltf(filepath=path)
            # Blender turns a glTF file's y up into its z up; Glint takes the axes of the file as they are.
            for object_ in chosen(bpy.data.objects, before):
                if object_.parent is None:
                    object_.matrix_world = Matrix.Rotation(-math.pi / 2, 4, "X") @ object_.matrix_world
            bpy.context.view_layer.update()
        else:
            raise InputError(path, "", "is no PLY, OBJ, STL or glTF file by its name")
    except (RuntimeError, AttributeError) as e:
        lines = [line.strip() for line in str(e).splitlines() if line.strip()] or [type(e).__name__]
        said = [line for line in lines if re.match(r"\w*(Error|Exception): ", line)] or lines
        raise InputError(path, "", f"Blender's reader fails: {said[-1]}") from None
    made = [o for o in chosen(bpy.data.objects, before)]
    found = [o for o in made if o.type == "MESH"]
    if not found or not any(len(o.data.polygons) for o in found):
        raise InputError(path, "", "has no faces")
    return made, found


def mesh_surface(path, factor, world):
    """One object for each mesh of a file, in Blender's world. factor: metres per unit of the file."""
    made, found = run_reader(path)
    place = Matrix(world.as_matrix()) @ Matrix.Scale(factor, 4)
    for object_ in found:
        object_.data.transform(place @ object_.matrix_world)
        object_.parent = None
        object_.matrix_world = Matrix.Identity(4)
        object_.data.polygons.foreach_set("use_smooth", [True] * len(object_.data.polygons))
        object_.data.update()
        for home in list(object_.users_collection):
            home.objects.unlink(object_)
    for object_ in made:
        if object_ not in found:
            bpy.data.objects.remove(object_)
    return found


def surfaces_of(document, path, world, size, warnings):
    """Objects by id of the surface."""
    found, folder = {}, os.path.dirname(os.path.abspath(path))
    listing = document.get("surfaces")
    for name, surface in (listing.items() if isinstance(listing, dict) else []):
        place = f"surfaces.{name}"
        if not isinstance(surface, dict):
            raise InputError(path, place, "must be an object")
        if isinstance(surface.get("analytic"), dict):
            value = surface["analytic"]
            made = meshes.analytic(value.get("type"), value, size, path, f"{place}.analytic")
            if made is None:
                warnings.append(f"{name}: a surface of type {value.get('type')} has no mesh here and is left out")
                continue
            pose = scene_file.pose(value["world_from_surface"], path, f"{place}.analytic.world_from_surface") \
                if value.get("world_from_surface") is not None else None
            found[name] = [meshes.mesh_object(name, *made, world, pose)]
        elif surface.get("mesh") is not None:
            units = surface.get("units", 1.0)
            factor = {"m": 1.0, "cm": 0.01,
                      "mm": 0.001}.get(units) if isinstance(units, str) else scene_file.number(units, path, f"{place}.units")
            if not factor or factor < 0:
                raise InputError(path, f"{place}.units", "must be m, cm, mm or a number of metres")
            file = scene_file.inside(folder, surface["mesh"], path, f"{place}.mesh")
            if not os.path.isfile(file):
                raise InputError(path, f"{place}.mesh", f"{surface['mesh']} does not exist")
            found[name] = mesh_surface(file, factor, world)
            for object_ in found[name]:
                object_.name = name
        else:
            warnings.append(f"{name}: a surface of points has no mesh here and is left out")
        for object_ in found.get(name, []):
            object_[show.SURFACE] = name
    if any(f.get("surface") is None for f in document["frames"]) and len(found) != 1:
        warnings.append("frames whose surface is their depth map have no surface here")
    return found


def size_of(frames):
    """Side of a surface without end, m: what the cameras are away from the world's origin, doubled."""
    far = sorted(linear.length(linear.column(linear.inverse_rigid(f["pose"]), 3)) for f in frames)
    return 2 * far[len(far) // 2] or 1.0


def lens_warnings(frames, warnings):
    sizes = {(f["camera"]["width"], f["camera"]["height"]) for f in frames}
    if len(sizes) > 1:
        warnings.append(f"frames have {len(sizes)} sizes; Blender has one for all cameras, that of the first frame: the others are shown with "
                        "another edge (their exact cameras are kept)")
    if any(scene_file.bends(f["camera"]) for f in frames):
        warnings.append("the cameras bend straight lines; Blender shows them without (their exact cameras are kept, photographs are not undistorted)")
    if any(f["camera"].get("skew") for f in frames):
        warnings.append("cameras with skew are shown without (their exact cameras are kept)")
    aspects = [f["camera"]["fx"] / f["camera"]["fy"] for f in frames]
    if max(aspects) - min(aspects) > 1e-6:
        warnings.append("the pixels of frames have different aspects; Blender has one for all, that of the first frame")


class Importer:
    """Makes the objects of a scene file. first: Blender's frame of its first frame."""

    def __init__(self, context, path, world, first=1, one_camera=False, photographs=True):
        self.context, self.scene, self.path, self.world = context, context.scene, path, world
        self.first, self.one_camera, self.photographs, self.warnings = first, one_camera, photographs, []
        self.document = scene_file.read_json(path, "glint_scene")
        self.frames = results.frames_of(self.document, path)
        if len(self.frames) > MOST_FRAMES:
            raise InputError(path, "frames", f"{len(self.frames)} frames, more than {MOST_FRAMES}")
        self.numbers = [first + i for i in range(len(self.frames))]
        self.lights = self._lights()

    def _lights(self):
        rows = []
        for i, light in enumerate(results.objects(self.document.get("lights") or [], self.path, "lights")):
            place = f"lights[{i}]"
            row = {"id": str(light.get("id", "")),
                   "radius": scene_file.number(light.get("radius") or 0, self.path, f"{place}.radius")}
            for key in ("position", "direction"):
                if light.get(key) is not None:
                    row[key] = scene_file.vector(light[key], 3, self.path, f"{place}.{key}")
            for key, value in light.items():  # a shape that has its place by points: two ends, corners
                if isinstance(value, list) and value and isinstance(value[0], list):
                    if len(value) < 2:
                        raise InputError(self.path, f"{place}.{key}", "must be two points or more")
                    row["points"] = [scene_file.vector(p, 3, self.path, f"{place}.{key}") for p in value]
            row["frame"] = light.get("frame", "world")
            if row["frame"] not in ("world", "camera"):
                raise InputError(self.path, f"{place}.frame", "must be world or camera")
            if len([k for k in ("position", "direction", "points") if k in row]) != 1:
                raise InputError(self.path, place, "must have a position, a direction or the points of its shape")
            rows.append(row)
        return rows

    def _picture(self, frame):
        """Path of the picture of a frame, None without one (or without one to show)."""
        for key in ("image", "radiance"):
            if isinstance(frame[key], str) and frame[key]:
                file = scene_file.inside(os.path.dirname(os.path.abspath(self.path)), frame[key], self.path, f"frames.{key}")
                if os.path.isfile(file):
                    return file
                self.warnings.append(f"frame {frame['id']}: {frame[key]} does not exist")
        return None

    def run(self):
        pictures = [self._picture(f) for f in self.frames]
        lens_warnings(self.frames, self.warnings)
        surfaces = self._surfaces()  # before anything else, because it may fail
        name = self.document.get("name")
        root = bpy.data.collections.new(name if isinstance(name, str) and name else "Glint scene")
        self.scene.collection.children.link(root)
        cameras.set_image(self.scene, self.frames[0]["camera"])
        self.scene.frame_start, self.scene.frame_end, self.scene.frame_step = self.numbers[0], self.numbers[-1], 1
        self._link_surfaces(surfaces, root)
        rows = self._one_camera(root, pictures) if self.one_camera else self._camera_for_each(root, pictures)
        poses = [f["pose"] for f in self.frames]
        for light in self.lights:
            carried, middle = light["frame"] == "camera", [0.0, 0.0, 0.0]
            object_ = lamps.blender_light(light["id"] or "light", light, self.world.of_cameras() if carried else self.world,
                                          linear.transformed(poses[0], middle) if carried else middle)
            object_["glint_truth"] = True
            root.objects.link(object_)
            if carried:
                lamps.carry(object_, [bpy.data.objects[row["camera"]] for row in rows], poses, self.numbers, self.world)
        self.scene.glint.set_frames(rows, os.path.abspath(self.path))
        self.scene.glint.origin = "FILE"
        return root

    def _surfaces(self):
        before = set(bpy.data.objects)
        try:
            return surfaces_of(self.document, self.path, self.world, size_of(self.frames), self.warnings)
        except InputError:
            for object_ in chosen(bpy.data.objects, before):  # nothing is half loaded
                bpy.data.objects.remove(object_)
            raise

    def _link_surfaces(self, surfaces, root):
        only = next(iter(surfaces)) if len(surfaces) == 1 else None
        places = [Matrix(self.world.motion_to_blender(f["place"])) for f in self.frames]
        moves = any(p != Matrix.Identity(4) for p in places)
        for name, objects in surfaces.items():
            seen = [n for n, f in zip(self.numbers, self.frames) if (f["surface"] or only) == name]
            for object_ in objects:
                root.objects.link(object_)
                if moves:
                    cameras.keyed(object_, places, self.numbers)
                if len(surfaces) > 1:
                    show.show_only_in(object_, seen, self.numbers)

    def _show_picture(self, camera, picture):
        if picture and self.photographs:
            try:
                images.show(camera, picture, "photograph")
            except RuntimeError:
                self.warnings.append(f"{picture}: Blender cannot read it")

    def _camera_for_each(self, root, pictures):
        home = show.collection(root, "Cameras")
        rows, made = [], []
        for frame, number, picture in zip(self.frames, self.numbers, pictures):
            data = bpy.data.cameras.new(frame["id"])
            cameras.set_lens(data, frame["camera"])
            self._small(data)
            camera = bpy.data.objects.new(frame["id"], data)
            camera.rotation_mode = "QUATERNION"  # Euler angles lose digits where a camera looks straight up or down: 2e-3 px
            camera.matrix_world = cameras.blender_matrix(frame["pose"], self.world)
            home.objects.link(camera)
            self._show_picture(camera, picture)
            marker = self.scene.timeline_markers.new(frame["id"], frame=number)
            marker.camera = camera
            made.append(camera)
            rows.append({"id": frame["id"], "frame": number, "camera": camera.name, "picture": picture or "", "exact": True})
        self.context.view_layer.update()
        for frame, camera in zip(self.frames, made):
            cameras.keep_exact(self.scene, camera, frame["pose"], frame["camera"], self.world, frame["id"])
        self.scene.camera = made[0]
        self.scene.frame_set(self.numbers[0])
        return rows

    def _small(self, data):
        """A camera that is drawn small beside the scene."""
        data.display_size = size_of(self.frames) / 40 / self.world.scale

    def _one_camera(self, root, pictures):
        data = bpy.data.cameras.new("Glint camera")
        camera = bpy.data.objects.new("Glint camera", data)
        self._small(data)
        root.objects.link(camera)
        cameras.keyed(camera, [cameras.blender_matrix(f["pose"], self.world) for f in self.frames], self.numbers)
        for frame, number in zip(self.frames, self.numbers):
            cameras.set_lens(data, frame["camera"])
            for path in ("lens", "shift_x", "shift_y"):
                data.keyframe_insert(path, frame=number)
        self.scene.camera = camera
        for frame, number in zip(self.frames, self.numbers):
            self.scene.frame_set(number)
            cameras.keep_exact(self.scene, camera, frame["pose"], frame["camera"], self.world, frame["id"], number)
        self.scene.frame_set(self.numbers[0])
        self._show_picture(camera, pictures[0])
        return [{"id": f["id"], "frame": n, "camera": camera.name, "picture": p or "", "exact": True}
                for f, n, p in zip(self.frames, self.numbers, pictures)]


@orientation_helper(axis_forward="Y", axis_up="Z")
class GLINT_OT_import_scene(bpy.types.Operator, ImportHelper):
    """Read cameras with their photographs, surfaces and lamps of a Glint scene"""
    bl_idname = "glint.import_scene"
    bl_label = "Import Glint Scene"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    scale: FloatProperty(name="Metres per Unit",
                         description="Length of one Blender unit in metres, on top of the scene's unit scale", default=1.0,
                         min=1e-6, max=1e6)
    cameras: EnumProperty(name="Cameras", description="How the cameras of the frames become objects",
                          items=[("EACH", "One for Each Frame",
                                  "A camera object for each frame, bound to markers of the timeline"),
                                 ("ONE", "One Animated", "One camera object with keys at each frame")], default="EACH")
    first: IntProperty(name="First Frame", description="Blender's frame that shows the first frame of the file", default=1)
    photographs: BoolProperty(name="Photographs", description="Show the photographs behind the cameras' views", default=True)

    def execute(self, context):
        try:
            world = world_from(context.scene, self.axis_forward, self.axis_up, self.scale)
            importer = Importer(context, self.filepath, world, self.first, self.cameras == "ONE", self.photographs)
            importer.run()
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        context.scene.glint.remember(self.axis_forward, self.axis_up, self.scale)
        told(self, importer.warnings)
        self.report({"INFO"}, f"{len(importer.frames)} frames, {len(importer.lights)} lamps")
        return {"FINISHED"}


def menu(self, context):
    self.layout.operator(GLINT_OT_import_scene.bl_idname, text="Glint Scene (.json)")


classes = (GLINT_OT_import_scene,)


def register():
    bpy.types.TOPBAR_MT_file_import.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu)
