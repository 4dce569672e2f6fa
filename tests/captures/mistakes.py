# SPDX-License-Identifier: BSD-3-Clause
"""What people do wrong: each takes a right Capture and returns a wrong one. The sparse points of COLMAP stay with the cameras, not with the mesh."""
import numpy as np

from capture import ellipsoid_mesh, read_png


def _mesh(change):
    def wrong(capture):
        other = capture.measured()
        change(other)
        return other

    return wrong


def turned(axis, degrees):
    a = np.radians(degrees)
    i, k = [(1, 2), (2, 0), (0, 1)][axis]
    r = np.eye(3)
    r[i, i] = r[k, k] = np.cos(a)
    r[i, k], r[k, i] = -np.sin(a), np.sin(a)

    def change(c):
        c.vertices, c.normals = c.vertices @ r.T, c.normals @ r.T

    return _mesh(change)


def scaled(factor):
    def change(c):
        c.vertices = c.vertices * factor

    return _mesh(change)


def shifted(*parts):
    """By parts of the mesh's size along x, y, z."""

    def change(c):
        c.vertices = c.vertices + np.array(parts) * np.linalg.norm(c.vertices.max(0) - c.vertices.min(0))

    return _mesh(change)


def halved(about_itself=False):
    def change(c):
        middle = (c.vertices.max(0) + c.vertices.min(0)) / 2 if about_itself else 0
        c.vertices = middle + 0.5 * (c.vertices - middle)

    return _mesh(change)


def other_mesh(kind):
    """A body of another shape in the same box."""

    def change(c):
        low, high = c.vertices.min(0), c.vertices.max(0)
        ball, normals, faces = ellipsoid_mesh([1, 1, 1])
        if kind == "box":  # rounded: |x|^6 + |y|^6 + |z|^6 = 1
            ball = ball / (np.abs(ball) ** 6).sum(1, keepdims=True) ** (1 / 6)
            normals = np.sign(ball) * np.abs(ball) ** 5
        elif kind == "pear":
            factor = 1 + 0.45 * ball[:, 2:]
            normals = np.stack([ball[:, 0] / factor[:, 0] ** 1, ball[:, 1] / factor[:, 0], ball[:, 2] - 0.45 * (ball[:, 0] ** 2 + ball[:, 1] ** 2) / 1], -1)
            ball = ball * np.hstack([factor, factor, np.ones_like(factor)])
        half = (high - low) / 2 * np.array({"box": [1, 1, 1], "pear": [1, 1, 1], "lying": [1.35, 0.75, 0.8], "flat": [1, 1, 0.8]}[kind])
        normals = normals / half
        c.vertices, c.normals, c.triangles = (high + low) / 2 + ball * half, normals / np.linalg.norm(normals, axis=1, keepdims=True), faces

    return _mesh(change)


def _poses(change):
    def wrong(capture):
        other = capture.measured()
        for f in other.frames:
            f.pose = change(f.pose)
        return other

    return wrong


def _moved(pose, factor):
    pose = pose.copy()
    pose[:3, 3] *= factor
    return pose


def poses_in(factor):
    """COLMAP's points have the unit of the poses."""

    def wrong(capture):
        other = capture.measured()
        for f in other.frames:
            f.pose = _moved(f.pose, factor)
        other.points = (other.points[0] * factor, other.points[1])
        return other

    return wrong


inverse_poses = _poses(np.linalg.inv)
opengl_axes = _poses(lambda pose: np.diag([1.0, -1, -1, 1]) @ pose)
inverse_opengl = _poses(lambda pose: np.linalg.inv(np.diag([1.0, -1, -1, 1]) @ pose))


def order_of_poses(by):
    """The photographs have the poses of others."""

    def wrong(capture):
        other = capture.measured()
        poses = [f.pose for f in other.frames]
        for i, f in enumerate(other.frames):
            f.pose = poses[(i + by) % len(poses)]
        return other

    return wrong


def swapped(one, other_one):
    """Two photographs have each other's poses."""

    def wrong(capture):
        other = capture.measured()
        a, b = other.frames[one], other.frames[other_one]
        a.pose, b.pose = b.pose, a.pose
        return other

    return wrong


def focal(factor):
    def wrong(capture):
        other = capture.measured()
        other.intrinsics[0] *= factor
        other.intrinsics[1] *= factor
        return other

    return wrong


def _images(change, swap=False):
    def wrong(capture):
        other = capture.measured()
        for f in other.frames:
            f.image = np.ascontiguousarray(change(f.image if isinstance(f.image, np.ndarray) else read_png(f.image)))
        if swap:
            other.size = (other.size[1], other.size[0])
        return other

    return wrong


mirrored = _images(lambda p: p[:, ::-1])
upside_down = _images(lambda p: p[::-1])
turned_180 = _images(lambda p: p[::-1, ::-1])
turned_90 = _images(lambda p: np.rot90(p, -1), swap=True)  # clockwise; poses and intrinsics are those of the stored pictures
turned_270 = _images(lambda p: np.rot90(p), swap=True)
grey = _images(lambda p: np.full_like(p, 0.35 * np.iinfo(p.dtype).max))


def _matte(p):
    """Without the highlight: the brightest are cut at what most of the object has."""
    most = np.percentile(p[p > 0], 50) if (p > 0).any() else 0
    return np.minimum(p, p.dtype.type(most))


no_highlight = _images(_matte)


def mostly_dark(capture):
    """Two of three photographs show no highlight."""
    dark, other = no_highlight(capture), capture.measured()
    other.frames = [f if i % 3 == 0 else dark.frames[i] for i, f in enumerate(other.frames)]
    return other
