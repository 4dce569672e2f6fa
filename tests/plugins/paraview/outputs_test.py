# SPDX-License-Identifier: BSD-3-Clause
"""Every output of reader and filter against the command line, the Python module and closed forms: numbers to the last bit."""
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import glint
import numpy as np
from host import (SESSIONS, block, check, column, evaluated, fetched, field, finish, load, of_cells, of_points, points, same, session, values)
from paraview.simple import PLYReader

load(globals())
EXACT = 1e-12  # of a unit: some operations in double precision
POSES = 1e-5  # px: rotations of scene files are rotations to 1e-9, and a camera's centre is computed from them
METRICS = ["contour_error_pct", "contour_error_px", "hausdorff_px", "iou", "centre_offset_px", "axis_ratio_error", "angle_error_deg", "peak_offset_px"]


def the_table_is_what_evaluate_writes(name):
    reader = GlintReader(FileName=session(name))
    reader.UpdatePipeline(0.0)
    table, said, compared = fetched(reader, 1), evaluated(session(name)), 0
    keys = list(zip(column(table, "frame").tolist(), column(table, "light"), column(table, "highlight").tolist()))
    check(len(set(keys)) == len(keys), f"{name}: rows of the table are unique")
    for model, answer in said["models"].items():
        for row in answer["frames"]:
            if row["highlight"] is None or row["highlight"] < 0:
                continue
            at = keys.index((row["index"], row["light"], row["highlight"]))
            for metric in METRICS:
                given = row.get(metric)
                check(same(column(table, f"{metric} {model}")[at], math.nan if given is None else given), f"{name}: {model} {metric} of {keys[at]}")
                compared += given is not None
            if row["contour_error_px"] is not None:
                check(same(column(table, f"coverage {model}")[at], row["coverage"]), f"{name}: {model} coverage of {keys[at]}")
    print(name, compared, "numbers of the table equal those of glint evaluate")
    check(compared > 40, f"{name}: only {compared} numbers")
    return reader, said


def the_blocks_are_what_python_has(name, reader, said):
    inspection = glint.inspect(glint.open(session(name)))
    compared = 0
    for frame in (0, inspection.held_out[-1]):
        reader.UpdatePipeline(float(frame))
        data = fetched(reader)
        check(field(data, "frame")[0] == frame, f"{name}: the frame of time {frame}")
        check(field(data, "frame_id")[0] == inspection.scene.frames[frame].id, f"{name}: the frame's id")
        camera = inspection.scene.frames[frame].camera
        check(same(field(data, "projection"), camera.projection.ravel()), f"{name}: projection")
        for model, result in inspection.models.items():
            mine = [h for c in result.frames if c.frame == frame for h in c.prediction.highlights]
            drawn = block(data, f"Predicted/{model}/ContoursInImage")
            wanted = np.concatenate([h.contour for h in mine]) if mine else np.zeros((0, 2))
            check(same(of_points(drawn, "pixel") if mine else wanted, wanted), f"{name}: {model}: predicted contours of frame {frame}")
            compared += wanted.size
            if mine:  # a point of the block projects to its pixel
                check(np.abs(camera.project(points(drawn)) - wanted).max() < POSES, f"{name}: {model}: contours lie on their rays")
                spots = block(data, f"Predicted/{model}/BrightestPoints")
                check(same(points(spots), [h.brightest_point.position for h in mine]), f"{name}: {model}: brightest points")
            for f in result.fits:
                ellipsoid = f.fit.ellipsoid if f.fit else None
                if ellipsoid and f.surface in (None, inspection.scene.frames[frame].surface):
                    body = block(data, "Ellipsoids/" + "-".join([model, f.light] + ([f.surface] if f.surface else [])))
                    check(same(field(body, "q_dual"), f.fit.q_dual.ravel()), f"{name}: {model}: Q*")
                    check(same(field(body, "semi_axes"), ellipsoid.semi_axes), f"{name}: {model}: semi-axes")
                    m = np.linalg.inv(ellipsoid.world_from_ellipsoid)  # every point fulfils the equation of the ellipsoid
                    local, axes = points(body) @ m[:3, :3].T + m[:3, 3], ellipsoid.semi_axes
                    solid = axes > 0  # one axis may be 0: a disk, of which the points fill the inside, too
                    norm = ((local[:, solid] / axes[solid]) ** 2).sum(axis=1)
                    check(np.abs(norm - 1).max() < 1e-9 if solid.all() else norm.max() < 1 + 1e-9, f"{name}: {model}: points on the ellipsoid")
                    check(np.abs(local[:, ~solid]).max(initial=0) < EXACT, f"{name}: {model}: a disk is flat")
        observed = [h.contour for h in inspection.evidence[frame].highlights]
        drawn = block(data, "Observed/ContoursInImage")
        check(same(of_points(drawn, "pixel"), np.concatenate(observed)), f"{name}: observed contours of frame {frame}")
        on_surface = block(data, "Observed/ContoursOnSurface")
        check(np.abs(camera.project(points(on_surface)) - of_points(on_surface, "pixel")).max() < POSES, f"{name}: contours on the surface are seen there")
        views = [v for v in inspection.views if v.tangent_plane]
        planes, mirrored = block(data, "Training/TangentPlanes"), block(data, "Training/VirtualCameras")
        check(same(of_cells(planes, "normal"), [v.tangent_plane.normal for v in views]), f"{name}: tangent planes")
        corners = points(planes).reshape(len(views), 4, 3)
        off = [np.abs(v.tangent_plane.signed_distance(c)).max() for v, c in zip(views, corners)]
        check(max(off) < EXACT, f"{name}: corners on the tangent planes")
        check(same(of_cells(mirrored, "projection")[::5], [v.virtual_camera.ravel() for v in views]), f"{name}: virtual cameras")
        centres = points(mirrored).reshape(len(views), -1, 3)[:, 0]  # the centre is what the projection maps to nothing
        check(max(np.abs(v.virtual_camera @ np.append(c, 1)).max() for v, c in zip(views, centres)) < POSES, f"{name}: centres of virtual cameras")
        lights = block(data, "Lights/Estimated")
        found = [e for _, e in sorted(inspection.lights(frame).items()) if not isinstance(e, str)]
        check(same(of_cells(lights, "homogeneous"), [e.light.homogeneous for e in found]), f"{name}: lights")
    for model, answer in said["models"].items():
        for f in answer["fits"]:
            body = block(data, "-".join(filter(None, [f"Ellipsoids/{model}", f["light"], f["surface"]])))
            if body is not None and f["q_dual"] and body.GetNumberOfPoints():
                check(same(field(body, "q_dual"), np.ravel(f["q_dual"])), f"{name}: {model}: Q* of glint evaluate")
    print(name, compared, "coordinates equal those of Python")


def the_photograph_is_where_its_pixels_are():
    reader = GlintReader(FileName=str(SESSIONS / "ellipsoid/scene.json"), LargestPhotographSide=80)
    reader.UpdatePipeline(4.0)
    data, scene = fetched(reader), glint.open(SESSIONS / "ellipsoid/scene.json")
    grid, picture, camera = block(data, "Photograph"), scene.photograph(4), scene.frames[4].camera
    size = [0, 0, 0]
    grid.GetDimensions(size)
    check(size == [81, 61, 1] and field(grid, "pixels_per_cell")[0] == 8, "640 x 480 px in cells of 8 x 8")
    means = np.rint(255 * np.asarray(picture, float).reshape(60, 8, 80, 8, 3).mean(axis=(1, 3))).astype(int)
    check(np.abs(of_cells(grid, "photograph").reshape(60, 80, 3).astype(int) - means).max() <= 1, "cells are means of their pixels")
    x, y = np.meshgrid(np.arange(81) * 8 - 0.5, np.arange(61) * 8 - 0.5)
    seen = camera.project(points(grid))
    check(np.abs(seen - np.stack([x.ravel(), y.ravel()], axis=1)).max() < 1e-9, "corners of cells are corners of pixels")


def the_true_lamp_and_the_surface_are_the_scene_s():
    reader = GlintReader(FileName=session("ellipsoid"))
    reader.UpdatePipeline(0.0)
    data = fetched(reader)
    body = points(block(data, "Surface")) / [0.6, 0.35, 0.25]  # sessions/ellipsoid/spec.json
    check(np.abs((body ** 2).sum(axis=1) - 1).max() < 1e-9, "the surface is the ellipsoid of the scene")
    check(same(points(block(data, "Lights/True"))[0], [1.2, -1.0, 2.2]), "the true lamp")  # the same file
    reader = GlintReader(FileName=str(SESSIONS / "plane/scene.json"))  # its lamp is a sphere
    reader.UpdatePipeline(0.0)
    outline = points(block(fetched(reader), "Lights/LongLamps"))
    check(len(outline) > 100 and np.abs(np.linalg.norm(outline - [0.05, 0.03, 1.3], axis=1) - 0.01).max() < EXACT, "the outline of a sphere")


def the_filter_on_the_scene_s_own_mesh(name="vase"):
    """On the vertices that the scene's mesh has, the filter says what the reader says; on others, what glint.predict says of them."""
    inspection = glint.inspect(glint.open(session(name)), ["limit-angle"])
    frame = inspection.held_out[2]
    reader = PLYReader(FileNames=[str(SESSIONS / name / "mesh/geom_00.ply")])
    for directions in 0, 24:
        filtered = GlintPredictHighlights(Input=reader, Session=session(name), Model="limit-angle", Directions=directions)
        filtered.UpdatePipeline(float(frame))
        mesh = fetched(reader)
        triangles = mesh.GetPolys().GetConnectivityArray()
        settings = {"predict.directions": directions} if directions else {}
        fits = glint.inspect(glint.open(session(name)), ["limit-angle"], **settings)
        normals = mesh.GetPointData().GetNormals()
        surface = glint.mesh(points(mesh), values(triangles).reshape(-1, 3), None if normals is None else values(normals), **fits.request.settings)
        wanted = glint.predict(fits.models["limit-angle"].fits[0].fit, inspection.scene.frames[frame].camera, surface, **fits.request.settings)
        drawn = block(fetched(filtered), "ContoursInImage")
        check(same(of_points(drawn, "pixel"), np.concatenate([h.contour for h in wanted.highlights])), f"the filter's contour, directions {directions}")
        if not directions:
            own = next(c for c in inspection.models["limit-angle"].frames if c.frame == frame).prediction[0].contour
            off = np.abs(own[:, None] - wanted[0].contour[None]).sum(axis=2).min(axis=1).max()
            check(off < 0.05, f"single precision of the mesh moves the contour by {off} px")
            print("filter and reader differ by", off, "px")
    return reader


def a_level_changes_the_contour():
    reader = GlintReader(FileName=session("ellipsoid"))
    areas = []
    for level in 0.3, 0.0, 0.7:
        reader.ContourLevel = level
        reader.UpdatePipeline(8.0)
        areas.append(of_cells(block(fetched(reader), "Observed/ContoursInImage"), "area_px2")[0])
    check(areas[0] > areas[1] > areas[2], f"a lower level has a larger contour: {areas}")
    wanted = glint.inspect(glint.open(session("ellipsoid")), [], level=0.7).evidence[8].highlights[0].area
    check(same(areas[2], wanted), "the contour of level 0.7")


for each in "ellipsoid", "two-lamps":
    the_blocks_are_what_python_has(each, *the_table_is_what_evaluate_writes(each))
the_photograph_is_where_its_pixels_are()
the_true_lamp_and_the_surface_are_the_scene_s()
the_filter_on_the_scene_s_own_mesh()
a_level_changes_the_contour()
finish()
