#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A trade-off in shards: each setting of the fixed list once, the same errors however the list is divided, and front and choice as their
definitions say, computed here from the merged times.

    tests/shards/tradeoff_shards.py GLINT SCENE FOLDER -- ARGUMENTS"""
import json
import math
import pathlib
import shutil
import sys

import common


def front(points):
    def dominates(a, b):
        return a[0] <= b[0] and a[1] <= b[1] and a != b
    costs = [(p["ranked_error_pct"], p["predict_us"]) for p in points]
    return [not any(dominates(other, cost) for other in costs) for cost in costs]


def main():
    glint, scene, folder, arguments = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), sys.argv[5:]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    def merged(name, n, *more):
        files = []
        for i in range(1, n + 1):
            files.append(folder / ("%s-%d.json" % (name, i)))
            common.run(glint, "tradeoff", scene, *arguments, *more, "--shard", "%d/%d" % (i, n), "--json", files[-1])
        common.run(glint, "merge", *reversed(files), "-o", folder / (name + ".json"))
        return json.loads((folder / (name + ".json")).read_text()), files

    one, _ = merged("one", 1)
    three, parts = merged("three", 3)
    # What was measured, by setting: everything but times, and what follows from times.
    varying = {"predict_us", "fit_us", "peak_mb", "pareto"}

    def by_setting(document):
        return {json.dumps(p["set"], sort_keys=True) + p["settings"]["model"]: {k: v for k, v in p.items() if k not in varying}
                for p in document["points"]}

    difference = common.first_difference(*(dict(sorted(by_setting(d).items())) for d in (one, three)))
    common.check(not difference, "errors depend on how the list is divided: " + difference)
    common.check(len(by_setting(three)) == len(three["points"]) > 3, "every setting once: %d" % len(three["points"]))
    measured = sum(len(json.loads(f.read_text())["points"]) for f in parts)
    common.check(measured == len(three["points"]), "nothing is lost or pruned: %d of %d" % (len(three["points"]), measured))

    times = [p["predict_us"] for p in three["points"]]
    common.check(times == sorted(times), "fastest first")
    common.check([p["pareto"] for p in three["points"]] == front(three["points"]), "the front is that of the merged times")
    chosen = three["points"][three["chosen"]]
    common.check(three["chosen"] == three["presets"]["balanced"] and chosen["pareto"], "the choice is the balanced preset")

    # A bound is part of the request, and the choice follows it: the fastest point within the error.
    limit = sorted(p["ranked_error_pct"] for p in three["points"])[len(three["points"]) // 2]
    bound, _ = merged("bound", 2, "--max-error-pct", str(limit * 1.0001))
    within = [p["predict_us"] for p in bound["points"] if p["ranked_error_pct"] <= limit * 1.0001]
    common.check(math.isclose(bound["points"][bound["chosen"]]["predict_us"], min(within)), "the fastest within the error")

    # Refused.
    common.run(glint, "merge", *parts[:2], "-o", folder / "x.json", code=2, says="part 3 of 3 is missing")
    other = folder / "other.json"
    twice = list(arguments)
    twice[twice.index("--repeats") + 1] = "2"
    common.run(glint, "tradeoff", scene, *twice, "--shard", "3/3", "--json", other)
    common.run(glint, "merge", *parts[:2], other, "-o", folder / "x.json", code=2, says="shard.repeats")
    evil = folder / "evil.json"
    document = json.loads(parts[2].read_text())
    document["shard"]["points"][0] = 0
    evil.write_text(common.resealed(document))
    common.run(glint, "merge", *parts[:2], evil, "-o", folder / "x.json", code=2, says="is in another part, too")
    common.run(glint, "tradeoff", scene, "--shard", "1/2", "--json", "-", "--html", "x.html", code=2, says="--html")
    common.check(not (folder / "x.json").exists(), "nothing is written")
    print("%d settings" % len(three["points"]))
    return common.finish()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
