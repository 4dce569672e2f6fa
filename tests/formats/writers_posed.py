# SPDX-License-Identifier: BSD-3-Clause
"""scene.json, nerfstudio, TUM RGB-D, BOP, images and videos with poses.

Sources: docs of nerfstudio, "Data conventions", and for applied_transform its parser of transforms.json; the page "File Formats"
of the TUM RGB-D benchmark; the description of the BOP datasets.
"""
import json
import struct

from exact_scene import World, dot, enlarged, length, product, quaternion_of, rotation_of, scaled, sub, times, tracks, transposed, unit
from writers import (Case, Frame, NotExpressible, by_name, number, numbers, write, write_json, write_mesh, write_photograph,
                     write_points)

CORNER = 0.5  # nerfstudio's origin is the corner of the first pixel, ours its centre


def scene_json(folder, scene):
    """Frames stay in the order of the file. The first camera is the scene's, the others are their frames' own."""
    units_per_metre = 4000  # not that of any other format

    def camera(view):
        return {"width": view.width, "height": view.height, "fx": view.fx, "fy": view.fy, "cx": view.cx, "cy": view.cy}

    first = camera(scene.views[0])
    found, frames = [], []
    for view in scene.views:
        image = write_photograph(folder / "frames" / f"{view.name}.png", view)
        depth = write(folder / "depth" / f"{view.name}.png", view.pictures.depth_png(units_per_metre))
        write(folder / "mask" / f"{view.name}.png", view.pictures.mask_png())
        found.append(Frame(view.name, view, image, depth))
        frame = {"id": view.name, "image": f"frames/{view.name}.png", "depth": f"depth/{view.name}.png",
                 "depth_scale": 1 / units_per_metre, "mask": f"mask/{view.name}.png",
                 "camera_from_world": view.matrix(), "surface": "body"}
        if camera(view) != first:
            frame["camera"] = camera(view)
        frames.append(frame)
    write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    write_json(folder / "scene.json", {"glint_scene": 1, "name": "ellipsoid", "units": "m", "camera": first, "frames": frames,
                                       "surfaces": {"body": {"mesh": "mesh.ply"}}})
    return Case("scene", folder, found, scene, 1 / units_per_metre)


def nerfstudio_frames(folder, scene, units):
    """Camera to world, looks along -z with y upwards. `units`: stored depth per metre."""
    frames, found = [], []
    for view in scene.views:
        image = write_photograph(folder / "images" / f"{view.name}.png", view)
        depth = write(folder / "depth" / f"{view.name}.png", view.pictures.depth_png(units))
        found.append(Frame(view.name, view, image, depth))
        axes = transposed(view.rotation)  # columns: the camera's axes in the world
        rows = [[x, -y, -z, c] for (x, y, z), c in zip(axes, view.centre())]
        frames.append({"file_path": f"images/{view.name}.png", "depth_file_path": f"depth/{view.name}.png",
                       "fl_x": view.fx, "fl_y": view.fy, "transform_matrix": [*rows, [0.0, 0.0, 0.0, 1.0]]})
    return frames, found


def same_for_all(scene, *names):
    values = {tuple(getattr(view, name) for name in names) for view in scene.views}
    if len(values) > 1:
        raise NotExpressible(f"{names} differ between views")
    return values.pop()


def seen_points(scene):
    """As nerfstudio takes them out of a COLMAP model, without their tracks: a point there was seen by two views at least."""
    return [scene.sparse[k] for k in sorted(tracks(scene))]


def nerfstudio(folder, scene):
    """In the scene's own world. Focal lengths per frame, the rest for all; masks; sparse points."""
    frames, found = nerfstudio_frames(folder, scene, 1000)
    for view, frame in zip(scene.views, frames):
        write(folder / "masks" / f"{view.name}.png", view.pictures.mask_png())
        frame["mask_path"] = f"masks/{view.name}.png"
    width, height, cx, cy = same_for_all(scene, "width", "height", "cx", "cy")
    write_json(folder / "transforms.json", {"camera_model": "OPENCV", "w": width, "h": height,
                                            "cx": cx + CORNER, "cy": cy + CORNER,
                                            "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0,
                                            "ply_file_path": "sparse_pc.ply", "frames": frames})
    write_points(folder / "sparse_pc.ply", seen_points(scene))
    write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return Case("nerfstudio", folder, by_name(found), scene, 0.001)


# No rotation is its own inverse here, nor is the shift along an axis: an inverse or an order that is mixed up is seen.
APPLIED = World(rotation_of(0.31, 0.74, -0.29, 0.53), [0.7, -1.9, 0.4], 2.75)


def nerfstudio_applied(folder, scene):
    """In a world that was moved before it was saved: saved = applied_scale (applied_transform original).

    Two cases, by whether --world original undoes it. Depth is stored in millimetres of the original world: nerfstudio multiplies
    it by applied_scale when it reads it (its dataparser_scale). mesh.ply is in the saved world, as the sparse points; original/object.ply is in the scene's own.
    """
    saved = scene.moved(APPLIED)
    frames, found = nerfstudio_frames(folder, saved, 1000)  # pictures have depth in metres
    for view, frame in zip(saved.views, frames):
        frame |= {"w": view.width, "h": view.height, "cx": view.cx + CORNER, "cy": view.cy + CORNER}
    applied = [[*row, t] for row, t in zip(APPLIED.rotation, APPLIED.shift)]
    write_json(folder / "transforms.json", {"camera_model": "PINHOLE",
                                            "applied_transform": applied, "applied_scale": APPLIED.scale,
                                            "ply_file_path": "sparse_pc.ply", "frames": frames})
    write_points(folder / "sparse_pc.ply", seen_points(saved))
    write_mesh(folder / "mesh.ply", saved.mesh, scene.mesh_comment + ", moved by applied_transform and applied_scale")
    own = write_mesh(folder / "original" / "object.ply", scene.mesh, scene.mesh_comment)
    back = {view.name: view for view in scene.views}
    undone = [Frame(f.id, back[f.view.name], f.image, f.depth) for f in found]
    return [Case("nerfstudio_applied", folder, by_name(found), saved, 0.001 * APPLIED.scale),
            Case("nerfstudio_original", folder, by_name(undone), scene, 0.001,
                 ["--world", "original", "--surface", own])]


def between(view, other, share):
    """A pose on the way from one view to another: what a tracker reports at other times."""
    x = unit([(1 - share) * a + share * b for a, b in zip(view.rotation[0], other.rotation[0])])
    z = [(1 - share) * a + share * b for a, b in zip(view.rotation[2], other.rotation[2])]
    z = unit(sub(z, scaled(x, dot(x, z))))
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    centre = [(1 - share) * a + share * b for a, b in zip(view.centre(), other.centre())]
    return [x, y, z], centre


def stamp(microseconds):
    return f"{microseconds // 1000000}.{microseconds % 1000000:06d}"


def tum_line(microseconds, rotation, centre):
    """Camera to world, quaternion with w last."""
    w, x, y, z = quaternion_of(transposed(rotation))
    return f"{stamp(microseconds)} {numbers(*centre, x, y, z, w)}\n"


def tum(folder, scene):
    """Views of the first camera only, because all share --camera. Images have the time as their name.

    Poses come more often than images; the nearest in time is the view's own, 6 ms away, and those 12 to 14 ms away are others.
    Depth is 3 ms late, and one depth image is of no colour image. The last colour image has no pose within 20 ms and is no frame.
    """
    views = [view for view in scene.views if view.camera == 0]
    start, step = 1305031102175304, 133337  # microseconds
    rgb, depth, poses, found = [], [], [], []
    for k, view in enumerate(views):
        time = start + k * step
        late = 6000 if k % 2 else -6000
        other = views[(k + 1) % len(views)]
        poses += [tum_line(time + late, view.rotation, view.centre()), tum_line(time - 2 * late, *between(view, other, 0.2)),
                  tum_line(time + 9 * late // 4, *between(view, other, 0.1)), tum_line(time + 50000, *between(view, other, 0.4))]
        image = write_photograph(folder / "rgb" / f"{stamp(time)}.png", view)
        measured = write(folder / "depth" / f"{stamp(time + 3000)}.png", view.pictures.depth_png(5000))
        rgb.append(f"{stamp(time)} rgb/{image.name}\n")
        depth.append(f"{stamp(time + 3000)} depth/{measured.name}\n")
        found.append(Frame(image.stem, view, image, measured))
        if k == 1:
            early = write(folder / "depth" / f"{stamp(time + 40000)}.png", view.pictures.depth_png(5000))
            depth.append(f"{stamp(time + 40000)} depth/{early.name}\n")
    lost = write_photograph(folder / "rgb" / f"{stamp(start + len(views) * step + 60000)}.png", views[0])
    rgb.append(f"{lost.stem} rgb/{lost.name}\n")
    poses.append(tum_line(start + len(views) * step + 85000, views[0].rotation, views[0].centre()))
    write(folder / "rgb.txt", "# colour images\n# time, file\n" + "".join(rgb))
    write(folder / "depth.txt", "# depth maps\n# time, file\n" + "".join(depth))
    write(folder / "groundtruth.txt", "# poses of the colour camera\n# time tx ty tz qx qy qz qw\n" + "".join(sorted(poses)))
    mesh = write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    v = views[0]
    camera = ",".join(map(number, (v.fx, v.fy, v.cx, v.cy)))
    return Case("tum", folder, by_name(found), scene, 1 / 5000, ["--camera", camera, "--surface", mesh])


MILLIMETRES = 1000
IMAGE_NUMBERS = (105, 7, 12, 31, 3, 88, 240, 19, 56, 101, 1, 64)
OBJECT, OTHER_OBJECT = 4, 11
# Where the object stands in the world of the scene's other cameras (cam_R_w2c), which is not the object's frame.
BOP_WORLD = World(rotation_of(0.62, -0.35, 0.51, 0.48), [0.21, 0.33, -0.87])


def bop_data(folder, scene, with_other):
    """Millimetres. A depth unit is 0.1 mm. The object's frame, that of its model, is the scene's world."""
    place = folder / "test" / "000002"
    cameras, truth, found = {}, {}, []
    for k, view in zip(IMAGE_NUMBERS, scene.views):
        image = write_photograph(place / "rgb" / f"{k:06d}.png", view)
        depth = write(place / "depth" / f"{k:06d}.png", view.pictures.depth_png(10 * MILLIMETRES))
        found.append(Frame(image.stem, view, image, depth))
        still = BOP_WORLD.view(view)
        cameras[str(k)] = {"cam_K": [view.fx, 0.0, view.cx, 0.0, view.fy, view.cy, 0.0, 0.0, 1.0], "depth_scale": 0.1,
                           "cam_R_w2c": sum(still.rotation, []), "cam_t_w2c": scaled(still.translation, MILLIMETRES)}
        truth[str(k)] = [{"cam_R_m2c": sum(view.rotation, []), "cam_t_m2c": scaled(view.translation, MILLIMETRES),
                          "obj_id": OBJECT}]
        if with_other:  # elsewhere, and first in the list
            turned = product(view.rotation, BOP_WORLD.rotation)
            away = scaled([a + b for a, b in zip(view.translation, times(turned, [0.4, 0.1, -0.2]))], MILLIMETRES)
            truth[str(k)].insert(0, {"cam_R_m2c": sum(turned, []), "cam_t_m2c": away, "obj_id": OTHER_OBJECT})
    write_json(place / "scene_camera.json", cameras)
    write_json(place / "scene_gt.json", truth)
    mesh = scene.mesh.moved(enlarged(MILLIMETRES))
    low, high = ([f(v[i] for v in mesh.vertices) for i in range(3)] for f in (min, max))
    facts = {"diameter": length(sub(high, low))} | {f"min_{n}": v for n, v in zip("xyz", low)} | {
        f"size_{n}": b - a for n, a, b in zip("xyz", low, high)}
    objects = [OBJECT, OTHER_OBJECT] if with_other else [OBJECT]
    for k in objects:
        write_mesh(folder / "models" / f"obj_{k:06d}.ply", mesh, "ellipsoid, as a BOP model")
    write_json(folder / "models" / "models_info.json", {str(k): facts for k in objects})
    return place, by_name(found)


def bop(folder, scene):
    return Case("bop", *bop_data(folder, scene, False), scene, 0.0001)


def bop_two_objects(folder, scene):
    """Two objects in every image; --object says which one is meant."""
    return Case("bop_two_objects", *bop_data(folder, scene, True), scene, 0.0001, ["--object", str(OBJECT)])


# --- images and videos with the poses of a tracker ---

def shared_camera(view):
    return ["--camera", ",".join(map(number, (view.fx, view.fy, view.cx, view.cy)))]


def images_tum(folder, scene):
    """A folder of images whose names are times, with TUM lines of the first camera: each pose 4 ms beside its image, others between
    them, and an image and a pose that are far from all."""
    views = [view for view in scene.views if view.camera == 0]
    start, step = 4711250000, 40000  # microseconds
    lines, found = ["# time tx ty tz qx qy qz qw\n"], []
    for k, view in enumerate(views):
        time = start + k * step
        beside = 4000 if k % 3 else -4000
        lines += [tum_line(time + beside, view.rotation, view.centre()),
                  tum_line(time + step // 2 - 3000, *between(view, views[(k + 1) % len(views)], 0.5))]
        image = write_photograph(folder / "images" / f"{stamp(time)}.png", view)
        found.append(Frame(image.stem, view, image))
    write_photograph(folder / "images" / f"{stamp(start + 1000 * step)}.png", views[0])
    lines.append(tum_line(start + 2000 * step, views[0].rotation, views[0].centre()))
    poses = write(folder / "poses.txt", "".join(lines))
    mesh = write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return Case("images_tum", folder / "images", by_name(found), scene, None,
                ["--poses", poses, *shared_camera(views[0]), "--surface", mesh])


def pose_json(view, **more):
    return json.dumps({**more, "camera_from_world": view.matrix()}) + "\n"


def images_json(folder, scene):
    """JSON lines in another order than the images, world to camera, each with its camera; one image without a line, one line
    without an image."""
    lines, found = [], []
    for view in scene.views:
        camera = {"width": view.width, "height": view.height, "fx": view.fx, "fy": view.fy, "cx": view.cx, "cy": view.cy}
        lines.append(pose_json(view, id=view.name, camera=camera))
        image = write_photograph(folder / "images" / f"{view.name}.png", view)
        found.append(Frame(view.name, view, image))
    write_photograph(folder / "images" / "without.png", scene.views[0])
    lines.insert(3, pose_json(scene.views[0], id="of-no-image", time=7.5))
    poses = write(folder / "poses.jsonl", "".join(reversed(lines)))
    mesh = write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return Case("images_json", folder / "images", by_name(found), scene, None, ["--poses", poses, "--surface", mesh])


def avi(width, height, fps, pictures):
    """An AVI file of pictures that are not compressed: rows from below, blue green red. Microsoft, "AVI RIFF File Reference"."""
    def chunk(name, body):
        return name + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)

    def rows_list(name, body):
        return chunk(b"LIST", name + body)

    def stored(rgb):
        row = 3 * width
        lines = (rgb[at:at + row] for at in range(row * (height - 1), -1, -row))
        filled = b"\0" * (-row % 4)
        swapped = bytearray()
        for line in lines:
            turned = bytearray(row)
            turned[0::3], turned[1::3], turned[2::3] = line[2::3], line[1::3], line[0::3]
            swapped += turned + filled
        return bytes(swapped)

    frames = [stored(p) for p in pictures]
    size = len(frames[0])
    main_header = struct.pack("<14I", 1000000 // fps, size * fps, 0, 0x10, len(frames), 0, 1, size, width, height, 0, 0, 0, 0)
    stream = struct.pack("<4s4sIHHIIIIIIII4H", b"vids", b"DIB ", 0, 0, 0, 0, 1, fps, 0, len(frames), size, 0xFFFFFFFF, 0,
                         0, 0, width, height)
    bitmap = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    header = rows_list(b"hdrl", chunk(b"avih", main_header) +
                       rows_list(b"strl", chunk(b"strh", stream) + chunk(b"strf", bitmap)))
    index, at = b"", 4
    for frame in frames:
        index += struct.pack("<4sIII", b"00db", 0x10, at, len(frame))
        at += 8 + len(frame)
    body = b"AVI " + header + rows_list(b"movi", b"".join(chunk(b"00db", f) for f in frames)) + chunk(b"idx1", index)
    return b"RIFF" + struct.pack("<I", len(body)) + body


def video_case(folder, scene, name, lines_of):
    """A video of 25 pictures per second that shows the views of the first camera; every second picture has a pose."""
    views = [view for view in scene.views if view.camera == 0]
    fps = 25
    shown = [view for view in views for _ in range(2)]  # each twice: the second picture has no pose
    file = write(folder / "video.avi", avi(views[0].width, views[0].height, fps, [v.pictures.photograph for v in shown]))
    found = [Frame(f"{2 * k:06d}", view, file) for k, view in enumerate(views)]
    poses = write(folder / "poses.txt", "".join(lines_of(views, 2 / fps)))
    mesh = write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return Case(name, file, found, scene, None, ["--poses", poses, *shared_camera(views[0]), "--surface", mesh])


def video_tum(folder, scene):
    """TUM lines, 6 ms beside the pictures."""
    return video_case(folder, scene, "video_tum", lambda views, step: [
        tum_line(round(1e6 * k * step) + 6000, view.rotation, view.centre()) for k, view in enumerate(views)])


def video_json(folder, scene):
    """JSON lines by time."""
    return video_case(folder, scene, "video_json", lambda views, step: [
        pose_json(view, id=f"pose {k}", time=k * step) for k, view in enumerate(views)])
