# SPDX-License-Identifier: BSD-3-Clause
"""Cases of run.py."""
import json
import math

from run import lacks, near, says  # noqa: F401


def directions(file):
    """Name -> direction of a list of light positions."""
    rows = [line.split() for line in file.read_text().splitlines()[1:]]
    return {name: [float(n) for n in numbers] for name, *numbers in rows}


def apart(found, truth):
    """Largest angle, degrees, between directions of the same names."""
    assert found.keys() == truth.keys(), (found.keys(), truth.keys())
    cosines = [sum(a * b for a, b in zip(found[n], truth[n])) / math.hypot(*found[n]) / math.hypot(*truth[n]) for n in truth]
    return max(math.degrees(math.acos(max(-1.0, min(1.0, c)))) for c in cosines)


def case_ball_with_window(report):
    done = report.glint("lights", ".", "--ball", "200,150,60", "-o", "l.lp")
    says(done.stderr, "does not move between photographs")
    off = apart(directions(report.folder / "l.lp"), directions(report.folder / "truth.lp"))
    assert off < 1.5, f"{off} degrees from the truth"
    one = report.folder / "one"
    one.mkdir()
    (one / "IMG_0001.JPG").write_bytes((report.folder / "IMG_0001.JPG").read_bytes())
    done = report.glint("lights", "one", "--ball", "200,150,60", "--all-warnings", "--json", "one.json")
    says(done.stderr, "may be a window's", "Only motion tells")
    lamp = json.loads((report.folder / "one.json").read_text())["lights"][0]
    x, y, z = directions(report.folder / "truth.lp")["IMG_0001.JPG"]
    off = [apart({"": d}, {"": [x, -y, -z]}) for d in [lamp["direction"]] + [o["direction"] for o in lamp["dropped"] if o["direction"]]]
    assert min(off) < 2 and off[0] < 2 * lamp["direction_sigma_deg"], (off, lamp["direction_sigma_deg"])


def case_ball_exif_turned(report):
    done = report.glint("lights", ".", "--ball", "120,100,60", "--json", "j.json", "-o", "l.lp", exit_code=3)
    says(done.stderr, "EXIF orientation (3)", "stored pixels")
    assert (report.folder / "j.json").is_file() and (report.folder / "l.lp").is_file(), "exit 3 writes its files"
