# SPDX-License-Identifier: BSD-3-Clause
"""Results as objects of Blender. Each keeps the exact numbers that it shows as text in its custom property `glint_result`."""
import json
import math

import bpy
import numpy
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from . import cameras, lamps, linear, materials, meshes, results as results_, views

RESULT = "glint_result"
SURFACE = "glint_surface"
ROOT = "Glint results"
KINDS = [("ELLIPSOIDS", "Ellipsoids", "The ellipsoids that models fitted"),
         ("LIGHTS", "Lamps", "Lamps where the fits put them, as Blender lights with their size"),
         ("CAMERAS", "Virtual Cameras", "Each camera mirrored in the tangent plane of its highlight"),
         ("PLANES", "Tangent Planes", "Tangent planes at the brightest points, with the canonical ellipses"),
         ("CONTOURS", "Contours", "Predicted contours as curves on the surface"),
         ("MATERIAL", "Material", "The fitted lobe and roughness as a material (model reflectance)")]
COLOURS = {"ellipsoid": (0.95, 0.55, 0.1, 0.35), "plane": (0.2, 0.5, 0.95, 0.25), "ellipse": (0.1, 0.3, 0.9, 1.0),
           "contour": (0.9, 0.1, 0.5, 1.0)}


def collection(parent, name):
    """The child collection of this name; made where it is missing."""
    for child in parent.children:
        if child.get("glint_name") == name:
            return child
    made = bpy.data.collections.new(name)
    made["glint_name"] = name
    parent.children.link(made)
    return made


def remove_results(scene, model=None):
    """Removes objects, curves, meshes and lights of earlier results, of one model or of all."""
    gone = [o for o in scene.objects if RESULT in o and (model is None or json.loads(o[RESULT]).get("model") == model)]
    for object_ in gone:
        data = object_.data
        bpy.data.objects.remove(object_)
        if data is not None and data.users == 0:
            bpy.data.batch_remove([data])
    for root in [c for c in scene.collection.children if c.get("glint_name") == ROOT]:
        for child in list(root.children):
            if not child.all_objects:
                bpy.data.collections.remove(child)
        if not root.children:
            bpy.data.collections.remove(root)
    return len(gone)


def show_only_in(object_, frames, all_frames, renders=True):
    """Keys that show an object in some frames of a scene and hide it in the others; in renders, too, unless it never shows there."""
    frames, before = set(frames), None
    for frame in sorted(set(all_frames)):
        hidden = frame not in frames
        if hidden != before:
            for path in ("hide_viewport", "hide_render") if renders else ("hide_viewport",):
                setattr(object_, path, hidden)
                object_.keyframe_insert(path, frame=frame)
            before = hidden


def placed(object_, into, kind, model, numbers, render=False):
    """Links an object and writes down what it is."""
    object_[RESULT] = json.dumps({"kind": kind, "model": model, **numbers})
    object_.hide_render = not render
    into.objects.link(object_)
    return object_


def curve(name, splines, width, colour):
    """A poly curve object. splines: (points of Blender's world, closed)."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    data.bevel_depth, data.bevel_resolution = width, 1
    for points, closed in splines:
        spline = data.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", [v for p in points for v in (*p, 1.0)])
        spline.use_cyclic_u = closed
    data.materials.append(materials.plain(f"Glint {colour}", COLOURS[colour]))
    return bpy.data.objects.new(name, data)


class Caster:
    """First hits of rays with the glossy surface of a frame. objects_of: objects by id of the surface."""

    def __init__(self, scene, world, objects_of):
        self.scene, self.world, self.objects_of, self.trees, self.key = scene, world, objects_of, [], None

    def use(self, surface, frame, plays):
        """Chooses the surface; plays: it may change from frame to frame."""
        key = (surface, frame if plays else None)
        if key == self.key:
            return
        if plays and self.scene.frame_current != frame:
            self.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.key, self.trees = key, []
        for object_ in self.objects_of(surface):
            tree = BVHTree.FromObject(object_, depsgraph)
            matrix = object_.evaluated_get(depsgraph).matrix_world.copy()
            if tree is not None:
                self.trees.append((tree, matrix, matrix.inverted_safe()))

    def hits(self, frame, pixels):
        """Where the rays through ideal pixels of a frame meet the surface first (Blender's world); None for those that miss."""
        origin, directions = views.rays(frame["camera"], frame["pose"], pixels)
        start = Vector(self.world.to_blender(origin))
        ways = directions @ numpy.array(self.world.axes)  # row vectors: the transposed axes, to Blender
        found = [None] * len(pixels)
        nearest = [math.inf] * len(pixels)
        for tree, matrix, back in self.trees:
            near, turn = back @ start, back.to_3x3()
            for i, way in enumerate(ways.tolist()):
                place = tree.ray_cast(near, (turn @ Vector(way)).normalized())[0]
                if place is not None:
                    place = matrix @ place
                    far = (place - start).length
                    if far < nearest[i]:
                        found[i], nearest[i] = place, far
        return found


def splines_on_surface(caster, frame, highlight):
    """Pieces of a contour on the surface: (points of Blender's world, closed), and how many points hit it. Cut at gaps and where rays miss."""
    hits, gaps = caster.hits(frame, highlight["contour"]), highlight["gaps"]
    count = len(hits)
    joins = [hits[i] is not None and hits[(i + 1) % count] is not None and (i, (i + 1) % count) not in gaps
             and ((i + 1) % count, i) not in gaps
             for i in range(count)]
    if count > 2 and all(joins):
        return [(hits, True)], count
    pieces, piece = [], []
    start = next((i + 1 for i in range(count) if not joins[i]), 0)
    for step in range(count):
        i = (start + step) % count
        if hits[i] is not None:
            piece.append(hits[i])
        if not joins[i]:
            if len(piece) > 1:
                pieces.append((piece, False))
            piece = []
    if len(piece) > 1:
        pieces.append((piece, False))
    return pieces, sum(h is not None for h in hits)


class Shower:
    """Makes the objects of one model."""

    def __init__(self, scene, found, model, world, frame_numbers, objects_of, only_own_frame=True, width=None):
        self.scene, self.found, self.model, self.world, self.only = scene, found, model, world, only_own_frame
        self.frame_numbers = frame_numbers  # Blender's frame by number of the scene file's frame
        self.objects_of, self.warnings, self.made = objects_of, [], []
        root = collection(scene.collection, ROOT)
        self.home = collection(root, f"Glint {model}")
        self.home["glint_model"] = model
        points = [h["brightest_point"] for r in found.predictions.get(model, []) for h in r["highlights"] if h["brightest_point"]]
        self.size = self._typical_size(points)
        self.width = width if width is not None else 0.01 * self.size / world.scale

    def _typical_size(self, points):
        """Metres: a tenth of the distance of the cameras from the highlights."""
        far = [linear.length(linear.difference(linear.column(linear.inverse_rigid(f["pose"]), 3), p))
               for f in self.found.frames[:8] for p in points[:8]]
        return 0.1 * sorted(far)[len(far) // 2] if far else 0.1

    def _world_of(self, fit):
        return self.world.of_cameras() if fit["frame"] == "camera" else self.world

    def _put_fit(self, object_, kind, fit, numbers, render=False):
        """What stands still where the fit's light does: in the world, or before the camera."""
        self._put(object_, kind, {"light": fit["light"], "frame": fit["frame"], **numbers}, render=render)
        if fit["frame"] == "camera":
            carriers = [bpy.data.objects.get(f.camera) for f in self.scene.glint.frames]
            lamps.carry(object_, carriers, [f["pose"] for f in self.found.frames], self.frame_numbers, self.world)

    def _put(self, object_, kind, numbers, frame=None, render=False):
        placed(object_, self.home, kind, self.model, numbers, render)
        self.made.append(object_)
        if frame is not None and self.only and len(set(self.frame_numbers)) > 1:
            show_only_in(object_, [self.frame_numbers[frame]], self.frame_numbers, renders=render)
        return object_

    def ellipsoids(self):
        for fit in self.found.fits.get(self.model, []):
            e = fit["ellipsoid"]
            if e is None:
                continue
            vertices, faces = meshes.ball(e["semi_axes"], 48)
            object_ = meshes.mesh_object(f"Ellipsoid {fit['light']}", vertices, faces, self._world_of(fit), e["world_from_ellipsoid"])
            object_.data.materials.append(materials.plain("Glint ellipsoid", COLOURS["ellipsoid"]))
            self._put_fit(object_, "ellipsoid", fit, {"surface": fit["surface"], "ellipsoid": e})

    def lights(self, power=10.0):
        for fit in self.found.fits.get(self.model, []):
            place = fit["light_position"]
            if place is None:
                continue
            name, world, middle = f"Lamp {fit['light']}", self._world_of(fit), self.found.middle
            numbers = {"light_position": place, "light_radius": fit["light_radius"], "light_segment": fit["light_segment"]}
            if fit["light_segment"]:
                seen = linear.transformed(self.found.frames[0]["pose"], middle) if fit["frame"] == "camera" else middle
                object_ = lamps.tube(name, fit["light_segment"], fit["light_radius"] or 0.0, world, seen)
            elif abs(place[3]) < 1e-12:  # a light at infinity; Glint writes 0 or 1
                object_ = lamps.sun(name, place[:3], world)
            else:
                object_ = lamps.point_light(name, linear.scaled(place[:3], 1 / place[3]), fit["light_radius"] or 0.0, world)
            if object_.data.type != "SUN":
                object_.data.energy = power
            self._put_fit(object_, "light", fit, numbers, render=True)

    def _each_highlight(self):
        for row in self.found.predictions.get(self.model, []):
            frame = self.found.frames[row["index"]]
            for number, highlight in enumerate(row["highlights"]):
                if highlight["brightest_point"] is not None and highlight["normal"] is not None:
                    yield row, frame, highlight, f"{frame['id']} {row['light']}" + (f" {number + 1}" if number else "")

    def cameras(self):
        for row, frame, highlight, name in self._each_highlight():
            pose = views.mirrored_pose(frame["pose"], highlight["brightest_point"], highlight["normal"])
            # The inverse of a mirrored pose: a mirror is its own inverse.
            back = linear.product(linear.reflection(highlight["brightest_point"], highlight["normal"]),
                                  linear.inverse_rigid(frame["pose"]))
            m = linear.product(back, views.FLIP)
            world = linear.with_translation(linear.product(linear.transposed(self.world.axes), linear.block3(m)),
                                            self.world.to_blender(linear.column(m, 3)))
            data = bpy.data.cameras.new(f"Virtual {name}")
            cameras.set_lens(data, frame["camera"])
            data.display_size = self.size / self.world.scale
            object_ = bpy.data.objects.new(f"Virtual {name}", data)
            object_.matrix_world = Matrix(world)
            self._put(object_, "virtual camera", {"light": row["light"], "index": row["index"], "camera_from_world": pose},
                      row["index"])

    def planes(self):
        for row, frame, highlight, name in self._each_highlight():
            fit = results_.fit_for(self.found, self.model, row["light"], frame["surface"])
            point, normal = highlight["brightest_point"], highlight["normal"]
            ellipse = None
            # The ellipsoid of the model `primal` is seen by the cameras themselves: it has no outline in a tangent plane.
            if fit is not None and fit["q_dual"] is not None and self.model != "primal":
                to_fit = linear.inverse_rigid(frame["pose"]) if fit["frame"] == "camera" else linear.identity()
                q_dual = linear.product(linear.product(to_fit, fit["q_dual"]), linear.transposed(to_fit))
                ellipse = views.canonical_ellipse(frame["pose"], point, normal, q_dual)
            half = 1.5 * linear.length(ellipse[1]) if ellipse else self.size
            u, v = linear.frame_around(normal)
            corners = [[point[i] + half * (a * u[i] + b * v[i]) for i in range(3)]
                       for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            object_ = meshes.mesh_object(f"Tangent plane {name}", corners, [(0, 1, 2, 3)], self.world, smooth=False)
            object_.data.materials.append(materials.plain("Glint plane", COLOURS["plane"]))
            self._put(object_, "tangent plane", {"light": row["light"], "index": row["index"], "point": point, "normal": normal},
                      row["index"])
            if ellipse:
                centre, first, second = ellipse
                points = [[centre[i] + math.cos(t) * first[i] + math.sin(t) * second[i] for i in range(3)]
                          for t in (2 * math.pi * k / 96 for k in range(96))]
                object_ = curve(f"Canonical ellipse {name}", [([self.world.to_blender(p) for p in points], True)], self.width,
                                "ellipse")
                numbers = {"light": row["light"], "index": row["index"], "centre": centre, "half_axes": [first, second]}
                self._put(object_, "canonical ellipse", numbers, row["index"])

    def contours(self):
        before, missed = self.scene.frame_current, 0
        plays = len(self.found.surfaces) > 1 or any(f["surface"] is None or f["place"] != linear.identity() for f in self.found.frames)
        caster = Caster(self.scene, self.world, self.objects_of)
        for row in self.found.predictions.get(self.model, []):
            frame = self.found.frames[row["index"]]
            for number, highlight in enumerate(row["highlights"]):
                if not highlight["contour"]:
                    continue
                caster.use(frame["surface"], self.frame_numbers[row["index"]], plays)
                pieces, hits = splines_on_surface(caster, frame, highlight)
                if not pieces:
                    missed += 1
                    continue
                name = f"Contour {frame['id']} {row['light']}" + (f" {number + 1}" if number else "")
                object_ = curve(name, pieces, self.width, "contour")
                self._put(object_, "contour",
                          {"light": row["light"], "index": row["index"], "points": len(highlight["contour"]), "hits": hits},
                          row["index"])
        if self.scene.frame_current != before:
            self.scene.frame_set(before)
        if missed:
            self.warnings.append(f"{missed} contours do not meet the surface in this Blender scene and are left out")

    def material(self):
        for fit in self.found.fits.get(self.model, []):
            if fit["roughness"] is None or fit["lobe"] is None:
                continue
            made = materials.material(f"Glint {fit['lobe']} {fit['light']}", fit["lobe"], fit["roughness"])
            made.use_fake_user = True
            self.made.append(made)
            if fit["lobe"] in ("phong", "blinn-phong"):
                self.warnings.append(f"{made.name}: Blender has no such lobe; Beckmann with the same width near the peak stands for it")
            return

    def show(self, kinds):
        for kind, make in (("ELLIPSOIDS", self.ellipsoids), ("LIGHTS", self.lights), ("CAMERAS", self.cameras),
                           ("PLANES", self.planes),
                           ("CONTOURS", self.contours), ("MATERIAL", self.material)):
            if kind in kinds:
                make()
        if not self.home.objects:
            bpy.data.collections.remove(self.home)
        return self.made
