#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one exact scene in every format that Glint reads, and truth.json: what reading each of them must give.

  tests/formats/write_scene.py FOLDER [--format NAME ...]
      FOLDER/NAME for each format, by default all
  tests/formats/write_scene.py FOLDER --wrong MISTAKE [--format NAME ...]
      the same with one deliberate mistake, by default as scene.json; `all`: FOLDER/MISTAKE for each; truth.json is the right one

Written in another language than Glint, from docs/formats.md and the formats' own documentation, with nothing but Python. What an
earlier run wrote in FOLDER is replaced.

truth.json, all in Glint's conventions: `cases` by name: `input` and `arguments` for the command line ({"file": path}: in FOLDER),
`points` (ten, in the world that is expected), `size` (what errors of lengths are relative to), `depth_scale`, and `frames` in the
order that is expected, with `id`, files, `centre`, `K`, `camera_from_world` and `pixels` of the points.
`images`: the same by name in the scene's own world, metres.
"""
import argparse
import json
import pathlib
import shutil
import sys

sys.dont_write_bytecode = True  # no folder among the sources
import exact_scene
import pictures
import writers_posed
import writers_sfm
from writers import Case, NotExpressible, write_json
from wrong_conventions import MISTAKES

FORMATS = {"scene": writers_posed.scene_json, "colmap_text": writers_sfm.colmap_text, "colmap_binary": writers_sfm.colmap_binary,
           "nvm": writers_sfm.nvm, "nerfstudio": writers_posed.nerfstudio, "nerfstudio_applied": writers_posed.nerfstudio_applied,
           "tum": writers_posed.tum, "bundler": writers_sfm.bundler, "bundler_flat": writers_sfm.bundler_flat,
           "bop": writers_posed.bop, "bop_two_objects": writers_posed.bop_two_objects,
           "images_tum": writers_posed.images_tum, "images_json": writers_posed.images_json,
           "video_tum": writers_posed.video_tum, "video_json": writers_posed.video_json}


def camera_truth(view, points):
    return {"centre": view.centre(), "K": [[view.fx, 0.0, view.cx], [0.0, view.fy, view.cy], [0.0, 0.0, 1.0]],
            "camera_from_world": view.matrix(), "pixels": [view.pixel(p) for p in points]}


def case_truth(case, root):
    def relative(path):
        return path.relative_to(root).as_posix()

    frames = [{"id": f.id, "image": relative(f.image), "depth": relative(f.depth) if f.depth else None,
               **camera_truth(f.view, case.scene.checks)} for f in case.frames]
    arguments = [{"file": relative(a)} if isinstance(a, pathlib.Path) else a for a in case.arguments]
    return {"input": relative(case.input), "arguments": arguments, "size": case.scene.size(), "points": case.scene.checks,
            "depth_scale": case.depth_scale, "frames": frames}


def remove_earlier(root):
    """Only what truth.json says was written by this program."""
    truth = root / "truth.json"
    if truth.exists():
        for case in json.loads(truth.read_text())["cases"].values():
            shutil.rmtree(root / pathlib.PurePosixPath(case["input"]).parts[0], ignore_errors=True)
        truth.unlink()


def write_cases(root, scene, formats):
    """Name of the case -> what reading it must give."""
    cases = {}
    for name in formats:
        written = FORMATS[name](root / name, scene)
        for case in [written] if isinstance(written, Case) else written:
            cases[case.name] = case_truth(case, root)
    return cases


def write_all(root, scene, formats, mistake=None):
    """All formats and truth.json, which is that of the right scene whatever the mistake."""
    remove_earlier(root)
    cases = write_cases(root, scene, formats)
    if mistake:  # over the right files; what the command line says is part of the mistake
        for name, wrong in write_cases(root, mistake.make(scene), formats).items():
            cases[name]["arguments"] = wrong["arguments"]
    truth = {"mistake": mistake.what if mistake else None, "cameras_wrong": bool(mistake and mistake.cameras),
             "size": scene.size(),
             "ellipsoid": {"centre": exact_scene.CENTRE, "semi_axes": exact_scene.SEMI_AXES,
                           "world_from_ellipsoid": exact_scene.WORLD_FROM_BODY},
             "lamp": exact_scene.LAMP, "points": scene.checks,
             "images": {v.name: camera_truth(v, scene.checks) for v in scene.views},
             "cases": cases}
    print(write_json(root / "truth.json", truth))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--format", action="append", choices=FORMATS, dest="formats")
    parser.add_argument("--wrong", choices=[*MISTAKES, "all"])
    a = parser.parse_args()
    root = a.folder.resolve()
    scene = exact_scene.exact_scene()
    pictures.take(scene)
    try:
        if not a.wrong:
            write_all(root, scene, a.formats or list(FORMATS))
        elif a.wrong == "all":
            for name, mistake in MISTAKES.items():
                write_all(root / name, scene, a.formats or ["scene"], mistake)
        else:
            write_all(root, scene, a.formats or ["scene"], MISTAKES[a.wrong])
    except NotExpressible as e:
        print(f"write_scene.py: {e}", file=sys.stderr)
        sys.exit(2)


main()
