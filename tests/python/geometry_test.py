# SPDX-License-Identifier: BSD-3-Clause
"""Cameras and conics against closed forms in NumPy."""
import numpy as np
import pytest

import glint
import scenes

EXACT = 1e-10  # px and world units: round-off of a few operations on numbers of order 1000


@pytest.fixture
def view():
    k = scenes.intrinsics()
    pose = scenes.looking_at([0.5, -1.2, 0.9], target=[0.1, 0, 0.05])
    return k, pose, glint.Camera(**k, camera_from_world=pose)


def test_projection_is_the_pinhole_camera(view):
    k, pose, camera = view
    points = np.random.default_rng(1).uniform(-0.2, 0.2, (50, 3))
    assert np.allclose(camera.project(points), scenes.to_pixels(k, pose, points), atol=EXACT, rtol=0)
    homogeneous = np.c_[points, np.ones(50)] @ camera.projection.T
    assert np.allclose(homogeneous[:, :2] / homogeneous[:, 2:], scenes.to_pixels(k, pose, points), atol=EXACT, rtol=0)
    assert np.allclose(camera.centre, [0.5, -1.2, 0.9], atol=1e-14)
    assert np.array_equal(camera.K, scenes.matrix(k))
    assert np.allclose(camera.depth(points), (points @ pose[:3, :3].T + pose[:3, 3])[:, 2], atol=1e-14)


def test_directions_go_back_to_the_points(view):
    _, _, camera = view
    points = np.random.default_rng(2).uniform(-0.2, 0.2, (20, 3))
    directions = camera.directions(camera.project(points))
    expected = points - camera.centre
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(directions, expected, atol=1e-13)


def test_what_is_behind_the_camera_has_no_pixel(view):
    _, _, camera = view
    pixels = camera.project(np.array([camera.centre - 0.5 * camera.directions([[320, 240]])[0], [0, 0, 0]]))
    assert np.isnan(pixels[0]).all() and np.isfinite(pixels[1]).all()


def test_distortion_is_brown_conrady():
    k = scenes.intrinsics()
    k1, k2, p1, p2, k3 = 0.12, -0.05, 0.001, -0.002, 0.01
    camera = glint.Camera(**k, distortion=[k1, k2, p1, p2, k3])
    ideal = np.array([[100.0, 80.0], [500, 400], [319.5, 239.5]])
    x, y = ((ideal - [k["cx"], k["cy"]]) / k["fx"]).T
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    expected = np.stack([u, v], axis=1) * k["fx"] + [k["cx"], k["cy"]]
    assert np.allclose(camera.distort(ideal), expected, atol=EXACT, rtol=0)
    assert np.allclose(camera.undistort(expected), ideal, atol=1e-9, rtol=0)
    assert np.array_equal(camera.distortion, [k1, k2, p1, p2, k3]) and camera.model == "OPENCV"


def test_the_virtual_camera_sees_through_the_mirror(view):
    k, pose, camera = view
    n = np.array([0.1, -0.3, 0.9])
    plane = glint.Plane([0.02, 0.03, -0.01], n)
    n /= np.linalg.norm(n)
    points = np.random.default_rng(3).uniform(-0.2, 0.2, (10, 3))
    mirrored = points - 2 * ((points - [0.02, 0.03, -0.01]) @ n)[:, None] * n
    seen = np.c_[points, np.ones(10)] @ camera.virtual(plane).T
    assert np.allclose(seen[:, :2] / seen[:, 2:], scenes.to_pixels(k, pose, mirrored), atol=EXACT, rtol=0)
    assert np.linalg.det(camera.virtual(plane)[:, :3]) < 0
    assert np.allclose(plane.signed_distance(points), (points - [0.02, 0.03, -0.01]) @ n, atol=1e-15)
    assert np.allclose(plane.reflection @ plane.reflection, np.eye(4), atol=1e-14)


def test_outline_of_a_sphere_is_its_cone_of_rays(view):
    k, pose, camera = view
    centre, radius = np.array([0.05, 0.1, 0.0]), 0.15
    outline = glint.Ellipsoid(np.array([[1, 0, 0, 0.05], [0, 1, 0, 0.1], [0, 0, 1, 0], [0, 0, 0, 1.0]]), [radius] * 3).outline(camera.projection)
    # Every ray through the outline touches the sphere: its distance from the centre is the radius.
    d = camera.directions(outline.sample(60))
    to_centre = centre - camera.centre
    distance = np.linalg.norm(np.cross(np.broadcast_to(to_centre, d.shape), d), axis=1)
    assert np.allclose(distance, radius, atol=1e-12)


def test_dual_quadric_and_back():
    pose = np.linalg.inv(scenes.looking_at([0.3, 0.2, 0.1]))
    q = pose @ np.diag([-0.3**2, -0.2**2, -0.1**2, 1.0]) @ pose.T
    ellipsoid = glint.Ellipsoid.from_dual(-3.7 * q)
    assert np.allclose(ellipsoid.semi_axes, [0.3, 0.2, 0.1], atol=1e-13)
    assert np.allclose(ellipsoid.centre, pose[:3, 3], atol=1e-14)
    assert np.allclose(ellipsoid.q_dual, q / q[3, 3], atol=1e-14)


def test_ellipse_through_exact_points():
    t = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    a, b, angle, centre = 40.0, 15.0, 0.4, np.array([200.0, 150.0])
    points = centre + np.stack([a * np.cos(t) * np.cos(angle) - b * np.sin(t) * np.sin(angle),
                                a * np.cos(t) * np.sin(angle) + b * np.sin(t) * np.cos(angle)], axis=1)
    e = glint.Ellipse.fit(points)
    assert np.allclose(e.centre, centre, atol=1e-8) and np.allclose(e.semi_axes, [a, b], atol=1e-8) and abs(e.angle - angle) < 1e-9
    assert abs(e.area - np.pi * a * b) < 1e-6
    h = np.c_[points, np.ones(30)]
    assert np.allclose(np.einsum("ni,ij,nj->n", h, e.conic, h), 0, atol=1e-9)
    again = glint.Ellipse.from_dual(-5 * e.dual)
    assert np.allclose(again.semi_axes, [a, b], atol=1e-6)


def test_lights():
    at = glint.Light.at([0.1, 0.2, 3.0])
    assert np.allclose(at.position, [0.1, 0.2, 3.0]) and not at.at_infinity
    assert np.allclose(at.direction_from([0.1, 0.2, 1.0]), [0, 0, 1])
    sun = glint.Light.towards([0, 3, 4])
    assert sun.at_infinity and sun.position is None and np.allclose(sun.direction_from([9, 9, 9]), [0, 0.6, 0.8])
    assert glint.Light.from_homogeneous([1, 2, 3, 0]).at_infinity


def test_metrics_of_circles():
    t = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    circle = lambda r, x=0.0: np.stack([x + r * np.cos(t), r * np.sin(t)], axis=1)  # noqa: E731
    m = glint.compare_contours(circle(20), circle(22))
    assert abs(m.contour_error_px - 2) < 1e-3 and abs(m.contour_error_pct - 100 * 2 / 40) < 1e-2
    assert abs(m.hausdorff_px - 2) < 1e-3 and abs(m.iou - (20 / 22)**2) < 1e-3 and m.centre_offset_px < 1e-9
    # Two circles of radius r whose centres are d apart: area of the lens in closed form.
    r, d = 20.0, 13.0
    lens = 2 * r * r * np.arccos(d / (2 * r)) - d / 2 * np.sqrt(4 * r * r - d * d)
    assert abs(glint.iou(circle(r), circle(r, d)) - lens / (2 * np.pi * r * r - lens)) < 1e-3
    assert glint.iou([circle(5)], [circle(5), circle(5, 100)]) == pytest.approx(0.5, abs=1e-3)
