# SPDX-License-Identifier: BSD-3-Clause
"""Where the program is."""
import bpy
from bpy.props import StringProperty

from . import program
from .failures import InputError


class GlintPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: StringProperty(name="Program", description="The program glint; empty: the one on PATH", subtype="FILE_PATH")

    def draw(self, context):
        layout = self.layout
        layout.prop(self, "program")
        layout.operator("glint.check_program")


def program_path(context):
    """Absolute path of the program, checked; InputError with what to do."""
    addon = context.preferences.addons.get(__package__)
    found = program.find(bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else "")
    program.version_of(found)
    return found


class GLINT_OT_check_program(bpy.types.Operator):
    """Find the program glint and ask for its version"""
    bl_idname = "glint.check_program"
    bl_label = "Check Program"

    def execute(self, context):
        try:
            found = program_path(context)
        except InputError as e:
            self.report({"ERROR"}, str(e))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{found}: version {'.'.join(map(str, program.version_of(found)))}")
        return {"FINISHED"}


classes = (GlintPreferences, GLINT_OT_check_program)
