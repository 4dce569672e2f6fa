# SPDX-License-Identifier: BSD-3-Clause
"""Glint in Blender: where specular highlights are predicted, and which lamps make them.

The add-on needs the program `glint` and nothing else: no Python package is to be installed. docs/blender.md is its manual."""
bl_info = {
    "name": "Glint: Specular Highlights",
    "description": "Fit lamps and highlight models to frames, predict highlights, show them on the surface",
    "author": "The Glint authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, File > Export, 3D View > Sidebar > Glint",
    "category": "Import-Export",
}

import bpy

from . import export_scene, images, import_results, import_scene, panel, preferences, properties, run

MODULES = (properties, preferences, images, export_scene, import_scene, import_results, run, panel)


def register():
    for module in MODULES:
        for class_ in module.classes:
            bpy.utils.register_class(class_)
    for module in MODULES:
        if hasattr(module, "register"):
            module.register()


def unregister():
    for module in reversed(MODULES):
        if hasattr(module, "unregister"):
            module.unregister()
    for module in reversed(MODULES):
        for class_ in reversed(module.classes):
            bpy.utils.unregister_class(class_)
