# SPDX-License-Identifier: BSD-3-Clause
"""What the tests that run in pvpython share. Arguments: GLINT, SOURCE (the project's folder), WORK (an empty folder)."""
import json
import pathlib
import subprocess
import sys

import numpy as np
from paraview import servermanager
from paraview.simple import LoadPlugin
from vtkmodules.util.numpy_support import vtk_to_numpy

PROGRAM, SOURCE, WORK = (pathlib.Path(a) for a in sys.argv[1:4])
PLUGIN = SOURCE / "plugins/paraview/glint_paraview.py"
SESSIONS = SOURCE / "sessions"
FAILED = []


def load(names, remote=False):
    LoadPlugin(str(PLUGIN), remote=remote, ns=names)


def session(name):
    return str(SESSIONS / name / f"{name}.glint")


def check(condition, words):
    if not condition:
        FAILED.append(words)
        print("FAILED:", words, flush=True)


def finish():
    sys.stdout.flush()
    if FAILED:
        sys.exit(f"{len(FAILED)} checks failed")
    print("passed", flush=True)


def fetched(source, port=0):
    return servermanager.Fetch(source, idx=port)


def block(data, path):
    """The block of a path such as "Predicted/canonical/ContoursInImage"; None if it is missing."""
    for name in path.split("/"):
        if data is None or not data.IsA("vtkMultiBlockDataSet"):
            return None
        data = next((data.GetBlock(i) for i in range(data.GetNumberOfBlocks()) if data.GetMetaData(i).Get(data.NAME()) == name), None)
    return data


def leaves(data, path=""):
    for i in range(data.GetNumberOfBlocks()):
        name = f"{path}/{data.GetMetaData(i).Get(data.NAME())}".strip("/")
        child = data.GetBlock(i)
        if child is not None and child.IsA("vtkMultiBlockDataSet"):
            yield from leaves(child, name)
        else:
            yield name, child


def values(array):
    """NumPy array, or a list of texts."""
    if array is None:
        return None
    if array.IsA("vtkStringArray"):
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array)


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def of_points(data, name):
    return values(data.GetPointData().GetAbstractArray(name))


def of_cells(data, name):
    return values(data.GetCellData().GetAbstractArray(name))


def field(data, name):
    return values(data.GetFieldData().GetAbstractArray(name))


def column(table, name):
    return values(table.GetColumnByName(name))


def evaluated(file, *arguments):
    """What the command line says."""
    out = WORK / "evaluation.json"
    subprocess.run([PROGRAM, "evaluate", file, "--json", out, *arguments], check=True, stdout=subprocess.DEVNULL)
    return json.loads(out.read_text())


def same(a, b):
    """To the last bit; what is not a number equals itself."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    return a.shape == b.shape and np.array_equal(a, b, equal_nan=True)
