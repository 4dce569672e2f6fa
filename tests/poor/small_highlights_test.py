#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Highlights of 4 px radius whose contours have noise of 0.6 px: what evaluate answers.

small_highlights_test.py GLINT

A photograph of a glossy ball from some distance looks like that. The contours are exact ones of the limit angle on a sphere, found here by bisection along
rays of the camera, with independent noise on every point. Two kinds of noise: of single points, and smooth along the contour, as detection makes it.
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

GLINT = sys.argv[1]
VIEWS, POINTS, NOISE, RADIUS, LIMIT = 96, 36, 0.6, 0.1, math.radians(1.3)
LAMP = (0.9, 0.3, 1.6)
FOCAL, WIDTH, HEIGHT = 1400.0, 1280, 960
CENTRE = (639.5, 479.5)


def plus(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def half_vector(at, eye):
    return unit(plus(unit(plus(LAMP, at, -1)), unit(plus(eye, at, -1))))


class View:
    """A camera at `eye` that looks at the middle of the ball."""

    def __init__(self, eye):
        self.eye = eye
        forward = unit(plus((0, 0, 0), eye, -1))
        right = unit(cross((0, -1, 0), forward))
        self.axes = (right, cross(forward, right), forward)

    def pose(self):
        return [[*axis, -dot(axis, self.eye)] for axis in self.axes] + [[0, 0, 0, 1]]

    def pixel(self, point):
        x, y, z = (dot(axis, plus(point, self.eye, -1)) for axis in self.axes)
        return (FOCAL * x / z + CENTRE[0], FOCAL * y / z + CENTRE[1])

    def angle(self, pixel):
        """Between normal and half vector where the pixel sees the ball; large beside it."""
        x, y = ((pixel[i] - CENTRE[i]) / FOCAL for i in (0, 1))
        ray = unit(plus(plus(self.axes[2], self.axes[0], x), self.axes[1], y))
        along = dot(self.eye, ray)
        under = along * along - dot(self.eye, self.eye) + RADIUS * RADIUS
        if under < 0:
            return math.pi
        at = plus(self.eye, ray, -along - math.sqrt(under))
        return math.acos(max(-1.0, min(1.0, dot(unit(at), half_vector(at, self.eye)))))

    def peak(self):
        at = plus((0, 0, 0), unit(plus(unit(LAMP), unit(self.eye))), RADIUS)
        for _ in range(200):
            at = plus((0, 0, 0), half_vector(at, self.eye), RADIUS)
        return self.pixel(at)


def radius_of_contour(view, peak, turn):
    """Bisection along a ray in the image."""
    near, far = 0.0, 60.0
    for _ in range(60):
        middle = (near + far) / 2
        inside = view.angle((peak[0] + middle * math.cos(turn), peak[1] + middle * math.sin(turn))) < LIMIT
        near, far = (middle, far) if inside else (near, middle)
    return near


def smooth_noise(rng):
    """Along the normal: an offset and three harmonics of equal size, with a variance of NOISE^2."""
    size = NOISE / 2
    a, b = ([rng.gauss(0, size) for _ in range(4)] for _ in range(2))
    turns = [2 * math.pi * i / POINTS for i in range(POINTS)]
    return [sum(a[k] * math.cos(k * t) + b[k] * math.sin(k * t) for k in range(4)) for t in turns]


def scene(smooth):
    rng = random.Random(5)
    frames, radii = [], []
    for i in ((k * 37) % VIEWS for k in range(VIEWS)):  # the first ones are spread, as when a person walks about
        azimuth, elevation = 2 * math.pi * i / VIEWS * 0.6 - 0.9, 0.5 + 0.25 * math.sin(2 * math.pi * i / 24)
        distance = 0.8 + 0.1 * math.cos(2 * math.pi * i / 31)
        eye = (math.sin(azimuth) * math.cos(elevation), 0.6 * math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
        view = View(tuple(distance * e for e in eye))
        peak = view.peak()
        along = smooth_noise(rng)
        contour = []
        for k in range(POINTS):
            turn = 2 * math.pi * k / POINTS
            radius = radius_of_contour(view, peak, turn)
            radii.append(radius)
            dx, dy = (along[k] * math.cos(turn), along[k] * math.sin(turn)) if smooth else (rng.gauss(0, NOISE), rng.gauss(0, NOISE))
            contour.append([peak[0] + radius * math.cos(turn) + dx, peak[1] + radius * math.sin(turn) + dy])
        highlight = {"light": "lamp", "level": 0.5, "peak": [c + rng.gauss(0, NOISE) for c in peak], "contour": contour}
        frames.append({"id": f"{len(frames):04d}", "camera_from_world": view.pose(), "surface": "ball", "lights_on": ["lamp"], "highlights": [highlight]})
    mean = sum(radii) / len(radii)
    assert 3.8 < mean < 4.2, f"radius {mean} px"
    camera = {"width": WIDTH, "height": HEIGHT, "fx": FOCAL, "fy": FOCAL, "cx": CENTRE[0], "cy": CENTRE[1]}
    surface = {"analytic": {"type": "sphere", "radius": RADIUS, "world_from_surface": [[float(i == j) for j in range(4)] for i in range(4)]}}
    return {"glint_scene": 1, "name": "ball", "units": "m", "camera": camera, "frames": frames, "surfaces": {"ball": surface}}


def evaluated(folder, train, models):
    command = [GLINT, "evaluate", folder, "--train", train, "--models", models, "--set", "predict.band=true", "--json", "-"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, timeout=500)
    assert done.returncode == 0, f"{' '.join(map(str, command))}: {done.returncode}: {done.stderr}"
    return json.loads(done.stdout)["models"]


def check(folder, kind, trains, most):
    """Every model answers in every held-out frame; `most`: mean error, % of the diameter."""
    bad = []
    for train in trains:
        held_out = VIEWS - int(train.split(":")[1])
        for models in ("limit-angle,reflectance", "auto"):
            for name, model in evaluated(folder, train, models).items():
                summary = model["summary"]
                error, covered = summary["contour_error_pct"]["mean"], model["band"]["coverage_95"]
                print(f"{kind:6} {train:9} {models if models == 'auto' else '':4} {name:11} {model['status']:4} {summary['predicted']}/{held_out} {error:.3f} % coverage {covered:.3f}")
                if model["status"] == "failed" or summary["predicted"] != held_out or not error <= most or not 0.85 <= covered <= 0.99:
                    bad.append((kind, train, models, name))
    return bad


def main():
    bad = []
    with tempfile.TemporaryDirectory() as folder:
        for kind, trains, most in (("points", ("first:6", "spread:6", "spread:12"), 5.2), ("smooth", ("first:6",), 7.0)):
            path = pathlib.Path(folder) / kind
            path.mkdir()
            (path / "scene.json").write_text(json.dumps(scene(kind == "smooth")), encoding="utf-8")
            bad += check(path, kind, trains, most)
    assert not bad, bad


if __name__ == "__main__":
    main()
