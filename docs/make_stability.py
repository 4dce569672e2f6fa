#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of docs/stability.md from the program `stability` of the tests."""
import argparse
import pathlib
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--program", default=str(root / "build/ci/bin/stability"))
program = parser.parse_args().program
run = subprocess.run([program, "--markdown"], stdout=subprocess.PIPE, text=True)
if run.returncode not in (0, 1):
    sys.exit(f"make_stability.py: {program} failed with {run.returncode}")
page = root / "docs/stability.md"
begin, end = "<!-- table -->\n", "<!-- end of table -->\n"
head, rest = page.read_text().split(begin)
tail = rest.split(end)[1]
page.write_text(head + begin + run.stdout + end + tail)
sys.exit(run.returncode)
