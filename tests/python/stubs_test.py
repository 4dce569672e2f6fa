#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""stubs_test.py SOURCE PACKAGE [--write]: the type stubs of the extension module are what stubgen makes of it, and stubtest finds that they and the
annotations of the package say what is there. --write: makes the stubs."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HEAD = "# SPDX-License-Identifier: BSD-3-Clause\n# Made by tests/python/stubs_test.py --write\n"


def made(package):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-c", "from mypy.stubgen import main; main()", "-q", "-m", "glint._glint", "-o", folder],
                              env={**os.environ, "PYTHONPATH": package}, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
        text = (pathlib.Path(folder) / "glint/_glint.pyi").read_text()
    # The types of arguments that may be None: stubgen reads "= None" as a default of the type named.
    text = re.sub(r"\bglint\._glint\.", "", text)
    return HEAD + text


def main():
    source, package = pathlib.Path(sys.argv[1]), sys.argv[2]
    if importlib.util.find_spec("mypy") is None:
        print("skipped: the package mypy is not installed")
        sys.exit(77)
    if not list(pathlib.Path(package).glob("glint/_glint.*.so")):
        print("skipped: the Python module was not built; it needs python3-dev, python3-numpy and pybind11-dev")
        sys.exit(77)
    file, text = source / "plugins/python/glint/_glint.pyi", made(package)
    if "--write" in sys.argv:
        file.write_text(text)
        return
    if not file.exists() or file.read_text() != text:
        sys.exit(f"{file.name} is not what stubgen makes of the module; run this test with --write")
    done = subprocess.run([sys.executable, "-c", "import sys; from mypy.stubtest import main; sys.exit(main())", "glint", "--ignore-missing-stub"],
                          env={**os.environ, "PYTHONPATH": package, "MYPYPATH": package}, cwd=package, capture_output=True, text=True, check=False)
    print(done.stdout + done.stderr)
    sys.exit(done.returncode)


main()
