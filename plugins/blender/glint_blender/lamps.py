# SPDX-License-Identifier: BSD-3-Clause
"""Lamps: Blender's as the lights of a scene file, Glint's as Blender lights of the right size."""
import bpy
from mathutils import Matrix

from . import cameras, linear

LONG = 4.0  # an area light at least this many times as long as wide is exported as a tube


def lamp_objects(scene):
    return [o for o in scene.objects if o.type == "LIGHT"]


def shines(object_, depsgraph):
    """Whether a lamp lights a render at the scene's frame."""
    lamp = object_.evaluated_get(depsgraph)
    return not lamp.hide_render and lamp.data.energy > 0


def light_of(object_, depsgraph, world, warnings):
    """An entry of `lights` of a scene file. What Glint's lamps cannot be is said in `warnings`."""
    shown = object_.evaluated_get(depsgraph)
    lamp, m = shown.data, linear.rows(shown.matrix_world)
    place = world.to_glint(linear.column(m, 3))
    if lamp.type == "SUN":
        return {"id": object_.name, "direction": linear.unit(world.direction_to_glint(linear.unit(linear.column(m, 2))))}
    if lamp.type in ("POINT", "SPOT"):
        return {"id": object_.name, "position": place, "radius": lamp.shadow_soft_size * world.scale}
    sides = [lamp.size, lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size]
    sides = [s * linear.length(linear.column(m, j)) * world.scale for j, s in enumerate(sides)]
    long_one = 0 if sides[0] >= sides[1] else 1
    if sides[long_one] >= LONG * sides[1 - long_one]:
        half = linear.scaled(linear.unit(world.direction_to_glint(linear.column(m, long_one))), sides[long_one] / 2)
        warnings.append(f"{object_.name}: an area light; written as a tube of its length")
        return {"id": object_.name, "segment": [linear.difference(place, half),
                                                linear.difference(place, linear.scaled(half, -1))],
                "radius": sides[1 - long_one] / 2}
    warnings.append(f"{object_.name}: an area light; written as a ball of the same area")
    return {"id": object_.name, "position": place, "radius": (sides[0] * sides[1] / linear.math.pi) ** 0.5}


def seen_from(light, pose):
    """An entry of `lights` in the coordinates of a camera."""
    moved = {"direction": lambda v: linear.product(linear.block3(pose), v), "position": lambda v: linear.transformed(pose, v),
             "segment": lambda v: [linear.transformed(pose, p) for p in v]}
    return {key: moved[key](value) if key in moved else value for key, value in light.items()}


def same_light(a, b, size=1.0):
    """Whether two entries are the same lamp at the same place, to single precision at places so far (m) from the origin."""
    def flat(value):
        return [v for part in value for v in flat(part)] if isinstance(value, list) else [value]
    if set(a) != set(b):
        return False
    for key in a:
        if key != "id":
            for x, y in zip(flat(a[key]), flat(b[key])):
                if abs(x - y) > 1e-6 * max(size, abs(x)):
                    return False
    return True


def point_light(name, place, radius, world):
    """A Blender point light: a ball of this radius (m) at a place of Glint's world."""
    data = bpy.data.lights.new(name, "POINT")
    data.shadow_soft_size = radius / world.scale
    object_ = bpy.data.objects.new(name, data)
    object_.location = world.to_blender(place)
    return object_


def along_z(axis, place):
    """A matrix whose z axis is the unit vector `axis`."""
    u, v = linear.frame_around(axis)
    return Matrix(linear.with_translation(linear.transposed([u, v, axis]), place))


def sun(name, direction, world):
    """A Blender sun whose light comes from `direction` (Glint's world)."""
    object_ = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
    object_.matrix_world = along_z(linear.unit(world.direction_to_blender(direction)), [0.0, 0.0, 0.0])
    object_.data.angle = 0.0
    return object_


def tube(name, points, radius, world, towards):
    """An area light through the points that say a lamp's place: as long and as wide as a tube between two ends (Blender has no tubes), turned to the
    point `towards`, or over the corners of a panel, in order around it. points, towards: Glint's world."""
    points = [world.to_blender(point) for point in points]
    a, b = points[:2]
    axis = linear.unit(linear.difference(b, a))
    middle = [sum(values) / len(points) for values in zip(*points)]
    back = linear.difference(middle, world.to_blender(towards))  # an area light shines along its -z
    width = 2 * radius / world.scale
    if len(points) > 2:
        side = linear.difference(points[2], b)
        normal, width = linear.cross(axis, linear.unit(side)), linear.length(side)
        back = normal if linear.dot(normal, back) > 0 else linear.scaled(normal, -1)
    back = linear.difference(back, linear.scaled(axis, linear.dot(axis, back)))
    back = linear.unit(back) if linear.length(back) > 1e-9 else linear.frame_around(axis)[0]
    data = bpy.data.lights.new(name, "AREA")
    data.shape = "RECTANGLE"
    data.size = linear.length(linear.difference(b, a))
    data.size_y = max(width, 1e-4)  # Blender draws nothing narrower
    object_ = bpy.data.objects.new(name, data)
    object_.matrix_world = Matrix(linear.with_translation(linear.transposed([axis, linear.cross(back, axis), back]), middle))
    return object_


def blender_light(name, light, world, towards):
    """A Blender light for an entry of `lights`: position, direction or the points of its shape, and radius. towards: the middle of the scene."""
    radius = light.get("radius") or 0.0
    if light.get("direction") is not None:
        object_ = sun(name, light["direction"], world)
    elif light.get("points") is not None:
        object_ = tube(name, light["points"], radius, world, towards)
    else:
        object_ = point_light(name, light["position"], radius, world)
    return object_


def carry(object_, carriers, poses, numbers, world):
    """Moves an object that was made in World.of_cameras() with the cameras of the frames: as the child of the one camera, else by keys. carriers:
    camera object of each frame, None where it is gone. numbers: Blender's frames."""
    if len(set(carriers)) == 1 and carriers[0] is not None:
        object_.parent = carriers[0]
        # A camera's own scale does not count.
        object_.matrix_parent_inverse = Matrix.Diagonal((*carriers[0].matrix_world.to_scale(), 1.0)).inverted_safe()
    else:
        local = object_.matrix_basis.copy()
        cameras.keyed(object_, [cameras.blender_matrix(pose, world) @ local for pose in poses], numbers)
        bpy.context.scene.frame_set(bpy.context.scene.frame_current)
