# SPDX-License-Identifier: BSD-3-Clause
"""Lights that lie where they cannot, failures that call themselves ok, the extended light at infinity, and the contract."""
import json
import math

from audit.harness import Result, line, percent


# Rendering costs, exact contours do not: they keep their accuracy in a small image.
SMALL = {"camera.width": 96, "camera.height": 72, "camera.fx": 120, "camera.fy": 120, "camera.cx": 47.5, "camera.cy": 35.5}


def given(runner, spec, keep=lambda frame: None, folder=None):
    """Folder of a scene whose frames give their exact contours and nothing else, changed by `keep`."""
    folder = folder or runner.synth(spec)
    scene = json.loads((folder / "scene.json").read_text())
    for frame in scene["frames"]:
        for key in ("image", "radiance"):
            frame.pop(key, None)
        levels = json.loads((folder / "truth" / (frame["id"] + ".json")).read_text())["levels"]
        frame["highlights"] = [{"light": frame["lights_on"][0], "level": float(q), "contour": c["points"],
                                "peak": middle(c["points"])}
                               for q, contours in levels.items() for c in contours]
        keep(frame)
    out = folder.parent / "given"
    out.mkdir(exist_ok=True)
    (out / "scene.json").write_text(json.dumps(scene))
    return out


def middle(points):
    return [sum(p[k] for p in points) / len(points) for k in (0, 1)]


def json_of(runner, scene, *arguments):
    done = runner.glint("evaluate", scene, *arguments, "--json", "-")
    return done, json.loads(done.stdout) if done.stdout.strip() else {}


def fits(evaluation, model):
    return evaluation["models"][model]["fits"]


def normal_at(scene, frame, radius):
    """Unit normal where the middle of a frame's contour hits the sphere about the origin."""
    camera, pose = scene["camera"], frame["camera_from_world"]
    x, y = middle(json.loads(frame["truth"].read_text())["levels"]["0.50"][0]["points"])
    ray = [(x - camera["cx"]) / camera["fx"], (y - camera["cy"]) / camera["fy"], 1]
    direction = [sum(pose[k][i] * ray[k] for k in range(3)) for i in range(3)]
    eye = [-sum(pose[k][i] * pose[k][3] for k in range(3)) for i in range(3)]
    a, b = sum(d * d for d in direction), sum(d * e for d, e in zip(direction, eye))
    c = sum(e * e for e in eye) - radius * radius
    t = (-b - math.sqrt(b * b - a * c)) / a
    return [(e + t * d) / radius for e, d in zip(eye, direction)]


def is_behind(folder, evaluation, light, radius):
    scene = json.loads((folder / "scene.json").read_text())
    for i in evaluation["train"]:
        frame = dict(scene["frames"][i], truth=folder / "truth" / (scene["frames"][i]["id"] + ".json"))
        n = normal_at(scene, frame, radius)
        if sum(n[k] * (light[k] - light[3] * radius * n[k]) for k in range(3)) <= 0:
            return True
    return False


def short_tube(runner, length, reach):
    """A tube over a sphere, seen from cameras that hardly move."""
    return runner.synth(runner.spec("light_sphere", **{
        **SMALL, "lights": [{"id": "lamp", "segment": [[0.2, -1.3, 2.2 - length / 2], [0.2, -1.3 + length, 2.2]],
                             "radius": 0.015}],
        "path.orbit.from": -1.2, "path.orbit.to": -1.2 + 2.4 * reach, "path.orbit.count": 8}))


@line("1.2", "extended light in front of the surface", "no light of an answer lies behind a training highlight")
def behind(runner):
    bad = answers = 0
    for reach in (0.1, 0.2, 0.4):
        for length in (0.3, 0.8):
            folder = short_tube(runner, length, reach)
            scene = given(runner, None, folder=folder)
            for seed in (1, 2, 3):
                done, evaluation = json_of(runner, scene, "--models", "limit-angle", "--set", "light.limit_orders=1",
                                           "--noise-px", 0.6,
                                           "--seed", seed)
                for fit in fits(evaluation, "limit-angle"):
                    if fit["status"] == "ok":
                        answers += 1
                        bad += is_behind(folder, evaluation, fit["light_position"], 0.5)
    return Result(f"{bad} of {answers} answers behind", bad == 0 and answers > 0)


@line("1.2", "the reason is the true one", "no 'too few views, have 0' without why the six views could not be used")
def true_reason(runner):
    scene = given(runner, None, folder=short_tube(runner, 0.3, 0.2))
    reasons = []
    for seed in (1, 2, 3):
        _, evaluation = json_of(runner, scene, "--models", "canonical", "--set", "light.limit_orders=1", "--noise-px", 0.6,
                                "--seed", seed)
        reasons.append(evaluation["models"]["canonical"]["reason"] or "answers")
    return Result("; ".join(sorted(set(reasons))), all("too few views" not in r or "could not be used" in r for r in reasons))


@line("1.5", "dual and primal that explain nothing",
      "refused where more than a tenth of the contour's radius is left; 6 % are an answer")
def explained(runner):
    # Every second contour is smaller by a share of its radius, the others larger: no limit angle leaves less than about that share of both.
    # The first six frames train, so that both sizes do.
    told, holds = [], True
    for apart in (0.5, 0.15, 0.06):
        def contradict(frame):
            factor = 1 - apart if int(frame["id"]) % 2 else 1 + apart
            for h in frame["highlights"]:
                m = middle(h["contour"])
                h["contour"] = [[m[0] + factor * (p[0] - m[0]), m[1] + factor * (p[1] - m[1])] for p in h["contour"]]
        folder = given(runner, runner.spec("light_ellipsoid", **{"path.orbit.count": 12}), contradict)
        _, evaluation = json_of(runner, folder, "--models", "primal,dual,limit-angle", "--train", "first:6")
        status = {m: v["status"] for m, v in evaluation["models"].items()}
        answered = [m for m, s in status.items() if s == "ok"]
        told.append(f"{100 * apart:.0f} % apart: {', '.join(answered) or 'none'} answered")
        holds = holds and (status["limit-angle"] == "ok" if apart < 0.1 else not answered)
    return Result("; ".join(told), holds)


@line("1.5", "a limit angle of nothing, a highlight of 0.0005 px", "refused by name")
def tiny_highlight(runner):
    def tiny(frame):
        for h in frame["highlights"]:
            m = middle(h["contour"])
            h["contour"] = [[m[0] + 1e-5 * (p[0] - m[0]), m[1] + 1e-5 * (p[1] - m[1])] for p in h["contour"]]
    folder = given(runner, runner.spec("light_sphere", **{"path.orbit.count": 12}), tiny)
    done, evaluation = json_of(runner, folder, "--models", "limit-angle")
    fit = fits(evaluation, "limit-angle")[0]
    return Result(f"{fit['status']}, limit angle {fit['limit_angle_deg']} deg",
                  fit["status"] == "failed" and done.returncode == 3)


@line("1.5", "residual_px and condition of limit-angle and reflectance", "a number per training view, and one")
def filled(runner):
    evaluation = runner.evaluate(runner.synth(runner.spec("light_ellipsoid")), "--models", "limit-angle,reflectance")
    missing = [f"{m}.{key}" for m in evaluation["models"] for f in fits(evaluation, m) for key in ("residual_px", "condition")
               if f[key] is None or (key == "residual_px" and len(f[key]) != len(evaluation["train"]))]
    return Result("missing: " + ", ".join(missing) if missing else "all there", not missing)


@line("1.5", "two lights whose highlights merge", "said in words")
def merged(runner):
    folder = runner.synth(runner.spec("light_sphere", **{
        "lights": [{"id": "left", "position": [1.15, -1.0, 2.2]}, {"id": "right", "position": [1.25, -1.0, 2.2]}]}))
    done, evaluation = json_of(runner, folder, "--models", "limit-angle")
    told = [w for f in fits(evaluation, "limit-angle") if f["status"] == "ok" for w in f.get("warnings", []) if "merge" in w]
    answers = [f["light"] for f in fits(evaluation, "limit-angle") if f["status"] == "ok"]
    return Result(f"{len(answers)} light answered, {'told' if told else 'nothing said'}", bool(told) or not answers)


@line("1.5", "evaluate says that highlights are clipped", "a warning with the frames in text and JSON")
def clipped(runner):
    folder = runner.synth(runner.spec("light_sphere", **{"render.bits": 8, "render.exposure": 3.0, "render.diffuse": 0.05}))
    detected = json.loads(runner.glint("detect", folder, "--source", "image", "--json", "-").stdout)
    known = sum(h["clipped"] for f in detected["frames"] for h in f["highlights"])
    done, evaluation = json_of(runner, folder, "--source", "image", "--models", "limit-angle")
    told = any("clipped" in w for w in evaluation.get("warnings", [])) and "clipped" in done.stderr
    return Result(f"{known} highlights clipped, {'told' if told else 'nothing said'}", known > 0 and told)


@line("1.5", "a skewed camera", "held-out error within 1.2 times that without skew")
def skew(runner):
    plain = runner.spec("light_ellipsoid")
    errors = []
    for spec in (plain, runner.spec("light_ellipsoid", **{"camera.skew": 40.0})):
        # Both are made without skew and then sheared: x + s (y - cy) / fy is what a camera of skew s sees.
        s = spec["camera"].pop("skew", 0.0)
        folder = given(runner, spec)
        scene = json.loads((folder / "scene.json").read_text())
        c = scene["camera"]
        for frame in scene["frames"]:
            for h in frame["highlights"]:
                h["contour"] = [[p[0] + s * (p[1] - c["cy"]) / c["fy"], p[1]] for p in h["contour"]]
                h["peak"][0] += s * (h["peak"][1] - c["cy"]) / c["fy"]
        if s:
            c["skew"] = s
        (folder / "scene.json").write_text(json.dumps(scene))
        _, evaluation = json_of(runner, folder, "--models", "limit-angle")
        m = evaluation["models"]["limit-angle"]
        errors.append(m["summary"]["contour_error_pct"]["mean"] if m["status"] == "ok" else math.nan)
    return Result(f"{percent(errors[1])}, without skew {percent(errors[0])}", errors[1] <= 1.2 * errors[0] + 1e-3)


@line("1.7", "extended light at infinity",
      "limit-angle with the extent has at most half the error of one limit angle, four seeds of 0.3 px noise at 96 x 72")
def infinity(runner):
    far = 1e7
    folder = given(runner, runner.spec("light_ellipsoid", **{**SMALL, "lights": [
        {"id": "lamp", "radius": 0.001 * far,
         "segment": [[0.42 * far, -0.35 * far, 0.87 * far], [0.56 * far, -0.54 * far, 0.63 * far]]}]}))
    worst, errors = 0, []
    for seed in (1, 2, 3, 4):  # one of them settles at infinity itself
        found = []
        for orders in (0, 1):
            _, evaluation = json_of(runner, folder, "--models", "limit-angle", "--train", "spread:6", "--set",
                                    f"light.limit_orders={orders}",
                                    "--noise-px", 0.3, "--seed", seed)
            m = evaluation["models"]["limit-angle"]
            found.append(m["summary"]["contour_error_pct"]["mean"] if m["status"] == "ok" else math.inf)
        errors.append(found[1])
        worst = max(worst, found[1] / found[0])
    return Result(f"{percent(max(errors))} at worst, {worst:.2f} times that of one limit angle", worst <= 0.5)


@line("1.8", "evaluate --models auto --json with exit code 3", "the JSON is written")
def auto_json(runner):
    folder = given(runner, runner.spec("light_sphere", **{"path.orbit.count": 8}), lambda frame: frame.update(highlights=[]))
    out = folder / "out.json"
    out.unlink(missing_ok=True)
    done = runner.glint("evaluate", folder, "--models", "auto", "--json", out)
    return Result(f"exit {done.returncode}, {'written' if out.exists() else 'no file'}", done.returncode == 3 and out.exists())


@line("1.8", "predict --allow-outside", "accepted")
def allow_outside(runner):
    folder = runner.synth(runner.spec("light_sphere"))
    elsewhere = runner.scratch / "elsewhere"
    elsewhere.mkdir(exist_ok=True)
    scene = json.loads((folder / "scene.json").read_text())
    for frame in scene["frames"]:
        frame.update({k: str(folder / frame[k]) for k in ("image", "radiance", "depth", "normals", "mask") if k in frame})
    (elsewhere / "scene.json").write_text(json.dumps(scene))
    session = elsewhere / "run.glint"
    made = runner.glint("reconstruct", elsewhere, "--allow-outside", "--model", "limit-angle", "-o", session)
    done = runner.glint("predict", session, "--allow-outside", "--frames", "7")
    return Result(f"exit {made.returncode}, {done.returncode}", made.returncode == 0 and done.returncode == 0)


@line("1.8", "--level takes what the scene reader takes", "contours at level 0.01 are evaluated")
def level(runner):
    def low(frame):
        for h in frame["highlights"]:
            h["level"] = 0.01
    folder = given(runner, runner.spec("light_sphere", level=0.01), low)
    done = runner.glint("evaluate", folder, "--models", "limit-angle", "--level", "0.01")
    return Result((done.stderr.strip().splitlines() or ["answers"])[-1], done.returncode == 0)


@line("1.8", "the number of a frame that does not exist", "the message says how frames are counted")
def counted(runner):
    folder = runner.synth(runner.spec("light_sphere"))
    done = runner.glint("evaluate", folder, "--train", "96")
    text = done.stderr.strip().split("--train 96: ")[-1]
    return Result(text, done.returncode == 2 and "0 to 13" in text)


@line("1.8", "a scene with contours and no images", "its picture shows them, without a red fault")
def no_images(runner):
    folder = given(runner, runner.spec("light_sphere"))
    picture = folder / "frame.png"
    done = runner.glint("render", folder, "--view", "frame", "--frame", "7", "--models", "limit-angle", "--size", "640x480",
                        "-o", picture)
    if done.returncode:
        return Result(done.stderr.strip(), False)
    import zlib
    data, at, parts, header = picture.read_bytes(), 8, b"", None
    while at < len(data):
        size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        header = data[at + 8:at + 8 + size] if kind == b"IHDR" else header
        parts += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += 12 + size
    width, height, channels = int.from_bytes(header[:4], "big"), int.from_bytes(header[4:8], "big"), 3 if header[9] == 2 else 4
    raw, previous, red = zlib.decompress(parts), bytearray(width * channels), 0
    for y in range(height):
        kind, row = raw[y * (width * channels + 1)], bytearray(raw[y * (width * channels + 1)
                                                                   + 1:(y + 1) * (width * channels + 1)])
        for x in range(len(row)):
            a, b, c = row[x - channels] if x >= channels else 0, previous[x], previous[x - channels] if x >= channels else 0
            p = a + b - c
            row[x] = (row[x] + (0, a, b, (a + b) // 2,
                                min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2])[kind]) & 255
        red += sum(row[x] > 180 and row[x + 1] < 60 and row[x + 2] < 60 for x in range(0, len(row), channels))
        previous = row
    return Result(f"{red} red pixels", red == 0)
