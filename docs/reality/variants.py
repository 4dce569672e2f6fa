# SPDX-License-Identifier: BSD-3-Clause
"""Scenes with one flaw, computed from clean ones: other curves, exposure, JPEG, vignetting, clipping, crops, meshes and poses.

Each variant is written as a folder with scene.json, frames and truth. The scene does not state the flaw.
"""
import copy
import json
import os
import pathlib
import shutil

import numpy as np

from audit.auto import icosphere
from reality import contours, pictures

PEAK = 0.9  # of white: where the brightest pixel of a scene lies, unless a variant clips
JPEG = {"jpeg60": 60, "tone-jpeg-exposure": 85}


# Light to codes.
def s_curve(codes, strength=0.5):
    return codes - strength * np.sin(2 * np.pi * codes) / (2 * np.pi)


def filmic(light):
    """A shoulder to white at twice the light that a straight curve shows, then contrast: as phones develop."""
    return s_curve(pictures.srgb_codes(1.6 * light * (1 + light / 4) / (1 + 1.6 * light)), 0.3)


CURVES = {"gamma18": lambda light: light ** (1 / 1.8), "gamma22": lambda light: light ** (1 / 2.2), "linear": lambda light: light,
          "s-curve": lambda light: s_curve(pictures.srgb_codes(light)), "tone-jpeg-exposure": filmic}


def exposure(kind, frame):
    """Factor of a frame's light: only one variant changes it, by half a stop up and down."""
    return 2 ** (0.5 * np.sin(2.4 * frame) - 0.5) if kind == "tone-jpeg-exposure" else 3 / PEAK if kind == "clipped3" else 1.0


def vignetting(shape, loss=0.4):
    """Light that is left; `loss` at the corners, with the square of the distance from the middle."""
    y, x = np.mgrid[:shape[0], :shape[1]].astype(float)
    r2 = (x - (shape[1] - 1) / 2) ** 2 + (y - (shape[0] - 1) / 2) ** 2
    return 1 - loss * r2 / r2.max()


def developed(kind, light, frame):
    """Codes of a frame whose light has its scene's peak at PEAK."""
    if kind == "vignetting":
        fall = vignetting(light.shape)
        light = light * (fall[..., None] if light.ndim == 3 else fall)
    light = np.clip(light * exposure(kind, frame), 0, 1)
    return CURVES.get(kind, pictures.srgb_codes)(light)


# Meshes.
def read_ply(path):
    """Vertices and triangles of a binary PLY whose faces are triangles."""
    raw = pathlib.Path(path).read_bytes()
    head, body = raw.split(b"end_header\n", 1)
    counts, columns = {}, []
    for line in head.decode().splitlines():
        word = line.split()
        if word[0] == "element":
            counts[word[1]] = int(word[2])
        elif word[0] == "property" and "face" not in counts:
            columns.append((word[2], {"float": "<f4", "double": "<f8"}[word[1]]))
    vertices = np.frombuffer(body, columns, counts["vertex"])
    faces = np.frombuffer(body, [("n", "u1"), ("v", "<i4", 3)], counts["face"], vertices.nbytes)
    return np.stack([vertices[c].astype(float) for c in "xyz"], 1), faces["v"].copy()


def write_ply(path, vertices, faces, normals=None):
    """With vertex normals: those that are given, or means of the triangles around weighted by area."""
    if normals is None:
        cross = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
        normals = np.zeros_like(vertices)
        for corner in range(3):
            np.add.at(normals, faces[:, corner], cross)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)  # an unused vertex has no normal
    columns = "".join(f"property double {c}\n" for c in ("x", "y", "z", "nx", "ny", "nz"))
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{columns}"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    corners = np.zeros(len(faces), [("n", "u1"), ("v", "<i4", 3)])
    corners["n"], corners["v"] = 3, faces
    pathlib.Path(path).write_bytes(head.encode() + np.hstack([vertices, normals]).astype("<f8").tobytes() + corners.tobytes())


def ellipsoid_mesh(semi_axes, times=5):
    vertices, faces = icosphere(times)
    return np.array(vertices) * np.array(semi_axes), np.array(faces)


def bumpy(vertices, height=0.001, seed=5):
    """Moved along the direction from the middle by waves of 40 to 80 mm whose sum is at most about `height`."""
    rng = np.random.default_rng(seed)
    bumps = np.zeros(len(vertices))
    for _ in range(12):
        direction = rng.normal(size=3)
        waves = 2 * np.pi / rng.uniform(0.04, 0.08) * direction / np.linalg.norm(direction)
        bumps += np.sin(vertices @ waves + rng.uniform(0, 2 * np.pi))
    away = vertices - vertices.mean(0)
    return vertices + height * (bumps / np.abs(bumps).max())[:, None] * away / np.linalg.norm(away, axis=1, keepdims=True)


# Poses and crops.
def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def shaken(poses, middle, seed=7, turn_deg=0.05, shift=0.0002):
    """Poses as bundle adjustment leaves them: each turned about the object's middle, which the points pin, and shifted by a
    share of its distance."""
    rng = np.random.default_rng(seed)
    out = []
    for pose in poses:
        pose = np.array(pose, float)
        seen = pose[:3, :3] @ middle + pose[:3, 3]
        turn = rotation(np.radians(turn_deg) * rng.normal(size=3))
        pose[:3, :3] = turn @ pose[:3, :3]
        pose[:3, 3] = seen - pose[:3, :3] @ middle + shift * np.linalg.norm(seen) * rng.normal(size=3)
        out.append(pose.tolist())
    return out


def cut(contour, bottom):
    """Visible parts of a closed contour above the row `bottom`, as open lines."""
    points = contour["points"]
    inside = [p[1] <= bottom for p in points]
    if all(inside):
        return [contour]
    parts, start = [], inside.index(False)
    for k in range(start, start + len(points)):
        here, after = points[k % len(points)], points[(k + 1) % len(points)]
        if (here[1] <= bottom) != (after[1] <= bottom):
            t = (bottom - here[1]) / (after[1] - here[1])
            border = [here[0] + t * (after[0] - here[0]), bottom]
            if after[1] <= bottom:
                parts.append([border, after])
            else:
                parts[-1].append(border)
        elif after[1] <= bottom:
            parts[-1].append(after)
    return [{"closed": False, "points": p} for p in parts if len(p) > 3 and abs(contours.area(p)) >= 6]


def crop_rows(truths, height):
    """First row and end of each frame's window, so that its lower border cuts the highlight; windows are equally high."""
    ends = []
    for k, truth in enumerate(truths):
        rows = [p[1] for c in truth["levels"]["0.50"] for p in c["points"]]
        low, high = min(rows), max(rows)
        ends.append(int(round(low + (0.35 + 0.3 * (0.5 + 0.5 * np.sin(2.4 * k))) * (high - low))))
    rows = min(min(ends) + 1, height)
    return [(end - rows + 1, end + 1) for end in ends]


class Base:
    """A clean scene: its file, its truth folder, and how its codes become light."""

    def __init__(self, file, truth, light=pictures.srgb_light):
        self.file, self.truth_folder, self.light = pathlib.Path(file), pathlib.Path(truth), light
        self.scene = json.loads(self.file.read_text())

    def truth(self, frame):
        found = json.loads((self.truth_folder / f"{frame['id']}.json").read_text())
        return {"peak_subpixel": found["peak_subpixel"], "levels": {"0.50": found["levels"]["0.50"]}}

    def lights(self):
        """Light of every frame, with the brightest pixel at PEAK."""
        files = [self.file.parent / f["image"] for f in self.scene["frames"]]
        read = [self.light(pictures.dithered(pictures.read(file), k)) for k, file in enumerate(files)]
        top = max(light.max() for light in read)
        return [PEAK / top * light for light in read]

    def mesh(self):
        (surface,) = self.scene["surfaces"].values()
        if "mesh" in surface:
            return read_ply(self.file.parent / surface["mesh"])
        return ellipsoid_mesh(surface["analytic"]["semi_axes"])


def without_maps(base):
    """The scene without radiance, depth and masks: a photographer has none."""
    scene = copy.deepcopy(base.scene)
    scene.pop("lights", None)
    for frame in scene["frames"]:
        for key in ("radiance", "depth", "depth_scale", "mask", "highlights"):
            frame.pop(key, None)
    return scene


def crop(scene, truths, lights):
    windows = crop_rows(truths, scene["camera"]["height"])
    for k, (frame, (top, end)) in enumerate(zip(scene["frames"], windows)):
        frame["camera"] = dict(scene["camera"], cy=scene["camera"]["cy"] - top, height=end - top)
        lights[k] = lights[k][top:end]
        moved = [{"closed": True, "points": [[x, y - top] for x, y in c["points"]]} for c in truths[k]["levels"]["0.50"]]
        truths[k] = {"peak_subpixel": None, "levels": {"0.50": [part for c in moved for part in cut(c, end - top - 0.5)]}}


def make(kind, base, folder):
    """Writes the variant of this kind; a folder appears complete or not at all."""
    folder = pathlib.Path(folder)
    if (folder / "scene.json").exists():
        return
    scene, lights, truths = without_maps(base), base.lights(), [base.truth(f) for f in base.scene["frames"]]
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    scene["name"] = kind
    if kind == "cropped":
        crop(scene, truths, lights)
    if kind == "stated":
        scene["camera"]["response"] = "gamma:1.8"
    if kind in ("bumps", "large"):
        vertices, faces = base.mesh()
        middle = vertices.mean(0)
        write_ply(folder / "surface.ply", bumpy(vertices) if kind == "bumps" else middle + 1.03 * (vertices - middle), faces)
        scene["surfaces"] = {name: {"mesh": "surface.ply"} for name in scene["surfaces"]}
    elif "mesh" in next(iter(scene["surfaces"].values())):
        for surface in scene["surfaces"].values():
            shutil.copy(base.file.parent / surface["mesh"], folder / "surface.ply")  # a scene may not name files outside
            surface["mesh"] = "surface.ply"
    if kind == "poses":
        poses = shaken([f["camera_from_world"] for f in scene["frames"]], base.mesh()[0].mean(0))
        for frame, pose in zip(scene["frames"], poses):
            frame["camera_from_world"] = pose
    quality = JPEG.get(kind)
    for k, frame in enumerate(scene["frames"]):
        frame["image"] = f"frames/{frame['id']}.{'jpg' if quality else 'png'}"
        pictures.write(folder / frame["image"], developed("gamma18" if kind == "stated" else kind, lights[k], k), quality)
        contours.write_truth(folder / "truth", frame["id"], truths[k])
    (folder / "scene.json.new").write_text(json.dumps(scene))
    os.replace(folder / "scene.json.new", folder / "scene.json")
