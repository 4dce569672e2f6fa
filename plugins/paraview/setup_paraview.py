#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mends the loader of Python plugins in Debian 12's ParaView 5.11, for the user who runs this.

That loader imports inspect.getargspec, which Python 3.11 no longer has, so no Python plugin loads. --mend-loader writes one file of one line into
your own site-packages, which Python 3.11 runs at its start: it gives the name getargspec to inspect.getfullargspec, and does nothing where
inspect.getargspec exists. --undo removes that file. Nothing else is touched; a file of that name with another content is left as it is."""
import argparse
import os
import pathlib
import site
import subprocess
import sys

NAME = "glint_paraview_loader.pth"
LINE = 'import inspect; inspect.getargspec = getattr(inspect, "getargspec", inspect.getfullargspec)\n'


def folder_of(python):
    """The user's site-packages of the interpreter that ParaView embeds."""
    if pathlib.Path(python).resolve() == pathlib.Path(sys.executable).resolve():
        return pathlib.Path(site.getusersitepackages()), hasattr(__import__("inspect"), "getargspec")
    asked = "import inspect, site; print(site.getusersitepackages()); print(hasattr(inspect, 'getargspec'))"
    try:
        said = subprocess.run([python, "-c", asked], capture_output=True, text=True, check=True).stdout.splitlines()
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"{python}: cannot be asked for its user's site-packages: {error}")
    return pathlib.Path(said[0]), said[1] == "True"


def content_of(file):
    try:
        return file.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{file}: cannot be read: {error}")


def mend(file, healthy):
    if healthy:
        print("inspect.getargspec exists: nothing to mend, nothing was written")
        return
    found = content_of(file)
    if found == LINE:
        print(f"{file}: was written before; nothing was changed")
        return
    if found is not None:
        sys.exit(f"{file}: has another content; it is left as it is")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        partial = file.with_name(f"{file.name}.{os.getpid()}")  # Python runs names in .pth only
        partial.write_text(LINE, encoding="utf-8")
        os.replace(partial, file)
    except OSError as error:
        sys.exit(f"{file}: cannot be written: {error}")
    print(f"wrote {file}:\n{LINE}Python plugins load in ParaView now; --undo removes the file")


def undo(file):
    found = content_of(file)
    if found is None:
        print(f"{file}: is not there; nothing was changed")
        return
    if found != LINE:
        sys.exit(f"{file}: has another content; it is left as it is")
    try:
        file.unlink()
    except OSError as error:
        sys.exit(f"{file}: cannot be removed: {error}")
    print(f"removed {file}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--mend-loader", action="store_true", help="write the file")
    what.add_argument("--undo", action="store_true", help="remove it")
    parser.add_argument("--python", default="/usr/bin/python3",
                        help="the interpreter that ParaView embeds (default: %(default)s)")
    options = parser.parse_args()
    folder, healthy = folder_of(options.python)
    if options.undo:
        undo(folder / NAME)
    else:
        mend(folder / NAME, healthy)


main()
