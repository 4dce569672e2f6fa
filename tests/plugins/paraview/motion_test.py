# SPDX-License-Identifier: BSD-3-Clause
"""An object that turns under a lamp on the camera, and under one that stands still: every block where the scene file and the command line say."""
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np
from host import PROGRAM, SOURCE, WORK, block, check, column, evaluated, fetched, field, finish, load, of_cells, of_points, points, same
from paraview.simple import ExtractBlock, ExtractSurface, MergeBlocks

load(globals())
AXES = np.array([0.6, 0.35, 0.25])  # tests/plugins/moving.json
NEAR = 1e-9  # of a unit: poses of scene files are rotations to 1e-9
MODELS = ["canonical", "limit-angle"]
STILL = {"id": "lamp", "position": [1.2, -1.0, 2.2]}
FRAMES = 0, 5, 11


class Sequence:
    """A scene of glint synth, its session, and what the command line says of it."""

    def __init__(self, name, lights):
        folder = WORK / name
        folder.mkdir()
        spec = {**json.loads((SOURCE / "tests/plugins/moving.json").read_text()), "lights": lights}
        (folder / "spec.json").write_text(json.dumps(spec))
        run = lambda *words: subprocess.run([PROGRAM, *words], check=True, stdout=subprocess.DEVNULL)
        self.file, self.session = folder / "scene.json", folder / "run.glint"
        run("synth", folder / "spec.json", "-o", folder)
        run("reconstruct", self.file, "--model", ",".join(MODELS), "--train", "spread:6", "-o", self.session)
        run("predict", self.session, "--out", folder / "predictions")
        self.scene = json.loads(self.file.read_text())
        self.predicted = json.loads((folder / "predictions/predictions.json").read_text())["models"]
        self.said = evaluated(self.session)
        c = self.scene["camera"]
        self.K = np.array([[c["fx"], 0, c["cx"]], [0, c["fy"], c["cy"]], [0, 0, 1.0]])
        self.poses = [np.array(f["camera_from_world"]) for f in self.scene["frames"]]
        self.places = [np.array(f.get("world_from_object", np.eye(4))) for f in self.scene["frames"]]

    def seen(self, frame, where):
        """Pixels of points of the world."""
        x = (where @ self.poses[frame][:3, :3].T + self.poses[frame][:3, 3]) @ self.K.T
        return x[:, :2] / x[:, 2:]

    def local(self, frame, where):
        back = np.linalg.inv(self.places[frame])
        return where @ back[:3, :3].T + back[:3, 3]

    def off(self, frame, where):
        """By how much points miss the ellipsoid where it stands in a frame."""
        return np.abs(((self.local(frame, where) / AXES) ** 2).sum(axis=1) - 1).max()

    def outward(self, frame, where):
        normals = (self.local(frame, where) / AXES ** 2) @ self.places[frame][:3, :3].T
        return normals / np.linalg.norm(normals, axis=1)[:, None]


def lights_stand_where_they_should(name, s, data, frame, carried):
    back = np.linalg.inv(s.poses[frame])
    into = back if carried else np.eye(4)
    for kind in "Estimated", "OfModels":
        found = block(data, f"Lights/{kind}")
        for model, row in zip(MODELS, of_cells(found, "homogeneous")) if kind == "OfModels" else ():
            wanted = into @ s.said["models"][model]["fits"][0]["light_position"]
            check(np.abs(row / row[3] - wanted).max() < NEAR, f"{name}: lamp of {model} in frame {frame}")
        true = back @ [0.35, -0.25, 0.1, 1] if carried else np.append(STILL["position"], 1)
        check(np.linalg.norm(points(found) - true[:3], axis=1).max() < 0.1, f"{name}: {kind} is near the truth in frame {frame}")
    found = block(data, "Lights/True")
    check(np.abs(points(found)[0] - true[:3]).max() < NEAR, f"{name}: the true lamp in frame {frame}")
    fit = s.said["models"]["canonical"]["fits"][0]
    body = block(data, f"Ellipsoids/canonical-{fit['light']}")
    m = np.linalg.inv(into @ fit["ellipsoid"]["world_from_ellipsoid"])
    local, axes = points(body) @ m[:3, :3].T + m[:3, 3], np.array(fit["ellipsoid"]["semi_axes"])
    solid = axes > 0  # a disk has an axis of 0
    norm = ((local[:, solid] / axes[solid]) ** 2).sum(axis=1)
    check(np.abs(norm - 1).max() < 1e-9 if solid.all() else norm.max() < 1 + 1e-9, f"{name}: points on the ellipsoid in frame {frame}")
    for row, plane in zip(points(body)[::97], of_points(body, "normals")[::97]) if solid.all() else ():
        tangent = np.append(plane, -plane @ row)  # touches the ellipsoid, so that p^T Q* p = 0
        q = field(body, "q_dual").reshape(4, 4)
        check(abs(tangent @ q @ tangent) < 1e-6 * (np.abs(tangent) @ np.abs(q) @ np.abs(tangent)), f"{name}: Q* in frame {frame}")


def the_blocks_move_with_time(name, s, carried):
    reader = GlintReader(FileName=str(s.session))
    check(all(f["frame"] == ("camera" if carried else "world") for m in MODELS for f in s.said["models"][m]["fits"]), f"{name}: where the lamp stands still")
    for frame in FRAMES:
        reader.UpdatePipeline(float(frame))
        data = fetched(reader)
        check(same(field(data, "camera_from_world").reshape(4, 4)[:3, :3], s.poses[frame][:3, :3]) or
              np.abs(field(data, "camera_from_world") - s.poses[frame].ravel()).max() < NEAR, f"{name}: the camera of frame {frame}")
        check(s.off(frame, points(block(data, "Surface"))) < NEAR, f"{name}: the surface of frame {frame}")
        lights_stand_where_they_should(name, s, data, frame, carried)
        for model in MODELS:
            row = next(r for r in s.predicted[model] if r["index"] == frame)
            contour = np.concatenate([h["contour"] for h in row["highlights"]])
            drawn, on_surface = (block(data, f"Predicted/{model}/Contours{k}") for k in ("InImage", "OnSurface"))
            check(same(of_points(drawn, "pixel"), contour), f"{name}: {model}: contours of glint predict in frame {frame}")
            for part in drawn, on_surface:
                check(np.abs(s.seen(frame, points(part)) - of_points(part, "pixel")).max() < 1e-5, f"{name}: {model}: contours are seen there")
            check(s.off(frame, points(on_surface)) < NEAR, f"{name}: {model}: contours on the surface of frame {frame}")
            spots = block(data, f"Predicted/{model}/BrightestPoints")
            where, normals = points(spots), of_points(spots, "normals")
            check(s.off(frame, where) < NEAR and np.abs(normals - s.outward(frame, where)).max() < NEAR, f"{name}: {model}: brightest points")
            check(np.abs(s.seen(frame, where) - [h["peak"] for h in row["highlights"]]).max() < 1e-6, f"{name}: {model}: peaks")
            planes_touch(f"{name}: {model}", s, frame, block(data, f"Predicted/{model}"), where, normals)
        train = block(data, "Training/BrightestPoints")
        for i, spot in enumerate(points(train)):  # each where its own frame has the object
            own = of_cells(train, "frame")[i]
            check(s.off(own, spot[None]) < NEAR, f"{name}: training point of frame {own}")
            check(np.abs(of_cells(block(data, "Training/TangentPlanes"), "normal")[i] - s.outward(own, spot[None])[0]).max() < NEAR, "its plane")
            projection = of_cells(block(data, "Training/VirtualCameras"), "projection")[5 * i].reshape(3, 4)  # the mirror moves no point of it
            x = projection @ np.append(spot, 1)
            check(np.abs(x[:2] / x[2] - s.seen(own, spot[None])[0]).max() < 1e-6, f"{name}: virtual camera of training frame {own}")
        for part in ("BrightestPoints", "TangentPlanes"):
            seen = block(data, f"Observed/{part}")
            if part == "BrightestPoints":
                check(s.off(frame, points(seen)) < NEAR, f"{name}: observed points of frame {frame}")
    return reader


def planes_touch(name, s, frame, tree, where, normals):
    planes, cameras, ellipses = (block(tree, b) for b in ("TangentPlanes", "VirtualCameras", "CanonicalEllipses"))
    for i, corners in enumerate(points(planes).reshape(-1, 4, 3)):
        check(np.abs(of_cells(planes, "normal")[i] - normals[i]).max() < NEAR, f"{name}: normal of a plane in frame {frame}")
        check(np.abs((corners - where[i]) @ normals[i]).max() < NEAR, f"{name}: corners of a plane in frame {frame}")
        check(abs(of_cells(planes, "offset")[i] + where[i] @ normals[i]) < NEAR, f"{name}: offset of a plane in frame {frame}")
    check(np.abs((points(ellipses) - where[0]) @ normals[0]).max(initial=0) < NEAR, f"{name}: canonical contours lie in the plane of frame {frame}")
    projection, x = of_cells(cameras, "projection")[0].reshape(3, 4), np.array([0.3, 0.1, 0.9])
    mirrored = x - 2 * ((x - where[0]) @ normals[0]) * normals[0]
    seen = projection @ np.append(x, 1)
    check(np.abs(seen[:2] / seen[2] - s.seen(frame, mirrored[None])[0]).max() < 1e-6, f"{name}: the virtual camera of frame {frame}")


def the_table_is_what_evaluate_writes(name, s, reader):
    reader.UpdatePipeline(0.0)
    table, compared = fetched(reader, 1), 0
    frames = column(table, "frame").tolist()
    for model in MODELS:
        for row in s.said["models"][model]["frames"]:
            for metric in "contour_error_px", "contour_error_pct", "iou", "peak_offset_px":
                check(same(column(table, f"{metric} {model}")[frames.index(row["index"])], row[metric]), f"{name}: {model} {metric} of {row['id']}")
                compared += 1
    print(name, compared, "numbers of the table equal those of glint evaluate")
    check(compared == 4 * 6 * len(MODELS), f"{name}: {compared} numbers")


def to_curve(pixels, contour):
    """The largest distance of a pixel from a closed curve."""
    ends = np.roll(contour, -1, axis=0) - contour
    from_start = pixels[:, None] - contour[None]
    t = np.clip((from_start * ends).sum(axis=2) / (ends ** 2).sum(axis=1), 0, 1)
    return np.linalg.norm(from_start - t[..., None] * ends, axis=2).min(axis=1).max()


def the_filter_takes_the_mesh_where_it_stands(name, s, reader):
    """On the tessellated surface of each frame the filter says what glint predict says, but for the facets."""
    reader.SurfaceCells = 400
    surface = ExtractSurface(Input=MergeBlocks(Input=ExtractBlock(Input=reader, Selectors=["/Root/Surface"])))
    filtered = GlintPredictHighlights(Input=surface, Session=str(s.session), Model="limit-angle", Normals="curved")
    for frame in FRAMES:
        filtered.UpdatePipeline(float(frame))
        data = fetched(filtered)
        drawn = block(data, "ContoursInImage")
        wanted = np.array(next(r for r in s.predicted["limit-angle"] if r["index"] == frame)["highlights"][0]["contour"])
        off = to_curve(of_points(drawn, "pixel"), wanted)
        print(f"{name}: on the mesh of frame {frame} the filter's contour is {off:.3f} px away")
        check(off < 0.05, f"{name}: the filter's contour of frame {frame} is {off} px away")
        check(s.off(frame, points(block(data, "BrightestPoints"))) < 1e-3, f"{name}: the filter's brightest point of frame {frame}")
        check(np.abs(s.seen(frame, points(drawn)) - of_points(drawn, "pixel")).max() < 1e-5, f"{name}: the filter's contours are seen there")


def lamps_of_both_kinds_are_shown(s):
    """A scene without models: the truth alone."""
    document = {**s.scene, "lights": [s.scene["lights"][0], STILL, {"id": "sun", "frame": "camera", "direction": [0, -0.6, -0.8]},
                                      {"id": "bar", "frame": "camera", "segment": [[-0.3, 0.2, 0], [0.3, 0.2, 0.1]]}]}
    for f in document["frames"]:
        f.pop("lights_on", None)
    file = s.file.with_name("lamps.json")
    file.write_text(json.dumps(document))
    reader = GlintReader(FileName=str(file))
    for frame in FRAMES:
        reader.UpdatePipeline(float(frame))
        found = block(fetched(reader), "Lights/True")
        where = dict(zip(of_cells(found, "light"), of_cells(found, "homogeneous")))
        back = np.linalg.inv(s.poses[frame])
        for light, place in (("flash", back @ [0.35, -0.25, 0.1, 1]), ("lamp", [1.2, -1.0, 2.2, 1]), ("sun", back @ [0, -0.6, -0.8, 0]),
                             ("bar", back @ [0, 0.2, 0.05, 1])):
            check(np.abs(where[light] - place).max() < NEAR, f"true {light} in frame {frame}: {where.get(light)}")


for each, lamps in (("moving", [{"id": "flash", "frame": "camera", "position": [0.35, -0.25, 0.1]}]), ("turning", [STILL])):
    sequence = Sequence(each, lamps)
    of_session = the_blocks_move_with_time(each, sequence, each == "moving")
    the_table_is_what_evaluate_writes(each, sequence, of_session)
    the_filter_takes_the_mesh_where_it_stands(each, sequence, of_session)
    if each == "moving":
        lamps_of_both_kinds_are_shown(sequence)
finish()
