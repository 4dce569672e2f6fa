# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py: images as other programs write them. Errors are those of the same pixels in a plain file."""
import json

from run import lacks, near, says


def case_tiff_planar_16_bit(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 2.0232})
    found = json.loads(report.glint("detect", ".", "--json", "-").stdout)
    assert [len(frame["highlights"]) for frame in found["frames"]] == [1] * 5, found


def case_tiff_half_float(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 1.8607})


def case_tiff_bigtiff(report):
    near(report.errors(models="limit-angle", train="first:4"), {"limit-angle": 1.9317})


def case_raw_files(report):
    found = report.info()
    says(found, "raw file of a camera", "develop it to TIFF or PNG first")
    lacks(found, "damaged", "truncated")
    report.folder.joinpath("images/a.dng").write_bytes(report.folder.joinpath("images/b.CR2").read_bytes())
    found = report.info()
    says(found, "raw file of a camera")
    lacks(found, "damaged", "truncated")


def case_exif_rotated_size(report):
    says(report.info(), "EXIF orientation 6", "the sizes agree", "-auto-orient")
    says(report.glint("evaluate", ".", "--models", "limit-angle", exit_code=3).stderr, "EXIF orientation 6")


def case_exr_multilayer(report):
    found = json.loads(report.glint("detect", ".", "--json", "-").stdout)
    assert [len(frame["highlights"]) for frame in found["frames"]] == [1] * 3, found
