# SPDX-License-Identifier: BSD-3-Clause
"""Glint in ParaView: a reader of sessions (*.glint) and scenes (scene.json), and a filter that predicts highlights on a mesh.

One file, longer than others of the project, because ParaView loads a Python plugin as one file and finds no modules beside it.

Load it under Tools > Manage Plugins, or with LoadPlugin("glint_paraview.py"); with a server, on the server. All numbers are those of the Python
module glint, which must be installed where the server runs. docs/paraview.md describes the blocks, arrays and units.

Frames are time steps: frame i is at time i; between two steps the earlier one is shown, beyond the ends the nearest. Lengths are in the scene's
world units (metres where its file says nothing else). Pixels are ideal ones, without lens distortion; (0, 0) is the centre of the first pixel.
"""
import collections
import math
import os
import re
import threading
import weakref
from xml.sax.saxutils import quoteattr

import numpy as np
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smproperty, smproxy
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArraySelection, vtkOutputWindow, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkDataObject, vtkMultiBlockDataSet, vtkPolyData, vtkStructuredGrid,
                                           vtkTable)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkParallelCore import vtkMultiProcessController

try:
    import glint
    _MISSING = ""
except ImportError as error:
    glint = None
    _MISSING = (f"the Python module glint cannot be loaded ({error}). Install Debian's package python3-glint, or set PYTHONPATH to the folder "
                "'python' of Glint's build before ParaView or its server starts")

paraview_plugin_name = "Glint"
paraview_plugin_version = glint.__version__ if glint else "0"

KEPT = 4  # scenes and inspections that stay in memory: a reader and a filter on two sessions, before and after a change
OFF_PLANE = 1e-3  # curves in the image lie this fraction of the depth before the photograph, so that they are not hidden in it
OUTLINE_STEPS = 8  # segments of a side of a frustum: a distorted lens bends it
ELLIPSE_STEPS = 72  # points of a drawn ellipse, one every 5 degrees
SPHERE_STEPS = 48  # meridians of a drawn ellipsoid
UNITS = "lengths: world units of the scene, metres where its file says nothing else; pixels: ideal, (0, 0) is the centre of the first pixel"
PARTS = ("Surface", "Cameras", "Lights", "Ellipsoids", "Training", "Photograph", "Observed", "Predicted")
NEED_INSPECTION = {"Lights", "Ellipsoids", "Training", "Observed", "Predicted"}
METRICS = ("contour_error_pct", "contour_error_px", "hausdorff_px", "iou", "centre_offset_px", "axis_ratio_error",
           "angle_error_deg",
           "peak_offset_px")


class Refused(Exception):
    """What was asked cannot be done; the text says why."""


# ---- what VTK takes ----------------------------------------------------------------------------------------------------------------------

def _array(name, values):
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


def _points(coordinates):
    out = vtkPoints()
    out.SetDataTypeToDouble()
    out.SetData(numpy_to_vtk(np.ascontiguousarray(coordinates, dtype=np.float64).reshape(-1, 3), deep=True))
    return out


def _cells(runs):
    offsets = np.concatenate([[0], np.cumsum([len(r) for r in runs])]).astype(np.int64)
    ids = np.concatenate(runs).astype(np.int64) if runs else np.zeros(0, np.int64)
    out = vtkCellArray()
    out.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(ids, deep=True))
    return out


def _note(data, **fields):
    """Field data: texts, numbers and matrices (row by row). None is left out."""
    for name, value in fields.items():
        if value is None:
            continue
        if isinstance(value, (list, tuple)) and not value:
            continue
        data.GetFieldData().AddArray(_array(name,
                                            [value] if np.ndim(value) == 0 else value if np.ndim(value) == 1
                                            else np.ravel(value)))
    return data


class _Parts:
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
        out.SetPoints(_points(np.concatenate(self.points) if self.points else np.zeros((0, 3))))
        if self.cells:
            {"verts": out.SetVerts, "lines": out.SetLines, "polys": out.SetPolys}[self.kind](_cells(self.cells))
        for name, rows in self.of_points.items():
            joined = np.concatenate(rows)
            if len(joined) == self.count:  # else not every piece has it
                out.GetPointData().AddArray(_array(name, joined))
                if name == "normals":
                    out.GetPointData().SetActiveNormals(name)
        for name, values in self.of_cells.items():
            if len(values) == len(self.cells):
                out.GetCellData().AddArray(_array(name, values))
        return _note(out, units=UNITS, reasons=list(dict.fromkeys(self.reasons)), **fields)


def _fill(block, tree):
    """Named blocks from nested dictionaries."""
    for i, (name, part) in enumerate(tree.items()):
        if isinstance(part, dict):
            child = vtkMultiBlockDataSet()
            _fill(child, part)
            part = child
        block.SetBlock(i, part)
        block.GetMetaData(i).Set(vtkMultiBlockDataSet.NAME(), name)


# ---- geometry ----------------------------------------------------------------------------------------------------------------------------

def _runs(kept, closed=True):
    """Index lists of the polylines that are left of a closed curve where kept[i] says whether the segment from i to i + 1 is drawn."""
    n = len(kept)
    if n < 2:
        return []
    kept = np.array(kept, dtype=bool)
    if not closed:
        kept[-1] = False
    if kept.all():
        return [np.append(np.arange(n), 0)]
    runs, start = [], int(np.flatnonzero(~kept)[0]) + 1
    run = []
    for step in range(n):
        i = (start + step) % n
        if kept[i]:
            run = run or [i]
            run.append((i + 1) % n)
        elif run:
            runs.append(np.array(run))
            run = []
    return runs


def _kept(n, gaps, valid):
    """Segments of a contour of n vertices without those that bridge a gap or end at an invalid vertex."""
    kept = np.array(valid, dtype=bool) & np.roll(valid, -1)
    for start, end in gaps:
        i = start
        while i != end:  # a gap's segments lie from its first vertex to its last
            kept[i] = False
            i = (i + 1) % n
    return kept


def _at_depth(camera, pixels, depth):
    """(n, 3) world points of ideal pixels at a depth along the optical axis."""
    axis = camera.camera_from_world[2, :3]
    directions = camera.directions(pixels)
    return camera.centre + directions * (depth / (directions @ axis))[:, None]


def _ideal(camera, measured):
    """Ideal pixels of measured ones; where the lens shows none, the measured ones themselves."""
    ideal = np.array(camera.undistort(measured))
    lost = ~np.isfinite(ideal).all(axis=1)
    ideal[lost] = np.asarray(measured)[lost]
    return ideal


def _border(camera):
    """(4 OUTLINE_STEPS, 2) ideal pixels around the image, from its top-left corner."""
    w, h = camera.width - 0.5, camera.height - 0.5
    corners = np.array([[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]])
    t = np.arange(OUTLINE_STEPS)[:, None] / OUTLINE_STEPS
    return _ideal(camera, np.concatenate([a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]))


def _frustum(camera, depth):
    """Points (the centre first) and lines of a camera."""
    around = _at_depth(camera, _border(camera), depth)
    n = len(around)
    return np.concatenate([camera.centre[None], around]), [np.append(np.arange(1, n + 1),
                                                                     1)] + [np.array([0, 1 + i * OUTLINE_STEPS]) for i in range(4)]


def _mirrored(plane, points):
    m = plane.reflection
    return points @ m[:3, :3].T + m[:3, 3]


def _on_plane(camera, plane, pixels):
    """World points where the rays of pixels meet a plane; those that do not meet it before the camera are left out."""
    directions = camera.directions(pixels)
    along = directions @ plane.normal
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -(camera.centre @ plane.normal + plane.offset) / along
    good = np.isfinite(t) & (t > 0)
    return camera.centre + directions[good] * t[good, None]


def _square(plane, middle, half, across):
    """Four corners on a plane around a point of it."""
    x = across - plane.normal * (across @ plane.normal)
    if np.linalg.norm(x) < 1e-6:  # the camera's right is along the normal: any other direction serves
        x = np.cross(plane.normal, np.eye(3)[np.argmin(np.abs(plane.normal))])
    x = x / np.linalg.norm(x)
    y = np.cross(plane.normal, x)
    return np.array([middle + half * (a * x + b * y) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def _ellipsoid(body):
    """Points, quads and normals of an ellipsoid."""
    v, u = np.meshgrid(np.linspace(0, np.pi, SPHERE_STEPS // 2 + 1), np.arange(SPHERE_STEPS) * 2 * np.pi / SPHERE_STEPS,
                       indexing="ij")
    unit = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1).reshape(-1, 3)
    pose, axes = body.world_from_ellipsoid, body.semi_axes
    normals = unit / np.maximum(axes, 1e-12 * axes.max()) @ pose[:3, :3].T
    i = (np.arange(SPHERE_STEPS // 2)[:, None] * SPHERE_STEPS + np.arange(SPHERE_STEPS)).reshape(-1, 1)
    j = (np.arange(SPHERE_STEPS // 2)[:, None] * SPHERE_STEPS + (np.arange(SPHERE_STEPS) + 1) % SPHERE_STEPS).reshape(-1, 1)
    quads = np.concatenate([i, i + SPHERE_STEPS, j + SPHERE_STEPS, j], axis=1)
    return (unit * axes) @ pose[:3, :3].T + pose[:3, 3], quads, normals / np.linalg.norm(normals, axis=1)[:, None]


# ---- inputs and inspections, shared by reader and filter -----------------------------------------------------------------------------------

def _stamp(path):
    """What changes when a file is written again."""
    try:
        s = os.stat(path)
        return s.st_mtime_ns, s.st_size, s.st_ino
    except OSError:
        return None


class _Input:
    """An opened session or scene."""

    def __init__(self, path, outside):
        opened = glint.open(path, allow_outside=outside)
        self.session = opened if isinstance(opened, glint.Session) else None
        self.scene = self.session.scene if self.session else opened
        self.warnings = list(dict.fromkeys([*(self.session.warnings if self.session else []), *self.scene.warnings]))
        self.stamps = {f: _stamp(f) for f in {path, self.scene.file} if f}
        self.tessellations = {}

    def unchanged(self):
        return all(_stamp(f) == stamp for f, stamp in self.stamps.items())


_inputs = collections.OrderedDict()
_inspections = collections.OrderedDict()


def _remembered(cache, key, make):
    if key not in cache:
        cache[key] = make()
    cache.move_to_end(key)
    while len(cache) > KEPT:
        cache.popitem(last=False)
    return cache[key]


def _opened(path, outside):
    if not glint:
        raise Refused(_MISSING)
    if vtkMultiProcessController.GetGlobalController() and vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses() > 1:
        raise Refused("runs on one process only; start pvserver without mpirun (Glint uses all cores of it)")
    if not path:
        raise Refused("no session (*.glint) or scene file is named")
    path = os.path.abspath(path)
    key = (path, bool(outside))
    if key in _inputs and not _inputs[key].unchanged():
        del _inputs[key]
    return _remembered(_inputs, key, lambda: _Input(path, bool(outside)))


def _settings_of(text):
    """'predict.band=true detect.min_area=20' -> dictionary."""
    out = {}
    for word in re.split(r"[\s,;]+", text.strip()):
        if not word:
            continue
        name, equals, value = word.partition("=")
        if not equals or not name or not value:
            raise Refused(f"FurtherSettings: expected name=value, not '{word}'")
        out[name] = value
    return out


class _Answers:
    """An inspection, with what is asked of it often."""

    def __init__(self, inspection, failure):
        self.inspection, self.failure = inspection, failure
        self.comparisons = collections.defaultdict(list)
        for model, result in inspection.models.items():
            for c in result.frames:
                self.comparisons[model, c.frame].append(c)


def _inspected(given, models, train, level, settings, progress):
    key = (given, None if models is None else tuple(models), train, level, tuple(sorted(settings.items())))
    before = next((a.inspection for (i, *_), a in reversed(_inspections.items()) if i is given), None)

    def make():
        try:
            found = glint.inspect(given.session or given.scene, models, train=train or None, level=level or None, previous=before,
                                  progress=progress, **settings)
            return _Answers(found, "")
        except glint.CannotAnswer as error:
            if getattr(error, "inspection", None) is None:
                raise
            return _Answers(error.inspection, str(error))

    return _remembered(_inspections, key, make)


# ---- blocks ------------------------------------------------------------------------------------------------------------------------------

def _colour(model):
    text = glint.model(model).colour
    return np.array([int(text[i:i + 2], 16) for i in (1, 3, 5)], np.uint8)


class _View:
    """One frame with its camera, surface and sizes of what is drawn."""

    def __init__(self, scene, frame, surface, depth, plane_size):
        self.scene, self.frame, self.surface, self.depth, self.plane_size = scene, frame, surface, depth, plane_size
        self.camera = scene.frames[frame].camera

    def hits(self, pixels):
        """(positions (n, 3), hit (n,)) of the rays through pixels."""
        if self.surface is None or len(pixels) == 0:
            return np.full((len(pixels), 3), np.nan), np.zeros(len(pixels), bool)
        found = self.surface.first_hits(self.camera.centre[None], self.camera.directions(pixels))
        return np.array(found.positions), np.array(found.hit)

    def draw_contour(self, image, on_surface, contour, gaps, of_points, **of_cells):
        """A contour into two blocks: at the photograph, and on the surface, as far as its rays meet it."""
        n = len(contour)
        of_points = {"pixel": contour, **of_points}
        every = np.ones(n, bool)
        image.add(_at_depth(self.camera, contour, self.depth * (1 - OFF_PLANE)), _runs(_kept(n, gaps, every)), of_points,
                  **of_cells)
        positions, hit = self.hits(contour)
        if not hit.any():
            on_surface.missing("no ray of a contour meets the surface")
            return 0.0
        runs = _runs(_kept(n, gaps, hit))
        if not hit.all():
            on_surface.missing(f"{n - int(hit.sum())} of {n} points of a contour miss the surface")
        positions[~hit] = positions[hit][0]  # no cell names them
        on_surface.add(positions, runs, of_points, **of_cells)
        return float(np.linalg.norm(positions[hit] - positions[hit].mean(axis=0), axis=1).max())

    def size_of(self, contour):
        if self.plane_size > 0:
            return self.plane_size / 2
        positions, hit = self.hits(contour)
        spread = np.linalg.norm(positions[hit] - positions[hit].mean(axis=0), axis=1).max() if hit.any() else 0.0
        return 2 * float(spread) if spread > 0 else self.depth / 4


def _draw_mirror(view, planes, cameras, camera, plane, point, contour, **of_cells):
    planes.add(_square(plane, point.position, view.size_of(contour), camera.camera_from_world[0, :3]),
               normal=plane.normal, offset=plane.offset, **of_cells)
    around, lines = _frustum(camera, view.depth)
    cameras.add(_mirrored(plane, around), lines, projection=camera.virtual(plane).ravel(), **of_cells)


def _draw_canonical(out, camera, plane, canonical, **of_cells):
    if canonical is None:
        out.missing("a highlight has no canonical contour")
        return
    points = np.array(canonical.on_tangent_plane)
    if len(points) > 1:
        out.add(points, [np.append(np.arange(len(points)), 0)], of="points", **of_cells)
    if canonical.ellipse is None:
        out.missing("the canonical contour of a highlight is no ellipse")
        return
    e = canonical.ellipse
    points = _on_plane(camera, plane, e.sample(ELLIPSE_STEPS))
    closed = [np.append(np.arange(len(points)), 0)] if len(points) == ELLIPSE_STEPS else [np.arange(len(points))]
    out.add(points, closed, of="ellipse", **of_cells)


def _training(answers, view):
    """Virtual cameras, tangent planes and canonical ellipses of the training highlights."""
    cameras, planes, ellipses, points = _Parts("lines"), _Parts("polys"), _Parts("lines"), _Parts("verts")
    for v in answers.inspection.views:
        where = {"frame": v.frame, "light": v.highlight.light}
        if v.tangent_plane is None:
            for block in cameras, planes, ellipses, points:
                block.missing(f"frame {answers.inspection.scene.frames[v.frame].id}: {v.failure or 'no tangent plane'}")
            continue
        try:
            surface = answers.inspection.scene.surface(v.frame)
        except glint.CannotAnswer:
            surface = None
        own = _View(answers.inspection.scene, v.frame, surface, view.depth, view.plane_size)
        _draw_mirror(own, planes, cameras, v.camera, v.tangent_plane, v.brightest_point, v.highlight.contour, **where)
        _draw_canonical(ellipses, v.camera, v.tangent_plane, v.canonical, **where)
        b = v.brightest_point
        points.add([b.position], None, {"normals": [b.normal], "pixel": [b.pixel], "alpha_deg": [math.degrees(b.alpha)]}, **where)
    return {"VirtualCameras": cameras.data(), "TangentPlanes": planes.data(), "CanonicalEllipses": ellipses.data(),
            "BrightestPoints": points.data()}


def _observed(answers, view):
    """What the frame itself shows: contours, brightest points, tangent planes, virtual cameras."""
    image, on_surface, points = _Parts("lines"), _Parts("lines"), _Parts("verts")
    planes, cameras = _Parts("polys"), _Parts("lines")
    evidence = answers.inspection.evidence[view.frame]
    if evidence.failure or not evidence.highlights:
        for block in image, on_surface, points, planes, cameras:
            block.missing(evidence.failure or "no highlight in this frame")
    for i, h in enumerate(evidence.highlights):
        where = {"light": h.light, "highlight": i, "level": h.level, "area_px2": h.area}
        view.draw_contour(image, on_surface, h.contour, [], {}, **where)
        seen = glint.TrainingView(view.camera, view.surface, h, view.frame)
        if seen.tangent_plane is None:
            for block in points, planes, cameras:
                block.missing(seen.failure or "no tangent plane")
            continue
        b = seen.brightest_point
        points.add([b.position], None, {"normals": [b.normal], "pixel": [b.pixel]}, **where)
        _draw_mirror(view, planes, cameras, view.camera, seen.tangent_plane, b, h.contour, **where)
    return {"ContoursInImage": image.data(), "ContoursOnSurface": on_surface.data(), "BrightestPoints": points.data(),
            "TangentPlanes": planes.data(), "VirtualCameras": cameras.data()}


class _Predicted:
    """Blocks of what one model predicts in one frame."""

    def __init__(self, view, model):
        self.view, self.model, self.colour = view, model, _colour(model)
        self.image, self.on_surface, self.points = _Parts("lines"), _Parts("lines"), _Parts("verts")
        self.planes, self.cameras, self.ellipses = _Parts("polys"), _Parts("lines"), _Parts("lines")

    def missing(self, reason):
        for block in self.image, self.on_surface, self.points, self.planes, self.cameras, self.ellipses:
            block.missing(reason)

    def add(self, light, highlight, index, metrics=None, matched=-1):
        where = {"light": light, "highlight": index, "coverage": highlight.coverage, "colour": self.colour}
        errors = {} if metrics is None and matched is None else {m: getattr(metrics, m) if metrics else math.nan for m in METRICS}
        numbers = {**where, **errors, **({} if matched is None else {"matches": matched})}
        sigma = np.array(highlight.sigma_px)
        self.view.draw_contour(self.image, self.on_surface, highlight.contour, highlight.gaps,
                               {"sigma_px": sigma} if len(sigma) == len(highlight.contour) else {}, **numbers)
        b = highlight.brightest_point
        self.points.add([b.position], None, {"normals": [b.normal], "pixel": [b.pixel], "alpha_deg": [math.degrees(b.alpha)]},
                        **where)
        if highlight.tangent_plane is None:
            for block in self.planes, self.cameras, self.ellipses:
                block.missing(f"{self.model} has no tangent planes")
            return
        _draw_mirror(self.view, self.planes, self.cameras, self.view.camera, highlight.tangent_plane, b, highlight.contour,
                     **where)
        _draw_canonical(self.ellipses, self.view.camera, highlight.tangent_plane, highlight.canonical, **where)

    def tree(self):
        named = {"model": self.model}
        return {"ContoursInImage": self.image.data(**named), "ContoursOnSurface": self.on_surface.data(**named),
                "BrightestPoints": self.points.data(**named), "TangentPlanes": self.planes.data(**named),
                "VirtualCameras": self.cameras.data(**named), "CanonicalEllipses": self.ellipses.data(**named)}


def _predicted(answers, view, model):
    out = _Predicted(view, model)
    for c in answers.comparisons[model, view.frame]:
        if c.prediction.failure:
            out.missing(f"light {c.light}: {c.prediction.failure}")
        for k, highlight in enumerate(c.prediction.highlights):
            row = next((r for r in c.rows if r.predicted == k), None)
            out.add(c.light, highlight, k, row.metrics if row else None, row.observed if row else -1)
    if not answers.comparisons[model, view.frame]:
        failed = [f"light {f.light}: {f.failure}" for f in answers.inspection.models[model].fits if f.failure]
        out.missing("; ".join(failed) or "this model has no prediction for this frame")
    return out.tree()


def _fits_of(answers, model, surface_key):
    return [f for f in answers.inspection.models[model].fits if f.surface is None or f.surface == surface_key]


def _ellipsoids(answers, surface_key):
    tree = {}
    for model in answers.inspection.models:
        for f in _fits_of(answers, model, surface_key):
            out, fit = _Parts("polys"), f.fit
            if fit is None:
                out.missing(f"{model}, light {f.light}: {f.failure}")
            elif fit.ellipsoid is None and fit.q_dual is None:
                continue  # a model without an ellipsoid
            elif fit.ellipsoid is None:
                out.missing(f"{model}, light {f.light}: its dual quadric is no ellipsoid")
            else:
                points, quads, normals = _ellipsoid(fit.ellipsoid)
                out.add(points, list(quads), {"normals": normals}, colour=_colour(model))
            numbers = {} if fit is None else dict(q_dual=fit.q_dual, gap_ratio=fit.gap_ratio, condition=fit.condition,
                                                  residual_px=fit.residual_px,
                                                  frames=fit.frames, solver=fit.solver, warnings=list(fit.warnings))
            if fit is not None and fit.ellipsoid is not None:
                numbers.update(centre=fit.ellipsoid.centre, semi_axes=fit.ellipsoid.semi_axes,
                               world_from_ellipsoid=fit.ellipsoid.world_from_ellipsoid)
            tree["-".join([model, f.light]
                          + ([f.surface] if f.surface else []))] = out.data(model=model, light=f.light, **numbers)
    return tree


def _draw_light(points, lines, middle, reach, light_id, homogeneous, **of_cells):
    """A light as a point, and a line to it from the object's middle; one at infinity at `reach` from there."""
    h = np.asarray(homogeneous, float)
    infinite = h[3] == 0
    place = middle + reach * h[:3] / np.linalg.norm(h[:3]) if infinite else h[:3] / h[3]
    points.add([place], light=light_id, at_infinity=int(infinite), homogeneous=h, **of_cells)
    lines.add([middle, place], light=light_id, at_infinity=int(infinite))


def _lights(answers, scene, frame, surface_key, middle, reach):
    estimated, true, lamps, lines = _Parts("verts"), _Parts("verts"), _Parts("verts"), _Parts("lines")
    tubes = _Parts("lines")
    for light, estimate in sorted(answers.inspection.lights(frame).items()):
        if isinstance(estimate, str):
            estimated.missing(f"light {light}: {estimate}")
            continue
        c = estimate.covariance
        c = np.full((3, 3), np.nan) if c is None else np.array(c)
        _draw_light(estimated, lines, middle, reach, light, estimate.light.homogeneous, covariance=c.ravel(),
                    sigma=np.sqrt(np.diag(c)),
                    limit_angle_deg=math.degrees(estimate.limit_angle), rms_px=estimate.rms_px, solver=estimate.solver)
    for model in answers.inspection.models:
        for f in _fits_of(answers, model, surface_key):
            if f.fit is None or f.fit.light_estimate is None:
                continue
            angle, radius = f.fit.limit_angle, f.fit.light_radius
            _draw_light(lamps, _Parts("lines"), middle, reach, f.light, f.fit.light_estimate.homogeneous, model=model,
                        colour=_colour(model),
                        limit_angle_deg=math.nan if angle is None else math.degrees(angle),
                        light_radius=math.nan if radius is None else radius)
            if f.fit.light_segment is not None:
                tubes.add(f.fit.light_segment, model=model, light=f.light)
    for light in scene.lights:
        if "segment" in light:
            tubes.add(light["segment"], model="truth", light=light["id"])
        place = light.get("position", light["segment"].mean(axis=0) if "segment" in light else None)
        h = np.append(light["direction"], 0) if place is None else np.append(place, 1)
        _draw_light(true, _Parts("lines"), middle, reach, light["id"], h, light_radius=light["radius"])
    if not scene.lights:
        true.missing("the scene states no true lights")
    return {"Estimated": estimated.data(), "OfModels": lamps.data(), "True": true.data(), "LongLamps": tubes.data(),
            "FromObject": lines.data()}


def _camera_numbers(scene, frame):
    """Field data of a frame: its camera, and what a ParaView view needs to look through it."""
    c = scene.frames[frame].camera
    pose = c.camera_from_world
    files = scene.frames[frame].files
    return dict(frame=frame, frame_id=scene.frames[frame].id, width_px=c.width, height_px=c.height, K_px=c.K,
                camera_from_world=pose,
                projection=c.projection, lens=c.model, distortion=c.distortion if np.any(c.distortion) else None,
                view_position=c.centre,
                view_focal_point=c.centre + pose[2, :3], view_up=-pose[1, :3],
                view_angle_deg=math.degrees(2 * math.atan2(c.height / 2, c.K[1, 1])),
                image=files.get("image") or files.get("radiance"), surface=scene.frames[frame].surface or None, units=UNITS)


def _cameras(scene, frame, depth, train, held_out):
    out = _Parts("lines")
    for i, f in enumerate(scene.frames):
        points, lines = _frustum(f.camera, depth)
        role = "training" if i in train else "held out" if i in held_out else "not used" if train or held_out else "unknown"
        out.add(points, lines, frame=i, frame_id=f.id, role=role, current=int(i == frame))
    now = _Parts("lines")
    now.add(*_frustum(scene.frames[frame].camera, depth))
    numbers = _camera_numbers(scene, frame)
    numbers.pop("units")
    return {"All": out.data(), "OfFrame": now.data(**numbers)}


def _photograph(scene, frame, depth, largest):
    """The photograph as cells of a grid at a depth before the camera, one cell a pixel, or a square of pixels averaged. CannotAnswer."""
    picture = np.array(scene.photograph(frame))
    picture = picture[..., None].repeat(3, axis=2) if picture.ndim == 2 else picture[..., :3]
    camera = scene.frames[frame].camera
    h, w = picture.shape[:2]
    step = max(1, math.ceil(max(h, w) / max(largest, 1)))
    rows, columns = np.arange(0, h, step), np.arange(0, w, step)
    sums = np.add.reduceat(np.add.reduceat(picture.astype(np.float64), rows, axis=0), columns, axis=1)
    share = np.outer(np.diff(np.append(rows, h)), np.diff(np.append(columns, w)))[..., None]
    rgb = np.clip(np.rint(255 * np.nan_to_num(sums / share)), 0, 255).astype(np.uint8)
    x, y = np.meshgrid(np.append(columns, w) - 0.5, np.append(rows, h) - 0.5)
    corners = np.stack([x.ravel() * camera.width / w, y.ravel() * camera.height / h],
                       axis=1) if (w, h) != (camera.width, camera.height) \
        else np.stack([x.ravel(), y.ravel()], axis=1)
    grid = vtkStructuredGrid()
    grid.SetDimensions(len(columns) + 1, len(rows) + 1, 1)
    grid.SetPoints(_points(_at_depth(camera, _ideal(camera, corners), depth)))
    colours = _array("photograph", rgb.reshape(-1, 3))
    grid.GetCellData().SetScalars(colours)
    numbers = _camera_numbers(scene, frame)
    return _note(grid, pixels_per_cell=step, **numbers)


def _empty(reason):
    out = _Parts("verts")
    out.missing(reason)
    return out.data()


def _errors(table, inspection):
    """One row per held-out highlight, with the columns of every model: the numbers of `glint evaluate --json`."""
    rows = collections.OrderedDict()
    models = list(inspection.models)
    held_out = set(inspection.held_out)
    for model in models:
        for c in inspection.models[model].frames:
            if c.frame not in held_out:
                continue
            for row in c.rows:
                if row.observed < 0:
                    continue
                rows.setdefault((c.frame, c.light, row.observed), {})[model] = (c, row)
    keys = sorted(rows)
    frames = inspection.scene.frames
    columns = [("frame", [k[0] for k in keys]), ("frame_id", [frames[k[0]].id for k in keys]), ("light", [k[1] for k in keys]),
               ("highlight", [k[2] for k in keys])]
    for model in models:
        found = [rows[k].get(model) for k in keys]
        for metric in METRICS:
            columns.append((f"{metric} {model}",
                            [math.nan if f is None or f[1].metrics is None else getattr(f[1].metrics, metric) for f in found]))
        columns.append((f"coverage {model}",
                        [math.nan if f is None or f[1].predicted < 0 else f[0].prediction[f[1].predicted].coverage
                         for f in found]))
        columns.append((f"reason {model}",
                        ["no prediction" if f is None else (f[1].failure or f[0].prediction.failure or "") for f in found]))
    for name, values in columns:
        if keys:
            table.AddColumn(_array(name, values))
    _note(table, units="px, percent (pct) of the observed equivalent diameter, degrees (deg); iou and coverage: 0 to 1; nan: not measured",
          models=models, reasons=None if keys else ["no held-out highlight was observed"])


# ---- properties --------------------------------------------------------------------------------------------------------------------------

class _Property:
    """One parameter: its XML, and the value that a setter keeps. ParaView makes the label of the name ("TrainingFrames": "Training Frames"), and
    Python's name of the label: a label of its own would rename the property there."""

    def __init__(self, kind, name, default, text, domain="", hints="", advanced=False):
        self.name, self.default = name, default
        shown = {True: "1", False: "0"}.get(default, default)
        self.xml = (f'<{kind}VectorProperty name="{name}" command="Set{name}" number_of_elements="1" '
                    f'default_values={quoteattr(str(shown))} panel_visibility="{"advanced" if advanced else "default"}">{domain}'
                    f'<Documentation>{quoteattr(text)[1:-1]}</Documentation>{"<Hints>" + hints + "</Hints>" if hints else ""}</{kind}VectorProperty>')


def _switch(name, default, text, **more):
    return _Property("Int", name, default, text, '<BooleanDomain name="bool"/>', **more)


def _whole(name, default, least, most, text, **more):
    return _Property("Int", name, default, text, f'<IntRangeDomain name="range" min="{least}" max="{most}"/>', **more)


def _number(name, default, least, most, text, **more):
    limits = f'min="{least}"' + ("" if most is None else f' max="{most}"')
    return _Property("Double", name, default, text, f'<DoubleRangeDomain name="range" {limits}/>', **more)


def _choice(name, default, values, text, **more):
    strings = "".join(f"<String value={quoteattr(v)}/>" for v in values)
    return _Property("String", name, default, text, f'<StringListDomain name="list">{strings}</StringListDomain>', **more)


def _ticks(name, text):
    """A list of names with check boxes; the class has Get<name>."""
    return (f'<StringVectorProperty name="{name}Info" command="Get{name}" number_of_elements_per_command="2" information_only="1" '
            f'si_class="vtkSIDataArraySelectionProperty"/><StringVectorProperty name="{name}" '
            f'information_property="{name}Info" command="Get{name}" number_of_elements_per_command="2" element_types="2 0" repeat_command="1" '
            f'si_class="vtkSIDataArraySelectionProperty"><ArraySelectionDomain name="array_list"><RequiredProperties><Property '
            f'function="ArrayList" name="{name}Info"/></RequiredProperties></ArraySelectionDomain><Documentation>{text}</Documentation>'
            f'</StringVectorProperty>')


def _setter(name):
    def set_value(self, value):
        value = "" if value is None or value == "None" else value
        if self.given.get(name) != value:
            self.given[name] = value
            self.Modified()
    return set_value


def _parameters(*properties):
    """Class decorator: properties in the order of the panel, with their setters."""
    def decorate(cls):
        cls.defaults = {p.name: p.default for p in properties if isinstance(p, _Property)}
        for name in cls.defaults:
            setattr(cls, "Set" + name, _setter(name))
        decorated = cls
        for p in properties:
            decorated = smproperty.xml(p.xml if isinstance(p, _Property) else p)(decorated)
        return decorated
    return decorate


_MODELS = [m.id for m in glint.models()] if glint else []
_FILES = '<FileListDomain name="files"/>'
_TIMES = ('<DoubleVectorProperty name="TimestepValues" command="GetTimestepValues" information_only="1" si_class="vtkSITimeStepsProperty" '
          'repeatable="1"><TimeStepsInformationHelper/><Documentation>One per frame: its index.</Documentation></DoubleVectorProperty>')
_SAID = ('<StringVectorProperty name="Messages" command="GetMessages" information_only="1"><Documentation>What was said of the last request, '
         'in words: an error first, then warnings.</Documentation></StringVectorProperty>')
_AGAIN = ('<Property name="ReadAgain" command="ReadAgain" panel_widget="command_button"><Documentation>Forget what was '
          'read and computed: photographs or meshes changed on the disk. A changed session or scene file is noticed without it.</Documentation></Property>')
# A button and no switch: a state file keeps and restores values, and whoever made it must not grant rights on this machine.
_OUTSIDE = ('<Property name="AllowFilesOutside" command="AllowFilesOutside" panel_widget="command_button" panel_visibility="advanced">'
            '<Documentation>From now on read files that this scene or session names outside of its own folder, until another file is chosen or '
            'ParaView ends. Without it such a path is refused. State files do not keep it.</Documentation></Property>')
_LEVEL = _number("ContourLevel", 0.0, 0, 1,
                 "Fraction of a highlight's peak above the background at which contours lie, more than 0 and "
                 "less than 1. 0: the session's, else 0.5.")
_DIRECTIONS = _whole("Directions", 0, 0, 3600,
                     "Directions from the brightest point in which a contour is predicted. 0: the session's.")
_SETTINGS = _Property("String", "FurtherSettings", "",
                      "As `glint evaluate --set` takes them, separated by blanks: predict.band=true "
                      "detect.min_area=20. `glint settings` lists them.", advanced=True)
_DEPTH = _number("CameraDepth", 0.0, 0, None,
                 "How far before a camera its photograph and the end of its frustum are drawn, world "
                 "units. 0: a seventh of the distance to the object.")
_PLANES = _number("TangentPlaneSide", 0.0, 0, None, "World units. 0: four times the highlight's radius.", advanced=True)


class _Algorithm(VTKPythonAlgorithmBase):
    """What reader and filter share: parameters, messages, frames as time steps."""
    defaults = {}

    def __init__(self, **ports):
        super().__init__(**ports)
        self.given = dict(self.defaults)
        self.messages = []
        self.spoken = set()
        self.trusted = None  # the input whose files may lie anywhere

    def GetMessages(self):
        return ["\n".join(self.messages)]

    def AllowFilesOutside(self):
        self.trusted = self.input_file()
        self.spoken.clear()
        self.Modified()

    def opened(self):
        path = self.input_file()
        return _opened(path, bool(path) and path == self.trusted)

    def ReadAgain(self):
        _inputs.clear()
        _inspections.clear()
        self.spoken.clear()
        self.Modified()

    def GetTimestepValues(self):
        try:
            return [float(i) for i in range(len(self.opened().scene.frames))]
        except Exception:  # the request that follows says what is wrong
            return None

    def warn(self, text):
        """Shown once: not again at every time step."""
        if text not in self.messages:
            self.messages.append(text)
        if text not in self.spoken:
            self.spoken.add(text)
            vtkOutputWindow.GetInstance().DisplayWarningText(f"Warning: Glint: {text}\n")

    def guarded(self, work, *arguments):
        """1 where the work was done, else 0, with an error in words."""
        try:
            work(*arguments)
            return 1
        except Exception as error:  # whatever happens, ParaView goes on
            told = isinstance(error, Refused) or (glint and isinstance(error, (glint.Error, ValueError, OSError)))
            text = str(error) if told else f"unexpected {type(error).__name__}: {error}"
        self.messages.insert(0, text)
        vtkOutputWindow.GetInstance().DisplayErrorText(f"Error: Glint: {text}\n")
        return 0

    def progress(self, stage, done, total):
        """Called from several threads; ParaView is told by its own only."""
        if threading.current_thread() is threading.main_thread():
            self.SetProgressText(stage)
            self.UpdateProgress(done / total if total else 0.0)
        return not self.GetAbortExecute()

    def level(self):
        level = self.given["ContourLevel"]
        if not (math.isfinite(level) and 0 <= level < 1):
            raise Refused(f"ContourLevel: must be more than 0 and less than 1 (0: the session's), not {level:g}")
        return level

    def settings(self):
        out = _settings_of(self.given["FurtherSettings"])
        if self.given["Directions"] != 0:
            out["predict.directions"] = str(self.given["Directions"])
        return out

    def length(self, name):
        value = self.given[name]
        if not (math.isfinite(value) and value >= 0):
            raise Refused(f"{name}: must be finite and not negative (0: automatic), not {value:g}")
        return value

    def RequestInformation(self, request, inInfo, outInfo):
        self.messages = []
        return self.guarded(lambda: self.publish_times(outInfo, self.opened()))

    def publish_times(self, outInfo, given):
        n = len(given.scene.frames)
        times = [float(i) for i in range(n)]
        for port in range(self.GetNumberOfOutputPorts()):
            info = outInfo.GetInformationObject(port)
            info.Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), times, n)
            info.Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), [times[0], times[-1]], 2)

    def frame_at(self, outInfo, given):
        n = len(given.scene.frames)
        for port in range(self.GetNumberOfOutputPorts()):
            info = outInfo.GetInformationObject(port)
            if info.Has(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()):
                time = info.Get(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP())
                if math.isnan(time):
                    self.warn("the time asked for is not a number; the first frame is shown")
                    return 0
                return int(math.floor(min(max(time, 0.0), n - 1) + 1e-9))  # times are whole; a sum of steps may be a little below
        return 0

    def scale(self, given, surface):
        """(middle of the object, distance of a camera to it, depth of frustums), world units."""
        centres = np.array([f.camera.centre for f in given.scene.frames])
        middle = None
        if surface is not None and np.isfinite(surface.bounds).all():
            middle = surface.bounds.mean(axis=0)
        if middle is None:  # where the first camera looks, as far as the cameras are apart
            c = given.scene.frames[0].camera
            middle = c.centre + c.camera_from_world[2, :3] * max(np.linalg.norm(centres - centres.mean(axis=0), axis=1).max(),
                                                                 1e-3)
        distance = float(np.median(np.linalg.norm(centres - middle, axis=1)))
        return middle, distance, self.length("CameraDepth") or max(distance / 7, 1e-9)


def _watched(names, owner, off=()):
    """A list with check boxes; a changed one asks its owner to run again."""
    out = vtkDataArraySelection()
    for name in names:
        out.AddArray(name, name not in off)
    reference = weakref.ref(owner)

    def changed(*_):
        if reference() is not None:
            reference().Modified()
    out.AddObserver("ModifiedEvent", changed)
    return out


def _ticked(selection):
    return [selection.GetArrayName(i) for i in range(selection.GetNumberOfArrays()) if selection.GetArraySetting(i)]


@smproxy.reader(name="GlintReader", label="Glint Reader", file_description="Glint sessions and scenes",
                filename_patterns="*.glint scene.json")
@_parameters(
    _Property("String", "FileName", "", "A session *.glint, a scene file, or a folder with a capture that Glint reads.", _FILES,
              '<FileChooser extensions="glint json" file_description="Glint sessions and scenes"/>'),
    _TIMES, _SAID,
    _ticks("Parts", "What is shown. Surface, Cameras and Photograph are read; the others are computed as `glint evaluate` does."),
    _switch("SessionModels", True, "The models that the session names (a scene: none). Off: those that are ticked below."),
    _ticks("Models", "Which models are fitted and predict, where they are not the session's."),
    _Property("String", "TrainingFrames", "", "first:6, spread:6, 0-5,14, per-surface. Empty: the session's."),
    _LEVEL, _DIRECTIONS, _SETTINGS,
    _whole("LargestPhotographSide", 1024, 1, 65536,
           "Cells, one a pixel. A larger photograph is averaged over squares of pixels."),
    _whole("SurfaceCells", 64, 1, 4096, "Along a side. Meshes stay as they are."),
    _DEPTH, _PLANES, _OUTSIDE, _AGAIN)
class GlintReader(_Algorithm):
    """Sessions and scenes as named blocks (port 0) and a table of errors (port 1)."""

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=2, outputType="vtkMultiBlockDataSet")
        self.parts = _watched(PARTS, self)
        self.models = _watched(_MODELS, self, off=("reflectance",))

    def GetParts(self):
        return self.parts

    def GetModels(self):
        return self.models

    def FillOutputPortInformation(self, port, info):
        info.Set(vtkDataObject.DATA_TYPE_NAME(), "vtkTable" if port == 1 else "vtkMultiBlockDataSet")
        return 1

    def input_file(self):
        return self.given["FileName"]

    def RequestData(self, request, inInfo, outInfo):
        self.messages = []
        return self.guarded(self.produce, outInfo)

    def inspected(self, given):
        models = _ticked(self.models)
        if self.given["SessionModels"]:
            models = None if given.session else []
        answers = _inspected(given, models, self.given["TrainingFrames"], self.level(), self.settings(), self.progress)
        if answers.failure and answers.inspection.request.models:
            self.warn(f"no model answered: {answers.failure}")
        for text in answers.inspection.warnings:
            self.warn(text)
        return answers

    def produce(self, outInfo):
        given = self.opened()
        for text in given.warnings:
            self.warn(text)
        parts = set(_ticked(self.parts))
        frame = self.frame_at(outInfo, given)
        answers = self.inspected(given) if parts & NEED_INSPECTION else None
        scene = answers.inspection.scene if answers else given.scene
        try:
            surface, lost = scene.surface(frame, **(answers.inspection.request.settings if answers else {})), None
        except glint.CannotAnswer as error:
            surface, lost = None, str(error)
            self.warn(f"frame {scene.frames[frame].id}: {lost}")
        middle, distance, depth = self.scale(given, surface)
        view = _View(scene, frame, surface, depth, self.length("TangentPlaneSide"))
        tree = self.tree(given, answers, parts, view, lost, middle, distance)
        root = vtkMultiBlockDataSet.GetData(outInfo, 0)
        _fill(root, tree)
        _note(root, **_camera_numbers(scene, frame), warnings=list(self.messages))
        root.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), float(frame))
        table = vtkTable.GetData(outInfo, 1)
        if answers:
            _errors(table, answers.inspection)
        else:
            _note(table, reasons=["no part is ticked that needs models"])

    def tree(self, given, answers, parts, view, lost, middle, distance):
        scene, frame = view.scene, view.frame
        key = scene.frames[frame].surface
        train, held_out = (answers.inspection.train, answers.inspection.held_out) if answers else ((), ())
        makers = {
            "Surface": lambda: self.surface_block(given, view, lost, middle, distance),
            "Cameras": lambda: _cameras(scene, frame, view.depth, set(train), set(held_out)),
            "Lights": lambda: _lights(answers, scene, frame, key, middle, distance),
            "Ellipsoids": lambda: _ellipsoids(answers, key) or {"none": _empty("no model with an ellipsoid was asked for")},
            "Training": lambda: _training(answers, view),
            "Photograph": lambda: self.photograph_block(view),
            "Observed": lambda: _observed(answers, view),
            "Predicted": lambda: {m: _predicted(answers, view, m) for m in answers.inspection.models}
                         or {"none": _empty("no model was asked for: a scene names none; switch 'Session Models' off and tick some")},
        }
        return {name: makers[name]() for name in PARTS if name in parts}

    def photograph_block(self, view):
        try:
            return _photograph(view.scene, view.frame, view.depth, self.given["LargestPhotographSide"])
        except glint.CannotAnswer as error:
            self.warn(f"frame {view.scene.frames[view.frame].id}: {error}")
            return _empty(str(error))

    def surface_block(self, given, view, lost, middle, distance):
        if view.surface is None:
            return _empty(lost)
        bounds, box = view.surface.bounds, {}
        if not np.isfinite(bounds).all():  # a plane has no end: as much of it as the cameras are away
            box = {"lower": np.where(np.isfinite(bounds[0]), bounds[0], middle - distance / 2),
                   "upper": np.where(np.isfinite(bounds[1]), bounds[1], middle + distance / 2)}
            self.warn("the surface has no end; a part of it is drawn")
        cells = self.given["SurfaceCells"]
        key = (view.scene.frames[view.frame].surface or f"frame {view.frame}", cells)
        if key not in given.tessellations:
            while len(given.tessellations) >= 64:  # surfaces of a sequence; each is small beside the surface that Glint keeps
                given.tessellations.pop(next(iter(given.tessellations)))
            mesh = view.surface.tessellate(cells, **box)
            out = _Parts("polys")
            normals = np.array(mesh.normals)
            out.add(mesh.vertices, [], {"normals": normals} if len(normals) == len(mesh.vertices) else {})
            data = out.data(surface=repr(view.surface))
            triangles = np.array(mesh.triangles, dtype=np.int64).reshape(-1, 3)
            cell_array = vtkCellArray()
            cell_array.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64), deep=True),
                               numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles.ravel()), deep=True))
            data.SetPolys(cell_array)
            given.tessellations[key] = data
        return given.tessellations[key]


@smproxy.filter(name="GlintPredictHighlights", label="Glint Predict Highlights")
@smproperty.xml('<InputProperty name="Input" command="SetInputConnection"><ProxyGroupDomain name="groups"><Group name="sources"/><Group name="filters"/>'
                '</ProxyGroupDomain><DataTypeDomain name="input_type"><DataType value="vtkPolyData"/></DataTypeDomain><Documentation>The surface on '
                'which highlights are predicted, in the world of the session.</Documentation></InputProperty>')
@_parameters(
    _Property("String", "Session", "", "Gives cameras, lamps and training photographs: a session *.glint, a scene file, or a folder "
              "with a capture.", _FILES, '<FileChooser extensions="glint json" file_description="Glint sessions and scenes"/>'),
    _TIMES, _SAID,
    _choice("Model", "limit-angle" if "limit-angle" in _MODELS or not _MODELS else _MODELS[-1], _MODELS or ["limit-angle"],
            "Fitted to the session's training frames on the session's own surface, then asked on this mesh."),
    _Property("String", "TrainingFrames", "", "first:6, spread:6, 0-5,14. Empty: the session's."),
    _LEVEL, _DIRECTIONS,
    _choice("Normals", "as the session says", ["as the session says", "facet", "interpolated", "curved"],
            "What stands for the mesh's normals: each triangle's own, those of the vertices, or those with the curvature that they imply."),
    _SETTINGS, _DEPTH, _PLANES, _OUTSIDE, _AGAIN)
class GlintPredictHighlights(_Algorithm):
    """Highlights that a model of a session predicts on a mesh of ParaView's pipeline, for the camera of the frame at the time."""

    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkPolyData", outputType="vtkMultiBlockDataSet")
        self.mesh = (None, None)  # what it was made of, surface

    def FillInputPortInformation(self, port, info):
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData")
        return 1

    def input_file(self):
        return self.given["Session"]

    def RequestData(self, request, inInfo, outInfo):
        self.messages = []
        return self.guarded(self.produce, inInfo, outInfo)

    def settings(self):
        out = super().settings()
        if self.given["Normals"] != "as the session says":
            out["surface.normals"] = self.given["Normals"]
        return out

    def surface_of(self, data, settings):
        """The input as a surface of Glint; the same one while neither changes."""
        key = (data.GetMTime(), tuple(sorted((k, str(v)) for k, v in settings.items() if k.startswith("surface."))))
        if self.mesh[0] == key:
            return self.mesh[1]
        triangles = vtkTriangleFilter()
        triangles.PassVertsOff()
        triangles.PassLinesOff()
        triangles.SetInputData(data)
        triangles.Update()
        mesh = triangles.GetOutput()
        if mesh.GetNumberOfPolys() == 0:
            raise Refused("the input has no triangles or polygons: a mesh is needed")
        ids = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        normals = mesh.GetPointData().GetNormals()
        surface = glint.mesh(vtk_to_numpy(mesh.GetPoints().GetData()), ids, None if normals is None else vtk_to_numpy(normals),
                             **settings)
        self.mesh = (key, surface)
        return surface

    def produce(self, inInfo, outInfo):
        given = self.opened()
        for text in given.warnings:
            self.warn(text)
        data = vtkPolyData.GetData(inInfo[0], 0)
        if data is None or data.GetNumberOfPoints() == 0:
            raise Refused("the input is empty: a mesh is needed")
        frame, model = self.frame_at(outInfo, given), self.given["Model"]
        answers = _inspected(given, [model], self.given["TrainingFrames"], self.level(), self.settings(), self.progress)
        if answers.failure:
            raise Refused(f"{model} cannot be fitted: {answers.failure}")
        for text in answers.inspection.warnings:
            self.warn(text)
        settings = answers.inspection.request.settings
        surface = self.surface_of(data, settings)
        scene = answers.inspection.scene
        middle, distance, depth = self.scale(given, surface)
        view = _View(scene, frame, surface, depth, self.length("TangentPlaneSide"))
        out = self.predict(answers, view, model, settings)
        key = scene.frames[frame].surface
        root = vtkMultiBlockDataSet.GetData(outInfo, 0)
        _fill(root, {**out.tree(), "Ellipsoids": _ellipsoids(answers, key) or {"none": _empty(f"{model} has no ellipsoid")},
                     "Lights": _lights(answers, scene, frame, key, middle, distance),
                     "Cameras": _cameras(scene, frame, depth, set(answers.inspection.train), set(answers.inspection.held_out))})
        _note(root, **_camera_numbers(scene, frame), model=model, warnings=list(self.messages))
        root.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), float(frame))

    def predict(self, answers, view, model, settings):
        """Asks every fit that serves this frame: of its surface where fits are of one, and of the lamps that are on where it says which."""
        out, asked = _Predicted(view, model), view.scene.frames[view.frame]
        failures = []
        for f in _fits_of(answers, model, asked.surface):
            if f.fit is None:
                failures.append(f"light {f.light}: {f.failure}")
                continue
            if asked.lights_on and f.light not in asked.lights_on:
                continue
            try:
                prediction = glint.predict(f.fit, view.camera, view.surface, **settings)
            except glint.CannotAnswer as error:
                failures.append(f"light {f.light}, frame {asked.id}: {error}")
                continue
            for k, highlight in enumerate(prediction.highlights):
                out.add(f.light, highlight, k, None, None)
        for text in failures:
            out.missing(text)
            self.warn(text)
        if not out.image.cells and not failures:
            text = f"no lamp that {model} was fitted to is on in frame {asked.id}"
            out.missing(text)
            self.warn(text)
        return out
