# SPDX-License-Identifier: BSD-3-Clause
"""Reading and writing the JSON files of Glint. Files may come from others: types, sizes and numbers are checked, and paths stay inside."""
import json
import math
import os
import tempfile

from .failures import InputError

# In the folder of the meshes of an export: this add-on wrote the files there and may replace them.
MARK = "written_by_glint_blender.txt"
MOST_BYTES = 512_000_000  # as `glint` itself (docs/formats.md, "Limits")


def read_json(path, key):
    """The object of a JSON file that has the version key `key`."""
    try:
        size = os.path.getsize(path)
        if size > MOST_BYTES:
            raise InputError(path, "", f"{size} bytes, more than {MOST_BYTES}")
        with open(path, encoding="utf-8-sig") as file:
            document = json.load(file, parse_constant=lambda text: None)
    except OSError as e:
        raise InputError(path, "", e.strerror or str(e)) from None
    except (ValueError, RecursionError) as e:
        raise InputError(path, "", f"is not JSON: {e}") from None
    if not isinstance(document, dict) or key not in document:
        raise InputError(path, "", f"has no key {key}")
    return document


def number(value, file, place):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or abs(value) > 1e15:
        raise InputError(file, place, "must be a number")
    return float(value)


def vector(value, count, file, place):
    if not isinstance(value, list) or len(value) != count:
        raise InputError(file, place, f"must be a list of {count} numbers")
    return [number(v, file, place) for v in value]


def matrix(value, file, place, size=4):
    if not isinstance(value, list) or len(value) != size:
        raise InputError(file, place, f"must be {size} rows of {size} numbers")
    return [vector(row, size, file, place) for row in value]


def pose(value, file, place):
    """A rigid 4x4: what is not, is refused."""
    m = matrix(value, file, place)
    for i in range(3):
        for j in range(3):
            if abs(sum(m[k][i] * m[k][j] for k in range(3)) - (i == j)) > 1e-3:  # four typed digits
                raise InputError(file, place, "is not a rotation with a shift")
    if [abs(v) for v in m[3]] != [0, 0, 0, 1] or m[3][3] != 1:
        raise InputError(file, place, "must end with the row 0 0 0 1")
    return m


def camera(value, file, place):
    """A Glint camera: width, height, fx, fy, cx, cy, and skew, model, distortion, response where stated."""
    if not isinstance(value, dict):
        raise InputError(file, place, "must be an object")
    result = {}
    for key in ("width", "height"):
        n = number(value.get(key), file, f"{place}.{key}")
        if n != int(n) or not 1 <= n <= 65536:
            raise InputError(file, f"{place}.{key}", "must be a whole number from 1 to 65536")
        result[key] = int(n)
    for key in ("fx", "fy", "cx", "cy"):
        result[key] = number(value.get(key), file, f"{place}.{key}")
        if key in ("fx", "fy") and not 0 < result[key] < 1e9:
            raise InputError(file, f"{place}.{key}", "must be above 0")
    if value.get("skew"):
        result["skew"] = number(value["skew"], file, f"{place}.skew")
    for key in ("model", "response"):
        if isinstance(value.get(key), str):
            result[key] = value[key]
    if value.get("distortion"):
        result["distortion"] = vector(value["distortion"], len(value["distortion"]), file, f"{place}.distortion")
    return result


def bends(view):
    """Whether the lens of a camera is more than a pinhole."""
    return any(view.get("distortion", [])) or "FISHEYE" in view.get("model", "") or view.get("model", "") == "FOV"


def inside(folder, relative, file, place):
    """The absolute path of a file that a scene names; it must not leave the folder of the scene, by .. or by a link."""
    if not isinstance(relative, str) or not relative or "\0" in relative:
        raise InputError(file, place, "must be a path")
    root = os.path.realpath(folder)
    path = os.path.realpath(os.path.join(root, relative))
    if os.path.isabs(relative) or os.path.commonpath([root, path]) != root:
        raise InputError(file, place, f"{relative} is outside of the folder of the scene")
    return path


class Folder:
    """Files of one answer, written beside their places first and moved there together; the scene file last.

    with Folder(target) as folder: folder.path("meshes/a.ply") gives a name to write to. Where an exception leaves the block, nothing stays."""

    def __init__(self, target):
        self.target = os.path.abspath(target)
        self.home = os.path.dirname(self.target)
        self.stem = os.path.splitext(os.path.basename(self.target))[0]
        self.mark = os.path.join(self.home, f"{self.stem}_meshes", MARK)
        self.names = []

    def __enter__(self):
        if not os.path.isdir(self.home):
            raise InputError(self.home, "", "there is no such folder")
        if os.path.exists(self.target) and os.path.getsize(self.target):
            read_json(self.target, "glint_scene")  # refuses to replace any other file
        self.known = os.path.isfile(self.mark)
        try:
            self.work = tempfile.TemporaryDirectory(prefix=".glint-", suffix=".tmp", dir=self.home)
        except OSError as e:
            raise InputError(self.home, "", e.strerror or str(e)) from None
        return self

    def path(self, name):
        """Where to write the file that will be called `name` (relative, with /)."""
        place = os.path.join(self.work.name, *name.split("/"))
        os.makedirs(os.path.dirname(place), exist_ok=True)
        self.names.append(name)
        return place

    def finish(self, document):
        """Moves all files to their places, then writes the scene."""
        text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)
        for name in self.names:
            final = os.path.join(self.home, *name.split("/"))
            if os.path.exists(final) and not self.known:
                raise InputError(final, "", "exists already and is not of an earlier export; choose another name or folder")
        for name in self.names:
            final = os.path.join(self.home, *name.split("/"))
            os.makedirs(os.path.dirname(final), exist_ok=True)
            os.replace(os.path.join(self.work.name, *name.split("/")), final)
        if os.path.isdir(os.path.dirname(self.mark)):
            with open(self.mark, "w", encoding="ascii") as file:
                file.write("The Glint add-on for Blender wrote the files of this export and may replace them.\n")
        place = os.path.join(self.work.name, "scene.json.tmp")
        with open(place, "w", encoding="utf-8") as file:
            file.write(text + "\n")
        os.replace(place, self.target)

    def __exit__(self, kind, value, trace):
        self.work.cleanup()
        if isinstance(value, OSError):
            raise InputError(value.filename or self.home, "", value.strerror or str(value)) from value
        return False
