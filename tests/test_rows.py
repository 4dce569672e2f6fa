#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rows for docs/trust.md of a run of the tests: one for each test program, "name<TAB>count<TAB>findings<TAB>note". Used by tests/run_sanitizers.

  tests/test_rows.py --build FOLDER [--pattern REGEX] [--leave-out REGEX] [--reports FOLDER] JUNIT...    the rows; a test in several files counts as in the last one
  tests/test_rows.py --build FOLDER [--pattern REGEX] [--leave-out REGEX] --programs    names of all programs that a complete run has

JUNIT is what tests/suite/suite.py writes; --pattern and --leave-out are the tests of a complete run, as its --filter and --leave-out. A program of
which fewer tests ran has a row of another name, so that it stays missing.
"""
import argparse
import collections
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

sys.dont_write_bytecode = True  # no folder among the sources
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "suite"))
import suite


def programsOf(build, pattern, leaveOut):
    """How many tests of each program a complete run has; 0 of a program that is not built."""
    programs = collections.Counter()
    entries = suite.entriesOf(build)
    for entry, names in suite.namesOf(build, pattern, leaveOut).items():
        if names is not None:
            programs.update(name.split(".")[0] for name in names)
            continue
        program = entries[entry].prefix.split(".")[0]
        if not (leaveOut and re.search(leaveOut, f"{program}.")) and (not pattern or f"^{program}\\." in pattern):
            programs[program] += 0
    return programs


def rowsOf(junit, programs, reports):
    ran = collections.OrderedDict()
    cases = {case.get("name"): case for file in junit for case in xml.parse(file).getroot().iter("testcase")}
    for name, case in cases.items():
        program = ran.setdefault(name.split(".")[0], {"count": 0, "skipped": 0, "failed": []})
        if case.get("status") in ("disabled", "notrun") or case.find("skipped") is not None:
            program["skipped"] += 1
            continue
        program["count"] += 1
        if case.find("failure") is not None or case.get("status") == "fail":
            program["failed"].append(name)
    for name, program in sorted(ran.items()):
        seen = program["count"] + program["skipped"]
        part = "" if seen >= programs[name] else f", {seen} of {programs[name]} tests"
        note = "tests" + (f"; {program['skipped']} skipped" if program["skipped"] else "")
        if program["failed"]:
            note += ": " + ", ".join(program["failed"][:20])
        yield name + part, program["count"], len(program["failed"]), note
    found = len(list(pathlib.Path(reports).glob("report.*"))) if reports else 0
    if found:
        yield "reports of the sanitizer", found, found, "of all processes; a failed test may have made them"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True)
    parser.add_argument("--pattern", default="")
    parser.add_argument("--leave-out", default="")
    parser.add_argument("--reports", default="")
    parser.add_argument("--programs", action="store_true")
    parser.add_argument("junit", nargs="*")
    arguments = parser.parse_args()
    programs = programsOf(arguments.build, arguments.pattern, arguments.leave_out)
    if arguments.programs:
        print("\n".join(sorted(programs)))
    elif arguments.junit:
        for row in rowsOf(arguments.junit, programs, arguments.reports):
            print(*row, sep="\t")
    else:
        parser.error("JUNIT or --programs")


sys.exit(main())
