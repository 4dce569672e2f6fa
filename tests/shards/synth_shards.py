#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A synthetic scene made in shards is that of one run, byte for byte: scene.json, every image, meshes. The shards run at the same time.

    tests/shards/synth_shards.py GLINT SPEC FOLDER [--shards N] [--set JSON]

--set JSON is merged into the specification's "render" (and other top keys), so that one test sees noise, another a given exposure."""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

import common


def files_of(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def main():
    p = argparse.ArgumentParser()
    p.add_argument("glint")
    p.add_argument("spec", type=pathlib.Path)
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--shards", type=int, default=3)
    p.add_argument("--set", default="{}")
    a = p.parse_args()
    shutil.rmtree(a.folder, ignore_errors=True)
    a.folder.mkdir(parents=True)
    spec = a.spec
    changes = json.loads(a.set)
    if changes:
        document = json.loads(spec.read_text())
        for key, value in changes.items():
            if isinstance(value, dict):
                document[key] = {**document.get(key, {}), **value}
            else:
                document[key] = value
        spec = a.folder / "spec.json"
        spec.write_text(json.dumps(document))
    whole, parts = a.folder / "whole", a.folder / "parts"
    common.run(a.glint, "synth", spec, "-o", whole)
    started = [subprocess.Popen([a.glint, "synth", str(spec), "-o", str(parts), "--shard", "%d/%d" % (i, a.shards)],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for i in range(1, a.shards + 1)]
    for i, process in enumerate(started):
        error = process.communicate()[1]
        common.check(process.returncode == 0, "shard %d: %s" % (i + 1, error))
    common.check(not (parts / "scene.json").exists(), "scene.json comes last")
    lists = sorted((parts / "parts").iterdir())
    common.check([f.name for f in lists] == ["%d-of-%d.json" % (i, a.shards) for i in range(1, a.shards + 1)], "the parts")

    def merge(**how):
        return common.run(a.glint, "merge", *lists, "-o", parts / "scene.json", **how)

    # Refused as long as something is missing or another file, and mended by repeating the shard.
    frames = [f for f in sorted(parts.rglob("*")) if f.suffix in (".png", ".tiff", ".jpg")]
    if frames:
        victim = frames[len(frames) // 2]
        good = victim.read_bytes()
        victim.unlink()
        merge(code=2, says="is missing; repeat shard")
        victim.write_bytes(good[:-1])
        merge(code=2, says="is not what this shard wrote")
        common.check(not (parts / "scene.json").exists(), "nothing is written")
        for i in range(1, a.shards + 1):
            common.run(a.glint, "synth", spec, "-o", parts, "--shard", "%d/%d" % (i, a.shards))
    common.run(a.glint, "merge", *lists[:-1], "-o", parts / "scene.json", code=2, says="is missing")
    common.run(a.glint, "merge", *lists, "-o", a.folder / "scene.json", code=2, says="does not lie in the folder parts")
    merge()
    shutil.rmtree(parts / "parts")
    one, several = files_of(whole), files_of(parts)
    common.check(sorted(one) == sorted(several), "the same files: %s" % sorted(set(one) ^ set(several)))
    for name in one:
        common.check(one[name] == several.get(name), name + " differs")

    # A folder of somebody else is left alone.
    mine = a.folder / "mine"
    victim = mine / sorted(one)[0]
    victim.parent.mkdir(parents=True)
    victim.write_bytes(b"mine")
    if sorted(one)[0] != "scene.json":
        common.run(a.glint, "synth", spec, "-o", mine, "--shard", "1/1", code=2, says="already exists")
        common.check(files_of(mine) == {sorted(one)[0]: b"mine"}, "nothing is written beside it")
    print("%d files, %d shards" % (len(one), a.shards))
    return common.finish()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
