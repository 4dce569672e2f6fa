#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/sensitivity.md and its curves: contour error of every model against image resolution, errors of peaks, contours, poses and
normals, number of views, and baseline. Scenes are made by `glint synth` and perturbed here; `glint evaluate` scores them."""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

LEVEL = 0.5
TRAIN = [0, 13, 26, 39, 53, 66]                  # spread over the 80 poses
HELD_OUT = [4, 11, 18, 30, 35, 44, 49, 60, 70, 76]
FOCAL = 800.0
DISTANCE = 2.1                                   # m, cameras to the object
COLOURS = {"primal": "#e69f00", "dual": "#56b4e9", "canonical": "#009e73", "limit-angle": "#d55e00",
           "reflectance": "#cc79a7"}  # ModelTraits::rgb


def fail(text):
    sys.exit(f"make_sensitivity.py: {text}")


class Maker:
    def __init__(self, glint, root, folder):
        self.glint, self.root, self.folder = glint, root, folder
        self.count = 0
        self.base = self.synth("base", 1.0, None)

    def spec(self, scale, render):
        spec = json.loads((self.root / "resources/specs/ellipsoid_80.json").read_text())
        spec["name"] = "sensitivity"
        c = spec["camera"]
        for key in ("fx", "fy"):
            c[key] *= scale
        for key, size in (("cx", "width"), ("cy", "height")):
            c[size] = round(c[size] * scale)
            c[key] = (c[size] - 1) / 2
        spec["contour"], spec["level"] = "radiance", LEVEL
        spec.pop("limit_angle_deg")
        spec["margin_px"] = round(400 * scale)
        # Without images the specification asks for exact contours alone; `render` names what the surface is made of in both cases.
        spec["render"] = {"reflectance": "torrance-sparrow", "roughness": 0.12, "diffuse": [0.1, 0.1, 0.1], "bits": 8}
        if render is None:
            spec["material_only"] = True
        else:
            spec["render"].update(render)
        return spec

    def synth(self, name, scale, poses):
        """The scene of the poses (default: all), exact contours, with images when poses are given."""
        spec = self.spec(scale, {} if poses is not None else None)
        if poses is not None:
            cameras = spec["path"]["cameras"]
            spec["path"]["cameras"] = [cameras[i] for i in poses]
        if spec.pop("material_only", False):
            spec["render"]["bits"] = 32
            # A small picture is enough: contours are traced on the field, and the frames are dropped below.
        file = self.folder / f"{name}.json"
        file.write_text(json.dumps(spec))
        out = self.folder / name
        done = subprocess.run([self.glint, "synth", str(file), "-o", str(out)], capture_output=True, text=True)
        if done.returncode:
            fail(f"glint synth: {done.stderr.strip()}")
        return json.loads((out / "scene.json").read_text())

    def scene(self, train, held_out=HELD_OUT):
        """A copy with training frames first; images are dropped, contours stay."""
        frames = []
        for i in list(train) + list(held_out):
            f = json.loads(json.dumps(self.base["frames"][i]))
            for key in ("image", "radiance", "depth", "normals", "mask"):
                f.pop(key, None)
            f["id"] = f"{len(frames):03d}-{i}"
            frames.append(f)
        scene = {k: v for k, v in self.base.items() if k != "frames"}
        scene["frames"] = frames
        return scene

    def evaluate(self, scene, trained, extra=(), files=None):
        self.count += 1
        folder = self.folder / f"run{self.count}"
        folder.mkdir()
        for name, text in (files or {}).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)
        (folder / "scene.json").write_text(json.dumps(scene))
        return self.score(folder / "scene.json", trained, extra)

    def score(self, scene_file, trained, extra=()):
        done = subprocess.run([self.glint, "evaluate", str(scene_file), "--train", f"0-{trained - 1}", "--level", str(LEVEL),
                               "--json", "-", *extra],
                              capture_output=True, text=True)
        if done.returncode not in (0, 3):
            fail(f"glint evaluate {scene_file}: {done.stderr.strip()}")
        result = {}
        for model, r in json.loads(done.stdout)["models"].items():
            s = r["summary"]
            whole = s["predicted"] == s["frames"] and s["missed"] == 0
            result[model] = s["contour_error_pct"]["mean"] if whole else None
        return result


def resampled(points, n):
    lengths = [0.0]
    closed = points + points[:1]
    for a, b in zip(closed, closed[1:]):
        lengths.append(lengths[-1] + math.dist(a, b))
    out, k = [], 0
    for i in range(n):
        at = lengths[-1] * i / n
        while lengths[k + 1] < at:
            k += 1
        t = (at - lengths[k]) / max(lengths[k + 1] - lengths[k], 1e-300)
        out.append([closed[k][j] + t * (closed[k + 1][j] - closed[k][j]) for j in range(2)])
    return out


def with_peak_noise(scene, sigma, rng):
    for f in scene["frames"][:len(TRAIN)]:
        for h in f["highlights"]:
            h["peak"] = [x + rng.gauss(0, sigma) for x in h["peak"]]
    return scene


def with_contour_noise(scene, sigma, rng):
    for f in scene["frames"][:len(TRAIN)]:
        for h in f["highlights"]:
            h["contour"] = [[x + rng.gauss(0, sigma) for x in p] for p in resampled(h["contour"], 72)]
    return scene


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))] for i in range(len(a))]


def with_pose_noise(scene, sigma, rng):
    """Rotation about the camera's centre by sigma / f about each axis, and a translation of sigma Z / f along each."""
    for f in scene["frames"][:len(TRAIN)]:
        turn = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        for axis in range(3):
            a = rng.gauss(0, sigma / FOCAL)
            c, s = math.cos(a), math.sin(a)
            i, j = (axis + 1) % 3, (axis + 2) % 3
            r = [[float(p == q) for q in range(3)] for p in range(3)]
            r[i][i], r[i][j], r[j][i], r[j][j] = c, -s, s, c
            turn = product(r, turn)
        pose = f["camera_from_world"]
        moved = product(turn, [row[:4] for row in pose[:3]])
        for row in moved:
            row[3] += rng.gauss(0, sigma * DISTANCE / FOCAL)
        f["camera_from_world"] = moved + [[0, 0, 0, 1]]
    return scene


def ellipsoid_mesh(axes, tilt_deg, rng):
    """PLY of the ellipsoid, its vertex normals tilted by a smooth random field of that RMS angle (wavelengths of 0.2 to 0.6 m)."""
    rows, columns = 160, 320
    waves = []
    for _ in range(12):
        d = [rng.gauss(0, 1) for _ in range(3)]
        n = math.sqrt(sum(x * x for x in d))
        k = 2 * math.pi / rng.uniform(0.2, 0.6)
        waves.append(([k * x / n for x in d], rng.uniform(0, 2 * math.pi), [rng.gauss(0, 1) for _ in range(3)]))
    vertices, normals, tilts = [], [], []
    for r in range(rows + 1):
        for c in range(columns):
            u, v = math.pi * r / rows, 2 * math.pi * c / columns
            unit = (math.sin(u) * math.cos(v), math.sin(u) * math.sin(v), math.cos(u))
            p = [a * x for a, x in zip(axes, unit)]
            n = [x / a for a, x in zip(axes, unit)]
            length = math.sqrt(sum(x * x for x in n))
            n = [x / length for x in n]
            t = [0.0, 0.0, 0.0]
            for k, phase, amplitude in waves:
                s = math.sin(sum(a * b for a, b in zip(k, p)) + phase)
                t = [a + s * b for a, b in zip(t, amplitude)]
            along = sum(a * b for a, b in zip(t, n))
            t = [a - along * b for a, b in zip(t, n)]
            vertices.append(p), normals.append(n), tilts.append(t)
    rms = math.sqrt(sum(sum(x * x for x in t) for t in tilts) / len(tilts))
    scale = math.radians(tilt_deg) / rms
    faces = []
    for r in range(rows):
        for c in range(columns):
            a, b = r * columns + c, r * columns + (c + 1) % columns
            faces += [(a, a + columns, b + columns)] if r < rows - 1 else []
            faces += [(a, b + columns, b)] if r > 0 else []
            if r == rows - 1:
                faces.append((a, a + columns, b))
    out = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    out += [f"property float {x}" for x in ("x", "y", "z", "nx", "ny", "nz")]
    out += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    for p, n, t in zip(vertices, normals, tilts):
        m = [a + scale * b for a, b in zip(n, t)]
        length = math.sqrt(sum(x * x for x in m))
        out.append(" ".join(f"{x:.9g}" for x in p + [x / length for x in m]))
    out += [f"3 {a} {b} {c}" for a, b, c in faces]
    return "\n".join(out) + "\n"


def truth_of(frame):
    return json.dumps({"levels": {f"{LEVEL:.2f}": [{"points": h["contour"], "closed": True} for h in frame["highlights"]]}})


def resolution(maker, scale):
    poses = TRAIN + HELD_OUT
    name = f"resolution{scale:g}"
    scene = maker.synth(name, scale, poses)
    folder = maker.folder / name
    (folder / "truth").mkdir()
    for f in scene["frames"]:
        (folder / "truth" / f"{f['id']}.json").write_text(truth_of(f))
        f.pop("highlights", None)
    (folder / "scene.json").write_text(json.dumps(scene))
    return maker.score(folder / "scene.json", len(TRAIN), ["--source", "image", "--truth", str(folder / "truth")])


def study(maker, seeds):
    """(key, title, unit, remark, [(value, label, [run, ...])]): a run returns {model: error or None}."""
    def noisy(change, key, sigma):
        if sigma == 0:
            return [lambda: maker.evaluate(maker.scene(TRAIN), len(TRAIN))]
        return [lambda s=s: maker.evaluate(change(maker.scene(TRAIN), sigma, random.Random(f"{key} {sigma} {s}")), len(TRAIN))
                for s in range(seeds)]

    def normals(sigma, seed):
        scene = maker.scene(TRAIN)
        axes = scene["surfaces"]["body"]["analytic"]["semi_axes"]
        scene["surfaces"] = {"body": {"mesh": "body.ply"}}  # the scene of the other runs keeps its own
        return maker.evaluate(scene, len(TRAIN),
                              files={"body.ply": ellipsoid_mesh(axes, sigma, random.Random(f"normals {sigma} {seed}"))})

    def views(k):
        train = [p for p in ([round(i * 79 / max(1, k - 1)) for i in range(k)] if k > 1 else [39])]
        held_out = [p for p in HELD_OUT if p not in train]
        return maker.evaluate(maker.scene(train, held_out), k)

    def baseline(span):
        train = [round(4 + span * i / 5) for i in range(6)]
        return maker.evaluate(maker.scene(train, [p for p in HELD_OUT if p not in train]), 6)

    width = 457  # px of the object at scale 1
    return [
        ("resolution", "Image resolution", "width of the object, px",
         "8-bit images at this size, detected; scored against exact contours",
         [(width * s, f"{width * s:.0f}", [lambda s=s: resolution(maker, s)]) for s in (0.22, 0.3, 0.4, 0.6, 1.0)]),
        ("peak", "Error of the peaks", "px", "Gaussian, per coordinate, training peaks only",
         [(v, f"{v:g}", noisy(with_peak_noise, "peak", v)) for v in (0, 0.3, 1, 3, 10)]),
        ("contour", "Noise of the contours", "px", "Gaussian, per coordinate, on 72 points of each training contour",
         [(v, f"{v:g}", noisy(with_contour_noise, "contour", v)) for v in (0, 0.1, 0.3, 1, 3)]),
        ("pose", "Error of the poses", "px",
         "training cameras turned by sigma / f about each axis and shifted by sigma Z / f along each",
         [(v, f"{v:g}", noisy(with_pose_noise, "pose", v)) for v in (0, 0.1, 0.3, 1, 3)]),
        ("normal", "Error of the normals", "degrees",
         "a mesh of 51,000 vertices whose normals are tilted by a smooth random field, RMS",
         [(v, f"{v:g}", [lambda v=v, s=s: normals(v, s) for s in range(1 if v == 0 else min(seeds, 3))])
          for v in (0, 0.03, 0.1, 0.3, 1)]),
        ("views", "Number of training views", "views", "spread over all 80 poses, exact contours",
         [(k, str(k), [lambda k=k: views(k)]) for k in (2, 3, 4, 6, 10, 20)]),
        ("baseline", "Baseline", "degrees of the arc between the first and the last of 6 training views",
         "exact contours; held-out views of the whole arc",
         [(s * maker.degrees / 79, f"{s * maker.degrees / 79:.1f}", [lambda s=s: baseline(s)]) for s in (5, 10, 20, 40, 75)]),
    ]


def summary(results, model):
    values = [r.get(model) for r in results]
    known = [v for v in values if v is not None]
    if len(known) * 2 <= len(values):
        return None
    return statistics.median(v if v is not None else math.inf for v in values)


def svg(title, unit, points, models, values):
    """Log-log curves; zero is drawn at the left edge. A model without an answer has no point there."""
    w, h, left, right, top, bottom = 640, 360, 60, 130, 36, 48
    xs = [p[0] for p in points]
    smallest = min(x for x in xs if x > 0)
    place = [math.log10(x) if x > 0 else math.log10(smallest) - 0.6 for x in xs]
    ys = [math.log10(max(v, 1e-4)) for m in models for v in values[m] if v is not None and math.isfinite(v)]
    low, high = math.floor(min(ys)), max(math.ceil(max(ys)), math.floor(min(ys)) + 1)
    def px(x):
        return left + (x - place[0]) / (place[-1] - place[0]) * (w - left - right)
    def py(y):
        return h - bottom - (y - low) / (high - low) * (h - top - bottom)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" font-family="sans-serif" font-size="12">',
           f'<rect width="{w}" height="{h}" fill="white"/>',
           f'<text x="{left}" y="20" font-size="14">{title}: mean contour error, %</text>']
    for e in range(low, high + 1):
        out.append(f'<line x1="{left}" x2="{w - right}" y1="{py(e):.1f}" y2="{py(e):.1f}" stroke="#ddd"/>'
                   f'<text x="{left - 6}" y="{py(e) + 4:.1f}" text-anchor="end">{10.0 ** e:g}</text>')
    for (_, label, _), x in zip(points, place):
        out.append(f'<text x="{px(x):.1f}" y="{h - bottom + 18}" text-anchor="middle">{label}</text>')
    out.append(f'<text x="{(left + w - right) / 2:.0f}" y="{h - 10}" text-anchor="middle">{unit}</text>')
    for i, m in enumerate(models):
        colour = COLOURS.get(m, "#999999")
        run = [(px(x), py(math.log10(max(v, 1e-4)))) if v is not None and math.isfinite(v) else None
               for x, v in zip(place, values[m])]
        for a, b in zip(run, run[1:]):
            if a and b:
                out.append(f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" stroke="{colour}" stroke-width="2"/>')
        for p in filter(None, run):
            out.append(f'<circle cx="{p[0]:.1f}" cy="{p[1]:.1f}" r="3" fill="{colour}"/>')
        out.append(f'<text x="{w - right + 12}" y="{top + 16 * i + 12}" fill="{colour}">{m}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def number(v):
    return "–" if v is None or not math.isfinite(v) else f"{v:.3g}"


def arc_degrees(scene):
    """Angle between the first and the last camera as seen from the origin."""
    centres = []
    for f in (scene["frames"][0], scene["frames"][-1]):
        m = f["camera_from_world"]
        centres.append([-sum(m[i][j] * m[i][3] for i in range(3)) for j in range(3)])
    a, b = centres
    cosine = sum(x * y for x, y in zip(a, b)) / math.sqrt(sum(x * x for x in a) * sum(x * x for x in b))
    return math.degrees(math.acos(cosine))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--only", help="studies to make again, keys separated by commas; the page keeps its other sections")
    parser.add_argument("--jobs", type=int, default=1)
    a = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    with tempfile.TemporaryDirectory() as folder:
        maker = Maker(str(pathlib.Path(a.glint).resolve()), root, pathlib.Path(folder))
        maker.degrees = arc_degrees(maker.base)
        text = f"""# Sensitivity

How the contour error of each model grows with image resolution, noise and errors of cameras and normals. A program writes this page; do not edit it. After a release
build, from the root of the project:

    python3 docs/make_sensitivity.py

## What is measured
The ellipsoid of `resources/specs/ellipsoid_80.json` (0.6 x 0.35 x 0.25 m, cameras at about 2 m, f = {FOCAL:g} px), a point light, and a Torrance-Sparrow lobe of roughness 0.12; contours are level sets of the exact
radiance at {LEVEL}. Six training frames are spread over the 80 poses, ten others are held out; only training data are disturbed. Figures are the mean contour error of the held-out frames in percent
of the highlight's diameter, the median of {a.seeds} seeds where chance is involved (3 for normals). A dash: in half of the runs or more some frame was not predicted; `primal` and
`dual` mostly fail with a named reason, because their fit leaves more than a tenth of the contours' radius.
Only models that know the reflectance can reach zero on exact data: for `limit-angle` the off-specular shift remains, for the ellipsoid models the shape.
"""
        page = root / "docs/sensitivity.md"
        kept = {}
        if a.only and page.exists():
            for section in page.read_text().split("\n## ")[2:]:
                kept[section.split("\n")[0]] = "\n## " + section.rstrip("\n") + "\n"
        sections = {}

        def write():
            done = [sections.get(title) or kept.get(title, "") for _, title, *_ in studies]
            missing = [title.lower() for _, title, *_ in studies if title not in sections and title not in kept]
            note = f"\nNot made yet (`--only` makes single sections): {', '.join(missing)}.\n" if missing else ""
            page.write_text(text + note + "".join(done))

        studies = study(maker, a.seeds)
        for key, title, unit, remark, points in studies:
            if a.only and key not in a.only.split(","):
                continue
            with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
                results = [[f.result() for f in [pool.submit(run) for run in runs]] for _, _, runs in points]
            models = []
            for r in results:
                for one in r:
                    models += [m for m in one if m not in models]
            values = {m: [summary(r, m) for r in results] for m in models}
            sections[title] = (f"\n## {title}\nIn {unit}: {remark}.\n\n![{title}](pictures/sensitivity_{key}.svg)\n\n"
                               f"| {unit} | " + " | ".join(models) + " |\n" + "| --- " * (len(models) + 1) + "|\n" +
                               "".join(f"| {label} | " + " | ".join(number(values[m][i]) for m in models) + " |\n"
                                       for i, (_, label, _) in enumerate(points)))
            (root / "docs/pictures" / f"sensitivity_{key}.svg").write_text(svg(title, unit, points, models, values))
            write()  # after every study: the whole takes a while
            print(f"{title}: done", file=sys.stderr)


if __name__ == "__main__":
    main()
