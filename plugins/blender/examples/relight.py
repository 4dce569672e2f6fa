# SPDX-License-Identifier: BSD-3-Clause
"""Capture -> lamp and roughness -> a rendered frame over the photograph, and the same with the lamp elsewhere.

  blender -b --factory-startup --python-exit-code 1 -P plugins/blender/examples/relight.py -- SCENE.json FRAME OUT.png [--glint PROGRAM]
          [--work FOLDER] [--train SPEC] [--samples N] [--move X,Y,Z]

Glint fits the model `reflectance` to the photographs of the scene. Cycles renders the surface with the lobe, the roughness and the lamp that it
found. How strong both are, no fit of contours knows: two numbers for each colour and an ambient light are fitted to the photograph itself. OUT.png
shows the photograph, the render over it, and the render with the lamp moved (m, in the world of the scene). The script prints by how many pixels
the rendered highlight is off the photographed one."""
import argparse
import json
import os
import sys
import tempfile

import addon_utils
import bpy
import numpy

HOME = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def srgb_to_linear(codes):
    return numpy.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(light):
    light = numpy.clip(light, 0, 1)
    return numpy.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)


def pixels_of(path):
    """Codes of a picture, rows from the top: (height, width, 4)."""
    image = bpy.data.images.load(path, check_existing=False)
    width, height = image.size
    values = numpy.empty(width * height * image.channels, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(height, width, -1)[::-1].astype(numpy.float64)


def write_picture(path, light):
    """A picture in sRGB. light: (height, width, 3), linear."""
    height, width, _ = light.shape
    image = bpy.data.images.new("out", width, height)
    values = numpy.ones((height, width, 4), dtype=numpy.float32)
    values[:, :, :3] = linear_to_srgb(light)[::-1]
    image.pixels.foreach_set(values.ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    bpy.data.images.remove(image)


def render_settings(scene, samples):
    scene.render.engine, scene.render.film_transparent = "CYCLES", True
    scene.cycles.samples, scene.cycles.max_bounces, scene.cycles.seed = samples, 0, 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    if scene.world is not None:
        scene.world.use_nodes, scene.world.color = False, (0, 0, 0)


def render_part(scene, surfaces, material, path):
    """What the lamp makes of one material: (height, width, 4), linear."""
    for object_ in surfaces:
        object_.data.materials.clear()
        object_.data.materials.append(material)
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    return pixels_of(path)


def peak_of(picture, window):
    """Centre of mass of what is above half of the largest value in a window (rows, columns), px of it; single pixels of noise count little."""
    part = picture.mean(axis=2)[window]
    weight = numpy.clip(part - part.max() / 2, 0, None)
    rows, columns = numpy.mgrid[:part.shape[0], :part.shape[1]]
    return (columns * weight).sum() / weight.sum(), (rows * weight).sum() / weight.sum()


def window_around_peak(picture, half=30):
    grey = picture.mean(axis=2)
    y, x = numpy.unravel_index(grey.argmax(), grey.shape)
    return slice(max(y - half, 0), y + half + 1), slice(max(x - half, 0), x + half + 1)


def prepared(options):
    """The add-on, the scene, a run and its results; (scene, objects of the surface, lamps, fit's material)."""
    sys.path.insert(0, HOME)
    addon_utils.enable("glint_blender", default_set=True)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    addon_utils.enable("glint_blender", default_set=True)
    bpy.context.preferences.addons["glint_blender"].preferences.program = options.glint
    scene = bpy.context.scene
    bpy.ops.glint.import_scene(filepath=os.path.abspath(options.scene))
    for truth in [o for o in scene.objects if o.type == "LIGHT"]:
        bpy.data.objects.remove(truth)  # the lamp is to be found
    settings = scene.glint
    settings.folder, settings.models, settings.source = options.work, {"reflectance"}, "image"
    kind, _, count = options.train.partition(":")
    settings.training, settings.count = {"first": "FIRST", "spread": "SPREAD"}[kind], int(count)
    bpy.ops.glint.run(shows=False)
    bpy.ops.glint.import_results(filepath=os.path.join(options.work, "evaluation.json"), kinds={"LIGHTS", "MATERIAL"},
                                 overlays=False)
    lamps = [o for o in scene.objects if o.type == "LIGHT"]
    material = next(m for m in bpy.data.materials if "glint_roughness" in m)
    return scene, [o for o in scene.objects if "glint_surface" in o], lamps, material


def parts(scene, surfaces, material, base, folder, name):
    """Glossy and diffuse part of a render, and how much of each pixel the object covers."""
    glossy = render_part(scene, surfaces, material, os.path.join(folder, f"{name}_glossy.exr"))
    diffuse = render_part(scene, surfaces, base, os.path.join(folder, f"{name}_diffuse.exr"))
    return glossy[:, :, :3], diffuse[:, :, :3], glossy[:, :, 3:4]


def relight(options):
    """Runs everything; a dict of what was measured."""
    scene, surfaces, lamps, material = prepared(options)
    number = [f.frame_id for f in scene.glint.frames].index(options.frame)
    item = scene.glint.frames[number]
    scene.frame_set(item.frame)
    render_settings(scene, options.samples)
    from glint_blender import materials
    base = materials.material("Lambert", "torrance-sparrow", 1.0, 0.0, (1.0, 1.0, 1.0))
    photograph = srgb_to_linear(pixels_of(item.picture)[:, :, :3])
    glossy, diffuse, covered = parts(scene, surfaces, material, base, options.work, "as_found")
    inside = covered[:, :, 0] > 0.999
    strengths = []
    for c in range(3):
        columns = numpy.stack([glossy[inside][:, c], diffuse[inside][:, c], numpy.ones(inside.sum())], axis=1)
        strengths.append(numpy.linalg.lstsq(columns, photograph[inside][:, c], rcond=None)[0])
    strengths = numpy.array(strengths)  # colour by (glossy, diffuse, ambient)

    def over(glossy_, diffuse_, covered_):
        light = glossy_ * strengths[:, 0] + diffuse_ * strengths[:, 1] + covered_ * strengths[:, 2]
        return light + photograph * (1 - covered_)
    same = over(glossy, diffuse, covered)
    # The highlight alone: what the base does not explain.
    seen = numpy.where(inside[:, :, None], photograph - diffuse * strengths[:, 1] - strengths[:, 2], 0)
    window = window_around_peak(seen)
    (x, y), (u, v) = peak_of(seen, window), peak_of(glossy, window)
    with open(os.path.join(options.work, "evaluation.json"), encoding="utf-8") as file:
        fit = json.load(file)["models"]["reflectance"]["fits"][0]
    moved = numpy.array(fit["light_position"][:3]) + numpy.array([float(w) for w in options.move.split(",")])
    world = scene.glint.world()
    lamps[0].location = world.to_blender(moved.tolist())
    relit = over(*parts(scene, surfaces, material, base, options.work, "moved"))
    write_picture(options.out, numpy.concatenate([photograph, same, relit], axis=1))
    difference = 255 * (linear_to_srgb(same) - linear_to_srgb(photograph))[inside]
    return {"frame": options.frame, "lobe": fit["lobe"], "roughness": fit["roughness"], "light_position": fit["light_position"],
            "peak_offset_px": float(numpy.hypot(x - u, y - v)), "rms_codes": float(numpy.sqrt((difference ** 2).mean()))}


def main(words):
    parser = argparse.ArgumentParser(prog="relight.py")
    parser.add_argument("scene")
    parser.add_argument("frame")
    parser.add_argument("out")
    parser.add_argument("--glint", default="", help="the program; default: the one on PATH")
    parser.add_argument("--work", default="", help="folder for the files of the run; default: a temporary one")
    parser.add_argument("--train", default="first:6")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--move", default="-1.2,0.3,0.4")
    options = parser.parse_args(words)
    options.out = os.path.abspath(options.out)
    with tempfile.TemporaryDirectory() as temporary:
        options.work = os.path.abspath(options.work or temporary)
        found = relight(options)
    print(f"frame {found['frame']}: {found['lobe']}, m = {found['roughness']:.4f}, lamp at {found['light_position'][:3]} m")
    print(f"rendered highlight: {found['peak_offset_px']:.2f} px from the photographed one; the surface differs by {found['rms_codes']:.2f} "
          "of 255 codes (rms)")
    return found


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1:])
