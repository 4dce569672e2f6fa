# SPDX-License-Identifier: BSD-3-Clause
"""A run by the Python module `glint` in Blender's own process, for those who have it: the program is not needed then. An option of the
preferences; the files and numbers are those of the command line, times aside. No bpy here."""
import importlib
import json
import os
import tempfile
import threading

from .failures import InputError


def module():
    """The module; InputError where Python does not find it, or finds something else by that name."""
    try:
        found = importlib.import_module("glint")
    except ImportError as e:
        raise InputError("module glint", "",
                         f"cannot be imported: {e}; switch off Use the Python Module in the add-on's preferences") from None
    if not all(hasattr(found, name) for name in ("open", "inspect", "CannotAnswer", "InputError", "Stopped")):
        raise InputError("module glint", "", "is another module of this name")
    return found


def predictions_of(inspection, models):
    """The document of `glint predict --json`, as far as the add-on reads it."""
    ids = [frame.id for frame in inspection.scene.frames]
    document = {"glint_predictions": 1, "models": {}}
    for name in models:
        rows = document["models"][name] = []
        for found in inspection.models[name].frames:
            prediction = found.prediction
            highlights = [{"peak": h.brightest_point.pixel.tolist(), "brightest_point": h.brightest_point.position.tolist(),
                           "normal": h.brightest_point.normal.tolist(), "coverage": h.coverage, "contour": h.contour.tolist(),
                           "gaps": [list(gap) for gap in h.gaps]} for h in prediction.highlights]
            rows.append({"index": found.frame, "id": ids[found.frame], "light": found.light,
                         "status": "failed" if prediction.failure else "ok",
                         "reason": prediction.failure or "", "highlights": highlights})
    return document


def write(path, text):
    """A file, whole or not at all."""
    # In a folder that is new and this user's alone: no one has put a link in its place.
    with tempfile.TemporaryDirectory(prefix=".glint-", suffix=".tmp", dir=os.path.dirname(path)) as work:
        unfinished = os.path.join(work, os.path.basename(path))
        with open(unfinished, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(unfinished, path)


class InProcess:
    """What program.Sequence is for commands: done, progress, cancel, finish, failed, cancelled, warnings.

    options: the keyword arguments of glint.inspect (models, train, source, level, settings)."""

    def __init__(self, scene_path, folder, options):
        self.glint = module()
        self.failed, self.cancelled, self.warnings = "", False, []
        self.stage, self.part = "reading", None
        self.thread = threading.Thread(target=self._guarded, args=(scene_path, folder, options), daemon=True)
        self.thread.start()

    def _guarded(self, scene_path, folder, options):
        try:
            self._run(scene_path, folder, options)
        except self.glint.Stopped:
            self.cancelled = True
        except Exception as e:  # CannotAnswer, InputError, and what nobody foresaw: the user reads it, and Blender goes on
            self.failed = f"{e}" or type(e).__name__

    def _run(self, scene_path, folder, options):
        models = options["models"]
        inspection = self.glint.inspect(self.glint.open(scene_path), progress=self._progress, **options)
        self.warnings = [f"warning: {line}" for line in inspection.warnings]
        if self.cancelled:
            return
        predictions = os.path.join(folder, "predictions")
        os.makedirs(predictions, exist_ok=True)
        inspection.save_session(os.path.join(folder, "run.glint"))
        write(os.path.join(predictions, "predictions.json"), json.dumps(predictions_of(inspection, models), allow_nan=False))
        write(os.path.join(folder, "evaluation.json"), inspection.to_json())

    def _progress(self, stage, done, total):
        self.stage, self.part = stage, done / total if total > 0 else None
        return not self.cancelled

    def done(self):
        return not self.thread.is_alive()

    def progress(self):
        return ("done", 1.0) if self.done() else (self.stage, self.part or 0.0)

    def cancel(self):
        self.cancelled = True

    def finish(self):
        self.thread.join()
