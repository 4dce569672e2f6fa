# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: meshes as other programs write them. Each answer is that of the same capture with the mesh written in another way."""
from run import near, says


def case_obj_concave_polygon(report):
    says(report.glint("predict", "./plate.glint", "--frames", "notch", exit_code=3).stderr, "off the surface", "beyond its edge")


def case_ply_one_zero_normal(report):
    near(report.errors(), {"limit-angle": 0.7935, "canonical": 1.6744})


def case_ply_nan_vertex(report):
    near(report.errors(), {"limit-angle": 0.7935, "canonical": 1.6744})


def case_stl_leading_blank(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 9.2138})


def faces_of_strips(text):
    """The same PLY with its strips written out as faces, every other one turned."""
    head, data = text.split("end_header\n")
    vertices = int(head.split("element vertex ")[1].split()[0])
    lines = data.splitlines()
    faces = []
    for line in lines[vertices:]:
        strip = []
        for number in line.split()[1:]:
            strip = [] if number == "-1" else [*strip, number]
            if len(set(strip[-3:])) == 3:
                faces.append(" ".join(["3", *(strip[-3:] if len(strip) % 2 else [strip[-2], strip[-3], strip[-1]])]))
    head = head.replace("element tristrips 1", f"element face {len(faces)}")
    return head + "end_header\n" + "\n".join([*lines[:vertices], *faces]) + "\n"


def case_ply_tristrips(report):
    """Its triangles have other diagonals than those of stl-leading-blank, and so another error."""
    found = report.errors(models="limit-angle", train="first:4")
    mesh = report.folder / "m.ply"
    mesh.write_text(faces_of_strips(mesh.read_text()))
    near(found, report.errors(models="limit-angle", train="first:4"), within=0)
