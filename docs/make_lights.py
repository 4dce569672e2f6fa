#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/lights.md: what `glint lights` says of lamps that are known, and of two real chrome balls."""
import argparse
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

TEXT = """# Lamps

How well `glint lights` finds lamps, and what it assumes. A program writes this page; do not edit it. From the root of the project, after
`cmake --build --preset release --target glint`:

    python3 docs/make_lights.py

[commands.md](commands.md#lights) has the command, [formats.md](formats.md#lights---json) the files.

## Lamps of a scene
Every highlight of a lamp goes into one fit: the reflectance model of its pixels where images are there, of its contours where only they are given, else the bundle of the contours, else
the mirrored rays of the peaks alone, which give a direction. A highlight whose mirrored ray passes far from the lamp that the other frames see is left out and named in `dropped`.
`error` is the distance from the true lamp, `stated` the root of the trace of the covariance.

SCENES
The covariance has two parts: the noise that the residuals show, and how the lamp moves when an eighth of the frames is left out, by their contours. It cannot know an error that all frames share in the
same way: a lobe of another shape, a lamp with a size, a scale; an error may then be larger than stated, as on the path-traced sphere. Where fewer than four views
remain, each is taken to be 0.2 px off on its own.

All frames from one place see one mirrored ray: then there is no position, whatever the lobe's shape would make of it, and the direction is that of a distant lamp.
Twelve distant lamps around a rough ball, each on in one 8-bit frame of one camera, as a scene and as photographs (next section):

ROUGH
The camera is at 24 radii of the ball. A user who does not say so pays the angle under which it sees the ball's radius, 2.4 degrees at the edge.

## Photographs of mirror balls
One fit of all lamps and all outlines: a lamp is a direction and an inverse distance, a ball the circle (with a focal length the sphere) of its outline. The mirror point on the sphere is solved
for each pair of them. On exact highlights directions are right to 1e-6 rad and positions to 1e-6 of the distance, from 1/1000 to 1000 times the size, and with noise the squared errors have the promised
spread (`core.lamps` in the tests).

What the data determine:
- One ball: a direction. The lamp lies on the mirrored ray; seen from the ball's middle it is elsewhere by up to the angle at which the ball is seen from the lamp. `reason` says how much that is for a lamp at 20 radii.
- Two balls or more, and `--camera`: a position, where the inverse distance is five standard deviations from 0; else `parallel rays`, and how far away the lamp is at least.
- No focal length: directions under parallel rays. A ball beside the image's middle is then seen from the side, at an angle that is not taken into account.
- The focal length of EXIF data alone (`FocalLengthIn35mmFilm`, whole shots): directions, with the principal point taken in the middle; 3 % of the focal length and 0.01 rad of the axis are in the standard deviation.

A rough ball has wide highlights, whose middle is not the mirror point. Where they are wider than a twentieth of the radius, and there is one ball, its photographs also go through the fit of a scene; a lamp takes that
direction where the lobe explains its highlight and agrees with the mirrored ray (`solver` then says so).

Three balls or more tell which of their highlights is not the lamp's. Two that contradict each other, by more than four standard deviations and 2 % of the radius, do not: another bright place
on one of them may agree; else the lamp has no answer.

What stays where it is in three of four photographs is a window or another fixed thing, and the lamp is what moves. One photograph, or several of one lamp, do not tell: the largest reflection is taken. Every other one that
only its size speaks against (a fifth of the radius or more) then has its direction in `dropped`; there is no position, and the standard deviation is the root of the mean square of the angles between them all. A warning names them, and says how wide and of
what shape the thing in the reflection is: a single one gets a warning where it is rectangular or elongated, or wider than 20 degrees.

### How well an outline is known
Edges refine a given outline where they tell it to 1 % of the radius, or better than `--outline-sigma` says of it; else it stays as it is, with a warning. The standard deviation has three parts: what leaving out each
twelfth of the outline shows; what twice the blur shows, for a step beside light that rises or falls up to the rim, as in what a mirror shows, seems to lie aside; and the rounding of grey levels. Where the
outline found lies inside of the given one all around, it may be the edge of a reflection within a rim that does not stand out, which no photograph tells from a rim: the radius then is uncertain by half of the distance to the given
outline, and a warning says so. A given outline that is itself wrong does not help there.

The tests draw balls by a ray tracer that shares no code with the program: plain, small, large, noisy, as JPEG, faint, blurred, hidden in part, with a bright circle inside of the rim. In each of these groups at least 95 % of the true centres
and radii lie within three standard deviations; where there is a circle inside, the given outline is the true one (`test_core_lamps --gtest_filter='BallOutlineSigma.*'` prints the figures).

### Two chrome balls of which no truth is known
Twelve lamps, one in each photograph (psbox: a public set of real photographs). Size, focal length and lamps are not known, so the two balls check each other. In degrees: how far apart the directions from the
two balls are, along the line between the balls (parallax: a near lamp makes some) and across it (nothing but errors does), each as a mean. `left out`: how far the highlight on one ball is from where the other
ball alone predicts it for a distant lamp, with outlines that were refined without this lamp.

CHROME
The published directions of one lamp differ by 0.41 to 1.75 degrees, most of which is one constant offset: the outlines. What is left across the line is the detection of clipped, star-shaped highlights. A constant parallax along the line is an
outline's error or the lamps' distance; the photographs cannot tell which without a focal length.

The inspector's window of balls (*File > Measure lamps from balls…*, [inspector](inspector.md#lamps)) on these photographs; `docs/make_lights.py --picture PROGRAM` draws it:

![Two chrome balls, one lamp in each photograph](pictures/lamps-balls.png)

Photograph: PSBox, Copyright (c) 2014 Ying Xiong, MIT licence.
"""

LAMP = [1.5, -1.0, 2.2]
BODY = {"glint_scene": 1, "name": "body", "camera": {"width": 160, "height": 120, "fx": 200, "fy": 200, "cx": 79.5, "cy": 59.5},
        "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.3]}}},
        "lights": [{"id": "lamp", "position": LAMP}],
        "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.9, "height": 0.9, "from": -1.9, "to": -0.5, "count": 8}},
        "render": {"reflectance": "ggx", "roughness": 0.2, "diffuse": 0.05, "bits": 32, "samples": 1}}
TURNS = 12  # distant lamps around a rough ball
# Balls of psbox: outlines as a person clicked them (circle_data.txt), from the left and the bottom, counted from 1; x of the cut-out in the shot.
PSBOX = [("LightProbe-1", 0, 0), ("LightProbe-2", 2750, 50)]


class Program:
    def __init__(self, path):
        self.path = path

    def run(self, *arguments):
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"glint {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return done.stdout

    def lights(self, *arguments):
        return json.loads(self.run("lights", *arguments, "--json", "-"))

    def synth(self, spec, folder):
        (folder.parent / (folder.name + ".json")).write_text(json.dumps(spec))
        self.run("synth", folder.parent / (folder.name + ".json"), "-o", folder)
        return folder


def angle(a, b):
    cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return math.degrees(math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(a, b))))


def unit(v):
    return [x / math.hypot(*v) for x in v]


def bare(folder):
    """Without the exact highlights, so that the program has to find them."""
    scene = json.loads((folder / "scene.json").read_text())
    for frame in scene["frames"]:
        frame.pop("highlights", None)
    (folder / "found.json").write_text(json.dumps(scene))
    return folder / "found.json"


def positioned(name, answer, lamps):
    rows = []
    for light in answer["lights"]:
        truth = lamps[light["id"]]
        off = math.dist(light["position"], truth)
        away = math.dist(truth, light["from"])
        sigma = math.sqrt(sum(light["covariance"][k][k] for k in range(3)))
        rows.append([name, light["highlights"], f"{1000 * off:.2g}", f"{off / away:.1e}", f"{1000 * sigma:.2g}", light["solver"]])
    return rows


def scenes(program, folder, shared):
    exact = program.synth(BODY, folder / "body")
    rows = positioned("ellipsoid, exact pixels (float)", program.lights(bare(exact)), {"lamp": LAMP})
    rows += positioned("ellipsoid, exact contours", program.lights(exact), {"lamp": LAMP})
    coarse = json.loads(json.dumps(BODY))
    coarse["render"].update({"bits": 8, "noise": 0.003, "seed": 1, "samples": 2})
    rows += positioned("ellipsoid, 8 bits and noise of 0.3 %", program.lights(bare(program.synth(coarse, folder / "coarse"))),
                       {"lamp": LAMP})
    for name in ("sphere", "plane_to_cylinder", "vase"):
        scene = shared / "data/cycles" / name / "scene.json"
        truth = {light["id"]: light["position"] for light in json.loads(scene.read_text())["lights"]}
        rows += positioned(f"path-traced {name}", program.lights(scene), truth)
    return rows


def rough_balls(program, folder):
    lamps = []
    for i in range(TURNS):
        tilt, turn = math.radians(8 + 4 * i), 2.4 * i
        lamps.append([math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), -math.cos(tilt)])
    still = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    rows = []
    for lobe, roughness in (("torrance-sparrow", 0.15), ("ggx", 0.12)):
        spec = {"glint_scene": 1, "name": "ball",
                "camera": {"width": 300, "height": 300, "fx": 3000, "fy": 3000, "cx": 149.5, "cy": 149.5},
                "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.05,
                                                   "world_from_surface": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1.2],
                                                                          [0, 0, 0, 1]]}}},
                "frames": [{"id": f"{i:03}", "camera_from_world": still, "surface": "ball", "lights_on": [f"l{i:02}"]}
                           for i in range(TURNS)],
                "lights": [{"id": f"l{i:02}", "direction": d} for i, d in enumerate(lamps)],
                "render": {"reflectance": lobe, "roughness": roughness, "diffuse": 0.1, "bits": 8, "noise": 0.003, "seed": 1}}
        found = bare(program.synth(spec, folder / lobe))
        photographs = [folder / lobe / "frames", "--ball", "151,148.5,124"]
        for how, arguments in (("a scene, shape known", [found]),
                               ("photographs, `--ball`, `--camera`", photographs + ["--camera", "3000,3000,149.5,149.5"]),
                               ("photographs, `--ball` alone", photographs)):
            answer = program.lights(*arguments)
            errors = sorted(angle(light["direction"], lamps[int(light["frames"][0])]) for light in answer["lights"]
                            if light["direction"])
            positions = sum(light["position"] is not None for light in answer["lights"])
            rows.append([lobe, how, f"{len(errors)} of {TURNS}", positions, f"{errors[len(errors) // 2]:.2g}",
                         f"{errors[-1]:.2g}"])
    return rows


def psbox_balls(data, prefix):
    heights = {"LightProbe-1": 1000, "LightProbe-2": 950}
    balls = []
    for name, x0, y0 in PSBOX:
        x, y, radius = map(float, (data / name / "circle_data.txt").read_text().split())
        balls += ["--ball", f"{prefix}{name}:{x - 1},{heights[name] - y},{radius}@{x0},{y0}"]
    return balls


def picture(inspector, shared, output):
    """The window of balls on one photograph of psbox; needs xvfb-run."""
    data = shared / "data/psbox"
    environment = dict(os.environ, QT_QPA_PLATFORM="xcb")
    subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", inspector, str(data), *psbox_balls(data, ""), "--exclude",
                    "ref", "--frame",
                    "Image_11", "--theme", "dark", "--screenshot", output, "--wait-idle"], env=environment, check=True)
    if shutil.which("mogrify"):  # a third of the size, as docs/make_pictures.sh does
        subprocess.run(["mogrify", "-strip", "-colors", "128", "-define", "png:compression-level=9", output], check=True)


def psbox(program, shared):
    data = shared / "data/psbox"
    balls = psbox_balls(data, f"{data}/")
    rows, published = [], []
    columns = [[list(map(float, line.split())) for line in (data / n / "light_directions.txt").read_text().splitlines()
                if line.strip()]
               for n, _, _ in PSBOX]
    for i in range(12):
        published.append(angle(*[[c[k][i] for k in range(3)] for c in columns]))
    rows.append(["published (centroids, outlines as clicked)", 12, f"{sum(published) / 12:.2f}", f"{max(published):.2f}", "", "",
                 "", ""])
    for outlines in ("given", "edges", "fitted"):
        answer = program.lights(data, *balls, "--exclude", "ref", "--outlines", outlines)
        both = [light for light in answer["lights"] if light.get("parallax")]
        apart = [angle(light["sightings"][0]["direction"], light["sightings"][1]["direction"]) for light in both]
        along = [light["parallax"]["along_deg"] for light in both]
        across = [light["parallax"]["across_deg"] for light in both]
        left = [math.hypot(*s["left_out_px"]) for light in both for s in light["sightings"] if s["left_out_px"]]
        answered = sum(light["status"] == "ok" for light in answer["lights"])
        rms = math.sqrt(sum(a * a for a in across) / len(across))
        rows.append([f"`--outlines {outlines}`", answered, f"{sum(apart) / len(apart):.2f}", f"{max(apart):.2f}",
                     f"{sum(along) / len(along):.2f}", f"{sum(across) / len(across):.2f}", f"{rms:.2f}",
                     f"{sum(left) / len(left):.1f}"])
    return rows


def table(head, rows):
    out = "| " + " | ".join(head) + " |\n" + "|" + "---|" * len(head) + "\n"
    return out + "".join("| " + " | ".join(map(str, row)) + " |\n" for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/bin/glint")
    parser.add_argument("--shared", default="../shared", type=pathlib.Path)
    parser.add_argument("--output", default="docs/lights.md", help="file to write; - prints it")
    parser.add_argument("--picture", metavar="PROGRAM",
                        help="draw docs/pictures/lamps-balls.png with this glint-inspector, and nothing else")
    a = parser.parse_args()
    if a.picture:
        return picture(a.picture, a.shared, "docs/pictures/lamps-balls.png")
    program = Program(a.program)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = TEXT
        text = text.replace("SCENES", table(["scene", "highlights", "error, mm", "of the distance", "stated, mm", "from"],
                                            scenes(program, folder, a.shared)))
        text = text.replace("ROUGH", table(["lobe", "given as", "answered", "positions", "median, degrees", "largest, degrees"],
                                           rough_balls(program, folder)))
        text = text.replace("CHROME", table(["outlines", "lamps", "directions apart, mean", "largest", "along", "across",
                                             "across, rms",
                                             "left out, px"], psbox(program, a.shared)))
    if a.output == "-":
        print(text)
    else:
        pathlib.Path(a.output).write_text(text)


if __name__ == "__main__":
    main()
