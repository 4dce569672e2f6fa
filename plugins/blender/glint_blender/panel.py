# SPDX-License-Identifier: BSD-3-Clause
"""The tab Glint in the sidebar of the 3D view."""
import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from . import images


class GLINT_UL_frames(bpy.types.UIList):
    """Frames with the error of the model shown: of held-out ones px and percent, of training ones (pinned) what the fit leaves."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property):
        settings = context.scene.glint
        found = item.of_model(settings.shown_model)
        row = layout.row(align=True)
        if settings.training == "CHOSEN":
            row.prop(item, "train", text="")
        row = row.split(factor=0.3)
        row.label(text=item.frame_id)
        if not found:
            row.label(text="")
        elif found.get("role") == "training":
            row.label(text=f"{found['px']:.2f} px" if found.get("px") is not None else "trained", icon="PINNED")
        elif found.get("pct") is not None:
            row.label(text=f"{found['px']:.2f} px, {found['pct']:.1f} %")
        else:
            row.label(text=found.get("reason", ""), icon="ERROR")


class GLINT_MT_presets(bpy.types.Menu):
    bl_label = "Glint Presets"
    preset_subdir = "glint/run"
    preset_operator = "script.execute_preset"
    draw = bpy.types.Menu.draw_preset


class GLINT_OT_preset_add(AddPresetBase, bpy.types.Operator):
    """Add or remove a preset of models, training and settings"""
    bl_idname = "glint.preset_add"
    bl_label = "Add Glint Preset"
    preset_menu = "GLINT_MT_presets"
    preset_subdir = "glint/run"
    preset_defines = ["settings = bpy.context.scene.glint"]
    preset_values = ["settings.models", "settings.training", "settings.count", "settings.source", "settings.level",
                     "settings.more"]


class GLINT_PT_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Glint Presets"
    preset_subdir = "glint/run"
    preset_operator = "script.execute_preset"
    preset_add_operator = "glint.preset_add"


class InSidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Glint"


class GLINT_PT_main(InSidebar, bpy.types.Panel):
    bl_idname = "GLINT_PT_main"
    bl_label = "Glint"

    def draw_header_preset(self, context):
        GLINT_PT_presets.draw_panel_header(self.layout)

    def draw(self, context):
        layout, settings = self.layout, context.scene.glint
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.enabled = not settings.running
        column.prop(settings, "origin")
        if settings.origin == "FILE":
            column.prop(settings, "input")
        else:
            column.prop(settings, "surfaces")
            if settings.surfaces == "COLLECTION":
                column.prop(settings, "surface")
            column.prop(settings, "pictures")
            if settings.pictures == "FOLDER":
                column.prop(settings, "pictures_folder")
            if images.GLINT_OT_trust_pictures.poll(context):
                column.operator(images.GLINT_OT_trust_pictures.bl_idname)
        column.prop(settings, "folder")
        column.separator()
        column.label(text="Models")
        models = column.column(align=True)
        models.use_property_split = False
        models.prop(settings, "models")
        column.prop(settings, "training")
        if settings.training in ("SPREAD", "FIRST"):
            column.prop(settings, "count")
        column.prop(settings, "source")
        column.prop(settings, "level")
        column.prop(settings, "more")
        if settings.running:
            layout.prop(settings, "part", text=settings.stage or "Starting", slider=True)
            layout.operator("glint.cancel", icon="CANCEL")
        else:
            layout.operator("glint.run", icon="PLAY")
            if settings.message:
                layout.label(text=settings.message)


class GLINT_PT_frames(InSidebar, bpy.types.Panel):
    bl_idname = "GLINT_PT_frames"
    bl_parent_id = "GLINT_PT_main"
    bl_label = "Frames"

    def draw(self, context):
        layout, settings = self.layout, context.scene.glint
        layout.prop(settings, "shown_model")
        layout.template_list("GLINT_UL_frames", "", settings, "frames", settings, "active", rows=6)
        row = layout.row(align=True)
        row.operator("glint.step", text="", icon="TRIA_LEFT").by = -1
        row.operator("glint.step", text="", icon="TRIA_RIGHT").by = 1
        row.operator("glint.step", text="Worst").worst = True
        row = layout.row(align=True)
        row.operator("glint.import_results", text="Import", icon="IMPORT")
        row.operator("glint.clear_results", text="Clear", icon="TRASH")


class GLINT_PT_world(InSidebar, bpy.types.Panel):
    bl_idname = "GLINT_PT_world"
    bl_parent_id = "GLINT_PT_main"
    bl_label = "Axes and Units"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.layout, context.scene.glint
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("axis_forward", "axis_up", "scale"):
            layout.prop(settings, name)


classes = (GLINT_UL_frames, GLINT_MT_presets, GLINT_OT_preset_add, GLINT_PT_presets, GLINT_PT_main, GLINT_PT_frames,
           GLINT_PT_world)
