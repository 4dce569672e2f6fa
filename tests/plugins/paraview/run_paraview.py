#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a test script in pvpython, with a home and site-packages of its own; 77 where something that it needs is not there.

The home's site-packages hold what `setup_paraview.py --mend-loader` writes: without it Debian's ParaView loads no Python plugin."""
import argparse
import glob
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def folder_of(pattern):
    found = sorted({os.path.dirname(f) for f in glob.glob(pattern, recursive=True)})
    return os.pathsep.join(found)


def programs(unpacked):
    """(folder of pvpython and pvserver, environment that they need)."""
    if (unpacked / "usr/bin/pvpython").exists():
        libraries = folder_of(f"{unpacked}/usr/lib/**/libvtkCommonCore*.so*")
        modules = folder_of(f"{unpacked}/usr/lib/**/dist-packages/paraview")
        return unpacked / "usr/bin", {"LD_LIBRARY_PATH": libraries, "PYTHONPATH": modules}
    installed = shutil.which("pvpython")
    if not installed:
        skip("ParaView is neither installed nor unpacked; resources/setup/unpack-paraview unpacks it")
    return pathlib.Path(installed).parent, {}


def with_display(command):
    if os.environ.get("DISPLAY"):
        return command
    if not shutil.which("xvfb-run"):
        skip("no display, and no xvfb-run for a virtual one")
    return ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24 -nolisten tcp -noreset", *command]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("script", type=pathlib.Path)
    parser.add_argument("--glint", required=True)
    parser.add_argument("--package", type=pathlib.Path, required=True)
    parser.add_argument("--paraview", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    options = parser.parse_args()
    if not list(options.package.glob("glint/_glint.*.so")):
        skip("the Python module glint was not built; it needs python3-dev, python3-numpy and pybind11-dev")
    bin_folder, needed = programs(options.paraview)
    work = pathlib.Path(tempfile.mkdtemp(prefix="glint_paraview_"))
    try:
        environment = {**os.environ, "HOME": str(work), "XDG_CONFIG_HOME": str(work / "config"), "PYTHONUSERBASE": str(work / "user"),
                       "PYTHONDONTWRITEBYTECODE": "1", "LIBGL_ALWAYS_SOFTWARE": "1", "QT_QPA_PLATFORM": "xcb"}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(options.package), needed.get("PYTHONPATH")]))
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, [needed.get("LD_LIBRARY_PATH"), os.environ.get("LD_LIBRARY_PATH")]))
        environment["GLINT_PVSERVER"] = str(bin_folder / "pvserver")
        subprocess.run(["/usr/bin/python3", options.source / "plugins/paraview/setup_paraview.py", "--mend-loader"], env=environment, check=True)
        (work / "out").mkdir()
        done = subprocess.run(with_display([str(bin_folder / "pvpython"), str(options.script), options.glint, str(options.source), str(work / "out")]),
                              env=environment, check=False)
        sys.exit(done.returncode)
    finally:
        shutil.rmtree(work, ignore_errors=True)


main()
