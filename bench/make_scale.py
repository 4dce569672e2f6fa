#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/scale.md: what a shard costs, and from that the plan of a study of 1,000 scenes with 5 models. CPU time of one thread: on a shared
machine wall time says little."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODELS = ["primal", "dual", "canonical", "limit-angle", "reflectance"]
SCENES = {"ellipsoid": "sessions/ellipsoid/scene.json", "vase": "sessions/vase/scene.json"}
TRAIN = ["--train", "spread:6"]
SHARDS = [1, 2, 4, 8]  # one run first
STUDY_SCENES = 1000
CORES = 128  # of the cluster in the example; a task takes one

TEXT = """# Work for many machines

How `--shard i/n` divides work, what a shard costs, and how to plan a study for a cluster. A program writes this page; do not edit it. After a build,
from the root of the project (%(seconds).0f s of the processor):

    python3 bench/make_scale.py --glint build/release/bin/glint%(how)s

CPU time, user and system, of processes with one thread (`GLINT_THREADS=1`)%(jobs)s, one run each; the machine did other work meanwhile, so an idle one is faster. Of a division the middle shard was measured.

## What a shard costs
Every shard reads the scene, finds the highlights of the training frames and makes the fits; then it finds, predicts and compares the highlights of its own frames. The first part is paid by every shard, so many small shards cost
more than few large ones. The last number of a division is what dividing costs in all.

%(shards)s
Merging is cheap: %(merge)s.

What is **not** divided:
- Lights that can only be told from all frames: frames with several lamps, or scenes that do not name their lights. Then every shard finds the highlights of all frames, and only fits and predictions of other frames are saved. Name
  the lights (`lights_on`) where you know them.
- `synth` with `"exposure": 0` or noise traces the highlights of all frames in every shard, since both are relative to the brightest peak of the sequence; rendering is divided.
- `tradeoff` finds the highlights of all frames in every shard, and measures times: its shards need machines of one kind that do nothing else.

## A study of 1,000 scenes x 5 models
Assumed: scenes like those above in equal numbers (%(scenes)s), six training frames; one task a core, %(cores)d cores; times as measured here.

%(plan)s
- One shard per scene and model is enough for scenes of this size: %(tasks1)s tasks of at most %(longest1)s keep %(cores)d cores busy. More shards shorten the longest task, and cost processor time.
- Divide a scene where one task would take longer than the queue allows, or where there are fewer tasks than cores: captures of a thousand photographs. A shard should take several times what every shard repeats.
- A study takes %(space)s of disk for its parts; they may be deleted when all are merged.
- Slurm's arrays have a limit (`MaxArraySize`, 1001 by default): `study.py left` names what is not done yet, so that `sbatch --array` can take it in pieces.

`plugins/cluster/study.py STUDY.json cost` prints the same figures from the shards that are done, on the machine that did them: run a dozen shards first, then decide.

## How to run it
[plugins/cluster](../plugins/cluster/README.md): one study file, and engines that run it: Slurm (`submit.sh`), Snakemake (`Snakefile`), or a loop over `study.py STUDY.json run N`. A shard that fails is repeated by all of them; a part is
written as a whole or not at all, so what was computed before a node failed is not computed again. `glint merge` refuses what does not belong together: parts of other versions, settings or inputs, and shards whose fits differ
because the machines round differently.
"""


def cpu_seconds(arguments):
    with tempfile.TemporaryFile() as error:
        process = subprocess.Popen([str(a) for a in arguments], stdout=subprocess.DEVNULL, stderr=error, env={**os.environ, "GLINT_THREADS": "1"})
        _, status, used = os.wait4(process.pid, 0)  # of this process alone, whatever runs beside it
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 3):
            error.seek(0)
            sys.exit("%s: %s" % (" ".join(map(str, arguments)), error.read().decode(errors="replace")))
    return used.ru_utime + used.ru_stime


def seconds(value):
    return "%.2f s" % value if value < 60 else "%.1f min" % (value / 60)


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--glint", default="build/release/bin/glint")
    p.add_argument("--scenes", default=",".join(SCENES))
    p.add_argument("--shards", default=",".join(map(str, SHARDS)), help="divisions, 1 the first of them")
    p.add_argument("--jobs", type=int, default=1, help="measured beside each other")
    p.add_argument("--output", default=str(ROOT / "docs" / "scale.md"))
    a = p.parse_args()
    a.scenes, a.shards = a.scenes.split(","), [int(n) for n in a.shards.split(",")]
    with tempfile.TemporaryDirectory() as work:
        write(a, pathlib.Path(work))
    return 0


def write(a, work):
    frames = {scene: len(json.loads((ROOT / SCENES[scene]).read_text())["frames"]) for scene in a.scenes}
    todo = [(scene, model, n) for scene in a.scenes for model in MODELS for n in a.shards]

    def measure(task):
        scene, model, n = task
        part = work / ("%s-%s-%d.json" % task)
        # Of a division the middle shard: all have the same number of frames, give or take one.
        return cpu_seconds([a.glint, "evaluate", ROOT / SCENES[scene], "--models", model, *TRAIN, "--shard", "%d/%d" % ((n + 1) // 2, n), "--json", part])

    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        cost = dict(zip(todo, pool.map(measure, todo)))
    used = sum(cost.values())
    wholes = [work / ("%s-%s-1.json" % (scene, model)) for scene in a.scenes for model in MODELS]
    sizes = [f.stat().st_size for f in wholes]
    merges = [cpu_seconds([a.glint, "merge", f, "-o", work / "whole.json"]) for f in wholes[:1]]
    rows = ["| scene | model | one run, s | " + " | ".join("a shard of %d, s | %d shards / one run" % (n, n) for n in a.shards[1:]) + " |",
            "| --- | --- | --- " + "| --- | --- " * (len(a.shards) - 1) + "|"]
    for scene in a.scenes:
        for model in MODELS:
            one = cost[scene, model, 1]
            rows.append("| %s | %s | %.2f | " % (scene, model, one) + " | ".join(
                "%.2f | %.2f" % (cost[scene, model, n], n * cost[scene, model, n] / one) for n in a.shards[1:]) + " |")
    plan = ["| shards per scene and model | tasks | CPU hours | hours on %d cores | longest task |" % CORES, "| --- | --- | --- | --- | --- |"]
    longest = {n: max(cost[scene, model, n] for scene in a.scenes for model in MODELS) for n in a.shards}
    for n in a.shards:
        total = STUDY_SCENES * statistics.mean(sum(n * cost[scene, model, n] for model in MODELS) for scene in a.scenes)
        plan.append("| %d | %s | %.1f | %.2f | %s |" % (n, format(STUDY_SCENES * len(MODELS) * n, ","), total / 3600,
                                                      max(total / CORES, longest[n]) / 3600, seconds(longest[n])))
    text = TEXT % {
        "seconds": used, "jobs": "" if a.jobs == 1 else ", %d beside each other" % a.jobs,
        "how": "" if (a.scenes, a.shards) == (list(SCENES), SHARDS) else " --scenes %s --shards %s" % (",".join(a.scenes), ",".join(map(str, a.shards))),
        "shards": "\n".join(rows) + "\n", "merge": "%.2f s for one part" % merges[0],
        "scenes": " and ".join("%s, %d frames" % (scene, frames[scene]) for scene in a.scenes), "cores": CORES, "plan": "\n".join(plan) + "\n",
        "tasks1": format(STUDY_SCENES * len(MODELS), ","), "longest1": seconds(longest[1]),
        "space": "%.1f GB" % (STUDY_SCENES * len(MODELS) * statistics.mean(sizes) / 1e9)}
    pathlib.Path(a.output).write_text(text, encoding="utf-8")
    print("%s: %.0f s of the processor" % (a.output, used))


if __name__ == "__main__":
    sys.exit(main())
