# SPDX-License-Identifier: BSD-3-Clause
"""Arrays and pieces of Glint's plugin for ParaView as VTK data. glint_paraview.py loads it from its own folder, for glint_paraview_blocks.py."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMultiBlockDataSet, vtkPolyData

UNITS = "lengths: world units of the scene, metres where its file says nothing else; pixels: ideal, (0, 0) is the centre of the first pixel"


def array(name, values):
    """A vtkDataArray or vtkStringArray with a copy of the values: Glint's arrays are views of memory that it may free."""
    if len(values) and isinstance(values[0], str):
        out = vtkStringArray()
        for text in values:
            out.InsertNextValue(text)
    else:
        given = np.asarray(values)
        given = given.astype(np.int32) if given.dtype.kind in "bi" and given.dtype != np.uint8 else given
        given = given.reshape(len(given), -1) if given.ndim > 1 else given
        out = numpy_to_vtk(np.ascontiguousarray(given), deep=True)
    out.SetName(name)
    return out


def vtk_points(coordinates):
    out = vtkPoints()
    out.SetDataTypeToDouble()
    out.SetData(numpy_to_vtk(np.ascontiguousarray(coordinates, dtype=np.float64).reshape(-1, 3), deep=True))
    return out


def vtk_cells(runs):
    offsets = np.concatenate([[0], np.cumsum([len(r) for r in runs])]).astype(np.int64)
    ids = np.concatenate(runs).astype(np.int64) if runs else np.zeros(0, np.int64)
    out = vtkCellArray()
    out.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(ids, deep=True))
    return out


def note(data, **fields):
    """Field data: texts, numbers and matrices (row by row). None is left out."""
    for name, value in fields.items():
        if value is None:
            continue
        if isinstance(value, (list, tuple)) and not value:
            continue
        data.GetFieldData().AddArray(array(name,
                                            [value] if np.ndim(value) == 0 else value if np.ndim(value) == 1
                                            else np.ravel(value)))
    return data


class Parts:
    """Pieces of one block: cells of one kind ("verts", "lines", "polys") with numbers and texts for every point and cell."""

    def __init__(self, kind):
        self.kind, self.points, self.cells, self.of_points, self.of_cells, self.reasons = kind, [], [], {}, {}, []
        self.count = 0

    def add(self, points, runs=None, of_points=None, **of_cells):
        """(n, 3) points; runs: lists of their indices, by default one cell of all; of_points: name -> n rows; of_cells: one value for each cell."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        runs = [np.arange(len(points))] if runs is None else [np.asarray(r) for r in runs]
        self.points.append(points)
        self.cells += [r + self.count for r in runs]
        self.count += len(points)
        for name, rows in (of_points or {}).items():
            self.of_points.setdefault(name, []).append(np.asarray(rows))
        for name, value in of_cells.items():
            self.of_cells.setdefault(name, []).extend([value] * len(runs))

    def missing(self, reason):
        self.reasons.append(reason)

    def data(self, **fields):
        out = vtkPolyData()
        out.SetPoints(vtk_points(np.concatenate(self.points) if self.points else np.zeros((0, 3))))
        if self.cells:
            {"verts": out.SetVerts, "lines": out.SetLines, "polys": out.SetPolys}[self.kind](vtk_cells(self.cells))
        for name, rows in self.of_points.items():
            joined = np.concatenate(rows)
            if len(joined) == self.count:  # else not every piece has it
                out.GetPointData().AddArray(array(name, joined))
                if name == "normals":
                    out.GetPointData().SetActiveNormals(name)
        for name, values in self.of_cells.items():
            if len(values) == len(self.cells):
                out.GetCellData().AddArray(array(name, values))
        return note(out, units=UNITS, reasons=list(dict.fromkeys(self.reasons)), **fields)


def fill(block, tree):
    """Named blocks from nested dictionaries."""
    for i, (name, part) in enumerate(tree.items()):
        if isinstance(part, dict):
            child = vtkMultiBlockDataSet()
            fill(child, part)
            part = child
        block.SetBlock(i, part)
        block.GetMetaData(i).Set(vtkMultiBlockDataSet.NAME(), name)
