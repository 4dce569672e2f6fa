# SPDX-License-Identifier: BSD-3-Clause
"""A state file, saved and loaded again, gives the same numbers. Without a view: a virtual display may start anew when its last window closes."""
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from host import SESSIONS, WORK, check, fetched, finish, leaves, load, points, session
from paraview.simple import FindSource, LoadState, PLYReader, RenameSource, ResetSession, SaveState

load(globals())


def numbers(source):
    data = fetched(source)
    return {name: points(leaf).tobytes() for name, leaf in leaves(data) if leaf is not None and leaf.GetPoints()}


def main():
    reader = GlintReader(FileName=session("plane"), ContourLevel=0.4, Directions=20, Parts=["Surface", "Observed", "Predicted"], CameraDepth=0.3,
                         SessionModels=0, Models=["canonical", "dual"], FurtherSettings="predict.band=true")
    RenameSource("mine", reader)
    mesh = PLYReader(FileNames=[str(SESSIONS / "vase/mesh/geom_00.ply")])
    filtered = GlintPredictHighlights(Input=mesh, Session=session("vase"), Model="canonical", Directions=16)
    RenameSource("predicted", filtered)
    before = []
    for source in reader, filtered:
        source.UpdatePipeline(3.0)
        before.append(numbers(source))
    check(set(name.split("/")[0] for name in before[0]) == {"Surface", "Observed", "Predicted"}, f"the parts that were ticked: {sorted(before[0])}")
    check({name.split("/")[1] for name in before[0] if name.startswith("Predicted")} == {"canonical", "dual"}, "the models that were ticked")
    check(len(before[1]["ContoursInImage"]) >= 16 * 24, "the filter has a contour")
    SaveState(str(WORK / "state.pvsm"))
    ResetSession()
    check(FindSource("mine") is None, "the session of ParaView is new")
    LoadState(str(WORK / "state.pvsm"))
    reader, filtered = FindSource("mine"), FindSource("predicted")
    check(abs(reader.ContourLevel - 0.4) < 1e-15 and reader.Directions == 20 and list(reader.Models) == ["canonical", "dual"], "properties of the reader")
    check(filtered.Model == "canonical" and filtered.Session == session("vase"), "properties of the filter")
    for source, wanted in zip((reader, filtered), before):
        source.UpdatePipeline(3.0)
        check(numbers(source) == wanted, "the numbers of the state")


def rights():
    """A scene that names a mesh outside of its folder: who allows it does so for this run of ParaView alone."""
    inside, outside = WORK / "inside", WORK / "outside"
    shutil.copytree(SESSIONS / "vase", inside)
    shutil.move(inside / "mesh", outside)
    scene = json.loads((inside / "scene.json").read_text())
    for surface in scene["surfaces"].values():
        surface["mesh"] = surface["mesh"].replace("mesh/", "../outside/")
    (inside / "scene.json").write_text(json.dumps(scene))
    reader = GlintReader(FileName=str(inside / "scene.json"), Parts=["Surface"])
    RenameSource("mine", reader)

    def said(source):
        source.UpdatePipeline(0.0)
        source.UpdatePropertyInformation()
        return source.GetPropertyValue("Messages")

    check("leaves the folder" in said(reader), f"a mesh outside is refused: {said(reader)}")
    reader.SMProxy.InvokeCommand("AllowFilesOutside")
    check("leaves the folder" not in said(reader) and numbers(reader), f"it is allowed: {said(reader)}")
    reader.FileName = session("plane")
    said(reader)
    reader.SMProxy.InvokeCommand("AllowFilesOutside")
    reader.FileName = str(inside / "scene.json")
    check("leaves the folder" in said(reader), "what was allowed of one file is not allowed of another")
    reader.SMProxy.InvokeCommand("AllowFilesOutside")
    check("leaves the folder" not in said(reader), "allowed again")
    state = WORK / "rights.pvsm"
    SaveState(str(state))
    # Whoever writes a state file may put any property into it.
    text = state.read_text()
    mark = text.index('<Property name="ContourLevel"')
    head = text[text.rindex("<Proxy ", 0, mark):mark]
    number = head[head.index('id="') + 4:].split('"')[0]
    granted = ('<Property name="AllowFilesOutside" id="%s.AllowFilesOutside" number_of_elements="1"><Element index="0" value="1"/></Property>'
               % number)
    (WORK / "granted.pvsm").write_text(text[:mark] + granted + text[mark:])
    for file in "rights.pvsm", "granted.pvsm":
        ResetSession()
        LoadState(str(WORK / file))
        check("leaves the folder" in said(FindSource("mine")), f"{file} grants nothing: {said(FindSource('mine'))}")


main()
ResetSession()
rights()
finish()
