# SPDX-License-Identifier: BSD-3-Clause
"""Lines of section 2 about speed: contours by walks from the maxima against the level set."""
from .harness import Result, line, mean_error, percent


def _both(run, scene, model, *arguments):
    """Error and the program's own median time a frame of the level set, then of the star."""
    for contour in ("level-set", "star"):
        found = run.evaluate(scene, "--models", model, "--train", "spread:6", "--set", "predict.contour=" + contour, *arguments)
        times = found["models"][model]["summary"].get("time_us", {})
        yield mean_error(found, model), times.get("median", float("nan"))


@line("2.5", "`reflectance` by star walk: error against the level set", "within 0.01 percentage points")
def star_error(run):
    (whole, whole_us), (star, star_us) = _both(run, run.synth(run.spec("speed_ellipsoid")), "reflectance")
    return Result(f"{percent(whole)} by the level set ({whole_us:.0f} µs), {percent(star)} by the star ({star_us:.0f} µs)",
                  abs(star - whole) <= 0.01 and star_us < whole_us / 4)
