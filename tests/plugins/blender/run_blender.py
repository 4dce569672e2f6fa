#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a test of the Blender add-on in Blender, in the background.

  run_blender.py TEST.py FOLDER [--glint PROGRAM] [--window] [ARGUMENT ...]

FOLDER is emptied and holds what the test writes, and the user's files of this Blender, so that nobody's own settings count or change.
--window: with a window, on a virtual display. Exit code: 0 passed, 1 failed, 77 without Blender, xvfb-run, or what the
test itself needs."""
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]


def main(words):
    test, folder = pathlib.Path(words[0]).resolve(), pathlib.Path(words[1]).resolve()
    rest = words[2:]
    window = "--window" in rest
    if window:
        rest.remove("--window")
    blender = shutil.which("blender")
    if not blender or (window and not shutil.which("xvfb-run")):
        print("skipped: there is no", "xvfb-run" if blender else "blender")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "user").mkdir(parents=True)
    environment = dict(os.environ, GLINT_ROOT=str(ROOT), GLINT_TEST_FOLDER=str(folder), PYTHONDONTWRITEBYTECODE="1", LIBGL_ALWAYS_SOFTWARE="1",
                       BLENDER_USER_RESOURCES=str(folder / "user"), BLENDER_USER_CONFIG=str(folder / "user" / "config"),
                       BLENDER_USER_SCRIPTS=str(folder / "user" / "scripts"), BLENDER_USER_DATAFILES=str(folder / "user" / "datafiles"))
    # Blender looks for its Python along PATH: the system's, which it was built for, comes first.
    environment["PATH"] = os.pathsep.join(["/usr/bin", "/bin", environment.get("PATH", "")])
    for name in ("config", "scripts", "datafiles"):
        (folder / "user" / name).mkdir()
    if "--glint" in rest:
        at = rest.index("--glint")
        environment["GLINT_PROGRAM"] = rest[at + 1]
        del rest[at:at + 2]
    command = [blender, "--factory-startup", "--python-exit-code", "1", "-P", str(test), "--", *rest]
    command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24 -noreset", *command] if window else [command[0], "-b", *command[1:]]
    done = subprocess.run(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", check=False)
    print(done.stdout)
    if done.returncode == 77:
        return 77
    # A test that was never reached must not count as passed.
    return 0 if done.returncode == 0 and "glint test: all passed" in done.stdout else 1


if len(sys.argv) < 3:
    sys.exit(__doc__)
sys.exit(main(sys.argv[1:]))
