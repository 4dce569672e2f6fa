#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What `glint merge` refuses, by name, without writing anything; and that a merge replaces an earlier one as a whole.

    tests/shards/refused_parts.py GLINT SESSION FOLDER"""
import json
import pathlib
import shutil
import sys

import common

ARGUMENTS = ["--models", "limit-angle,primal"]


def changed(file, to, change, sealed=True):
    """A copy of a part with a change; with `sealed` its digest fits, so that what is refused is the change itself."""
    document = json.loads(file.read_text())
    change(document)
    to.write_text(common.resealed(document) if sealed else json.dumps(document))
    return to


def main():
    glint, session, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    out = folder / "whole.json"

    def part(i, n, *more, source=session):
        file = folder / ("part-%d.json" % len(list(folder.glob("part-*.json"))))
        common.run(glint, "evaluate", source, *ARGUMENTS, *more, "--shard", "%d/%d" % (i, n), "--json", file)
        return file

    def refused(says, *parts):
        common.run(glint, "merge", *parts, "-o", out, code=2, says=says)
        common.check(not out.exists(), "%s: nothing is written" % says)

    a, b, c = part(1, 3), part(2, 3), part(3, 3)
    refused("part 2 of 3 is missing", a, c)
    refused("parts 2, 3 of 3 are missing", a)
    refused("is part 2/3, as ", a, b, c, b)
    refused("is part 1/2", a, b, c, part(1, 2))
    refused("settings.predict.directions: is 12", a, b, part(3, 3, "--set", "predict.directions=12"))
    refused("train", a, b, part(3, 3, "--train", "0-2"))

    # Inputs: one photograph of the training frames is another file by now.
    copy = folder / "copy"
    shutil.copytree(pathlib.Path(session).parent, copy)
    photograph = sorted((copy / "frames").iterdir())[0]
    photograph.write_bytes(photograph.read_bytes() + b" ")
    refused("the input frames/" + photograph.name + " is another one", a, b, part(3, 3, source=copy / pathlib.Path(session).name))

    # Damage: every part must be what was written.
    text = b.read_text()
    short, flipped = folder / "short.json", folder / "flipped.json"
    short.write_text(text[:len(text) // 2])
    refused("short.json: line", a, short, c)
    digit = next(i for i, k in enumerate(text) if text[i - 1:i + 1].isdigit() and i > text.index('"frames": ['))
    flipped.write_text(text[:digit] + ("1" if text[digit] != "1" else "2") + text[digit + 1:])
    refused("is damaged", a, flipped, c)
    (folder / "empty.json").write_text("")
    refused("empty.json", a, folder / "empty.json", c)
    whole = folder / "no-part.json"
    common.run(glint, "evaluate", session, *ARGUMENTS, "--json", whole)
    refused("is no part of a work", a, whole, c)
    refused("nowhere.json", a, folder / "nowhere.json", c)

    # On purpose: the digest fits, what it says does not.
    evil = folder / "evil.json"

    def hostile(says, change):
        refused(says, a, changed(b, evil, change), c)

    hostile("was written by glint 0.0.0", lambda d: d["shard"].update(program="glint 0.0.0"))
    hostile("between 1 and 10000", lambda d: d["shard"].update(of=1000000000))
    hostile("shard.index", lambda d: d["shard"].update(index=-1))
    hostile("is in another part, too", lambda d: (d["shard"]["frames"].__setitem__(0, 0), d["shard"]["records"][0].update(frame=0)))
    hostile("no part has the frame at position", lambda d: (d["shard"]["frames"].__setitem__(-1, 99), d["shard"]["records"][-1].update(frame=99)))
    hostile("no part has the frame at position", lambda d: (d["shard"]["frames"].pop(), d["shard"]["records"].pop()))
    hostile("as many entries as `frames`", lambda d: d["shard"]["records"].pop())
    hostile("shard.records[0].clipped", lambda d: d["shard"]["records"][0].update(clipped="no"))
    hostile("between 0 and", lambda d: d["shard"]["records"][0].update(frame=-5))
    of = "primal"
    hostile("more rows than", lambda d: d["shard"]["models"][of]["comparisons"][0].update(rows=1000))
    hostile("counts more highlights than rows", lambda d: d["shard"]["models"][of]["comparisons"][0].update(missed=99999999))
    hostile("has rows of no comparison", lambda d: d["models"][of]["frames"].append(d["models"][of]["frames"][0]))
    hostile("is not held out", lambda d: d["shard"]["models"][of]["comparisons"][0].update(frame=0))
    hostile("must have 6 numbers", lambda d: d["shard"]["models"][of]["comparisons"][0].update(measured=[[1]]))
    hostile("models.primal.fits", lambda d: d["models"][of].update(fits={}))
    hostile("differ from those of", lambda d: d["models"][of]["fits"][0].update(reason="another"))
    hostile("models", lambda d: d["models"].pop(of))

    # Over an earlier result, and never over anything else.
    common.run(glint, "merge", a, b, c, "-o", out)
    first = out.read_bytes()
    common.run(glint, "merge", c, b, a, "-o", out)
    common.check(out.read_bytes() == first, "the same parts in any order")
    common.run(glint, "merge", a, flipped, c, "-o", out, code=2, says="is damaged")
    common.check(out.read_bytes() == first, "a refused merge leaves the old result")
    notes = folder / "notes.txt"
    notes.write_text("mine")
    common.run(glint, "merge", a, b, c, "-o", notes, code=2, says="notes.txt")
    common.run(glint, "merge", a, b, c, "-o", a, code=2, says=a.name)
    common.check(notes.read_text() == "mine" and json.loads(a.read_text())["shard"]["index"] == 1, "files of others stay")
    printed = common.run(glint, "merge", a, b, c, "-o", "-").stdout
    common.check(printed.encode() == first, "- is standard output")

    # Requests that cannot be a shard's.
    for wrong, says in ((["--shard", "0/3"], "numbered from 1 to 3"), (["--shard", "4/3"], "numbered from 1 to 3"),
                        (["--shard", "1/0"], "between 1 and 10000"), (["--shard", "1"], "expected i/n"),
                        (["--shard", "-1/3"], "expected i/n"), (["--shard", "1/3 "], "expected i/n")):
        common.run(glint, "evaluate", session, *wrong, "--json", out, code=2, says=says)
    common.run(glint, "evaluate", session, "--shard", "1/3", code=2, says="needs --json")
    common.run(glint, "evaluate", session, "--shard", "1/3", "--json", out, "--csv", "x.csv", code=2, says="--csv")
    common.run(glint, "evaluate", session, "--shard", "1/3", "--json", out, "--models", "auto", code=2, says="not for shards")
    return common.finish()


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
