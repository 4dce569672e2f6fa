#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What Glint makes of inputs that went wrong once.

run.py GLINT REPORTS CASES.py [NAME...]    REPORTS: the folder with one folder for each report

CASES.py has a function for each case, whose name begins with "case_". It takes a Report and raises AssertionError where the answer is not the right
one. "case_mesh_y_up" gets a copy of the folder "mesh-y-up"; words behind two underscores tell several cases of one folder apart
("case_mesh_y_up__window"). Exit code: 0 all passed, 1 one failed, 77 there is no such folder.
"""
import importlib.util
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import traceback


class Report:
    """A copy of one report's folder, and the program that reads it."""

    def __init__(self, glint, folder):
        self.program, self.folder = glint, folder

    def glint(self, *words, exit_code=0):
        """Runs a command in the folder. Returns the finished process (stdout, stderr: text); fails at another exit code (None: any)."""
        done = subprocess.run([self.program, *map(str, words)], cwd=self.folder, capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL)
        assert exit_code is None or done.returncode == exit_code, f"glint {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        return done

    def info(self, *words):
        """What `glint info` prints of `words`, by default of the folder."""
        done = self.glint("info", *(words or ["."]))
        return done.stdout + done.stderr

    def errors(self, *words, models="limit-angle,canonical", train="spread:5"):
        """Mean error of each model in held-out frames, % of the contour's diameter; None for a model without an answer. `words`: input and options, by default the folder."""
        done = self.glint("evaluate", *(words or ["."]), "--models", models, "--train", train, "--json", "-", exit_code=None)
        assert done.stdout.startswith("{"), done.stderr
        found = json.loads(done.stdout)["models"]
        return {name: (model["summary"]["contour_error_pct"]["mean"] if model["status"] != "failed" else None) for name, model in found.items()}


def near(found, expected, within=0.02):
    """Whether errors of models are those of the same capture without the fault. `within`: relative."""
    for name, value in expected.items():
        assert found.get(name) is not None, f"{name}: no answer, expected {value} %: {found}"
        assert abs(found[name] - value) <= within * value, f"{name}: {found[name]} %, expected {value} %"


def says(text, *words):
    """Whether `text` has each of `words`, in whatever case."""
    for word in words:
        assert word.lower() in text.lower(), f'missing: "{word}" in:\n{text}'


def lacks(text, *words):
    for word in words:
        assert word.lower() not in text.lower(), f'not expected: "{word}" in:\n{text}'


def main():
    glint, reports, file, *chosen = sys.argv[1:]
    reports = pathlib.Path(reports)
    if not reports.is_dir():
        print("no data beside the project; skipped")
        return 77
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    sys.modules["run"] = sys.modules["__main__"]  # one copy of this file for the cases
    spec = importlib.util.spec_from_file_location("cases", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    cases = {name.removeprefix("case_"): call for name, call in vars(module).items() if name.startswith("case_")}
    passed = failed = 0
    for name, call in cases.items():
        if chosen and name not in chosen:
            continue
        source = reports / name.split("__")[0].replace("_", "-")
        with tempfile.TemporaryDirectory() as scratch:
            copy = pathlib.Path(scratch) / source.name
            shutil.copytree(source, copy)
            for path in [copy, *copy.rglob("*")]:
                os.chmod(path, 0o755 if path.is_dir() else 0o644)
            try:
                call(Report(os.path.abspath(glint), copy))
                passed += 1
            except Exception:  # a test reports whatever went wrong and goes on with the next case
                failed += 1
                print(f"FAILED {name}")
                traceback.print_exc(file=sys.stdout)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
