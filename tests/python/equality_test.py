# SPDX-License-Identifier: BSD-3-Clause
"""Python says what the command line says, to the last bit, for every shipped session. Truth: the program `glint`."""
import json
import pathlib
import subprocess

import numpy as np
import pytest

import glint

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SESSIONS = sorted((SOURCE / "sessions").rglob("*.glint"))


def without_times(value):
    """Times, and what is computed from them, differ from run to run."""
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k not in ("time_us", "predict_us", "exact_predict_us")}
    return [without_times(v) for v in value] if isinstance(value, list) else value


def numbers(value):
    if isinstance(value, dict):
        return sum(numbers(v) for v in value.values())
    if isinstance(value, list):
        return sum(numbers(v) for v in value)
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def command_line(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    # Python's reader keeps every bit: the text has 17 digits where it needs them.
    return json.loads(done.stdout)


def test_there_are_sessions():
    assert len(SESSIONS) >= 11


@pytest.mark.parametrize("session", SESSIONS, ids=lambda p: p.stem if "lessons" not in p.parts else "lesson-" + p.stem)
def test_every_number_of_evaluate(session, program):
    theirs = without_times(command_line(program, "evaluate", session, "--json", "-"))
    opened = glint.open(session)
    inspection = glint.inspect(opened)
    ours = without_times(json.loads(glint.report(inspection)))
    assert numbers(theirs) > 50  # so that two empty answers are not equal
    assert ours == theirs
    # The same numbers as attributes: nothing is rounded on the way into NumPy.
    for name, model in theirs["models"].items():
        fits = inspection.models[name].fits
        assert len(fits) == len(model["fits"])
        for stated, made in zip(model["fits"], fits):
            assert stated["light"] == made.light
            if stated["status"] != "ok":
                assert made.fit is None and made.failure == stated["reason"]
                continue
            if stated["ellipsoid"]:
                assert np.array_equal(made.fit.ellipsoid.centre, stated["ellipsoid"]["centre"])
                assert np.array_equal(made.fit.ellipsoid.semi_axes, stated["ellipsoid"]["semi_axes"])
                assert np.array_equal(made.fit.ellipsoid.world_from_ellipsoid, stated["ellipsoid"]["world_from_ellipsoid"])
            if stated["q_dual"]:
                assert np.array_equal(made.fit.q_dual, stated["q_dual"])
            assert list(made.fit.residual_px) == stated["residual_px"]
        mean, stated = inspection.summary(name)["contour_error_pct"]["mean"], model["summary"]["contour_error_pct"]["mean"]
        assert np.isnan(mean) if stated is None else mean == stated  # a model that fails has no error


def test_the_same_with_settings_frames_and_level(program):
    session = SOURCE / "sessions/ellipsoid/ellipsoid.glint"
    theirs = command_line(program, "evaluate", session, "--models", "dual,limit-angle", "--train", "0,2,4", "--exclude", "1", "--level",
                          "0.6", "--noise-px", "0.2", "--seed", "7", "--set", "predict.directions=20", "--set", "light.solver=triangulated",
                          "--json", "-")
    ours = glint.report(glint.inspect(glint.open(session), ["dual", "limit-angle"], train=[0, 2, 4], exclude=1, level=0.6, noise_px=0.2,
                                      seed=7, predict_directions=20, **{"light.solver": "triangulated"}))
    assert without_times(json.loads(ours)) == without_times(theirs)


def test_the_same_with_a_chosen_model(program):
    session = SOURCE / "sessions/plane/plane.glint"
    theirs = command_line(program, "evaluate", session, "--models", "auto", "--level", "auto", "--json", "-")
    ours = json.loads(glint.report(glint.inspect(glint.open(session), "auto", level="auto")))
    assert ours["chosen_model"] == theirs["chosen_model"]
    assert without_times(ours)["models"] == without_times(theirs)["models"]
    assert ours["level_reason"] == theirs["level_reason"]


def test_lamps(program):
    session = SOURCE / "sessions/two-lamps/two-lamps.glint"
    assert json.loads(glint.lights(glint.open(session)).to_json()) == command_line(program, "lights", session, "--json", "-")


def test_conventions(program):
    session = SOURCE / "sessions/ellipsoid/ellipsoid.glint"
    assert glint.conventions(glint.open(session)) == command_line(program, "info", session, "--json", "-")


def test_replay():
    replay = glint.open(SOURCE / "sessions/plane/plane.glint").replay()
    assert replay.differences == [] and replay.compared > 10


def test_an_object_that_turns_under_known_lamps(program, tmp_path):
    spec = {"camera": {"width": 320, "height": 240, "fx": 400, "fy": 400, "cx": 159.5, "cy": 119.5},
            "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.5, 0.4, 0.35]}}},
            "lights": [{"id": "flash", "frame": "camera", "position": [0.05, -0.02, 0.01], "known": True, "sigma_m": 0.002}],
            "object": {"turn": {"axis": [0, 1, 0], "through": [0, 0, 0], "from": 0, "to": 1.2, "count": 5}},
            "contour": "limit-angle", "limit_angle_deg": 4,
            "path": {"cameras": [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]]}}
    (tmp_path / "spec.json").write_text(json.dumps(spec), encoding="utf-8")
    made = subprocess.run([program, "synth", tmp_path / "spec.json", "-o", tmp_path / "made"], capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    scene = tmp_path / "made" / "scene.json"
    stated = json.loads(scene.read_text(encoding="utf-8"))
    opened = glint.open(scene)
    for frame, theirs in zip(opened.frames, stated["frames"]):
        assert np.array_equal(frame.world_from_object, theirs.get("world_from_object", np.eye(4)))
    light = opened.lights[0]
    assert (light["frame"], light["known"], light["sigma_m"]) == ("camera", True, 0.002)
    inspection = glint.inspect(opened, models=["limit-angle", "reflectance"], train="0-2")
    assert inspection.light_frame == "camera"
    theirs = without_times(command_line(program, "evaluate", scene, "--models", "limit-angle,reflectance", "--train", "0-2", "--json", "-"))
    assert without_times(json.loads(glint.report(inspection))) == theirs
    # The known lamp stays where it is, and its photographs are predicted.
    assert np.allclose(theirs["models"]["limit-angle"]["fits"][0]["light_position"], [0.05, -0.02, 0.01, 1], atol=1e-15)
    assert theirs["models"]["limit-angle"]["summary"]["contour_error_pct"]["max"] < 0.1
    again = glint.Frame("0", glint.Camera(320, 240, 400, 400, 159.5, 119.5), world_from_object=opened.frames[1].world_from_object)
    assert np.array_equal(again.world_from_object, opened.frames[1].world_from_object)
