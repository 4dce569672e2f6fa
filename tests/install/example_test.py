#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the commands of docs/cpp.md in an empty folder: installs the build, builds the example programs and the example plugin against that
installation alone, runs them. Then compares: the numbers of the example program with those of `glint evaluate --json`, to the last bit, and its
picture with that of `glint render`, byte for byte."""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


class Shell:
    """Runs commands in one folder, without the libraries of this session."""

    def __init__(self, folder, compiler):
        self.folder = folder
        self.environment = {key: value for key, value in os.environ.items() if key not in ("LD_LIBRARY_PATH", "GLINT_PLUGIN_PATH")}
        self.environment.update(CMAKE_GENERATOR="Ninja", CXX=compiler)

    def run(self, command):
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            sys.exit(f"{command}\n{done.stdout}")
        return done.stdout


def commands_of(page, build):
    """The commands of the page's plain blocks, with the folder of this build. The build itself and its documentation are other tests."""
    blocks = re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    commands = [line.replace("build/release", str(build)) for language, block in blocks if not language for line in block.splitlines()]
    return [c for c in commands if not c.startswith("./glint-run") and "--target api" not in c]


def evaluated(shell, session):
    """(model, frame, light, highlight) -> contour error, px, of the command line."""
    shell.run(f"prefix/bin/glint evaluate {session} --json evaluation.json")
    found = {}
    for model, answer in json.loads((shell.folder / "evaluation.json").read_text())["models"].items():
        for row in answer["frames"]:
            if row["contour_error_px"] is not None:
                found[model, row["id"], row["light"], row["highlight"]] = row["contour_error_px"]
    return found


def compare(shell):
    for name in "plane-to-cylinder", "two-lamps":
        session = f"prefix/share/glint/sessions/{name}/{name}.glint"
        expected = evaluated(shell, session)
        printed = {}
        for line in shell.run(f"example/session_errors {session}").splitlines():
            model, frame, light, highlight, error = line.split()
            printed[model, frame, light, int(highlight)] = float(error.replace(",", "."))  # printf under a locale with a comma
        if not expected or printed != expected:
            differ = [key for key in {*printed, *expected} if printed.get(key) != expected.get(key)]
            sys.exit(f"{name}: {len(differ)} of {len(expected)} numbers differ, the first for {differ[:1]}")
        print(f"{name}: {len(expected)} numbers equal")
    first = min(frame for _, frame, _, _ in expected)  # of those that no model was trained on
    shell.run(f"prefix/bin/glint render {session} --view frame --frame {first} --size 1200x800 -o same.png")
    if (shell.folder / "picture.png").read_bytes() != (shell.folder / "same.png").read_bytes():
        sys.exit("frame_picture draws another picture than glint render")
    print("the picture is that of glint render, byte for byte")


def check_plugin(shell):
    listed = shell.run("prefix/bin/glint --plugin plugin/example.so --version")
    for what in "model flat-mirror", "lobe student-t", "surface superellipsoid", "reader camera-table":
        if what not in listed:
            sys.exit(f"--version does not list {what}:\n{listed}")
    # Without the plugin its model is refused by name.
    session = "prefix/share/glint/sessions/plane-to-cylinder/plane-to-cylinder.glint"
    refused = shell.run(f"prefix/bin/glint evaluate {session} --models flat-mirror 2>&1 && exit 9; [ $? = 2 ]")
    if "flat-mirror" not in refused:
        sys.exit(f"the model of a plugin that is not loaded is not refused by name:\n{refused}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--compiler", required=True)
    options = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="glint_install_"))
    try:
        shell = Shell(folder, options.compiler)
        commands = commands_of(options.source / "docs/cpp.md", options.build.resolve())
        if len(commands) < 9:
            sys.exit(f"docs/cpp.md has only {len(commands)} commands")
        for command in commands:
            print(command, flush=True)
            shell.run(command)
        compare(shell)
        check_plugin(shell)
    finally:
        shutil.rmtree(folder)


main()
