# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: poses that were lost, repeated, or timed in other units."""
import json

from run import lacks, near, says  # noqa: F401

WHOLE = {"limit-angle": 0.7935, "canonical": 1.6744}
POSED = ["./im", "--poses", "./poses.txt", "--surface", "./mesh.ply", "--camera", "400.0,400.0,159.5,119.5"]


def frames_of(report, *words):
    report.glint("convert", *(words or ["."]), "-o", "converted.json")
    text = (report.folder / "converted.json").read_text()
    (report.folder / "converted.json").unlink()  # a scene file is one more way to read the folder
    return [f["id"] for f in json.loads(text)["frames"]]


def case_pose_infinite_nerf(report):
    assert len(frames_of(report)) == 7
    says(report.info(), "transforms.json: frames[3]: no finite pose (tracking was lost); it is left out")


def case_pose_infinite_nerf__all(report):
    capture = json.loads((report.folder / "transforms.json").read_text())
    for frame in capture["frames"]:
        frame["transform_matrix"] = None
    (report.folder / "transforms.json").write_text(json.dumps(capture))
    says(report.glint("info", ".", exit_code=2).stderr, "transforms.json: frames: have no finite pose")


def case_pose_infinite_nerf__frame_twice(report):
    capture = json.loads((report.folder / "transforms.json").read_text())
    capture["frames"].append(capture["frames"][0])
    (report.folder / "transforms.json").write_text(json.dumps(capture))
    assert len(frames_of(report)) == 7
    says(report.info(), "the image is there twice with the same camera")
    capture["frames"][-1] = json.loads(json.dumps(capture["frames"][0]))
    capture["frames"][-1]["transform_matrix"][0][3] += 1
    (report.folder / "transforms.json").write_text(json.dumps(capture))
    says(report.glint("info", ".", exit_code=2).stderr, "two images are called")


def case_pose_line_twice(report):
    near(report.errors(*POSED), WHOLE)
    says(report.info(*POSED), "poses.txt: line 5: says the same as a line before; it is left out")


def case_pose_line_twice__other_pose(report):
    """Which of two poses of one time counts, nobody knows."""
    lines = (report.folder / "poses.txt").read_text().splitlines()
    words = lines[4].split()
    lines[4] = " ".join([words[0], "9.5", *words[2:]])
    (report.folder / "poses.txt").write_text("\n".join(lines))
    says(report.glint("info", *POSED, exit_code=2).stderr, "poses.txt: line 5: duplicate id", "another pose")


def case_pose_line_twice__infinite(report):
    lines = (report.folder / "poses.txt").read_text().splitlines()
    words = lines[2].split()
    lines[2] = " ".join([words[0], "inf", *words[2:]])
    (report.folder / "poses.txt").write_text("\n".join(lines))
    assert len(frames_of(report, *POSED)) == 7
    says(report.info(*POSED), "poses.txt: line 3: no finite pose (tracking was lost); it is left out")


def case_poses_nanoseconds(report):
    near(report.errors(*POSED), WHOLE)


def case_poses_nanoseconds__against_seconds(report):
    """Images in nanoseconds, poses in seconds, 3 ms later."""
    lines = [line.split() for line in (report.folder / "poses.txt").read_text().splitlines() if not line.startswith("#")]
    seconds = [" ".join([f"{int(w[0]) // 10**9}.{int(w[0]) % 10**9 + 3 * 10**6:09d}", *w[1:]]) for w in lines]
    (report.folder / "poses.txt").write_text("\n".join(seconds))
    near(report.errors(*POSED), WHOLE)
    says(report.info(*POSED), "nearest in time (3.0 ms at most)")


def case_pose_line_twice__cut(report):
    """As a full disk leaves the last line."""
    text = (report.folder / "poses.txt").read_text().rstrip("\n")
    (report.folder / "poses.txt").write_text(text[:text.rindex(" ")])
    assert len(frames_of(report, *POSED)) == 7
    says(report.info(*POSED), "poses.txt: line 9: has fewer numbers than a pose (a cut line?); it is left out")


def case_pose_infinite_nerf__cut(report):
    capture = json.loads((report.folder / "transforms.json").read_text())
    capture["frames"][5]["transform_matrix"][1].pop()
    (report.folder / "transforms.json").write_text(json.dumps(capture))
    assert len(frames_of(report)) == 6
    says(report.info(), "transforms.json: frames[5]: has fewer numbers than a pose", "frames[3]: no finite pose")
