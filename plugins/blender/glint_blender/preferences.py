# SPDX-License-Identifier: BSD-3-Clause
"""Where the program is."""
import bpy
from bpy.props import BoolProperty, StringProperty

from . import program
from .failures import InputError


class GlintPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    program: StringProperty(name="Program", description="The program glint; empty: the one on PATH", subtype="FILE_PATH")

    use_module: BoolProperty(name="Use the Python Module",
                             description="Run in Blender's own process by the Python module glint, where Python finds it; "
                             "the program is not needed then", default=False)

    def draw(self, context):
        layout = self.layout
        layout.prop(self, "program")
        layout.prop(self, "use_module")
        layout.operator("glint.check_program")


def uses_module(context):
    addon = context.preferences.addons.get(__package__)
    return bool(addon and addon.preferences.use_module)


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
