#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Is the contour of a highlight right whatever the response of the camera?

  tests/formats/response.py GLINT FOLDER       FOLDER is made anew

Writes pictures of I(r) = exp(-r^2 / 2 s^2) around a known point in linear light, coded by cameras with different responses. At the
level L the contour is a circle of radius s sqrt(-2 ln L): from the equation, not from a program. Then the same pictures with
another response stated must give another circle, whose radius follows from both curves.
"""
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys

from pictures import png

WIDTH, HEIGHT, CENTRE, SIGMA, LEVEL = 96, 80, (47.3, 38.8), 9.0, 0.5
TOP = 0.9  # of the largest code: nothing is clipped
# Codes of 8 bits at the level have steps of 1/255 in light that falls by 0.05 a pixel there; a contour averages over 50 pixels.
TOLERANCE_PX = {8: 0.02, 16: 0.002}
NOT_GAUSSIAN_PX = 0.05  # through the wrong curve the picture is no Gaussian any more, as the fit of the peak takes it to be


def curve_file():
    """The measured response of a camera: codes of an s-shaped film curve, as 33 pairs of code and light."""
    def light(code):
        return code ** 2.6 * (1.3 - 0.3 * code)
    rows = [(255 * i / 32, light(i / 32)) for i in range(33)]
    text = "code,light\n" + "".join(f"{code!r},{value!r}\n" for code, value in rows)

    def coded(value):  # on the polyline of the file, as its reader is promised to take it
        for (c0, l0), (c1, l1) in zip(rows, rows[1:]):
            if value <= l1:
                return (c0 + (c1 - c0) * (value - l0) / (l1 - l0)) / 255
        return 1.0
    return text, coded


CURVE, CODED = curve_file()
RESPONSES = {"srgb": lambda v: 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055,
             "linear": lambda v: v, "gamma:2.2": lambda v: v ** (1 / 2.2), "gamma:1.8": lambda v: v ** (1 / 1.8), "curve.csv": CODED}
PLACES = {"srgb": "through the sRGB curve", "linear": "taken as linear", "gamma:2.2": "to the power of 2.2",
          "gamma:1.8": "to the power of 1.8", "curve.csv": "through the curve of curve.csv"}


def picture(code_of, bits):
    data = bytearray()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            r2 = (x - CENTRE[0]) ** 2 + (y - CENTRE[1]) ** 2
            code = round(code_of(TOP * math.exp(-r2 / (2 * SIGMA ** 2))) * (2 ** bits - 1))
            data += struct.pack("B" if bits == 8 else ">H", code) * 3
    return png(WIDTH, HEIGHT, 3, bits, bytes(data))


def scene(folder, name, response):
    camera = {"width": WIDTH, "height": HEIGHT, "fx": 200, "fy": 200, "cx": (WIDTH - 1) / 2, "cy": (HEIGHT - 1) / 2}
    if response:
        camera["response"] = response
    (folder / name).write_text(json.dumps({
        "glint_scene": 1, "camera": camera,
        "frames": [{"id": "a", "image": "a.png", "camera_from_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]}],
        "surfaces": {"wall": {"analytic": {"type": "plane"}}}}))
    return folder / name


def json_of(glint, *arguments):
    run = subprocess.run([glint, *map(str, arguments), "--json", "-"], capture_output=True, text=True, timeout=100, check=False)
    if not run.stdout.startswith("{"):
        sys.exit(f"glint {arguments} ended with {run.returncode}: {run.stderr.strip()}")
    return json.loads(run.stdout)


def radius_of(glint, file):
    highlights = json_of(glint, "detect", file, "--level", LEVEL)["frames"][0]["highlights"]
    if len(highlights) != 1:
        sys.exit(f"{file}: {len(highlights)} highlights instead of one")
    contour = highlights[0]["contour"]
    return sum(math.dist(p, CENTRE) for p in contour) / len(contour)


def main():
    glint, root = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(root, ignore_errors=True)
    complaints = []
    expected = SIGMA * math.sqrt(-2 * math.log(LEVEL))
    for response, code_of in RESPONSES.items():
        for bits in (8, 16):
            folder = root / f"{response.replace(':', '-')}-{bits}"
            folder.mkdir(parents=True)
            (folder / "a.png").write_bytes(picture(code_of, bits))
            if response.endswith(".csv"):
                (folder / response).write_text(CURVE)
            file = scene(folder, "scene.json", response)
            radius = radius_of(glint, file)
            print(f"{response}, {bits} bits: radius {radius:.4f} px, expected {expected:.4f} px")
            if not abs(radius - expected) <= TOLERANCE_PX[bits]:
                complaints.append(f"{response}, {bits} bits: the contour's radius is {radius} px, not {expected}")
            said = json_of(glint, "info", file)["frames"][0]["linear"]
            if said != f"{bits}-bit codes {PLACES[response]} (stated)":
                complaints.append(f"{response}, {bits} bits: the report says '{said}'")
    # Linear pictures without a word are taken as sRGB: half of the light of the peak lies at another place.
    folder = root / "linear-16"
    file = scene(folder, "unstated.json", "")
    to_light = lambda c: c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
    wrong = SIGMA * math.sqrt(-2 * math.log(RESPONSES["srgb"](LEVEL * to_light(TOP)) / TOP))
    radius = radius_of(glint, file)
    print(f"linear taken as sRGB: radius {radius:.4f} px, expected {wrong:.4f} px")
    if not abs(radius - wrong) <= NOT_GAUSSIAN_PX or "default" not in json_of(glint, "info", file)["frames"][0]["linear"]:
        complaints.append("linear pictures without a response are not taken as sRGB, or the report does not say so")
    print("\n".join(complaints) or "agrees")
    sys.exit(1 if complaints else 0)


main()
