# SPDX-License-Identifier: BSD-3-Clause
"""The Python module in the interpreter of another program: it loads there and says what the command line says, to the last bit.

  pvpython module_test.py GLINT SOURCE WORK        or in Blender, by run_blender.py"""
import json
import os
import pathlib
import subprocess
import sys


def main():
    program = os.environ.get("GLINT_PROGRAM") or sys.argv[1]
    source = pathlib.Path(os.environ.get("GLINT_ROOT") or sys.argv[2])
    sys.path.insert(0, str(pathlib.Path(program).parents[1] / "python"))
    try:
        import glint
    except ModuleNotFoundError as missing:
        print("skipped:", missing, flush=True)
        os._exit(77)
    import numpy

    session = source / "sessions/lessons/plane/plane.glint"
    done = subprocess.run([program, "evaluate", session, "--json", "-"], capture_output=True, text=True, check=True)
    theirs, ours = json.loads(done.stdout), glint.inspect(glint.open(session))
    errors = 0
    for name, model in theirs["models"].items():
        mine = [row.metrics.contour_error_px for c in ours.models[name].frames if c.frame in ours.held_out for row in c.rows if row.metrics]
        stated = [row["contour_error_px"] for row in model["frames"] if row["contour_error_px"] is not None]
        if mine != stated:
            sys.exit(f"{name}: {mine} here, {stated} by the command line")
        errors += len(stated)
    contour = ours.evidence[0].highlights[0].contour
    if errors < 4 or not isinstance(contour, numpy.ndarray) or contour.flags.writeable:
        sys.exit(f"{errors} errors compared; the contour is {type(contour)}")
    # What a host must not do in a process of its own: know the failures of the caller as something else.
    try:
        glint.open(source / "missing.glint")
        sys.exit("a missing session was opened")
    except glint.InputError:
        pass
    print(f"{pathlib.Path(sys.executable).name} imports glint {glint.__version__}: {errors} contour errors, the same to the last bit")
    print("glint test: all passed", flush=True)


main()
