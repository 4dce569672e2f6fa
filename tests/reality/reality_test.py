#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of docs/reality: level lines against circles and ellipses, variants against what they are said to do, and each
verdict from a small evaluation as `glint evaluate --json` writes it. A judge that takes an error for an answer would hide errors."""
import json
import math
import pathlib
import sys
import tempfile
import unittest

import numpy as np

root = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(root / "docs"))
from reality import contours, pictures, rungs, scenes, variants, verdict  # noqa: E402


def lobe(shape, centre, axes, turn=0.0, height=1.0):
    """A Gaussian whose half level is the ellipse of these semi-axes."""
    y, x = np.mgrid[:shape[0], :shape[1]].astype(float)
    c, s = math.cos(turn), math.sin(turn)
    u, v = c * (x - centre[0]) + s * (y - centre[1]), -s * (x - centre[0]) + c * (y - centre[1])
    return height * np.exp(-math.log(2) * ((u / axes[0]) ** 2 + (v / axes[1]) ** 2))


def away(points, centre, axes, turn=0.0):
    """How far points are from the ellipse, to first order, px."""
    c, s = math.cos(turn), math.sin(turn)
    out = []
    for x, y in points:
        u, v = c * (x - centre[0]) + s * (y - centre[1]), -s * (x - centre[0]) + c * (y - centre[1])
        q = math.hypot(u / axes[0], v / axes[1])
        out.append(abs(q - 1) * q / math.hypot(u / axes[0] ** 2, v / axes[1] ** 2))
    return max(out)


class LevelLines(unittest.TestCase):
    def testACircleIsFoundWhereItIs(self):
        ((points, closed),) = contours.level_lines(lobe((80, 100), (51.3, 38.8), (20, 20)), 0.5)
        self.assertTrue(closed)
        self.assertLess(away(points, (51.3, 38.8), (20, 20)), 0.02)  # the chord of a cell on a circle of 20 px: 1 / (8 * 20)
        self.assertLess(abs(abs(contours.area(points)) / (math.pi * 400) - 1), 2e-3)

    def testATurnedEllipseFromTheTruthOfOneLamp(self):
        truth = contours.truth_of([lobe((120, 120), (60.2, 55.7), (24, 11), 0.7, height=7.0)])
        (found,) = truth["levels"]["0.50"]
        self.assertTrue(found["closed"])
        self.assertLess(away(found["points"], (60.2, 55.7), (24, 11), 0.7), 0.03)
        self.assertLess(math.dist(truth["peak_subpixel"], (60.2, 55.7)), 1e-6)  # the logarithm of this lobe is a paraboloid

    def testEachLampHasItsOwnHalf(self):
        truth = contours.truth_of([lobe((80, 200), (x, 40), (9, 9), height=h) for x, h in ((50, 1.0), (150, 0.2))])
        for found, x in zip(truth["levels"]["0.50"], (50, 150), strict=True):
            self.assertLess(away(found["points"], (x, 40), (9, 9)), 0.05)

    def testALineThatLeavesThePictureIsOpenAndWhole(self):
        ((points, closed),) = contours.level_lines(lobe((60, 60), (30, 2.5), (15, 15)), 0.5)
        self.assertFalse(closed)
        self.assertEqual(sorted(round(p[1], 9) for p in (points[0], points[-1])), [0, 0])
        self.assertLess(away(points, (30, 2.5), (15, 15)), 0.02)

    def testSaddlesAreJoinedByTheirMean(self):
        low, high = np.array([[0, 1.2], [1.2, 0]]), np.array([[1.6, 0], [0, 1.6]])
        self.assertEqual([len(contours.level_lines(v, 0.5)) for v in (low, high)], [2, 2])
        self.assertEqual(contours.level_lines(np.zeros((5, 5)), 0.5), [])

    def testSmoothingKeepsAQuadraticAndLowersNoise(self):
        y, x = np.mgrid[:30, :30].astype(float)
        quadratic = 1 + 0.1 * x - 0.2 * y + 0.01 * x * y + 0.03 * x * x
        self.assertLess(np.abs(contours.smoothed(quadratic) - quadratic)[2:-2, 2:-2].max(), 1e-9)
        noise = np.random.default_rng(1).normal(size=(60, 60))
        self.assertLess(contours.smoothed(noise).std(), 0.5)


class Variants(unittest.TestCase):
    light = np.tile(np.linspace(0.001, variants.PEAK, 64), (48, 1))

    def testCurvesInvert(self):
        for kind, gamma in (("gamma18", 1.8), ("gamma22", 2.2), ("linear", 1.0)):
            self.assertLess(np.abs(variants.developed(kind, self.light, 0) ** gamma - self.light).max(), 1e-12, kind)
        self.assertLess(np.abs(pictures.srgb_light(variants.developed("clean", self.light, 0)) - self.light).max(), 1e-12)

    def testEveryCurveRisesFromBlackToWhite(self):
        ramp = np.linspace(0, 1, 1001)
        for kind, curve in variants.CURVES.items():
            codes = curve(ramp)
            self.assertTrue((np.diff(codes) > 0).all() and codes[0] == 0 and codes[-1] <= 1 + 1e-12, kind)

    def testAClippedPictureIsClipped(self):
        codes = variants.developed("clipped3", self.light, 0)
        self.assertLess(abs((codes > 1 - 1e-9).mean() - 2 / 3), 0.02)  # a ramp to three times white
        self.assertLess((variants.developed("clean", self.light, 0) > 1 - 1e-9).mean(), 1e-9)

    def testVignettingTakesFromTheCornersOnly(self):
        left = variants.vignetting((101, 201))
        self.assertEqual((left[50, 100], round(left[0, 0], 12), round(left[-1, -1], 12)), (1.0, 0.6, 0.6))

    def testExposureChangesInOneVariantAlone(self):
        factors = [variants.exposure("tone-jpeg-exposure", k) for k in range(14)]
        self.assertLess(max(factors), 1.0001)
        self.assertGreater(max(factors) / min(factors), 1.8)
        self.assertEqual({variants.exposure("jpeg60", k) for k in range(14)}, {1.0})

    def testBumpsAreAsHighAsTheyAreSaid(self):
        vertices, _ = variants.ellipsoid_mesh([0.15, 0.09, 0.07], 3)
        moved = np.linalg.norm(variants.bumpy(vertices) - vertices, axis=1)
        self.assertLess(abs(moved.max() - 0.001), 1e-9)
        self.assertGreater(moved.mean(), 0.0002)

    def testAMeshComesBackFromItsFile(self):
        vertices, faces = variants.ellipsoid_mesh([0.15, 0.09, 0.07], 2)
        with tempfile.TemporaryDirectory() as folder:
            variants.write_ply(pathlib.Path(folder) / "m.ply", vertices, faces)
            v, f = variants.read_ply(pathlib.Path(folder) / "m.ply")
        self.assertTrue((v == vertices).all() and (f == faces).all())

    def testShakenPosesStayRigidAndSmall(self):
        pose = np.eye(4)
        pose[2, 3] = 1.0
        moved = np.array(variants.shaken([pose.tolist()] * 40, np.zeros(3)))
        turns = [math.degrees(math.acos(min(1, (np.trace(m[:3, :3]) - 1) / 2))) for m in moved]
        self.assertLess(max(abs(np.linalg.det(m[:3, :3]) - 1) for m in moved), 1e-12)
        self.assertTrue(0.05 < np.mean(turns) < 0.12)  # three angles of 0.05 degrees
        self.assertLess(np.abs(moved[:, :3, 3] - [0, 0, 1]).max(), 0.001)

    def testACutContourEndsAtTheBorder(self):
        circle = [[50 + 10 * math.cos(t), 50 + 10 * math.sin(t)] for t in np.linspace(0, 2 * math.pi, 100, endpoint=False)]
        (part,) = variants.cut({"closed": True, "points": circle}, 53.0)
        self.assertFalse(part["closed"])
        self.assertEqual((part["points"][0][1], part["points"][-1][1]), (53.0, 53.0))
        self.assertLess(max(p[1] for p in part["points"]), 53.0001)
        whole = {"closed": True, "points": circle}
        self.assertEqual(variants.cut(whole, 70.0), [whole])

    def testAVariantIsWrittenWhole(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            pictures.write(folder / "a.png", lobe((60, 80), (40, 30), (5, 5)))
            contours.write_truth(folder / "truth", "a", contours.truth_of([lobe((60, 80), (40, 30), (5, 5))]))
            camera = {"width": 80, "height": 60, "fx": 90, "fy": 90, "cx": 39.5, "cy": 29.5}
            (folder / "scene.json").write_text(json.dumps(
                {"glint_scene": 1, "name": "a", "camera": camera,
                 "surfaces": {"s": {"analytic": {"type": "sphere", "radius": 1}}},
                 "lights": [{"id": "lamp", "position": [0, 0, 1]}],
                 "frames": [{"id": "a", "image": "a.png", "radiance": "a.tiff"}]}))
            base = variants.Base(folder / "scene.json", folder / "truth", lambda codes: codes)
            for kind in ("jpeg60", "cropped", "stated"):
                variants.make(kind, base, folder / kind)
            scene = {kind: json.loads((folder / kind / "scene.json").read_text()) for kind in ("jpeg60", "cropped", "stated")}
            self.assertEqual(scene["jpeg60"]["frames"], [{"id": "a", "image": "frames/a.jpg"}])  # neither lamp nor radiance
            self.assertNotIn("lights", scene["jpeg60"])
            self.assertEqual(scene["stated"]["camera"]["response"], "gamma:1.8")
            own = scene["cropped"]["frames"][0]["camera"]
            cut = json.loads((folder / "cropped/truth/a.json").read_text())["levels"]["0.50"][0]
            self.assertEqual(pictures.read(folder / "cropped/frames/a.png").shape, (own["height"], 80))
            self.assertAlmostEqual(max(p[1] for p in cut["points"]), own["height"] - 0.5)
            # the lobe's own peak stands where the moved camera says
            picture = pictures.read(folder / "cropped/frames/a.png")
            self.assertEqual(np.unravel_index(picture.argmax(), picture.shape)[0], 30 - (29.5 - own["cy"]))


class KnownLamps(unittest.TestCase):
    def testADomeSpreadsOverTheUpperHemisphere(self):
        directions = np.array([lamp["direction"] for lamp in rungs.dome()])
        self.assertLess(np.abs(np.linalg.norm(directions, axis=1) - 1).max(), 1e-12)
        self.assertTrue((directions[:, 2] > 0.28).all())
        between = directions @ directions.T - 2 * np.eye(13)
        self.assertGreater(math.degrees(math.acos(between.max())), 25)  # an even spread over this cap has about 35
        self.assertLess(np.linalg.norm(directions[:, :2].sum(0)), 1.5)  # on all sides

    def composed(self, folder, lamps):
        """A scene of two photographs, each with one of two lobes; Blender's part is played by arrays."""
        (folder / "light").mkdir()
        frames = [{"id": name, "camera_from_world": np.eye(4).tolist(), "on": [k]} for k, name in enumerate("ab")]
        for k, frame in enumerate(frames):
            light = lobe((60, 80), (25 + 30 * k, 30), (8, 6))
            np.save(folder / f"light/{frame['id']}-{k}.npy", light)
            np.save(folder / f"light/{frame['id']}.npy", np.repeat(light[..., None], 3, 2))
        (folder / "made.json").write_text(json.dumps(
            {"camera": {"width": 80}, "semi_axes": [1, 1, 1], "frames": frames, "lamps": ["sun", "sun"]}))
        scenes.compose(rungs.Rung("r", "", render={"lamps": lamps}), folder)
        return json.loads((folder / "scene.json").read_text())

    def testEachPhotographNamesItsLampAndHasItsTruthAlone(self):
        with tempfile.TemporaryDirectory() as name:
            scene = self.composed(pathlib.Path(name), rungs.dome()[:2])
            self.assertEqual((scene["glint_scene"], [f["lights_on"] for f in scene["frames"]]), (2, [["dome-01"], ["dome-02"]]))
            self.assertEqual({k for light in scene["lights"] for k in light}, {"id", "frame", "direction", "known", "sigma_deg"})
            for file, x in (("a", 25), ("b", 55)):
                (found,) = json.loads((pathlib.Path(name) / f"truth/{file}.json").read_text())["levels"]["0.50"]
                self.assertLess(away(found["points"], (x, 30), (8, 6)), 0.05)

    def testLampsThatAreNotKnownStayUnsaid(self):
        with tempfile.TemporaryDirectory() as name:
            scene = self.composed(pathlib.Path(name), [rungs.LAMP, rungs.LAMP])
        self.assertEqual((scene["glint_scene"], "lights" in scene, "lights_on" in scene["frames"][0]), (1, False, False))


def evaluation(error_pct=0.1, error_px=0.2, status="ok", reason="", warnings=(), matched=8, missed=0, spurious=0,
               model="reflectance", coverage=0.95):
    statistic = {"mean": error_pct}
    return {"warnings": list(warnings), "chosen_model": model, "why_chosen": "", "models": {model: {
        "status": status, "reason": reason, "fits": [{"reason": reason, "warnings": []}],
        "band": {"sigma_px": 0.1, "coverage_95": coverage},
        "summary": {"predicted": 0 if status == "failed" else 8, "matched": matched, "missed": missed, "spurious": spurious,
                    "contour_error_pct": statistic, "contour_error_px": {"mean": error_px}}}}}


class Verdicts(unittest.TestCase):
    def judged(self, model="reflectance", causes="", border=verdict.RIGHT_PCT, **values):
        return verdict.judged(evaluation(**values), model, causes, border)

    def testRight(self):
        found = self.judged()
        self.assertEqual((found.verdict, found.error_pct, found.coverage), (verdict.RIGHT, 0.1, 0.95))
        self.assertEqual(self.judged(error_pct=0.9, error_px=0.04).verdict, verdict.RIGHT)  # a small highlight
        self.assertEqual(self.judged(error_pct=5.0, error_px=1.0, border=8).verdict, verdict.RIGHT)

    def testJustAboveTheBorderIsNear(self):
        self.assertEqual([self.judged(error_pct=e).verdict for e in (0.3, 0.301, 0.6, 0.601)],
                         [verdict.RIGHT, verdict.NEAR, verdict.NEAR, verdict.CONFIDENT])
        self.assertEqual(self.judged(error_pct=0.4, warnings=["a doubt"]).verdict, verdict.WARNED)

    def testAnErrorWithAWarningIsWarned(self):
        found = self.judged(error_pct=2.0, warnings=["reflectance, light lamp: the pixel residuals have a pattern"])
        self.assertEqual((found.verdict, found.said), (verdict.WARNED, "the pixel residuals have a pattern"))
        self.assertEqual(self.judged(error_pct=2.0, status="poor", reason="1.5 px remain").verdict, verdict.WARNED)

    def testAnErrorWithoutADoubtIsConfident(self):
        self.assertEqual(self.judged(error_pct=2.0).verdict, verdict.CONFIDENT)
        neutral = "reflectance, light lamp: Fitted to one contour per highlight: no other levels are given."
        self.assertEqual(self.judged(error_pct=2.0, warnings=[neutral]).verdict, verdict.CONFIDENT)
        for other in ("limit-angle, light lamp: poor: 3 px remain", "limit-angle, light: poor: 3 px remain",
                      "canonical, lightbulb, surface a: 3 px"):
            self.assertEqual(self.judged(error_pct=2.0, warnings=[other]).verdict, verdict.CONFIDENT)

    def testWhatIsMissedOrInventedIsNotRight(self):
        self.assertEqual(self.judged(missed=2).verdict, verdict.CONFIDENT)
        self.assertEqual(self.judged(spurious=2).verdict, verdict.CONFIDENT)
        self.assertEqual(self.judged(matched=0, missed=8, error_pct=None, error_px=None).verdict, verdict.CONFIDENT)

    def testRefusals(self):
        values = dict(status="failed", reason="texture under the highlight", error_pct=None, error_px=None)
        self.assertEqual(self.judged(causes="textur", **values).verdict, verdict.REFUSED)
        self.assertEqual(self.judged(causes="border", **values).verdict, verdict.SILENT)
        self.assertEqual(self.judged(**values).said, "texture under the highlight")

    def testAutoIsItsChoiceOrItsRefusal(self):
        self.assertEqual((self.judged("auto").verdict, self.judged("auto").model), (verdict.RIGHT, "reflectance"))
        document = dict(evaluation(), chosen_model=None, why_chosen="no model is good enough: the lamp moves",
                        selection={"status": "failed", "best": "reflectance"})
        self.assertEqual(verdict.judged(document, "auto", "moves").verdict, verdict.REFUSED)
        self.assertEqual(verdict.judged(document, "auto", "").verdict, verdict.SILENT)


class Page(unittest.TestCase):
    def testEveryRungStandsOnThePage(self):
        page = (root / "docs/reality.md").read_text()
        names = [r.name for r in rungs.computed() + rungs.rendered()]
        for group, some in (("exact", rungs.EXACT), ("ladder", rungs.LADDER), ("cycles", rungs.CYCLES)):
            names += [f"{group}/{r.name}" for r in some]
        self.assertEqual([n for n in names if f"| {n} |" not in page], [])
        self.assertEqual(len(names), len(set(names)))


if __name__ == "__main__":
    unittest.main()
