# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces from NumPy against closed forms."""
import numpy as np
import pytest

import glint
import scenes


def test_rays_meet_a_sphere_where_the_quadratic_says():
    rng = np.random.default_rng(4)
    origin = np.array([0.1, -2.0, 0.3])
    directions = rng.normal(0, 0.08, (500, 3)) + [0, 1, -0.1]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    radius = 0.2
    b, c = directions @ origin, origin @ origin - radius**2
    root = b * b - c
    hits = glint.Surface.analytic("sphere", radius=radius).first_hits([origin], 3 * directions)
    assert np.array_equal(hits.hit, root > 0) and 50 < hits.hit.sum() < 450
    t = -b[hits.hit] - np.sqrt(root[hits.hit])
    expected = origin + t[:, None] * directions[hits.hit]
    assert np.allclose(hits.positions[hits.hit], expected, atol=1e-12)
    assert np.allclose(hits.normals[hits.hit], expected / radius, atol=1e-11)
    assert np.isnan(hits.positions[~hits.hit]).all() and len(hits) == 500


@pytest.mark.parametrize("dtype", ["float64", "float32", ">f8"])
@pytest.mark.parametrize("index", ["int32", "int64", "uint8", "uint64"])
def test_a_mesh_of_any_numbers(dtype, index):
    vertices, triangles = scenes.grid_mesh(n=4, size=2.0)
    flat = glint.mesh(vertices.astype(dtype), triangles.astype(index))
    hits = flat.first_hits([[0.3, 0.1, 1.0]], [[0, 0, -1.0]])
    assert hits.hit[0] and np.allclose(hits.positions[0], [0.3, 0.1, 0], atol=1e-9)
    corners = vertices[triangles[hits.elements[0]]]  # the hit lies in the triangle that it names
    assert corners[:, 0].min() <= 0.3 <= corners[:, 0].max() and corners[:, 1].min() <= 0.1 <= corners[:, 1].max()


def test_a_mesh_that_is_not_contiguous():
    vertices, triangles = scenes.grid_mesh(n=4, size=2.0)
    wide = np.zeros((len(vertices), 6))
    wide[:, ::2] = vertices
    flat = glint.mesh(wide[:, ::2], np.asfortranarray(triangles))
    assert np.allclose(flat.first_hits([[0.3, 0.1, 1]], [[0, 0, -1]]).positions[0], [0.3, 0.1, 0], atol=1e-9)


def test_mirror_point_of_a_plane():
    centre = np.array([0.5, -0.4, 1.0])
    camera = glint.Camera(**scenes.intrinsics(), camera_from_world=scenes.looking_at(centre))
    expected = scenes.mirror_point_on_plane(centre, scenes.LIGHT)
    for surface in (glint.Surface.analytic("plane"), glint.mesh(*scenes.grid_mesh())):
        found = surface.brightest_points(camera, glint.Light.at(scenes.LIGHT))
        assert len(found) == 1
        assert np.allclose(found[0].position, expected, atol=1e-9) and found[0].alpha < 1e-9
        assert np.allclose(found[0].normal, [0, 0, 1], atol=1e-12)
        back = surface.observed_brightest_point(camera, found[0].pixel)
        assert np.allclose(back.position, expected, atol=1e-9)


def test_depth_of_a_plane_is_the_plane():
    k = scenes.intrinsics(160, 120, 200.0)
    centre = np.array([0.2, -0.5, 1.0])
    pose = scenes.looking_at(centre)
    camera = glint.Camera(**k, camera_from_world=pose)
    u, v = np.meshgrid(np.arange(160.0), np.arange(120.0))
    rays = camera.directions(np.stack([u.ravel(), v.ravel()], axis=1))
    points = centre + (-centre[2] / rays[:, 2])[:, None] * rays
    depth = (points @ pose[:3, :3].T + pose[:3, 3])[:, 2].reshape(120, 160)
    depth[10, 10] = np.nan  # a pixel that measured nothing
    surface = glint.depth_map(depth, camera)
    hits = surface.first_hits([centre], camera.directions([[80.3, 60.7], [40, 90]]))
    # Single precision of a depth of about 1.1 m, seen at a slant.
    assert hits.hit.all() and np.abs(hits.positions[:, 2]).max() < 1e-6
    # The grid of pixels without a copy of its own type: float32 says the same.
    same = glint.depth_map(depth.astype(np.float32), camera).first_hits([centre], camera.directions([[80.3, 60.7], [40, 90]]))
    assert np.array_equal(same.positions, hits.positions)


def test_curvature_of_a_cylinder():
    cylinder = glint.Surface.analytic("cylinder", radius=0.25)
    k1, k2 = cylinder.curvature([0, 0, 2], [0, 0, -1])
    assert abs(k1 - 4) < 1e-9 and abs(k2) < 1e-9


def test_triangles_for_display_lie_on_the_sphere():
    mesh = glint.Surface.analytic("sphere", radius=0.2).tessellate(24)
    assert len(mesh.vertices) > 100 and mesh.triangles.max() < len(mesh.vertices)
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 0.2, atol=1e-12)


def test_bounds():
    assert np.allclose(glint.Surface.analytic("sphere", radius=0.2).bounds, [[-0.2] * 3, [0.2] * 3])
    assert np.isinf(glint.Surface.analytic("plane").bounds).any()


def test_the_given_normals_of_a_mesh_count():
    """A flat square whose vertices all say the same other normal: interpolation of equal vectors is that vector."""
    vertices, triangles = scenes.grid_mesh(4, 2.0)
    said = np.array([0.3, -0.2, 1.0]) / np.linalg.norm([0.3, -0.2, 1.0])
    ray = ([[0.1, 0.2, 1.0]], [[0, 0, -1.0]])
    with_normals = glint.mesh(vertices, triangles, np.tile(said, (len(vertices), 1))).first_hits(*ray)
    without = glint.mesh(vertices, triangles).first_hits(*ray)
    assert np.abs(with_normals.normals[0] - said).max() < 1e-6 and np.abs(without.normals[0] - [0, 0, 1]).max() < 1e-6
