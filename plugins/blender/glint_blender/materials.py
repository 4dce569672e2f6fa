# SPDX-License-Identifier: BSD-3-Clause
"""Glint's roughness as a Blender material.

Glint's m is the width of the lobe: exp(-tan^2(theta_h) / m^2) of torrance-sparrow (Beckmann), the alpha of ggx. The Roughness of Blender's shaders
is its square root: alpha = roughness^2."""
import math

import bpy

# Lobes that Blender has. The two others become Beckmann with the same fall near the peak, and the material says so.
DISTRIBUTIONS = {"torrance-sparrow": "BECKMANN", "ggx": "GGX", "blinn-phong": "BECKMANN", "phong": "BECKMANN"}


def roughness_of(m):
    """Blender's Roughness for Glint's m; m above 1 has none."""
    return math.sqrt(min(max(m, 0.0), 1.0))


def glossy_type():
    """The glossy node: Blender 4.0 merged it with the anisotropic one."""
    return "ShaderNodeBsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy") else "ShaderNodeBsdfAnisotropic"


def material(name, lobe, m, strength=0.5, diffuse=(0.0, 0.0, 0.0)):
    """A material with the lobe that was fitted, without Fresnel's factor (no fit knows it), over a Lambert base of this colour.

    strength: colour of the glossy node, which highlights do not tell apart from the lamp's power."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made["glint_lobe"], made["glint_roughness"] = lobe, m
    tree = made.node_tree
    tree.nodes.clear()
    glossy = tree.nodes.new(glossy_type())
    glossy.distribution = DISTRIBUTIONS.get(lobe, "BECKMANN")
    glossy.inputs["Color"].default_value = (strength, strength, strength, 1.0)
    glossy.inputs["Roughness"].default_value = roughness_of(m)
    base = tree.nodes.new("ShaderNodeBsdfDiffuse")
    base.inputs["Color"].default_value = (*diffuse, 1.0)
    both = tree.nodes.new("ShaderNodeAddShader")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(base.outputs[0], both.inputs[0])
    tree.links.new(glossy.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], output.inputs["Surface"])
    for i, node in enumerate((base, glossy, both, output)):
        node.location = (220 * max(0, i - 1), -160 * (i == 1))
    return made


def plain(name, colour):
    """A material for objects that show results: one colour, translucent in the viewport. Made once."""
    made = bpy.data.materials.get(name)
    if made is None:
        made = bpy.data.materials.new(name)
        made.diffuse_color = colour
    return made
