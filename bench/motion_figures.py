#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of lamps and objects that move, on a path tracer's sequences (data/ladder).

  flash      noise of 2 codes in 20 seeds: is the lamp's place inside its stated 95 % region, and how far is it off?
  turntable  the same views told twice, as cameras that move around the object and as an object that moves before one camera:
             by how much do the errors of a frame differ?

Usage: bench/motion_figures.py --glint BIN/glint --data FOLDER [flash|turntable]
Needs numpy and Pillow.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
from PIL import Image

CHI2_3_95 = 7.8147  # 95 % quantile, three degrees of freedom
FLASH = np.array([0.05, -0.02, 0.0])  # m, in the camera's frame: the README of data/ladder


def answer(command, out):
    run = subprocess.run([*command, "--json", str(out)], capture_output=True, text=True)
    if run.returncode:
        raise SystemExit(run.stderr)
    return json.loads(out.read_text())


def flash(glint, data, folder, seeds=20):
    source, inside, lateral = data / "ladder/flash", 0, []
    for name in ("mesh", "mask"):
        shutil.copytree(source / name, folder / name)
    (folder / "frames").mkdir()
    for seed in range(seeds):
        scene, random = json.loads((source / "scene.json").read_text()), np.random.default_rng(seed)
        for frame in scene["frames"]:
            codes = np.asarray(Image.open(source / frame["image"]).convert("RGB"), float)
            noisy = np.clip(np.rint(codes + random.normal(0, 2, codes.shape)), 0, 255)
            Image.fromarray(noisy.astype(np.uint8)).save(folder / frame["image"])
            frame.pop("radiance", None)
        (folder / "scene.json").write_text(json.dumps(scene))
        lamp = answer([glint, "lights", folder / "scene.json", "--source", "image"], folder / "lights.json")["lights"][0]
        off = np.array(lamp["position"]) - FLASH
        inside += off @ np.linalg.solve(np.array(lamp["covariance"]), off) <= CHI2_3_95
        lateral.append(np.hypot(*off[:2]))
    print(f"inside the 95 % region in {inside} of {seeds} seeds; lateral error at most {1e3 * max(lateral):.2g} mm")


def turntable(glint, data, folder):
    source = data / "ladder/turntable"
    shutil.copytree(source, folder / "moving")
    scene = json.loads((source / "scene.json").read_text())
    first = np.array(scene["frames"][0]["camera_from_world"])
    scene["glint_scene"] = 2
    for frame in scene["frames"]:
        frame["world_from_object"] = (np.linalg.inv(first) @ np.array(frame["camera_from_world"])).tolist()
        frame["camera_from_world"] = first.tolist()
    (folder / "moving/scene.json").write_text(json.dumps(scene))
    told = [answer([glint, "evaluate", at / "scene.json", "--models", "canonical,limit-angle,reflectance", "--train", "spread:6",
                    "--truth", source / "contours"], folder / "errors.json") for at in (source, folder / "moving")]
    for model in told[0]["models"]:
        errors = [[f["contour_error_pct"] for f in t["models"][model]["frames"]] for t in told]
        apart = max(abs(a - b) for a, b in zip(*errors) if a is not None)
        print(f"{model}: {told[0]['models'][model]['summary']['contour_error_pct']['mean']:.3g} %, a frame differs by {apart:.2g} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--glint", required=True)
    parser.add_argument("--data", required=True, type=pathlib.Path)
    parser.add_argument("what", nargs="?", choices=["flash", "turntable"])
    asked = parser.parse_args()
    for measure in (flash, turntable):
        if asked.what in (None, measure.__name__):
            with tempfile.TemporaryDirectory() as folder:
                measure(asked.glint, asked.data, pathlib.Path(folder))


if __name__ == "__main__":
    main()
