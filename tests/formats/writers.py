# SPDX-License-Identifier: BSD-3-Clause
"""What all writers share: cases, numbers as text, files and meshes."""
import dataclasses
import json
import pathlib

from exact_scene import MIDDLE


class NotExpressible(Exception):
    """The format has no word for what the scene has."""


@dataclasses.dataclass
class Frame:
    """A frame that a reader must find."""
    id: str
    view: object  # its camera, in the world of the case
    image: pathlib.Path
    depth: pathlib.Path = None


@dataclasses.dataclass
class Case:
    """A folder in one format, and what reading it must give."""
    name: str
    input: pathlib.Path  # what the command line names
    frames: list  # in the order in which they must be found
    scene: object  # in the world that is expected
    depth_scale: float = None  # metres (or units of that world) per stored unit
    arguments: list = dataclasses.field(default_factory=list)


def by_name(frames):
    """Frames in the order of their images' names, as text."""
    return sorted(frames, key=lambda frame: frame.image.as_posix().encode())


def number(value):
    """17 digits: enough for every double to come back the same."""
    return f"{value:.17g}"


def numbers(*values):
    return " ".join(map(number, values))


def write(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def write_json(path, value):
    """Python writes a double with as many digits as it needs to come back the same, at most 17."""
    return write(path, json.dumps(value, indent=1) + "\n")


def write_photograph(path, view):
    return write(path, view.pictures.photograph_png())


def need_middle(view, format_name):
    if (view.cx, view.cy) != MIDDLE or view.fx != view.fy:
        raise NotExpressible(f"{format_name} has one focal length and its principal point is the image's middle")


def ply_vertices(points, normals=None):
    names = ("x", "y", "z", "nx", "ny", "nz")[:6 if normals else 3]
    header = f"element vertex {len(points)}\n" + "".join(f"property double {name}\n" for name in names)
    rows = [[*p, *n] for p, n in zip(points, normals)] if normals else points
    return header, "".join(numbers(*row) + "\n" for row in rows)


def write_mesh(path, mesh, comment):
    header, rows = ply_vertices(mesh.vertices, mesh.normals)
    faces = "".join("3 {} {} {}\n".format(*face) for face in mesh.faces)
    return write(path, f"ply\nformat ascii 1.0\ncomment {comment}\n{header}element face {len(mesh.faces)}\n"
                       f"property list uchar int vertex_indices\nend_header\n{rows}{faces}")


def write_points(path, points):
    """A cloud: no faces, hence no surface."""
    header, rows = ply_vertices(points)
    return write(path, f"ply\nformat ascii 1.0\n{header}end_header\n{rows}")
