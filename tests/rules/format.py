#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every C++ file is as clang-format 14 lays it out with the project's .clang-format (other versions lay out differently).

  tests/rules/format.py [ROOT]      exit code 1 where a file differs (the names are printed), 77 without clang-format 14"""
import pathlib
import re
import shutil
import subprocess
import sys

FOLDERS = ("core", "io", "viz", "gui", "cli", "bench", "tests", "plugins")


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
    tool = shutil.which("clang-format-14") or shutil.which("clang-format")
    version = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout if tool else ""
    if not re.search(r"version 14\.", version):
        print("skipped: there is no clang-format 14")
        sys.exit(77)
    files = sorted(path for folder in FOLDERS for path in (root / folder).rglob("*") if path.suffix in (".cpp", ".h"))
    wrong = set()
    for first in range(0, len(files), 100):
        done = subprocess.run([tool, "--dry-run", "--ferror-limit=1", *files[first:first + 100]], capture_output=True, text=True)
        wrong |= {m[1] for m in re.finditer(r"^(.*?):\d+:\d+: (?:warning|error)", done.stderr, re.MULTILINE)}
    for name in sorted(wrong):
        print(f"{pathlib.Path(name).relative_to(root)}: not laid out as .clang-format says; run clang-format-14 -i on it")
    print(f"{len(files)} files, {len(wrong)} differ")
    sys.exit(1 if wrong else 0)


main()
