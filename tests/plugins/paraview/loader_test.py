#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""setup_paraview.py: writes one line that works, does nothing where it is not needed, undoes it, and touches no file of another."""
import os
import pathlib
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(sys.argv[1]) / "plugins/paraview/setup_paraview.py"


def run(base, *arguments, python=sys.executable):
    environment = {**os.environ, "PYTHONUSERBASE": str(base)}
    return subprocess.run([sys.executable, "-B", SCRIPT, "--python", python, *arguments], env=environment, capture_output=True, text=True, check=False)


def main():
    with tempfile.TemporaryDirectory() as base:
        environment = {**os.environ, "PYTHONUSERBASE": base}
        where = subprocess.run([sys.executable, "-c", "import site; print(site.getusersitepackages())"], env=environment, capture_output=True, text=True,
                               check=True).stdout.strip()
        file = pathlib.Path(where) / "glint_paraview_loader.pth"
        has = subprocess.run([sys.executable, "-c", "from inspect import getargspec"], env=environment, capture_output=True, check=False).returncode == 0
        done = run(base, "--mend-loader")
        assert done.returncode == 0, done.stderr
        if has:  # an older interpreter: nothing to mend
            assert not file.exists() and "nothing was written" in done.stdout
        else:
            assert str(file) in done.stdout and [f.name for f in file.parent.iterdir()] == [file.name]
            assert len(file.read_text().splitlines()) == 1
            asked = "from inspect import getargspec; print(getargspec(lambda a, b: 0).args)"
            said = subprocess.run([sys.executable, "-c", asked], env=environment, capture_output=True, text=True, check=False)
            assert said.stdout.strip() == "['a', 'b']", said.stderr
            assert "nothing" in run(base, "--mend-loader").stdout
            assert run(base, "--undo").returncode == 0 and not file.exists()
        assert run(base, "--undo").returncode == 0  # once more changes nothing
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("# of another program\n")
        for option in ("--undo",) + (() if has else ("--mend-loader",)):
            refused = run(base, option)
            assert refused.returncode != 0 and "another content" in refused.stderr and file.read_text() == "# of another program\n"
        # An interpreter that has getargspec is left alone. This one is a stand-in, which answers as such a one does.
        old = pathlib.Path(base) / "python"
        old.write_text(f"#!/bin/sh\necho '{base}/old'\necho True\n")
        old.chmod(0o755)
        done = run(base, "--mend-loader", python=str(old))
        assert done.returncode == 0 and "nothing was written" in done.stdout and not (pathlib.Path(base) / "old").exists()
    print("passed")


main()
