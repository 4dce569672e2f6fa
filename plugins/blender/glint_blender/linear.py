# SPDX-License-Identifier: BSD-3-Clause
"""Small matrices in double precision, as lists of rows. Blender's own (mathutils) are single precision."""
import math


def identity(n=4):
    return [[1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]


def rows(matrix):
    """A matrix of mathutils, or any nested sequence, as lists of floats."""
    return [[float(v) for v in row] for row in matrix]


def product(a, b):
    """The matrix a b; b may also be a vector."""
    if not isinstance(b[0], (list, tuple)):
        return [sum(x * y for x, y in zip(row, b)) for row in a]
    columns = list(zip(*b))
    return [[sum(x * y for x, y in zip(row, column)) for column in columns] for row in a]


def transposed(a):
    return [list(column) for column in zip(*a)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def difference(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(a, s):
    return [x * s for x in a]


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    size = length(a)
    return [x / size for x in a]


def determinant3(m):
    return dot(m[0], cross(m[1], m[2]))


def inverse3(m):
    """Raises ZeroDivisionError where the matrix is singular."""
    d = determinant3(m)
    return transposed([scaled(cross(m[1], m[2]), 1 / d), scaled(cross(m[2], m[0]), 1 / d), scaled(cross(m[0], m[1]), 1 / d)])


def block3(m):
    """The upper left 3x3 block."""
    return [list(row[:3]) for row in m[:3]]


def column(m, j, count=3):
    return [m[i][j] for i in range(count)]


def with_translation(r, t):
    """The 4x4 matrix [r t; 0 1]."""
    return [list(r[i]) + [t[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def inverse_rigid(m):
    r = transposed(block3(m))
    return with_translation(r, scaled(product(r, column(m, 3)), -1))


def transformed(m, point):
    """The point m (x, 1) of a 4x4 matrix whose last row is 0 0 0 1."""
    return [dot(row[:3], point) + row[3] for row in m[:3]]


def nearest_rotation(m):
    """The orthogonal matrix nearest to a 3x3 matrix (Newton's iteration for the polar decomposition; Higham 1986)."""
    for _ in range(50):
        other = transposed(inverse3(m))
        next_one = [[(x + y) / 2 for x, y in zip(p, q)] for p, q in zip(m, other)]
        moved = max(abs(x - y) for p, q in zip(m, next_one) for x, y in zip(p, q))
        m = next_one
        if moved < 1e-15:  # a few units in the last place of 1
            break
    return m


def frame_around(normal):
    """Two unit vectors u, v with u x v = normal (a unit vector)."""
    helper = [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0]
    u = unit(cross(helper, normal))
    return u, cross(normal, u)


def reflection(point, normal):
    """The 4x4 matrix that mirrors the world in the plane through `point` with the unit normal `normal`: Eq. (mirror) of NOTATION.md."""
    r = [[(1.0 if i == j else 0.0) - 2 * normal[i] * normal[j] for j in range(3)] for i in range(3)]
    return with_translation(r, scaled(normal, 2 * dot(normal, point)))


def ellipse_of_conic(c):
    """Centre, semi-axes (larger first) and the angle of the first one, rad, of { x : x^T c x = 0 }; None where it is no ellipse."""
    a, b, d = c[0][0], c[0][1], c[1][1]
    minor = a * d - b * b
    if not minor > 0:
        return None
    x = (b * c[1][2] - d * c[0][2]) / minor
    y = (b * c[0][2] - a * c[1][2]) / minor
    level = -(c[0][2] * x + c[1][2] * y + c[2][2])
    mean, half = (a + d) / 2, math.hypot((a - d) / 2, b)
    if mean < 0:
        mean, level, a, b, d = -mean, -level, -a, -b, -d
    if not level > 0 or not mean - half > 0:
        return None
    # The longer axis belongs to the smaller eigenvalue.
    angle = 0.5 * math.atan2(2 * b, a - d) + math.pi / 2
    return [x, y], [math.sqrt(level / (mean - half)), math.sqrt(level / (mean + half))], angle
