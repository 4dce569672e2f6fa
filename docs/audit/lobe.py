# SPDX-License-Identifier: BSD-3-Clause
"""Lobes, long lamps and several levels, from exact contours that the scene gives: no pixels, no detection."""
import functools
import hashlib
import json
import math
import statistics

from .harness import Result, line, mean_error, percent

FIRST, SPREAD = "first:6", "spread:6"
LOBES = ("torrance-sparrow", "ggx", "blinn-phong", "phong")


def exact_scene(runner, spec, levels=(0.5,)):
    """Folder of a scene that gives exact contours at some levels and has no images, the first level leading."""
    text = json.dumps([spec, levels], sort_keys=True)
    folder = runner.scratch / ("exact" + hashlib.sha256(text.encode()).hexdigest()[:16])
    if (folder / "scene.json").exists():
        return folder
    folder.mkdir(exist_ok=True)
    scene = None
    for k, level in enumerate(levels):
        part = folder / f"level{k}"
        (folder / "spec.json").write_text(json.dumps(dict(spec, level=level)))
        runner.glint("synth", folder / "spec.json", "-o", part, check=True)
        made = json.loads((part / "scene.json").read_text())
        if scene is None:
            scene = made
        else:
            for frame, more in zip(scene["frames"], made["frames"]):
                frame["highlights"] = frame.get("highlights", []) + more.get("highlights", [])
    for frame in scene["frames"]:
        for key in ("image", "radiance", "depth", "normals", "mask"):
            frame.pop(key, None)
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder


def reflectance(runner, scene, *arguments):
    """Mean held-out error in percent (nan where not every frame is answered) and the fit of the reflectance model."""
    e = runner.evaluate(scene, "--models", "reflectance", *arguments, truth=False)
    fits = e["models"]["reflectance"]["fits"]
    return mean_error(e, "reflectance"), (fits[0] if fits else {})


def worst_of(runner, cases, arguments=lambda lobe: ()):
    """Right lobes and the worst error of (surface, lobe, roughness, level) cases."""
    right, worst = 0, 0.0
    for surface, lobe, roughness, level in cases:
        changes = {"render.reflectance": lobe, "render.roughness": roughness}
        if surface == "sphere":
            changes["surfaces.body.analytic"] = {"type": "sphere", "radius": 0.3}
        scene = exact_scene(runner, runner.spec("lobe_ellipsoid", **changes), (level,))
        error, fit = reflectance(runner, scene, "--train", FIRST, "--level", level, *arguments(lobe))
        right += fit.get("lobe") == lobe
        worst = max(worst, math.inf if math.isnan(error) else error)
    return right, worst


@line("1.7", "wide Beckmann lobes, `fit.lobe=auto`", "the right lobe in all, error ≤ 0.003 %, a chord's share of the contours")
def wide_lobes(runner):
    cases = [(s, "torrance-sparrow", m, q) for s in ("ellipsoid", "sphere") for m in (0.2, 0.4, 0.7) for q in (0.5, 0.8)]
    right, worst = worst_of(runner, cases)
    return Result(f"{right} of {len(cases)} right, worst error {worst:.2g} %", right == len(cases) and worst <= 3e-3)


@line("1.7", "every lobe, m 0.05 to 0.5", "the right lobe in all, error ≤ 0.01 %, a chord's share of small contours")
def every_lobe(runner):
    cases = [("ellipsoid", lobe, m, 0.5) for lobe in LOBES for m in (0.05, 0.2, 0.5) if not (lobe == "phong" and m > 0.3)]
    right, worst = worst_of(runner, cases)
    return Result(f"{right} of {len(cases)} right, worst error {worst:.2g} %", right == len(cases) and worst <= 1e-2)


@line("1.7", "Beckmann m 0.7 at level 0.8, forced", "answers, error ≤ 0.001 %")
def forced(runner):
    cases = [(s, "torrance-sparrow", 0.7, 0.8) for s in ("ellipsoid", "sphere")]
    _, worst = worst_of(runner, cases, lambda lobe: ("--set", "fit.lobe=" + lobe))
    return Result("no answer" if math.isinf(worst) else f"worst error {worst:.2g} %", worst <= 1e-3)


@line("2", "long lamp from contours", "≤ 0.15 %, centre ≤ 5 mm, axis ≤ 0.5 degrees, length ≤ 1 %")
def long_lamp(runner):
    spec = runner.spec("lobe_long_lamp")
    scene = exact_scene(runner, spec)
    a, b = spec["lights"][0]["segment"]
    errors, words = [], []
    holds = True
    for train in (FIRST, SPREAD):
        error, fit = reflectance(runner, scene, "--train", train)
        errors.append(error)
        ends = fit.get("light_segment")
        if not ends:
            holds = False
            continue
        p, q = ends
        centre = math.dist([(x + y) / 2 for x, y in zip(p, q)], [(x + y) / 2 for x, y in zip(a, b)])
        cosine = abs(sum((x - y) * (u - v) for x, y, u, v in zip(p, q, a, b))) / (math.dist(p, q) * math.dist(a, b))
        axis = math.degrees(math.acos(min(1.0, cosine)))
        length = abs(math.dist(p, q) / math.dist(a, b) - 1) * 100
        words.append(f"centre {centre * 1e3:.1f} mm, axis {axis:.2f} degrees, length {length:.2f} %")
        holds = holds and centre <= 5e-3 and axis <= 0.5 and length <= 1
    holds = holds and all(e <= 0.15 for e in errors)
    return Result(" / ".join(map(percent, errors)) + " (first / spread 6)" + "".join("; " + w for w in words), holds)


def levels(runner, camera):
    spec = runner.spec("lobe_ellipsoid",
                       **{"render.reflectance": "ggx", "render.roughness": 0.1, "path.orbit.count": 16, **camera})
    scene = exact_scene(runner, spec, (0.5, 0.3, 0.7))
    known = runner.glint("settings").stdout
    several = ("--set", "fit.evidence=levels") if "fit.evidence" in known else ()
    right, medians = 0, []
    for train in (FIRST, SPREAD):
        errors = []
        for seed in range(1, 21):
            error, fit = reflectance(runner, scene, "--train", train, "--noise-px", 1, "--seed", seed, *several)
            right += fit.get("lobe") == "ggx"
            errors.append(100.0 if math.isnan(error) else error)
        medians.append(statistics.median(errors))
    return Result(f"{medians[0]:.2f} / {medians[1]:.2f} % (first / spread 6), lobe {right} of 40",
                  right == 40 and medians[0] <= 0.95 and medians[1] <= 0.25)


LARGER = {"camera": {"width": 1600, "height": 1200, "fx": 2000, "fy": 2000, "cx": 799.5, "cy": 599.5}}
for title, camera in (("several levels, 1 px noise on given contours, GGX ellipsoid, 14 to 22 px wide", {}),
                      ("several levels, 1 px noise on given contours, GGX ellipsoid, 36 to 55 px wide", LARGER)):
    line("2", title, "the lobe in all, median ≤ 0.95 % first 6, ≤ 0.25 % spread")(functools.partial(levels, camera=camera))
