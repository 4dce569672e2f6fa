#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Time and memory of reading captures of 2,000 cameras.

  python3 bench/measure_readers.py [--glint FILE] [--cameras N] [--points N] [--format NAME ...]

Writes one capture in every format by the writers of tests/formats (full-HD photographs, which all show the same; sparse points, five
cameras each) in a scratch folder, lets `glint convert` read each three times and write a scene file, and prints a table in Markdown:
the size of the files that say what the capture is, the least time and the least time of the processor, and the largest resident memory of the process.
"""
import argparse
import math
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # no folder among the sources
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "formats"))
import exact_scene
import writers_posed
import writers_sfm
from pictures import Pictures
from writers import write_mesh

SEEN_BY = 5  # cameras of a point
WIDTH, HEIGHT, FOCAL = 1920, 1080, 1500.0
RUNS = 3


def images_tum(folder, scene):
    """As writers_posed.images_tum, but with the pose of every image alone."""
    lines = [writers_posed.tum_line(40000 * k, view.rotation, view.centre()) for k, view in enumerate(scene.views)]
    for k, view in enumerate(scene.views):
        writers_posed.write_photograph(folder / "images" / f"{writers_posed.stamp(40000 * k)}.png", view)
    poses = writers_posed.write(folder / "poses.txt", "".join(lines))
    mesh = write_mesh(folder / "mesh.ply", scene.mesh, scene.mesh_comment)
    return writers_posed.Case("images_tum", folder / "images", [], scene, None,
                              ["--poses", poses, *writers_posed.shared_camera(scene.views[0]), "--surface", mesh])


def flat_jpeg(width, height, size):
    """A grey JPEG of full sequential coding in which every coefficient is 0, filled up with comments to about a photograph's size in bytes:
    the size of the picture stands in its first bytes, as mostly. ITU T.81, annex B."""
    def segment(code, body):
        return b"\xff" + bytes([code]) + struct.pack(">H", len(body) + 2) + body

    one_code = bytes([1] + 15 * [0] + [0])  # "0" says: no more coefficients, or no change of the mean
    scan = bytes(((width + 7) // 8 * ((height + 7) // 8) * 2 + 7) // 8)
    comments = b"".join(segment(0xFE, bytes(65000)) for _ in range(max(0, size // 65000)))
    return (b"\xff\xd8" + segment(0xDB, bytes([0] + 64 * [1]))
            + segment(0xC0, struct.pack(">BHHB3B", 8, height, width, 1, 1, 0x11, 0)) +
            comments + segment(0xC4, b"\x00" + one_code) + segment(0xC4, b"\x10" + one_code) +
            segment(0xDA, bytes([1, 1, 0, 0, 63, 0])) + scan + b"\xff\xd9")


def images_jpeg(folder, scene):
    """Photographs of 700 kB: hard links to one file, which the system has in memory after the first run."""
    case = images_tum(folder, scene)
    (folder / "one.jpg").write_bytes(flat_jpeg(WIDTH, HEIGHT, 700000))
    for image in sorted((folder / "images").iterdir()):
        os.link(folder / "one.jpg", image.with_suffix(".jpg"))
        image.unlink()
    return case


FORMATS = {"colmap_text": writers_sfm.colmap_text, "colmap_binary": writers_sfm.colmap_binary, "nvm": writers_sfm.nvm,
           "bundler": writers_sfm.bundler, "images_tum": images_tum, "images_jpeg": images_jpeg}


def large_scene(cameras, points):
    """Cameras on a sphere about the ellipsoid; each point with five of them, wherever it is."""
    chance = random.Random(1)
    picture = Pictures(WIDTH, HEIGHT, bytes(3 * WIDTH * HEIGHT), None)
    exact_scene.MIDDLE = middle = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    writers_sfm.IMAGE_IDS = range(1, cameras + 1)
    writers_sfm.need_middle = lambda view, name: None  # it knows the middle of small pictures alone
    views = []
    for k, direction in enumerate(exact_scene.spread(cameras)):
        position = exact_scene.add(exact_scene.CENTRE, exact_scene.scaled(direction, 1.5))
        rotation = exact_scene.looking(position, exact_scene.add(exact_scene.CENTRE, [0.01, 0.02, 0.0]), 7.0 * k)
        translation = exact_scene.scaled(exact_scene.times(rotation, position), -1)
        views.append(exact_scene.View(f"{k:05d}", 0, FOCAL, FOCAL, *middle, rotation, translation, WIDTH, HEIGHT, picture))
    sparse = [exact_scene.from_sphere(q)[0] for q in exact_scene.spread(points)]
    for k, point in enumerate(sparse):
        for view in chance.sample(views, SEEN_BY):
            view.seen.append((k, view.pixel(point)))
    return exact_scene.Scene(views, exact_scene.ellipsoid_mesh(), sparse, exact_scene.CHECKS)


# A small process between: the system counts the memory of the process that starts another one as that one's, too.
WATCH = """import resource, subprocess, sys
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
u = resource.getrusage(resource.RUSAGE_CHILDREN)
print(u.ru_utime + u.ru_stime, u.ru_maxrss / 1024)
sys.exit(code)"""


def measured(command):
    """Seconds until it ends, seconds of the processor, and megabytes; ends with the program's words where it fails."""
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-S", "-c", WATCH, *map(str, command)], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stderr}")
    return time.monotonic() - start, *map(float, done.stdout.split())


def megabytes(folder):
    return sum(f.stat().st_size for f in folder.rglob("*") if f.is_file() and f.suffix not in (".png", ".jpg", ".ply")) / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--cameras", type=int, default=2000)
    parser.add_argument("--points", type=int, default=50000)
    parser.add_argument("--format", action="append", choices=FORMATS, dest="formats")
    a = parser.parse_args()
    if a.cameras < SEEN_BY:
        parser.error(f"at least {SEEN_BY} cameras")
    with tempfile.TemporaryDirectory() as scratch:
        print(f"{a.cameras:,} cameras of {WIDTH} x {HEIGHT}, {a.points:,} sparse points, {SEEN_BY * a.points:,} observations\n")
        print("| capture | files, MB | time, s | of the processor, s | peak memory, MB |\n|---|---|---|---|---|")
        scene = large_scene(a.cameras, a.points)
        for name in a.formats or FORMATS:
            folder = pathlib.Path(scratch) / name
            case = FORMATS[name](folder, scene)
            runs = [measured([a.glint, "convert", case.input, "-o", pathlib.Path(scratch) / f"{name}-{k}.json", *case.arguments])
                    for k in range(RUNS)]
            print(f"| {name} | {megabytes(folder):.0f} | {min(r[0] for r in runs):.1f} | {min(r[1] for r in runs):.1f} | {max(r[2] for r in runs):.0f} |", flush=True)


main()
