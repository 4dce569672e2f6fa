# SPDX-License-Identifier: BSD-3-Clause
"""A shared page as a file: its numbers are those of `glint evaluate --json`, equal input gives equal bytes, nothing in it loads anything, no name
becomes mark-up, and what must not be overwritten is not.

structure_test.py GLINT SESSIONS [--all]     --all: every shipped session and lesson, for their size alone
"""
import base64
import hashlib
import html.parser
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

MOST = 20e6  # bytes, for every shipped session
HOSTILE = "</script><script>document.title='owned'</script><!-- \" ' & \u2028 \u2029 <img src=x onerror=alert(1)>"
TIMES = ("time_us", "predict_us", "exact_predict_us")


def run(glint, *words, expect=0):
    done = subprocess.run([glint, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == expect, f"{words}: {done.returncode}, not {expect}: {done.stderr}"
    return done


class Page(html.parser.HTMLParser):
    """As a browser reads it: elements with their attributes, and the texts of scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.texts, self.inside = [], [], None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag in ("script", "style"):
            self.inside = [tag, dict(attributes), ""]

    def handle_data(self, data):
        if self.inside:
            self.inside[2] += data

    def handle_endtag(self, tag):
        if self.inside and tag == self.inside[0]:
            self.texts.append(tuple(self.inside))
            self.inside = None

    def data(self):
        return json.loads(next(text for tag, a, text in self.texts if a.get("id") == "data"), parse_constant=refused)


def refused(constant):
    raise AssertionError(f"{constant} is no number of JSON")


def untimed(value):
    if isinstance(value, dict):
        return {k: untimed(v) for k, v in value.items() if k not in TIMES}
    return [untimed(v) for v in value] if isinstance(value, list) else value


def check_policy(page):
    """Two scripts, one style, each named by its hash; nothing else may load or run."""
    runs = [text for tag, a, text in page.texts if tag == "script" and a.get("type") != "application/json"]
    styles = [text for tag, a, text in page.texts if tag == "style"]
    assert len(runs) == 2 and len(styles) == 1, (len(runs), len(styles))
    policy = next(a["content"] for tag, a in page.elements if tag == "meta" and a.get("http-equiv") == "Content-Security-Policy")
    rules = {rule.split()[0]: rule.split()[1:] for rule in policy.split(";")}
    assert rules["default-src"] == ["'none'"] and rules["img-src"] == ["data:"], policy
    digest = lambda text: "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"
    assert rules["script-src"] == [digest(text) for text in runs], "scripts are not those that the policy names"
    assert rules["style-src"] == [digest(text) for text in styles]
    for tag, attributes in page.elements:
        assert tag not in ("link", "iframe", "object", "embed", "img", "base"), tag
        for name, value in attributes.items():
            assert not name.startswith("on"), (tag, name)
            assert name not in ("src", "href", "action", "style"), (tag, name, value)


def project(camera, point):
    """Ideal pixel of a world point, from the definition of K [R | t]."""
    x, y, z = (sum(row[k] * point[k] for k in range(3)) + row[3] for row in camera["camera_from_world"])
    return camera["fx"] * x / z + camera["skew"] * y / z + camera["cx"], camera["fy"] * y / z + camera["cy"]


def to_chain(camera, chain):
    return [project(camera, chain[i:i + 3]) for i in range(0, len(chain), 3)]


def farthest(points, line):
    """Largest distance of points from a polygon, px."""
    worst = 0
    for px, py in points:
        best = math.inf
        for (ax, ay), (bx, by) in zip(line, line[1:] + line[:1]):
            length = (bx - ax) ** 2 + (by - ay) ** 2
            t = max(0, min(1, ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / length)) if length else 0
            best = min(best, math.hypot(px - ax - t * (bx - ax), py - ay - t * (by - ay)))
        worst = max(worst, best)
    return worst


def of_role(holder, role):
    return [thing for thing in holder["things"] if thing["role"] == role]


def check_drawing(data):
    """What lies on the surface projects onto what lies over the photograph."""
    checked = 0
    for frame in data["frames"]:
        if frame["camera"]["distorted"]:
            continue
        for model in [""] + [m["id"] for m in data["models"]]:
            over = [l["points"] for l in frame["lines"] if l["model"] == model]
            on = [c for part in of_role(frame, "predicted-contour" if model else "observed-contour") if part["model"] == model for c in part["chains"]]
            if len(over) != 1 or len(on) != 1:
                continue  # of several, which belongs to which is not said
            line = list(zip(over[0][0::2], over[0][1::2]))
            assert farthest(to_chain(frame["camera"], on[0]), line) < 0.5, (frame["id"], model)
            checked += 1
    return checked


def check_roles(data):
    """Which frames train, as `evaluate --json` says it; virtual cameras that are mirrored in the tangent planes; lights where the fits have them."""
    training = {row["index"] for row in data["evaluation"]["training"]}
    assert {f["index"] for f in data["frames"] if f["role"] == "training"} == training, training
    for frame in data["frames"]:
        (camera,) = of_role(frame, "camera")
        planes, mirrored = of_role(frame, "tangent-plane"), of_role(frame, "virtual-camera")
        assert len(planes) == len(mirrored) == len(of_role(frame, "brightest-point")) > 0, frame["id"]
        for plane, virtual in zip(planes, mirrored):
            eye, other, at, normal = camera["place"], virtual["place"], plane["place"], plane["normal"]
            across = [a - b for a, b in zip(eye[:3], other[:3])]  # from the mirror image to the camera: along the normal, and the plane halves it
            long = math.hypot(*across)
            assert math.dist([v / long for v in across], normal) < 1e-9, frame["id"]
            assert abs(sum(n * ((a + b) / 2 - p) for n, a, b, p in zip(normal, eye, other, at))) < 1e-9, frame["id"]
            assert abs(max(math.dist(plane["chains"][0][i:i + 3], at[:3]) for i in range(0, 96, 3)) - plane["radius"]) < 1e-4, frame["id"]  # rounded
    places = {fit["light"]: fit["light_position"] for model in data["evaluation"]["models"].values() for fit in model["fits"]
              if fit.get("light_position")}
    assert places and all(place[3] == 1 for place in places.values()), places
    lights = of_role(data, "light")
    assert lights
    for light in lights:
        x, y, z, w = light["place"]
        assert math.dist([x / w, y / w, z / w], places[light["light"]][:3]) < 1e-9, light
    check_bodies(data)


def check_bodies(data):
    """Ellipsoids are those of the evaluation: the drawn curves fulfil their equations, and what is poor is drawn so."""
    fits = [(name, fit) for name, model in data["evaluation"]["models"].items() for fit in model["fits"]]
    for name, fit in fits:
        drawn = [t for t in of_role(data, "ellipsoid") if (t["model"], t["light"], t.get("surface")) == (name, fit["light"], fit["surface"])]
        assert len(drawn) == bool(fit["q_dual"]), (name, fit["light"])
        for thing in drawn:
            assert thing.get("poor", False) == (fit["status"] == "poor"), (name, fit["status"])
            assert ("problem" in thing) or fit["ellipsoid"], name
            if "chains" not in thing:
                continue
            pose, axes = fit["ellipsoid"]["world_from_ellipsoid"], fit["ellipsoid"]["semi_axes"]
            for chain in thing["chains"]:
                for i in range(0, len(chain), 3):
                    away = [p - c for p, c in zip(chain[i:i + 3], fit["ellipsoid"]["centre"])]
                    own = [sum(pose[r][k] * away[r] for r in range(3)) for k in range(3)]
                    assert min(axes) < 1e-4 or abs(sum((v / a) ** 2 for v, a in zip(own, axes)) - 1) < 1e-2, (name, own, axes)


def check_surfaces(data):
    for surface in data["surfaces"]:
        assert surface["problem"] == ""
        positions = base64.b64decode(surface["positions"])
        indices = base64.b64decode(surface["indices"])
        vertices = len(positions) // 6
        assert len(indices) == 12 * surface["triangles"] > 0
        assert max(struct.unpack(f"<{len(indices) // 4}I", indices)) == vertices - 1
        assert len(base64.b64decode(surface["normals"])) in (0, 3 * vertices)


def check_equations(lesson, explain):
    """The typeset equations are the pictures on record, those of this lesson alone, of outlines and nothing else."""
    known = {e["plain"]: e["id"] for e in json.loads((explain / "equations.json").read_text(encoding="utf-8"))["equations"]}
    there = {e["plain"]: e["svg"] for e in lesson["equations"]}
    steps = {step["equation"] for step in lesson["steps"]} - {""}
    words = json.dumps([lesson["see"], lesson["questions"], lesson["steps"]], ensure_ascii=False)
    assert steps <= set(there), steps - set(there)
    for plain, svg in there.items():
        assert plain in words, f"the lesson does not show {plain}"
        assert svg + "\n" == (explain / "equations" / (known[plain] + ".svg")).read_text(encoding="utf-8"), plain
        tags = {e.tag.rsplit("}", 1)[-1] for e in xml.etree.ElementTree.fromstring(svg).iter()}
        assert tags <= {"svg", "title", "desc", "g", "path"}, tags
    return len(there)


def check_session(glint, session, folder):
    first, second = folder / "first.html", folder / "second.html"
    run(glint, "share", session, "-o", first)
    run(glint, "share", session, "-o", second)
    assert first.read_bytes() == second.read_bytes(), "equal input gives other bytes"
    text = first.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>") and len(first.read_bytes()) < MOST
    page = Page(text)
    check_policy(page)
    data = page.data()
    evaluation = json.loads(run(glint, "evaluate", session, "--json", "-").stdout)
    assert data["evaluation"] == untimed(evaluation), "numbers differ from evaluate --json"
    assert any(m["summary"]["predicted"] for m in data["evaluation"]["models"].values())
    check_surfaces(data)
    check_roles(data)
    assert check_drawing(data) > 3
    assert all(p.startswith("data:image/jpeg;base64,") for p in data["photographs"]) and len(data["photographs"]) == len(data["frames"])
    return data


def inside_out(pose):
    """The inverse of a rigid motion."""
    turn = [[pose[c][r] for c in range(3)] for r in range(3)]
    return [row + [-sum(row[k] * pose[k][3] for k in range(3))] for row in turn]


def moved(pose, point):
    return [sum(row[k] * point[k] for k in range(3)) + row[3] for row in pose[:3]]


def check_moved(data, poses, axes):
    """What is drawn of each frame is on the ellipsoid where that frame has it: surface, contours and brightest points."""
    assert len(data["surfaces"]) == len(data["frames"]) == len(poses), "one place of the object in each frame"
    places = set()
    for frame, pose in zip(data["frames"], poses):
        surface, back = data["surfaces"][frame["surface"]], inside_out(pose)
        codes = base64.b64decode(surface["positions"])
        codes = struct.unpack(f"<{len(codes) // 2}H", codes)
        drawn = [[surface["origin"][k] + surface["step"][k] * codes[i + k] for k in range(3)] for i in range(0, len(codes), 3)]
        lying = [c[i:i + 3] for t in of_role(frame, "observed-contour") + of_role(frame, "predicted-contour") for c in t["chains"] for i in range(0, len(c), 3)]
        lying += [t["place"][:3] for t in of_role(frame, "brightest-point")]
        assert len(drawn) > 500 and len(lying) > 100, (len(drawn), len(lying))
        for point in drawn + lying:
            away = math.hypot(*(v / a for v, a in zip(moved(back, point), axes))) - 1
            assert abs(away) < 1e-3, (frame["id"], point, away)
        places.add(tuple(round(v, 2) for v in drawn[len(drawn) // 3]))
    assert len(places) > len(poses) / 2, "it does not move"


def check_moving(glint, sessions, folder):
    """A lamp that moves with the camera, and the same views as an object that is turned before a still camera and lamp: equal numbers, and the object
    where each frame has it."""
    lesson = sessions / "lessons/moving-lamp"
    carried = check_session(glint, lesson / "moving-lamp.glint", folder)
    scene = json.loads((lesson / "scene.json").read_text())
    axes, lamp = scene["surfaces"]["body"]["analytic"]["semi_axes"], scene["lights"][0]["position"]
    poses = [frame["camera_from_world"] for frame in scene["frames"]]
    assert carried["coordinates"]["frame"] == "camera" and carried["coordinates"]["moves"] and "moves with the camera" in carried["coordinates"]["reason"]
    here = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    assert all(frame["camera"]["camera_from_world"] == here for frame in carried["frames"]), "the camera moves in its own coordinates"
    check_moved(carried, poses, axes)
    for frame in carried["frames"]:
        for ray in of_role(frame, "reflected-ray"):
            (x, y) = ray["chains"][0][:3], ray["chains"][0][3:]
            along, to = [b - a for a, b in zip(x, y)], [b - a for a, b in zip(x, lamp)]
            t = sum(map(lambda a, b: a * b, along, to)) / sum(a * a for a in along)
            assert math.dist([t * a for a in along], to) < 1e-4, (frame["id"], "a ray misses the lamp")
    for frame in scene["frames"]:
        frame["world_from_object"], frame["camera_from_world"] = frame["camera_from_world"], here + [[0, 0, 0, 1]]
    scene["lights"][0]["frame"] = "world"
    shutil.copytree(lesson / "frames", folder / "turned" / "frames")
    (folder / "turned" / "scene.json").write_text(json.dumps(scene))
    options = ["--models", ",".join(m["id"] for m in carried["models"]), "--source", "image", "--train", "0,2,4,6,8", "--set", "fit.most_residual=0.3"]
    run(glint, "share", folder / "turned", *options, "-o", folder / "turned.html")
    turned = Page((folder / "turned.html").read_text(encoding="utf-8")).data()
    assert turned["evaluation"] == untimed(json.loads(run(glint, "evaluate", folder / "turned", *options, "--json", "-").stdout))
    assert turned["coordinates"]["frame"] == "world" and turned["coordinates"]["moves"]
    check_moved(turned, poses, axes)
    errors = lambda data, model: [row["contour_error_pct"] for row in data["evaluation"]["models"][model]["frames"]]
    for model in ("dual", "canonical", "limit-angle"):
        there = errors(turned, model)
        assert len(there) == 4 and all(abs(a - b) < 1e-3 for a, b in zip(there, errors(carried, model))), model


def check_frames(glint, session, folder):
    page = folder / "two.html"
    run(glint, "share", session, "--frames", "1,3", "--models", "dual", "-o", page)
    data = Page(page.read_text(encoding="utf-8")).data()
    assert [f["index"] for f in data["frames"]] == [1, 3] and [m["id"] for m in data["models"]] == ["dual"]
    assert list(data["evaluation"]["models"]) == ["dual"]


def check_hostile(glint, lesson, folder):
    """A scene whose every name is an attack."""
    shutil.copytree(lesson.parent, folder / "scene")
    file = folder / "scene" / "scene.json"
    scene = json.loads(file.read_text())
    scene["name"] = HOSTILE
    for i, frame in enumerate(scene["frames"]):
        frame["id"] = f"{i}{HOSTILE}"
        for highlight in frame.get("highlights", []):
            highlight["light"] = HOSTILE
        if "lights_on" in frame:
            frame["lights_on"] = [HOSTILE]
    for light in scene["lights"]:
        light["id"] = HOSTILE
    file.write_text(json.dumps(scene))
    page = folder / "hostile.html"
    run(glint, "share", file, "--train", "0-2", "-o", page)
    text = page.read_text(encoding="utf-8")
    read = Page(text)
    check_policy(read)
    assert read.data()["name"] == HOSTILE and read.data()["frames"][1]["id"] == "1" + HOSTILE
    assert "\u2028" not in text and "\u2029" not in text
    assert "<img" not in text
    return page


def check_refusals(glint, lesson, folder):
    own = folder / "own"
    shutil.copytree(lesson.parent, own)
    scene = own / "scene.json"
    before = scene.read_bytes()
    assert "scene.json" in run(glint, "share", own, "-o", scene, expect=2).stderr
    assert scene.read_bytes() == before
    foreign = folder / "foreign.html"
    foreign.write_text("<html>somebody else's</html>")
    run(glint, "share", own, "-o", foreign, expect=2)
    assert foreign.read_text() == "<html>somebody else's</html>"
    run(glint, "share", own, "-o", folder / "unscored.html")  # every frame trains: nothing to score, and all of it to see
    run(glint, "share", own, "--train", "0-2", "-o", folder / "nowhere" / "page.html", expect=2)
    assert not (folder / "nowhere").exists()
    for words in (["--frames", "999"], ["--models", "nothing"], ["--set", "no.such=1"]):
        run(glint, "share", own, *words, "-o", folder / "never.html", expect=2)
    run(glint, "share", own, "--train", "0", "--models", "dual", "-o", folder / "never.html", expect=3)  # one view determines no ellipsoid
    run(glint, "share", own, expect=2)
    assert not (folder / "never.html").exists()


def main():
    glint, sessions = sys.argv[1], pathlib.Path(sys.argv[2])
    files = sorted(sessions.glob("*/*.glint")) + sorted(sessions.glob("lessons/*/*.glint"))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if "--all" in sys.argv:
            assert len(files) >= 13
            for session in files:
                run(glint, "share", session, "-o", folder / "page.html")
                size = (folder / "page.html").stat().st_size
                print(f"{str(session.parent.relative_to(sessions)):26} {size / 1e6:6.2f} MB")
                assert size < MOST, session
                lesson = Page((folder / "page.html").read_text(encoding="utf-8")).data()["lesson"]
                assert (lesson is not None) == ("lessons" in session.parts)
                assert lesson is None or all(step["title"] and step["text"] for step in lesson["steps"])
                assert lesson is None or all(q["ask"] and q["answer"] for q in lesson["questions"])
                if lesson:
                    check_equations(lesson, sessions.parent / "resources/explain")
            return
        check_session(glint, sessions / "two-lamps/two-lamps.glint", folder)
        lesson = sessions / "lessons/sphere/sphere.glint"
        shared = check_session(glint, lesson, folder)["lesson"]
        assert len(shared["steps"]) == 5 and check_equations(shared, sessions.parent / "resources/explain") == 5
        check_moving(glint, sessions, folder)
        check_frames(glint, lesson, folder)
        check_hostile(glint, lesson, folder)
        check_refusals(glint, lesson, folder)


if __name__ == "__main__":
    main()
