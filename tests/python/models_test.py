# SPDX-License-Identifier: BSD-3-Clause
"""Every model's fit and predict on exact contours of a plane, made by NumPy: nominal, scale, noise, degenerate."""
import numpy as np
import pytest

import glint
import scenes

MODELS = [m.id for m in glint.models()]
# Highlights are 100 px wide. limit-angle makes no assumption that is not true here; what is left (0.005 px) is the polygon of 120 points.
# An ellipse is only nearly the contour of a near lamp on a plane (measured: 0.27 px), and so is the level set of a lobe (0.12 px).
NOMINAL_PX = {"limit-angle": 0.02, "reflectance": 0.2}


def training(views, surface, noise=0.0, seed=0):
    rng = np.random.default_rng(seed)
    made = []
    for number, (k, pose, _, contour, peak) in enumerate(views):
        contour = contour + rng.normal(0, noise, contour.shape) if noise else contour
        peak = peak + rng.normal(0, noise, 2) if noise else peak
        made.append(glint.TrainingView(glint.Camera(**k, camera_from_world=pose), surface, glint.Highlight(contour, peak, "lamp"), number))
    return made


def errors_of(model, surface, noise=0.0, scale=1.0):
    """Contour errors, px, of views 6 and 7 predicted from views 0 to 5."""
    views = scenes.plane_views(8, scale)
    fit = glint.fit(model, training(views[:6], surface, noise))
    assert fit.model == model and fit.light == "lamp" and fit.frames == [0, 1, 2, 3, 4, 5]
    errors = []
    for k, pose, _, contour, _ in views[6:]:
        prediction = glint.predict(fit, glint.Camera(**k, camera_from_world=pose), surface)
        assert len(prediction) == 1
        errors.append(glint.compare_contours(contour, prediction[0].contour).contour_error_px)
    return errors


def test_models_are_those_of_the_program():
    assert len(MODELS) >= 5 and [m.id for m in glint.models() if m.needs_light]
    for m in glint.models():
        assert m.title and m.assumption and m.reference and m.colour.startswith("#") and len(m.colour) == 7


@pytest.mark.parametrize("model", MODELS)
def test_nominal(model):
    assert max(errors_of(model, glint.Surface.analytic("plane"))) < NOMINAL_PX.get(model, 0.35)


@pytest.mark.parametrize("model", MODELS)
def test_scale(model):
    # In millimetres: the same pixels. A search stops when its steps no longer count, so not to the last bit.
    plane = glint.Surface.analytic("plane")
    assert np.allclose(errors_of(model, plane, scale=1000.0), errors_of(model, plane), atol=2e-3)


@pytest.mark.parametrize("model", MODELS)
def test_noise(model):
    # 0.3 px on each coordinate of 120 points: a fit of many points errs by far less than one point does.
    assert max(errors_of(model, glint.Surface.analytic("plane"), noise=0.3)) < NOMINAL_PX.get(model, 0.35) + 0.3


@pytest.mark.parametrize("model", MODELS)
def test_degenerate(model):
    # A surface that no ray of a peak meets: there is nothing to fit. primal alone needs no surface; it lacks views.
    nowhere = glint.Surface.analytic("sphere", radius=1e-3, world_from_surface=np.array([[1, 0, 0, 9], [0, 1, 0, 9], [0, 0, 1, 9], [0, 0, 0, 1.0]]))
    with pytest.raises(glint.CannotAnswer) as failure:
        glint.fit(model, training(scenes.plane_views(2 if model == "primal" else 6), nowhere))
    assert failure.value.reason == "too few views"


def test_the_light_is_where_the_contours_come_from():
    estimate = glint.estimate_light(training(scenes.plane_views(), glint.Surface.analytic("plane")))
    assert np.allclose(estimate.light.position, scenes.LIGHT, atol=1e-5)
    # The chords of a polygon of 120 corners lie inside of its contour by up to 1 - cos(pi / 120).
    assert abs(estimate.limit_angle - scenes.LIMIT) < (1 - np.cos(np.pi / 120)) * scenes.LIMIT
    assert estimate.covariance.shape == (3, 3) and len(estimate.residual_px) == 8 and estimate.solver == "bundle"
    triangulated = glint.estimate_light(training(scenes.plane_views(), glint.Surface.analytic("plane")), light_solver="triangulated")
    assert triangulated.solver == "triangulated" and np.allclose(triangulated.light.position, scenes.LIGHT, atol=1e-6)


def test_a_light_that_is_known_need_not_be_estimated():
    plane = glint.Surface.analytic("plane")
    views = training(scenes.plane_views(6), plane)
    fit = glint.fit("limit-angle", views, glint.LightEstimate(glint.Light.at(scenes.LIGHT), scenes.LIMIT))
    assert np.allclose(fit.light_estimate.position, scenes.LIGHT, atol=1e-15) and abs(fit.limit_angle - scenes.LIMIT) < 1e-12


def test_what_a_view_adds():
    k, pose, centre, contour, peak = scenes.plane_views(1)[0]
    camera = glint.Camera(**k, camera_from_world=pose)
    view = glint.TrainingView(camera, glint.Surface.analytic("plane"), glint.Highlight(contour, peak, "lamp"))
    assert view.failure is None
    assert np.allclose(view.brightest_point.position, scenes.mirror_point_on_plane(centre, scenes.LIGHT), atol=1e-9)
    assert np.allclose(view.tangent_plane.normal, [0, 0, 1], atol=1e-12)
    assert np.allclose(view.virtual_camera, camera.virtual(view.tangent_plane), atol=1e-9)
    off = glint.TrainingView(camera, glint.Surface.analytic("sphere", radius=0.01), glint.Highlight(contour, peak, "lamp"))
    assert off.failure.startswith("peak off surface") and off.brightest_point is None and off.virtual_camera is None


def test_predictions_on_a_mesh_from_numpy():
    # The mesh is flat, so its predictions are those of the plane.
    assert max(errors_of("limit-angle", glint.mesh(*scenes.grid_mesh()))) < NOMINAL_PX["limit-angle"]


def test_detection_of_a_bump_of_known_shape():
    u, v = np.meshgrid(np.arange(200.0), np.arange(160.0))
    centre, s = np.array([90.3, 70.6]), np.array([12.0, 7.0])
    image = 4.0 * np.exp(-((u - centre[0]) / s[0])**2 / 2 - ((v - centre[1]) / s[1])**2 / 2)
    found = glint.detect(image, light="lamp", detect_level=0.5)
    assert len(found) == 1 and found[0].light == "lamp"
    assert np.allclose(found[0].peak, centre, atol=2e-3)
    # Half of the peak is at sqrt(2 ln 2) standard deviations.
    assert np.allclose(found[0].ellipse.semi_axes, np.sqrt(2 * np.log(2)) * s, rtol=2e-2)
    assert len(glint.detect(np.repeat(image[:, :, None], 3, axis=2), np.ones(image.shape, bool))) == 1
    with pytest.raises(glint.CannotAnswer) as failure:
        glint.detect(np.zeros((50, 60)))
    assert failure.value.reason == "no highlight"


def test_a_scene_from_memory_is_inspected():
    views = scenes.plane_views(8)
    frames = [glint.Frame(f"{i:04d}", glint.Camera(**k, camera_from_world=pose), surface="table", lights_on=["lamp"],
                          highlights=[glint.Highlight(contour, peak, "lamp")]) for i, (k, pose, _, contour, peak) in enumerate(views)]
    scene = glint.scene(frames, {"table": {"type": "plane"}}, "made")
    inspection = glint.inspect(scene, train="first:6")
    assert inspection.train == [0, 1, 2, 3, 4, 5] and inspection.held_out == [6, 7]
    for model in MODELS:
        summary = inspection.summary(model)
        assert summary["predicted"] == summary["frames"] == 2 and summary["contour_error_px"]["max"] < NOMINAL_PX.get(model, 0.35)
    assert np.allclose(inspection.lights()["lamp"].light.position, scenes.LIGHT, atol=1e-5)


def test_a_drawing_has_what_the_definitions_say():
    views = scenes.plane_views(8)
    frames = [glint.Frame(f"{i:04d}", glint.Camera(**k, camera_from_world=pose), surface="table", lights_on=["lamp"],
                          highlights=[glint.Highlight(contour, peak, "lamp")]) for i, (k, pose, _, contour, peak) in enumerate(views)]
    inspection = glint.inspect(glint.scene(frames, {"table": {"type": "plane"}}), ["dual", "limit-angle"], train="first:6")
    for frame in 2, "0007":  # one that trains, and one that does not
        k, pose, centre, contour, _ = views[int(frame)]
        drawing = inspection.drawing(frame)
        role = lambda name, model="": [t for t in drawing if t["role"] == name and t["model"] == model]
        (point,), (plane,), (virtual,) = role("brightest-point"), role("tangent-plane"), role("virtual-camera")
        at = scenes.mirror_point_on_plane(centre, scenes.LIGHT)
        assert np.allclose(point["place"], [*at, 1], atol=1e-9) and np.allclose(point["normal"], [0, 0, 1])
        assert np.allclose(plane["place"], [*at, 1], atol=1e-9) and np.allclose(plane["chains"][0][:, 2], 0, atol=1e-9)
        assert np.allclose(virtual["place"], [*(centre * [1, 1, -1]), 1])
        (ray,) = role("reflected-ray")
        along = ray["chains"][0][1] - ray["chains"][0][0]
        assert np.allclose(along / np.linalg.norm(along), (scenes.LIGHT - at) / np.linalg.norm(scenes.LIGHT - at), atol=1e-6)
        (seen,) = role("observed-contour")
        drawn = scenes.to_pixels(k, pose, seen["chains"][0])  # it may run the other way round
        assert len(drawn) == len(contour) + 1 and np.abs(drawn[:, None] - contour).sum(axis=2).min(axis=1).max() < 1e-6
        assert role("predicted-contour", "dual") and role("tangent-plane", "dual") and role("surface")[0]["mesh"] is not None
        assert all(chain.shape[1] == 3 for thing in drawing for chain in thing["chains"])
    scene = inspection.drawing()
    assert {t["role"] for t in scene} == {"light", "fitted-lamp", "ellipsoid"}
    light = next(t for t in scene if t["role"] == "light")
    assert np.allclose(light["place"][:3] / light["place"][3], scenes.LIGHT, atol=1e-5) and light["arrow"] is None
    body, fit = next(t for t in scene if t["role"] == "ellipsoid"), inspection.models["dual"].fits[0].fit
    if fit.ellipsoid is not None:
        unit = np.linalg.inv(fit.ellipsoid.world_from_ellipsoid) @ body["world_from_ball"] @ [0.6, 0, 0.8, 1]
        assert np.allclose(unit[:3], fit.ellipsoid.semi_axes * [0.6, 0, 0.8])
    with pytest.raises(glint.InputError):
        inspection.drawing("none")


def test_live_poses():
    views = scenes.plane_views(8)
    frames = [glint.Frame(f"{i:04d}", glint.Camera(**k, camera_from_world=pose), surface="table", lights_on=["lamp"],
                          highlights=[glint.Highlight(contour, peak, "lamp")]) for i, (k, pose, _, contour, peak) in enumerate(views[:7])]
    scene = glint.scene(frames, {"table": {"type": "plane"}})
    predictor = glint.Predictor(scene, glint.inspect(scene, ["canonical"]).request)
    k, pose, _, contour, _ = views[7]
    (model, light, prediction), = predictor.predict("live", pose)
    assert (model, light) == ("canonical", "lamp")
    assert glint.compare_contours(contour, prediction[0].contour).contour_error_px < 0.35


def test_the_lamp_of_a_lobe_says_its_shape_and_place():
    plane, views = glint.Surface.analytic("plane"), scenes.plane_views(6)
    fit = glint.fit("reflectance", training(views, plane))
    lamp = fit.lamp
    assert lamp["radius"] == fit.light_radius and fit.roughness_ratio is None
    points = lamp["position"] if lamp["shape"] != "segment" else lamp["segment"].mean(axis=0)
    assert np.allclose(points, fit.light_estimate.position, atol=1e-12)
    assert len(lamp["outline"]) == {"point": 0, "sphere": 3, "segment": 1}[lamp["shape"]]
    assert all(chain.ndim == 2 and chain.shape[1] == 3 for chain in lamp["outline"])
    assert glint.fit("limit-angle", training(views, plane)).lamp is None
