# SPDX-License-Identifier: BSD-3-Clause
"""Exact synthesis for the tests, by NumPy alone: nothing of Glint computes a number that a test expects."""
import numpy as np


def looking_at(centre, target=(0, 0, 0), up=(0, 0, 1)):
    """camera_from_world, x right, y down, z forward."""
    centre, target = np.asarray(centre, float), np.asarray(target, float)
    z = target - centre
    z /= np.linalg.norm(z)
    x = np.cross(z, up)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z])
    pose[:3, 3] = -pose[:3, :3] @ centre
    return pose


def intrinsics(width=640, height=480, focal=800.0):
    return dict(width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2, cy=(height - 1) / 2)


def matrix(k):
    return np.array([[k["fx"], 0, k["cx"]], [0, k["fy"], k["cy"]], [0, 0, 1.0]])


def to_pixels(k, pose, points):
    """Pinhole projection of (n, 3) world points."""
    x = np.asarray(points, float) @ pose[:3, :3].T + pose[:3, 3]
    h = x @ matrix(k).T
    return h[:, :2] / h[:, 2:]


def mirror_point_on_plane(centre, light, n=(0, 0, 1.0), d=0.0):
    """Where the plane n.x + d = 0 mirrors the light into the camera: on the line from the camera to the light's mirror image."""
    n = np.asarray(n, float)
    image = light - 2 * (n @ light + d) * n
    t = -(n @ centre + d) / (n @ (image - centre))
    return centre + t * (image - centre)


def half_angle(points, n, centre, light):
    """Angle between the normal and the half vector, by atan2: exact near 0."""
    to_light = light - points
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    to_camera = centre - points
    to_camera /= np.linalg.norm(to_camera, axis=1, keepdims=True)
    h = to_light + to_camera
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    n = np.broadcast_to(n, points.shape)
    return np.arctan2(np.linalg.norm(np.cross(n, h), axis=1), np.einsum("ij,ij->i", n, h))


def contour_on_plane(k, centre, pose, light, limit, count=120):
    """The contour of constant half angle on the plane z = 0, by bisection along rays from the mirror point: pixels, peak, world points."""
    n = np.array([0, 0, 1.0])
    peak = mirror_point_on_plane(centre, light)
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    directions = np.stack([np.cos(t), np.sin(t), np.zeros(count)], axis=1)
    low, high = np.zeros(count), np.full(count, 1e-3 * abs(centre[2]))
    while np.any(half_angle(peak + high[:, None] * directions, n, centre, light) < limit):
        high *= 2
    for _ in range(200):
        middle = (low + high) / 2
        inside = half_angle(peak + middle[:, None] * directions, n, centre, light) < limit
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    points = peak + low[:, None] * directions
    return to_pixels(k, pose, points), to_pixels(k, pose, peak[None])[0], points


LIGHT = np.array([0.3, 0.5, 1.4])
LIMIT = np.deg2rad(3.0)


def plane_views(count=8, scale=1.0, light=LIGHT):
    """(intrinsics, pose, centre, contour, peak) of cameras around a glossy plane z = 0, metres times `scale`."""
    k = intrinsics()
    views = []
    for i in range(count):
        angle = -1.9 + 0.45 * i
        centre = scale * np.array([0.9 * np.cos(angle), 0.9 * np.sin(angle), 0.8 + 0.07 * (i % 3)])
        # Near the middle of the image, not in it.
        pose = looking_at(centre, target=mirror_point_on_plane(centre, scale * light) + scale * np.array([0.02, -0.01, 0.0]))
        contour, peak, _ = contour_on_plane(k, centre, pose, scale * light, LIMIT)
        views.append((k, pose, centre, contour, peak))
    return views


def grid_mesh(n=40, size=4.0):
    """A flat square z = 0 of 2 n^2 triangles."""
    s = np.linspace(-size / 2, size / 2, n + 1)
    x, y = np.meshgrid(s, s)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    i = (np.arange(n)[:, None] * (n + 1) + np.arange(n)[None, :]).ravel()
    triangles = np.concatenate([np.stack([i, i + 1, i + n + 2], axis=1), np.stack([i, i + n + 2, i + n + 1], axis=1)])
    return vertices, triangles


def sphere_mesh(radius=0.2, n=80):
    """A sphere about the origin with exact normals."""
    theta = np.linspace(0, np.pi, n + 1)
    phi = np.linspace(0, 2 * np.pi, 2 * n + 1)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    normals = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1).reshape(-1, 3)
    i = (np.arange(n)[:, None] * (2 * n + 1) + np.arange(2 * n)[None, :]).ravel()
    w = 2 * n + 1
    triangles = np.concatenate([np.stack([i, i + w, i + 1], axis=1), np.stack([i + 1, i + w, i + w + 1], axis=1)])
    return radius * normals, triangles, normals
