#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Peak memory of `glint evaluate` on a long sequence: 1,410 photographs of 1920 x 1080 (ten pictures, repeated).

Prints one line: frames, models, peak resident memory of the process in MB, and whether every frame was answered. The scene is made
by `glint synth` in a scratch folder; frames beyond the tenth refer to the same files, which are read again for each.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

PICTURES = 10


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--frames", type=int, default=1410)
    parser.add_argument("--models", default="canonical,limit-angle")
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        spec = {"glint_scene": 1, "name": "long", "units": "m",
                "camera": {"width": 1920, "height": 1080, "fx": 2000, "fy": 2000, "cx": 959.5, "cy": 539.5},
                "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.25]}}},
                "lights": [{"id": "lamp", "position": [1.2, -1.0, 2.2]}], "contour": "radiance", "level": 0.5,
                "render": {"reflectance": "torrance-sparrow", "roughness": 0.12, "bits": 8, "diffuse": 0.1},
                "path": {"orbit": {"centre": [0, 0, 0], "radius": 2.1, "from": -1.6, "to": 0.4, "height": 0.9,
                                   "count": PICTURES}}}
        (folder / "spec.json").write_text(json.dumps(spec))
        subprocess.run([a.glint, "synth", str(folder / "spec.json"), "-o", str(folder / "scene")], check=True,
                       capture_output=True)
        scene = json.loads((folder / "scene" / "scene.json").read_text())
        frames = []
        for i in range(a.frames):
            frame = dict(scene["frames"][i * PICTURES // a.frames], id=f"{i:04d}")
            for key in ("highlights", "radiance", "depth", "normals"):  # photographs alone: highlights are detected
                frame.pop(key, None)
            frames.append(frame)
        scene["frames"] = frames
        long = folder / "scene" / "long.json"
        long.write_text(json.dumps(scene))
        done = subprocess.run([a.glint, "evaluate", str(long), "--models", a.models, "--train", "spread:6", "--source", "image",
                               "--json", "-"],
                              capture_output=True, text=True)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        if done.returncode:
            sys.exit(done.stderr.strip())
        answered = []
        for name, model in json.loads(done.stdout)["models"].items():
            s = model["summary"]
            answered.append(f"{name} {s['predicted']} of {s['frames']} predicted")
        print(f"{a.frames} frames of 1920 x 1080: {'; '.join(answered)}; peak {peak:.0f} MB")


if __name__ == "__main__":
    main()
