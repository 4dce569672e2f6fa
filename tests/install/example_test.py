#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Installs the build into a folder of its own, builds the example program of resources/examples/cpp against that folder alone, and compares
what it prints with `glint evaluate --json`: the same numbers to the last bit."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


def evaluated(program, session, folder, environment):
    """(model, frame, light, highlight) -> contour error, px, of the command line."""
    file = folder / "evaluation.json"
    run(program, "evaluate", session, "--json", file, env=environment)
    found = {}
    for model, answer in json.loads(file.read_text())["models"].items():
        for row in answer["frames"]:
            if row["contour_error_px"] is not None:
                found[model, row["id"], row["light"], row["highlight"]] = row["contour_error_px"]
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--compiler", required=True)
    options = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="glint_install_"))
    environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    try:
        prefix = folder / "prefix"
        run(options.cmake, "--install", options.build, "--prefix", prefix)
        # A copy, so that no header of the source tree is found by chance.
        shutil.copytree(options.source / "resources/examples/cpp", folder / "example")
        run(options.cmake, "-S", folder / "example", "-B", folder / "built", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
            f"-DCMAKE_CXX_COMPILER={options.compiler}", "-DCMAKE_BUILD_TYPE=Release", env=environment)
        run(options.cmake, "--build", folder / "built", env=environment)
        for name in "plane-to-cylinder", "two-lamps":
            session = prefix / f"share/glint/sessions/{name}/{name}.glint"
            expected = evaluated(prefix / "bin/glint", session, folder, environment)
            printed = {}
            for line in run(folder / "built/session_errors", session, env=environment).splitlines():
                model, frame, light, highlight, error = line.split()
                printed[model, frame, light, int(highlight)] = float(error)
            if not expected or printed != expected:
                differ = [key for key in {*printed, *expected} if printed.get(key) != expected.get(key)]
                sys.exit(f"{name}: {len(differ)} of {len(expected)} numbers differ, the first for {differ[:1]}")
            print(f"{name}: {len(expected)} numbers equal")
        first = min(frame for _, frame, _, _ in expected)  # of those that no model was trained on
        run(folder / "built/frame_picture", session, folder / "picture.png", env=environment)
        run(prefix / "bin/glint", "render", session, "--view", "frame", "--frame", first, "--size", "1200x800", "-o", folder / "same.png",
            env=environment)
        if (folder / "picture.png").read_bytes() != (folder / "same.png").read_bytes():
            sys.exit("frame_picture draws another picture than glint render")
        print("the picture is that of glint render, byte for byte")
    finally:
        shutil.rmtree(folder)


main()
