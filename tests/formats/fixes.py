#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does the correction that `glint info` proposes give back the scene that was written?

  tests/formats/fixes.py GLINT FOLDER       FOLDER: what write_scene.py wrote with --wrong for one mistake

Takes the fix that info proposes, lets `glint convert --fix` make it, compares cameras and depth scales with truth.json as
read_back.py does, and asks info about the corrected scene: it must find nothing.
"""
import json
import pathlib
import subprocess
import sys

from read_back import compare


def report_of(glint, path):
    run = subprocess.run([glint, "info", str(path), "--json", "-"], capture_output=True, text=True, timeout=300, check=False)
    if not run.stdout.startswith("{"):
        sys.exit(f"glint info ended with {run.returncode}: {run.stderr.strip()}")
    return json.loads(run.stdout)


def main():
    glint, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    case = json.loads((root / "truth.json").read_text())["cases"]["scene"]
    report = report_of(glint, root / case["input"])
    if len(report["fixes"]) != 1:
        sys.exit(f"expected one fix, got {report['fixes']} for {report['findings']}")
    fix = report["fixes"][0]["fix"]
    print(f"{report['findings'][report['fixes'][0]['finding']]}\n  --fix {fix}")
    output = root / "corrected.json"
    subprocess.run([glint, "convert", str(root / case["input"]), "--fix", fix, "-o", str(output)], check=True)
    if fix.startswith("depth-scale"):
        case["depth_scale"] *= 5  # wrong_conventions.py: 1000 units for 5000
    centre, pixel, complaints = compare(json.loads(output.read_text(encoding="utf-8")), case, output.parent, root)
    print(f"centres {centre:.2g} of the scene's size, pixels {pixel:.2g}")
    complaints += report_of(glint, output)["findings"]
    print("\n".join(complaints) or "agrees")
    sys.exit(1 if complaints else 0)


main()
