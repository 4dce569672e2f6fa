#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""One session through every program that Glint works in: prints how many contour errors each gives, and whether they are those of the command
line, bit for bit. A program that is not there is named as missing.

make_hosts.py [--build build/release] [--session sessions/ellipsoid/ellipsoid.glint] [--only NAME ...]
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]


class Missing(Exception):
    """The program is not on this machine."""


def run(command, **options):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                          **options)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def errors_of(evaluation):
    """(model, frame, light, highlight) -> contour error, px, of `glint evaluate --json`."""
    return {(model, row["id"], row["light"], row["highlight"]): row["contour_error_px"]
            for model, answer in evaluation["models"].items() for row in answer["frames"] if row["contour_error_px"] is not None}


def printed(text):
    """The last line that is a JSON list of [model, frame, light, highlight, error]."""
    line = [line for line in text.splitlines() if line.startswith("[[")][-1]
    return {tuple(row[:4]): row[4] for row in json.loads(line)}


def command_line(job):
    run([job.glint, "evaluate", job.session, "--json", job.folder / "whole.json"])
    return errors_of(json.loads((job.folder / "whole.json").read_text()))


PYTHON = """
import json, sys, glint
inspection = glint.inspect(glint.open(sys.argv[1]))
held_out = set(inspection.held_out)
print(json.dumps([[m, inspection.scene.frames[c.frame].id, c.light, row.observed, row.metrics.contour_error_px]
                  for m, answer in inspection.models.items() for c in answer.frames if c.frame in held_out
                  for row in c.rows if row.metrics is not None]))
"""


def python(job):
    if not (job.build / "python/glint").is_dir():
        raise Missing("the module is not part of this build")
    return printed(run(["/usr/bin/python3", "-c", PYTHON, job.session],
                       env=dict(os.environ, PYTHONPATH=str(job.build / "python"))))


def cpp(job):
    prefix = job.folder / "prefix"
    run(["cmake", "--install", job.build, "--prefix", prefix])
    run(["cmake", "-S", ROOT / "resources/examples/cpp", "-B", job.folder / "cpp", f"-DCMAKE_PREFIX_PATH={prefix}",
         "-DCMAKE_BUILD_TYPE=Release"])
    run(["cmake", "--build", job.folder / "cpp", "--target", "session_errors"])
    rows = [line.split() for line in run([job.folder / "cpp/session_errors", job.session]).splitlines()]
    return {(model, frame, light, int(highlight)): float(error) for model, frame, light, highlight, error in rows}


PARAVIEW = """
import json, math, sys
from paraview import servermanager
from paraview.simple import LoadPlugin
LoadPlugin(sys.argv[2], remote=False, ns=globals())
reader = GlintReader(FileName=sys.argv[1])
reader.UpdatePipeline()
table = servermanager.Fetch(reader, idx=1)
column = lambda name: [table.GetValueByName(i, name) for i in range(table.GetNumberOfRows())]
found = []
for i in range(table.GetNumberOfColumns()):
    name = table.GetColumnName(i)
    if not name.startswith("contour_error_px "):
        continue
    for frame, light, highlight, error in zip(column("frame_id"), column("light"), column("highlight"), column(name)):
        if not math.isnan(error.ToDouble()):
            found.append([name.split()[1], frame.ToString(), light.ToString(), highlight.ToInt(), error.ToDouble()])
print(json.dumps(found))
"""


def paraview(job):
    if not (job.build / "python/glint").is_dir():
        raise Missing("the Python module is not part of this build")
    command, environment = None, dict(os.environ, PYTHONPATH=str(job.build / "python"))
    unpacked = ROOT / "build/hosts/paraview"  # resources/setup/unpack-paraview
    if shutil.which("pvpython"):
        command = [shutil.which("pvpython")]
    elif (unpacked / "usr/bin/pvpython").is_file():
        command = [unpacked / "usr/bin/pvpython"]
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(str(p) for p in unpacked.glob("usr/lib/*-linux-gnu"))
        environment["PYTHONPATH"] += os.pathsep + str(unpacked / "usr/lib/python3/dist-packages")
    if not command or not shutil.which("xvfb-run"):
        raise Missing("there is no pvpython, or no xvfb-run")
    script = job.folder / "in_paraview.py"
    # Debian's plugin loader asks for a function that Python 3.11 no longer has (docs/paraview.md).
    script.write_text("import inspect\nif not hasattr(inspect, 'getargspec'):\n    inspect.getargspec = inspect.getfullargspec\n"
                      + PARAVIEW)
    return printed(run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24 -noreset", *command, script, job.session,
                        ROOT / "plugins/paraview/glint_paraview.py"], env=environment))


BLENDER = """
import json, os, sys
sys.path.insert(0, os.path.join(os.environ["GLINT_ROOT"], "plugins", "blender"))
import addon_utils, bpy
addon_utils.enable("glint_blender", default_set=True)
bpy.context.preferences.addons["glint_blender"].preferences.program = os.environ["GLINT_PROGRAM"]
bpy.ops.glint.import_scene(filepath=os.environ["GLINT_SCENE"])
settings = bpy.context.scene.glint
settings.folder = os.environ["GLINT_FOLDER"]
settings.models = set(os.environ["GLINT_MODELS"].split(","))
settings.training, settings.count = "SPREAD", 6
bpy.ops.glint.run()
evaluation = json.load(open(os.path.join(os.environ["GLINT_FOLDER"], "evaluation.json")))
shown = {(m, f.frame_id): f.of_model(m).get("px") for f in settings.frames for m in settings.models if f.of_model(m).get("role") == "held out"}
print(json.dumps([[m, row["id"], row["light"], row["highlight"], shown[m, row["id"]]] for m, a in evaluation["models"].items() for row in a["frames"]
                  if shown.get((m, row["id"])) is not None]))
"""


def blender(job):
    if not shutil.which("blender"):
        raise Missing("there is no blender")
    script = job.folder / "in_blender.py"
    script.write_text(BLENDER)
    # The add-on asks its own question, of the scene; so the command line answers that one, too.
    scene, models = job.session.parent / "scene.json", ",".join(json.loads(job.session.read_text())["request"]["models"])
    run([job.glint, "evaluate", scene, "--models", models, "--train", "spread:6", "--json", job.folder / "asked.json"])
    environment = dict(os.environ, GLINT_ROOT=str(ROOT), GLINT_SCENE=str(scene), GLINT_MODELS=models,
                       GLINT_PROGRAM=str(job.glint), GLINT_FOLDER=str(job.folder / "blender"),
                       BLENDER_USER_RESOURCES=str(job.folder / "user"), PYTHONDONTWRITEBYTECODE="1",
                       PATH=os.pathsep.join(["/usr/bin", "/bin", os.environ.get("PATH", "")]))
    found = printed(run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", script], env=environment,
                        stdin=subprocess.DEVNULL))
    return found, errors_of(json.loads((job.folder / "asked.json").read_text()))


HOSTS = {"python": ("Python", python), "cpp": ("C++ program, `find_package(Glint)`", cpp),
         "paraview": ("ParaView, table of errors", paraview), "blender": ("Blender, errors per frame", blender)}


class Job:
    def __init__(self, build, session, folder):
        self.build, self.session, self.folder = build.resolve(), session.resolve(), folder
        self.glint = self.build / "bin/glint"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--session", type=pathlib.Path, default=ROOT / "sessions/ellipsoid/ellipsoid.glint")
    parser.add_argument("--only", nargs="+", choices=list(HOSTS), default=list(HOSTS))
    options = parser.parse_args()
    different = False
    with tempfile.TemporaryDirectory(prefix="glint_hosts_") as name:
        job = Job(options.build, options.session, pathlib.Path(name))
        reference = command_line(job)
        print("| program | contour errors | the same to the last bit | largest difference, px |\n|---|---|---|---|")
        print(f"| command line, `glint evaluate --json` | {len(reference)} | | |")
        for host in options.only:
            title, ask = HOSTS[host]
            expected = reference
            try:
                found = ask(job)
                if isinstance(found, tuple):
                    found, expected = found
            except Missing as missing:
                print(f"| {title} | missing: {missing} | | |")
                continue
            same = sum(found.get(key) == value for key, value in expected.items())
            largest = max((abs(found[key] - value) for key, value in expected.items() if key in found), default=float("nan"))
            print(f"| {title} | {len(found)} | {same} of {len(expected)} | {largest:.3g} |", flush=True)
            different |= found != expected
    sys.exit(1 if different else 0)


main()
