#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""run.py PACKAGE GLINT FILE...: pytest on these files with the built package; 77 where something that they need is not there.

PACKAGE: the folder with the package glint; GLINT: the program."""
import importlib.util
import os
import pathlib
import subprocess
import sys


def main():
    package, program, *files = sys.argv[1:]
    for name, debian in (("pytest", "python3-pytest"), ("numpy", "python3-numpy")):
        if importlib.util.find_spec(name) is None:
            print(f"skipped: the package {debian} is not installed")
            sys.exit(77)
    if not list(pathlib.Path(package).glob("glint/_glint.*.so")):
        print("skipped: the Python module was not built; it needs python3-dev, python3-numpy and pybind11-dev")
        sys.exit(77)
    here = pathlib.Path(__file__).resolve().parent
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([package, str(here)]), "GLINT_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}
    sys.exit(subprocess.run([sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", str(here), *files],
                            env=environment, check=False).returncode)


main()
