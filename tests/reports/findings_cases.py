# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: what `glint info` finds where input and highlights do not belong together, and the fix that it names."""
import struct

from run import lacks, near, says

RIGHT = {"limit-angle": 0.7935, "canonical": 1.6744}  # of the same capture without the fault (README of each folder)


def fix_of(text):
    """The value of --fix that `info` names."""
    lines = [line for line in text.splitlines() if "--fix " in line]
    assert len(lines) == 1, text
    return lines[0].split("--fix ")[1].split()[0]


def corrected(report):
    text = report.info()
    lacks(text, "no problems found")
    report.glint("convert", ".", "--fix", fix_of(text), "--out", "corrected.json")
    near(report.errors("corrected.json"), RIGHT)
    return text


def case_mesh_y_up(report):
    says(corrected(report), "the mesh is turned by -90 degrees about its x axis", "y up against z up")


def case_mesh_mm_around_cameras(report):
    says(corrected(report), "the mesh is in millimetres", "--fix mesh-mm")


def case_video_rotation_tag(report):
    given = ["clip.mp4", "--poses", "poses.txt", "--surface", "mesh.ply", "--camera", "400.0,400.0,159.5,119.5"]
    text = report.info(*given)
    says(text, "the file's rotation tag turns the stored ones by 90 degrees clockwise", "turned by 90 degrees clockwise: corrected", "--fix turn-cameras=90")
    lacks(text, "no problems found")
    report.glint("convert", *given, "--fix", fix_of(text), "--out", "corrected.json")
    # The same pictures as they are stored: the file without its tag.
    clip = bytearray((report.folder / "clip.mp4").read_bytes())
    matrix = clip.find(b"tkhd") + 44  # of the track's header, version 0: nine numbers of 32 bits
    clip[matrix : matrix + 36] = struct.pack(">9i", 1 << 16, 0, 0, 0, 1 << 16, 0, 0, 0, 1 << 30)
    (report.folder / "stored.mp4").write_bytes(clip)
    near(report.errors("corrected.json"), report.errors("stored.mp4", *given[1:]))


def case_alpha_hidden_white(report):
    near(report.errors(), RIGHT)
    lacks(report.info(), "finding:")
