# SPDX-License-Identifier: BSD-3-Clause
"""1.6: coordinates keep their digits from the file to the contour, and `info` notices what is wrong with images and cameras.

The meshes are written here, in the formats that the line names; nothing of the program under test makes them.
"""
import json
import math
import shutil
import struct

from .harness import Result, line, mean_error, percent

MODELS = ("limit-angle", "reflectance")
FAR = 1e6


def icosphere(levels):
    """Vertices and triangles of an icosahedron divided `levels` times, on the unit sphere."""
    t = (1 + math.sqrt(5)) / 2

    def unit(v):
        n = math.sqrt(sum(c * c for c in v))
        return tuple(c / n for c in v)

    points = [unit(p) for p in ((-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t),
                                (0, -1, -t), (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1))]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit(tuple(points[a][k] + points[b][k] for k in range(3))))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return points, faces


def write_ply(path, vertices, normals, faces, kind):
    """kind: "double" and "float" are binary, "text" is ascii."""
    ascii_text, scalar = kind == "text", "float" if kind == "float" else "double"
    head = ["ply", "format " + ("ascii" if ascii_text else "binary_little_endian") + " 1.0", f"element vertex {len(vertices)}"]
    head += [f"property {scalar} {n}" for n in "xyz"] + ([f"property {scalar} n{n}" for n in "xyz"] if normals else [])
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    rows = [v + n for v, n in zip(vertices, normals)] if normals else vertices
    with open(path, "wb") as f:
        f.write("\n".join(head).encode())
        if ascii_text:
            f.write("".join(" ".join(map(repr, r)) + "\n" for r in rows).encode())
            f.write("".join("3 %d %d %d\n" % t for t in faces).encode())
            return
        code = struct.Struct("<%d%s" % (len(rows[0]), scalar[0]))
        f.write(b"".join(code.pack(*r) for r in rows))
        f.write(b"".join(struct.pack("<B3i", 3, *t) for t in faces))


def write_obj(path, vertices, normals, faces):
    with open(path, "w") as f:
        f.writelines("v %r %r %r\n" % v for v in vertices)
        f.writelines("vn %r %r %r\n" % n for n in normals)
        f.writelines("f " + " ".join(f"{i + 1}//{i + 1}" for i in t) + "\n" for t in faces)


def moved(pose, by):
    """The pose of the same camera in a world shifted by `by`: t - R by."""
    return [row[:3] + [row[3] - sum(row[k] * by[k] for k in range(3))] for row in pose[:3]] + [pose[3]]


def images_of(source, scene, folder):
    """The scene's images beside its changed copy; paths stay. What is left out (depth, normals) belongs to the unchanged world."""
    for frame in scene["frames"]:
        frame.pop("depth", None)
        frame.pop("normals", None)
        for key in ("radiance", "image", "mask"):
            if key in frame:
                (folder / frame[key]).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source / frame[key], folder / frame[key])


def with_mesh(run, kind, far, normals=True, levels=5):
    """The synthetic sphere with a mesh for its surface and everything shifted by `far` metres; the images stay, as they must."""
    source = run.synth(run.spec("far_sphere"))
    folder = run.scratch / f"far_{kind}_{far:g}_{normals}_{levels}"
    if not (folder / "scene.json").exists():
        folder.mkdir(exist_ok=True)
        scene = json.loads((source / "scene.json").read_text())
        by = (far, -0.6 * far, 0.3 * far)
        images_of(source, scene, folder)
        for frame in scene["frames"]:
            frame["camera_from_world"] = moved(frame["camera_from_world"], by)
        for lamp in scene["lights"]:
            lamp["position"] = [p + b for p, b in zip(lamp["position"], by)]
        points, faces = icosphere(levels)
        vertices = [tuple(0.5 * c + b for c, b in zip(p, by)) for p in points]
        name = "ball." + ("obj" if kind == "obj" else "ply")
        if kind == "obj":
            write_obj(folder / name, vertices, points, faces)
        else:
            write_ply(folder / name, vertices, points if normals else [], faces, kind)
        scene["surfaces"] = {"ball": {"mesh": name}}
        (folder / "scene.json").write_text(json.dumps(scene))
        truth = folder / "truth"
        if not truth.exists():
            truth.symlink_to((source / "truth").resolve())
    return folder


def errors(run, folder):
    report = run.evaluate(folder, "--models", ",".join(MODELS), "--train", "spread:6")
    return {m: mean_error(report, m) for m in MODELS}


def offset(kind, title):
    @line("1.6", f"{title}, {FAR:g} m from the origin", "error at most 1.1 times that at the origin")
    def check(run):
        near, far = errors(run, with_mesh(run, kind, 0)), errors(run, with_mesh(run, kind, FAR))
        text = "; ".join(f"{m} {percent(near[m])} -> {percent(far[m])}" for m in MODELS)
        return Result(text, all(far[m] <= 1.1 * near[m] for m in MODELS))  # nan holds nothing


offset("double", "PLY of doubles")
offset("text", "PLY as text")
offset("obj", "OBJ")


def findings(run, folder):
    done = run.glint("info", folder / "scene.json", "--json", "-")
    if not done.stdout.strip():
        raise RuntimeError((done.stderr.strip().splitlines() or ["exit code %d" % done.returncode])[-1])
    return json.loads(done.stdout)["findings"]


def noticed(run, folder, *words):
    found = findings(run, folder)
    hits = [f for f in found if any(w in f for w in words)]
    others = [f for f in found if f not in hits]
    return Result((hits or others or ["nothing found"])[0], bool(hits) and not others)


@line("1.6", "info: floats that are too coarse (PLY of floats, 1 km from the origin)", "noticed")
def coarse(run):
    return noticed(run, with_mesh(run, "float", 1000, normals=False), "coarse")


def changed(run, name, change):
    """A scene whose files say something else than what was rendered."""
    source = run.synth(run.spec("cameras_ellipsoid"))
    folder = run.scratch / ("changed_" + name)
    folder.mkdir(exist_ok=True)
    scene = json.loads((source / "scene.json").read_text())
    images_of(source, scene, folder)
    change(scene)
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder


def mirrored_spec(run):
    """What a camera sees in a mirrored world is the mirrored image: F (R X + t) = (F R S) (S X) + F t with F = S = diag(-1, 1, 1)."""
    spec = run.spec("cameras_ellipsoid")
    plain = run.synth(spec)
    scene = json.loads((plain / "scene.json").read_text())
    poses = [f["camera_from_world"] for f in scene["frames"]]
    signs = (-1, 1, 1)
    spec["path"] = {"cameras": [[[signs[i] * p[i][k] * signs[k] for k in range(3)] + [signs[i] * p[i][3]] for i in range(3)]
                                + [p[3]] for p in poses]}
    spec["lights"][0]["position"][0] *= -1
    return run.synth(spec), poses


@line("1.6", "info: images mirrored left-right", "noticed")
def flipped(run):
    source, poses = mirrored_spec(run)
    folder = run.scratch / "mirrored"
    folder.mkdir(exist_ok=True)
    scene = json.loads((source / "scene.json").read_text())
    images_of(source, scene, folder)
    for frame, pose in zip(scene["frames"], poses):
        frame["camera_from_world"] = pose
    (folder / "scene.json").write_text(json.dumps(scene))
    return noticed(run, folder, "mirrored")


@line("1.6", "info: principal point half a pixel off", "noticed")
def half_pixel(run):
    def change(scene):
        for c in [scene["camera"]] if "camera" in scene else [f["camera"] for f in scene["frames"]]:
            c["cx"] += 0.5
            c["cy"] += 0.5
    return noticed(run, changed(run, "half", change), "half a pixel")


@line("1.6", "info: focal length 1 % too long", "noticed")
def focal(run):
    def change(scene):
        for c in [scene["camera"]] if "camera" in scene else [f["camera"] for f in scene["frames"]]:
            c["fx"] *= 1.01
            c["fy"] *= 1.01
    return noticed(run, changed(run, "focal", change), "focal length")


@line("1.6", "info: the same scene as it was rendered, and the path-traced sequences", "nothing found")
def no_false_alarm(run):
    folders = [changed(run, "not", lambda scene: None), run.shared / "data/cycles/sphere",
               run.shared / "data/cycles/plane_to_cylinder"]
    found = [f for folder in folders if (folder / "scene.json").exists() for f in findings(run, folder)]
    return Result(found[0] if found else "nothing found", not found)
