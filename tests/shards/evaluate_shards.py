#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""An evaluation in shards equals one without, to the last bit except for times: every model, every part, the order of every key.

    tests/shards/evaluate_shards.py GLINT FOLDER [--shards N] [--other-light-from K] -- INPUT EVALUATE-ARGUMENTS

What it compares with is the run without shards, which shares none of the merging. --other-light-from: from frame K on the lamp of INPUT, a scene
file, has another name, so that some frames show a lamp that no training frame shows."""
import argparse
import json
import pathlib
import shutil
import sys

import common


def with_other_light(scene, folder, first):
    shutil.copytree(scene.parent, folder)
    document = json.loads(scene.read_text())
    for frame in document["frames"][first:]:
        frame["lights_on"] = ["another"]
        for highlight in frame.get("highlights", []):
            highlight["light"] = "another"
    (folder / scene.name).write_text(json.dumps(document))
    return str(folder / scene.name)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("glint")
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--shards", type=int, default=3)
    p.add_argument("--code", type=int, default=0, help="exit code of the whole run, and so of merge")
    p.add_argument("--other-light-from", type=int)
    p.add_argument("arguments", nargs="+")
    a = p.parse_args()
    shutil.rmtree(a.folder, ignore_errors=True)
    a.folder.mkdir(parents=True)
    if a.other_light_from is not None:
        a.arguments[0] = with_other_light(pathlib.Path(a.arguments[0]), a.folder / "scene", a.other_light_from)
    whole, merged = a.folder / "whole.json", a.folder / "merged.json"
    common.run(a.glint, "evaluate", *a.arguments, "--json", whole, code=a.code)
    parts = []
    for i in range(1, a.shards + 1):
        parts.append(a.folder / ("part-%d.json" % i))
        common.run(a.glint, "evaluate", *a.arguments, "--shard", "%d/%d" % (i, a.shards), "--json", parts[-1])
    # In another order than that of the shards.
    common.run(a.glint, "merge", *parts[1:], parts[0], "-o", merged, code=a.code)
    difference = common.first_difference(common.masked(whole), common.masked(merged))
    common.check(not difference, "the merged evaluation differs: " + difference)

    document = json.loads(whole.read_text())
    rows = sum(len(m["frames"]) for m in document["models"].values())
    common.check(rows > 0 and len(document["models"]) > 0, "the whole has rows to compare")
    # The comparison sees a last bit.
    text = whole.read_text()
    value = next(str(r["contour_error_px"]) for m in document["models"].values() for r in m["frames"]
                 if r["contour_error_px"] is not None)
    changed = common.without_times(common.parsed(text.replace(value, value[:-1] + ("1" if value[-1] != "1" else "2"), 1)))
    common.check(common.first_difference(common.masked(whole), changed), "a changed digit is not seen")
    print("%d models, %d rows, %d shards" % (len(document["models"]), rows, a.shards))
    return common.finish()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
