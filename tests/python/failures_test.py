# SPDX-License-Identifier: BSD-3-Clause
"""The three kinds of failure, and inputs that are meant to do harm. None may crash, hang or answer."""
import json
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import glint
import scenes

SESSIONS = pathlib.Path(__file__).resolve().parents[2] / "sessions"
PLANE = SESSIONS / "plane/plane.glint"


def message_of(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    return done.stderr.strip().removeprefix("glint: ")


@pytest.mark.parametrize("key, value", [("predict.directions", 1), ("predict.directions", "many"), ("predict.directions", 36.5),
                                        ("detect.level", 1.5), ("detect.level", float("nan")), ("light.solver", "guess"),
                                        ("predict.band", "perhaps"), ("predict.nothing", 1), ("nonsense", 1)])
def test_settings_say_what_the_command_line_says(program, key, value):
    theirs = message_of(program, "evaluate", PLANE, "--set", f"{key}={value}")
    with pytest.raises(glint.InputError) as ours:
        glint.inspect(glint.open(PLANE), **{key: value})
    assert str(ours.value) == theirs
    if "." in key:
        with pytest.raises(glint.InputError) as ours:
            glint.inspect(glint.open(PLANE), **{key.replace(".", "_"): value})
        assert str(ours.value) == theirs


def test_every_setting_is_a_keyword():
    keywords = [s.keyword for s in glint.settings()]
    assert len(set(keywords)) == len(keywords) and all(k.isidentifier() for k in keywords)
    request = glint.inspect(glint.open(PLANE), [], **{s.keyword: s.default for s in glint.settings()}).request
    assert request.settings == {s.key: s.default for s in glint.settings()}


@pytest.mark.parametrize("arguments, flags", [
    (dict(models=["dual", "dual"]), ["--models", "dual,dual"]), (dict(models="oracle"), ["--models", "oracle"]),
    (dict(train="first:x"), ["--train", "first:x"]), (dict(train=[0, 99]), ["--train", "0,99"]),
    (dict(exclude="7-9"), ["--exclude", "7-9"]), (dict(level=2), ["--level", "2"]), (dict(level="high"), ["--level", "high"]),
    (dict(noise_px=-1), ["--noise-px", "-1"]), (dict(models="auto", good_enough_pct=-1), ["--models", "auto", "--good-enough-pct", "-1"]),
    (dict(truth="/nowhere"), ["--truth", "/nowhere"])])
def test_requests_say_what_the_command_line_says(program, arguments, flags):
    with pytest.raises(glint.InputError) as ours:
        glint.inspect(glint.open(PLANE), **arguments)
    theirs = message_of(program, "evaluate", PLANE, *flags)
    assert str(ours.value) == theirs or (ours.value.reason in theirs and ours.value.place.split()[0] in theirs)


def test_input_error_has_file_place_and_reason(tmp_path):
    scene = json.loads((SESSIONS / "plane/scene.json").read_text())
    scene["frames"][1]["camera_from_world"][0][0] = 5
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    with pytest.raises(glint.InputError) as failure:
        glint.open(file)
    e = failure.value
    assert e.file == str(file) and e.place == "frames[1].camera_from_world" and "rotation" in e.reason
    assert str(e) == f"{e.file}: {e.place}: {e.reason}" and isinstance(e, glint.Error)


@pytest.mark.parametrize("content", [b"", b"{", b"\x00" * 100, b"[" * 100000, b'{"glint_scene": 1, "frames": 1e999}',
                                     b'{"glint_session": 99}', b"ply\nformat ascii 1.0\n"])
@pytest.mark.parametrize("name", ["scene.json", "s.glint"])
def test_broken_files(tmp_path, content, name):
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(glint.InputError):
        glint.open(file)


def test_what_is_not_there(tmp_path):
    with pytest.raises(glint.InputError):
        glint.open(tmp_path / "nothing.json")
    with pytest.raises(glint.InputError):
        glint.open(tmp_path)
    with pytest.raises(glint.InputError) as failure:
        glint.open(PLANE, as_="colmap")
    assert "session" in str(failure.value)
    with pytest.raises(glint.InputError, match="there is no such option"):
        glint.open(SESSIONS / "plane/scene.json", colour="red")
    with pytest.raises(TypeError):
        glint.open(3)


def test_the_data_cannot_answer():
    k, pose, _, contour, peak = scenes.plane_views(1)[0]
    frame = glint.Frame("0", glint.Camera(**k, camera_from_world=pose), surface="s", highlights=[glint.Highlight(contour, peak)])
    with pytest.raises(glint.CannotAnswer) as failure:
        glint.inspect(glint.scene([frame], {"s": {"type": "sphere", "radius": 0.001}}), train=0)
    assert failure.value.reason == "too few views" and "no training frame" in failure.value.detail
    # What was computed is there: why, frame by frame.
    inspection = failure.value.inspection
    assert inspection.views[0].failure.startswith("peak off surface")
    assert isinstance(failure.value, glint.Error) and not isinstance(failure.value, (ValueError, glint.InputError))
    assert glint.inspect(glint.scene([frame], {"s": {"type": "plane"}}), [], train=0).views[0].failure is None  # no model was asked for


K = scenes.intrinsics()
POSE = np.eye(4)
BAD_POSE = np.diag([1.0, 1, -1, 1])


@pytest.mark.parametrize("call, kind, words", [
    (lambda: glint.Camera(**{**K, "width": 0}), ValueError, "width"),
    (lambda: glint.Camera(**{**K, "fx": -1.0}), ValueError, "fx"),
    (lambda: glint.Camera(**{**K, "fx": float("nan")}), ValueError, "K"),
    (lambda: glint.Camera(**K, model="PINHOLE9"), ValueError, "OPENCV"),
    (lambda: glint.Camera(**K, distortion=[1, 2]), ValueError, "distortion"),
    (lambda: glint.Camera(**K, camera_from_world=BAD_POSE), ValueError, "mirrored"),
    (lambda: glint.Camera(**K, camera_from_world=2 * POSE), ValueError, "last row"),
    (lambda: glint.Camera(**K, camera_from_world=POSE[:3]), ValueError, r"\(4, 4\)"),
    (lambda: glint.Camera.from_matrix(np.ones((3, 3)), 10, 10), ValueError, "upper triangular"),
    (lambda: glint.Camera(**K).project([[1, 2]]), ValueError, r"\(n, 3\), not \(1, 2\)"),
    (lambda: glint.Camera(**K).project([[0, 0, float("inf")]]), ValueError, r"points\[0\]: is not finite"),
    (lambda: glint.Camera(**K).project(np.ones((2, 3), complex)), TypeError, "complex"),
    (lambda: glint.Camera(**K).project([["a", "b", "c"]]), TypeError, "real numbers"),
    (lambda: glint.Camera(**K).project(None), TypeError, "points"),
    (lambda: glint.Camera(**K).project(np.ma.masked_array(np.ones((1, 3)), mask=True)), TypeError, "masked"),
    (lambda: glint.Camera(**K).project([[1, 2, 3], [4, 5]]), TypeError, "array"),
    (lambda: glint.Plane([0, 0, 0], [0, 0, 0]), ValueError, "length"),
    (lambda: glint.Ellipse([0, 0], [1, 2]), ValueError, "longer"),
    (lambda: glint.Ellipse([0, 0], [2, 1]).sample(-1), ValueError, "n"),
    (lambda: glint.Ellipsoid(np.eye(4), [1, 0, 0]), ValueError, "zero|axes"),
    (lambda: glint.Light.towards([0, 0, 0]), ValueError, ""),
    (lambda: glint.mesh([[0, 0, 0]], [[0, 1, 2]]), ValueError, ""),
    (lambda: glint.mesh(np.zeros((3, 3)), [[0, 1, 2]]), ValueError, ""),
    (lambda: glint.mesh(np.eye(3), [[0, 1, -1]]), ValueError, ""),
    (lambda: glint.mesh(np.eye(3), [[0, 1, 2.0]]), TypeError, "whole numbers"),
    (lambda: glint.mesh(np.eye(3), [[0, 1, 2**40]]), ValueError, "32 bits"),
    (lambda: glint.mesh(np.eye(3), np.array([[0, 1, 2**64 - 1]], np.uint64)), ValueError, "32 bits"),
    (lambda: glint.mesh(np.eye(3) * np.nan, [[0, 1, 2]]), ValueError, "finite"),
    (lambda: glint.mesh(np.eye(3), [[0, 1, 2]], np.eye(3)[:2]), ValueError, "normals"),
    (lambda: glint.mesh([], []), (ValueError, TypeError), ""),
    (lambda: glint.Surface.analytic("cube"), ValueError, "cube"),
    (lambda: glint.Surface.analytic("sphere", radius=-1), ValueError, ""),
    (lambda: glint.Surface.analytic("sphere", radius=float("nan")), ValueError, ""),
    (lambda: glint.Surface.analytic("plane").tessellate(8), ValueError, "no end"),
    (lambda: glint.Surface.analytic("sphere", radius=1).tessellate(10**9), ValueError, "resolution"),
    (lambda: glint.Surface.analytic("plane").first_hits([[0, 0, 1]] * 2, [[0, 0, -1]] * 3), ValueError, "origins"),
    (lambda: glint.Surface.analytic("plane").first_hits([[0, 0, 1]], [[0, 0, 0]]), ValueError, "length"),
    (lambda: glint.depth_map(np.ones((4, 4)), glint.Camera(**K)), ValueError, ""),
    (lambda: glint.depth_map(np.ones((480, 640, 2)), glint.Camera(**K)), ValueError, ""),
    (lambda: glint.detect(np.zeros((0, 5))), ValueError, "65536"),
    (lambda: glint.detect(np.zeros((5, 5, 2))), ValueError, "channels"),
    (lambda: glint.detect(np.zeros((5, 5)), np.zeros((4, 4))), ValueError, "mask"),
    (lambda: glint.detect(np.zeros((5, 5)), "mask"), TypeError, ""),
    (lambda: glint.Highlight([[0, 0], [1, 0], [1, 1]], [0, 0]), ValueError, "at least 5"),
    (lambda: glint.Highlight([[0, 0]] * 6, [0, 0]), ValueError, "no area"),
    (lambda: glint.Highlight(np.eye(6)[:, :2], [0, 0], level=1), ValueError, "level"),
    (lambda: glint.compare_contours([[0, 0]], [[0, 0]]), ValueError, "at least 3"),
    (lambda: glint.compare_contours(np.eye(3)[:, :2], np.eye(3)[:, :2], gaps=[(0, 9)]), ValueError, "gaps"),
    (lambda: glint.iou(3, 4), TypeError, ""),
    (lambda: glint.iou(np.eye(3)[:, :2], np.eye(3)[:, :2], cell_px=0), ValueError, "cell_px"),
    (lambda: glint.fit("dual", []), ValueError, "empty"),
    (lambda: glint.fit(3, []), (TypeError, AttributeError), ""),
    (lambda: glint.estimate_light([]), ValueError, "empty"),
    (lambda: glint.inspect("scene.json"), TypeError, ""),
    (lambda: glint.inspect(glint.open(PLANE), train=[0.5j]), TypeError, "frames"),
    (lambda: glint.inspect(glint.open(PLANE), train=[]), ValueError, "empty"),
    (lambda: glint.inspect(glint.open(PLANE), source="both"), ValueError, "source"),
    (lambda: glint.open(PLANE).scene.pixels(99), IndexError, "99"),
    (lambda: glint.open(PLANE).scene.pixels(True), TypeError, "frame"),
    (lambda: glint.scene([], {}), ValueError, "empty"),
    (lambda: glint.scene([glint.Frame("a", glint.Camera(**K), surface="s")], {"s": {"radius": 1}}), ValueError, "type"),
    (lambda: glint.scene([glint.Frame("a", glint.Camera(**K), surface="x")], {}), ValueError, "'x'"),
    (lambda: glint.scene([glint.Frame("a", glint.Camera(**K), surface="s")] * 2, {"s": {"type": "plane"}}), ValueError, "twice"),
    (lambda: glint.scene([glint.Frame("a", glint.Camera(**K), surface="s")], {"s": {"type": "plane", "size": 1}}), ValueError, "size"),
])
def test_the_callers_bug(call, kind, words):
    with pytest.raises(kind, match=words):
        call()


def test_outside_names_are_input_errors(tmp_path):
    with pytest.raises(glint.InputError, match="oracle"):
        glint.model("oracle")
    with pytest.raises(glint.InputError, match="no such mesh"):
        glint.scene([glint.Frame("a", glint.Camera(**K), surface="s")], {"s": tmp_path / "none.ply"})
    with pytest.raises(glint.InputError, match="no such frame"):
        glint.open(PLANE).scene.pixels("frame of another scene")
    with pytest.raises(glint.InputError):
        glint.set_limit("mesh-megabytes=-1")


def test_nothing_is_overwritten_that_is_not_a_session(tmp_path):
    inspection = glint.inspect(glint.open(PLANE), ["dual"])
    file = tmp_path / "thesis.txt"
    file.write_text("three years")
    with pytest.raises(glint.InputError):
        inspection.save_session(str(file))
    assert file.read_text() == "three years" and list(tmp_path.iterdir()) == [file]
    with pytest.raises(glint.InputError):
        inspection.save_session(str(tmp_path / "no folder" / "s.glint"))
    inspection.save_session(str(tmp_path / "s.glint"), "from a test")
    saved = glint.open(tmp_path / "s.glint", allow_outside=True)
    assert saved.notes == "from a test" and saved.request.models == ["dual"] and saved.replay().digest_agrees
    with pytest.raises(glint.InputError):
        inspection.scene.save(str(PLANE.parent / "scene.json"))


def test_random_arrays_never_crash():
    """Every kind of array for every argument of a few calls: an answer, or an exception of this page."""
    rng = np.random.default_rng(5)
    allowed = (ValueError, TypeError, glint.Error)
    shapes = [(), (0,), (2,), (3,), (4,), (0, 3), (5, 2), (6, 3), (3, 3), (4, 4), (2, 3, 4), (7, 2)]
    dtypes = ["f8", "f4", "f2", "i8", "u1", "c16", "?", "U3", "O", "M8[s]"]
    camera = glint.Camera(**K)
    plane = glint.Surface.analytic("plane")
    calls = [camera.project, camera.undistort, glint.Ellipse.fit, glint.Ellipse.from_conic, glint.Ellipsoid.from_dual, glint.Light.at,
             lambda a: glint.mesh(a, [[0, 1, 2]]), lambda a: glint.mesh(np.eye(3), a), lambda a: glint.Highlight(a, [1, 1]),
             lambda a: plane.first_hits(a, a), lambda a: glint.Camera(**K, camera_from_world=a), glint.detect, lambda a: glint.iou(a, a)]
    outcomes = {True: 0, False: 0}
    for _ in range(3):
        for shape in shapes:
            for dtype in dtypes:
                array = (rng.normal(0, 10, shape) if rng.random() < 0.7 else np.full(shape, rng.choice([np.nan, np.inf, 1e308, 0.0])))
                with np.errstate(all="ignore"):
                    array = np.asarray(array).astype(dtype) if dtype != "M8[s]" else np.zeros(shape, dtype)
                array = array[..., ::-1] if array.ndim and rng.random() < 0.3 else array
                for call in calls:
                    try:
                        call(array)
                        outcomes[True] += 1
                    except allowed:
                        outcomes[False] += 1
    assert outcomes[True] > 50 and outcomes[False] > 1000


@pytest.mark.parametrize("what", ["pickle.dumps(x, 0)", "pickle.dumps(x, 2)", "copy.copy(x)", "x.__reduce__()", "x.__reduce_ex__(0)"])
def test_pickling_is_refused_and_ends_nothing(what):
    program = f"import copy, pickle, glint\nx = glint.Ellipse([1, 2], [3, 2], 0.1)\ntry:\n  {what}\nexcept TypeError as e:\n  print(e)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "cannot pickle or copy 'Ellipse'" in done.stdout, done.stderr


@pytest.mark.parametrize("what", ["base()", "base(x)", "base.__new__(base)", "type('Derived', (base,), {})()",
                                  "copyreg._reduce_ex(x, 1)"])
def test_the_base_of_all_objects_makes_none_and_ends_nothing(what):
    program = f"import copyreg, glint\nx = glint.Ellipse([1, 2], [3, 2], 0.1)\nbase = type(x).__mro__[-2]\ntry:\n  {what}\nexcept TypeError as e:\n  print(e)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "cannot create" in done.stdout, done.stderr


def test_classes_derived_in_python_still_make_objects():
    class Named(glint.Ellipse):
        name = "mine"

    made = Named([1, 2], [3, 2], 0.1)
    assert made.name == "mine" and made.centre[0] == 1
