# SPDX-License-Identifier: BSD-3-Clause
"""What the checks of the audit share: how a line is declared, and how the program is run on synthetic scenes.

A check is a function with the decorator `line`. It gets a `Runner` and returns a `Result`: what was measured in a few words, and
whether the bound holds. It must survive any build, also an old one that knows neither a setting nor a key: a check that raises is
shown as "fails: ..." and does not hold.
"""
import dataclasses
import hashlib
import json
import math
import pathlib
import statistics
import subprocess

SPECS = pathlib.Path(__file__).parent / "specs"
LINES = []  # every declared line, in the order of declaration


@dataclasses.dataclass
class Result:
    figure: str  # what was measured, with units
    holds: bool


@dataclasses.dataclass
class Line:
    section: str  # of the issue, such as "1.2"; rows are sorted by it
    title: str
    bound: str  # what must hold, in words
    check: object


def line(section, title, bound):
    def declare(check):
        LINES.append(Line(section, title, bound, check))
        return check

    return declare


class Runner:
    """Runs one build of the program, with a scratch folder in which synthetic scenes are made once."""

    def __init__(self, glint, scratch, shared):
        self.program, self.scratch, self.shared = pathlib.Path(glint).resolve(), pathlib.Path(scratch), pathlib.Path(shared)
        self.scratch.mkdir(parents=True, exist_ok=True)

    def glint(self, *arguments, check=False, timeout=900, stdin=None):
        """Exit code, stdout and stderr of `glint ARGUMENTS`."""
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, input=stdin)
        if check and done.returncode != 0:
            raise RuntimeError((done.stderr.strip().splitlines() or ["exit code %d" % done.returncode])[-1])
        return done

    def spec(self, name, **changes):
        """A specification of docs/audit/specs with keys replaced; dots reach into objects and lists: `render.bits`, `lights.0.position`."""
        spec = json.loads((SPECS / (name + ".json")).read_text())
        for path, value in changes.items():
            *parents, last = path.split(".")
            node = spec
            for p in parents:
                node = node[int(p)] if isinstance(node, list) else node.setdefault(p, {})
            if isinstance(node, list):
                node[int(last)] = value
            elif value is None:
                node.pop(last, None)
            else:
                node[last] = value
        return spec

    def synth(self, spec):
        """Folder of the scene made from a specification (a dict), and of its exact contours in FOLDER/truth, one file per frame.

        The scene itself gives no contours, so that every command detects its own."""
        text = json.dumps(spec, sort_keys=True)
        folder = self.scratch / hashlib.sha256(text.encode()).hexdigest()[:16]
        if not (folder / "done").exists():
            folder.mkdir(exist_ok=True)
            (folder / "spec.json").write_text(text)
            self.glint("synth", folder / "spec.json", "-o", folder / "scene", check=True)
            self._separate_truth(folder / "scene")
            (folder / "done").write_text("")
        return folder / "scene"

    @staticmethod
    def _separate_truth(folder):
        scene = json.loads((folder / "scene.json").read_text())
        truth = folder / "truth"
        truth.mkdir(exist_ok=True)
        for frame in scene["frames"]:
            given = frame.pop("highlights", [])
            levels = sorted({h["level"] for h in given}, reverse=True)
            (truth / (frame["id"] + ".json")).write_text(json.dumps({"levels": {
                f"{q:.2f}": [{"closed": True, "points": h["contour"]} for h in given if h["level"] == q] for q in levels}}))
        (folder / "scene.json").write_text(json.dumps(scene))

    def evaluate(self, scene, *arguments, truth=True, timeout=1800):
        """The JSON of `glint evaluate`, scored against the exact contours; exit code 3 (no model answers) is an answer too."""
        more = ["--truth", scene / "truth"] if truth and (scene / "truth").is_dir() else []
        done = self.glint("evaluate", scene, *more, *arguments, "--json", "-", timeout=timeout)
        if done.returncode not in (0, 3) or not done.stdout.strip():
            raise RuntimeError((done.stderr.strip().splitlines() or ["exit code %d" % done.returncode])[-1])
        return json.loads(done.stdout)


def mean_error(evaluation, model):
    """Mean contour error of a model in percent of the diameter; nan where it did not answer every frame."""
    m = evaluation["models"][model]
    s = m["summary"]
    if m["status"] != "ok" or s["predicted"] != s["frames"] or s["missed"] or not s["frames"]:
        return math.nan
    return s["contour_error_pct"]["mean"]


def percent(value):
    return "no answer" if value is None or math.isnan(value) else f"{value:.3g} %"


def median(values):
    return statistics.median(values) if values else math.nan
