# SPDX-License-Identifier: BSD-3-Clause
"""Where the scene of a rung lies: in the shared data, computed into the cache, or rendered into it."""
import json
import os
import pathlib
import subprocess
import sys

import numpy as np

from reality import contours, pictures, rungs, variants

RENDER = pathlib.Path(__file__).parent / "render.py"
KNOWN = ("id", "frame", "direction", "position", "known", "sigma_deg", "sigma_m")  # what a scene says of a lamp that is given
LAMP_WITH_SHAPE = ("area", "ring")  # sampled at random: their noise is smoothed before contours are traced


def place(rung, data, cache):
    """The scene file and the folder of its truth; None where it is not rendered."""
    if rung.folder:
        folder = pathlib.Path(rung.folder)
        return folder / rung.file, folder / rung.truth
    if rung.kind:
        folder = cache / "computed" / rung.name
        variants.make(rung.kind, rungs.base(data, rung.base), folder)
        return folder / "scene.json", folder / "truth"
    folder = cache / rung.name
    return (folder / "scene.json", folder / "truth") if (folder / "scene.json").exists() else None


def render(blender, ladder, cache):
    """Renders what the cache lacks; frames of a rendering that was stopped are kept. One that fails stays missing."""
    for rung in ladder:
        folder = cache / rung.name
        if (folder / "scene.json").exists():
            continue
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "render.json").write_text(json.dumps(rung.render))
        command = ["nice", "-n", "19", blender, "-b", "--factory-startup", "--python-exit-code", "1", "-t", "1", "-P", RENDER,
                   "--", folder / "render.json", folder]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        (folder / "blender.log").write_text(done.stdout)
        if done.returncode:
            print(f"{rung.name}: Blender failed, see {folder / 'blender.log'}", file=sys.stderr)
            continue
        compose(rung, folder)
        print(f"{rung.name}: rendered", flush=True)


def compose(rung, folder):
    """Photographs in sRGB, truth of each frame and the scene, from the light that Blender left as arrays."""
    made = json.loads((folder / "made.json").read_text())
    photos = [np.load(folder / "light" / f"{f['id']}.npy") for f in made["frames"]]
    top = max(photo.max() for photo in photos)  # no colour is clipped
    (folder / "frames").mkdir(exist_ok=True)
    for frame, photo in zip(made["frames"], photos):
        pictures.write(folder / "frames" / f"{frame['id']}.png", pictures.srgb_codes(variants.PEAK / top * photo))
        lamps = []
        for k in frame["on"]:
            specular = np.load(folder / "light" / f"{frame['id']}-{k}.npy")
            lamps.append(contours.smoothed(specular) if made["lamps"][k] in LAMP_WITH_SHAPE else specular)
        contours.write_truth(folder / "truth", frame["id"], contours.truth_of(lamps))
    surface = {"analytic": {"type": "ellipsoid", "semi_axes": made["semi_axes"]}}
    if (folder / "mesh.npz").exists():
        mesh = np.load(folder / "mesh.npz")
        variants.write_ply(folder / "mesh.ply", mesh["vertices"], mesh["faces"], mesh["normals"])
        surface = {"mesh": "mesh.ply"}
    lamps = rung.render.get("lamps", [])
    given = [{key: lamp[key] for key in KNOWN if key in lamp} for lamp in lamps if lamp.get("known")]
    scene = {"glint_scene": 2 if given else 1, "name": rung.name, "units": "m", "camera": made["camera"],
             "surfaces": {"body": surface}, **({"lights": given} if given else {}), "frames": []}
    for frame in made["frames"]:
        on = frame.pop("on")
        named = {"lights_on": [lamps[k]["id"] for k in on]} if given else {}
        scene["frames"].append(dict(frame, surface="body", image=f"frames/{frame['id']}.png", **named))
    (folder / "scene.json.new").write_text(json.dumps(scene))
    os.replace(folder / "scene.json.new", folder / "scene.json")
