# SPDX-License-Identifier: BSD-3-Clause
"""A server and a client: reader and filter run where the files are; the client gets the same numbers, warnings and errors."""
import os
import json
import socket
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import glint
import numpy as np
from host import PLUGIN, WORK, block, check, column, fetched, finish, load, of_points, same, session
from paraview.simple import Connect, Disconnect, Plane

PATIENCE = 120  # s until a server listens, whatever the machine's load


def main():
    with socket.socket() as probe:  # pvserver names port 11111 where it is given 0
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    log = open(WORK / "server.txt", "w+", encoding="utf-8")
    server = subprocess.Popen([os.environ["GLINT_PVSERVER"], f"--server-port={port}", "--force-offscreen-rendering"], stdout=log,
                              stderr=subprocess.STDOUT)
    try:
        for _ in range(PATIENCE * 10):
            if "Accepting connection" in (WORK / "server.txt").read_text() or server.poll() is not None:
                break
            time.sleep(0.1)
        check(server.poll() is None, f"the server listens: {(WORK / 'server.txt').read_text()}")
        Connect("localhost", port)
        load(globals(), remote=True)
        # The client's process must not compute: there, opening fails.
        glint.open = glint.inspect = None
        reader = GlintReader(FileName=session("plane"))
        reader.UpdatePipelineInformation()
        check(list(reader.TimestepValues) == [0, 1, 2, 3, 4, 5], f"frames of the server: {list(reader.TimestepValues)}")
        reader.UpdatePipeline(4.0)
        data, table = fetched(reader), fetched(reader, 1)
        sheet = Plane(Origin=[-0.5, -0.5, 0], Point1=[0.5, -0.5, 0], Point2=[-0.5, 0.5, 0])
        filtered = GlintPredictHighlights(Input=sheet, Session=session("plane"), Model="canonical")
        filtered.UpdatePipeline(4.0)
        drawn = block(fetched(filtered), "ContoursInImage")
        reader.FileName = str(WORK / "nowhere.glint")
        reader.UpdatePipeline(4.0)
        reader.UpdatePropertyInformation()
        check("nowhere.glint" in reader.GetPropertyValue("Messages"), "an error of the server reaches the client")
        Disconnect()
    finally:
        try:
            server.wait(timeout=20)
        except subprocess.TimeoutExpired:
            server.terminate()
            server.wait()
    # The numbers of the same session in another process.
    asked = ("import glint, json, sys; i = glint.inspect(glint.open(sys.argv[1])); print(json.dumps({m: [[h.contour.tolist() for h in c.prediction."
             "highlights] for c in r.frames if c.frame == 4] for m, r in i.models.items()}))")
    wanted = json.loads(subprocess.run(["/usr/bin/python3", "-c", asked, session("plane")], capture_output=True, text=True, check=True).stdout)
    compared = 0
    for model, frames in wanted.items():
        contours = [np.array(c) for f in frames for c in f]
        if contours:
            check(same(of_points(block(data, f"Predicted/{model}/ContoursInImage"), "pixel"), np.concatenate(contours)), f"{model}: contours of the server")
            compared += len(contours)
    check(compared >= 2, f"only {compared} contours")
    check(table.GetNumberOfRows() > 0 and np.isfinite(column(table, "contour_error_px canonical")).any(), "the table of errors")
    check(of_points(drawn, "pixel").shape[0] > 10, "the filter on the server")
    print(compared, "contours of the server equal those of Python")


main()
finish()
