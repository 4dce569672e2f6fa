#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the commands of docs/captures.md, in their order, in an empty folder: each must end with 0.

walkthrough.py GLINT SOURCE WORK    SOURCE: the project's folder; WORK: emptied and written
"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys


def main():
    glint, source, work = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3])
    blocks = re.findall(r"^```\n(.*?)^```", (source / "docs/captures.md").read_text(encoding="utf-8"), re.M | re.S)
    commands = [line for block in blocks for line in block.splitlines() if line]
    if len(commands) < 8:
        sys.exit(f"docs/captures.md has only {len(commands)} commands")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    for command in commands:
        words = shlex.split(command)
        if words[0] == "glint":
            words[0] = glint
        elif words[:2] == ["python3", "tests/formats/write_scene.py"]:
            words[:2] = [sys.executable, "-B", str(source / words[1])]
        else:
            sys.exit(f"not a command of this page: {command}")
        done = subprocess.run(words, cwd=work, capture_output=True, text=True, check=False)
        print(f"{command}: {done.returncode}")
        if done.returncode:
            sys.exit(done.stderr.strip())


main()
