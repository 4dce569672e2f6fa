#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/depth.md: contour errors with depth maps in place of the surface, against noise, radius, smoothing and fusion, and the jitter of the
predicted peak over still frames. Scenes come from `glint synth` and from the path-traced sphere; `glint evaluate` adds the noise and scores."""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

MODELS = ["primal", "dual", "canonical", "limit-angle", "reflectance"]
TRAIN = [0, 13, 26, 39, 53, 66]                  # of the 80 poses of resources/specs/ellipsoid_80.json
HELD_OUT = [4, 18, 30, 44, 60, 76]
SPHERE = list(range(0, 24, 2))                   # of the path-traced sphere: the first six train
COPIES = 6                                       # still frames for the jitter
SEEDS = (1, 2)
SCALE = 0.5                                      # 320 x 240 pixels, focal length 400 px


def fail(text):
    sys.exit(f"make_depth.py: {text}")


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        fail(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


class Maker:
    def __init__(self, glint, root, folder):
        self.glint, self.root, self.folder = str(glint), root, folder
        self.scenes = {}
        self.known = {}

    def write(self, name, scene):
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        (folder / "scene.json").write_text(json.dumps(scene))
        self.scenes[name] = folder / "scene.json"

    def ellipsoid(self):
        spec = json.loads((self.root / "resources/specs/ellipsoid_80.json").read_text())
        camera = spec["camera"]
        for key in ("fx", "fy"):
            camera[key] *= SCALE
        for key, size in (("cx", "width"), ("cy", "height")):
            camera[size] = round(camera[size] * SCALE)
            camera[key] = (camera[size] - 1) / 2
        spec.pop("limit_angle_deg")
        spec.update(contour="radiance", level=0.5, margin_px=200, name="depth")
        spec["render"] = {"reflectance": "torrance-sparrow", "roughness": 0.12, "bits": 32}
        spec["path"]["cameras"] = [spec["path"]["cameras"][i] for i in TRAIN + HELD_OUT]
        (self.folder / "spec.json").write_text(json.dumps(spec))
        run([self.glint, "synth", str(self.folder / "spec.json"), "-o", str(self.folder / "synth")])
        scene = json.loads((self.folder / "synth/scene.json").read_text())
        for f in scene["frames"]:
            f["depth"] = str(self.folder / "synth" / f["depth"])
            for key in ("image", "radiance", "normals", "mask"):
                f.pop(key, None)
        self.write("ellipsoid-given", scene)
        depth = json.loads(json.dumps(scene))
        depth.pop("surfaces")
        for f in depth["frames"]:
            f.pop("surface")
        self.write("ellipsoid", depth)
        still = json.loads(json.dumps(depth))
        one = still["frames"][len(TRAIN) + 2]
        still["frames"] = still["frames"][:len(TRAIN)] + [dict(one, id=f"still-{i}") for i in range(COPIES)]
        self.write("still", still)

    def sphere(self, data):
        folder = data / "cycles/sphere"
        scene = json.loads((folder / "scene.json").read_text())
        scene["frames"] = [scene["frames"][i] for i in SPHERE]
        for f in scene["frames"]:
            for key in ("image", "radiance", "depth"):
                f[key] = str(folder / f[key])
        given = json.loads(json.dumps(scene))
        for s in given["surfaces"].values():
            s["mesh"] = str(folder / s["mesh"])
        self.write("sphere-given", given)
        scene.pop("surfaces")
        for f in scene["frames"]:
            f.pop("surface")
        self.write("sphere", scene)

    def arguments(self, name, models, settings):
        a = [str(self.scenes[name]), "--train", "0-5", "--models", ",".join(models), "--allow-outside"]
        for key, value in settings:
            a += ["--set", f"surface.depth_{key}={value}"]
        return a

    def score(self, key):
        """Each model's mean contour error in percent, predicted and all frames, and mean peak offset in pixels."""
        name, models, settings = key
        extra = ["--truth", str(self.truth)] if name.startswith("sphere") else []
        found = json.loads(run([self.glint, "evaluate", *self.arguments(name, models, settings), *extra, "--json", "-"]))
        result = {}
        print(f"{name} {dict(settings)}", file=sys.stderr, flush=True)
        for model, r in found["models"].items():
            s = r["summary"]
            result[model] = (s["contour_error_pct"]["mean"], s["predicted"], s["frames"], s["peak_offset_px"]["mean"])
        return result

    def jitter(self, settings):
        """Root mean square distance of the predicted peaks of the still frames from their mean, px; None where the model failed."""
        session = self.folder / f"still{abs(hash(settings))}.glint"
        done = subprocess.run([self.glint, "reconstruct", *self.arguments("still", ["limit-angle"], settings), "-o",
                               str(session)], capture_output=True, text=True)
        if done.returncode == 3:
            return None
        if done.returncode:
            fail(done.stderr.strip())
        text = run([self.glint, "predict", str(session), "--frames", f"6-{5 + COPIES}", "--allow-outside", "--json", "-"])
        peaks = [p["peak"] for p in peaks_of(json.loads(text))]
        if len(peaks) < 2:
            return None
        mean = [statistics.fmean(p[k] for p in peaks) for k in (0, 1)]
        return math.sqrt(sum((p[0] - mean[0])**2 + (p[1] - mean[1])**2 for p in peaks) / (len(peaks) - 1)), len(peaks)

    def work(self, keys, jitters, jobs):
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            scores = {k: pool.submit(self.score, k) for k in dict.fromkeys(keys)}
            stills = {j: pool.submit(self.jitter, j) for j in dict.fromkeys(jitters)}
            self.known = {k: f.result() for k, f in scores.items()}
            self.still = {j: f.result() for j, f in stills.items()}


def peaks_of(node):
    """Every predicted highlight with a peak, wherever it is."""
    if isinstance(node, dict):
        if isinstance(node.get("peak"), list):
            yield node
        for v in node.values():
            yield from peaks_of(v)
    elif isinstance(node, list):
        for v in node:
            yield from peaks_of(v)


def shown(values):
    """Mean error over seeds of one model; predicted/frames where some failed; the word of a refusal."""
    errors = [v[0] for v in values if v[0] is not None]
    predicted, frames = sum(v[1] for v in values), sum(v[2] for v in values)
    if not errors:
        return "refused"
    return f"{statistics.fmean(errors):.2f} %" + (f" ({predicted}/{frames})" if predicted < frames else "")


def noisy(times, seed, **settings):
    return (("noise", times), ("seed", seed), *sorted(settings.items()))


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head),
                      *("| " + " | ".join(r) + " |" for r in rows)]) + "\n"


FIT = dict(smoothing="fit")
RADII = (0.03, 0.06, 0.09)
NOISES = (0.5, 2)
FUSED = (0, 3, 6)
TWO = ("limit-angle", "reflectance")
BEST = 0.09


def sections(maker, scenes):
    keys, jitters, out = [], [], []
    get = lambda key: (keys.append(key), maker.known.get(key))[1] if not maker.known else maker.known[key]

    def cell(name, models, model, settings_of_seed, seeds):
        found = [get((name, models, settings_of_seed(s))) for s in seeds]
        return "" if not maker.known else shown([f[model] for f in found])

    def still(settings):
        jitters.append(settings)
        if not maker.known:
            return ""
        found = maker.still[settings]
        return "refused" if found is None else f"{found[0]:.2f} px" + (f" ({found[1]}/{COPIES})" if found[1] < COPIES else "")

    rows = []
    for name in scenes:
        models = tuple(MODELS) if name == "ellipsoid" else TWO  # a path-traced frame takes longer
        for model in models:
            rows.append([name, model, *(cell(n, models, model, lambda s: st, [1]) for n, st in
                        ((name + "-given", ()), (name, ()), (name, (("normals", "integral"),)), (name, tuple(FIT.items()))))])
    out.append(("exact", table(["scene", "model", "surface as given", "depth, default", "integral normals", "fit"], rows)))
    rows = []
    for smoothing in ("none", "bilateral", "fit"):
        for r in RADII:
            st = lambda s: noisy(1, s, smoothing=smoothing, radius=r)
            rows.append([smoothing, f"{100 * r:.0f} cm", *(cell("ellipsoid", TWO, m, st, SEEDS) for m in TWO), still(st(1))])
    out.append(("radius", table(["smoothing", "radius", "limit-angle", "reflectance", "jitter of the peak"], rows)))
    rows = []
    for times in NOISES:
        for label, settings in (("none, default", {}), ("bilateral, 6 cm", dict(smoothing="bilateral", radius=0.06)),
                                ("fit, 6 cm", dict(FIT, radius=0.06))):
            st = lambda s: noisy(times, s, **settings)
            rows.append([f"{times:g}", label, *(cell("ellipsoid", tuple(MODELS), m, st, SEEDS[:1]) for m in MODELS)])
    out.append(("noise", table(["noise", "smoothing, radius", *MODELS], rows)))
    rows = []
    for k in FUSED:
        for smoothing, r in (("bilateral", 0.06), ("fit", 0.06), ("fit", BEST)):
            st = lambda s: noisy(1, s, fuse=k, radius=r, smoothing=smoothing)
            rows.append([str(k), f"{smoothing}, {100 * r:.0f} cm",
                         *(cell("ellipsoid", TWO, m, st, SEEDS) for m in TWO), still(st(1))])
    out.append(("fusion", table(["frames fused", "smoothing, radius", "limit-angle", "reflectance", "jitter of the peak"], rows)))
    if "sphere" in scenes:
        rows = []
        bilateral = dict(smoothing="bilateral", radius=0.06)
        for label, settings in (("none, default", {}), ("bilateral, 6 cm", bilateral),
                                ("bilateral, 6 cm, 6 fused", dict(bilateral, fuse=6)), ("fit, 6 cm", dict(FIT, radius=0.06)),
                                (f"fit, {100 * BEST:.0f} cm", dict(FIT, radius=BEST)),
                                (f"fit, {100 * BEST:.0f} cm, 6 fused", dict(FIT, radius=BEST, fuse=6))):
            st = lambda s: noisy(1, s, **settings)
            rows.append([label, *(cell("sphere", TWO, m, st, SEEDS[:1]) for m in TWO)])
        out.append(("traced", table(["smoothing, radius", *TWO], rows)))
    return keys, jitters, dict(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--data", default=os.environ.get("GLINT_DATA", ""),
                        help="folder with cycles/sphere; without it the path-traced rows are left out")
    parser.add_argument("--jobs", type=int, default=2, help="programs at once")
    parser.add_argument("--out", default="docs/depth.md")
    a = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    page = root / a.out
    text = page.read_text()
    with tempfile.TemporaryDirectory() as temporary:
        maker = Maker(pathlib.Path(a.glint).resolve(), root, pathlib.Path(temporary))
        maker.ellipsoid()
        scenes = ["ellipsoid"]
        if a.data:
            maker.truth = pathlib.Path(a.data) / "cycles/sphere/contours"
            maker.sphere(pathlib.Path(a.data).resolve())
            scenes.append("sphere")
        maker.work(*sections(maker, scenes)[:2], a.jobs)
        for name, lines in sections(maker, scenes)[2].items():
            start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
            if start not in text or end not in text:
                text += f"\n{start}{end}\n"
            text = text[:text.index(start) + len(start)] + lines + text[text.index(end):]
    page.write_text(text)


if __name__ == "__main__":
    main()
