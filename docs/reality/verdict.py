# SPDX-License-Identifier: BSD-3-Clause
"""What one run of `glint evaluate` is worth: its error against truth, and whether its words agree with it."""
import dataclasses
import math
import re

RIGHT, NEAR, WARNED, CONFIDENT = "right", "near", "warned", "CONFIDENT ERROR"
REFUSED, SILENT = "refused by name", "refused, no cause"
STOPPED, MISSING = "stopped", "missing"
VERDICTS = (RIGHT, NEAR, WARNED, REFUSED, SILENT, CONFIDENT, STOPPED, MISSING)

RIGHT_PCT = 0.3  # of the diameter: the bound of issue 54 for most rows
RIGHT_PX = 0.05  # what true contours of a path tracer are known to; on a highlight of 6 px it is 0.8 %
NEAR_TIMES = 2  # so many borders need no warning: limit-angle is 0.30 % off on a path-traced sphere, by what it assumes
MOST_LOST = 0.1  # share of true highlights that may be missed, or of predicted ones that may be invented

# Remarks that say how a fit was made, and doubt nothing.
NEUTRAL = (r"Fitted to one contour per highlight: no other levels are given",
           r"^clipped \(saturated\) highlights .*comes from the lobe fitted around",
           r"the light has an extent of")


@dataclasses.dataclass
class Judgement:
    verdict: str
    said: str = ""  # first words of what the program said
    error_pct: float = math.nan
    error_px: float = math.nan
    coverage: float = math.nan  # of the 95 % band, from 0 to 1
    matched: int = 0
    missed: int = 0
    spurious: int = 0
    model: str = ""  # that auto chose


def number(value):
    return math.nan if value is None else float(value)


# How a warning about one model begins: "reflectance, light A, surface ball: ".
OF_MODEL = r"(primal|dual|canonical|limit-angle|reflectance), [^:]*: "


def of_other_model(warning, model):
    head = re.match(OF_MODEL, warning)
    return head and head[1] != model


def doubts(document, model):
    """Warnings about the input and about this model that name a doubt, and why it is poor."""
    result = document.get("models", {}).get(model, {})
    said = [w for w in document.get("warnings", []) if not of_other_model(w, model)]
    said += [w for fit in result.get("fits", []) for w in fit.get("warnings", [])]
    if result.get("status") == "poor":
        said += [result.get("reason", "")] + [fit.get("reason", "") for fit in result.get("fits", [])]
    kept = []
    for text in said:
        bare = re.sub("^" + OF_MODEL, "", text)
        if bare and not any(re.search(pattern, bare) for pattern in NEUTRAL) and bare not in kept:
            kept.append(bare)
    return kept


def refusal(said, causes):
    named = any(re.search(causes, text, re.IGNORECASE) for text in said) if causes else False
    return Judgement(REFUSED if named else SILENT, said[0] if said else "nothing")


def judged(document, asked, causes="", border_pct=RIGHT_PCT):
    """`asked`: a model's name or "auto". `causes`: a pattern of the words that would name this rung's difficulty."""
    model = asked
    if asked == "auto":
        selection = document.get("selection") or {}
        model = document.get("chosen_model") or ""
        if not model or selection.get("status") == "failed":
            return refusal([document.get("why_chosen") or ""] + doubts(document, selection.get("best") or ""), causes)
    result = document["models"][model]
    summary = result["summary"]
    said = doubts(document, model)
    if result["status"] == "failed" or not summary["predicted"]:
        reasons = [result.get("reason", "")] + [fit.get("reason", "") for fit in result.get("fits", [])]
        return refusal([r for r in reasons if r] + said, causes)
    found = Judgement("", said[0] if said else "", model=model if asked == "auto" else "")
    found.error_pct, found.error_px = (number(summary[key]["mean"]) for key in ("contour_error_pct", "contour_error_px"))
    found.matched, found.missed, found.spurious = (summary[key] for key in ("matched", "missed", "spurious"))
    found.coverage = number((result.get("band") or {}).get("coverage_95"))
    # Comparisons are False where there is no number.
    right = found.error_pct <= border_pct or found.error_px <= RIGHT_PX
    near = found.error_pct <= NEAR_TIMES * border_pct or found.error_px <= NEAR_TIMES * RIGHT_PX
    lost = any(n > MOST_LOST * (found.matched + n) for n in (found.missed, found.spurious))
    found.verdict = RIGHT if right and not lost else WARNED if said else NEAR if near and not lost else CONFIDENT
    return found
