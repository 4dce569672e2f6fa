# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: names of files, and folders that are recognised."""
import json
import re
import shutil
import struct
import unicodedata
import zlib

from run import lacks, near, says  # noqa: F401

# Errors of the same capture without the fault, by the README of each folder.
WHOLE = {"limit-angle": 0.7935, "canonical": 1.6744}
POSED = ["./im", "--poses", "./poses.txt", "--surface", "./mesh.ply", "--camera", "400.0,400.0,159.5,119.5"]


def edit_transforms(report, change):
    """Changes every frame of transforms.json."""
    file = report.folder / "transforms.json"
    capture = json.loads(file.read_text())
    for frame in capture["frames"]:
        change(frame)
    file.write_text(json.dumps(capture))


def case_path_mixed_slashes(report):
    near(report.errors(), WHOLE)


def case_path_mixed_slashes__scene(report):
    report.glint("convert", ".", "-o", "scene.json")
    text = (report.folder / "scene.json").read_text()
    (report.folder / "scene.json").write_text(text.replace("nerf/canister/rgb/", "nerf\\\\canister\\\\rgb/"))
    assert "canister\\\\rgb/0000.png" in (report.folder / "scene.json").read_text()
    near(report.errors("scene.json"), WHOLE)


def case_path_case(report):
    near(report.errors(), WHOLE)
    says(report.info(), "8 files have other names", "'images/IMG_0000.png' is 'images/IMG_0000.PNG'")


def case_path_case__folder(report):
    (report.folder / "images").rename(report.folder / "Images")
    near(report.errors(), WHOLE)


def case_path_case__photographs(report):
    (report.folder / "images").rename(report.folder / "elsewhere")
    near(report.errors(".", "--photographs", "elsewhere"), WHOLE)


def case_path_case__several(report):
    """Two files that differ from the name in case: neither is taken."""
    for image in list((report.folder / "images").iterdir()):
        shutil.copy(image, image.with_suffix(".Png"))
    says(report.glint("evaluate", ".", "--models", "limit-angle", "--train", "spread:5", exit_code=3).stderr, "IMG_0000.png", "No such file")


def case_path_case__other_ending(report):
    """Converted photographs: the only image of that name is taken."""
    edit_transforms(report, lambda f: f.update(file_path=f["file_path"].replace(".png", ".jpeg")))
    near(report.errors(), WHOLE)
    says(report.info(), "ending")


def case_path_case__unicode(report):
    """macOS hands out accents apart from their letters; Korean syllables in parts."""
    for place, name in enumerate(["Größe", "Ångström", "한국어", "Việt", "й"]):
        copy = report.folder / f"copy{place}"
        shutil.copytree(report.folder / "images", copy / "images")
        for file in ["transforms.json", "mesh.ply"]:
            shutil.copy(report.folder / file, copy)
        (copy / "images").rename(copy / unicodedata.normalize("NFC", name))
        text = (copy / "transforms.json").read_text().replace("images/", unicodedata.normalize("NFD", name) + "/")
        (copy / "transforms.json").write_text(text)
        near(report.errors(f"copy{place}"), WHOLE)


def case_pose_id_with_ending(report):
    near(report.errors(*POSED), WHOLE)


def case_pose_id_with_ending__case_and_folder(report):
    text = (report.folder / "poses.txt").read_text()
    (report.folder / "poses.txt").write_text(re.sub(r'"(\d{4})\.png"', r'"im\\\\\1.PNG"', text))
    near(report.errors(*POSED), WHOLE)


def case_nerf_synthetic_folder(report):
    near(report.errors(), WHOLE)
    says(report.info(), "only transforms_train.json is read", "transforms_test.json", "transforms_val.json")
    near(report.errors("transforms_train.json"), WHOLE)


def case_nerf_synthetic_folder__without_train(report):
    (report.folder / "transforms_train.json").rename(report.folder / "transforms_all.json")
    near(report.errors(), WHOLE)


def case_images_downscaled(report):
    says(report.info(".", "--photographs", "images_2"), "convert INPUT --fix image-scale=0.5", "fix:")
    report.glint("convert", ".", "--photographs", "images_2", "--fix", "image-scale=0.5", "-o", "half.json")
    scene = json.loads((report.folder / "half.json").read_text())
    camera = scene.get("camera") or scene["frames"][0]["camera"]
    # 320 x 240, f = 400 px, and the middle of the image is the principal point.
    assert (camera["width"], camera["height"]) == (160, 120), camera
    for key, value in {"fx": 200, "fy": 200, "cx": 79.5, "cy": 59.5}.items():
        assert abs(camera[key] - value) < 1e-9, camera
    errors = report.errors("half.json")
    assert errors["limit-angle"] < 2 and errors["canonical"] < 4, errors


def case_images_downscaled__alone(report):
    """Nothing but the smaller copies, named or not: found, and the same correction; also by nerfstudio's and the other readers."""
    assert not (report.folder / "images").exists()
    says(report.info(), "the photographs are those of the folder images_2", "convert INPUT --fix image-scale=0.5")
    report.glint("convert", ".", "--fix", "image-scale=0.5", "-o", "half.json")
    errors = report.errors("half.json")
    assert errors["limit-angle"] < 2 and errors["canonical"] < 4, errors
    (report.folder / "half.json").unlink()
    (report.folder / "images").mkdir()
    (report.folder / "images_2").rename(report.folder / "images_8")
    says(report.info(), "the photographs are those of the folder images_8", "convert INPUT --fix image-scale=0.5")


def case_path_case__smaller_copies_alone(report):
    captures = other_captures(report)
    half_size(report)
    for kind, fix in {"nerfstudio": "image-scale=0.5", "nvm": "focal-length=0.5", "bundler": "focal-length=0.5"}.items():
        files, options = captures.get(kind, ({}, []))
        write_capture(report, kind, files)
        if not files:
            shutil.copy(report.folder / "transforms.json", report.folder / kind)
        (report.folder / kind / "images").rename(report.folder / kind / "images_2")
        says(report.info(kind, *options), "the photographs are those of the folder images_2", f"--fix {fix}")
        report.glint("convert", kind, *options, "--fix", fix, "-o", f"{kind}/fixed.json")
        errors = report.errors(f"{kind}/fixed.json")
        assert errors["limit-angle"] < 2 and errors["canonical"] < 4, (kind, errors)


def case_images_downscaled__other_shape(report):
    """A crop is no resized photograph."""
    report.glint("convert", ".", "--photographs", "images_2", "-o", "scene.json")
    text = (report.folder / "scene.json").read_text()
    (report.folder / "scene.json").write_text(re.sub(r'("height": *)240', r"\g<1>260", text))
    lacks(report.info("scene.json"), "image-scale")


def case_nerfcapture(report):
    near(report.errors(), WHOLE)
    says(report.info(), "frames[0].", "more: differs from the value at the top of the file; the frame's own one counts")


def case_nerfcapture__depth_of_lower_resolution(report):
    """As the depth sensors of telephones write it: a plane 1 m away, 160 x 120 of 320 x 240."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    width, height = 160, 120
    rows = (b"\0" + struct.pack(">H", 1000) * width) * height
    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    (report.folder / "depth.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    edit_transforms(report, lambda f: f.update(depth_file_path="depth.png"))
    text = report.info(".", "--surface", "depth")
    lacks(text, "cannot be used")


def case_bundler_without_list(report):
    done = report.glint("info", ".", exit_code=2)
    says(done.stderr, "bundle.out: needs the list of its images")
    lacks(done.stderr, "nothing in this folder is recognised")


def case_bundler_without_list__named_after_it(report):
    names = sorted(p.name for p in (report.folder / "images").iterdir())
    (report.folder / "bundle.out").rename(report.folder / "model.out")
    (report.folder / "model.out.list.txt").write_text("".join(f"images/{n}\n" for n in names))
    near(report.errors(), WHOLE)


def case_bop_no_models(report):
    done = report.glint("evaluate", "test/000001", "--models", "limit-angle", "--train", "spread:5", exit_code=2)
    says(done.stderr, "--surface FILE", "--surface-units")
    lacks(done.stderr, "--surface points")


def case_bop_no_models__several_instances(report):
    """Another one of the object stands in front of the first in each image."""
    scene = report.folder / "test/000001/scene_gt.json"
    poses = json.loads(scene.read_text())
    for objects in poses.values():
        other = dict(objects[0], cam_t_m2c=[objects[0]["cam_t_m2c"][0] + 500, *objects[0]["cam_t_m2c"][1:]])
        objects.append(other)
    scene.write_text(json.dumps(poses))
    number = objects[0]["obj_id"]
    done = report.glint("info", "test/000001", exit_code=2)
    says(done.stderr, f"shows object {number} 2 times; choose one by --object {number}:N")
    cloud = ["--surface", str(report.folder / "mesh.ply")]
    (report.folder / "mesh.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    shifts = []
    for n in (0, 1):
        report.glint("convert", "test/000001", "--object", f"{number}:{n}", *cloud, "-o", f"{n}.json", "--allow-outside")
        shifts.append(json.loads((report.folder / f"{n}.json").read_text())["frames"][0]["camera_from_world"][0][3])
    assert abs(shifts[1] - shifts[0] - 0.5) < 1e-9, shifts  # mm against m
    says(report.glint("info", "test/000001", "--object", f"{number}:2", *cloud, exit_code=2).stderr, "no image shows the object more than 2 times")


def world_to_camera(report):
    """Names, rotations and translations of the capture, with our axes."""
    report.glint("convert", ".", "-o", "whole.json")
    frames = json.loads((report.folder / "whole.json").read_text())["frames"]
    (report.folder / "whole.json").unlink()
    return [(f["id"], [row[:3] for row in f["camera_from_world"][:3]], [row[3] for row in f["camera_from_world"][:3]]) for f in frames]


def quaternion(r):
    """w, x, y, z of a rotation, by its largest component."""
    squares = [1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2], 1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]]
    k = squares.index(max(squares))
    d = 2 * squares[k] ** 0.5
    x, y, z = r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]
    sums = {(1, 2): r[0][1] + r[1][0], (1, 3): r[0][2] + r[2][0], (2, 3): r[1][2] + r[2][1]}
    of = lambda i, j: {1: x, 2: y, 3: z}[max(i, j)] if 0 in (i, j) else sums[min(i, j), max(i, j)]  # noqa: E731
    return [squares[k] / d if i == k else of(i, k) / d for i in range(4)]


def centre(r, t):
    return [-sum(r[i][j] * t[i] for i in range(3)) for j in range(3)]


def other_captures(report):
    """The capture as other programs write it: name -> files and options of the command line."""
    frames = world_to_camera(report)
    words = lambda v: " ".join(map(repr, v))  # noqa: E731
    file = "images/{}.PNG".format
    nvm = ["NVM_V3", "", str(len(frames))] + [f"{file(n)} 400 {words(quaternion(r))} {words(centre(r, t))} 0 0" for n, r, t in frames] + ["", "0", "", "0"]
    bundle = ["# Bundle file v0.3", f"{len(frames)} 0"]
    for _, r, t in frames:  # y up, looking along -z
        bundle += ["400 0 0", words(r[0]), words([-v for v in r[1]]), words([-v for v in r[2]]), words([t[0], -t[1], -t[2]])]
    images = [f"{i + 1} {words(quaternion(r))} {words(t)} 1 {n}.PNG\n" for i, (n, r, t) in enumerate(frames)]
    poses = []
    for i, (_, r, t) in enumerate(frames):
        w, x, y, z = quaternion(r)
        poses.append(f"{10 + i / 10:.6f} {words(centre(r, t))} {words([-x, -y, -z, w])}")
    return {"nvm": ({"model.nvm": nvm}, []), "bundler": ({"bundle.out": bundle, "list.txt": [file(n) for n, *_ in frames]}, []),
            "colmap": ({"cameras.txt": ["1 PINHOLE 320 240 400 400 160 120"], "images.txt": images, "points3D.txt": ["# none"]}, []),
            "tum": ({"rgb.txt": [f"{10 + i / 10:.6f} {file(n)}" for i, (n, *_) in enumerate(frames)], "groundtruth.txt": poses}, ["--camera", "400,400,159.5,119.5"])}


def write_capture(report, kind, files, line_end="\n", mark=""):
    folder = report.folder / kind
    folder.mkdir()
    shutil.copytree(report.folder / "images", folder / "images")
    shutil.copy(report.folder / "mesh.ply", folder)
    for name, lines in files.items():
        (folder / name).write_bytes((mark + line_end.join("\n".join(lines).split("\n")) + line_end).encode())


def case_path_case__text_of_windows(report):
    """The mark of UTF-8 and line ends of Windows in the texts of all captures."""
    for kind, (files, options) in other_captures(report).items():
        write_capture(report, kind, files, "\r\n", "\ufeff")
        near(report.errors(kind, *options), WHOLE)


def case_path_case__camera_twice(report):
    files, _ = other_captures(report)["colmap"]
    write_capture(report, "colmap", files | {"cameras.txt": files["cameras.txt"] * 2})
    near(report.errors("colmap"), WHOLE)
    files["cameras.txt"].append("1 PINHOLE 320 240 500 400 160 120")
    write_capture(report, "other", files)
    says(report.glint("info", "other", exit_code=2).stderr, "two cameras have the number 1")


def half_size(report):
    """Photographs of half the size in place of the whole ones, each pixel the mean of four."""
    from images_cases import pixels_of, png_of
    for image in (report.folder / "images").iterdir():
        rows = pixels_of(image.read_bytes())
        pairs = [[[b"".join(bytes([(a + b + 1) // 2]) for a, b in zip(p, q)) for p, q in zip(row[::2], row[1::2])] for row in (up, down)] for up, down in zip(rows[::2], rows[1::2])]
        image.write_bytes(png_of([[bytes((a + b) // 2 for a, b in zip(p, q)) for p, q in zip(*pair)] for pair in pairs], 1))


def case_path_case__resized(report):
    """Captures whose files do not say the size of their images: the highlights, or the principal point, tell."""
    captures = other_captures(report)
    half_size(report)
    for kind, fix in {"nvm": "focal-length=0.5", "bundler": "focal-length=0.5", "tum": "camera-scale=0.5"}.items():
        files, options = captures[kind]
        write_capture(report, kind, files)
        says(report.info(kind, *options), f"--fix {fix}")
        report.glint("convert", kind, *options, "--fix", fix, "-o", f"{kind}/fixed.json")
        errors = report.errors(f"{kind}/fixed.json")
        assert errors["limit-angle"] < 2 and errors["canonical"] < 4, (kind, errors)


def depth_png(rotation, shift, step, unit):
    """16-bit PNG of the depths of the ellipsoid that the capture shows, in units of `unit` metres, of pixels that are `step` of the photograph's wide."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    eye, axes, rows = centre(rotation, shift), (0.6, 0.35, 0.25), bytearray()
    width, height = 320 // step, 240 // step
    for y in range(height):
        rows.append(0)
        for x in range(width):
            ray = [(step * (x + 0.5) - 0.5 - 159.5) / 400, (step * (y + 0.5) - 0.5 - 119.5) / 400, 1]
            way = [sum(rotation[i][j] * ray[i] for i in range(3)) / axes[j] for j in range(3)]
            from_ = [e / a for e, a in zip(eye, axes)]
            a, b, c = (sum(p * q for p, q in zip(*pair)) for pair in ((way, way), (way, from_), (from_, from_)))
            root = b * b - a * (c - 1)
            rows += struct.pack(">H", round((-b - root**0.5) / a / unit) if root > 0 else 0)  # along z, since the ray has z = 1
    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows))) + chunk(b"IEND", b"")


def case_path_case__depth_of_lower_resolution(report):
    """Depth of half the photographs' size, by each reader that has depth: the surface is that of the whole size, whose errors are 0.24 to 0.32 %."""
    frames = world_to_camera(report)
    tum, options = other_captures(report)["tum"]
    bop, nerf = report.folder / "bop" / "test" / "000001", report.folder / "nerf"
    write_capture(report, "tum", {**tum, "depth.txt": [f"{10 + i / 10:.6f} depth/{i}.png" for i in range(len(frames))]})
    for folder in (bop / "depth", bop / "rgb", nerf / "depth", report.folder / "tum" / "depth"):
        folder.mkdir(parents=True)
    for i, (name, r, t) in enumerate(frames):
        depth = depth_png(r, t, 2, 1 / 5000)
        for file in (report.folder / "tum" / "depth" / f"{i}.png", bop / "depth" / f"{i:06d}.png", nerf / "depth" / f"{name}.png"):
            file.write_bytes(depth)
        shutil.copy(report.folder / "images" / f"{name}.PNG", bop / "rgb" / f"{i:06d}.png")
    (bop / "scene_camera.json").write_text(json.dumps({i: {"cam_K": [400, 0, 159.5, 0, 400, 119.5, 0, 0, 1], "depth_scale": 0.2} for i in range(len(frames))}))
    (bop / "scene_gt.json").write_text(json.dumps({i: [{"obj_id": 1, "cam_R_m2c": sum(r, []), "cam_t_m2c": [1000 * v for v in t]}] for i, (_, r, t) in enumerate(frames)}))
    shutil.copytree(report.folder / "images", nerf / "images")
    capture = json.loads((report.folder / "transforms.json").read_text())
    capture["depth_unit_scale_factor"] = 1 / 5000
    for (name, *_), frame in zip(frames, capture["frames"]):
        frame["depth_file_path"] = f"depth/{name}.png"
    (nerf / "transforms.json").write_text(json.dumps(capture))
    for kind, words in {"nerf": [], "tum": options, "bop/test/000001": []}.items():
        errors = report.errors(kind, *words, "--surface", "depth", models="limit-angle")
        assert errors["limit-angle"] < 0.6, (kind, errors)
