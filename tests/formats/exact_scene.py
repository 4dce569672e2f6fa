# SPDX-License-Identifier: BSD-3-Clause
"""One scene, known exactly: twelve cameras around an ellipsoid, its mesh, sparse points and a lamp. Everything else in this
folder is a consequence of this file.

Conventions here are Glint's own: lengths in metres; a camera looks along +z with x to the right and y down; (0, 0) is the centre
of the first pixel; a pose is camera from world. Vectors and matrices are lists: the tests need nothing but Python.
"""
import copy
import dataclasses
import math

WIDTH, HEIGHT = 320, 240
# The principal point is the exact middle, the only place that NVM and Bundler can express. In our pixels that is 159.5, 119.5.
MIDDLE = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
# Two focal lengths, one x and y alike (one camera each in COLMAP): a reader that mixes up its cameras is seen.
FOCALS = (410.25, 367.625)


# --- vectors and 3x3 matrices ---

def add(a, b):
    return [x + y for x, y in zip(a, b)]


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(a, factor):
    return [x * factor for x in a]


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return scaled(a, 1 / length(a))


def times(m, v):
    """Matrix times vector."""
    return [dot(row, v) for row in m]


def product(a, b):
    """Matrix times matrix."""
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def transposed(m):
    return [list(column) for column in zip(*m)]


def rotation_of(w, x, y, z):
    """The rotation of a quaternion of any length."""
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def quaternion_of(r):
    """(w, x, y, z) of a rotation, of length 1. Starts from the largest component: nothing is divided by a small number."""
    squares = [1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
               1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]]  # 4 w^2, 4 x^2, 4 y^2, 4 z^2
    largest = max(range(4), key=lambda i: squares[i])
    wx, wy, wz = r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]  # 4 w x, ...
    xy, xz, yz = r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]
    row = [[squares[0], wx, wy, wz], [wx, squares[1], xy, xz], [wy, xy, squares[2], yz], [wz, xz, yz, squares[3]]][largest]
    n = math.sqrt(dot(row, row))
    return [value / n for value in row]


# --- the parts of a scene ---

@dataclasses.dataclass
class View:
    name: str  # of the photograph, without folder and ending
    camera: int  # index in FOCALS
    fx: float
    fy: float
    cx: float
    cy: float
    rotation: list  # camera from world
    translation: list
    width: int = WIDTH
    height: int = HEIGHT
    pictures: object = None  # pictures.Pictures
    seen: list = dataclasses.field(default_factory=list)  # features: (index of a sparse point or None, (u, v))

    def centre(self):
        return scaled(times(transposed(self.rotation), self.translation), -1)

    def in_camera(self, point):
        return add(times(self.rotation, point), self.translation)

    def pixel(self, point):
        x, y, z = self.in_camera(point)
        return [self.fx * x / z + self.cx, self.fy * y / z + self.cy]

    def matrix(self):
        return [[*row, t] for row, t in zip(self.rotation, self.translation)] + [[0.0, 0.0, 0.0, 1.0]]


@dataclasses.dataclass
class Mesh:
    vertices: list
    normals: list  # of vertices, unit, outwards
    faces: list  # corners counter-clockwise from outside

    def moved(self, world):
        return Mesh([world.point(v) for v in self.vertices], [world.direction(n) for n in self.normals], self.faces)


@dataclasses.dataclass
class World:
    """A similarity, new from old: x -> scale (rotation x + shift). The scale comes last and scales the shift, too."""
    rotation: list
    shift: list
    scale: float = 1.0

    def direction(self, v):
        return times(self.rotation, v)

    def point(self, x):
        return scaled(add(self.direction(x), self.shift), self.scale)

    def view(self, view):
        """The same camera in the new world. What it sees moves away by the scale, so that pixels stay."""
        moved = copy.copy(view)
        moved.rotation = product(view.rotation, transposed(self.rotation))
        moved.translation = scaled(times(moved.rotation, self.point(view.centre())), -1)
        return moved


def enlarged(factor):
    return World([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], factor)


@dataclasses.dataclass
class Scene:
    views: list  # in an order of no meaning; names sort differently
    mesh: Mesh
    sparse: list  # points on the surface
    checks: list  # ten points whose pixels are compared
    mesh_comment: str = "ellipsoid in metres"

    def size(self):
        """What errors of lengths are relative to: the largest distance between two cameras."""
        centres = [view.centre() for view in self.views]
        return max(length(sub(a, b)) for a in centres for b in centres)

    def moved(self, world):
        return dataclasses.replace(self, views=[world.view(v) for v in self.views], mesh=self.mesh.moved(world),
                                   sparse=[world.point(p) for p in self.sparse], checks=[world.point(p) for p in self.checks])


# --- the description ---

# The ellipsoid: where it is, how it is turned, and how long its semi-axes are. No two are alike, none is along a world axis.
CENTRE = [0.13, -0.07, 0.29]
WORLD_FROM_BODY = rotation_of(0.83, -0.21, 0.44, 0.27)
SEMI_AXES = [0.21, 0.155, 0.115]
LAMP = [0.62, -0.93, 1.37]

# Name, camera, position, what the optical axis passes through (never the ellipsoid's centre), turn about the axis in degrees.
# As text, names sort otherwise than as numbers ("v10" before "v2") and otherwise than they stand here.
CAMERAS = [
    ("v7", 0, (0.912, -0.583, 0.701), (0.171, -0.112, 0.263), 13.7),
    ("v2", 1, (0.334, -1.021, 0.873), (0.083, -0.031, 0.347), -21.3),
    ("v10", 0, (-0.247, -0.688, 1.148), (0.194, -0.093, 0.241), 64.9),
    ("v31", 0, (0.587, -0.214, 1.296), (0.107, -0.146, 0.312), 171.2),
    ("v4", 1, (1.083, -0.061, 0.532), (0.052, -0.103, 0.334), -8.6),
    ("v23", 0, (0.049, -0.957, 0.416), (0.186, -0.017, 0.226), -97.4),
    ("v1", 0, (0.738, 0.327, 1.094), (0.141, -0.158, 0.357), 38.1),
    ("v12", 0, (-0.371, -0.302, 1.009), (0.096, -0.024, 0.218), 120.8),
    ("v9", 1, (0.466, -0.869, 1.231), (0.203, -0.139, 0.304), -142.5),
    ("v3", 0, (0.803, -0.747, 0.257), (0.074, -0.006, 0.271), 5.2),
    ("v18", 0, (0.218, 0.113, 1.372), (0.161, -0.121, 0.249), -58.3),
    ("v5", 0, (-0.093, -1.104, 0.767), (0.117, 0.009, 0.366), 86.6),
]

# Around the ellipsoid, in front of every camera.
CHECKS = [[0.131, -0.067, 0.293], [0.287, -0.041, 0.312], [-0.024, -0.118, 0.257], [0.153, 0.079, 0.334], [0.094, -0.213, 0.276],
          [0.171, -0.103, 0.448], [0.117, -0.012, 0.143], [0.249, -0.187, 0.203], [0.012, 0.061, 0.397], [0.208, 0.034, 0.187]]

# This view has no features: its line in images.txt is empty.
WITHOUT_FEATURES = "v9"
SPARSE_POINTS = 70  # some 50 are seen by two cameras or more
RINGS, SECTORS = 32, 32  # 2 * 32 + 30 * 2 * 32 = 1984 triangles


def looking(position, target, turn):
    """Camera from world: the axis passes through the target; at a turn of 0 the image's x is level with the world's z upwards."""
    z = unit(sub(target, position))
    level = unit(cross(z, [0.0, 0.0, 1.0]))
    down = cross(z, level)
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    x = add(scaled(level, c), scaled(down, s))
    return [x, cross(z, x), z]


def from_sphere(q):
    """The ellipsoid's point and its outward normal at a point of the unit sphere."""
    point = add(CENTRE, times(WORLD_FROM_BODY, [a * c for a, c in zip(SEMI_AXES, q)]))
    return point, unit(times(WORLD_FROM_BODY, [c / a for a, c in zip(SEMI_AXES, q)]))


def ellipsoid_mesh():
    sphere = [[0.0, 0.0, 1.0]]
    for i in range(1, RINGS):
        polar = math.pi * i / RINGS
        for j in range(SECTORS):
            around = 2 * math.pi * j / SECTORS
            sphere.append([math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around), math.cos(polar)])
    sphere.append([0.0, 0.0, -1.0])

    def at(ring, sector):
        return 1 + (ring - 1) * SECTORS + sector % SECTORS

    last = len(sphere) - 1
    faces = [(0, at(1, j), at(1, j + 1)) for j in range(SECTORS)]
    for i in range(1, RINGS - 1):
        for j in range(SECTORS):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    faces += [(last, at(RINGS - 1, j + 1), at(RINGS - 1, j)) for j in range(SECTORS)]
    points = [from_sphere(q) for q in sphere]
    return Mesh([p for p, _ in points], [n for _, n in points], faces)


def spread(count):
    """Points of the unit sphere, evenly and nowhere regular: heights in even steps, turned by the golden angle."""
    golden = math.pi * (3 - math.sqrt(5))
    for k in range(count):
        z = 1 - (2 * k + 1) / count
        r = math.sqrt(1 - z * z)
        yield [r * math.cos(golden * k), r * math.sin(golden * k), z]


def features(view, sparse, normals):
    """What the view sees of the sparse points, exactly, and between them features that became no point."""
    seen = []
    for k, (point, normal) in enumerate(zip(sparse, normals)):
        towards = unit(sub(view.centre(), point))
        u, v = view.pixel(point)
        if dot(normal, towards) > 0.2 and 0 <= u <= view.width - 1 and 0 <= v <= view.height - 1:  # not at the rim
            if len(seen) % 5 == 3:
                seen.append((None, [v, u / 2]))
            seen.append((k, [u, v]))
    return seen


def exact_scene():
    """The scene without pictures."""
    views = []
    for name, camera, position, target, turn in CAMERAS:
        rotation = looking(position, target, turn)
        views.append(View(name, camera, FOCALS[camera], FOCALS[camera], *MIDDLE, rotation, scaled(times(rotation, position), -1)))
    sampled = [from_sphere(q) for q in spread(SPARSE_POINTS)]
    sparse, normals = [p for p, _ in sampled], [n for _, n in sampled]
    for view in views:
        if view.name != WITHOUT_FEATURES:
            view.seen = features(view, sparse, normals)
    # A point needs two views: one that only one camera sees is a feature without a point.
    counts = [sum(k == i for view in views for k, _ in view.seen) for i in range(SPARSE_POINTS)]
    for view in views:
        view.seen = [(k if k is None or counts[k] > 1 else None, uv) for k, uv in view.seen]
    return Scene(views, ellipsoid_mesh(), sparse, CHECKS)


def tracks(scene):
    """index of a sparse point -> [(index of the view, index of the feature in it, (u, v))], of those that are seen."""
    found = {}
    for i, view in enumerate(scene.views):
        for j, (k, uv) in enumerate(view.seen):
            if k is not None:
                found.setdefault(k, []).append((i, j, uv))
    return found
