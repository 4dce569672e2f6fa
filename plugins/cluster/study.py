#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A study: every scene with every model, each in shards, then merged. Any engine runs it: Slurm (study.sbatch), Snakemake (Snakefile), or a loop.

    study.py STUDY.json count            number of shards of all scenes and models
    study.py STUDY.json list             one line for each: number, scene, model, shard
    study.py STUDY.json run N            computes the N-th (from 1), which writes its part as a whole or not at all
    study.py STUDY.json left             numbers whose part is not there yet, as Slurm's --array takes them ("3,7-9"); "" = none
    study.py STUDY.json merge            merges what is complete, and prints a line for each scene and model
    study.py STUDY.json cost             seconds that the shards took, from the parts that are there, and what the whole study takes

STUDY.json (paths relative to it; JSON is YAML, so Snakemake reads it as well):

    {"glint_study": 1, "glint": "glint", "out": "results", "shards": 4,
     "scenes": {"ellipsoid": "ellipsoid/scene.json"}, "models": ["limit-angle", "reflectance"],
     "arguments": ["--train", "spread:6"]}

Exit codes: 0 done; 1 something is missing or failed; 2 the study or the call is wrong."""
import json
import os
import pathlib
import re
import subprocess
import sys
import time

KEYS = {"glint_study", "glint", "out", "shards", "scenes", "models", "arguments"}
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")  # of a scene or model: they become names of files
MOST_SHARDS = 10000  # as glint


class Wrong(Exception):
    """One line about the study or the call."""


def text_list(value, what):
    if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
        raise Wrong("%s: must be a list of texts" % what)
    return value


class Study:
    def __init__(self, file):
        self.file = pathlib.Path(file).resolve()
        try:
            document = json.loads(self.file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise Wrong("%s: %s" % (file, error)) from error
        if not isinstance(document, dict) or document.get("glint_study") != 1:
            raise Wrong("%s: is no study: \"glint_study\": 1 is missing" % file)
        unknown = sorted(set(document) - KEYS)
        if unknown:
            raise Wrong("%s: %s: unknown key" % (file, unknown[0]))
        self.folder = self.file.parent
        self.glint = document.get("glint", "glint")
        if not isinstance(self.glint, str):
            raise Wrong("%s: glint: must be a text" % file)
        if "/" in self.glint:
            self.glint = str(self.folder / self.glint)
        self.out = self.folder / str(document.get("out", "results"))
        self.shards = document.get("shards")
        if not isinstance(self.shards, int) or not 1 <= self.shards <= MOST_SHARDS:
            raise Wrong("%s: shards: must be between 1 and %d" % (file, MOST_SHARDS))
        self.scenes = document.get("scenes")
        if not isinstance(self.scenes, dict) or not self.scenes or not all(isinstance(v, str) for v in self.scenes.values()):
            raise Wrong("%s: scenes: must name a file for each scene" % file)
        self.models = text_list(document.get("models"), "%s: models" % file)
        self.arguments = text_list(document.get("arguments", []), "%s: arguments" % file)
        for name in list(self.scenes) + self.models:
            if not NAME.fullmatch(name):
                raise Wrong("%s: %r: a name has letters, digits, and . _ - inside" % (file, name))
        if not self.models or len(set(self.models)) != len(self.models):
            raise Wrong("%s: models: each once" % file)

    def tasks(self):
        """(scene, model, shard), in the order of their numbers."""
        return [(scene, model, shard) for scene in self.scenes for model in self.models for shard in range(1, self.shards + 1)]

    def part(self, scene, model, shard):
        return self.out / "parts" / scene / model / ("%d-of-%d.json" % (shard, self.shards))

    def whole(self, scene, model):
        return self.out / scene / (model + ".json")

    def evaluate(self, scene, model, shard):
        """The command of one shard."""
        return [self.glint, "evaluate", str(self.folder / self.scenes[scene]), "--models", model, *self.arguments,
                "--shard", "%d/%d" % (shard, self.shards), "--json", str(self.part(scene, model, shard))]


def ranges(numbers):
    """3, 7, 8, 9 as "3,7-9"."""
    texts, at = [], 0
    while at < len(numbers):
        end = at
        while end + 1 < len(numbers) and numbers[end + 1] == numbers[end] + 1:
            end += 1
        texts.append(str(numbers[at]) if end == at else "%d-%d" % (numbers[at], numbers[end]))
        at = end + 1
    return ",".join(texts)


def run(study, number):
    tasks = study.tasks()
    if not 1 <= number <= len(tasks):
        raise Wrong("%d: shards of this study are numbered from 1 to %d" % (number, len(tasks)))
    part = study.part(*tasks[number - 1])
    part.parent.mkdir(parents=True, exist_ok=True)
    started = time.monotonic()
    code = subprocess.run(study.evaluate(*tasks[number - 1])).returncode
    if code == 0:
        part.with_suffix(".seconds").write_text("%.3f\n" % (time.monotonic() - started))
    return code


def merge(study):
    failed = 0
    for scene in study.scenes:
        for model in study.models:
            parts = [study.part(scene, model, shard) for shard in range(1, study.shards + 1)]
            whole = study.whole(scene, model)
            missing = [i + 1 for i, part in enumerate(parts) if not part.exists()]
            if missing:
                print("%s, %s: shards %s are missing" % (scene, model, ranges(missing)))
                failed += 1
                continue
            whole.parent.mkdir(parents=True, exist_ok=True)
            done = subprocess.run([study.glint, "merge", *map(str, parts), "-o", str(whole)], capture_output=True, text=True)
            if done.returncode not in (0, 3):  # 3: merged, and the model has no answer, which is a result of a study
                print("%s, %s: %s" % (scene, model, done.stderr.strip()))
                failed += 1
                continue
            summary = json.loads(whole.read_text(encoding="utf-8"))["models"][model]["summary"]
            mean = summary["contour_error_pct"]["mean"]
            print("%s, %s: %d of %d frames, %s" % (scene, model, summary["predicted"], summary["frames"],
                                                   "no answer" if mean is None else "mean error %.4g %%" % mean))
    return 1 if failed else 0


def cost(study):
    seconds = {}
    for scene, model, shard in study.tasks():
        try:
            taken = float(study.part(scene, model, shard).with_suffix(".seconds").read_text())
        except (OSError, ValueError):
            continue
        seconds.setdefault(model, []).append(taken)
    if not seconds:
        print("no shard is there yet")
        return 1
    print("%-14s %8s %14s %14s" % ("model", "shards", "mean s", "longest s"))
    total = 0
    for model in study.models:
        times = seconds.get(model, [])
        if times:
            print("%-14s %8d %14.2f %14.2f" % (model, len(times), sum(times) / len(times), max(times)))
            total += sum(times) / len(times) * study.shards * len(study.scenes)
    print("all shards of these models: %.2f hours of one task" % (total / 3600))
    return 0


def main(arguments):
    if len(arguments) < 2 or arguments[1] not in ("count", "list", "run", "left", "merge", "cost"):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        study, what, rest = Study(arguments[0]), arguments[1], arguments[2:]
        if (len(rest) == 1) != (what == "run") or len(rest) > 1:
            raise Wrong("%s: too few or too many arguments" % what)
        if what == "run":
            if not rest[0].isdigit():
                raise Wrong("%s: expected the number of a shard" % rest[0])
            return run(study, int(rest[0]))
        if what == "merge":
            return merge(study)
        if what == "cost":
            return cost(study)
        tasks = study.tasks()
        if what == "count":
            print(len(tasks))
        elif what == "list":
            for number, (scene, model, shard) in enumerate(tasks, 1):
                print("%d %s %s %d/%d" % (number, scene, model, shard, study.shards))
        else:
            print(ranges([n for n, task in enumerate(tasks, 1) if not study.part(*task).exists()]))
        return 0
    except Wrong as error:
        print("study: %s" % error, file=sys.stderr)
        return 2
    except OSError as error:
        print("study: %s: %s" % (error.filename or "", os.strerror(error.errno) if error.errno else error), file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
