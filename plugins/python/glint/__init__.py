# SPDX-License-Identifier: BSD-3-Clause
"""Glint for Python: from specular highlights to lamps, virtual cameras, ellipsoids and predicted contours.

Conventions: metres where files say nothing else; cameras look along +z, y down; pixel (0, 0) is the centre of the top-left pixel;
contours and peaks are in ideal pixels (lens distortion removed); angles in radians unless a name ends in `_deg`. Arrays that come out are
read-only views of Glint's memory where it holds one, and keep it alive.

Failures: ValueError and TypeError are the caller's bug; CannotAnswer means that the data cannot answer, with a stable `reason`; InputError
means that a file, a setting or a disk is wrong, with `file`, `place` and `reason`; Stopped means that a progress function returned False.

Settings are keyword arguments with the names of `glint evaluate --set`, an underscore for the point: `predict_directions=36`, or
`**{"predict.directions": 36}`. `glint.settings()` lists them.
"""
from __future__ import annotations

import collections.abc as _abc
import json as _json
import os as _os
from typing import Any, NoReturn, Optional, Union

from numpy.typing import ArrayLike

from . import _glint
from ._glint import (
    BrightestPoint,
    Camera,
    CannotAnswer,
    CanonicalContour,
    ComparisonRow,
    ContourMetrics,
    Ellipse,
    Ellipsoid,
    Error,
    FitResult,
    Frame,
    FrameComparison,
    FrameEvidence,
    Highlight,
    Hits,
    InputError,
    Inspection,
    Lamp,
    Lamps,
    Light,
    LightEstimate,
    Mesh,
    Model,
    ModelFit,
    ModelResult,
    Plane,
    PredictedHighlight,
    Prediction,
    Predictor,
    Replay,
    Request,
    Retextured,
    Scene,
    Session,
    Setting,
    Stopped,
    Surface,
    Tradeoff,
    TradeoffPoint,
    TrainingView,
    __version__,
    compare_contours,
    iou,
    load_plugin,
    model,
    models,
    plugins,
    set_limit,
    settings,
)

__all__ = [
    "BrightestPoint", "Camera", "CannotAnswer", "CanonicalContour", "ComparisonRow", "ContourMetrics", "Ellipse", "Ellipsoid",
    "Error", "FitResult", "Frame", "FrameComparison", "FrameEvidence", "Highlight", "Hits", "InputError", "Inspection", "Lamp",
    "Lamps",
    "Light", "LightEstimate", "Mesh", "Model", "ModelFit", "ModelResult", "Plane", "PredictedHighlight", "Prediction",
    "Predictor",
    "Replay", "Request", "Retextured", "Scene", "Session", "Setting", "Stopped", "Surface", "Tradeoff", "TradeoffPoint",
    "TrainingView",
    "__version__", "compare_contours", "conventions", "depth_map", "detect", "estimate_light", "fit", "inspect", "iou", "lights",
    "lights_of_balls", "load_plugin", "mesh", "model", "models", "open", "plugins", "predict", "report", "retexture", "scene",
    "set_limit", "settings", "synth",
    "tradeoff", "write_labels",
]

Path = Union[str, "_os.PathLike[str]"]
Progress = _abc.Callable[[str, int, int], Optional[bool]]
Frames = Union[str, int, _abc.Iterable[int]]


def _raise(failure: tuple[str, str, str], **attributes: Any) -> NoReturn:
    message, reason, detail = failure
    error = CannotAnswer(message)
    error.reason, error.detail = reason, detail
    for name, value in attributes.items():
        setattr(error, name, value)
    raise error


def _spec(frames: Optional[Frames]) -> Optional[str]:
    """What the command line takes: a text as it is, numbers as "0,3,7"."""
    if frames is None or isinstance(frames, str):
        return frames
    try:
        numbers = [int(f) for f in ([frames] if isinstance(frames, int) else frames)]
    except (TypeError, ValueError):
        raise TypeError("frames: expected a text (\"first:6\", \"0-5,14\") or whole numbers") from None
    if not numbers:
        raise ValueError("frames: is empty")
    return ",".join(str(n) for n in numbers)


def _files(given: Union[None, Path, _abc.Iterable[Path]]) -> list[str]:
    if given is None:
        return []
    if isinstance(given, (str, _os.PathLike)):
        return [_os.fspath(given)]
    return [_os.fspath(f) for f in given]


def open(input: Path, *, allow_outside: bool = False, photographs: Union[None, Path, _abc.Iterable[Path]] = None,
         files: Optional[_abc.Mapping[str, Path]] = None, mesh: Optional[_abc.Mapping[str, Path]] = None,
         meshes: Union[None, Path, _abc.Iterable[Path]] = None, **reading: Any) -> Union[Scene, Session]:
    """Opens a scene file, a capture of another program, a folder with one, or a session.

    Parameters
    ----------
    input : path
    allow_outside : bool
        Accept paths outside the folders of the session and the scene file.
    photographs, meshes : path or paths
        Folders to search for photographs, and for meshes that are not in their place.
    files : dict
        Folders to search by kind: "depth", "normals", "masks".
    mesh : dict
        Files to use as the meshes that the scene calls by these names.
    **reading
        How a capture is read, with the command line's names: `as_="colmap"`, `surface="depth"`, `camera="fx,fy,cx,cy"`, `units="mm"`,
        `surface_units`, `depth_scale`, `object`, `poses`, `poses_by`, `world`, `response`.

    Returns
    -------
    Session for a file *.glint, else Scene. InputError where it cannot be read.
    """
    flags = {"--" + name.rstrip("_").replace("_", "-"): _text(value) for name, value in reading.items() if value is not None}
    places = _glint._Places(allow_outside, _files(photographs), [f"{kind}={_os.fspath(f)}" for kind, f in (files or {}).items()],
                            [f"{name}={_os.fspath(f)}" for name, f in (mesh or {}).items()], _files(meshes), flags)
    return _glint._open(_os.fspath(input), places)


def _text(value: Any) -> str:
    if isinstance(value, (str, _os.PathLike)):
        return str(_os.fspath(value))
    if isinstance(value, _abc.Iterable):
        return ",".join(repr(float(v)) for v in value)
    return str(value)


def mesh(vertices: ArrayLike, triangles: ArrayLike, normals: Optional[ArrayLike] = None, **settings: Any) -> Surface:
    """A triangle mesh as a Surface.

    Parameters
    ----------
    vertices : (n, 3) real numbers, world
    triangles : (m, 3) whole numbers
        Indices of vertices. Winding may differ; degenerate triangles are ignored but keep their index.
    normals : (n, 3) real numbers
        Normals of the vertices; None, or a zero: the mean of the triangles around.
    **settings
        `surface_normals="facet"`, "interpolated" or "curved"; `surface_rays`.
    """
    return Surface._mesh(vertices, triangles, normals, settings)


def depth_map(depth: ArrayLike, camera: Camera, **settings: Any) -> Surface:
    """The surface that a depth map shows.

    Parameters
    ----------
    depth : (height, width) real numbers
        Along the optical axis, metres; 0, negative or not finite: none. Single precision is kept.
    camera : Camera
        A picture of the same size; its lens distortion is removed.
    **settings
        `surface_depth_smoothing`, `surface_depth_normals`, `surface_depth_radius`, `surface_depth_fill` and those of `mesh`.

    Raises CannotAnswer: "no surface" where fewer than one cell of pixels has a depth.
    """
    return Surface._depth_map(depth, camera, settings)


def scene(frames: _abc.Sequence[Frame], surfaces: _abc.Mapping[str, Union[Path, _abc.Mapping[str, Any]]],
          name: str = "") -> Scene:
    """A scene from memory.

    Parameters
    ----------
    frames : list of Frame
        With unique ids; each names one of the surfaces, or has a depth file.
    surfaces : dict
        By key: the path of a mesh, or an analytic surface as scene.json writes it, `{"type": "sphere", "radius": 0.1}`.
    """
    files: dict[str, str] = {}
    analytic: dict[str, Any] = {}
    for key, surface in surfaces.items():
        if isinstance(surface, _abc.Mapping):
            keys = dict(surface)
            if "type" not in keys:
                raise ValueError(f"surfaces: '{key}' says no type")
            analytic[key] = _glint._AnalyticSpec(keys.pop("type"), keys)
        else:
            files[key] = _os.fspath(surface)
    return Scene._make(list(frames), files, analytic, name)


def detect(image: ArrayLike, mask: Optional[ArrayLike] = None, *, camera: Optional[Camera] = None, light: str = "light",
           **settings: Any) -> list[Highlight]:
    """Highlights of a linear image.

    Parameters
    ----------
    image : (height, width) or (height, width, 3) real numbers
        Linear radiance. Not finite or negative: not used.
    mask : (height, width)
        Not zero on the glossy object.
    camera : Camera
        Removes lens distortion; None: pixels stay as measured.
    light : str
        Id of the light that the highlights belong to.
    **settings
        `detect_level` (fraction of the peak), `detect_min_area` (px^2), `detect_clip` (value of saturation) ...

    Returns a list of Highlight, strongest first. Raises CannotAnswer: "no highlight", "not finite".
    """
    found = _glint._detect(image, mask, light, settings)
    return found if camera is None else [h.undistorted(camera) for h in found]


def estimate_light(views: _abc.Sequence[TrainingView], **settings: Any) -> LightEstimate:
    """The light of some training views of one light: triangulated, then from whole contours (`light_solver`).

    Raises CannotAnswer: "too few views", "light behind surface", "not converged" ...
    """
    return _glint._estimate_light(list(views), settings)


def fit(model: Union[str, Model], views: _abc.Sequence[TrainingView], light: Union[None, Light, LightEstimate] = None, *,
        progress: Optional[Progress] = None, **settings: Any) -> ModelFit:
    """Fits a model to training views of one light.

    Parameters
    ----------
    model : str or Model
    views : list of TrainingView
    light : Light, LightEstimate or None
        None: estimated from the views, where the model needs one.
    progress : function (stage, done, total)
        Returns False to stop.

    Raises CannotAnswer: "too few views", "rank deficient", "not an ellipsoid" ...
    """
    estimate = LightEstimate(light) if isinstance(light, Light) else light
    return _model(model)._fit(list(views), estimate, settings, progress)


def predict(fit: ModelFit, camera: Camera, surface: Optional[Surface] = None, **settings: Any) -> Prediction:
    """The highlights that a fit predicts for a camera.

    Parameters
    ----------
    fit : ModelFit
    camera : Camera
    surface : Surface
        None only for `primal`.

    Raises CannotAnswer: "no brightest point", "no surface" ...
    """
    return _model(fit.model)._predict(fit, camera, surface, settings)


def _model(which: Union[str, Model]) -> Model:
    return model(which) if isinstance(which, str) else which


def inspect(scene: Union[Scene, Session], models: Union[None, str, _abc.Sequence[str]] = None, *, train: Optional[Frames] = None,
            exclude: Optional[Frames] = None, level: Union[None, float, str] = None, source: Optional[str] = None,
            truth: Optional[Path] = None, noise_px: float = 0.0, seed: int = 1, good_enough_pct: Optional[float] = None,
            previous: Optional[Inspection] = None, progress: Optional[Progress] = None, **settings: Any) -> Inspection:
    """What `glint evaluate` computes: evidence, lights, fits, predictions and errors. What is None is the session's, else the default.

    Parameters
    ----------
    scene : Scene or Session
    models : list of ids, or "auto"
        None: all. "auto": the simplest model that is as good as the best, chosen by the training frames. []: evidence and views only.
    train : str or numbers
        Frames that train: "first:6", "spread:6", "0-5,14", "per-surface", or their numbers.
    exclude : str or numbers
        Frames that neither train nor count.
    level : float or "auto"
        Contour level, fraction of the peak above the background.
    source : "radiance" or "image"
        Which pixels, where a frame has both.
    truth : path
        Folder of true contours to score against.
    noise_px : float
        Gaussian noise on training contours and peaks, px; with `seed`.
    good_enough_pct : float
        With "auto": contour error in percent that is good enough.
    previous : Inspection
        An earlier result of the same scene: what did not change is taken from it.
    progress : function (stage, done, total)
        Called from the threads of the work; returns False to stop. What it raises comes out.

    Raises
    ------
    CannotAnswer
        No model answered; the exception's `inspection` holds what was computed.
    InputError
        A setting, a frame or a model that does not exist, or a value out of range, with the words of the command line.
    """
    where, request = (scene.scene, scene.request) if isinstance(scene, Session) else (scene, None)
    choose = models == "auto"
    wanted = None if models is None or choose else [models] if isinstance(models, str) else list(models)
    result = _glint._inspect(where, request, wanted, choose, good_enough_pct, _spec(train), _spec(exclude),
                             None if level is None else str(level), source, noise_px, seed,
                             "" if truth is None else _os.fspath(truth),
                             settings, previous, progress)
    if result._failure is not None and (choose or result.request.models):
        _raise(result._failure, inspection=result)
    return result


def retexture(source: Union[Session, Scene, Inspection], frame: Union[int, str], *, texture: Union[None, Path, ArrayLike] = None,
              background: Union[None, Path, ArrayLike] = None, remove: bool = False, model: str = "", light: str = "",
              mapping: str = "natural", shading: str = "auto", repeat: float = 1.0, albedo: Optional[float] = None,
              margin_px: float = 4.0,
              progress: Optional[Progress] = None, **settings: Any) -> Retextured:
    """Puts a frame's predicted highlight over another texture or background, or removes the observed one, as `glint retexture`.

    Parameters
    ----------
    source : Session, Scene or Inspection
        An inspection's evidence and fits are taken over where they serve.
    frame : number or id
    texture : path or (h, w, 3) array
        Becomes the surface's albedo. Arrays are linear light; files are sRGB, or linear where they say so.
    background : path or (h, w, 3) array
        The frame without its highlight, of the frame's size.
    remove : bool
        The frame without its highlight, filled from around it. One of texture, background and remove is given.
    model : str
        Id; empty: the one that the session shows, else its richest.
    light : str
        Id; empty: every light.
    mapping : "natural", "planar", "spherical" or "box"
        How the texture lies.
    shading : "auto", "lambert", "frame" or "none"
        Under the texture.
    repeat : float
        Textures in place of one, in both directions.
    albedo : float
        Albedo of the surface as it was, above 0, at most 1; None: the texture's mean takes its place.
    margin_px : float
        How far beyond its visible part a highlight is removed, px.

    Raises CannotAnswer where no highlight is predicted, or no photograph shows one to learn its colour from.
    """
    request, previous, shown = None, None, ""
    if isinstance(source, Session):
        where, request, shown = source.scene, source.request, source._shown_model
    elif isinstance(source, Inspection):
        where, request, previous = source._given, source.request, source
    else:
        where = source
    if albedo == 0:
        raise ValueError("albedo: must be above 0; None stands for the texture's mean")
    asked = {"model": model, "shown": shown, "light": light, "texture": texture, "background": background, "remove": remove,
             "mapping": mapping, "shading": shading, "repeat": repeat, "albedo": albedo or 0.0, "margin_px": margin_px}
    made: Retextured = _glint._retexture(where, request, previous, frame, asked, settings, progress)
    return made


def synth(spec: Path, folder: Path, *, progress: Optional[Progress] = None) -> Scene:
    """Makes a synthetic scene with exact contours, peaks and frames in a folder, as `glint synth`.

    Parameters
    ----------
    spec : path
        Specification (JSON): a scene without images, with path, surface_steps, contour, render.
    folder : path
        For scene.json and the images; created if missing.

    Returns the scene as written. Raises CannotAnswer, "no highlight", where no frame shows one; scene.json is there then, too.
    """
    made: Scene = _glint._synth(_os.fspath(spec), _os.fspath(folder), progress)
    if not any(frame.highlights for frame in made.frames):
        _raise(("no highlight: no frame shows a highlight", "no highlight", "no frame shows a highlight"))
    return made


def tradeoff(scene: Union[Scene, Session], models: Union[None, str, _abc.Sequence[str]] = None, *, train: Optional[Frames] = None,
             exclude: Optional[Frames] = None, level: Union[None, float, str] = None, source: Optional[str] = None,
             budget_us: Optional[float] = None, max_error_pct: Optional[float] = None, repeats: int = 5, max_trials: int = 240,
             progress: Optional[Progress] = None, **settings: Any) -> Tradeoff:
    """Measures speed against accuracy of models and settings on one input, as `glint tradeoff`. Let nothing else run meanwhile.

    Parameters
    ----------
    scene, models, train, exclude, level, source
        The parameters of `inspect`. Without models, compares those of the session, or all of them for a scene.
    budget_us : float
        Choose the most accurate setting within this many microseconds per frame.
    max_error_pct : float
        Choose the fastest setting with at most this contour error in percent.
    repeats : int
        How often each prediction is timed.
    max_trials : int
        Settings tried on a few frames.
    **settings
        From which knobs are turned.

    Raises CannotAnswer where nothing is chosen; the exception's `tradeoff` holds what was measured. What Stopped interrupts is not kept.
    """
    where, request = (scene.scene, scene.request) if isinstance(scene, Session) else (scene, None)
    wanted = None if models is None else [models] if isinstance(models, str) else list(models)
    result: Tradeoff = _glint._tradeoff(where, request, wanted, _spec(train), _spec(exclude),
                                        None if level is None else str(level), source,
                                        budget_us, max_error_pct, repeats, max_trials, settings, progress)
    if result._failure is not None:
        _raise(result._failure, tradeoff=result)
    return result


def write_labels(inspection: Inspection, folder: Path, formats: str = "coco,masks", *, frames: Optional[Frames] = None,
                 progress: Optional[Progress] = None) -> None:
    """Writes predicted highlights as labels for training, as `glint predict --labels`.

    Parameters
    ----------
    inspection : Inspection
    folder : path
        New; whole or not at all.
    formats : str
        "coco", "masks", "yolo", separated by commas: labels_MODEL.json, masks/, yolo/MODEL/.
    frames : str or numbers
        Which are labelled; None: all.
    """
    _glint._write_labels(inspection, _os.fspath(folder), formats, _spec(frames), progress)


def report(inspection: Inspection) -> str:
    """The text that `glint evaluate --json` writes of this inspection. Times differ from run to run."""
    return inspection.to_json()


def conventions(scene: Union[Scene, Session], *, progress: Optional[Progress] = None) -> dict[str, Any]:
    """What `glint info --json` says: what an input was understood to be, and tests of that on its own data."""
    where = scene.scene if isinstance(scene, Session) else scene
    found: dict[str, Any] = _json.loads(where._conventions(progress))
    return found


def lights(scene: Union[Scene, Session], *, exclude: Optional[Frames] = None, source: str = "radiance",
           progress: Optional[Progress] = None, **settings: Any) -> Lamps:
    """Where the lamps of a scene are, as `glint lights` finds them: from the highlights, never from the true lights that a scene may state.

    Raises CannotAnswer where no lamp has an answer; the exception's `lamps` holds the reasons.
    """
    if source not in ("radiance", "image"):
        raise ValueError(f"source: expected \"radiance\" or \"image\", not \"{source}\"")
    where = scene.scene if isinstance(scene, Session) else scene
    return _answered(_glint._lights(where, _spec(exclude), source, settings, progress))


def lights_of_balls(folder: Path, balls: Union[str, _abc.Sequence[str]], *, ball_radius: Optional[float] = None,
                    camera: Union[None, str, _abc.Sequence[float]] = None, exclude: Optional[Frames] = None,
                    outlines: str = "fitted",
                    outline_sigma: float = 1.0, response: str = "", progress: Optional[Progress] = None) -> Lamps:
    """Where the lamps of photographs of mirror balls are, one lamp in each photograph, the camera at the origin.

    Parameters
    ----------
    folder : path
        The folder of the photographs.
    balls : list of "[DIR:]CX,CY,R[@X0,Y0]"
        Outlines, px, as `glint lights --ball` takes them.
    ball_radius : float
        m; None: lengths are in ball radii.
    camera : (4,) or (9,) numbers
        fx, fy, cx, cy[, k1, k2, p1, p2, k3], px; None: what EXIF data say, else a distant one.
    outlines : "fitted", "edges" or "given"
    outline_sigma : float
        Standard deviation of a given outline's centre and radius, px.
    """
    return _answered(_glint._lights_of_balls(_os.fspath(folder), [balls] if isinstance(balls, str) else list(balls), ball_radius,
                                             "" if camera is None else _text(camera), _spec(exclude) or "", outlines,
                                             outline_sigma,
                                             response, progress))


def _answered(lamps: Lamps) -> Lamps:
    if lamps._failure is not None:
        _raise(lamps._failure, lamps=lamps)
    return lamps
