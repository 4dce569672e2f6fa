#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where programs and libraries look for libraries, in the build tree and installed: never in the current folder, which an empty entry or a
relative one of a search path means. A stranger's folder, in which somebody calls a program, must not choose its code."""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile


def search_paths(file):
    """The entries of RUNPATH and RPATH, as readelf prints them; None where the file is no ELF file."""
    with open(file, "rb") as opened:
        if opened.read(4) != b"\x7fELF":
            return None
    told = subprocess.run(["readelf", "--wide", "--dynamic", file], check=True, capture_output=True, text=True).stdout
    return [entry for paths in re.findall(r"\((?:RUNPATH|RPATH)\).*?\[(.*)\]", told) for entry in paths.split(":")]


def wrong(entry):
    return not re.match(r"/|\$ORIGIN(/|$)", entry)


def check(folders):
    """@return the number of files looked at"""
    seen, faults = 0, []
    for folder in folders:
        for file in sorted(folder.rglob("*")):
            if file.is_symlink() or not file.is_file() or "CMakeFiles" in file.parts:
                continue
            entries = search_paths(file)
            if entries is None:
                continue
            seen += 1
            faults += [f"{file}: looks for libraries in '{entry}'" for entry in entries if wrong(entry)]
    if faults:
        sys.exit("\n".join(faults))
    return seen


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    build = parser.parse_args().build
    assert all(map(wrong, ["", ".", "lib", "$ORIGINAL/x"])) and not any(map(wrong, ["/usr/lib", "$ORIGIN", "$ORIGIN/../lib"]))
    count = check([build / name for name in ("bin", "lib", "python", "plugins", "tests")])
    with tempfile.TemporaryDirectory() as folder:
        installed = pathlib.Path(folder)
        known = set(re.findall(r'CMAKE_INSTALL_COMPONENT STREQUAL "(\w+)"', "".join(f.read_text() for f in build.rglob("cmake_install.cmake"))))
        for component in sorted(known & {"glint", "inspector", "libraries", "python", "python_wheel"}):
            subprocess.run(["cmake", "--install", build, "--prefix", installed, "--component", component], check=True, stdout=subprocess.DEVNULL)
        placed = check([installed])
    if count < 5 or placed < 4:
        sys.exit(f"only {count} files in the build tree and {placed} installed were found")
    print(f"{count} files in the build tree and {placed} installed look in no folder of the caller")


if __name__ == "__main__":
    main()
