# SPDX-License-Identifier: BSD-3-Clause
"""Section 2: meshes with smooth bumps, and what `light.refine_normals` takes back of what they cost.

The scenes are those of band.py: exact contours of an ellipsoid and a sphere, seen on meshes of them with bumps. Errors are those of held-out frames against the
exact contours. `first:6` trains on one end of the path: most held-out highlights then lie where no training highlight was, and nothing tells of the bumps there.
"""
import copy
import functools
import math
import random
import statistics

from audit import band
from audit.harness import Result, line, mean_error

SEEDS = 3  # of each base
MODELS = ["limit-angle", "reflectance"]
BASES = ["band_ellipsoid", "band_sphere"]


def place_of(r, base, bump, seed):
    folder, scene, spec = band.exact(r, base)
    if bump is None:
        return band.write(folder, "normals_exact", copy.deepcopy(scene))
    rng = random.Random("normals %s %g %d" % (base, bump, seed))
    mesh = band.mesh_text(band.semi_axes(spec), 5 if bump else 6, rng, bump=bump / 100)
    return band.write(folder, "normals_%g_%d" % (bump, seed), copy.deepcopy(scene), mesh)


def errors(r, place, arguments):
    evaluation = r.evaluate(place, "--models", ",".join(MODELS), *arguments, truth=False)
    return [mean_error(evaluation, model) for model in MODELS]


def both(r, bump, train, noise):
    """(without, with) of every case and model, by model."""
    pairs = {model: [] for model in MODELS}
    for base in BASES:
        for seed in range(SEEDS if bump else 1):
            arguments = ["--train", train] + (["--noise-px", noise, "--seed", seed + 1] if noise else [])
            place = place_of(r, base, bump, seed)
            plain, refined = errors(r, place, arguments), errors(r, place, arguments + ["--set", "light.refine_normals=true"])
            for model, a, b in zip(MODELS, plain, refined):
                pairs[model].append((a, b))
    return pairs


def bumps(r, bump, train, noise, share):
    """Means over the cases that both answer; no case may be refused that was answered without."""
    texts, holds = [], True
    for model, pairs in both(r, bump, train, noise).items():
        answered = [p for p in pairs if not any(map(math.isnan, p))]
        gained, lost = (sum(math.isnan(p[k]) and not math.isnan(p[1 - k]) for p in pairs) for k in (0, 1))
        without, refined = (statistics.mean(p[k] for p in answered) for k in (0, 1))
        holds = holds and not lost and refined <= share * without
        texts.append("%s %.3g -> %.3g %% (worst case times %.2g%s%s)" % (
            model, without, refined, max(b / a for a, b in answered),
            ", %d of %d answered only with it" % (gained, len(pairs)) if gained else "", ", %d lost" % lost if lost else ""))
    return Result("; ".join(texts), holds)


def nothing_wrong(r, bump, noise):
    changed = [pair for train in ("first:6", "spread:6") for pairs in both(r, bump, train, noise).values() for pair in pairs]
    worst = max(b - a for a, b in changed)
    return Result("at most %.3g percentage points more" % worst, worst <= 0.01)


for bump in (0.02, 0.2):
    line("2.6", "refined normals, bumps of %g %%, spread:6" % bump, "mean error at most half of that without")(
        functools.partial(bumps, bump=bump, train="spread:6", noise=0, share=0.5))
    line("2.6", "refined normals, bumps of %g %%, first:6" % bump, "mean error at most nine tenths of that without")(
        functools.partial(bumps, bump=bump, train="first:6", noise=0, share=0.9))
line("2.6", "refined normals, bumps of 0.2 %, 0.3 px noise, spread:6", "mean error at most half of that without")(
    functools.partial(bumps, bump=0.2, train="spread:6", noise=0.3, share=0.5))
line("2.6", "refined normals, exact shapes",
     "within 0.01 percentage points of the error without")(functools.partial(nothing_wrong, bump=None, noise=0))
line("2.6", "refined normals, meshes without bumps",
     "within 0.01 percentage points of the error without")(functools.partial(nothing_wrong, bump=0, noise=0))
line("2.6", "refined normals, meshes without bumps, 0.3 px noise", "within 0.01 percentage points of the error without")(
    functools.partial(nothing_wrong, bump=0, noise=0.3))
