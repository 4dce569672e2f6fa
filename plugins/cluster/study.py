#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A study: every scene with every model and every group of settings, one `glint evaluate` each, and one table of all results.

    study.py STUDY.json --engine local|snakemake|slurm -o DIR [-j N] [OPTION...]
                                     runs what is not done yet; results go to DIR. -j: tasks at once (default: one per core).
                                     Further options go to snakemake or sbatch
    study.py collect DIR -o FILE     the table, as .csv or .html: a row for each task, with those that failed or are missing
    study.py left DIR                numbers of the tasks that are not done, one per line
    study.py run DIR N               runs the N-th task (from 1) here: what the engines call

STUDY.json (paths relative to it; "settings" and "arguments" may be left out):

    {"glint_study": 1, "glint": "glint",
     "scenes": {"ellipsoid": "ellipsoid/scene.json", "vase": "vase/scene.json"},
     "models": ["limit-angle", "reflectance"],
     "settings": {"usual": [], "fine": ["predict.directions=72"]},
     "arguments": ["--train", "spread:6"]}

Exit codes: 0 all is done (also where the data cannot answer: the table says so); 1 a task ended with an error or is missing; 2 the study or the
call is wrong."""
import csv
import html
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

KEYS = {"glint_study", "glint", "scenes", "models", "settings", "arguments"}
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")  # of a scene, model or group: they become names of files
MOST_REPEATS = 2  # a task that fails three times fails for a reason of its own
ANSWERED = (0, 3)  # done: 3 says that the data cannot answer, which is a result of a study
FINAL = (0, 2, 3)  # the same would happen again
MOST_IN_ARRAY = 1000  # Slurm's MaxArraySize is 1001 by default
HERE = pathlib.Path(__file__).resolve().parent


class Wrong(Exception):
    """One line about the study or the call."""


def text_list(value, what):
    if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
        raise Wrong("%s: must be a list of texts" % what)
    return value


def read_json(file):
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Wrong("%s: %s" % (file, error)) from error


def write(file, text):
    """The whole file or nothing."""
    file.parent.mkdir(parents=True, exist_ok=True)
    temporary = file.with_name("%s.%d.part" % (file.name, os.getpid()))
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, file)


class Task:
    def __init__(self, folder, scene, model, group, command):
        self.scene, self.model, self.group, self.command = scene, model, group, command
        self.result = folder / scene / model / (group + ".json")
        self.done = self.result.with_suffix(".done")  # says which command made the result
        self.failed = self.result.with_suffix(".failed")

    def record(self, file):
        """What was written about this very command; None = nothing, or about another one."""
        try:
            record = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return record if isinstance(record, dict) and record.get("command") == self.command else None

    def run(self):
        self.result.parent.mkdir(parents=True, exist_ok=True)
        for file in (self.result, self.done, self.failed):  # of another command, or of a run that failed
            file.unlink(missing_ok=True)
        started = time.monotonic()
        ended = subprocess.run([*self.command, "--json", str(self.result)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               text=True,
                               errors="replace")
        lines = ended.stderr.strip().splitlines()
        record = {"command": self.command, "code": ended.returncode, "seconds": round(time.monotonic() - started, 3),
                  "message": lines[-1] if lines else ""}
        write(self.done if ended.returncode in ANSWERED else self.failed, json.dumps(record, indent=1) + "\n")
        return ended.returncode


class Study:
    """One whose paths are absolute: the content of DIR/study.json."""

    def __init__(self, document, folder):
        self.folder = folder
        self.tasks = []
        for scene, file in document["scenes"].items():
            for model in document["models"]:
                for group, settings in document["settings"].items():
                    command = [document["glint"], "evaluate", file, "--models", model, *document["arguments"]]
                    for setting in settings:
                        command += ["--set", setting]
                    self.tasks.append(Task(folder / "tasks", scene, model, group, command))

    def left(self):
        return [n for n, task in enumerate(self.tasks, 1) if not task.record(task.done)]


def checked(file):
    """The document of a study, with absolute paths."""
    document, folder = read_json(file), file.resolve().parent
    if not isinstance(document, dict) or document.get("glint_study") != 1:
        raise Wrong("%s: is no study: \"glint_study\": 1 is missing" % file)
    unknown = sorted(set(document) - KEYS)
    if unknown:
        raise Wrong("%s: %s: unknown key" % (file, unknown[0]))
    glint, scenes = document.get("glint", "glint"), document.get("scenes")
    if not isinstance(glint, str):
        raise Wrong("%s: glint: must be a text" % file)
    if not isinstance(scenes, dict) or not scenes or not all(isinstance(v, str) for v in scenes.values()):
        raise Wrong("%s: scenes: must name a file for each scene" % file)
    models = text_list(document.get("models"), "%s: models" % file)
    if not models or len(set(models)) != len(models):
        raise Wrong("%s: models: at least one, each once" % file)
    groups = document.get("settings", {"usual": []})
    if not isinstance(groups, dict) or not groups:
        raise Wrong("%s: settings: must have a list of KEY=VALUE for each name" % file)
    for name, settings in groups.items():
        text_list(settings, "%s: settings.%s" % (file, name))
    for name in [*scenes, *models, *groups]:
        if not NAME.fullmatch(name):
            raise Wrong("%s: %r: a name has letters, digits, and . _ - inside" % (file, name))
    return {"glint_study_folder": 1, "glint": str(folder / glint) if "/" in glint else glint,
            "scenes": {name: str(folder / scene) for name, scene in scenes.items()}, "models": models, "settings": groups,
            "arguments": text_list(document.get("arguments", []), "%s: arguments" % file)}


def opened(folder):
    document = read_json(folder / "study.json")
    if not isinstance(document, dict) or document.get("glint_study_folder") != 1:
        raise Wrong("%s: holds no results of a study" % folder)
    return Study(document, folder)


def prepared(file, folder):
    """The study in its folder; what an earlier one did there by another command is to be done again."""
    document = checked(file)
    if folder.exists() and any(folder.iterdir()):
        opened(folder)
    write(folder / "study.json", json.dumps(document, indent=1) + "\n")
    study = Study(document, folder)
    for task in study.tasks:
        if not task.record(task.done):
            task.done.unlink(missing_ok=True)  # Snakemake looks for the file alone
    return study


def run_local(study, jobs):
    threads = str(max(1, (os.cpu_count() or 1) // jobs))
    os.environ.setdefault("GLINT_THREADS", threads)

    left, stopped = study.left(), threading.Event()

    def attempt(number):
        for _ in range(1 + MOST_REPEATS):
            if stopped.is_set() or study.tasks[number - 1].run() in FINAL:
                break

    with ThreadPoolExecutor(jobs) as pool:
        try:
            for n, _ in enumerate(pool.map(attempt, left), 1):
                if sys.stderr.isatty():
                    print("\r%d of %d tasks" % (n, len(left)), end="" if n < len(left) else "\n", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            stopped.set()
            raise


def run_snakemake(study, jobs, options):
    subprocess.run(["snakemake", "-s", str(HERE / "Snakefile"), "--cores", str(jobs), "--keep-going", *options, "--config",
                    "study=" + str(study.folder)], cwd=study.folder)


def submit(study, options):
    """Arrays of Slurm with what is left, and a job that collects behind them. Names go by the environment: in an option list a comma would end
    them, in a command line a quote."""
    logs = study.folder / "logs"
    logs.mkdir(exist_ok=True)
    output = str(logs).replace("%", "%%")  # Slurm takes % in names of files as a pattern
    environment = {**os.environ, "STUDY": str(study.folder), "STUDY_PY": str(HERE / "study.py")}
    left, jobs = study.left(), []

    def sbatch(*arguments, **more):
        done = subprocess.run(["sbatch", "--parsable", "--export=ALL", *arguments], env={**environment, **more},
                              capture_output=True, text=True)
        if done.returncode:
            raise Wrong("sbatch: %s" % done.stderr.strip())
        return done.stdout.strip().split(";")[0]

    for at in range(0, len(left), MOST_IN_ARRAY):
        numbers = left[at:at + MOST_IN_ARRAY]
        chunk = logs / ("tasks-%d.txt" % (at // MOST_IN_ARRAY + 1))
        write(chunk, "".join("%d\n" % n for n in numbers))
        jobs.append(sbatch("--array=1-%d" % len(numbers), "--output=%s/%%A-%%a.txt" % output, *options,
                           str(HERE / "study.sbatch"),
                           STUDY_TASKS=str(chunk)))
        print("array %s: %d tasks" % (jobs[-1], len(numbers)))
    behind = ["--dependency=afterany:" + ":".join(jobs)] if jobs else []
    print("table %s: %s" % (sbatch("--job-name=glint-table", "--output=%s/table.txt" % output, *behind,
                                   "--wrap=python3 \"$STUDY_PY\" collect \"$STUDY\" -o \"$STUDY/table.csv\""),
                            study.folder / "table.csv"))


COLUMNS = ["scene", "model", "settings", "status", "reason", "frames", "predicted", "mean_pct", "median_pct", "p95_pct",
           "max_pct", "mean_px",
           "matched", "missed", "spurious", "iou", "predict_us", "seconds", "command"]


def row_of(task):
    row = dict.fromkeys(COLUMNS, "")
    row.update(scene=task.scene, model=task.model, settings=task.group, command=shlex.join(task.command))
    done, failed = task.record(task.done), task.record(task.failed)
    about = done or failed
    if not about:
        return {**row, "status": "missing", "reason": "it was not run"}
    row.update(status="failed", reason=about.get("message", ""), seconds=about.get("seconds", ""))
    if not done:
        return {**row, "reason": "exit code %s: %s" % (about.get("code"), row["reason"])}
    row["done"] = True
    try:
        model = json.loads(task.result.read_text(encoding="utf-8"))["models"][task.model]
        summary = model["summary"]
        error = summary["contour_error_pct"]
        row.update(status=model["status"], reason=model["reason"], frames=summary["frames"], predicted=summary["predicted"],
                   mean_pct=error["mean"], median_pct=error["median"], p95_pct=error["p95"], max_pct=error["max"],
                   mean_px=summary["contour_error_px"]["mean"], matched=summary["matched"], missed=summary["missed"],
                   spurious=summary["spurious"], iou=summary["iou"]["mean"], predict_us=summary["time_us"]["median"])
    except FileNotFoundError:
        pass  # the data could not answer, and the message says why
    except (OSError, ValueError, KeyError, TypeError) as wrong:
        row.update(done=False, reason="%s cannot be read: %r" % (task.result, wrong))
    return row


def text_of(value):
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return "%.6g" % value if isinstance(value, float) else str(value)


def without_formula(text):
    """A spreadsheet takes a cell that begins so for a formula; names and messages come from files of others."""
    return "'" + text if text[:1] in "=+-@\t\r" and len(text) > 1 and not re.fullmatch(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", text) else text


PAGE = """<!DOCTYPE html>
<meta charset="utf-8"><title>Study</title>
<style>body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}td,th{padding:2px 8px;text-align:left;border-bottom:1px solid #ccc}
td.number{text-align:right;font-variant-numeric:tabular-nums}tr.poor{color:#777}tr.failed,tr.missing{color:#a00}</style>
<h1>Study</h1><p>%s</p>
<table><tr>%s</tr>
%s</table>
"""


def page_of(rows):
    counts = {}
    for row in rows:
        counts[row["status"]] = counts.get(row["status"], 0) + 1
    columns = COLUMNS[:-1]
    lines = []
    for row in rows:
        cells = "".join("<td%s>%s</td>" % (" class=number" if isinstance(row[c], (int, float)) else "",
                                           html.escape(text_of(row[c])))
                        for c in columns)
        lines.append('<tr class="%s" title="%s">%s</tr>\n' % (html.escape(row["status"]), html.escape(row["command"]), cells))
    return PAGE % (html.escape("%d tasks: %s. Errors are mean contour errors of held-out frames." % (
        len(rows), ", ".join("%d %s" % (n, s) for s, n in sorted(counts.items())))),
                   "".join("<th>%s</th>" % c for c in columns), "".join(lines))


def collect(study, file):
    rows = [row_of(task) for task in study.tasks]
    if file.suffix == ".csv":
        lines = [COLUMNS] + [[without_formula(text_of(row[c])) for c in COLUMNS] for row in rows]
        temporary = file.with_name("%s.%d.part" % (file.name, os.getpid()))
        with open(temporary, "w", encoding="utf-8", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows(lines)
        os.replace(temporary, file)
    elif file.suffix == ".html":
        write(file, page_of(rows))
    else:
        raise Wrong("%s: a table is .csv or .html" % file)
    bad = [row for row in rows if not row.get("done")]
    for row in bad:
        print("%s, %s, %s: %s: %s" % (row["scene"], row["model"], row["settings"], row["status"], row["reason"]))
    print("%s: %d tasks, %d of them not done" % (file, len(rows), len(bad)))
    return 1 if bad else 0


def taken(arguments, option, default=None):
    """The value of an option, which is taken out of the list."""
    if option not in arguments:
        return default
    at = arguments.index(option)
    if at + 1 >= len(arguments):
        raise Wrong("%s: needs a value" % option)
    value = arguments[at + 1]
    del arguments[at:at + 2]
    return value


def whole_number(text, what, most):
    if not text.isdigit() or not 1 <= int(text) <= most:
        raise Wrong("%s %s: must be between 1 and %d" % (what, text, most))
    return int(text)


def start(arguments):
    file, engine, out = pathlib.Path(arguments.pop(0)), taken(arguments, "--engine"), taken(arguments, "-o")
    jobs = whole_number(taken(arguments, "-j", str(os.cpu_count() or 1)), "-j", 1000)
    if engine not in ("local", "snakemake", "slurm") or out is None:
        raise Wrong("expected --engine local|snakemake|slurm and -o DIR")
    if engine == "local" and arguments:
        raise Wrong("%s: unknown argument" % arguments[0])
    needed = {"snakemake": "snakemake", "slurm": "sbatch"}.get(engine)
    if needed and not shutil.which(needed):
        raise Wrong("%s is not installed" % needed)
    study = prepared(file, pathlib.Path(out).absolute())
    if engine == "slurm":
        submit(study, arguments)
        return 0
    if engine == "local":
        run_local(study, jobs)
    else:
        run_snakemake(study, jobs, arguments)
    return collect(study, study.folder / "table.csv")


def main(arguments):
    if not arguments or arguments[0] in ("-h", "--help"):
        print(__doc__)
        return 0 if arguments else 2
    arguments = list(arguments)
    try:
        if arguments[0] not in ("collect", "left", "run"):
            return start(arguments)
        what, out = arguments[0], taken(arguments, "-o")
        if len(arguments) != (3 if what == "run" else 2) or (out is None) != (what != "collect"):
            raise Wrong("%s: too few or too many arguments" % what)
        study = opened(pathlib.Path(arguments[1]).absolute())
        if what == "collect":
            return collect(study, pathlib.Path(out))
        if what == "left":
            print("".join("%d\n" % n for n in study.left()), end="")
            return 0
        code = study.tasks[whole_number(arguments[2], "task", len(study.tasks)) - 1].run()
        return 0 if code in ANSWERED else code
    except Wrong as error:
        print("study: %s" % error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("study: stopped; the same command goes on", file=sys.stderr)
        return 130
    except OSError as error:
        print("study: %s: %s" % (error.filename or "", os.strerror(error.errno) if error.errno else error), file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
