#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/retexture.md: composites and frames without their highlight against exact renderings.

Usage: docs/make_retexture.py --glint build/release/bin/glint [-o docs/retexture.md]   (Python's standard library only)
Each scene is rendered twice by `glint synth`: as it is, and with next to no lobe. The second rendering is the background of composites and the
truth of frames without their highlight.
"""
import argparse
import json
import math
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile
import zlib

MODELS = ["primal", "dual", "canonical", "limit-angle", "reflectance"]
START, END = "<!-- table: docs/make_retexture.py -->\n", "<!-- end of table -->\n"
PLANE = {"type": "sheet", "curvature": 0.0, "length": 2.0, "width": 2.0}
ELLIPSOID = {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.25]}
# name, surface, lobe, m, blur px, noise (share of the peak), exposure
SCENES = [("plane", PLANE, "torrance-sparrow", 0.08, 0, 0, 0.35),
          ("ellipsoid", ELLIPSOID, "torrance-sparrow", 0.1, 0, 0, 0.55),
          ("ellipsoid, GGX", ELLIPSOID, "ggx", 0.1, 0, 0, 0.55),
          ("ellipsoid, core clipped", ELLIPSOID, "torrance-sparrow", 0.1, 0, 0, 1.1),
          ("ellipsoid, GGX, core clipped", ELLIPSOID, "ggx", 0.1, 0, 0, 1.1)]
FRAMES, TRAIN = 12, "spread:6"
HELD_OUT = [1, 5, 9]
REMOVED = 5  # one of them: filling a frame takes as long as a composite, for each of them all is fitted again
DIM = 2  # by how much less exposed a rendering is that shows the true peak of a clipped core
SAID = [("its own tail", "tail"), ("core is clipped", "core clipped"), ("clipped (saturated)", "clipped frames"),
        ("strength differs", "strength differs"),
        ("fades out", "fades out"), ("pixels that are left", "seen everywhere")]


def fail(reason):
    sys.exit(f"make_retexture.py: {reason}")


def run(glint, *arguments):
    return subprocess.run([str(glint), *map(str, arguments)], capture_output=True, text=True, check=False)


def pixels(file):
    """Width and rows of an 8-bit colour PNG without interlace (PNG specification, filters of section 9)."""
    data = file.read_bytes()
    at, packed, width, height, channels = 8, b"", 0, 0, 3
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b"IHDR":
            width, height, bits, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
            channels = {0: 1, 2: 3}.get(colour, 0)
            if bits != 8 or interlace or not channels:
                fail(f"{file}: an 8-bit PNG was expected")
        elif kind == b"IDAT":
            packed += body
    raw, step = zlib.decompress(packed), width * channels
    rows, above = [], bytes(step)
    for y in range(height):
        kind, row = raw[y * (step + 1)], bytearray(raw[y * (step + 1) + 1:(y + 1) * (step + 1)])
        for i in range(step) if kind else ():
            left, up = row[i - channels] if i >= channels else 0, above[i]
            corner = above[i - channels] if i >= channels else 0
            if kind == 4:
                guess = left + up - corner
                near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))
                row[i] = (row[i] + near[2]) & 255
            else:
                row[i] = (row[i] + {1: left, 2: up, 3: (left + up) // 2}[kind]) & 255
        rows.append(bytes(row) if channels == 3 else bytes(v for v in row for _ in range(3)))
        above = bytes(row)
    return b"".join(rows)


KEPT = {}


def kept(file):
    """The same, read once."""
    if file not in KEPT:
        KEPT[file] = pixels(file)
    return KEPT[file]


LINEAR = [v / 255 / 12.92 if v / 255 <= 0.04045 else ((v / 255 + 0.055) / 1.055) ** 2.4 for v in range(256)]


def psnr(image, truth, where):
    squares = sum((image[i] - truth[i]) ** 2 for i in where)
    return 10 * math.log10(255 ** 2 * len(where) / squares) if squares else 99.0


def error_of_highlight(image, truth, matt, where):
    """Sum of |H - H true| over the sum of H true, linear light."""
    wrong = sum(abs(LINEAR[image[i]] - LINEAR[truth[i]]) for i in where)
    return 100 * wrong / sum(LINEAR[truth[i]] - LINEAR[matt[i]] for i in where)


def make_scene(glint, folder, surface, lobe, m, blur, noise, exposure):
    spec = {"glint_scene": 1, "name": "retexture", "units": "m",
            "camera": {"width": 320, "height": 240, "fx": 400, "fy": 400, "cx": 159.5, "cy": 119.5},
            "surfaces": {"body": {"analytic": surface}}, "lights": [{"id": "lamp", "position": [1.2, -1.0, 2.2]}],
            "path": {"orbit": {"centre": [0, 0, 0], "radius": 2.0, "from": -2.2, "to": 0.8, "height": 0.9, "count": FRAMES}},
            "render": {"reflectance": lobe, "roughness": m, "diffuse": [0.3, 0.18, 0.1], "bits": 8, "samples": 2,
                       "exposure": exposure, "seed": 1}}
    if surface is PLANE:  # over the plane the cameras look from where the lamp is mirrored
        spec["path"]["orbit"].update({"height": 2.0, "radius": 1.2, "from": 1.6, "to": 3.4})
    matt = {"specular": 1e-12, "blur_px": 0, "noise": 0}
    for name, more in [("shiny", {"blur_px": blur, "noise": noise}), ("matt", matt),
                       ("dim", {"specular": 1, "exposure": exposure / DIM}), ("dim-matt", {**matt, "exposure": exposure / DIM})]:
        spec["render"].update(more)
        (folder / f"{name}.json").write_text(json.dumps(spec))
        done = run(glint, "synth", folder / f"{name}.json", "-o", folder / name)
        if done.returncode:
            fail(done.stderr.strip())
    scene = json.loads((folder / "shiny" / "scene.json").read_text())
    for frame in scene["frames"]:
        for key in ["highlights", "radiance", "depth", "normals", "mask"]:
            frame.pop(key, None)
    (folder / "shiny" / "scene.json").write_text(json.dumps(scene))
    return [frame["id"] for frame in scene["frames"]]


def true_peak(folder, ids):
    """Largest radiance of the highlight, mean of the channels, linear light (1 = the largest code); median over the training frames."""
    peaks = []
    for i in range(0, FRAMES, 2):  # spread:6 of 12
        shiny, matt = (pixels(folder / name / "frames" / f"{ids[i]}.png") for name in ["dim", "dim-matt"])
        peaks.append(DIM * max(sum(LINEAR[shiny[k + c]] - LINEAR[matt[k + c]] for c in range(3))
                               for k in range(0, len(shiny), 3)) / 3)
    return statistics.median(peaks)


def strength_in(printed):
    """Mean of the three channels, from the table that `glint retexture` prints."""
    row = printed.strip().splitlines()[-1].split()
    return statistics.mean(float(v) for v in row[-5:-2])


def score(glint, folder, model, ids, peak):
    """Medians over held-out frames: PSNR of the composite, error of its highlight, its strength as a share of the true peak; PSNR without highlight,
    of the frame as it is; what warnings say. Or why the picture is missing."""
    session = folder / "shiny" / f"{model}.glint"
    fitted = run(glint, "reconstruct", folder / "shiny", "--model", model, "--train", TRAIN, "-o", session)
    if fitted.returncode:
        return fitted.stderr.strip().removeprefix("glint: ").split(":")[0]
    rows, said, without = [], set(), None
    for i in HELD_OUT:
        name = f"{ids[i]}.png"
        out, plain, clean = folder / "o.png", folder / "p.png", folder / "matt" / "frames" / name
        common = ["retexture", session, "--frame", ids[i]]
        done = run(glint, *common, "--background", clean, "--all-warnings", "-o", out)
        if done.returncode:
            return done.stderr.strip().removeprefix("glint: ").split(":")[0]
        said |= {short for words, short in SAID if words in done.stderr}
        truth, matt = kept(folder / "shiny" / "frames" / name), kept(clean)
        image = pixels(out)
        where = [k for k in range(len(truth)) if truth[k] > matt[k] + 1 or image[k] > matt[k] + 1]  # more than rounding and noise
        rows.append((psnr(image, truth, where), error_of_highlight(image, truth, matt, where),
                     100 * strength_in(done.stdout) / peak))
        if i == REMOVED:
            removed = run(glint, *common, "--remove", "--all-warnings", "-o", plain)
            if removed.returncode:
                return removed.stderr.strip().removeprefix("glint: ").split(":")[0]
            said |= {short for words, short in SAID if words in removed.stderr}
            without = f"{psnr(pixels(plain), matt, where):.1f} ({psnr(truth, matt, where):.1f})"
    composite, wrong, strength = (statistics.median(column) for column in zip(*rows))
    return [f"{composite:.1f}", f"{wrong:.2f}", f"{strength:.1f}", without, ", ".join(sorted(said))]


def table(glint):
    lines = ["| scene | model | composite, dB | error of the highlight, % | strength, % of the true peak | without highlight, dB (frame as it is) | warned of |",
             "| --- | --- | --- | --- | --- | --- | --- |"]
    for name, *how in SCENES:
        KEPT.clear()
        with tempfile.TemporaryDirectory() as text:
            folder = pathlib.Path(text)
            ids = make_scene(glint, folder, *how)
            peak = true_peak(folder, ids)
            for model in MODELS:
                result = score(glint, folder, model, ids, peak)
                cells = [result, "", "", "", ""] if isinstance(result, str) else result
                lines.append("| " + " | ".join([name, model, *cells]) + " |")
                print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--glint", default="build/release/bin/glint", type=pathlib.Path)
    parser.add_argument("-o", default="docs/retexture.md", type=pathlib.Path)
    arguments = parser.parse_args()
    page = arguments.o.read_text()
    before, rest = page.split(START)
    arguments.o.write_text(before + START + table(arguments.glint) + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
