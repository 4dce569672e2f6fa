# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be done is refused in words, ParaView goes on, and the next good request is answered."""
import math
import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from host import SESSIONS, WORK, block, check, fetched, field, finish, leaves, load, of_cells, points, session
from paraview.simple import Delete, Plane, PointSource, Sphere, Transform

load(globals())


def messages(source):
    source.UpdatePropertyInformation()
    return source.GetPropertyValue("Messages")


def refused(source, words, what, time=0.0):
    source.UpdatePipeline(time)
    said = messages(source)
    check(words in said, f"{what}: expected '{words}', said '{said}'")
    data = fetched(source)
    drawn = [] if data is None else [name for name, leaf in leaves(data) if leaf is not None and leaf.GetNumberOfPoints()]
    check(not drawn, f"{what}: there is an answer all the same: {drawn}")


def answered(source, what, time=0.0):
    source.UpdatePipeline(time)
    data = fetched(source)
    check(data.GetNumberOfBlocks() > 3, f"{what}: no answer, but '{messages(source)}'")
    return data


def files():
    reader = GlintReader(FileName="")
    refused(reader, "no session", "an empty name")
    reader.FileName = str(WORK / "nowhere.glint")
    refused(reader, "nowhere.glint", "a missing file")
    (WORK / "empty").mkdir()
    reader.FileName = str(WORK / "empty")
    refused(reader, "empty", "a folder with nothing in it")
    copy = WORK / "plane"
    shutil.copytree(SESSIONS / "plane", copy)
    mine = copy / "plane.glint"
    text = mine.read_text()
    reader.FileName = str(mine)
    answered(reader, "a copied session")
    for name, content in (("cut.glint", text[:len(text) // 2]), ("bytes.glint", "\x00\x01" * 50), ("list.glint", "[]"), ("newer.glint", text.replace(
            '"glint_session": 3', '"glint_session": 99'))):
        (copy / name).write_text(content)
        reader.FileName = str(copy / name)
        refused(reader, name, name)
    reader.FileName = str(mine)
    answered(reader, "the good session after bad ones")
    os.rename(copy / "scene.json", copy / "gone.json")
    Delete(reader)
    reader = GlintReader(FileName=str(mine))
    reader.SMProxy.InvokeCommand("ReadAgain")
    refused(reader, "scene.json", "a session whose scene is gone")
    os.rename(copy / "gone.json", copy / "scene.json")
    os.remove(sorted((copy / "frames").iterdir())[0])
    reader.SMProxy.InvokeCommand("ReadAgain")
    reader.UpdatePipeline(0.0)
    check(messages(reader) != "", "a photograph that is gone is named")


def times():
    reader = GlintReader(FileName=session("plane"), Parts=["Cameras"])
    for time, frame in ((0.0, 0), (2.0, 2), (2.5, 2), (2.9999999999, 3), (5.0, 5), (6.0, 5), (1e300, 5), (-1e300, 0), (math.inf, 5), (-math.inf, 0)):
        data = None
        reader.UpdatePipeline(time)
        data = fetched(reader)
        check(field(data, "frame")[0] == frame, f"time {time}: frame {field(data, 'frame')}")
        now = of_cells(block(data, "Cameras/All"), "current")
        check(now.sum() == 5 and now.argmax() == 5 * frame, f"time {time}: the current camera")


def parameters():
    reader = GlintReader(FileName=session("plane"))
    for name, value, words in (("ContourLevel", 1.5, "ContourLevel"), ("ContourLevel", math.nan, "ContourLevel"), ("ContourLevel", -1.0, "ContourLevel"),
                               ("Directions", 1, "predict.directions"), ("Directions", -5, "predict.directions"), ("FurtherSettings", "fast", "name=value"),
                               ("FurtherSettings", "no.such=1", "no.such"), ("TrainingFrames", "0-99", "--train"), ("CameraDepth", math.nan, "CameraDepth"),
                               ("CameraDepth", -1.0, "CameraDepth"), ("TangentPlaneSide", math.inf, "TangentPlaneSide")):
        before = reader.GetPropertyValue(name)
        setattr(reader, name, value)
        refused(reader, words, f"{name} = {value}")
        setattr(reader, name, before)
    answered(reader, "after refused parameters")
    reader.TrainingFrames = "0"
    reader.UpdatePipeline(3.0)
    reasons = [r for name, leaf in leaves(fetched(reader)) for r in (field(leaf, "reasons") or []) if name.startswith("Predicted")]
    check(any("too few" in r for r in reasons) and "too few" in messages(reader), f"one training frame: the reason is there: {set(reasons)}")


def a_scene_without_models():
    reader = GlintReader(FileName=str(SESSIONS / "plane/scene.json"))
    data = answered(reader, "a scene")
    reasons = field(block(data, "Predicted/none"), "reasons")
    check(reasons and "Session Models" in reasons[0], f"a scene says how to get models: {reasons}")
    check(block(data, "Observed/ContoursInImage").GetNumberOfPoints() > 10, "a scene shows what is observed")


def meshes():
    cloud = PointSource(NumberOfPoints=10)
    refused(GlintPredictHighlights(Input=cloud, Session=session("plane")), "mesh is needed", "points without triangles")
    ball = Sphere()
    refused(GlintPredictHighlights(Input=ball, Session=""), "no session", "a filter without a session")
    lost = GlintPredictHighlights(Input=ball, Session=str(WORK / "nowhere.glint"))
    refused(lost, "nowhere.glint", "a filter with a missing session")
    far = Transform(Input=Sphere())
    far.Transform.Translate = [0, 0, 500]
    away = GlintPredictHighlights(Input=far, Session=session("plane"), Model="canonical")
    away.UpdatePipeline(4.0)
    reasons = field(block(fetched(away), "ContoursInImage"), "reasons")
    check(bool(reasons) and reasons[0] in messages(away), f"a mesh that no camera sees: {reasons}")
    sheet = Plane(Origin=[-0.5, -0.5, 0], Point1=[0.5, -0.5, 0], Point2=[-0.5, 0.5, 0], XResolution=4, YResolution=4)
    good = GlintPredictHighlights(Input=sheet, Session=session("plane"), Model="canonical")
    check(block(answered(good, "a plane of ParaView", 4.0), "ContoursInImage").GetNumberOfPoints() > 10, "a contour on ParaView's own plane")
    check(points(block(fetched(good), "ContoursOnSurface"))[:, 2].ptp() < 1e-9, "it lies in that plane")


files()
times()
parameters()
a_scene_without_models()
meshes()
finish()
