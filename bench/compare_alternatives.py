#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a user would otherwise do for the same contour: render it with a path tracer, or program the method in NumPy.

Needs, beside Glint: python3-numpy, and Blender 3.4 with Cycles (Debian packages python3-numpy and blender). Neither is needed to
build, install or test Glint. The scene is a folder with scene-analytic.json of one sphere, about.json (material and lamp) and
contours/ of a reference renderer, such as cycles/sphere of the shared data sets.

All three run one after another on one thread of the same machine. Errors are distances to the reference contours, as a share of
their equivalent diameter. The table replaces the section of docs/performance.md between the marks.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

BEGIN, END = "<!-- alternatives: begin -->", "<!-- alternatives: end -->"


def render_in_blender(job_file):
    """Runs inside Blender: renders the specular radiance of the job's frames at several sample counts, timing each."""
    import bpy
    import mathutils
    import numpy as np

    with open(job_file) as f:
        job = json.load(f)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    s = bpy.context.scene
    s.render.engine = "CYCLES"
    s.cycles.device = "CPU"
    s.cycles.use_adaptive_sampling = False
    s.cycles.use_denoising = False
    s.cycles.pixel_filter_type = "BOX"
    s.cycles.filter_width = 1.0
    s.cycles.max_bounces = 0
    s.render.threads_mode, s.render.threads = "FIXED", 1
    s.render.resolution_x, s.render.resolution_y, s.render.resolution_percentage = job["width"], job["height"], 100
    s.render.image_settings.file_format = "OPEN_EXR"
    s.render.image_settings.color_depth = "32"
    s.world = bpy.data.worlds.new("black")
    s.world.color = (0, 0, 0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=512, ring_count=256, radius=job["radius"])
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("glossy")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    glossy, output = nodes.new("ShaderNodeBsdfGlossy"), nodes.new("ShaderNodeOutputMaterial")
    glossy.distribution = "BECKMANN"
    glossy.inputs["Color"].default_value = (job["colour"],) * 3 + (1,)
    glossy.inputs["Roughness"].default_value = job["roughness"]
    material.node_tree.links.new(glossy.outputs[0], output.inputs[0])
    ball.data.materials.append(material)
    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size = job["power"], job["lamp_radius"]
    lamp.cycles.use_multiple_importance_sampling = False
    lamp_object = bpy.data.objects.new("lamp", lamp)
    lamp_object.location = job["lamp"]
    s.collection.objects.link(lamp_object)
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.sensor_width = "HORIZONTAL", 36.0
    camera.lens = job["focal"] * 36.0 / job["width"]
    camera_object = bpy.data.objects.new("camera", camera)
    s.collection.objects.link(camera_object)
    s.camera = camera_object
    results = []
    for frame in job["frames"]:
        from_world = mathutils.Matrix(frame["camera_from_world"])
        # Blender's camera looks along -z with y up.
        camera_object.matrix_world = from_world.inverted() @ mathutils.Matrix.Diagonal((1, -1, -1, 1))
        for samples in job["samples"]:
            s.cycles.samples, s.cycles.seed = samples, 17 + samples
            s.render.filepath = os.path.join(job["out"], f"{frame['id']}-{samples}.exr")
            start = time.perf_counter()
            bpy.ops.render.render(write_still=True)
            seconds = time.perf_counter() - start
            image = bpy.data.images.load(s.render.filepath)
            pixels = np.array(image.pixels[:], dtype=np.float32).reshape(job["height"], job["width"], 4)[::-1, :, 0]
            np.save(s.render.filepath[:-4] + ".npy", pixels)
            results.append({"id": frame["id"], "samples": samples, "seconds": seconds})
    with open(os.path.join(job["out"], "times.json"), "w") as f:
        json.dump(results, f)


def main():
    import numpy as np

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=pathlib.Path, help="folder with scene-analytic.json, about.json and contours/")
    parser.add_argument("--glint", default="build/release/bin/glint")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--frames", type=int, default=3, help="held-out frames that are rendered")
    parser.add_argument("--samples", default="1,4,16,64,256")
    parser.add_argument("--output", help="default: docs/performance.md; - prints the table")
    a = parser.parse_args()
    if not shutil.which(a.blender):
        sys.exit("compare_alternatives.py: needs Blender with Cycles (Debian package blender)")
    scene = json.loads((a.scene / "scene-analytic.json").read_text())
    about = json.loads((a.scene / "about.json").read_text())
    spec = next(iter(scene["surfaces"].values()))["analytic"]
    if spec["type"] != "sphere":
        sys.exit("compare_alternatives.py: the surface must be one sphere")
    centre, radius = np.array(spec["world_from_surface"])[:3, 3], spec["radius"]

    def reference(frame_id):
        contour = json.loads((a.scene / "contours" / f"{frame_id}.json").read_text())
        return np.array(max(contour["levels"]["0.50"], key=lambda c: c["area_px2"])["points"]), contour["ref_radiance"]

    def error_pct(points, polyline):
        """Mean distance of points to a closed polyline, over the equivalent diameter of the polyline, in percent."""
        p, d = polyline, np.roll(polyline, -1, axis=0) - polyline
        keep = (d**2).sum(1) > 0
        p, d = p[keep], d[keep]
        t = np.clip(((points[:, None] - p) * d).sum(2) / (d**2).sum(1), 0, 1)
        distance = np.sqrt((((p + t[..., None] * d) - points[:, None])**2).sum(2)).min(1)
        x, y = polyline.T
        area = 0.5 * abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
        return 100 * distance.mean() / (2 * math.sqrt(area / math.pi))

    # Glint: fit and prediction of three models, errors of the held-out frames against the reference contours.
    def evaluated(models, *settings):
        done = subprocess.run([a.glint, "evaluate", str(a.scene / "scene-analytic.json"), "--models", models, "--train",
                               "spread:6",
                               "--truth", str(a.scene / "contours"), "--json", "-", *settings], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"glint: {done.stderr.strip()}")
        return json.loads(done.stdout)

    evaluation = evaluated("canonical,limit-angle,reflectance")
    fast = evaluated("limit-angle", "--set", "predict.contour=star", "--set", "predict.search=hints")
    held_out = [f["index"] for f in evaluation["models"]["limit-angle"]["frames"]]
    rows = []
    for name, results, model in (("`canonical`", evaluation, "canonical"), ("`limit-angle`", evaluation, "limit-angle"),
                                 ("`limit-angle`, star and hints", fast, "limit-angle"),
                                 ("`reflectance`", evaluation, "reflectance")):
        r = results["models"].get(model)
        if r and r["status"] == "ok":
            rows.append((f"Glint, {name}", r["summary"]["contour_error_pct"]["mean"], r["summary"]["time_us"]["median"] * 1e-6))

    # The limit-angle method in NumPy: mirror point by fixed-point iteration, then 36 walks at once by secant steps.
    fit = evaluation["models"]["limit-angle"]["fits"][0]
    light, limit = np.array(fit["light_position"][:3]) / fit["light_position"][3], math.radians(fit["limit_angle_deg"])
    focal, cx, cy = (scene["camera"][k] for k in ("fx", "cx", "cy"))

    def unit(v):
        return v / np.linalg.norm(v, axis=-1, keepdims=True)

    def alpha(p):
        n, h = unit(p - centre), unit(light - p) + unit(eye - p)
        return np.arctan2(np.linalg.norm(np.cross(n, h), axis=-1), (n * h).sum(-1))

    def predict(pose):
        nonlocal eye
        r, t = pose[:3, :3], pose[:3, 3]
        eye = -r.T @ t
        n = unit(unit(light - centre) + unit(eye - centre))
        for _ in range(200):
            p = centre + radius * n
            h = unit(unit(light - p) + unit(eye - p))
            n = unit(n + 0.6 * (h - n))
            if np.linalg.norm(h - n) < 1e-14:
                break
        p = centre + radius * n
        u = unit(r[0] - (r[0] @ n) * n)
        v = np.cross(n, u)
        angles = np.arange(36) * (2 * math.pi / 36)
        direction = np.cos(angles)[:, None] * u + np.sin(angles)[:, None] * v

        def on_sphere(s):
            flat = s[:, None] * direction
            return p + flat - (radius - np.sqrt(radius**2 - s[:, None]**2)) * n

        a0, f0 = np.full(36, 1e-3 * radius), None
        f0 = alpha(on_sphere(a0)) - limit
        a1 = a0 * limit / (f0 + limit)
        for _ in range(20):
            f1 = alpha(on_sphere(a1)) - limit
            if np.abs(f1).max() < 1e-10:
                break
            slope = np.where(f1 != f0, (f1 - f0) / np.where(a1 != a0, a1 - a0, 1), 1)
            a0, f0, a1 = a1, f1, np.clip(a1 - f1 / slope, 0.5 * a1, np.minimum(2 * a1, 0.98 * radius))
        q = on_sphere(a1) @ r.T + t
        return np.stack([focal * q[:, 0] / q[:, 2] + cx, focal * q[:, 1] / q[:, 2] + cy], axis=1)

    eye = None
    errors, times = [], []
    for index in held_out:
        frame = scene["frames"][index]
        pose = np.array(frame["camera_from_world"])
        for repeat in range(5):
            start = time.perf_counter()
            points = predict(pose)
            times.append(time.perf_counter() - start)
        errors.append(error_pct(points, reference(frame["id"])[0]))
    rows.append(("NumPy, the limit angle alone, 36 directions, on the formula of a sphere", statistics.mean(errors),
                 statistics.median(times)))

    # Cycles: the same radiance, the contour at half of the reference's peak (which a user would have to estimate as well).
    light_truth = about["lights"][0]
    chosen = held_out[:: max(1, len(held_out) // a.frames)][: a.frames]
    with tempfile.TemporaryDirectory() as out:
        job = {"out": out, "width": scene["camera"]["width"], "height": scene["camera"]["height"], "focal": focal,
               "radius": radius,
               "roughness": about["material"]["blender_roughness"], "colour": about["material"]["glossy_color"],
               "power": light_truth["power_W"], "lamp_radius": light_truth["radius_m"], "lamp": light_truth["position"],
               "samples": [int(x) for x in a.samples.split(",")],
               "frames": [{k: scene["frames"][i][k] for k in ("id", "camera_from_world")} for i in chosen]}
        (pathlib.Path(out) / "job.json").write_text(json.dumps(job))
        done = subprocess.run([a.blender, "--background", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python",
                               __file__, "--",
                               str(pathlib.Path(out) / "job.json")], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"blender: {done.stdout[-800:]} {done.stderr[-800:]}")
        by_samples = {}
        for r in json.loads((pathlib.Path(out) / "times.json").read_text()):
            image = np.load(pathlib.Path(out) / f"{r['id']}-{r['samples']}.npy")
            contour, peak = reference(r["id"])
            above = image - 0.5 * peak
            crossings = []
            for axis in (0, 1):
                f, g = (above[:, :-1], above[:, 1:]) if axis == 0 else (above[:-1], above[1:])
                ys, xs = np.nonzero((f < 0) != (g < 0))
                t = f[ys, xs] / (f[ys, xs] - g[ys, xs])
                crossings.append(np.stack([xs + (t if axis == 0 else 0), ys + (t if axis == 1 else 0)], axis=1))
            by_samples.setdefault(r["samples"], []).append((error_pct(np.concatenate(crossings), contour), r["seconds"]))
    for samples, values in by_samples.items():
        rows.append((f"Cycles, {samples} samples a pixel, light and material known",
                     statistics.mean(e for e, _ in values), statistics.median(s for _, s in values)))

    fastest = next(r[2] for r in rows if "star" in r[0])
    lines = ["| what | mean error % | time for one frame | against the star |", "| --- | --- | --- | --- |"]
    for what, error, seconds in rows:
        shown = f"{seconds * 1e6:.0f} µs" if seconds < 1e-3 else f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"
        lines.append(f"| {what} | {error:.2g} | {shown} | {seconds / fastest:.2g} x |")
    table = "\n".join(lines)
    if a.output == "-":
        print(table)
        return
    output = pathlib.Path(a.output) if a.output else pathlib.Path(__file__).resolve().parent.parent / "docs" / "performance.md"
    text = output.read_text()
    if BEGIN not in text or END not in text:
        sys.exit(f"{output}: the marks of the section are missing")
    output.write_text(text[: text.index(BEGIN) + len(BEGIN)] + "\n" + table + "\n" + text[text.index(END):])


if "--" in sys.argv and "bpy" in sys.modules:
    render_in_blender(sys.argv[sys.argv.index("--") + 1])
elif __name__ == "__main__":
    main()
