#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/audit.md: findings of an external audit, measured with the build before and with this one.

  docs/make_audit.py                        runs every check with build/release/bin/glint and writes the page
  docs/make_audit.py --only 1.2             runs one section; the others keep the figures of the last run
  docs/make_audit.py --glint OLD --before   records the figures of an older build in the column "before"

Every figure comes from a run of the program on scenes in docs/audit/specs, scored against the exact contours of `glint synth`, not
against contours that the program detected.
"""
import argparse
import importlib
import json
import pathlib
import pkgutil
import re
import sys
import tempfile

DOCS = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))
from audit import harness  # noqa: E402

MOST = 200  # characters of a cell
RECORD = DOCS / "audit" / "figures.json"
HEAD = """# Audit

An external audit found answers that were wrong but looked right. Each row is one finding, measured before and now.
"Before" is the audited build (4e34f8f). Errors are mean distances between predicted and *exact* contours in held-out frames, as a
percentage of the highlight's diameter, unless a row says otherwise. A row that does not hold is marked **missed**.

`docs/make_audit.py` runs every check and writes this page.

"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--glint", default=DOCS.parent / "build/release/bin/glint")
    parser.add_argument("--shared", default=DOCS.parent.parent / "shared")
    parser.add_argument("--scratch", help="keep synthetic scenes from run to run here")
    parser.add_argument("--only", default="", help="only sections that start with this")
    parser.add_argument("--title", default="", help="only rows whose title contains this")
    parser.add_argument("--before", action="store_true", help="record the figures in the column 'before'")
    arguments = parser.parse_args()
    for module in sorted(m.name for m in pkgutil.iter_modules([str(DOCS / "audit")])):
        importlib.import_module("audit." + module)
    lines = sorted(harness.LINES, key=lambda l: l.section)
    keys = [f"{l.section} {l.title}" for l in lines]
    with tempfile.TemporaryDirectory() as scratch:
        runner = harness.Runner(arguments.glint, arguments.scratch or scratch, arguments.shared)
        for l in lines:
            if not l.section.startswith(arguments.only) or arguments.title not in l.title:
                continue
            try:
                result = l.check(runner)
            except Exception as e:  # an old build, or a fault: both are findings
                result = harness.Result(f"fails: {e}", False)
            print(f"{l.section} {l.title}: {result.figure}{'' if result.holds else '  MISSED'}", flush=True)
            # Read again each time: two builds may be measured beside each other, and a run that is stopped keeps what it found.
            record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
            entry = record.setdefault(f"{l.section} {l.title}", {})
            entry["before" if arguments.before else "now"] = {"figure": result.figure, "holds": result.holds}
            record = {k: v for k, v in sorted(record.items()) if k in keys}
            RECORD.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}

    def cell(key, when):
        entry = record.get(key, {}).get(when)
        if not entry:
            return "not measured"
        text = entry["figure"].replace("|", "\\|").replace("\n", " ")
        if len(text) >= MOST:
            text = re.sub(r" \([^()]*(\([^()]*\)[^()]*)*\)$", "", text)  # a long message without its advice
        return text + ("" if when == "before" or entry["holds"] else " **missed**")

    rows = ["| section | what was checked | bound | before | now |", "| --- | --- | --- | --- | --- |"]
    for l in lines:
        key = f"{l.section} {l.title}"
        rows.append(f"| {l.section} | {l.title} | {l.bound} | {cell(key, 'before')} | {cell(key, 'now')} |")
    (DOCS / "audit.md").write_text(HEAD + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
