# SPDX-License-Identifier: BSD-3-Clause
"""Cameras as numbers: Blender's lens as a calibration matrix, projections, rays, and what virtual cameras see. No bpy here.

A Glint camera is a dict with width, height, fx, fy, cx, cy, skew (px; (0, 0) is the centre of the first pixel); its pose is
camera_from_world, a 4x4 of rows, and it looks along +z with y down. A Blender camera looks along -z with y up."""
import numpy

from . import linear

# Camera axes of Glint in those of Blender: y and z turn round.
FLIP = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]


def calibration(width, height, lens, sensor_width, sensor_height, fit, shift_x, shift_y, aspect_x, aspect_y):
    """The Glint camera of a perspective Blender camera.

    width, height: size of the image, px. lens, sensor_width, sensor_height: mm. fit: AUTO, HORIZONTAL or VERTICAL. shift: in units of the
    larger side, as Blender has them. aspect_x, aspect_y: of a pixel. Blender fits the sensor to one side of the image, lengths measured
    in widths of a pixel; AUTO takes the longer side and always the sensor's width."""
    pixel = aspect_y / aspect_x  # height of a pixel in its widths
    if fit == "AUTO":
        horizontal, sensor = width * aspect_x >= height * aspect_y, sensor_width
    else:
        horizontal = fit == "HORIZONTAL"
        sensor = sensor_width if horizontal else sensor_height
    side = width if horizontal else height * pixel
    fx = lens * side / sensor
    return {"width": int(width), "height": int(height), "fx": fx, "fy": fx / pixel, "cx": width / 2 - 0.5 - shift_x * side,
            "cy": height / 2 - 0.5 + shift_y * side / pixel}


def lens_of(camera, sensor_width=36.0):
    """The inverse of `calibration`: lens, shift_x, shift_y for the fit HORIZONTAL, and the aspect of a pixel (x, y), both at least 1."""
    width, height = camera["width"], camera["height"]
    pixel = camera["fx"] / camera["fy"]
    aspect = (1.0, pixel) if pixel >= 1 else (1 / pixel, 1.0)
    return (camera["fx"] * sensor_width / width, (width / 2 - 0.5 - camera["cx"]) / width,
            (camera["cy"] + 0.5 - height / 2) * pixel / width, aspect)


def camera_from_world(matrix_world, world):
    """Pose of a Blender camera object in Glint's world. matrix_world: its 4x4; its scale does not count, as in a render.
    Raises ValueError where the object is mirrored or flat. world: a World."""
    m = linear.rows(matrix_world)
    axes = [linear.column(m, j) for j in range(3)]
    if not all(linear.length(a) > 0 for a in axes):
        raise ValueError("its scale is zero")
    r = linear.transposed([linear.unit(a) for a in axes])
    if not linear.determinant3(r) > 1e-6:  # singular, or left-handed
        raise ValueError("its scale mirrors it, so its picture would be mirrored, too")
    r = linear.nearest_rotation(r)
    pose = linear.product(linear.with_translation(linear.product(world.axes, r), world.to_glint(linear.column(m, 3))), FLIP)
    return linear.inverse_rigid(pose)


def matrix_world_of(pose, world):
    """The inverse of `camera_from_world`: 4x4 of the Blender object, in double precision."""
    m = linear.product(linear.inverse_rigid(pose), FLIP)
    return linear.with_translation(linear.product(linear.transposed(world.axes), linear.block3(m)),
                                   world.to_blender(linear.column(m, 3)))


def calibration_matrix(camera):
    return [[camera["fx"], camera.get("skew", 0.0), camera["cx"]], [0.0, camera["fy"], camera["cy"]], [0.0, 0.0, 1.0]]


def project(camera, pose, point):
    """Ideal pixel of a point of Glint's world; None behind the camera."""
    x = linear.transformed(pose, point)
    if not x[2] > 0:
        return None
    q = linear.product(calibration_matrix(camera), x)
    return [q[0] / q[2], q[1] / q[2]]


def rays(camera, pose, pixels):
    """Centre of the camera, and an array (n, 3) of unit directions of the rays through ideal pixels (n points), in Glint's world."""
    pixels = numpy.array(pixels, dtype=numpy.float64).reshape(-1, 2)
    y = (pixels[:, 1] - camera["cy"]) / camera["fy"]
    x = (pixels[:, 0] - camera["cx"] - camera.get("skew", 0.0) * y) / camera["fx"]
    ways = numpy.stack([x, y, numpy.ones_like(x)], axis=1) @ numpy.array(linear.block3(pose))
    return linear.column(linear.inverse_rigid(pose), 3), ways / numpy.linalg.norm(ways, axis=1, keepdims=True)


def mirrored_pose(pose, point, normal):
    """4x4 of the virtual camera, the one mirrored in the tangent plane: camera_from_world M. Left-handed (method.md section 5)."""
    return linear.product(pose, linear.reflection(point, normal))


def canonical_ellipse(pose, point, normal, q_dual):
    """The outline of the ellipsoid q_dual (4x4) in the virtual camera of the plane (point, unit normal), on that plane.

    The mirror moves no point of the plane, so the virtual camera sees the plane as the camera does: the outline P_v Q* P_v^T is carried
    to the plane by the homography of the camera. Returns the centre and two half axes (vectors of the world, m), None where the outline is
    no ellipse."""
    seen = mirrored_pose(pose, point, normal)[:3]
    outline = linear.product(linear.product(seen, q_dual), linear.transposed(seen))
    u, v = linear.frame_around(normal)
    r = linear.block3(pose)
    to_camera = linear.transposed([linear.product(r, u), linear.product(r, v), linear.transformed(pose, point)])
    try:
        back = linear.inverse3(to_camera)
        conic = linear.inverse3(linear.product(linear.product(back, outline), linear.transposed(back)))
    except ZeroDivisionError:
        return None
    found = linear.ellipse_of_conic(conic)
    if found is None:
        return None
    (a, b), axes, angle = found
    centre = [point[i] + a * u[i] + b * v[i] for i in range(3)]
    cos, sin = linear.math.cos(angle), linear.math.sin(angle)
    first = [axes[0] * (cos * u[i] + sin * v[i]) for i in range(3)]
    second = [axes[1] * (-sin * u[i] + cos * v[i]) for i in range(3)]
    return centre, first, second


class World:
    """Glint's world in Blender's: X_glint = scale * axes * X_blender. axes: a turn by quarter turns, exact. scale: metres per unit."""

    def __init__(self, axes=None, scale=1.0):
        self.axes = [[float(round(v)) for v in row] for row in axes] if axes else linear.identity(3)
        self.scale = float(scale)
        if not (self.scale > 0 and self.scale < 1e9):  # no unit of length is beyond it
            raise ValueError("the scale must be above 0")

    def to_glint(self, point):
        return linear.scaled(linear.product(self.axes, point), self.scale)

    def to_blender(self, point):
        return linear.scaled(linear.product(linear.transposed(self.axes), point), 1 / self.scale)

    def direction_to_glint(self, vector):
        return linear.product(self.axes, vector)

    def direction_to_blender(self, vector):
        return linear.product(linear.transposed(self.axes), vector)

    def motion_to_glint(self, motion):
        """A rigid 4x4 of Blender's world, in Glint's."""
        turn = linear.product(linear.product(self.axes, linear.block3(motion)), linear.transposed(self.axes))
        return linear.with_translation(turn, self.to_glint(linear.column(motion, 3)))

    def motion_to_blender(self, motion):
        turn = linear.product(linear.product(linear.transposed(self.axes), linear.block3(motion)), self.axes)
        return linear.with_translation(turn, self.to_blender(linear.column(motion, 3)))

    def of_cameras(self):
        """The same for the axes of a camera in place of the world's: where things are that a camera carries."""
        return World(linear.block3(FLIP), self.scale)

    def as_matrix(self):
        """4x4, Blender from Glint."""
        return [linear.scaled(row, 1 / self.scale) + [0.0] for row in linear.transposed(self.axes)] + [[0.0, 0.0, 0.0, 1.0]]

    def pose_from(self, pose, other):
        """A camera_from_world that was stated in the world `other`, in this one."""
        turn = linear.product(other.axes, linear.transposed(self.axes))
        factor = self.scale / other.scale
        return linear.with_translation(linear.product(linear.block3(pose), turn), linear.scaled(linear.column(pose, 3), factor))
