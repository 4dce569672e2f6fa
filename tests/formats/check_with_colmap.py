#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does COLMAP understand what write_scene.py wrote? So that Glint is not tested against a misunderstanding.

  tests/formats/check_with_colmap.py FOLDER      exit code 1 where it does not, 77 without colmap

COLMAP turns the binary model into text and the text model into binary, with the same values; its bundle adjustment finds nothing
to do before its first step; and the cameras of its own exports to NVM and Bundler are those of our files. (Features are not
compared: in NVM COLMAP 3.8 counts them from the corner of the image, VisualSFM, whose format it is, from the middle.)
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

NUMBERS = 1e-12  # relative to the largest: COLMAP writes 17 digits, and normalises quaternions once more
EXPORTED = 1e-12  # relative: COLMAP exports cameras with 17 digits, too, after turning quaternions into matrices


def colmap(*arguments):
    done = subprocess.run(["colmap", *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"colmap {arguments[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def records(path, rows):
    """The words of a text of COLMAP's by id, `rows` lines to a record. Empty lines count: a view may have no features."""
    lines = [line for line in path.read_text().split("\n") if not line.startswith("#")][:-1]
    texts = [" ".join(lines[i:i + rows]).split() for i in range(0, len(lines), rows)]
    return {words[0]: words[1:] for words in texts}


def differences(a, b, tolerance, what):
    """What differs between two lists of words, numbers by their value."""
    if len(a) != len(b):
        return [f"{what}: {len(a)} and {len(b)} words"]
    found = []
    for x, y in zip(a, b):
        try:
            same = abs(float(x) - float(y)) <= tolerance * max(1.0, abs(float(x)))
        except ValueError:
            same = x == y
        if not same:
            found.append(f"{what}: {x} and {y}")
    return found[:3]


def compare_models(ours, theirs):
    found = []
    for name, rows in (("cameras", 1), ("images", 2), ("points3D", 1)):
        a, b = records(ours / f"{name}.txt", rows), records(theirs / f"{name}.txt", rows)
        if a.keys() != b.keys():
            found.append(f"{name}: other ids")
        for key in a.keys() & b.keys():
            found += differences(a[key], b[key], NUMBERS, f"{name}.txt, {key}")
    return found


def initial_cost(log):
    """The error of the bundle adjustment, in pixels (root mean square)."""
    return float(re.search(r"Initial cost\s*:\s*([-+.e\d]+)", log)[1])


def pinhole_as_radial(model, work):
    """COLMAP exports to NVM only cameras with one focal length and one radial term."""
    copy = work / "radial"
    shutil.copytree(model, copy)
    lines = []
    for line in (copy / "cameras.txt").read_text().splitlines():
        words = line.split()
        if words[0] != "#":
            line = " ".join([words[0], "SIMPLE_RADIAL", *words[2:5], *words[-2:], "0"])  # width, height, f; cx, cy
        lines.append(line)
    (copy / "cameras.txt").write_text("\n".join(lines) + "\n")
    return copy


def nvm_cameras(path, folder=""):
    """Name without folder -> numbers with a quaternion of w >= 0."""
    rows = [line.split() for line in path.read_text().splitlines()]
    count = int(rows[2][0])
    found = {}
    for words in rows[3:3 + count]:
        q = [float(w) for w in words[2:6]]
        sign = 1 if q[0] >= 0 else -1
        found[words[0].removeprefix(folder)] = [words[1], *(str(sign * c) for c in q), *words[6:10]]
    return found


def bundler_cameras(bundle, names):
    rows = bundle.read_text().splitlines()[1:]
    images = [line.split()[0].rpartition("/")[2] for line in names.read_text().splitlines()]
    text = rows[1:]
    return {name: " ".join(text[5 * i:5 * i + 5]).split() for i, name in enumerate(images) if text[5 * i] != "0 0 0"}


def compare_tables(ours, theirs, what):
    if ours.keys() != theirs.keys():
        return [f"{what}: other images"]
    return [line for name in ours for line in differences(ours[name], theirs[name], EXPORTED, f"{what}, {name}")]


def main():
    root = pathlib.Path(sys.argv[1])
    if not shutil.which("colmap"):
        print("skipped: there is no colmap")
        sys.exit(77)
    for needed in ("colmap_text", "colmap_binary", "nvm", "bundler", "bundler_flat"):
        if not (root / needed).is_dir():
            raise SystemExit(f"{root} has no {needed}: run write_scene.py with all formats")
    text, binary = root / "colmap_text/sparse/0", root / "colmap_binary/sparse/0"
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        for folder in ("text", "binary", "again", "adjusted"):
            (work / folder).mkdir()
        colmap("model_converter", "--input_path", binary, "--output_path", work / "text", "--output_type", "TXT")
        found = compare_models(text, work / "text")
        colmap("model_converter", "--input_path", text, "--output_path", work / "binary", "--output_type", "BIN")
        colmap("model_converter", "--input_path", work / "binary", "--output_path", work / "again", "--output_type", "TXT")
        found += compare_models(text, work / "again")
        cost = initial_cost(colmap("bundle_adjuster", "--input_path", text, "--output_path", work / "adjusted"))
        print(f"bundle adjustment begins with an error of {cost:g} px")
        if not cost <= 1e-6:  # it prints six digits
            found.append(f"its points are {cost:g} px away from their features")
        radial = pinhole_as_radial(text, work)
        colmap("model_converter", "--input_path", radial, "--output_path", work / "out.nvm", "--output_type", "NVM")
        found += compare_tables(nvm_cameras(root / "nvm/model.nvm", "images/"), nvm_cameras(work / "out.nvm"), "NVM")
        colmap("model_converter", "--input_path", radial, "--output_path", work / "out", "--output_type", "Bundler")
        theirs = bundler_cameras(work / "out.bundle.out", work / "out.list.txt")
        for folder, bundle in (("bundler", "bundle/bundle.out"), ("bundler_flat", "bundle.out")):
            ours = bundler_cameras(root / folder / bundle, root / folder / "list.txt")
            found += compare_tables(ours, theirs, folder)
    print("\n".join(found) or "COLMAP reads the same")
    sys.exit(1 if found else 0)


main()
