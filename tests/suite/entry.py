#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the cases of a GoogleTest program, or one shard of them, as one CTest entry. glint_add_cases (tests/CMakeLists.txt) writes these commands.

A case that ends the program (a crash, an exit, no end within --seconds) fails by name, and the cases behind it run in a new process.
FOLDER/ENTRY.xml gets one JUnit test case for each, called PREFIX and the case's own name, and FOLDER/ENTRY.log all that was printed.

GLINT_TEST_FILTER, GLINT_TEST_LEAVE_OUT   regular expressions: only cases whose full name matches; none of those
GLINT_TEST_RESULTS                        takes the place of --results
Exit code: 0 all passed, 1 something failed, 77 nothing ran or every case was skipped.
"""
import argparse
import contextlib
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

ended = re.compile(r"\[==========\] \d+ tests? from \d+ test suites? ran\.")
begun = re.compile(r"\[ RUN      \] (\S+)")


def options(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--entry", required=True, help="name of the CTest entry")
    parser.add_argument("--prefix", required=True, help="stands before each case's name")
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--shard", type=int, default=0)
    parser.add_argument("--shards", type=int, default=1)
    parser.add_argument("--cases", default="*", help="GoogleTest's filter")
    parser.add_argument("--each", action="store_true", help="one process for each case")
    parser.add_argument("--seconds", type=float, default=600, help="limit of one case, on the clock")
    parser.add_argument("program", type=pathlib.Path)
    return parser.parse_args(words)


def listed(program, cases, cache):
    """Names of the program's cases as GoogleTest writes them, without the disabled ones. Kept in the folder `cache` until the program changes."""
    kept = cache / f"{program.name}.{cases.replace('/', '_')}.txt"
    stamp = str(program.stat().st_mtime_ns)
    with contextlib.suppress(OSError):
        first, *names = kept.read_text(encoding="utf-8").splitlines()
        if first == stamp:
            return names
    # What libraries leave behind in a program that only lists is no finding of a sanitizer.
    quiet = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0", "TSAN_OPTIONS": "report_bugs=0"}
    text = subprocess.run([program, "--gtest_list_tests", f"--gtest_filter={cases}"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          env=quiet, check=True).stdout.decode("utf-8", "replace")
    names, suite = [], ""
    for line in text.splitlines():
        if found := re.fullmatch(r"(\S+\.)(?: +#.*)?", line):
            suite = found[1]
        elif suite and (found := re.match(r"  (\S+)", line)):
            name = suite + found[1]
            if not re.search(r"(^|[./])DISABLED_", name):
                names.append(name)
    cache.mkdir(parents=True, exist_ok=True)
    own = kept.with_suffix(f".{os.getpid()}")
    own.write_text("\n".join([stamp, *names]) + "\n", encoding="utf-8")
    own.replace(kept)
    return names


def wanted(name, only, leaveOut):
    return (not only or re.search(only, name) is not None) and not (leaveOut and re.search(leaveOut, name))


def casesOf(entry, cache, only="", leaveOut=""):
    """The cases of one entry: those of its shard."""
    names = [name for name in listed(entry.program, entry.cases, cache) if wanted(entry.prefix + name, only, leaveOut)]
    return names[entry.shard::entry.shards]  # as GoogleTest deals them out


def stop(process):
    """Ends the program with all that it started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def waitFor(process, log, seconds):
    """The exit code; None where one case took more than `seconds`, and the program was ended."""
    since, place = time.monotonic(), 0
    while True:
        with contextlib.suppress(subprocess.TimeoutExpired):
            return process.wait(timeout=1)
        with open(log, "rb") as file:
            file.seek(max(0, place - 16))  # a mark may lie across the end of what was read
            new = file.read()
            place = file.tell()
        if b"[ RUN      ]" in new:
            since = time.monotonic()
        elif time.monotonic() - since > seconds:
            stop(process)
            return None


def howItEnded(code, seconds):
    if code is None:
        return f"no end within {seconds:g} s"
    if code < 0:
        return f"the program was ended by signal {-code} ({signal.strsignal(-code)})"
    return f"the program ended with exit code {code}"


class Results:
    def __init__(self):
        self.cases = {}  # name -> (status, message, seconds, output)

    def add(self, name, status, message="", seconds="0", output=""):
        if name not in self.cases or self.cases[name][0] != "failed":
            self.cases[name] = (status, message, seconds, output)

    def named(self, status):
        return [name for name, case in self.cases.items() if case[0] == status]


def read(report, text, results):
    """The results of a program that ran to its end: its own report; what a case printed comes from its output."""
    for suite in xml.fromstring(report.read_bytes().decode("utf-8", "replace")).iter("testsuite"):
        for case in suite.iter("testcase"):
            if not case.get("name"):
                continue  # newer versions: a failure of the suite, which is told below
            name = f"{case.get('classname')}.{case.get('name')}"
            failures = [failure.get("message", "") for failure in case.findall("failure")]
            skipped = case.find("skipped")
            if case.get("status") == "notrun":
                results.add(name, "disabled")
            elif failures:
                results.add(name, "failed", "\n".join(failures), case.get("time"), printedBy(name, text))
            elif skipped is not None:
                message = (skipped.get("message") or "").partition("\n")[2]  # behind the place in the source
                results.add(name, "skipped", message.strip(), case.get("time"))
            else:
                results.add(name, "passed", "", case.get("time"))
    # Its cases are skipped, without a reason.
    for suite, step in re.findall(r"^\[  FAILED  \] (\S+): (SetUpTestSuite or TearDownTestSuite)$", text, re.M):
        results.add(f"{suite}.({step})", "failed", "failed", "0", printed(rf"\[----------\] \d+ tests? from {re.escape(suite)}\b", text))


def printed(start, text):
    """From a mark to the next one."""
    found = re.search(f"{start}.*?(?=\\[ RUN      \\]|\\[----------\\]|\\Z)", text, re.S)
    return found[0] if found else ""


def printedBy(name, text):
    return printed(rf"\[ RUN      \] {re.escape(name)}\n", text)


def readBroken(text, how, results):
    """The results of a program that did not come to its end, from its output."""
    marks = re.compile(r"\[( RUN      |       OK |  FAILED  |  SKIPPED )\] ([^\s,]+)(?:.*\((\d+) ms\))?")
    open_ = None
    for mark, name, ms in marks.findall(text):
        if mark == " RUN      ":
            open_ = name
        elif name == open_ and ms:
            open_ = None
            output = printedBy(name, text)
            if "OK" in mark:
                results.add(name, "passed", "", str(int(ms) / 1000))
            elif "FAILED" in mark:
                results.add(name, "failed", output, str(int(ms) / 1000), output)
            else:
                reason = re.search(r": Skipped\n(.*?)\n*(?:\[  SKIPPED \]|$)", output, re.S)
                results.add(name, "skipped", reason[1] if reason else "", str(int(ms) / 1000))
    if open_:
        results.add(open_, "failed", how, "0", printedBy(open_, text) + how + "\n")
    return open_


def runOnce(entry, folder, chosen, results):
    """One process, with the cases `chosen`; None = those of the shard. False where it did not come to its end."""
    log, report = folder / f"{entry.entry}.part", folder / f"{entry.entry}.report"
    report.unlink(missing_ok=True)
    environment = {name: value for name, value in os.environ.items() if name not in ("GTEST_TOTAL_SHARDS", "GTEST_SHARD_INDEX", "GTEST_FILTER")}
    if chosen is None and entry.shards > 1:
        environment |= {"GTEST_TOTAL_SHARDS": str(entry.shards), "GTEST_SHARD_INDEX": str(entry.shard)}
    if "TSAN_OPTIONS" in environment:  # a report ends the program, as those of the other sanitizers do: thus its case is named
        environment["TSAN_OPTIONS"] += ":halt_on_error=1"
    command = [entry.program, f"--gtest_output=xml:{report}", f"--gtest_filter={entry.cases if chosen is None else ':'.join(chosen)}"]
    with open(log, "wb") as out:
        # A session of its own: what the program started and left can be ended with it.
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT, env=environment, start_new_session=True)
    try:
        code = waitFor(process, log, entry.seconds)
    finally:
        if process.poll() is None:
            stop(process)
    text = log.read_bytes().decode("utf-8", "replace")
    with open(folder / f"{entry.entry}.log", "a", encoding="utf-8") as all_:
        all_.write(text)
    log.unlink()
    how = howItEnded(code, entry.seconds)
    whole = code is not None and ended.search(text) and report.exists()
    if whole:
        read(report, text, results)
        if code != 0 and not results.named("failed"):
            results.add("(its end)", "failed", how, "0", f"{text[-3000:]}{how}\n")
    elif not readBroken(text, how, results):
        # Between two cases, or before the first: no case can be blamed.
        last = begun.findall(text)
        results.add(f"(after {last[-1]})" if last else "(its start)", "failed", how, "0", f"{text[-3000:]}{how}\n")
    report.unlink(missing_ok=True)
    return bool(whole)


def runAll(entry, folder, results):
    only, leaveOut = os.environ.get("GLINT_TEST_FILTER", ""), os.environ.get("GLINT_TEST_LEAVE_OUT", "")
    chosen = None
    if entry.each or only or leaveOut:
        try:
            chosen = casesOf(entry, folder / "lists", only, leaveOut)
        except (OSError, subprocess.SubprocessError) as error:
            results.add("(its start)", "failed", str(error))
            return
    if entry.each:
        for name in chosen:
            runOnce(entry, folder, [name], results)
        return
    if chosen == []:
        return
    while not runOnce(entry, folder, chosen, results):
        if chosen is None:
            try:
                chosen = casesOf(entry, folder / "lists")
            except (OSError, subprocess.SubprocessError):
                return  # it does not start, which is said already
        left = [name for name in chosen if name not in results.cases]
        if not left or left == chosen:  # nothing began: it would not begin again
            for name in left:
                results.add(name, "failed", "did not run: the program ended before it")
            return
        chosen = left


def write(entry, folder, results):
    suite = xml.Element("testsuite", name=entry.entry)
    for name, (status, message, seconds, _) in results.cases.items():
        ctest = {"passed": "run", "failed": "fail", "skipped": "notrun", "disabled": "disabled"}[status]
        case = xml.SubElement(suite, "testcase", name=entry.prefix + name, classname=entry.entry, time=seconds or "0", status=ctest)
        if status in ("failed", "skipped"):
            xml.SubElement(case, "failure" if status == "failed" else "skipped", message=printable(message))
    xml.ElementTree(suite).write(folder / f"{entry.entry}.xml", encoding="utf-8", xml_declaration=True)


def printable(text):
    """What XML can hold."""
    return re.sub(r"[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", text)


def main():
    entry = options(sys.argv[1:])
    folder = pathlib.Path(os.environ.get("GLINT_TEST_RESULTS") or entry.results)
    folder.mkdir(parents=True, exist_ok=True)
    for old in ("xml", "log"):
        (folder / f"{entry.entry}.{old}").unlink(missing_ok=True)
    sys.stdout.reconfigure(encoding="utf-8", errors="replace")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # by way of `finally`, which ends the program
    results = Results()
    if entry.program.exists():
        runAll(entry, folder, results)
    else:
        results.add("(its start)", "failed", f"{entry.program} is not built")
    write(entry, folder, results)
    count = {status: len(results.named(status)) for status in ("passed", "failed", "skipped", "disabled")}
    for name in results.named("failed"):
        _, message, _, output = results.cases[name]
        print(f"{output or message}".rstrip(), f"FAILED: {entry.prefix}{name}", "", sep="\n")
    for name in results.named("skipped"):
        print(f"skipped: {entry.prefix}{name}: {results.cases[name][1]}")
    print(f"{entry.entry}:", ", ".join(f"{n} {status}" for status, n in count.items() if n or status == "passed"))
    if count["failed"]:
        print(f"all output: {folder / entry.entry}.log")
        return 1
    return 0 if count["passed"] else 77


if __name__ == "__main__":
    sys.exit(main())
