#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/reality.md: one rung for each effect of real photographs, each model's error, and whether it says so when wrong.

  docs/make_reality.py                       runs what the cache lacks and writes the page
  docs/make_reality.py --only exact wood     runs rungs whose names contain one of the words; the others keep their results
  docs/make_reality.py --page                runs nothing and writes the page from the cache
  docs/make_reality.py --render              renders first what the cache lacks (needs Blender)

Scenes and results are kept in the cache, so that a run that was stopped goes on. A result older than the program is made again.
"""
import argparse
import json
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import time

DOCS = pathlib.Path(__file__).resolve().parent
ROOT = DOCS.parent
sys.path.insert(0, str(DOCS))
from reality import rungs, scenes, verdict  # noqa: E402

PAGE = DOCS / "reality.md"
MODELS = ("limit-angle", "reflectance", "auto")
LIMIT_S = 120  # of the processor, for one command
WALL = 4  # times that limit, for a machine that others load
MOST_SAID = 110  # characters of what the program said
GROUPS = ("shared", "computed", "rendered")


def program_time(glint):
    """When the program and its libraries were built last."""
    files = [glint, *glint.parent.parent.glob("lib/libglint*.so*")]
    return max(f.stat().st_mtime for f in files)


def limited(seconds):
    def inside():
        os.nice(10)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    return inside


def command_of(glint, scene, truth, rung, model):
    """The band takes several fits: the one of auto is that of the model which it chose, and is taken from that model's row."""
    band = [] if model == "auto" else ["--set", "predict.band=true"]
    return [str(glint), "evaluate", str(scene), "--source", "image", "--models", model, "--train", rung.train,
            "--truth", str(truth), *band, "--json", "-"]


def run(command, limit):
    """The record of one command: its document or its last words, its seconds of the processor, and whether it was stopped."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=limited(limit)) as child:
        try:
            out, err = child.communicate(timeout=WALL * limit)
        except subprocess.TimeoutExpired:
            child.kill()
            out, err = child.communicate()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    record = {"rc": child.returncode, "seconds": round(used, 1), "wall": round(time.monotonic() - start, 1), "limit": limit,
              "stopped": child.returncode in (-signal.SIGXCPU, -signal.SIGKILL)}
    try:
        record["document"] = json.loads(out)
    except ValueError:
        record["error"] = (err.strip().splitlines() or [f"exit code {child.returncode}"])[-1]
    return record


def write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    fresh = file.with_name(file.name + ".new")
    fresh.write_text(text)
    os.replace(fresh, file)


def result_file(cache, rung, model):
    return cache / "results" / re.sub(r"[^a-z0-9_-]+", "-", rung.name.lower()) / f"{model}.json"


def row_of(rung, model, records):
    found = alone(rung, model, records.get((rung.name, model)))
    if found.model and records.get((rung.name, found.model)):
        found.coverage = alone(rung, found.model, records[rung.name, found.model]).coverage
    return found


def alone(rung, model, record):
    if record is None:
        return verdict.Judgement(verdict.MISSING)
    if record["stopped"]:
        return verdict.Judgement(verdict.STOPPED, f"no answer in {record['limit']} s of the processor")
    if "document" not in record:
        return verdict.refusal([record["error"]], "")  # about the files or the command, not about the photographs
    return verdict.judged(record["document"], model, rung.causes, rung.border_pct)


def shown(text):
    """The first words, as plain text in a cell of a Markdown table."""
    text = " ".join(text.split())
    if len(text) > MOST_SAID:
        text = text[:MOST_SAID].rsplit(" ", 1)[0] + " …"
    return re.sub(r"([\\`*_<>\[\]|#])", r"\\\1", text)


def figure(value, unit=""):
    return "" if math.isnan(value) else f"{value:.3g}{unit}"


def cells(model, found, seconds):
    name = f"{model}: {found.model}" if found.model else model
    all_ = (found.matched, found.missed, found.spurious)
    counts = "/".join(map(str, all_)) if any(all_) else ""
    coverage = "" if math.isnan(found.coverage) else f"{100 * found.coverage:.0f} %"
    mark = f"**{found.verdict}**" if found.verdict == verdict.CONFIDENT else found.verdict
    error = [figure(found.error_pct, " %"), figure(found.error_px)]
    return [name, *error, counts, coverage, mark, shown(found.said), figure(seconds)]


def table(ladder, records):
    lines = ["| rung | effect | part | model | error | px | matched/missed/spurious | in the band | verdict | said | s |",
             "|---|---|---|---|---:|---:|---|---:|---|---|---:|"]
    for rung in ladder:
        part = f"open: {rung.later}" if rung.later else "**this issue**"
        if not any((rung.name, model) in records for model in MODELS):
            lines.append(f"| {rung.name} | {rung.effect} | {part} | | | | | | {verdict.MISSING} | | |")
            continue
        for k, model in enumerate(MODELS):
            record = records.get((rung.name, model))
            head = [rung.name, rung.effect, part] if k == 0 else ["", "", ""]
            row = cells(model, row_of(rung, model, records), record["seconds"] if record else math.nan)
            lines.append("| " + " | ".join(head + row) + " |")
    return "\n".join(lines) + "\n"


def confession(model, found):
    chosen = f" ({found.model})" if found.model else ""
    counts = f", {found.missed} missed, {found.spurious} invented" if found.missed + found.spurious else ""
    return f"{model}{chosen}: {figure(found.error_pct, ' %') or 'no highlight matched'}{counts}"


def summary(ladder, records):
    """How often each verdict was given, for each model, in rows of this issue and in others; then confident errors by name."""
    lines = ["| rows | model | " + " | ".join(verdict.VERDICTS) + " |", "|---|---|" + "---:|" * len(verdict.VERDICTS)]
    confident = []
    for own, name in ((True, "this issue"), (False, "open")):
        for model in MODELS:
            found = [(r, row_of(r, model, records)) for r in ladder if own == (not r.later)]
            counts = [sum(j.verdict == v for _, j in found) for v in verdict.VERDICTS]
            lines.append(f"| {name} | {model} | " + " | ".join(str(c) if c else "" for c in counts) + " |")
            confident += [f"- {name}: {r.name}, {confession(model, j)}" for r, j in found if j.verdict == verdict.CONFIDENT]
    errors = "Confident errors:\n\n" + "\n".join(confident) if confident else "There is no confident error."
    return "\n".join(lines) + "\n\n" + errors + "\n"


def write_page(ladders, records):
    text = PAGE.read_text()
    blocks = {"summary": summary([r for group in GROUPS for r in ladders[group]], records)}
    blocks.update({group: table(ladders[group], records) for group in GROUPS})
    for name, block in blocks.items():
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
        head, rest = text.split(begin)
        text = head + begin + block + end + rest.split(end, 1)[1]
    write(PAGE, text)


def read_records(cache, ladders):
    records = {}
    for group in GROUPS:
        for rung in ladders[group]:
            for model in MODELS:
                file = result_file(cache, rung, model)
                if file.exists():
                    records[rung.name, model] = json.loads(file.read_text())
    return records


def evaluate(arguments, rung, newest):
    """Runs the commands of one rung whose results are missing or older than the program."""
    files = {model: result_file(arguments.cache, rung, model) for model in arguments.models}
    due = [m for m, f in files.items() if arguments.fresh or not f.exists() or f.stat().st_mtime < newest]
    place = scenes.place(rung, arguments.data, arguments.cache) if due else None
    if due and place is None:
        print(f"{rung.name}: not rendered", flush=True)
        return
    for model in due:
        record = run(command_of(arguments.glint, *place, rung, model), arguments.limit)
        write(files[model], json.dumps(record))
        found = alone(rung, model, record)
        error = figure(found.error_pct, " %")
        print(f"{rung.name}, {model}: {error} {found.verdict}, {record['seconds']} s: {found.said[:150]}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", default=ROOT / "build/release/bin/glint", type=pathlib.Path)
    add = parser.add_argument
    add("--data", default=ROOT.parent / "shared/data", type=pathlib.Path, help="folder with exact, ladder and cycles")
    add("--cache", default=ROOT / "build/reality", type=pathlib.Path, help="scenes and results are kept here")
    add("--only", nargs="+", default=[""], metavar="RUNG", help="only rungs whose names contain one of these")
    add("--models", nargs="+", default=list(MODELS), choices=MODELS)
    add("--limit", default=LIMIT_S, type=int, metavar="S", help="seconds of the processor for one command")
    add("--fresh", action="store_true", help="run again what the cache has")
    add("--page", action="store_true", help="run nothing")
    add("--render", nargs="?", const="blender", metavar="BLENDER", help="render what the cache lacks, with this program")
    arguments = parser.parse_args()
    ladders = {"shared": rungs.shared(arguments.data), "computed": rungs.computed(), "rendered": rungs.rendered()}
    chosen = [r for g in GROUPS for r in ladders[g] if any(word in r.name for word in arguments.only)]
    if arguments.render:
        scenes.render(arguments.render, [r for r in chosen if r.render is not None], arguments.cache)
    if not arguments.page:
        newest = program_time(arguments.glint)
        for rung in chosen:
            evaluate(arguments, rung, newest)
    write_page(ladders, read_records(arguments.cache, ladders))


if __name__ == "__main__":
    main()
