# SPDX-License-Identifier: BSD-3-Clause
"""Runs in Blender: renders one rung by Cycles, direct light (two bounces with a floor), and leaves light as arrays.

  blender -b --factory-startup -P docs/reality/render.py -- SPEC.json FOLDER

FOLDER/light/ID.npy: light of the photograph, RGB. FOLDER/light/ID-K.npy: specular light of lamp K alone, on the body, grey, from
which the true contours are traced. FOLDER/made.json: camera, poses, semi-axes, and which lamps are on. FOLDER/mesh.npz: the body,
where it has waves. A frame whose arrays are there stays.
"""
import json
import math
import os
import pathlib
import sys

import bpy
import numpy as np

LAMP = {"kind": "sphere", "position": [0.75, -0.55, 1.3], "radius": 0.01, "power": 30.0}
DEFAULT = {"semi_axes": [0.15, 0.11, 0.09], "roughness": [0.42, 0.42], "size": [360, 270], "focal": 720, "views": 12,
           "eye": 0.75, "lamps": [LAMP], "samples": 128, "shape_samples": 400, "waves": 0.0, "diffuse": [0.2, 0.26, 0.4]}
WAVES = np.array([[3.1, -1.9, 1.7], [-1.2, 2.6, 2.9], [2.3, 2.8, -1.4]])  # three bulges to a turn: the body stays convex


# Cameras.
def look_at(eye):
    """camera_from_world of a camera at `eye` that looks at the origin; x right, y down, z forward."""
    forward = -eye / np.linalg.norm(eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    turn = np.stack([right, np.cross(forward, right), forward])
    return np.vstack([np.hstack([turn, (-turn @ eye)[:, None]]), [0, 0, 0, 1]])


def poses(spec):
    """An arc of a third of a turn opposite and above the lamps, or one still camera; `eye` is the sine of the elevation."""
    if "on" in spec:
        return [look_at(0.95 * np.array([0, -math.sqrt(1 - spec["eye"] ** 2), spec["eye"]]))] * len(spec["on"])
    out = []
    for k in range(spec["views"]):
        azimuth = math.radians(-110 + 120 * k / (spec["views"] - 1))
        lift = spec["eye"] + 0.06 * math.sin(1.9 * k)
        level = math.sqrt(1 - lift * lift)
        out.append(look_at(0.95 * np.array([level * math.cos(azimuth), level * math.sin(azimuth), lift])))
    return out


# The scene.
def level(points, spec):
    """1 on the body, less inside; t times as large at t times the point."""
    scaled = points / np.array(spec["semi_axes"])
    radius = np.linalg.norm(scaled, axis=1)
    return radius / (1 + spec["waves"] * np.sin(scaled / radius[:, None] @ WAVES.T).mean(1))


def body(spec, folder, times=7):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=times, radius=1)
    made = bpy.context.object
    mesh = made.data
    points = np.array([v.co for v in mesh.vertices], float) * spec["semi_axes"]
    points /= level(points, spec)[:, None]
    normals = np.stack([level(points + step, spec) - level(points - step, spec) for step in 1e-6 * np.eye(3)], 1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(normals.tolist())
    if spec["waves"]:
        faces = np.array([list(p.vertices) for p in mesh.polygons])
        np.savez(folder / "mesh.npz", vertices=points, faces=faces, normals=normals)
    return made


def node(tree, kind, **values):
    made = tree.nodes.new(kind)
    for name, value in values.items():
        if name in made.inputs:
            made.inputs[name].default_value = value
        else:
            setattr(made, name, value)
    return made


def add(tree, a, b):
    both = node(tree, "ShaderNodeAddShader")
    tree.links.new(a.outputs[0], both.inputs[0])
    tree.links.new(b.outputs[0], both.inputs[1])
    return both


def varied_roughness(tree, glossy, low, high):
    """From low to high along the body's longest axis, as a sine."""
    place = node(tree, "ShaderNodeTexCoord")
    wave = node(tree, "ShaderNodeTexWave", Scale=2.0, Distortion=0.0)
    tree.links.new(place.outputs["Object"], wave.inputs["Vector"])
    span = node(tree, "ShaderNodeMapRange")
    span.inputs["To Min"].default_value, span.inputs["To Max"].default_value = low, high
    tree.links.new(wave.outputs["Fac"], span.inputs["Value"])
    tree.links.new(span.outputs["Result"], glossy.inputs["Roughness"])


def paint(tree, kind, diffuse):
    """Contrast 1 : 5, so that the brightest paint is about as bright as the highlight's foot."""
    dark, bright = (0.12, 0.12, 0.12, 1), (0.6, 0.6, 0.6, 1)
    place = node(tree, "ShaderNodeTexCoord")
    if kind == "checker":
        made = node(tree, "ShaderNodeTexChecker", Scale=40.0, Color1=dark, Color2=bright)
        tree.links.new(made.outputs["Color"], diffuse.inputs["Color"])
    else:
        made = node(tree, "ShaderNodeTexWave", Scale=20.0, Distortion=6.0, Detail=3.0)
        ramp = node(tree, "ShaderNodeValToRGB")
        ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = dark, bright
        tree.links.new(made.outputs["Fac"], ramp.inputs["Fac"])
        tree.links.new(ramp.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(place.outputs["Object"], made.inputs["Vector"])


def lobe(tree, spec, roughness, strength):
    if "anisotropy" in spec:
        glossy = node(tree, "ShaderNodeBsdfAnisotropic", distribution="GGX", Roughness=roughness,
                      Anisotropy=spec["anisotropy"])
        tangent = node(tree, "ShaderNodeTangent", direction_type="RADIAL", axis="Z")
        tree.links.new(tangent.outputs[0], glossy.inputs["Tangent"])
    else:
        glossy = node(tree, "ShaderNodeBsdfGlossy", distribution="GGX", Roughness=roughness)
    glossy.inputs["Color"].default_value = (strength, strength, strength, 1)
    return glossy


def material(spec):
    made = bpy.data.materials.new("body")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    out = node(tree, "ShaderNodeOutputMaterial")
    if "fresnel" in spec:
        shader = node(tree, "ShaderNodeBsdfPrincipled", Roughness=spec["roughness"][0], Specular=spec["fresnel"])
        shader.inputs["Base Color"].default_value = (0.2, 0.2, 0.2, 1)
    else:
        diffuse = node(tree, "ShaderNodeBsdfDiffuse", Color=(*spec["diffuse"], 1))
        if "texture" in spec:
            paint(tree, spec["texture"], diffuse)
        low, high = spec.get("coat") or spec["roughness"]
        if "coat" in spec:
            glossy = add(tree, lobe(tree, spec, low, 0.05), lobe(tree, spec, high, 0.3))
        else:
            glossy = lobe(tree, spec, low, 0.2)
            if low != high:
                varied_roughness(tree, glossy, low, high)
        shader = add(tree, diffuse, glossy)
    tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return made


def emitter(lamp):
    """A ring: a thin torus that shines."""
    tube = 0.02 * lamp["radius"]
    bpy.ops.mesh.primitive_torus_add(major_radius=lamp["radius"], minor_radius=tube, major_segments=48, minor_segments=6)
    made = bpy.context.object
    shine = bpy.data.materials.new("ring")
    shine.use_nodes = True
    shine.node_tree.nodes.clear()
    area = 4 * math.pi ** 2 * lamp["radius"] * tube
    light = node(shine.node_tree, "ShaderNodeEmission", Strength=lamp["power"] / (math.pi * area))
    end = node(shine.node_tree, "ShaderNodeOutputMaterial")
    shine.node_tree.links.new(light.outputs[0], end.inputs["Surface"])
    made.data.materials.append(shine)
    return made


def lamp_object(lamp):
    if lamp["kind"] == "ring":
        made = emitter(lamp)
    else:
        data = bpy.data.lights.new("lamp", {"area": "AREA", "sun": "SUN"}.get(lamp["kind"], "POINT"))
        data.energy = lamp["power"]
        if lamp["kind"] == "area":
            data.shape, (data.size, data.size_y) = "RECTANGLE", lamp["size"]
        elif lamp["kind"] == "sun":
            data.angle = 0
        else:
            data.shadow_soft_size = lamp["radius"]
            data.cycles.use_multiple_importance_sampling = False
        made = bpy.data.objects.new("lamp", data)
        bpy.context.collection.objects.link(made)
    made.location = lamp.get("position") or lamp["direction"]
    made.rotation_mode = "QUATERNION"
    made.rotation_quaternion = (-made.location).to_track_quat("-Z", "Y")
    return made


def floor(depth):
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0, 0, -depth))
    white = bpy.data.materials.new("floor")
    white.use_nodes = True
    white.node_tree.nodes.clear()
    diffuse = node(white.node_tree, "ShaderNodeBsdfDiffuse", Color=(0.8, 0.8, 0.8, 1))
    end = node(white.node_tree, "ShaderNodeOutputMaterial")
    white.node_tree.links.new(diffuse.outputs[0], end.inputs["Surface"])
    bpy.context.object.data.materials.append(white)


def prepared(spec, folder, scratch):
    """The scene with its passes; File Output nodes write what a render gives to `scratch`."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    scene.cycles.device, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = "CPU", False, False
    shaped = any(lamp["kind"] in ("area", "ring") for lamp in spec["lamps"])
    scene.cycles.samples = spec["shape_samples" if shaped else "samples"]
    bounces = 2 if spec.get("floor") else 0
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces"):
        setattr(scene.cycles, name, bounces)
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x, scene.render.resolution_y = spec["size"]
    scene.render.resolution_percentage = 100
    layer = bpy.context.view_layer
    layer.use_pass_glossy_direct = layer.use_pass_glossy_color = True
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers, output = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeOutputFile")
    output.base_path = str(scratch)
    output.format.file_format, output.format.color_depth = "OPEN_EXR", "32"
    output.file_slots.clear()
    for name in ("Image", "GlossDir", "GlossCol"):
        output.file_slots.new(name + "-")
        tree.links.new(layers.outputs[name], output.inputs[name + "-"])
    made = body(spec, folder)
    made.data.materials.append(material(spec))
    if spec.get("floor"):
        floor(spec["semi_axes"][2])
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36
    data.lens = spec["focal"] * 36 / spec["size"][0]
    scene.camera = bpy.data.objects.new("camera", data)
    bpy.context.collection.objects.link(scene.camera)
    return scene


def read(file, size):
    picture = bpy.data.images.load(str(file))
    picture.colorspace_settings.name = "Non-Color"
    values = np.array(picture.pixels[:], np.float32).reshape(size[1], size[0], 4)[::-1, :, :3]
    bpy.data.images.remove(picture)
    return values


def lights_of(scene, scratch, size, seed):
    """Light of the photograph and specular light of one rendering."""
    scene.cycles.seed = seed
    bpy.ops.render.render(write_still=False)
    found = {name: read(next(scratch.glob(name + "-*.exr")), size) for name in ("Image", "GlossDir", "GlossCol")}
    for file in scratch.glob("*.exr"):
        os.remove(file)
    return found["Image"], (found["GlossDir"] * found["GlossCol"]).mean(2)


def main():
    spec_file, folder = (pathlib.Path(p) for p in sys.argv[sys.argv.index("--") + 1:])
    spec = {**DEFAULT, **json.loads(spec_file.read_text())}
    scratch, out = folder / "scratch", folder / "light"
    for made in (scratch, out):
        made.mkdir(parents=True, exist_ok=True)
    scene = prepared(spec, folder, scratch)
    lamps = [lamp_object(lamp) for lamp in spec["lamps"]]
    turn = np.diag([1.0, -1, -1, 1])  # Blender's cameras look along -z, y up
    frames = []
    for k, pose in enumerate(poses(spec)):
        name = f"{k:04}"
        on = spec["on"][k] if "on" in spec else range(len(lamps))
        frames.append({"id": name, "camera_from_world": pose.tolist(), "on": list(on)})
        if (out / f"{name}.npy").exists():
            continue
        scene.camera.matrix_world = (np.linalg.inv(pose) @ turn).T.tolist()
        photo = 0
        for i in on:
            for j, lamp in enumerate(lamps):
                lamp.hide_render = i != j
            if spec["lamps"][i].get("frame") == "camera":
                lamps[i].location = (np.linalg.inv(pose) @ [*spec["lamps"][i]["position"], 1])[:3]
            image, specular = lights_of(scene, scratch, spec["size"], 100 * k + i)
            np.save(out / f"{name}-{i}.npy", specular)
            photo = photo + image
        np.save(out / f"{name}.npy", photo)  # last: it says that the frame is complete
    width, height = spec["size"]
    camera = {"width": width, "height": height, "fx": spec["focal"], "fy": spec["focal"],
              "cx": (width - 1) / 2, "cy": (height - 1) / 2}
    (folder / "made.json").write_text(json.dumps({"camera": camera, "frames": frames, "semi_axes": spec["semi_axes"],
                                                  "lamps": [lamp["kind"] for lamp in spec["lamps"]]}))


main()
