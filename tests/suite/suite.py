#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests of a build by ctest and says case by case what failed and what was skipped. Used by glint-test, tests/run_nightly
and tests/run_sanitizers.

  tests/suite/suite.py --build FOLDER [--filter REGEX] [--leave-out REGEX] [--changed] [--built] [--junit FILE] [CTEST-ARGUMENT...]
  tests/suite/suite.py --build FOLDER [--filter REGEX] [--leave-out REGEX] --list      only names them

The name of a GoogleTest case is PROGRAM.Suite.Case (core_geometry.Conic.Scale); of every other test, that of its CTest entry (rules.layers).
--filter and --leave-out match these names. A program that is not built is a failure, unless --built leaves it out; with a filter nobody knows its
cases, and it is left out, too. FILE gets all results, as JUnit XML with one test case each.
--changed leaves out the groups of occasional.txt whose code is what it was when they passed, and says which.
Exit code: ctest's own.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

sys.dont_write_bytecode = True  # no folder among the sources
import entry as cases
import occasional


def entriesOf(build):
    """The CTest entries: name -> options of entry.py, False of another test, None of another test whose program is not built."""
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], stdout=subprocess.PIPE, text=True, check=True).stdout
    entries = {}
    for test in json.loads(shown)["tests"]:
        command = test.get("command", [])
        ours = [i for i, word in enumerate(command) if word.endswith("tests/suite/entry.py")]
        entries[test["name"]] = cases.options(command[ours[0] + 1:]) if ours else False if command else None
    return entries


def resultsFolder(build):
    return pathlib.Path(os.environ.get("GLINT_TEST_RESULTS") or pathlib.Path(build).resolve() / "Testing/cases")


def namesOf(build, only="", leaveOut=""):
    """The full names of all tests: entry -> names, [] where none matches; None of a program that is not built."""
    entries, cache, names = entriesOf(build), resultsFolder(build) / "lists", {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        programs = {(entry.program, entry.cases) for entry in entries.values() if entry and entry.program.exists()}
        concurrent.futures.wait([pool.submit(cases.listed, *program, cache) for program in programs])
    for name, entry in entries.items():
        if not entry:
            names[name] = [name] if cases.wanted(name, only, leaveOut) else []
        elif entry.program.exists():
            try:
                names[name] = [entry.prefix + case for case in cases.casesOf(entry, cache, only, leaveOut)]
            except (OSError, subprocess.SubprocessError):
                names[name] = [f"{entry.prefix}(its start)"]  # its entry says how it ended
        else:
            names[name] = None
    return names


def unchanged(names):
    """The entries of groups whose code did not change: group -> names."""
    run = {group.name for group in occasional.changed(occasional.HERE.parent.parent)}
    found = {g.name: [name for name in names if g.entries.search(name)] for g in occasional.groups() if g.name not in run}
    return {name: entries for name, entries in found.items() if entries}


def exactly(names):
    """A regular expression of ctest for these entries."""
    return "^(" + "|".join(re.escape(name) for name in names) + ")$"


def merged(junit, entries, folder, begun):
    """One JUnit test case for each case, in place of those for entries. Results from before `begun` are those of an earlier run."""
    suite = xml.Element("testsuite", name="Glint")
    for case in xml.parse(junit).getroot().iter("testcase"):
        name = case.get("name")
        report = folder / f"{name}.xml"
        if not entries.get(name) or case.get("status") == "disabled":
            suite.append(case)
            skipped = case.find("skipped")
            if skipped is not None and not skipped.get("message", "").startswith(("SKIP_", "Disabled")):  # as "Unable to find executable"
                skipped.tag = "failure"
                case.set("status", "fail")
        elif report.exists() and report.stat().st_mtime >= begun:
            suite.extend(xml.parse(report).getroot().iter("testcase"))
        else:  # ctest's own limit of time, or something that ended it
            broken = xml.SubElement(suite, "testcase", name=f"{entries[name].prefix}({name} left no results)", status="fail")
            xml.SubElement(broken, "failure", message=f"the output is in {folder / name}.part")
    return suite


def statusOf(case):
    if case.get("status") == "disabled":
        return "disabled"
    if case.find("skipped") is not None or case.get("status") == "notrun":
        return "skipped"
    return "passed" if case.find("failure") is None and case.get("status") == "run" else "failed"


def widgetSkips(case):
    """Functions that a Qt test skipped, with the reason: ctest knows the whole class only."""
    for name, reason in re.findall(r"^SKIP   : (?:\w+::)*(\w+::\w+\([^\n]*?\)) (.*)$", case.findtext("system-out", ""), re.M):
        yield f"{case.get('name')} {name}", reason


def reasonOf(case):
    """The reason of a skipped test."""
    message = case.find("skipped").get("message", "") if case.find("skipped") is not None else ""
    said = [line for line in case.findtext("system-out", "").splitlines() if line.strip()]
    return " ".join((said[-1] if said and "SKIP_" in message else message).split()) or "no reason given"


def summary(suite):
    """What the whole run found, by name."""
    count, failed, skipped = collections.Counter(), [], collections.defaultdict(list)
    for case in suite.iter("testcase"):
        count[statusOf(case)] += 1
        if statusOf(case) == "failed":
            failed.append(case.get("name"))
        elif statusOf(case) == "skipped":
            skipped[reasonOf(case)].append(case.get("name"))
        for name, reason in widgetSkips(case):
            skipped[reason].append(name)
    lines = []
    for reason, names in sorted(skipped.items()):
        lines += [f"skipped, {len(names)}: {reason}", *(f"  {name}" for name in sorted(names))]
    if failed:
        lines += [f"failed, {len(failed)}:", *(f"  {name}" for name in failed)]
    kinds = ", ".join(f"{count[kind]:,} {kind}" for kind in ("passed", "failed", "skipped", "disabled") if count[kind] or kind in ("passed", "failed"))
    return "\n".join([*lines, f"{sum(count.values()):,} tests: {kinds}"]), bool(failed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--filter", default="")
    parser.add_argument("--leave-out", default="")
    parser.add_argument("--changed", action="store_true")
    parser.add_argument("--built", action="store_true")
    parser.add_argument("--junit", type=pathlib.Path)
    parser.add_argument("--list", action="store_true")
    arguments, more = parser.parse_known_args()
    for regex in (arguments.filter, arguments.leave_out):
        try:
            re.compile(regex)
        except re.error as error:
            parser.error(f"'{regex}' is no regular expression: {error}")
    sys.stdout.reconfigure(errors="replace")
    build = arguments.build.resolve()
    folder = resultsFolder(build)
    narrowed = bool(arguments.filter or arguments.leave_out)
    if arguments.list or narrowed:
        names = namesOf(build, arguments.filter, arguments.leave_out)
    if arguments.list:
        print("\n".join(sorted(name for some in names.values() for name in some or [])))
        return 0

    entries = entriesOf(build)
    chosen = list(entries)
    if narrowed:
        chosen = [name for name in chosen if names[name] != []]
    if arguments.changed:
        for group, left in unchanged(chosen).items():
            print(f"left out, {len(left)} of '{group}': their code is what it was when they passed (tests/suite/occasional.py)")
            chosen = [name for name in chosen if name not in left]
    if narrowed or arguments.built:
        missing = [name for name in chosen if entries[name] is None or (entries[name] and not entries[name].program.exists())]
        chosen = [name for name in chosen if name not in missing]
        if missing:
            print("not built, left out:", *missing)
    if not chosen:
        print("no test matches" if narrowed else f"no test in {build}")
        return 8
    if len(chosen) < len(entries):
        more += ["-R", exactly(chosen)]
    folder.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "GLINT_TEST_FILTER": arguments.filter, "GLINT_TEST_LEAVE_OUT": arguments.leave_out, "GLINT_TEST_RESULTS": str(folder)}
    junit = folder / f"entries-{os.getpid()}.junit"  # other runs may go on beside this one, of other entries
    begun = time.time() - 1  # clocks of files are coarse
    # All that a test prints, not the first kilobyte: names of skipped functions stand in it.
    command = ["ctest", "--test-dir", build, "--output-on-failure", "--output-junit", junit, "--test-output-size-passed", "1000000", "--no-tests=error"]
    code = subprocess.run([*command, *more], env=environment).returncode
    if not junit.exists():
        return code
    suite = merged(junit, entries, folder, begun)
    junit.unlink()
    if arguments.junit:
        arguments.junit.parent.mkdir(parents=True, exist_ok=True)
        xml.ElementTree(suite).write(arguments.junit, encoding="utf-8", xml_declaration=True)
    text, failed = summary(suite)
    print(text, flush=True)
    return code or (8 if failed else 0)


if __name__ == "__main__":
    sys.exit(main())
