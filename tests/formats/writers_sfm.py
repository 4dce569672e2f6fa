# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP, NVM and Bundler: programs that find cameras and sparse points from photographs. Their unit of length is arbitrary; here
it is the metre.

Sources: COLMAP's page "Output Format" and the order of its binary records there; the description of NVM on the page of VisualSFM;
the manual of Bundler, "Output format and scene representation".
"""
import struct

from exact_scene import quaternion_of, tracks
from writers import Case, Frame, NotExpressible, by_name, need_middle, number, numbers, write, write_mesh, write_photograph

# Ids are arbitrary in COLMAP: neither from 1 nor without gaps nor in any order.
CAMERA_IDS = (7, 3)
IMAGE_IDS = (41, 7, 102, 13, 5, 77, 29, 64, 18, 90, 33, 2)
CORNER = 0.5  # COLMAP's origin is the corner of the first pixel, ours its centre
NO_POINT = 2 ** 64 - 1
GREY = 128


def point_id(k):
    return 3 * k + 11


def colmap_cameras(scene):
    """id -> (COLMAP's name of the model, its number, width, height, parameters). PINHOLE has two equal focal lengths."""
    found = {}
    for view in scene.views:
        middle = (view.cx + CORNER, view.cy + CORNER)
        if view.camera == 0:
            found[CAMERA_IDS[0]] = ("PINHOLE", 1, view.width, view.height, (view.fx, view.fy, *middle))
        else:
            if view.fx != view.fy:
                raise NotExpressible("SIMPLE_PINHOLE has one focal length")
            found[CAMERA_IDS[1]] = ("SIMPLE_PINHOLE", 0, view.width, view.height, (view.fx, *middle))
    return found


def colmap_images(scene):
    for image_id, view in zip(IMAGE_IDS, scene.views):
        features = [(u + CORNER, v + CORNER, k) for k, (u, v) in view.seen]
        yield image_id, quaternion_of(view.rotation), view.translation, CAMERA_IDS[view.camera], view.name + ".png", features


def colmap_case(name, folder, scene):
    write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    frames = [Frame(view.name, view, write_photograph(folder / "images" / f"{view.name}.png", view)) for view in scene.views]
    return Case(name, folder, by_name(frames), scene)


def colmap_text(folder, scene):
    model = folder / "sparse" / "0"
    cameras = "# id, model, width, height, parameters\n"
    for i, (kind, _, width, height, parameters) in colmap_cameras(scene).items():
        cameras += f"{i} {kind} {width} {height} {numbers(*parameters)}\n"
    write(model / "cameras.txt", cameras)
    images = "# id, quaternion (w x y z), translation, camera, name; below it the features (x, y, point)\n"
    for i, quaternion, translation, camera, name, features in colmap_images(scene):
        images += f"{i} {numbers(*quaternion, *translation)} {camera} {name}\n"
        images += " ".join(f"{number(x)} {number(y)} {-1 if k is None else point_id(k)}" for x, y, k in features) + "\n"
    write(model / "images.txt", images)
    points = "# id, position, colour, error, track (image, feature)\n"
    for k, seen in sorted(tracks(scene).items(), reverse=True):
        track = " ".join(f"{IMAGE_IDS[i]} {j}" for i, j, _ in seen)
        points += f"{point_id(k)} {numbers(*scene.sparse[k])} {GREY} {GREY} {GREY} 0 {track}\n"
    write(model / "points3D.txt", points)
    return colmap_case("colmap_text", folder, scene)


def colmap_binary(folder, scene):
    model = folder / "sparse" / "0"
    cameras = colmap_cameras(scene)
    data = struct.pack("<Q", len(cameras))
    for i, (_, kind, width, height, parameters) in cameras.items():
        data += struct.pack(f"<iiQQ{len(parameters)}d", i, kind, width, height, *parameters)
    write(model / "cameras.bin", data)
    parts = [struct.pack("<Q", len(scene.views))]
    for i, quaternion, translation, camera, name, features in colmap_images(scene):
        parts.append(struct.pack("<I7dI", i, *quaternion, *translation, camera) + name.encode() + b"\0")
        parts.append(struct.pack("<Q", len(features)))
        parts += (struct.pack("<ddQ", x, y, NO_POINT if k is None else point_id(k)) for x, y, k in features)
    write(model / "images.bin", b"".join(parts))
    found = tracks(scene)
    parts = [struct.pack("<Q", len(found))]
    for k, seen in sorted(found.items(), reverse=True):
        parts.append(struct.pack("<Q3d3BdQ", point_id(k), *scene.sparse[k], GREY, GREY, GREY, 0.0, len(seen)))
        parts += (struct.pack("<II", IMAGE_IDS[i], j) for i, j, _ in seen)
    write(model / "points3D.bin", b"".join(parts))
    return colmap_case("colmap_binary", folder, scene)


def nvm(folder, scene):
    """Quaternion (w first) of camera from world, the camera's centre instead of a translation, the radial term, 0, and a 0."""
    text = f"NVM_V3\n\n{len(scene.views)}\n"
    frames = []
    for view in scene.views:
        need_middle(view, "NVM")
        name = f"images/{view.name}.png"
        frames.append(Frame(view.name, view, write_photograph(folder / name, view)))
        text += f"{name} {numbers(view.fx, *quaternion_of(view.rotation), *view.centre())} 0 0\n"
    found = tracks(scene)
    text += f"\n{len(found)}\n"
    for k, seen in found.items():
        text += f"{numbers(*scene.sparse[k])} {GREY} {GREY} {GREY} {len(seen)}"
        for i, j, (u, v) in seen:  # from the middle, y downwards
            text += f" {i} {j} {numbers(u - scene.views[i].cx, v - scene.views[i].cy)}"
        text += "\n"
    # The end of the models, and no PLY file belongs to any.
    write(folder / "model.nvm", text + "\n0\n\n# models with a PLY file\n0\n")
    write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return Case("nvm", folder, by_name(frames), scene)


def bundler_files(bundle, root, scene, with_guess):
    """Looks along -z with y upwards: y and z of the camera's frame change their signs.

    The third photograph is not registered, which Bundler writes as zeros; cameras and list still have it.
    @param with_guess  the list also says the focal length with which Bundler began, as "name 0 length"
    """
    missing = 2
    names, text, frames = [], "", []
    for view in scene.views:
        need_middle(view, "Bundler")
        if len(names) == missing:
            write_photograph(root / "images" / "unregistered.png", view)
            names.append("images/unregistered.png")
            text += "0 0 0\n" + "0 0 0\n" * 4
        name = f"images/{view.name}.png"
        frames.append(Frame(view.name, view, write_photograph(root / name, view)))
        names.append(f"{name} 0 {number(1.1 * view.fx)}" if with_guess else name)
        x, y, z = view.rotation
        t = view.translation
        text += f"{number(view.fx)} 0 0\n{numbers(*x)}\n"
        text += "".join(numbers(*(-c for c in row)) + "\n" for row in (y, z)) + f"{numbers(t[0], -t[1], -t[2])}\n"
    found = tracks(scene)
    for k, seen in found.items():
        text += f"{numbers(*scene.sparse[k])}\n{GREY} {GREY} {GREY}\n{len(seen)}"
        for i, j, (u, v) in seen:  # from the middle, y upwards
            text += f" {i + (i >= missing)} {j} {numbers(u - scene.views[i].cx, scene.views[i].cy - v)}"
        text += "\n"
    write(bundle, f"# Bundle file v0.3\n{len(names)} {len(found)}\n{text}")
    write(root / "list.txt", "".join(name + "\n" for name in names))
    write_mesh(root / "mesh.ply", scene.mesh, scene.mesh_comment)
    return by_name(frames)


def bundler(folder, scene):
    """As Bundler leaves it: bundle/bundle.out, and list.txt in the project's root."""
    return Case("bundler", folder, bundler_files(folder / "bundle" / "bundle.out", folder, scene, True), scene)


def bundler_flat(folder, scene):
    """As other programs export it: both files beside each other."""
    return Case("bundler_flat", folder, bundler_files(folder / "bundle.out", folder, scene, False), scene)
