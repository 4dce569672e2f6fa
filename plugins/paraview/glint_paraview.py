# SPDX-License-Identifier: BSD-3-Clause
"""Glint in ParaView: a reader of sessions (*.glint) and scenes (scene.json), and a filter that predicts highlights on a mesh.

What is shown is made by glint_paraview_blocks.py with glint_paraview_vtk.py, which must lie in the same folder.

Load it under Tools > Manage Plugins, or with LoadPlugin("glint_paraview.py"); with a server, on the server. All numbers are those of the Python
module glint, which must be installed where the server runs. docs/paraview.md describes the blocks, arrays and units.

Frames are time steps: frame i is at time i; between two steps the earlier one is shown, beyond the ends the nearest. Lengths are in the scene's
world units (metres where its file says nothing else). Pixels are ideal ones, without lens distortion; (0, 0) is the centre of the first pixel.
"""
import collections
import importlib.util
import math
import os
import re
import sys
import threading
import weakref
from xml.sax.saxutils import quoteattr

import numpy as np
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smproperty, smproxy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArraySelection, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkMultiBlockDataSet, vtkPolyData, vtkTable
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
PARTS = ("Surface", "Cameras", "Lights", "Ellipsoids", "Training", "Photograph", "Observed", "Predicted")
NEED_INSPECTION = {"Lights", "Ellipsoids", "Training", "Observed", "Predicted"}


def _beside(name):
    """A module of the plugin's own folder, where ParaView does not look for modules."""
    spec = importlib.util.spec_from_file_location(name, os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where the next one finds it
    spec.loader.exec_module(module)
    return module


_beside("glint_paraview_vtk")
blocks = _beside("glint_paraview_blocks")


class Refused(Exception):
    """What was asked cannot be done; the text says why."""


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


def _inspected(given, models, train, level, settings, progress):
    key = (given, None if models is None else tuple(models), train, level, tuple(sorted(settings.items())))
    before = next((a.inspection for (i, *_), a in reversed(_inspections.items()) if i is given), None)

    def make():
        try:
            found = glint.inspect(given.session or given.scene, models, train=train or None, level=level or None, previous=before,
                                  progress=progress, **settings)
            return blocks.Answers(found, "", given.scene)
        except glint.CannotAnswer as error:
            if getattr(error, "inspection", None) is None:
                raise
            return blocks.Answers(error.inspection, str(error), given.scene)

    return _remembered(_inspections, key, make)


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
        middle, distance = blocks.middle_of(given.scene, surface)
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
        scene = answers.scene if answers else given.scene
        try:
            surface, lost = scene.surface(frame, **(answers.inspection.request.settings if answers else {})), None
        except glint.CannotAnswer as error:
            surface, lost = None, str(error)
            self.warn(f"frame {scene.frames[frame].id}: {lost}")
        middle, distance, depth = self.scale(given, surface)
        view = blocks.View(scene, frame, surface, depth, self.length("TangentPlaneSide"), answers.places[frame] if answers else np.eye(4))
        tree = self.tree(given, answers, parts, view, lost, middle, distance)
        root = vtkMultiBlockDataSet.GetData(outInfo, 0)
        blocks.fill(root, tree)
        blocks.note(root, **blocks.camera_numbers(scene, frame), warnings=list(self.messages))
        root.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), float(frame))
        table = vtkTable.GetData(outInfo, 1)
        if answers:
            blocks.errors(table, answers.inspection)
        else:
            blocks.note(table, reasons=["no part is ticked that needs models"])

    def tree(self, given, answers, parts, view, lost, middle, distance):
        scene, frame = view.scene, view.frame
        key = scene.frames[frame].surface
        train, held_out = (answers.inspection.train, answers.inspection.held_out) if answers else ((), ())
        makers = {
            "Surface": lambda: self.surface_block(given, view, lost, middle, distance),
            "Cameras": lambda: blocks.cameras(scene, frame, view.depth, set(train), set(held_out)),
            "Lights": lambda: blocks.lights(answers, frame, key, middle, distance),
            "Ellipsoids": lambda: blocks.ellipsoids(answers, frame, key) or {"none": blocks.empty("no model with an ellipsoid was asked for")},
            "Training": lambda: blocks.training(answers, view),
            "Photograph": lambda: self.photograph_block(view),
            "Observed": lambda: blocks.observed(answers, view),
            "Predicted": lambda: {m: blocks.predicted(answers, view, m) for m in answers.inspection.models}
                         or {"none": blocks.empty("no model was asked for: a scene names none; switch 'Session Models' off and tick some")},
        }
        return {name: makers[name]() for name in PARTS if name in parts}

    def photograph_block(self, view):
        try:
            return blocks.photograph(view.scene, view.frame, view.depth, self.given["LargestPhotographSide"])
        except glint.CannotAnswer as error:
            self.warn(f"frame {view.scene.frames[view.frame].id}: {error}")
            return blocks.empty(str(error))

    def surface_block(self, given, view, lost, middle, distance):
        if view.surface is None:
            return blocks.empty(lost)
        box = blocks.part_of(view.surface, middle, distance)
        if box:
            self.warn("the surface has no end; a part of it is drawn")
        cells = self.given["SurfaceCells"]
        frame = view.scene.frames[view.frame]
        key = (frame.surface or f"frame {view.frame}", frame.world_from_object.tobytes(), cells)
        if key not in given.tessellations:
            while len(given.tessellations) >= 64:  # surfaces of a sequence; each is small beside the surface that Glint keeps
                given.tessellations.pop(next(iter(given.tessellations)))
            given.tessellations[key] = blocks.triangles(view.surface, cells, box)
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
        self.meshes = collections.OrderedDict()  # by what they were made of

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

    def surface_of(self, data, settings, place):
        """The input as a surface of Glint in the coordinates `place` (4x4, from the world); the same one while nothing changes."""
        key = (data.GetMTime(), tuple(sorted((k, str(v)) for k, v in settings.items() if k.startswith("surface."))), place.tobytes())
        return _remembered(self.meshes, key, lambda: self.made_of(data, settings, place))

    def made_of(self, data, settings, place):
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
        return glint.mesh(blocks.moved(place, vtk_to_numpy(mesh.GetPoints().GetData())), ids,
                          None if normals is None else vtk_to_numpy(normals) @ place[:3, :3].T, **settings)

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
        surface, scene, place = self.surface_of(data, settings, np.eye(4)), answers.scene, answers.places[frame]
        middle, distance, depth = self.scale(given, surface)
        view = blocks.View(scene, frame, surface, depth, self.length("TangentPlaneSide"), place)
        out = self.predict(answers, view, model, settings, surface if view.still else self.surface_of(data, settings, np.linalg.inv(place)))
        key = scene.frames[frame].surface
        root = vtkMultiBlockDataSet.GetData(outInfo, 0)
        blocks.fill(root, {**out.tree(), "Ellipsoids": blocks.ellipsoids(answers, frame, key) or {"none": blocks.empty(f"{model} has no ellipsoid")},
                     "Lights": blocks.lights(answers, frame, key, middle, distance),
                     "Cameras": blocks.cameras(scene, frame, depth, set(answers.inspection.train), set(answers.inspection.held_out))})
        blocks.note(root, **blocks.camera_numbers(scene, frame), model=model, warnings=list(self.messages))
        root.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), float(frame))

    def predict(self, answers, view, model, settings, surface):
        """Asks every fit that serves this frame: of its surface where fits are of one, and of the lamps that are on where it says which. surface: in
        the coordinates of the fits."""
        out, asked = blocks.Predicted(view, model), view.scene.frames[view.frame]
        failures = []
        for f in blocks.fits_of(answers, model, asked.surface):
            if f.fit is None:
                failures.append(f"light {f.light}: {f.failure}")
                continue
            if asked.lights_on and f.light not in asked.lights_on:
                continue
            try:
                prediction = glint.predict(f.fit, answers.inspection.scene.frames[view.frame].camera, surface, **settings)
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
