#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/reflectance.md: the lobes of the reflectance model on the same sequences, right and wrong.

Every number comes from a run of `glint synth` and `glint evaluate` here. Exact sequences are contours of one lobe at level 0.5 on an
analytic surface; path-traced ones are SHARED/data/cycles (a Beckmann lobe), read where they are there.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

LOBES = ["torrance-sparrow", "ggx", "blinn-phong", "phong"]
CAMERA = {"width": 640, "height": 480, "fx": 800, "fy": 800, "cx": 319.5, "cy": 239.5}

# Geometry: incidence follows from the orbit and the lamp; the table prints what the frames really have.
GEOMETRIES = {
    "frontal (sphere)": {
        "surfaces": {"body": {"analytic": {"type": "sphere", "radius": 0.4}}},
        "lights": [{"id": "lamp", "position": [1.1, -1.2, 1.5]}],
        "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.7, "from": -1.5, "to": 0.3, "height": 1.0, "count": 12}},
    },
    "grazing (bent sheet)": {
        "surfaces": {"body": {"analytic": {"type": "sheet", "curvature": 0.5}}},
        "lights": [{"id": "lamp", "position": [-0.2, 1.9, 0.55]}],
        "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.9, "from": -1.85, "to": -1.25, "height": 0.5, "count": 12}},
    },
}
WIDTHS = {"narrow, m = 0.05": 0.05, "wide, m = 0.2": 0.2}

# Shapes beside sphere and sheet; every highlight lies inside the image. `turned`: a cylinder along x, seen from above.
TURNED = [[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]
ELLIPSOID = {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.25]}
SHAPES = {
    "plane": ({"type": "plane"}, [{"position": [0.2, 1.2, 1.1]}], [1.6, -2.0, -1.1, 1.2]),
    "cylinder": ({"type": "cylinder", "radius": 0.3, "world_from_surface": TURNED}, [{"position": [0.3, -1.5, 1.4]}],
                 [1.8, -2.1, -1.0, 1.2]),
    "bent sheet": ({"type": "sheet", "curvature": 1.2}, [{"position": [0.3, 0.9, 1.3]}], [1.6, -2.2, -0.9, 1.2]),
    "ellipsoid": (ELLIPSOID, [{"position": [1.2, -1.0, 2.2]}], [1.9, -2.4, 0.4, 0.7]),
    "ellipsoid, near lamp": (ELLIPSOID, [{"position": [0.5, -0.6, 0.9]}], [1.9, -2.4, 0.0, 0.7]),
    "ellipsoid, light at infinity": (ELLIPSOID, [{"direction": [0.5, -0.5, 0.8]}], [1.9, -2.4, 0.0, 0.7]),
    "ellipsoid, two lamps": (ELLIPSOID, [{"position": [1.2, -1.0, 2.2]}, {"position": [-1.4, -1.0, 1.4]}],
                             [1.9, -2.2, -0.6, 0.7]),
    "ellipsoid, lamp twice as wide as the lobe": (ELLIPSOID, [{"position": [1.2, -1.0, 2.2], "radius": 0.25}],
                                                  [1.9, -2.4, 0.4, 0.7]),
    "torus": ({"type": "torus", "major_radius": 0.4, "minor_radius": 0.15}, [{"position": [1.1, -1.2, 1.6]}],
              [1.7, -1.7, 0.2, 1.1]),
}
SHAPE_LOBES = [("torrance-sparrow", 0.03), ("torrance-sparrow", 0.1), ("ggx", 0.3), ("blinn-phong", 0.1), ("phong", 0.05)]


def fail(message):
    print(message, file=sys.stderr)
    sys.exit(1)


def evaluate(glint, scene, models, train, settings=(), extra=()):
    command = [glint, "evaluate", str(scene), "--models", models, "--train", train, "--json", "-", *extra]
    for s in settings:
        command += ["--set", s]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3) or not done.stdout.strip().startswith("{"):
        fail(f"{' '.join(command)}: {done.stderr.strip()}")
    return json.loads(done.stdout)["models"]


def percent(value):
    if value is None:
        return "–"
    return f"{value:.4f}" if value < 0.1 else f"{value:.3f}" if value < 1 else f"{value:.2f}"


def cell(model):
    """Mean error; a mark where a frame has no answer or a highlight is unmatched."""
    if model["status"] != "ok":
        return model["reason"].split(":")[0]
    s = model["summary"]
    whole = s["predicted"] == s["frames"] and s["missed"] == 0 and s["spurious"] == 0
    mean = s["contour_error_pct"]["mean"]
    return "–" if mean is None else percent(mean) + ("" if whole else f" ({s['predicted']}/{s['frames']}, {s['missed']} missed)")


def table(header, rows):
    return "\n".join(["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
                     + ["| " + " | ".join(r) + " |" for r in rows]) + "\n"


def exact_table(glint, folder):
    rows, right = [], 0
    for geometry, parts in GEOMETRIES.items():
        for width, m in WIDTHS.items():
            for truth in LOBES:
                name = f"{geometry.split()[0]}-{m}-{truth}"
                spec = {"glint_scene": 1, "name": name, "units": "m", "camera": CAMERA, "contour": "radiance", "level": 0.5,
                        "render": {"reflectance": truth, "roughness": m, "bits": 32}, **parts}
                file = folder / (name + ".json")
                file.write_text(json.dumps(spec))
                done = subprocess.run([glint, "synth", str(file), "-o", str(folder / name)], capture_output=True, text=True)
                if done.returncode:
                    fail(done.stderr.strip())
                scene = folder / name / "scene.json"
                auto = evaluate(glint, scene, "limit-angle,reflectance", "first:6")
                chosen = auto["reflectance"]["fits"][0].get("lobe", "–") if auto["reflectance"]["fits"] else "–"
                right += chosen == truth
                cells = [cell(evaluate(glint, scene, "reflectance", "first:6", [f"fit.lobe={l}"])["reflectance"]) for l in LOBES]
                cells[LOBES.index(truth)] = "**" + cells[LOBES.index(truth)] + "**"
                rows.append([geometry, width, truth, cell(auto["limit-angle"]), *cells, chosen])
    header = ["view", "lobe's width", "true lobe", "limit-angle"] + LOBES + ["chosen by residual"]
    return table(header, rows), right, len(rows)


def shapes_table(glint, folder):
    rows = []
    for shape, (surface, lights, (radius, start, end, height)) in SHAPES.items():
        wide = "radius" in lights[0]
        for lobe, m in SHAPE_LOBES:
            if wide and m > 0.03:
                continue
            name = f"shape-{len(rows)}"
            spec = {"glint_scene": 1, "name": name, "units": "m", "camera": CAMERA, "contour": "radiance", "level": 0.5,
                    "margin_px": 100,
                    "surfaces": {"body": {"analytic": surface}},
                    "lights": [{"id": f"lamp{i}", **l} for i, l in enumerate(lights)],
                    "path": {"orbit": {"centre": [0, 0, 0], "radius": radius, "from": start, "to": end, "height": height,
                                       "count": 12}},
                    "render": {"reflectance": lobe, "roughness": m, "bits": 32}}
            file = folder / (name + ".json")
            file.write_text(json.dumps(spec))
            done = subprocess.run([glint, "synth", str(file), "-o", str(folder / name)], capture_output=True, text=True)
            if done.returncode:
                fail(done.stderr.strip())
            auto = evaluate(glint, folder / name / "scene.json", "limit-angle,reflectance", "first:6")
            r = auto["reflectance"]
            fit = r["fits"][0] if r["fits"] else {}
            rows.append([shape, f"{lobe}, {m}", cell(auto["limit-angle"]), cell(r), fit.get("lobe", "–"),
                         f"{fit['roughness']:.4f}" if "roughness" in fit else "–"])
    return table(["scene", "true lobe and m", "limit-angle", "reflectance", "chosen", "m found"], rows)


def cycles_table(glint, cycles):
    rows = []
    for name, scene, trains in [("sphere", "scene-analytic.json", ["first:6", "spread:6"]),
                                ("sphere, mesh", "scene.json", ["first:6", "spread:6"]),
                                ("plane_to_cylinder", "scene-analytic.json", ["0-5"]),
                                ("plane_to_cylinder, mesh", "scene.json", ["0-5"]),
                                ("vase, mesh", "scene.json", ["first:6", "spread:6"])]:
        path = cycles / name.split(",")[0] / scene
        for train in trains:
            truth = ["--truth", str(cycles / name.split(",")[0] / "contours")]
            auto = evaluate(glint, path, "limit-angle,reflectance", train, extra=truth)
            own = evaluate(glint, path, "reflectance", train)["reflectance"]
            fit = auto["reflectance"]["fits"][0]
            cells = [cell(evaluate(glint, path, "reflectance", train, [f"fit.lobe={l}"], truth)["reflectance"]) for l in LOBES]
            rows.append([name, train, cell(auto["limit-angle"]), *cells, fit["lobe"], f"{fit['roughness']:.5f}",
                         f"{auto['reflectance']['summary']['iou']['mean']:.4f}", cell(own)])
    return table(["sequence", "training", "limit-angle"] + LOBES + ["chosen", "m", "mean IoU", "own detection"], rows)


def noise_table(glint, cycles, seeds):
    rows = []
    for train in ["first:6", "spread:6"]:
        for models in ["limit-angle", "reflectance"]:
            errors, lobes = [], {}
            for seed in range(1, seeds + 1):
                m = evaluate(glint, cycles / "sphere" / "scene-analytic.json", models, train,
                             extra=["--noise-px", "1", "--seed", str(seed)])[models]
                s = m["summary"]
                if s["predicted"] != s["frames"] or s["missed"] or s["spurious"]:
                    fail(f"noise seed {seed}, {train}: not every frame is answered")
                errors.append(s["contour_error_pct"]["mean"])
                lobe = m["fits"][0].get("lobe")
                if lobe:
                    lobes[lobe] = lobes.get(lobe, 0) + 1
            errors.sort()
            rows.append([train, models, percent(statistics.median(errors)), percent(errors[0]), percent(errors[-1]),
                         ", ".join(f"{k} {v}" for k, v in sorted(lobes.items(), key=lambda kv: -kv[1])) or "–"])
    return table(["training", "model", f"median of {seeds} seeds", "smallest", "largest", "lobes chosen"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--shared", default="../shared", type=pathlib.Path)
    parser.add_argument("--seeds", default=20, type=int)
    parser.add_argument("-o", default="docs/reflectance.md", type=pathlib.Path)
    parser.add_argument("--sections", default="exact,shapes,cycles,noise",
                        help="sections to make again, separated by commas; the page keeps the others")
    arguments = parser.parse_args()
    wanted = arguments.sections.split(",")
    cycles = arguments.shared / "data" / "cycles"
    old = arguments.o.read_text() if arguments.o.exists() else ""

    def kept(heading):
        """A section of the page as it is."""
        start = old.find("\n## " + heading)
        if start < 0:
            return ""
        end = old.find("\n## ", start + 1)
        return old[start + 1:end + 1 if end >= 0 else len(old)]

    text = """# Lobes compared: Phong, Blinn-Phong, Torrance-Sparrow, GGX

How well each reflectance lobe predicts contours, the true one and the wrong ones. The paper leaves this comparison as future work. The model `reflectance`
(docs/method.md section 7) is fitted with every lobe to the same contours, whether the lobe is true or not. Numbers are the mean
contour error on held-out frames in percent of the highlight's equivalent diameter; a note in brackets marks scenes where some highlights were not
answered. Written by:

    python3 docs/make_reflectance.py --glint build/release/bin/glint --shared ../shared

"""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if "exact" in wanted:
            exact, right, scenes = exact_table(arguments.glint, folder)
            text += f"""## Exact contours, first 6 of 12 frames train
Contours are traced on the radiance itself, so the true lobe (bold) leaves only the contours' sagitta; a wrong lobe leaves the loss.
The lobe with the smallest residual was the true one in {right} of {scenes} scenes.

{exact}
"""
        else:
            text += kept("Exact contours")
        if "shapes" in wanted:
            text += f"""## Other shapes and lights, exact contours, first 6 of 12 frames train
The residual chooses the lobe. Every frame is predicted and every highlight matched unless a note says otherwise.

{shapes_table(arguments.glint, folder)}
"""
        else:
            text += kept("Other shapes")
    if "cycles" in wanted and cycles.exists():
        text += f"""## Path-traced frames (a Beckmann lobe, light of 1 cm radius)
`torrance-sparrow` is the right lobe; the others are forced on these frames and wrong. Errors are against contours that another program traced
(`SHARED/data/cycles/*/contours`). The last columns show the automatic choice; the last one is its error against Glint's own detection.
Wrong lobes are fitted to the pixels, like the right one: the whole lobe counts there, not only the level of the contour.

{cycles_table(arguments.glint, cycles)}
"""
    else:
        text += kept("Path-traced")
    if "noise" in wanted and cycles.exists():
        text += f"""## One pixel of noise on training contours (sphere, analytic)
`--noise-px 1`: noise on 72 points of every training contour and on its peak; held-out contours stay clean; the residual chooses the lobe each time.

{noise_table(arguments.glint, cycles, arguments.seeds)}"""
    else:
        text += kept("One pixel").rstrip("\n") + "\n"
    text += """
## Conclusions
- Near the mirror direction every lobe falls as exp(-theta^2 / m^2): on frontal views of narrow highlights a wrong lobe costs little, and
  `limit-angle`, which has no lobe, is nearly as good.
- At grazing incidence the lobes differ: masking, 1 / cos(theta_V) and the off-specular shift move peak and contour. A model without these terms
  (Blinn-Phong) keeps the bias of `limit-angle`; Phong, whose highlight is round about the light's mirror direction, has another shape.
- With one level, Beckmann and GGX differ only by how the contour changes over the frames, not by its tails. With a pixel of noise their residuals
  are nearly equal; either may be chosen, and the wrong one then costs less than the noise.
"""
    arguments.o.write_text(text)


if __name__ == "__main__":
    main()
