# SPDX-License-Identifier: BSD-3-Clause
"""A capture (photographs, cameras, mesh) as numbers, and its writers: scene file, COLMAP text model, nerfstudio. Nothing here is Glint's own code."""
import copy
import json
import pathlib
import struct
import zlib

import numpy as np


class Frame:
    def __init__(self, name, image, pose):
        self.name, self.image, self.pose = name, image, pose  # image: a file, or pixels (h, w, channels); pose: camera from world, 4 x 4, y down


class Capture:
    def __init__(self, size, intrinsics, frames, vertices, normals, triangles):
        self.size, self.intrinsics, self.frames = size, list(intrinsics), frames  # (w, h); fx, fy, cx, cy with (0, 0) at the centre of a pixel
        self.vertices, self.normals, self.triangles = vertices, normals, triangles
        self.points = None  # sparse points of COLMAP, where they are not those of the mesh (`measured`)

    def copy(self):
        return copy.deepcopy(self)

    def measured(self):
        """The capture, which keeps the sparse points that the right mesh has: structure from motion does not know the mesh."""
        other = self.copy()
        if other.points is None:
            chosen = np.random.default_rng(3).choice(len(self.vertices), min(400, len(self.vertices)), replace=False)
            other.points = (self.vertices[chosen], self.normals[chosen])
        return other


def read_ply(path):
    """A PLY of triangles, floats and vertex normals, binary little-endian or ASCII."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header") + len(b"end_header\n")
    header, body = data[:end].decode().split("\n"), data[end:]
    count = {words[1]: int(words[2]) for words in (line.split() for line in header) if words[:1] == ["element"]}
    columns = sum(line.startswith("property") and "list" not in line for line in header)
    n, m = count["vertex"], count["face"]
    if "format ascii" in header[1]:
        rows = body.decode().split("\n")
        table = np.array([[float(x) for x in row.split()] for row in rows[:n]])
        faces = np.array([[int(x) for x in row.split()[1:4]] for row in rows[n : n + m]])
    else:
        table = np.frombuffer(body, "<f4", n * columns).reshape(n, columns).astype(float)
        kind = np.dtype([("n", "u1"), ("v", "<i4", 3)])
        faces = np.frombuffer(body, kind, m, n * columns * 4)["v"].astype(int)
    return table[:, :3], table[:, 3:6], faces


def write_ply(path, vertices, normals, triangles):
    header = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(vertices)}\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    faces = np.zeros(len(triangles), np.dtype([("n", "u1"), ("v", "<i4", 3)]))
    faces["n"], faces["v"] = 3, triangles
    pathlib.Path(path).write_bytes(header.encode() + np.hstack([vertices, normals]).astype("<f4").tobytes() + faces.tobytes())


def read_png(path):
    """Codes of a PNG that is not interlaced: (h, w, channels)."""
    data = pathlib.Path(path).read_bytes()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        chunk = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colours = struct.unpack(">IIBB", chunk[:10])
        if kind == b"IDAT":
            packed += chunk
        at += length + 12
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[colours]
    step, stride = channels * bits // 8, width * channels * bits // 8
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, stride + 1)
    out = np.zeros((height + 1, stride), np.uint8)
    for y in range(height):
        kind, line, above = raw[y, 0], raw[y, 1:], out[y]
        if kind == 0:
            out[y + 1] = line
        elif kind == 1:
            out[y + 1] = np.cumsum(line.reshape(-1, step), axis=0, dtype=np.uint8).reshape(-1)
        elif kind == 2:
            out[y + 1] = line + above
        else:
            out[y + 1] = list(unfiltered(kind, line.tolist(), above.tolist(), step))
    dtype = np.uint8 if bits == 8 else ">u2"
    return out[1:].copy().view(dtype).reshape(height, width, channels).astype(np.uint16 if bits == 16 else np.uint8)


def unfiltered(kind, line, above, step):
    """A line of PNG's filters 3 (mean) and 4 (Paeth)."""
    done = []
    for i, value in enumerate(line):
        a, b, c = (done[i - step], above[i], above[i - step]) if i >= step else (0, above[i], 0)
        if kind == 3:
            guess = (a + b) // 2
        else:
            pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            guess = a if pa <= pb and pa <= pc else b if pb <= pc else c
        done.append((value + guess) & 255)
    return done


def write_png(path, codes):
    height, width, channels = codes.shape
    bits = 16 if codes.dtype == np.uint16 else 8
    rows = codes.astype(">u2" if bits == 16 else np.uint8).tobytes()
    stride = width * channels * bits // 8
    raw = b"".join(b"\0" + rows[y * stride : (y + 1) * stride] for y in range(height))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, bits, {1: 0, 3: 2}[channels], 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))


def ellipsoid_mesh(axes, steps=96):
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * steps + 1), np.linspace(0, np.pi, steps + 1), indexing="ij")
    ball = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], -1).reshape(-1, 3)
    normals = ball / np.array(axes)
    i, k = (x.reshape(-1) for x in np.meshgrid(np.arange(2 * steps), np.arange(steps), indexing="ij"))
    a = i * (steps + 1) + k
    b = a + steps + 1
    faces = np.concatenate([np.stack([a, a + 1, b], -1), np.stack([a + 1, b + 1, b], -1)])
    return ball * axes, normals / np.linalg.norm(normals, axis=1, keepdims=True), faces


def read_scene(folder, most=10):
    """A scene file with one mesh or ellipsoid, and at most `most` of its photographs, evenly spread."""
    folder = pathlib.Path(folder)
    scene = json.loads((folder / "scene.json").read_text())
    c = scene["camera"]
    chosen = [scene["frames"][i * len(scene["frames"]) // most] for i in range(most)] if len(scene["frames"]) > most else scene["frames"]
    (surface,) = scene["surfaces"].values()
    mesh = read_ply(folder / surface["mesh"]) if "mesh" in surface else ellipsoid_mesh(surface["analytic"]["semi_axes"])
    frames = [Frame(f["id"], folder / f["image"], np.array(f["camera_from_world"], float)) for f in chosen]
    return Capture((c["width"], c["height"]), (c["fx"], c["fy"], c["cx"], c["cy"]), frames, *mesh)


def read_transforms(folder):
    """A nerfstudio folder of one camera with mesh.ply."""
    folder = pathlib.Path(folder)
    t = json.loads((folder / "transforms.json").read_text())
    frames = []
    for f in t["frames"]:
        world = np.array(f["transform_matrix"], float) @ np.diag([1.0, -1, -1, 1])
        frames.append(Frame(pathlib.Path(f["file_path"]).stem, folder / f["file_path"], np.linalg.inv(world)))
    intrinsics = (t["fl_x"], t["fl_y"], t["cx"] - 0.5, t["cy"] - 0.5)
    return Capture((t["w"], t["h"]), intrinsics, frames, *read_ply(folder / "mesh.ply"))


def write_images(capture, folder):
    (folder / "images").mkdir(parents=True)
    for f in capture.frames:
        file = folder / "images" / (f.name + ".png")
        if isinstance(f.image, np.ndarray):
            write_png(file, f.image)
        else:
            file.write_bytes(pathlib.Path(f.image).read_bytes())


def write_scene(capture, folder):
    """Scene file; returns what `glint` takes as INPUT."""
    write_images(capture, folder)
    write_ply(folder / "mesh.ply", capture.vertices, capture.normals, capture.triangles)
    (w, h), (fx, fy, cx, cy) = capture.size, capture.intrinsics
    scene = {"glint_scene": 1, "camera": {"width": w, "height": h, "fx": fx, "fy": fy, "cx": cx, "cy": cy}, "surfaces": {"body": {"mesh": "mesh.ply"}}}
    scene["frames"] = [{"id": f.name, "image": f"images/{f.name}.png", "surface": "body", "camera_from_world": f.pose.tolist()} for f in capture.frames]
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


def write_nerfstudio(capture, folder):
    write_images(capture, folder)
    write_ply(folder / "mesh.ply", capture.vertices, capture.normals, capture.triangles)
    (w, h), (fx, fy, cx, cy) = capture.size, capture.intrinsics
    t = {"camera_model": "OPENCV", "w": w, "h": h, "fl_x": fx, "fl_y": fy, "cx": cx + 0.5, "cy": cy + 0.5, "k1": 0, "k2": 0, "p1": 0, "p2": 0}
    t["frames"] = []
    for f in capture.frames:
        world = np.linalg.inv(f.pose) @ np.diag([1.0, -1, -1, 1])
        t["frames"].append({"file_path": f"images/{f.name}.png", "transform_matrix": world.tolist()})
    (folder / "transforms.json").write_text(json.dumps(t))
    return folder


def quaternion(rotation):
    """w x y z."""
    k = np.array([[rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]]).ravel()
    m = np.zeros((4, 4))
    m[0, 0], m[0, 1:], m[1:, 0] = np.trace(rotation), k, k
    m[1:, 1:] = rotation + rotation.T - np.trace(rotation) * np.eye(3)
    values, vectors = np.linalg.eigh(m)
    q = vectors[:, np.argmax(values)]
    return q if q[0] >= 0 else -q


def write_colmap(capture, folder):
    """Text model with sparse points of the object and of a floor below it, each seen by the cameras that its normal faces."""
    write_images(capture, folder)
    write_ply(folder / "mesh.ply", capture.vertices, capture.normals, capture.triangles)
    model = folder / "sparse" / "0"
    model.mkdir(parents=True)
    (w, h), (fx, fy, cx, cy) = capture.size, capture.intrinsics
    (model / "cameras.txt").write_text(f"1 PINHOLE {w} {h} {fx} {fy} {cx + 0.5} {cy + 0.5}\n")
    random = np.random.default_rng(7)
    points, normals = capture.points if capture.points is not None else capture.measured().points
    low, high = points.min(0), points.max(0)
    floor = np.stack([*(random.uniform(low[i] - 0.4 * (high - low)[i], high[i] + 0.4 * (high - low)[i], 80) for i in (0, 1)), np.full(80, low[2])], -1)
    points = np.vstack([points, floor]) + random.normal(0, 3e-4 * np.linalg.norm(high - low), (len(points) + 80, 3))
    normals = np.vstack([normals, np.tile([0, 0, 1.0], (80, 1))])
    lines, tracks = [], [[] for _ in points]
    for number, f in enumerate(capture.frames, 1):
        rotation, shift = f.pose[:3, :3], f.pose[:3, 3]
        local = points @ rotation.T + shift
        facing = ((-rotation.T @ shift - points) * normals).sum(1) > 0.15 * np.linalg.norm(local, axis=1)
        x, y = fx * local[:, 0] / local[:, 2] + cx, fy * local[:, 1] / local[:, 2] + cy
        seen = np.flatnonzero(facing & (local[:, 2] > 0) & (x > 0) & (y > 0) & (x < w - 1) & (y < h - 1))
        noise = random.normal(0, 0.3, (len(seen), 2))
        words = []
        for k, i in enumerate(seen):
            tracks[i].append((number, k))
            words.append(f"{x[i] + 0.5 + noise[k, 0]:.3f} {y[i] + 0.5 + noise[k, 1]:.3f} {i + 1}")
        pose = " ".join(f"{v:.12g}" for v in [*quaternion(rotation), *shift])
        lines += [f"{number} {pose} 1 {f.name}.png", " ".join(words)]
    (model / "images.txt").write_text("\n".join(lines) + "\n")
    (model / "points3D.txt").write_text("".join(f"{i + 1} {p[0]:.9g} {p[1]:.9g} {p[2]:.9g} 128 128 128 0.3 " + " ".join(f"{a} {b}" for a, b in tracks[i]) + "\n"
                                               for i, p in enumerate(points) if len(tracks[i]) > 1))
    # An observation of a point that too few photographs show names none.
    kept = {i + 1 for i in range(len(points)) if len(tracks[i]) > 1}
    rows = (model / "images.txt").read_text().split("\n")
    for n in range(1, len(rows) - 1, 2):
        words = rows[n].split()
        rows[n] = " ".join(w if k % 3 != 2 or int(w) in kept else "-1" for k, w in enumerate(words))
    (model / "images.txt").write_text("\n".join(rows))
    return folder


WRITERS = {"mesh": write_scene, "colmap": write_colmap, "nerfstudio": write_nerfstudio}
