# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of studies share: running the program, and results without their times."""
import json
import pathlib
import subprocess

TIMES = {"time_us", "predict_us", "fit_us", "peak_mb"}  # of a machine, not of the answer
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED: " + what)
    return holds


def finish():
    print("%d failures" % len(failures))
    return 1 if failures else 0


def run(*arguments, code=0, says=None):
    """Runs a program; its exit code and, where `says` is given, what the only line on standard error holds."""
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, encoding="utf-8")
    command = " ".join(pathlib.Path(str(a)).name or str(a) for a in arguments)
    check(done.returncode == code, "%s: exit code %d, not %d: %s" % (command, done.returncode, code, done.stderr.strip()))
    if says is not None:
        check(done.stderr.count("\n") == 1, "%s: one line on standard error, not %r" % (command, done.stderr))
        check(says in done.stderr, "%s: says %r, not %r" % (command, done.stderr.strip(), says))
    return done


def without_times(value):
    """The same document with every time replaced. Numbers stay texts as they are written, so that equal means equal to the last bit."""
    if isinstance(value, dict):
        return {k: "a time" if k in TIMES else without_times(v) for k, v in value.items()}
    if isinstance(value, list):
        return [without_times(v) for v in value]
    return value


def parsed(text):
    return json.loads(text, parse_float=lambda t: "number " + t, parse_int=lambda t: "number " + t)


def masked(file):
    return without_times(parsed(pathlib.Path(file).read_text(encoding="utf-8")))


def first_difference(a, b, place=""):
    """Where two documents differ first, in their order; "" where they do not."""
    if type(a) is not type(b):
        return "%s: %.80r, %.80r" % (place, a, b)
    if isinstance(a, dict):
        if list(a) != list(b):
            return "%s: keys %s, %s" % (place, list(a), list(b))
        return next((d for d in (first_difference(a[k], b[k], place + "." + k) for k in a) if d), "")
    if isinstance(a, list):
        if len(a) != len(b):
            return "%s: %d entries, %d" % (place, len(a), len(b))
        return next((d for d in (first_difference(x, y, "%s[%d]" % (place, i)) for i, (x, y) in enumerate(zip(a, b))) if d), "")
    return "" if a == b else "%s: %.80r, %.80r" % (place, a, b)
