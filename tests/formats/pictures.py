# SPDX-License-Identifier: BSD-3-Clause
"""What a camera sees of the ellipsoid, pixel by pixel from the equation of the ray (no mesh), and PNG files of it."""
import array
import math
import struct
import sys
import zlib

from exact_scene import CENTRE, LAMP, SEMI_AXES, WORLD_FROM_BODY, add, dot, scaled, sub, times, transposed, unit

ALBEDO = (0.36, 0.21, 0.11)  # linear; so low that nothing is clipped under the highlight
AMBIENT, SPECULAR, EXPONENT = 0.06, 0.55, 90.0
BACKGROUND = (0.012, 0.016, 0.022)


def srgb(linear):
    """The camera's curve (IEC 61966-2-1), as 8 bits."""
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return min(255, max(0, round(255 * encoded)))


def png(width, height, channels, bits, data):
    """A PNG file of rows without gaps; 16 bits are big-endian."""
    row = width * channels * bits // 8
    raw = b"".join(b"\0" + data[at:at + row] for at in range(0, row * height, row))

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    header = struct.pack(">IIBBBBB", width, height, bits, {1: 0, 3: 2}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 6)) + chunk(b"IEND", b"")


class Pictures:
    """Photograph, depth and mask of a view. Files are made once, however many formats have them."""

    def __init__(self, width, height, photograph, depth):
        self.width, self.height = width, height
        self.photograph = photograph  # bytes, 8-bit RGB
        self.depth = depth  # metres along the axis, 0 = nothing
        self.files = {}

    def photograph_png(self):
        return self.kept("photograph", lambda: png(self.width, self.height, 3, 8, self.photograph))

    def mask_png(self):
        return self.kept("mask", lambda: png(self.width, self.height, 1, 8, bytes(255 if z > 0 else 0 for z in self.depth)))

    def depth_png(self, units_per_metre):
        def make():
            stored = array.array("H", (int(z * units_per_metre + 0.5) for z in self.depth))
            if sys.byteorder == "little":
                stored.byteswap()
            return png(self.width, self.height, 1, 16, stored.tobytes())
        return self.kept(units_per_metre, make)

    def kept(self, key, make):
        if key not in self.files:
            self.files[key] = make()
        return self.files[key]

    def mirrored(self):
        """All of them, left and right exchanged."""
        pixels = [self.photograph[i:i + 3] for i in range(0, len(self.photograph), 3)]
        rows = range(0, self.width * self.height, self.width)
        photograph = b"".join(pixel for at in rows for pixel in reversed(pixels[at:at + self.width]))
        depth = array.array("d", (z for at in rows for z in reversed(self.depth[at:at + self.width])))
        return Pictures(self.width, self.height, photograph, depth)

    def with_depth(self, factor):
        return Pictures(self.width, self.height, self.photograph, array.array("d", (z * factor for z in self.depth)))


def shade(point, normal, eye):
    """Blinn-Phong, linear RGB."""
    to_lamp = unit(sub(LAMP, point))
    facing = max(0.0, dot(normal, to_lamp))
    half = unit(add(to_lamp, unit(sub(eye, point))))
    gloss = SPECULAR * max(0.0, dot(normal, half)) ** EXPONENT if facing > 0 else 0.0
    return [a * (AMBIENT + facing) + gloss for a in ALBEDO]


def pictures_of(view):
    """Rays through the centres of the pixels. Depth along the axis is the ray's parameter: rays have z = 1 in camera space."""
    # In these coordinates the ellipsoid is the unit sphere.
    to_sphere = [scaled(row, 1 / a) for row, a in zip(transposed(WORLD_FROM_BODY), SEMI_AXES)]
    world_from_camera = transposed(view.rotation)
    eye = view.centre()
    ox, oy, oz = times(to_sphere, sub(eye, CENTRE))
    outside = ox * ox + oy * oy + oz * oz - 1
    right, down, forward = (times(to_sphere, column) for column in transposed(world_from_camera))
    empty = bytes(srgb(c) for c in BACKGROUND)
    photograph, depth = bytearray(), array.array("d", bytes(8 * view.width * view.height))
    for v in range(view.height):
        y = (v - view.cy) / view.fy
        rx, ry, rz = (f + y * d for f, d in zip(forward, down))
        for u in range(view.width):
            x = (u - view.cx) / view.fx
            dx, dy, dz = rx + x * right[0], ry + x * right[1], rz + x * right[2]
            b = ox * dx + oy * dy + oz * dz
            a = dx * dx + dy * dy + dz * dz
            inside = b * b - a * outside
            if inside <= 0:
                photograph += empty
                continue
            t = (-b - math.sqrt(inside)) / a
            depth[v * view.width + u] = t
            sphere = (ox + t * dx, oy + t * dy, oz + t * dz)
            normal = unit(times(WORLD_FROM_BODY, [q / s for q, s in zip(sphere, SEMI_AXES)]))
            point = add(eye, scaled(times(world_from_camera, [x, y, 1.0]), t))
            photograph += bytes(map(srgb, shade(point, normal, eye)))
    return Pictures(view.width, view.height, bytes(photograph), depth)


def take(scene):
    """Gives every view its pictures."""
    for view in scene.views:
        view.pictures = pictures_of(view)
