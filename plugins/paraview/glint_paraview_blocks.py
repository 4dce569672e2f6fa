# SPDX-License-Identifier: BSD-3-Clause
"""What Glint's plugin for ParaView shows, as VTK data: the blocks of reader and filter. glint_paraview.py loads it from its own folder.

Numbers are those of the Python module glint; docs/paraview.md describes blocks, arrays and units.
"""
import collections
import math

import numpy as np
from glint_paraview_vtk import UNITS, Parts, array, fill, note, vtk_points
from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkStructuredGrid

try:
    import glint
except ImportError:
    glint = None  # the plugin says so

OFF_PLANE = 1e-3  # curves in the image lie this fraction of the depth before the photograph, so that they are not hidden in it
OUTLINE_STEPS = 8  # segments of a side of a frustum: a distorted lens bends it
ELLIPSE_STEPS = 72  # points of a drawn ellipse, one every 5 degrees
SPHERE_STEPS = 48  # meridians of a drawn ellipsoid
METRICS = ("contour_error_pct", "contour_error_px", "hausdorff_px", "iou", "centre_offset_px", "axis_ratio_error",
           "angle_error_deg",
           "peak_offset_px")


# ---- geometry ----------------------------------------------------------------------------------------------------------------------------

def _runs(kept, closed=True):
    """Index lists of the polylines that are left of a closed curve where kept[i] says whether the segment from i to i + 1 is drawn."""
    n = len(kept)
    if n < 2:
        return []
    kept = np.array(kept, dtype=bool)
    if not closed:
        kept[-1] = False
    if kept.all():
        return [np.append(np.arange(n), 0)]
    runs, start = [], int(np.flatnonzero(~kept)[0]) + 1
    run = []
    for step in range(n):
        i = (start + step) % n
        if kept[i]:
            run = run or [i]
            run.append((i + 1) % n)
        elif run:
            runs.append(np.array(run))
            run = []
    return runs


def _kept(n, gaps, valid):
    """Segments of a contour of n vertices without those that bridge a gap or end at an invalid vertex."""
    kept = np.array(valid, dtype=bool) & np.roll(valid, -1)
    for start, end in gaps:
        i = start
        while i != end:  # a gap's segments lie from its first vertex to its last
            kept[i] = False
            i = (i + 1) % n
    return kept


def _at_depth(camera, pixels, depth):
    """(n, 3) world points of ideal pixels at a depth along the optical axis."""
    axis = camera.camera_from_world[2, :3]
    directions = camera.directions(pixels)
    return camera.centre + directions * (depth / (directions @ axis))[:, None]


def _ideal(camera, measured):
    """Ideal pixels of measured ones; where the lens shows none, the measured ones themselves."""
    ideal = np.array(camera.undistort(measured))
    lost = ~np.isfinite(ideal).all(axis=1)
    ideal[lost] = np.asarray(measured)[lost]
    return ideal


def _border(camera):
    """(4 OUTLINE_STEPS, 2) ideal pixels around the image, from its top-left corner."""
    w, h = camera.width - 0.5, camera.height - 0.5
    corners = np.array([[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]])
    t = np.arange(OUTLINE_STEPS)[:, None] / OUTLINE_STEPS
    return _ideal(camera, np.concatenate([a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]))


def _frustum(camera, depth):
    """Points (the centre first) and lines of a camera."""
    around = _at_depth(camera, _border(camera), depth)
    n = len(around)
    return np.concatenate([camera.centre[None], around]), [np.append(np.arange(1, n + 1),
                                                                     1)] + [np.array([0, 1 + i * OUTLINE_STEPS]) for i in range(4)]


def _mirrored(plane, points):
    m = plane.reflection
    return points @ m[:3, :3].T + m[:3, 3]


def _on_plane(camera, plane, pixels):
    """World points where the rays of pixels meet a plane; those that do not meet it before the camera are left out."""
    directions = camera.directions(pixels)
    along = directions @ plane.normal
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -(camera.centre @ plane.normal + plane.offset) / along
    good = np.isfinite(t) & (t > 0)
    return camera.centre + directions[good] * t[good, None]


def _square(plane, middle, half, across):
    """Four corners on a plane around a point of it."""
    x = across - plane.normal * (across @ plane.normal)
    if np.linalg.norm(x) < 1e-6:  # the camera's right is along the normal: any other direction serves
        x = np.cross(plane.normal, np.eye(3)[np.argmin(np.abs(plane.normal))])
    x = x / np.linalg.norm(x)
    y = np.cross(plane.normal, x)
    return np.array([middle + half * (a * x + b * y) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def _ball(world_from_ball):
    """Points, quads and normals of the unit sphere where a 4 x 4 matrix carries it."""
    v, u = np.meshgrid(np.linspace(0, np.pi, SPHERE_STEPS // 2 + 1), np.arange(SPHERE_STEPS) * 2 * np.pi / SPHERE_STEPS,
                       indexing="ij")
    unit = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1).reshape(-1, 3)
    a, b, c = world_from_ball[:3, :3].T
    normals = unit @ np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])  # cofactors: they exist for a disk, too
    i = (np.arange(SPHERE_STEPS // 2)[:, None] * SPHERE_STEPS + np.arange(SPHERE_STEPS)).reshape(-1, 1)
    j = (np.arange(SPHERE_STEPS // 2)[:, None] * SPHERE_STEPS + (np.arange(SPHERE_STEPS) + 1) % SPHERE_STEPS).reshape(-1, 1)
    quads = np.concatenate([i, i + SPHERE_STEPS, j + SPHERE_STEPS, j], axis=1)
    points = unit @ world_from_ball[:3, :3].T + world_from_ball[:3, 3]
    return points, quads, normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]


def moved(place, points):
    """Points where a rigid 4 x 4 matrix carries them."""
    return points @ place[:3, :3].T + place[:3, 3]


# ---- blocks ------------------------------------------------------------------------------------------------------------------------------

def _colour(model):
    text = glint.model(model).colour
    return np.array([int(text[i:i + 2], 16) for i in (1, 3, 5)], np.uint8)


class Answers:
    """An inspection, with what is asked of it often. scene: in the world. given: as it was read."""

    def __init__(self, inspection, failure, given):
        self.inspection, self.failure, self.given = inspection, failure, given
        carried = inspection.light_frame == "camera"
        self.scene = given if carried else inspection.scene
        self.cameras = [np.linalg.inv(f.camera.camera_from_world) for f in given.frames]
        # World from the coordinates in which the lights stand still: those of fits, views and predictions.
        self.places = self.cameras if carried else [np.eye(4)] * len(given.frames)
        self.comparisons = collections.defaultdict(list)
        for model, result in inspection.models.items():
            for c in result.frames:
                self.comparisons[model, c.frame].append(c)


class View:
    """One frame with its camera, surface and sizes of what is drawn. place: world from the coordinates of fits and predictions."""

    def __init__(self, scene, frame, surface, depth, plane_size, place):
        self.scene, self.frame, self.surface, self.depth, self.plane_size = scene, frame, surface, depth, plane_size
        self.camera, self.place, self.still = scene.frames[frame].camera, place, np.array_equal(place, np.eye(4))

    def in_world(self, plane):
        """A plane of a fit or prediction."""
        return plane if self.still else glint.Plane(moved(self.place, -plane.offset * plane.normal), self.place[:3, :3] @ plane.normal)

    def draw_point(self, out, point, **of_cells):
        """A brightest point of a fit or prediction, with the angle there."""
        out.add([moved(self.place, point.position)], None, {"normals": [self.place[:3, :3] @ point.normal], "pixel": [point.pixel],
                                                            "alpha_deg": [math.degrees(point.alpha)]}, **of_cells)

    def hits(self, pixels):
        """(positions (n, 3), hit (n,)) of the rays through pixels."""
        if self.surface is None or len(pixels) == 0:
            return np.full((len(pixels), 3), np.nan), np.zeros(len(pixels), bool)
        found = self.surface.first_hits(self.camera.centre[None], self.camera.directions(pixels))
        return np.array(found.positions), np.array(found.hit)

    def draw_contour(self, image, on_surface, contour, gaps, of_points, **of_cells):
        """A contour into two blocks: at the photograph, and on the surface, as far as its rays meet it."""
        n = len(contour)
        of_points = {"pixel": contour, **of_points}
        every = np.ones(n, bool)
        image.add(_at_depth(self.camera, contour, self.depth * (1 - OFF_PLANE)), _runs(_kept(n, gaps, every)), of_points,
                  **of_cells)
        positions, hit = self.hits(contour)
        if not hit.any():
            on_surface.missing("no ray of a contour meets the surface")
            return 0.0
        runs = _runs(_kept(n, gaps, hit))
        if not hit.all():
            on_surface.missing(f"{n - int(hit.sum())} of {n} points of a contour miss the surface")
        positions[~hit] = positions[hit][0]  # no cell names them
        on_surface.add(positions, runs, of_points, **of_cells)
        return float(np.linalg.norm(positions[hit] - positions[hit].mean(axis=0), axis=1).max())

    def size_of(self, contour):
        if self.plane_size > 0:
            return self.plane_size / 2
        positions, hit = self.hits(contour)
        spread = np.linalg.norm(positions[hit] - positions[hit].mean(axis=0), axis=1).max() if hit.any() else 0.0
        return 2 * float(spread) if spread > 0 else self.depth / 4


def middle_of(scene, surface):
    """(middle of the object, median distance of a camera to it), world units."""
    centres = np.array([f.camera.centre for f in scene.frames])
    if surface is not None and np.isfinite(surface.bounds).all():
        middle = surface.bounds.mean(axis=0)
    else:  # where the first camera looks, as far as the cameras are apart
        c = scene.frames[0].camera
        middle = c.centre + c.camera_from_world[2, :3] * max(np.linalg.norm(centres - centres.mean(axis=0), axis=1).max(), 1e-3)
    return middle, float(np.median(np.linalg.norm(centres - middle, axis=1)))


def part_of(surface, middle, distance):
    """Bounds of what is drawn of a surface without an end, such as a plane: as much of it as the cameras are away. Else empty."""
    lower, upper = surface.bounds
    if np.isfinite(surface.bounds).all():
        return {}
    return {"lower": np.where(np.isfinite(lower), lower, middle - distance / 2),
            "upper": np.where(np.isfinite(upper), upper, middle + distance / 2)}


def _draw_mirror(view, planes, cameras, camera, plane, position, contour, **of_cells):
    planes.add(_square(plane, position, view.size_of(contour), camera.camera_from_world[0, :3]),
               normal=plane.normal, offset=plane.offset, **of_cells)
    around, lines = _frustum(camera, view.depth)
    cameras.add(_mirrored(plane, around), lines, projection=camera.virtual(plane).ravel(), **of_cells)


def _draw_canonical(view, out, camera, plane, canonical, **of_cells):
    if canonical is None:
        out.missing("a highlight has no canonical contour")
        return
    points = moved(view.place, np.array(canonical.on_tangent_plane).reshape(-1, 3))
    if len(points) > 1:
        out.add(points, [np.append(np.arange(len(points)), 0)], of="points", **of_cells)
    if canonical.ellipse is None:
        out.missing("the canonical contour of a highlight is no ellipse")
        return
    e = canonical.ellipse
    points = _on_plane(camera, plane, e.sample(ELLIPSE_STEPS))
    closed = [np.append(np.arange(len(points)), 0)] if len(points) == ELLIPSE_STEPS else [np.arange(len(points))]
    out.add(points, closed, of="ellipse", **of_cells)


def training(answers, view):
    """Virtual cameras, tangent planes and canonical ellipses of the training highlights."""
    cameras, planes, ellipses, points = Parts("lines"), Parts("polys"), Parts("lines"), Parts("verts")
    for v in answers.inspection.views:
        where = {"frame": v.frame, "light": v.highlight.light}
        if v.tangent_plane is None:
            for block in cameras, planes, ellipses, points:
                block.missing(f"frame {answers.inspection.scene.frames[v.frame].id}: {v.failure or 'no tangent plane'}")
            continue
        try:
            surface = answers.scene.surface(v.frame)
        except glint.CannotAnswer:
            surface = None
        own = View(answers.scene, v.frame, surface, view.depth, view.plane_size, answers.places[v.frame])
        camera = v.camera if own.still else v.camera.at(v.camera.camera_from_world @ np.linalg.inv(own.place))
        plane = own.in_world(v.tangent_plane)
        _draw_mirror(own, planes, cameras, camera, plane, moved(own.place, v.brightest_point.position), v.highlight.contour, **where)
        _draw_canonical(own, ellipses, camera, plane, v.canonical, **where)
        own.draw_point(points, v.brightest_point, **where)
    return {"VirtualCameras": cameras.data(), "TangentPlanes": planes.data(), "CanonicalEllipses": ellipses.data(),
            "BrightestPoints": points.data()}


def observed(answers, view):
    """What the frame itself shows: contours, brightest points, tangent planes, virtual cameras."""
    image, on_surface, points = Parts("lines"), Parts("lines"), Parts("verts")
    planes, cameras = Parts("polys"), Parts("lines")
    evidence = answers.inspection.evidence[view.frame]
    if evidence.failure or not evidence.highlights:
        for block in image, on_surface, points, planes, cameras:
            block.missing(evidence.failure or "no highlight in this frame")
    for i, h in enumerate(evidence.highlights):
        where = {"light": h.light, "highlight": i, "level": h.level, "area_px2": h.area}
        view.draw_contour(image, on_surface, h.contour, [], {}, **where)
        seen = glint.TrainingView(view.camera, view.surface, h, view.frame)
        if seen.tangent_plane is None:
            for block in points, planes, cameras:
                block.missing(seen.failure or "no tangent plane")
            continue
        b = seen.brightest_point
        points.add([b.position], None, {"normals": [b.normal], "pixel": [b.pixel]}, **where)
        _draw_mirror(view, planes, cameras, view.camera, seen.tangent_plane, b.position, h.contour, **where)
    return {"ContoursInImage": image.data(), "ContoursOnSurface": on_surface.data(), "BrightestPoints": points.data(),
            "TangentPlanes": planes.data(), "VirtualCameras": cameras.data()}


class Predicted:
    """Blocks of what one model predicts in one frame."""

    def __init__(self, view, model):
        self.view, self.model, self.colour = view, model, _colour(model)
        self.image, self.on_surface, self.points = Parts("lines"), Parts("lines"), Parts("verts")
        self.planes, self.cameras, self.ellipses = Parts("polys"), Parts("lines"), Parts("lines")

    def missing(self, reason):
        for block in self.image, self.on_surface, self.points, self.planes, self.cameras, self.ellipses:
            block.missing(reason)

    def add(self, light, highlight, index, metrics=None, matched=-1):
        where = {"light": light, "highlight": index, "coverage": highlight.coverage, "colour": self.colour}
        errors = {} if metrics is None and matched is None else {m: getattr(metrics, m) if metrics else math.nan for m in METRICS}
        numbers = {**where, **errors, **({} if matched is None else {"matches": matched})}
        sigma = np.array(highlight.sigma_px)
        self.view.draw_contour(self.image, self.on_surface, highlight.contour, highlight.gaps,
                               {"sigma_px": sigma} if len(sigma) == len(highlight.contour) else {}, **numbers)
        self.view.draw_point(self.points, highlight.brightest_point, **where)
        if highlight.tangent_plane is None:
            for block in self.planes, self.cameras, self.ellipses:
                block.missing(f"{self.model} has no tangent planes")
            return
        plane, position = self.view.in_world(highlight.tangent_plane), moved(self.view.place, highlight.brightest_point.position)
        _draw_mirror(self.view, self.planes, self.cameras, self.view.camera, plane, position, highlight.contour, **where)
        _draw_canonical(self.view, self.ellipses, self.view.camera, plane, highlight.canonical, **where)

    def tree(self):
        named = {"model": self.model}
        return {"ContoursInImage": self.image.data(**named), "ContoursOnSurface": self.on_surface.data(**named),
                "BrightestPoints": self.points.data(**named), "TangentPlanes": self.planes.data(**named),
                "VirtualCameras": self.cameras.data(**named), "CanonicalEllipses": self.ellipses.data(**named)}


def predicted(answers, view, model):
    out = Predicted(view, model)
    for c in answers.comparisons[model, view.frame]:
        if c.prediction.failure:
            out.missing(f"light {c.light}: {c.prediction.failure}")
        for k, highlight in enumerate(c.prediction.highlights):
            row = next((r for r in c.rows if r.predicted == k), None)
            out.add(c.light, highlight, k, row.metrics if row else None, row.observed if row else -1)
    if not answers.comparisons[model, view.frame]:
        failed = [f"light {f.light}: {f.failure}" for f in answers.inspection.models[model].fits if f.failure]
        out.missing("; ".join(failed) or "this model has no prediction for this frame")
    return out.tree()


def fits_of(answers, model, surface_key):
    return [f for f in answers.inspection.models[model].fits if f.surface is None or f.surface == surface_key]


def _drawn(answers, *roles):
    """Things of the 3D picture with these roles that belong to no frame."""
    return [thing for thing in answers.inspection.drawing() if thing["role"] in roles]


def ellipsoids(answers, frame, surface_key):
    tree, place = {}, answers.places[frame]
    bodies = {(t["model"], t["light"], t["surface"]): t for t in _drawn(answers, "ellipsoid")}
    for model in answers.inspection.models:
        for f in fits_of(answers, model, surface_key):
            out, fit = Parts("polys"), f.fit
            if fit is None:
                out.missing(f"{model}, light {f.light}: {f.failure}")
            elif (body := bodies.get((model, f.light, f.surface))) is None:
                continue  # a model without an ellipsoid
            elif body["world_from_ball"] is None:
                out.missing(f"{model}, light {f.light}: {body['problem']}")
            else:
                points, quads, normals = _ball(place @ body["world_from_ball"])
                out.add(points, list(quads), {"normals": normals}, colour=_colour(model))
            numbers = {} if fit is None else dict(q_dual=None if fit.q_dual is None else place @ fit.q_dual @ place.T,
                                                  gap_ratio=fit.gap_ratio, condition=fit.condition,
                                                  residual_px=fit.residual_px,
                                                  frames=fit.frames, solver=fit.solver, warnings=list(fit.warnings))
            if fit is not None and fit.ellipsoid is not None:
                numbers.update(centre=moved(place, fit.ellipsoid.centre), semi_axes=fit.ellipsoid.semi_axes,
                               world_from_ellipsoid=place @ fit.ellipsoid.world_from_ellipsoid)
            tree["-".join([model, f.light]
                          + ([f.surface] if f.surface else []))] = out.data(model=model, light=f.light, **numbers)
    return tree


def _draw_light(points, lines, middle, reach, light_id, homogeneous, **of_cells):
    """A light as a point, and a line to it from the object's middle; one at infinity at `reach` from there."""
    h = np.asarray(homogeneous, float)
    infinite = h[3] == 0
    place = middle + reach * h[:3] / np.linalg.norm(h[:3]) if infinite else h[:3] / h[3]
    points.add([place], light=light_id, at_infinity=int(infinite), homogeneous=h, **of_cells)
    lines.add([middle, place], light=light_id, at_infinity=int(infinite))


def _true_lamps(answers, frame):
    """Id and homogeneous place of each true light in the world of a frame: those that the picture has, then those that stand still in the other
    coordinates."""
    drawn = {t["light"]: answers.places[frame] @ t["place"] for t in _drawn(answers, "true-lamp")}
    for light in answers.given.lights:
        middle = np.mean(light["segment"], axis=0) if "segment" in light else light.get("position")
        place = np.append(light["direction"], 0) if middle is None else np.append(middle, 1)
        drawn.setdefault(light["id"], (answers.cameras[frame] if light["frame"] == "camera" else np.eye(4)) @ place)
    return drawn


def lights(answers, frame, surface_key, middle, reach):
    place = answers.places[frame]
    turn = place[:3, :3]
    estimated, true, lamps, lines = Parts("verts"), Parts("verts"), Parts("verts"), Parts("lines")
    outlines = Parts("lines")
    for light, estimate in sorted(answers.inspection.lights(frame).items()):
        if isinstance(estimate, str):
            estimated.missing(f"light {light}: {estimate}")
            continue
        c = estimate.covariance
        c = np.full((3, 3), np.nan) if c is None else turn @ c @ turn.T
        _draw_light(estimated, lines, middle, reach, light, place @ estimate.light.homogeneous, covariance=c.ravel(),
                    sigma=np.sqrt(np.diag(c)),
                    limit_angle_deg=math.degrees(estimate.limit_angle), rms_px=estimate.rms_px, solver=estimate.solver)
    for model in answers.inspection.models:
        for f in fits_of(answers, model, surface_key):
            if f.fit is None or f.fit.light_estimate is None:
                continue
            angle, radius = f.fit.limit_angle, f.fit.light_radius
            _draw_light(lamps, Parts("lines"), middle, reach, f.light, place @ f.fit.light_estimate.homogeneous, model=model,
                        colour=_colour(model),
                        limit_angle_deg=math.nan if angle is None else math.degrees(angle),
                        light_radius=math.nan if radius is None else radius)
    radii = {light["id"]: light["radius"] for light in answers.given.lights}
    for thing in _drawn(answers, "fitted-lamp", "true-lamp"):
        if thing["surface"] not in (None, surface_key):
            continue
        for chain in thing["chains"]:
            outlines.add(moved(place, chain), model=thing["model"] or "truth", light=thing["light"])
    for light, homogeneous in _true_lamps(answers, frame).items():
        _draw_light(true, Parts("lines"), middle, reach, light, homogeneous, light_radius=radii[light])
    if not answers.given.lights:
        true.missing("the scene states no true lights")
    return {"Estimated": estimated.data(), "OfModels": lamps.data(), "True": true.data(), "LongLamps": outlines.data(),
            "FromObject": lines.data()}


def camera_numbers(scene, frame):
    """Field data of a frame: its camera, and what a ParaView view needs to look through it."""
    c = scene.frames[frame].camera
    pose = c.camera_from_world
    files = scene.frames[frame].files
    return dict(frame=frame, frame_id=scene.frames[frame].id, width_px=c.width, height_px=c.height, K_px=c.K,
                camera_from_world=pose,
                projection=c.projection, lens=c.model, distortion=c.distortion if np.any(c.distortion) else None,
                view_position=c.centre,
                view_focal_point=c.centre + pose[2, :3], view_up=-pose[1, :3],
                view_angle_deg=math.degrees(2 * math.atan2(c.height / 2, c.K[1, 1])),
                image=files.get("image") or files.get("radiance"), surface=scene.frames[frame].surface or None, units=UNITS)


def cameras(scene, frame, depth, train, held_out):
    out = Parts("lines")
    for i, f in enumerate(scene.frames):
        points, lines = _frustum(f.camera, depth)
        role = "training" if i in train else "held out" if i in held_out else "not used" if train or held_out else "unknown"
        out.add(points, lines, frame=i, frame_id=f.id, role=role, current=int(i == frame))
    now = Parts("lines")
    now.add(*_frustum(scene.frames[frame].camera, depth))
    numbers = camera_numbers(scene, frame)
    numbers.pop("units")
    return {"All": out.data(), "OfFrame": now.data(**numbers)}


def photograph(scene, frame, depth, largest):
    """The photograph as cells of a grid at a depth before the camera, one cell a pixel, or a square of pixels averaged. CannotAnswer."""
    picture = np.array(scene.photograph(frame))
    picture = picture[..., None].repeat(3, axis=2) if picture.ndim == 2 else picture[..., :3]
    camera = scene.frames[frame].camera
    h, w = picture.shape[:2]
    step = max(1, math.ceil(max(h, w) / max(largest, 1)))
    rows, columns = np.arange(0, h, step), np.arange(0, w, step)
    sums = np.add.reduceat(np.add.reduceat(picture.astype(np.float64), rows, axis=0), columns, axis=1)
    share = np.outer(np.diff(np.append(rows, h)), np.diff(np.append(columns, w)))[..., None]
    rgb = np.clip(np.rint(255 * np.nan_to_num(sums / share)), 0, 255).astype(np.uint8)
    x, y = np.meshgrid(np.append(columns, w) - 0.5, np.append(rows, h) - 0.5)
    corners = np.stack([x.ravel() * camera.width / w, y.ravel() * camera.height / h],
                       axis=1) if (w, h) != (camera.width, camera.height) \
        else np.stack([x.ravel(), y.ravel()], axis=1)
    grid = vtkStructuredGrid()
    grid.SetDimensions(len(columns) + 1, len(rows) + 1, 1)
    grid.SetPoints(vtk_points(_at_depth(camera, _ideal(camera, corners), depth)))
    colours = array("photograph", rgb.reshape(-1, 3))
    grid.GetCellData().SetScalars(colours)
    numbers = camera_numbers(scene, frame)
    return note(grid, pixels_per_cell=step, **numbers)


def triangles(surface, cells, box):
    """The triangles of a surface, of an analytic one with so many cells along a side."""
    mesh = surface.tessellate(cells, **box)
    out, normals = Parts("polys"), np.array(mesh.normals)
    out.add(mesh.vertices, [], {"normals": normals} if len(normals) == len(mesh.vertices) else {})
    data = out.data(surface=repr(surface))
    ids = np.array(mesh.triangles, dtype=np.int64).reshape(-1, 3)
    cell_array = vtkCellArray()
    cell_array.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(ids) + 1, 3, dtype=np.int64), deep=True),
                       numpy_to_vtkIdTypeArray(np.ascontiguousarray(ids.ravel()), deep=True))
    data.SetPolys(cell_array)
    return data


def empty(reason):
    out = Parts("verts")
    out.missing(reason)
    return out.data()


def errors(table, inspection):
    """One row per held-out highlight, with the columns of every model: the numbers of `glint evaluate --json`."""
    rows = collections.OrderedDict()
    models = list(inspection.models)
    held_out = set(inspection.held_out)
    for model in models:
        for c in inspection.models[model].frames:
            if c.frame not in held_out:
                continue
            for row in c.rows:
                if row.observed < 0:
                    continue
                rows.setdefault((c.frame, c.light, row.observed), {})[model] = (c, row)
    keys = sorted(rows)
    frames = inspection.scene.frames
    columns = [("frame", [k[0] for k in keys]), ("frame_id", [frames[k[0]].id for k in keys]), ("light", [k[1] for k in keys]),
               ("highlight", [k[2] for k in keys])]
    for model in models:
        found = [rows[k].get(model) for k in keys]
        for metric in METRICS:
            columns.append((f"{metric} {model}",
                            [math.nan if f is None or f[1].metrics is None else getattr(f[1].metrics, metric) for f in found]))
        columns.append((f"coverage {model}",
                        [math.nan if f is None or f[1].predicted < 0 else f[0].prediction[f[1].predicted].coverage
                         for f in found]))
        columns.append((f"reason {model}",
                        ["no prediction" if f is None else (f[1].failure or f[0].prediction.failure or "") for f in found]))
    for name, values in columns:
        if keys:
            table.AddColumn(array(name, values))
    note(table, units="px, percent (pct) of the observed equivalent diameter, degrees (deg); iou and coverage: 0 to 1; nan: not measured",
          models=models, reasons=None if keys else ["no held-out highlight was observed"])
