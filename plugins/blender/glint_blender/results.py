# SPDX-License-Identifier: BSD-3-Clause
"""What `glint evaluate` and `glint predict` wrote, checked, as plain numbers. No bpy here."""
import math
import os

from . import linear, scene_file, views
from .failures import InputError

MOST_POINTS = 1_000_000  # of one contour


class Results:
    """frames: id, pose, camera, surface of each frame of the scene. fits: by model. predictions: by model, rows with highlights.
    evaluation: the document, or None."""

    def __init__(self):
        self.frames, self.fits, self.predictions, self.evaluation, self.surfaces, self.middle = [], {}, {}, None, {}, [0.0, 0.0, 0.0]
        self.train = []

    def models(self):
        return [m for m in dict.fromkeys(list(self.fits) + list(self.predictions))]

    def answered(self):
        return [m for m in self.models() if any(f.get("status") in ("ok", "poor") for f in self.fits.get(m, []))]


def objects(value, file, place):
    if not isinstance(value, list) or not all(isinstance(v, dict) for v in value):
        raise InputError(file, place, "must be a list of objects")
    return value


def frames_of(document, file):
    """Id, pose, camera, surface and its place of every frame of a scene document."""
    frames = []
    for i, frame in enumerate(objects(document.get("frames"), file, "frames")):
        place = f"frames[{i}]"
        if not isinstance(frame.get("id"), str) or not frame["id"]:
            raise InputError(file, f"{place}.id", "must be a text")
        own = frame.get("camera") if frame.get("camera") is not None else document.get("camera")
        frames.append({"id": frame["id"],
                       "pose": scene_file.pose(frame.get("camera_from_world"), file, f"{place}.camera_from_world"),
                       "camera": scene_file.camera(own, file, f"{place}.camera"), "surface": frame.get("surface"),
                       "place": scene_file.pose(frame["world_from_object"], file, f"{place}.world_from_object")
                       if frame.get("world_from_object") is not None else linear.identity(),
                       "image": frame.get("image"),
                       "radiance": frame.get("radiance")})
    if not frames:
        raise InputError(file, "frames", "is empty")
    return frames


def checked_fit(fit, file, place):
    """A fit with its numbers checked; keys that are missing become None."""
    result = {"light": str(fit.get("light", "")), "surface": fit.get("surface"), "status": str(fit.get("status", "ok")),
              "reason": str(fit.get("reason", "")), "ellipsoid": None, "q_dual": None, "light_position": None}
    e = fit.get("ellipsoid")
    if isinstance(e, dict):
        result["ellipsoid"] = {"centre": scene_file.vector(e.get("centre"), 3, file, f"{place}.ellipsoid.centre"),
                               "semi_axes": scene_file.vector(e.get("semi_axes"), 3, file, f"{place}.ellipsoid.semi_axes"),
                               "world_from_ellipsoid": scene_file.pose(e.get("world_from_ellipsoid"), file,
                                                                      f"{place}.ellipsoid.world_from_ellipsoid")}
    if fit.get("q_dual"):
        result["q_dual"] = scene_file.matrix(fit["q_dual"], file, f"{place}.q_dual")
    if fit.get("light_position") is not None:
        result["light_position"] = scene_file.vector(fit["light_position"], 4, file, f"{place}.light_position")
    for key in ("limit_angle_deg", "roughness", "light_radius"):
        result[key] = scene_file.number(fit[key], file, f"{place}.{key}") if fit.get(key) is not None else None
    segment = fit.get("light_segment")
    result["light_segment"] = [scene_file.vector(p, 3, file, f"{place}.light_segment") for p in segment] if segment else None
    result["frame"] = "camera" if fit.get("frame") == "camera" else "world"  # whose coordinates the fit has
    result["lobe"] = fit.get("lobe") if isinstance(fit.get("lobe"), str) else None
    return result


def checked_highlight(highlight, file, place):
    contour = highlight.get("contour")
    if not isinstance(contour, list) or len(contour) > MOST_POINTS:
        raise InputError(file, f"{place}.contour", "must be a list of points")
    result = {"contour": [scene_file.vector(p, 2, file, f"{place}.contour") for p in contour], "gaps": set()}
    for key, count in (("peak", 2), ("brightest_point", 3), ("normal", 3)):
        result[key] = scene_file.vector(highlight[key], count, file, f"{place}.{key}") if highlight.get(key) is not None else None
    for gap in highlight.get("gaps") or []:
        a, b = (int(v) for v in scene_file.vector(gap, 2, file, f"{place}.gaps"))
        result["gaps"].add((a, b))
    return result


def read(scene_path, evaluation_path=None, predictions_path=None):
    """Results of these files; the scene gives the cameras that pixels belong to. Raises InputError with file and place."""
    document = scene_file.read_json(scene_path, "glint_scene")
    results = Results()
    results.frames = frames_of(document, scene_path)
    results.surfaces = document.get("surfaces") if isinstance(document.get("surfaces"), dict) else {}
    count = len(results.frames)
    if evaluation_path:
        results.evaluation = scene_file.read_json(evaluation_path, "glint_evaluation")
        results.train = [int(i) for i in results.evaluation.get("train", []) if isinstance(i, int)]
        models = results.evaluation.get("models")
        for name, model in (models.items() if isinstance(models, dict) else []):
            place = f"models.{name}.fits"
            rows = objects(model.get("fits", []) if isinstance(model, dict) else None, evaluation_path, place)
            results.fits[name] = [checked_fit(f, evaluation_path, f"{place}[{i}]") for i, f in enumerate(rows)]
            for i, row in enumerate(objects(model.get("frames", []), evaluation_path, f"models.{name}.frames")):
                check_index(row, results.frames, evaluation_path, f"models.{name}.frames[{i}]")
    if predictions_path:
        predicted = scene_file.read_json(predictions_path, "glint_predictions")
        models = predicted.get("models")
        for name, rows in (models.items() if isinstance(models, dict) else []):
            results.predictions[name] = []
            for i, row in enumerate(objects(rows, predictions_path, f"models.{name}")):
                place = f"models.{name}[{i}]"
                index = check_index(row, results.frames, predictions_path, place)
                found = [checked_highlight(h, predictions_path, f"{place}.highlights[{j}]")
                         for j, h in enumerate(objects(row.get("highlights", []), predictions_path, f"{place}.highlights"))]
                to_world(found, results.frames[index])
                results.predictions[name].append({"index": index, "light": str(row.get("light", "")), "status": row.get("status"),
                                                  "reason": str(row.get("reason", "")), "highlights": found})
    points = [h["brightest_point"] for rows in results.predictions.values() for r in rows for h in r["highlights"]
              if h["brightest_point"]]
    if points:
        results.middle = [sum(p[i] for p in points) / len(points) for i in range(3)]
    assert count == len(results.frames)
    return results


def to_world(highlights, frame):
    """Moves those into the world that are in the coordinates of the camera, as under a lamp that it carries. Their file does not say so, but there their
    points are seen at their peaks."""
    back = linear.inverse_rigid(frame["pose"])
    for h in highlights:
        if h["peak"] and h["brightest_point"] and h["normal"]:
            off = [math.dist(pixel, h["peak"]) if pixel else math.inf for pixel in
                   (views.project(frame["camera"], pose, h["brightest_point"]) for pose in (frame["pose"], linear.identity()))]
            if off[1] < off[0]:
                h["brightest_point"] = linear.transformed(back, h["brightest_point"])
                h["normal"] = linear.product(linear.block3(back), h["normal"])


def check_index(row, frames, file, place):
    """The number of the frame of a row, whose id must be that of the scene: results of another scene are refused."""
    index = row.get("index")
    if not isinstance(index, int) or not 0 <= index < len(frames) or row.get("id") != frames[index]["id"]:
        raise InputError(file, place, f"is about frame {row.get('id')!r}, which the scene does not have at that place; it is of another scene")
    return index


def fit_for(results, model, light, surface):
    """The fit that predicts a light on a surface; None without one."""
    rows = [f for f in results.fits.get(model, []) if f["light"] == light and f["status"] in ("ok", "poor")]
    own = [f for f in rows if f["surface"] == surface and surface is not None]
    return (own or [f for f in rows if f["surface"] is None] or [None])[0]


def errors_of(results, model):
    """By number of frame: role, px and pct (mean over the highlights of the frame, None where nothing was measured), reason."""
    table = {}
    document = (results.evaluation or {}).get("models", {}).get(model, {})
    for row in document.get("frames", []):
        table.setdefault(row["index"], []).append(row)
    answer = {}
    for index, rows in table.items():
        px = [r["contour_error_px"] for r in rows if isinstance(r.get("contour_error_px"), (int, float))]
        pct = [r["contour_error_pct"] for r in rows if isinstance(r.get("contour_error_pct"), (int, float))]
        reasons = [f"{r.get('status')}: {r['reason']}" if r.get("reason") else str(r.get("status")) for r in rows
                   if r.get("status") != "ok"]
        answer[index] = {"role": "held out", "px": sum(px) / len(px) if px else None, "pct": sum(pct) / len(pct) if pct else None,
                         "reason": "; ".join(reasons)}
    for fit in document.get("fits", []):
        for index, residual in zip(fit.get("training_frames", []), fit.get("residual_px", [])):
            if index not in answer:
                answer[index] = {"role": "training", "px": residual if isinstance(residual, (int, float)) else None, "pct": None,
                                 "reason": ""}
    return answer


def files_in(folder):
    """(evaluation, predictions) that a run leaves in its folder; "" where one is missing."""
    evaluation = os.path.join(folder, "evaluation.json")
    options = [os.path.join(folder, "predictions", "predictions.json"), os.path.join(folder, "predictions.json")]
    predictions = next((p for p in options if os.path.isfile(p)), "")
    return evaluation if os.path.isfile(evaluation) else "", predictions
