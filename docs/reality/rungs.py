# SPDX-License-Identifier: BSD-3-Clause
"""The rungs of the ladder, in the page's order: shared scenes, variants computed from them, and scenes that Blender renders."""
import dataclasses
import math
import pathlib

from reality import variants
from reality.verdict import RIGHT_PCT

MESH = r"mesh|bump|normals|noise of the surface"
RESPONSE = r"response|gamma|tone curve|vignett|exposure"
LAMPS = r"\blamps\b|\blights\b|another lamp"
EXTENT = r"extent|size of the l|wide l|ring|panel|window"
KNOWN = r"known|given|stated"


@dataclasses.dataclass
class Rung:
    name: str
    effect: str
    causes: str = ""  # pattern of the words that name this effect in a refusal
    later: str = ""  # effects of another issue: which; rows of this issue have ""
    border_pct: float = RIGHT_PCT
    kind: str = ""  # of a variant
    base: str = ""  # the scene it is computed from
    render: dict = None  # what Blender renders
    folder: str = ""  # of shared data
    file: str = "scene.json"
    truth: str = "contours"
    train: str = "spread:6"


EXACT = [
    Rung("checker", "checker under the highlight", r"textur|paint|pattern"),
    Rung("wood", "wood under the highlight", r"textur|paint|pattern"),
    Rung("noise1mm", "mesh with noise of 1 mm on 0.3 m", MESH, border_pct=8),
    Rung("lin8_unstated", "linear codes, response not stated", RESPONSE),
    Rung("saddle", "every highlight is cut by the border", r"border|edge of the image"),
    Rung("rough2", "two patches of roughness", r"roughness|patch"),
    Rung("coat", "coat: two lobes", r"coat|two lobes|second lobe", "coats"),
    Rung("aniso_ax", "brushed 1 : 3 about an axis", r"anisotrop|brushed", "brushed surfaces"),
    Rung("ring_ell", "ring lamp", EXTENT, "lamps with a shape"),
]
LADDER = [
    Rung("ceiling", "four equal lamps, unlabelled", LAMPS),
    Rung("plastic", "Fresnel to 75 degrees, white floor with bounces", r"Fresnel|grazing|floor", "Fresnel and bounces"),
    Rung("coat", "coat: two lobes", r"coat|two lobes|second lobe", "coats"),
    Rung("brushed", "brushed metal", r"anisotrop|brushed", "brushed surfaces"),
    Rung("panel", "square panel", EXTENT, "lamps with a shape"),
    Rung("flash", "lamp fixed to the camera", r"with the camera|moves", "lamps that move"),
    Rung("turntable", "object turns before a still lamp", r"turns|moves", "lamps that move"),
    Rung("board", "small highlights beside a board", r"small|board|pattern", "boards"),
]
CYCLES = [
    Rung("sphere", "path-traced Beckmann, nothing hard"),
    Rung("plane_to_cylinder", "sheet that bends, nothing hard"),
    Rung("vase", "turned body, nothing hard"),
    Rung("torus", "two unequal highlights"),
]
ANALYTIC = "scene-analytic.json"


def shared(data):
    """The rungs of the folders, each file of a folder on its own."""
    out = []
    for group, rungs in (("exact", EXACT), ("ladder", LADDER), ("cycles", CYCLES)):
        for rung in rungs:
            folder = pathlib.Path(data) / group / rung.name
            for file in ("scene.json", ANALYTIC):
                if file == "scene.json" or (folder / ANALYTIC).exists():
                    name = f"{group}/{rung.name}" + (" (analytic)" if file == ANALYTIC else "")
                    truth = "truth" if group == "exact" else "contours"
                    out.append(dataclasses.replace(rung, name=name, folder=str(folder), file=file, truth=truth))
    return out


def base(data, name):
    """The clean scene that variants are computed from; the codes of the ellipsoid's frames are linear."""
    data = pathlib.Path(data)
    if name == "ellipsoid":
        return variants.Base(data / "exact/lin8_unstated/scene.json", data / "exact/lin8_unstated/truth", lambda codes: codes)
    file = data / "cycles" / name / (ANALYTIC if name == "sphere" else "scene.json")
    return variants.Base(file, file.parent / "contours")


# Kind, effect, words that name it, bound, and the scenes it is computed from.
VARIANTS = [
    ("clean", "nothing: sRGB codes of 8 bits", "", RIGHT_PCT, ("ellipsoid", "sphere")),
    ("stated", "gamma 1.8, stated", "", RIGHT_PCT, ("ellipsoid", "sphere")),
    ("linear", "linear codes, not stated", RESPONSE, RIGHT_PCT, ("sphere",)),
    ("gamma18", "gamma 1.8, not stated", RESPONSE, RIGHT_PCT, ("ellipsoid", "sphere")),
    ("gamma22", "gamma 2.2, not stated", RESPONSE, RIGHT_PCT, ("ellipsoid", "sphere")),
    ("s-curve", "S-curve, not stated", RESPONSE, RIGHT_PCT, ("ellipsoid", "sphere")),
    ("tone-jpeg-exposure", "filmic curve, JPEG 85, exposure changes by a stop", RESPONSE, RIGHT_PCT, ("ellipsoid", "sphere")),
    ("vignetting", "40 % less light in the corners", RESPONSE, RIGHT_PCT, ("ellipsoid", "sphere")),
    ("clipped3", "overexposed threefold", r"clipped|saturat", RIGHT_PCT, ("ellipsoid", "sphere")),
    ("jpeg60", "JPEG 60", r"JPEG|compress", RIGHT_PCT, ("ellipsoid", "sphere")),
    ("cropped", "every highlight is cut by the border", r"border|edge of the image", RIGHT_PCT, ("ellipsoid", "sphere")),
    ("bumps", "mesh with waves of 1 mm", MESH, 8, ("ellipsoid", "vase")),
    ("large", "mesh 3 % too large", MESH + r"|scale|too large|unit", 3, ("ellipsoid", "vase")),
    ("poses", "poses turned by 0.05 degrees about the object", r"pose", RIGHT_PCT, ("ellipsoid", "vase")),
]
VARIANTS_LATER = {"poses": "poses", "large": "scale"}


def computed():
    return [Rung(f"{base}/{kind}", effect, causes, VARIANTS_LATER.get(kind, ""), border, kind=kind, base=base)
            for kind, effect, causes, border, names in VARIANTS for base in names]


LAMP = {"kind": "sphere", "position": [0.75, -0.55, 1.3], "radius": 0.01, "power": 30.0}
AREA = {"kind": "area", "position": [0.9, -0.5, 1.7], "size": [0.8, 0.8], "power": 60.0}
MIRRORING = [0.25, 0.25]  # roughness at which a lamp's shape shows


def around(count, radius, height):
    """Positions of lamps on a level circle, from the camera's side."""
    return [dict(LAMP, position=[radius * math.cos(2 * math.pi * k / count), radius * math.sin(2 * math.pi * k / count), height])
            for k in range(count)]


def dome(count=13):
    """Known distant lamps on a spiral from near the zenith to 17 degrees above the horizon; the last is a lamp of the middle."""
    out = []
    for k in range(count):
        spiral = (k + (count + 1) // 2) % count
        height, turn = 0.96 - 0.67 * spiral / (count - 1), spiral * math.pi * (3 - math.sqrt(5))
        level = math.sqrt(1 - height * height)
        out.append({"kind": "sun", "id": f"dome-{k + 1:02}", "frame": "world", "power": 3.0, "known": True, "sigma_deg": 0.1,
                    "direction": [level * math.cos(turn), level * math.sin(turn), height]})
    return out


FLASH = dict(LAMP, id="flash", frame="camera", position=[0.3, -0.12, 0.05], known=True, sigma_m=0.001)
DOME = {"lamps": dome(), "on": [[k] for k in range(13)], "eye": 0.995, "roughness": [0.45, 0.45], "diffuse": [0.02, 0.02, 0.02]}
BALL = dict(DOME, semi_axes=[0.13, 0.13, 0.13])

# Each: material {lobe, roughness, ...}, lamps, floor; what is not said is the default of docs/reality/render.py.
RENDERED = [
    Rung("plain", "nothing hard", render={}),
    Rung("checker", "checker under the highlight", r"textur|paint|pattern", render={"texture": "checker"}),
    Rung("wood", "wood under the highlight", r"textur|paint|pattern", render={"texture": "wood"}),
    Rung("six-lamps", "six equal lamps, unlabelled", LAMPS, render={"lamps": around(6, 0.9, 1.3)}),
    Rung("fresnel", "Fresnel, F0 0.04, incidence of 55 to 70 degrees", r"Fresnel|grazing", "Fresnel and bounces",
         render={"fresnel": 0.5, "eye": 0.35, "lamps": [dict(LAMP, position=[-0.85, 1.0, 0.5])]}),
    Rung("coat", "coat: two lobes", r"coat|two lobes|second lobe", "coats", render={"coat": [0.3, 0.6]}),
    Rung("brushed", "brushed about z", r"anisotrop|brushed", "brushed surfaces", render={"anisotropy": 0.6}),
    Rung("roughness-varies", "roughness from 0.35 to 0.5 over the body", r"roughness|patch", render={"roughness": [0.35, 0.5]}),
    Rung("square-panel", "square panel", EXTENT, "lamps with a shape", render={"lamps": [AREA], "roughness": MIRRORING}),
    Rung("oblong-panel", "panel 1 : 4", EXTENT, "lamps with a shape",
         render={"lamps": [dict(AREA, size=[0.3, 1.2])], "roughness": MIRRORING}),
    Rung("window", "window at infinity", EXTENT, "lamps with a shape",
         render={"lamps": [dict(AREA, position=[30.0, -20.0, 45.0], size=[10.0, 15.0], power=60000.0)], "roughness": MIRRORING}),
    Rung("ring", "ring lamp", EXTENT, "lamps with a shape",
         render={"lamps": [dict(AREA, kind="ring", radius=0.4)], "roughness": MIRRORING}),
    Rung("white-floor", "white floor, two bounces", r"floor|bounce|reflect", "Fresnel and bounces", render={"floor": True}),
    Rung("dome-ball", "13 known distant lamps, one in each photograph, still camera", KNOWN, render=BALL,
         train="0-11"),
    Rung("dome-mesh", "the same over a mesh with broad waves", KNOWN, render=dict(DOME, waves=0.08), train="0-11"),
    Rung("known-flash", "known lamp fixed to the camera", KNOWN, render={"lamps": [FLASH]}),
    Rung("flash-and-lamp", "a flash on the camera beside a lamp that stands still, unlabelled", r"both kinds|with the camera",
         render={"lamps": [dict(LAMP, position=[-0.7, 0.7, 1.1], power=60.0),
                           dict(LAMP, frame="camera", position=[0.25, -0.12, 0.05])], "roughness": [0.36, 0.36]}),
    Rung("flash-waves", "an unknown lamp fixed to the camera, over a mesh with broad waves", r"with the camera|moves",
         render={"lamps": [dict(LAMP, frame="camera", position=[-0.16, 0.24, -0.06])], "waves": 0.08}),
    Rung("dome-three", "three known distant lamps in each photograph, still camera", KNOWN, train="0-11",
         render=dict(BALL, on=[[k, (k + 1) % 13, (k + 7) % 13] for k in range(13)], roughness=[0.39, 0.39])),
]


def rendered():
    return [dataclasses.replace(rung, name=f"rendered/{rung.name}", truth="truth") for rung in RENDERED]
