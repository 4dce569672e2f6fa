#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of textures in docs/retexture.md: `glint texture` against the paint of a scene that another renderer made.

Usage: docs/make_texture.py --glint build/release/bin/glint [--data ../shared/data] [-o docs/retexture.md]   (needs NumPy and Pillow)
The scene is data/exact/checker: cubes of 20 mm, dark and bright by turns, cut by an ellipsoid. Their two colours and the lamp's place come from the
photographs by robust least squares, without Glint; a matt surface under a lamp at l sends paint (N.L) / |l - P|^2.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs"))
from reality.pictures import srgb_codes, srgb_light  # noqa: E402

AXES, CUBE = np.array([0.15, 0.09, 0.07]), 0.02  # m
EDGE = 0.15  # of a cube: what lies nearer to a face mixes both colours
START, END = "<!-- texture: docs/make_texture.py -->\n", "<!-- end of texture -->\n"


def paint(points):
    return np.floor(points / CUBE).sum(-1) % 2


def from_faces(points):
    """Distance from the nearest face of a cube, in cubes."""
    return np.abs(points / CUBE - np.round(points / CUBE)).min(-1)


def normals(points):
    n = points / AXES**2
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def seen(folder, camera, frame):
    """Points under the pixels of a frame (not finite beside the body), the cosine of the view, and the light of the pixels."""
    pose = np.array(frame["camera_from_world"])
    eye = -pose[:3, :3].T @ pose[:3, 3]
    y, x = np.mgrid[0 : camera["height"], 0 : camera["width"]]
    ways = np.stack([(x - camera["cx"]) / camera["fx"], (y - camera["cy"]) / camera["fy"], np.ones(x.shape)], -1) @ pose[:3, :3]
    o, d = eye / AXES, ways / AXES
    a, b, c = (d * d).sum(-1), (d * o).sum(-1), o @ o - 1
    with np.errstate(invalid="ignore"):
        points = eye + ways * ((-b - np.sqrt(b * b - a * c)) / a)[..., None]
    view = eye - points
    cosine = (normals(points) * view).sum(-1) / np.linalg.norm(view, axis=-1)
    codes = np.asarray(Image.open(folder / frame["image"]), float) / 255
    return points, cosine, srgb_light(codes if codes.ndim == 2 else codes.mean(-1))


def matt(parameters, points):
    to = parameters[:3] - points
    squared = (to * to).sum(-1)
    shade = np.maximum(0, (normals(points) * to).sum(-1) / np.sqrt(squared)) / squared
    return np.where(paint(points) == 0, parameters[3], parameters[4]) * shade, shade


def fitted(points, light, scale=0.01):
    """Lamp and two colours: robust least squares from several starts."""
    random, best = np.random.default_rng(0), (np.inf, None)
    cost = lambda q: np.log1p(((matt(q, points)[0] - light) / scale) ** 2).sum()
    for _ in range(12):
        lamp = random.normal(size=3)
        q = np.array([*(lamp * random.uniform(0.5, 2) / np.linalg.norm(lamp)), 0.3, 0.3])
        damping = 1e-3
        for _ in range(150):
            residual = matt(q, points)[0] - light
            weight = 1 / (1 + (residual / scale) ** 2)
            slope = np.stack([(matt(q + 1e-6 * e, points)[0] - matt(q, points)[0]) / 1e-6 for e in np.eye(5)], -1)
            normal = slope.T @ (weight[:, None] * slope)
            trial = q - np.linalg.solve(normal + damping * np.diag(np.diag(normal) + 1e-12), slope.T @ (weight * residual))
            better = cost(trial) < cost(q)
            q, damping = (trial, damping / 2) if better else (q, damping * 3)
        best = min(best, (cost(q), q), key=lambda pair: pair[0])
    return best[1]


def row(name, off):
    return f"| {name} | {np.median(off):.2f} | {off.mean():.2f} | {np.percentile(off, 95):.2f} |"


def table(glint, folder):
    scene = json.loads((folder / "scene.json").read_text())
    frames = [seen(folder, scene["camera"], f) for f in scene["frames"]]
    random = np.random.default_rng(0)
    chosen = []
    for points, cosine, light in frames:
        y, x = np.nonzero(np.isfinite(cosine) & (cosine > 0.3) & (from_faces(points) > EDGE))
        some = random.choice(len(y), 400, replace=False)
        chosen.append((points[y[some], x[some]], light[y[some], x[some]]))
    truth = fitted(np.concatenate([p for p, _ in chosen]), np.concatenate([v for _, v in chosen]))
    lines = ["| `glint texture` on `exact/checker` | median | mean | 95 % |", "|---|---:|---:|---:|"]
    with tempfile.TemporaryDirectory() as scratch:
        for shading in ("keep", "remove"):
            out = pathlib.Path(scratch, f"{shading}.png")
            done = subprocess.run([glint, "texture", folder / "scene.json", "--shading", shading, "-o", out], capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"make_texture.py: {done.stderr.strip()}")
            texture = np.asarray(Image.open(out), float)
            height, width = texture.shape[:2]
            lon, lat = 2 * np.pi * (np.arange(width) + 0.5) / width, np.pi * (0.5 - (np.arange(height)[:, None] + 0.5) / height)
            points = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat) + 0 * lon], -1) * AXES
            light, shade = matt(truth, points)
            lit = (texture[..., 3] > 0) & (shade > 0.1)
            beside = lit & (from_faces(points) > EDGE)
            if shading == "keep":
                off = np.abs(texture[..., 0] - 255 * srgb_codes(light))
                lines.append(row("`--shading keep`: paint and light, codes of 8 bits, beside edges", off[beside]))
                lines.append(row("the same with the edges", off[lit]))
            else:
                ratio = srgb_light(texture[beside][:, 0] / 255) * shade[beside] / light[beside]
                lines.append(row("`--shading remove`: paint up to one factor, %, beside edges", 100 * np.abs(ratio / np.median(ratio) - 1)))
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--glint", default=ROOT / "build/release/bin/glint", type=pathlib.Path)
    parser.add_argument("--data", default=ROOT.parent / "shared/data", type=pathlib.Path)
    parser.add_argument("-o", default=ROOT / "docs/retexture.md", type=pathlib.Path)
    arguments = parser.parse_args()
    page = arguments.o.read_text()
    before, rest = page.split(START)
    arguments.o.write_text(before + START + table(arguments.glint, arguments.data / "exact/checker") + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
