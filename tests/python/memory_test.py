# SPDX-License-Identifier: BSD-3-Clause
"""Views without copies, and who keeps what alive."""
import gc
import pathlib
import resource
import weakref

import numpy as np
import pytest

import glint
import scenes

SESSION = pathlib.Path(__file__).resolve().parents[2] / "sessions/ellipsoid/ellipsoid.glint"


def address(array):
    return array.__array_interface__["data"][0]


def is_view_of(array, owner):
    return not array.flags.owndata and not array.flags.writeable and array.base is owner


@pytest.fixture(scope="module")
def inspection():
    return glint.inspect(glint.open(SESSION), ["dual", "limit-angle"])


def test_contours_are_views(inspection):
    highlight = inspection.evidence[0].highlights[0]
    assert is_view_of(highlight.contour, highlight)
    assert address(highlight.contour) == address(highlight.contour)  # the same memory each time, not a copy of it
    predicted = inspection.models["dual"].frames[0].prediction[0]
    assert is_view_of(predicted.contour, predicted) and address(predicted.contour) == address(predicted.contour)
    assert predicted.contour.strides == (16, 8) and predicted.contour.dtype == np.float64


def test_vertices_are_views():
    mesh = glint.Surface.analytic("sphere", radius=0.2).tessellate(16)
    for array, dtype in ((mesh.vertices, np.float64), (mesh.normals, np.float64), (mesh.triangles, np.int32)):
        assert is_view_of(array, mesh) and array.dtype == dtype and array.shape[1] == 3
    assert address(mesh.vertices) == address(mesh.vertices)
    with pytest.raises(ValueError):
        mesh.vertices[0, 0] = 1.0


def test_hits_are_views():
    hits = glint.Surface.analytic("sphere", radius=0.2).first_hits([[0, 0, 2]], [[0, 0, -1]] * 4)
    for array in (hits.positions, hits.normals, hits.elements, hits.hit):
        assert is_view_of(array, hits)


def test_an_array_keeps_its_owner_alive():
    inspection = glint.inspect(glint.open(SESSION), ["dual"])
    contour = inspection.models["dual"].frames[0].prediction[0].contour
    evidence = inspection.evidence[0].highlights[0].contour
    before = contour.copy(), evidence.copy()
    gone = weakref.finalize(contour, lambda: None)
    del inspection
    gc.collect()
    trash = [np.random.default_rng(i).random(1 << 16) for i in range(64)]  # what was freed would be written over
    assert np.array_equal(contour, before[0]) and np.array_equal(evidence, before[1]) and gone.alive
    del trash


def test_nothing_is_left_behind():
    """Memory does not grow with repetitions: owners are freed with their last array."""
    def once():
        mesh = glint.Surface.analytic("sphere", radius=0.2).tessellate(200)
        return mesh.vertices, mesh.triangles

    for _ in range(5):
        once()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    size = sum(a.nbytes for a in once())
    for _ in range(100):
        once()
    gc.collect()
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    assert grown < 20 * size, f"{grown} bytes more after 100 meshes of {size}"


def test_an_image_is_a_view():
    scene = glint.open(SESSION).scene
    pixels = scene.pixels(0)
    assert not pixels.flags.owndata and not pixels.flags.writeable and pixels.dtype == np.float32
    k = scene.frames[0].camera
    assert pixels.shape[:2] == (k.height, k.width)


def test_input_of_the_right_type_is_not_changed():
    vertices, triangles = scenes.grid_mesh(4)
    before = vertices.copy()
    glint.mesh(vertices, triangles)
    assert np.array_equal(vertices, before) and vertices.flags.writeable
