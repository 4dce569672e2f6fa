# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of frames: where they are, and pictures in a camera's view."""
import os
import shutil

import bpy

LINEAR = {".exr", ".tif", ".tiff", ".hdr"}  # may be float; .exr and .hdr always are
PICTURES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp", ".webp", ".hdr"}


# How files of these formats begin: a name says nothing about what is copied.
BEGINNINGS = (b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"v/1\x01", b"BM", b"#?RADIANCE",
              b"#?RGBE")


def is_picture(path):
    """Whether the file is a picture by its name and by its first bytes."""
    if os.path.splitext(path)[1].lower() not in PICTURES:
        return False
    try:
        with open(path, "rb") as file:
            head = file.read(12)
    except OSError:
        return False
    return head.startswith(BEGINNINGS) or (head[:4] == b"RIFF" and head[8:] == b"WEBP")


trusted = set()  # .blend files whose pictures may lie anywhere: the user said so since Blender started; no file can


def may_copy(path):
    """Whether a picture that the scene names may be copied: it lies below the folder of the .blend file, links followed, or the user trusts the
    file. A scene that was never saved names what its user chose."""
    if not bpy.data.filepath or bpy.data.filepath in trusted:
        return True
    root, place = os.path.realpath(os.path.dirname(bpy.data.filepath)), os.path.realpath(path)
    return os.path.commonpath([root, place]) == root


class GLINT_OT_trust_pictures(bpy.types.Operator):
    """Copy pictures that this .blend file names outside of its folder, until Blender ends. A .blend file of others may name any picture"""
    bl_idname = "glint.trust_pictures"
    bl_label = "Allow Pictures from Other Folders"

    @classmethod
    def poll(cls, context):
        return bool(bpy.data.filepath) and bpy.data.filepath not in trusted

    def execute(self, context):
        trusted.add(bpy.data.filepath)
        return {"FINISHED"}


classes = (GLINT_OT_trust_pictures,)


def rendered(scene, frame):
    """Path of the file that a render of this frame writes."""
    return bpy.path.abspath(scene.render.frame_path(frame=frame))


def in_folder(folder):
    """Pictures of a folder, by name."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    return [os.path.join(folder, n) for n in names if os.path.splitext(n)[1].lower() in PICTURES]


def behind(camera, frame):
    """Path of the first background image of a camera at a frame, None without one."""
    for background in camera.data.background_images:
        image = background.image
        if background.source != "IMAGE" or image is None or image.get("glint_slot") == "overlay":
            continue
        if image.source == "SEQUENCE":
            path = image.filepath_from_user(image_user=background.image_user)
        else:
            path = image.filepath
        return bpy.path.abspath(path)
    return None


def key_for(path):
    """`radiance` for pictures that are float by their format, else `image`."""
    return "radiance" if os.path.splitext(path)[1].lower() in (".exr", ".hdr") else "image"


def put_into(folder, path, name):
    """Copies a picture to the place that a Folder gives for it; the relative name."""
    relative = name + os.path.splitext(path)[1].lower()
    shutil.copyfile(path, folder.path(relative))
    return relative


def colour_warning(scene, paths):
    """What is wrong with pictures that a render of this scene wrote, "" if nothing is known to be. Glint reads 8- and 16-bit codes as sRGB."""
    if all(key_for(p) == "radiance" for p in paths):
        return ""
    view = scene.view_settings
    if view.view_transform not in ("Standard", "Raw") or view.look not in ("None",
                                                                           "") or view.gamma != 1.0 or view.use_curve_mapping:
        return (f"the pictures may have been rendered with the view transform {view.view_transform}, which Glint cannot undo: contours lie at "
                "other levels then; render OpenEXR, or with the view transform Standard")
    return ""


def show(camera, path, slot):
    """Shows a picture in the view of a camera. slot: `photograph`, behind everything, or `overlay`, before it; one that was there is replaced."""
    data = camera.data
    for background in list(data.background_images):
        if background.image is not None and background.image.get("glint_slot") == slot:
            data.background_images.remove(background)
    image = bpy.data.images.load(path, check_existing=True)
    image.reload()  # the file may be new
    image["glint_slot"] = slot
    background = data.background_images.new()
    background.image = image
    background.alpha = 1.0
    background.display_depth = "FRONT" if slot == "overlay" else "BACK"
    background.frame_method = "STRETCH"  # the picture has the camera's pixels, so it fills the view
    data.show_background_images = True
    return background


def show_sequence(camera, first_path, first_number, first_frame, count):
    """The same for overlays whose names are numbers: first_path, with first_number, belongs to Blender's first_frame; one a frame."""
    background = show(camera, first_path, "overlay")
    background.image.source = "SEQUENCE"
    user = background.image_user
    user.frame_start, user.frame_offset, user.frame_duration = first_frame, first_number - 1, count
    user.use_cyclic = False
    return background
