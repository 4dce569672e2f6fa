#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether `glint info` names the mistake of a scene that has one (write_scene.py --wrong), and none for the right scene.

info_names.py GLINT FOLDER MISTAKE    FOLDER: what --wrong wrote for this mistake; MISTAKE "none": any folder of a right scene. What the command needs
beside the folder (truth.json says it) is given.
"""
import json
import pathlib
import subprocess
import sys

# A part of the finding, in words that no other mistake gets.
FINDINGS = {
    "half-pixel": "the principal point is half a pixel off",
    "camera-to-world": "poses are camera to world: invert them",
    "axes": "camera axes are OpenGL's, y up and z backwards",
    "millimetres": "the mesh is in millimetres and the poses are in metres",
    "mirrored": "mirrored left-right",
    "mirrored-photographs": "mirrored left-right",
    "depth-scale": "depth maps say 0.2 times the depth of the surface",
    "flipped-normals": "has its sides reversed",
    "other-frame": "not in the frame of the cameras",
}


def question(folder):
    """The arguments of `glint info` for this folder."""
    cases = json.loads((folder.parent / "truth.json").read_text())["cases"] if (folder.parent / "truth.json").exists() else {}
    case = cases.get(folder.name)
    if case is None:
        return [str(folder)]
    return [str(folder.parent / case["input"])] + [str(folder.parent / a["file"]) if isinstance(a, dict) else str(a) for a in case["arguments"]]


def main():
    glint, folder, mistake = sys.argv[1:]
    run = subprocess.run([glint, "info", *question(pathlib.Path(folder)), "--json", "-"], capture_output=True, text=True, timeout=300)
    if not run.stdout.startswith("{"):
        print(f"glint info ended with {run.returncode}: {run.stderr.strip()}")
        return 1
    findings = json.loads(run.stdout)["findings"]
    print("\n".join(findings) or "no finding")
    if mistake == "none":
        return 1 if findings else 0
    if any(FINDINGS[mistake] in finding for finding in findings):
        return 0
    print(f'missing: "{FINDINGS[mistake]}"')
    return 1


if __name__ == "__main__":
    sys.exit(main())
