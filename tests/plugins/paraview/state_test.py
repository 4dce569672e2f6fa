# SPDX-License-Identifier: BSD-3-Clause
"""A state file, saved and loaded again, gives the same numbers. Without a view: a virtual display may start anew when its last window closes."""
import os
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


main()
finish()
