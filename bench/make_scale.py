#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/scale.md: what a shard costs, and from that the plan of a study of 1,000 scenes with 5 models. It counts processor seconds of one
thread, which other work on the machine changes little, and measures how much; wall times and memory stand beside them."""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import typing

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODELS = ["primal", "dual", "canonical", "limit-angle", "reflectance"]
WHOLE = "limit-angle"  # the model of which every shard is run, for the merge and for how far shards differ
ORBIT = "orbit"  # the scene of the session ellipsoid with more frames, as radiance, made here
ORBIT_FRAMES = 100
SCENES = {"ellipsoid": ROOT / "sessions/ellipsoid/scene.json", "vase": ROOT / "sessions/vase/scene.json", ORBIT: None}
TRAIN = ["--train", "spread:6"]
SHARDS = [1, 2, 4, 8]  # one run first
STUDY_SCENES = 1000
CORES = 128  # of the cluster in the example; a task takes one
LOAD_REPEATS = 3  # runs alone and beside other work, in turns: the same noise meets both
HOUR = 3600

TEXT = """# Work for many machines

How `--shard i/n` divides work, what a shard costs, and how to plan a study for a cluster. A program writes this page; do not edit it. After a build,
from the root of the project (%(used)s of the processor, %(wall)s by the clock):

    python3 bench/make_scale.py --glint build/release/bin/glint%(how)s

Seconds are those of the processor, user and system, of processes with one thread (`GLINT_THREADS=1`), one after the other, one run each. The machine:
%(machine)s; it did other work meanwhile (mean load %(load)s).

**How far to trust them.** The same run (%(load_run)s), %(repeats)d times as the machine was, and %(repeats)d times beside %(busy)d more processes that compute without pause:

| | processor, s | wall, s |
| --- | --- | --- |
| as the machine was | %(quiet_cpu)s | %(quiet_wall)s |
| beside %(busy)d busy processes | %(loud_cpu)s | %(loud_wall)s |

The load multiplied wall times by %(wall_factor).2f and processor seconds by %(cpu_factor).2f: a core that is shared computes more slowly (caches, memory, clock), but other work is not counted. On an idle
machine the figures below can be lower by about that much; hours by the clock are planned as processor seconds, as if every task had a core of its own.

## What a shard costs
Every shard reads the scene, finds the highlights of the training frames and makes the fits; then it finds, predicts and compares the highlights of its own frames. The first part is paid by every shard, so many small shards cost
more than few large ones. Of a division the middle shard was measured; *shards / run* is what all shards cost against one run.

%(shards)s
Memory is that of one process, the largest of all its shards. A model without an answer (`primal` on curved surfaces) costs what its fit and the highlights cost. All %(most)d shards of `%(whole)s` differ little, and merging
them is cheap:

%(merge)s
What is **not** divided:
- Lights that can only be told from all frames: frames with several lamps, or scenes that do not name their lights. Then every shard finds the highlights of all frames, and only fits and predictions of other frames are saved. Name
  the lights (`lights_on`) where you know them.
- `synth` with `"exposure": 0` or noise traces the highlights of all frames in every shard, since both are relative to the brightest peak of the sequence; rendering is divided.
- `tradeoff` finds the highlights of all frames in every shard, and measures times: its shards need machines of one kind that do nothing else.

## A study of 1,000 scenes x 5 models
Assumed: scenes like those above in equal numbers (%(scenes)s), six training frames; one task a core; costs as measured here, merging included.

%(plan)s
- *Cores for one hour*: the fewest with which the study ends within an hour by the clock, its longest task included.
- One shard per scene and model is enough for scenes of this size: %(tasks1)s tasks of at most %(longest1)s. More shards shorten the longest task, and cost processor time.
- Divide a scene where one task would take longer than the queue allows, or where there are fewer tasks than cores: captures of a thousand photographs. A shard should take several times what every shard repeats.
- A task needs up to %(memory)s of memory; the study takes %(space)s of disk for its parts, which may be deleted when all are merged.
- Slurm's arrays have a limit (`MaxArraySize`, 1001 by default): `study.py left` names what is not done yet, so that `sbatch --array` can take it in pieces.
- Not in these figures: starting a job (of Slurm or Snakemake), and reading photographs over a network.

`plugins/cluster/study.py STUDY.json cost` prints the seconds of the shards that are done, on the machine that did them: run a dozen shards first, then decide.

## How to run it
[plugins/cluster](../plugins/cluster/README.md): one study file, and engines that run it: Slurm (`submit.sh`), Snakemake (`Snakefile`), or a loop over `study.py STUDY.json run N`. A shard that fails is repeated by all of them; a part is
written as a whole or not at all, so what was computed before a node failed is not computed again. `glint merge` refuses what does not belong together: parts of other versions, settings or inputs, and shards whose fits differ
because the machines round differently.
"""


class Used(typing.NamedTuple):
    """What one process took."""
    cpu: float  # s, user and system
    wall: float  # s
    megabytes: float  # the most memory at a time


def measured(arguments):
    with tempfile.TemporaryFile() as error:
        start = time.monotonic()
        process = subprocess.Popen([str(a) for a in arguments], stdout=subprocess.DEVNULL, stderr=error, env={**os.environ, "GLINT_THREADS": "1"})
        _, status, used = os.wait4(process.pid, 0)  # of this process alone, whatever runs beside it
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 3):  # 3: a model without an answer, which is a result of a study
            error.seek(0)
            sys.exit("%s: %s" % (" ".join(map(str, arguments)), error.read().decode(errors="replace")))
    return Used(used.ru_utime + used.ru_stime, wall, used.ru_maxrss * 1024 / 1e6)


class Measurements:
    """All that is run, and what it took."""

    def __init__(self, a, work):
        self.a, self.work, self.files, self.used = a, work, dict(SCENES), 0.0
        if ORBIT in a.scenes:
            self.files[ORBIT] = self.orbit()
        self.frames = {scene: len(json.loads(self.files[scene].read_text("utf-8"))["frames"]) for scene in a.scenes}
        self.cost = {(scene, model, n): self.shard(scene, model, (n + 1) // 2, n) for scene in a.scenes for model in MODELS for n in a.shards}
        most = max(a.shards)
        # Every shard of one model: what merging takes, and whether the middle one stands for all.
        self.every = {scene: [self.shard(scene, WHOLE, i, most) for i in range(1, most + 1)] for scene in a.scenes}
        self.merges = {scene: self.run("merge", *(self.part(scene, WHOLE, i, most) for i in range(1, most + 1)), "-o", work / "whole.json") for scene in a.scenes}

    def run(self, *arguments):
        used = measured([self.a.glint, *arguments])
        self.used += used.cpu
        return used

    def orbit(self):
        spec = json.loads((ROOT / "sessions/ellipsoid/spec.json").read_text("utf-8"))
        spec["path"]["orbit"]["count"] = ORBIT_FRAMES
        (self.work / "spec.json").write_text(json.dumps(spec), "utf-8")
        self.run("synth", self.work / "spec.json", "--out", self.work / ORBIT)
        scene = self.work / ORBIT / "scene.json"
        document = json.loads(scene.read_text("utf-8"))
        for frame in document["frames"]:
            del frame["highlights"]  # to be found in the frames, as those of a capture
        scene.write_text(json.dumps(document), "utf-8")
        return scene

    def part(self, scene, model, i, n):
        return self.work / ("%s-%s-%d-of-%d.json" % (scene, model, i, n))

    def shard(self, scene, model, i, n):
        return self.run("evaluate", self.files[scene], "--models", model, *TRAIN, "--shard", "%d/%d" % (i, n), "--json", self.part(scene, model, i, n))

    def under_load(self):
        """The same run as the machine is, and beside busy processes: two lists of Used."""
        scene = self.a.scenes[0]
        quiet, loud = [], []
        for _ in range(LOAD_REPEATS):
            quiet.append(self.shard(scene, WHOLE, 1, 1))
            busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count())]
            try:
                loud.append(self.shard(scene, WHOLE, 1, 1))
            finally:
                for process in busy:
                    process.kill()
                    process.wait()
        return scene, quiet, loud


def seconds(value):
    return "%.2f s" % value if value < 60 else "%.1f min" % (value / 60)


def listed(values):
    return ", ".join("%.2f" % v for v in values)


def machine():
    names = [line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text("utf-8").splitlines() if line.startswith("model name")]
    return "%s, %d cores" % (names[0] if names else "a processor that says no name", os.cpu_count())


def shard_table(m):
    rows = ["| scene | model | memory, MB | one run, s | " + " | ".join("a shard of %d, s | shards / run" % n for n in m.a.shards[1:]) + " |",
            "| --- | --- | --- | --- " + "| --- | --- " * (len(m.a.shards) - 1) + "|"]
    for scene in m.a.scenes:
        for model in MODELS:
            one = m.cost[scene, model, 1].cpu
            rows.append("| %s | %s | %.0f | %.2f | " % (scene, model, max(m.cost[scene, model, n].megabytes for n in m.a.shards), one) + " | ".join(
                "%.2f | %.2f" % (m.cost[scene, model, n].cpu, n * m.cost[scene, model, n].cpu / one) for n in m.a.shards[1:]) + " |")
    return "\n".join(rows) + "\n"


def merge_table(m):
    rows = ["| scene | a shard of %d, s: least, most | middle shard x %d / all | merge, s |" % (2 * (max(m.a.shards),)), "| --- | --- | --- | --- |"]
    for scene in m.a.scenes:
        every = [u.cpu for u in m.every[scene]]
        middle = m.cost[scene, WHOLE, max(m.a.shards)].cpu
        rows.append("| %s | %.2f, %.2f | %.2f | %.2f |" % (scene, min(every), max(every), len(every) * middle / sum(every), m.merges[scene].cpu))
    return "\n".join(rows) + "\n"


def plan_table(m, longest):
    rows = ["| shards per scene and model | tasks | processor hours | longest task | cores for one hour | on %d cores |" % CORES, "| --- " * 6 + "|"]
    merging = max(u.cpu for u in m.merges.values()) * STUDY_SCENES * len(MODELS)
    for n in m.a.shards:
        total = merging + STUDY_SCENES * statistics.mean(sum(n * m.cost[scene, model, n].cpu for model in MODELS) for scene in m.a.scenes)
        cores = str(math.ceil(total / (HOUR - longest[n]))) if longest[n] < HOUR else "none"
        rows.append("| %d | %s | %.1f | %s | %s | %s |" % (n, format(STUDY_SCENES * len(MODELS) * n, ","), total / HOUR, seconds(longest[n]), cores,
                                                       seconds(total / CORES + longest[n])))
    return "\n".join(rows) + "\n"


def page(m, load, start):
    scene, quiet, loud = m.under_load()
    longest = {n: max(m.cost[s, model, n].cpu for s in m.a.scenes for model in MODELS) for n in m.a.shards}
    sizes = [m.part(s, model, 1, 1).stat().st_size for s in m.a.scenes for model in MODELS]

    def factor(of):
        return statistics.median(map(of, loud)) / statistics.median(map(of, quiet))

    return TEXT % {
        "used": seconds(m.used), "wall": seconds(time.monotonic() - start), "machine": machine(), "load": "%.1f" % statistics.mean([load, os.getloadavg()[2]]),
        "how": "" if (m.a.scenes, m.a.shards) == (list(SCENES), SHARDS) else " --scenes %s --shards %s" % (",".join(m.a.scenes), ",".join(map(str, m.a.shards))),
        "load_run": "`evaluate` of %s with `%s`" % (scene, WHOLE), "repeats": LOAD_REPEATS, "busy": os.cpu_count(),
        "quiet_cpu": listed(u.cpu for u in quiet), "quiet_wall": listed(u.wall for u in quiet), "loud_cpu": listed(u.cpu for u in loud),
        "loud_wall": listed(u.wall for u in loud), "wall_factor": factor(lambda u: u.wall), "cpu_factor": factor(lambda u: u.cpu),
        "shards": shard_table(m), "merge": merge_table(m), "plan": plan_table(m, longest), "most": max(m.a.shards), "whole": WHOLE,
        "scenes": ", ".join("%s with %d frames" % (s, m.frames[s]) for s in m.a.scenes), "tasks1": format(STUDY_SCENES * len(MODELS), ","),
        "longest1": seconds(longest[1]), "memory": "%.0f MB" % max(u.megabytes for u in m.cost.values()),
        "space": "%.1f GB" % (STUDY_SCENES * len(MODELS) * statistics.mean(sizes) / 1e9)}


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--glint", default="build/release/bin/glint")
    p.add_argument("--scenes", default=",".join(SCENES))
    p.add_argument("--shards", default=",".join(map(str, SHARDS)), help="divisions, 1 the first of them")
    p.add_argument("--output", default=str(ROOT / "docs" / "scale.md"))
    a = p.parse_args()
    a.scenes, a.shards = a.scenes.split(","), [int(n) for n in a.shards.split(",")]
    if a.shards[0] != 1 or not set(a.scenes) <= set(SCENES):
        p.error("--shards starts with 1, --scenes are of %s" % ", ".join(SCENES))
    load, start = os.getloadavg()[2], time.monotonic()
    with tempfile.TemporaryDirectory() as work:
        m = Measurements(a, pathlib.Path(work))
        pathlib.Path(a.output).write_text(page(m, load, start), encoding="utf-8")
    print("%s: %s of the processor" % (a.output, seconds(m.used)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
