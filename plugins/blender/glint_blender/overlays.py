# SPDX-License-Identifier: BSD-3-Clause
"""Predicted contours as transparent pictures before the views of the cameras, pixel by pixel those of the photographs."""
import os
import tempfile

import bpy
import numpy

from . import images
from .failures import InputError

FOLDER = "overlays"
MARK = "written_by_glint_blender.txt"
LONGEST = 2048  # px of a side: larger photographs get a smaller overlay, which the view stretches
LINE = 1.2  # px of half a line in an overlay
# Colours that are told apart without red and green (Okabe and Ito), linear; in the order of the models.
COLOURS = [(0.90, 0.62, 0.0), (0.0, 0.62, 0.45), (0.34, 0.70, 0.91), (0.80, 0.47, 0.65), (0.94, 0.89, 0.26)]


def draw_line(alpha, a, b, half):
    """Raises alpha (height, width) along the segment from a to b (px, (0, 0) is the centre of the first pixel)."""
    height, width = alpha.shape
    reach = half + 1
    x0, x1 = int(max(min(a[0], b[0]) - reach, 0)), int(min(max(a[0], b[0]) + reach + 1, width))
    y0, y1 = int(max(min(a[1], b[1]) - reach, 0)), int(min(max(a[1], b[1]) + reach + 1, height))
    if x0 >= x1 or y0 >= y1:
        return
    y, x = numpy.mgrid[y0:y1, x0:x1]
    dx, dy = b[0] - a[0], b[1] - a[1]
    size = dx * dx + dy * dy
    t = numpy.clip(((x - a[0]) * dx + (y - a[1]) * dy) / size, 0, 1) if size > 0 else 0.0
    away = numpy.hypot(x - a[0] - t * dx, y - a[1] - t * dy)
    part = alpha[y0:y1, x0:x1]
    numpy.maximum(part, numpy.clip(half + 0.5 - away, 0, 1), out=part)


def drawn(view, contours):
    """RGBA (height, width, 4), rows from the top, straight alpha. contours: (ideal pixels, pairs of vertices that are gaps, colour)."""
    factor = min(1.0, LONGEST / max(view["width"], view["height"]))
    width, height = max(1, round(view["width"] * factor)), max(1, round(view["height"] * factor))
    picture = numpy.zeros((height, width, 4))
    for points, gaps, colour in contours:
        alpha = numpy.zeros((height, width))
        # An edge of the image stays an edge: pixel -0.5 is -0.5 at every size.
        points = [((x + 0.5) * width / view["width"] - 0.5, (y + 0.5) * height / view["height"] - 0.5) for x, y in points]
        for i, point in enumerate(points):
            j = (i + 1) % len(points)
            if (i, j) not in gaps and (j, i) not in gaps:
                draw_line(alpha, point, points[j], LINE)
        picture[:, :, :3] = numpy.where(alpha[:, :, None] > picture[:, :, 3:], colour, picture[:, :, :3])
        picture[:, :, 3] = numpy.maximum(picture[:, :, 3], alpha)
    return picture


def save(path, picture):
    """Writes a PNG, whole or not at all."""
    height, width, _ = picture.shape
    image = bpy.data.images.new("Glint overlay", width, height, alpha=True)
    try:
        image.pixels.foreach_set(picture[::-1].astype(numpy.float32).ravel())
        # In a folder that is new and this user's alone: no one has put a link in its place.
        with tempfile.TemporaryDirectory(prefix=".glint-", suffix=".tmp", dir=os.path.dirname(path)) as work:
            unfinished = os.path.join(work, os.path.basename(path))
            image.filepath_raw, image.file_format = unfinished, "PNG"
            image.save()
            os.replace(unfinished, path)
    except (RuntimeError, OSError) as e:
        raise InputError(path, "", f"cannot be written: {e}") from None
    finally:
        bpy.data.images.remove(image)


def prepared(folder):
    """The folder `overlays` of a run; one that somebody else made is refused."""
    path = os.path.join(folder, FOLDER)
    try:
        mark = os.path.join(path, MARK)
        ours = os.path.isfile(mark) and not os.path.islink(mark)
        if os.path.islink(path) or (os.path.isdir(path) and os.listdir(path) and not ours):
            raise InputError(path, "", "exists already and is not of an earlier run")
        os.makedirs(path, exist_ok=True)
        if ours:
            return path
        with open(mark, "x", encoding="ascii") as file:
            file.write("The Glint add-on for Blender wrote the pictures here and may replace them.\n")
    except OSError as e:
        raise InputError(path, "", e.strerror or str(e)) from None
    return path


def write(found, models, folder):
    """One PNG for each frame that has a prediction, named by its number (0000.png); paths by number."""
    by_frame = {}
    for number, model in enumerate(models):
        for row in found.predictions.get(model, []):
            for highlight in row["highlights"]:
                if highlight["contour"]:
                    entry = (highlight["contour"], highlight["gaps"], COLOURS[number % len(COLOURS)])
                    by_frame.setdefault(row["index"], []).append(entry)
    if not by_frame:
        return {}
    place, paths = prepared(folder), {}
    for index, contours in by_frame.items():
        paths[index] = os.path.join(place, f"{index:04d}.png")
        save(paths[index], drawn(found.frames[index]["camera"], contours))
    return paths


def attach(scene, paths):
    """Shows overlays before the views of the cameras of their frames; the numbers of frames that show none."""
    by_camera, without = {}, []
    for i, item in enumerate(scene.glint.frames):
        if i in paths and item.camera in scene.objects:
            by_camera.setdefault(item.camera, []).append((item.frame, i))
    for name, rows in by_camera.items():
        rows.sort()
        if len(rows) == 1:
            images.show(scene.objects[name], paths[rows[0][1]], "overlay")
        elif {(b[0] - a[0], b[1] - a[1]) for a, b in zip(rows, rows[1:])} == {(1, 1)}:
            images.show_sequence(scene.objects[name], paths[rows[0][1]], rows[0][1], rows[0][0], len(rows))
        else:
            without += [i for _, i in rows]  # Blender's image sequences go by single frames
    return without
