# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator ``snowbough.add_sway``: lets a tree sway in the wind (tree.sway)."""

import bpy
from bpy.props import FloatProperty, IntProperty

from ..tree import sway
from .editing_lock import NotWhileBaking


class SNOWBOUGH_OT_add_sway(NotWhileBaking, bpy.types.Operator):
    """Let the active armature sway in the wind, in a loop that closes exactly"""

    bl_idname = "snowbough.add_sway"
    bl_label = "Add Tree Sway"
    bl_options = {"REGISTER", "UNDO"}

    bearing: FloatProperty(
        name="Bearing",
        description="Where the wind blows to, clockwise from +Y seen from above (degrees)",
        subtype="ANGLE",
        default=1.5707964,
    )
    strength: FloatProperty(
        name="Strength",
        description="Wind speed: 1 is a fresh breeze of 9 m/s (no unit)",
        default=1.0,
        min=0.0,
        soft_max=3.0,
    )
    gusts: FloatProperty(
        name="Gusts",
        description="How much the wind's speed varies over the loop (0 to 1)",
        default=0.4,
        min=0.0,
        max=1.0,
    )
    seed: IntProperty(
        name="Seed", description="Another number gives another sway (no unit)", default=0, min=0
    )
    frame_start: IntProperty(name="First Frame", description="Where the loop begins (frames)", default=1)
    loop_frames: IntProperty(
        name="Loop Length",
        description="Time after which the sway repeats (frames)",
        default=96,
        min=8,
        soft_max=1000,
    )
    keys: IntProperty(
        name="Keys",
        description="Keys that each channel takes for the loop; the fastest limbs swing once in four (keys)",
        default=16,
        min=4,
        max=256,
    )

    @classmethod
    def ready(cls, context):
        if sway.rig_of(context.object) is None:
            cls.poll_message_set("Select a tree: its armature, or a mesh that the armature bends")
            return False
        return True

    def execute(self, context):
        rig = sway.rig_of(context.object)
        if not rig.data.bones:
            self.report({"ERROR"}, f"The armature {rig.name} has no bones to sway")
            return {"CANCELLED"}
        if rig.library or rig.data.library and not rig.override_library:
            self.report({"ERROR"}, f"{rig.name} is linked: make a library override to animate it")
            return {"CANCELLED"}
        sway.add_sway(
            rig,
            context.scene,
            self.bearing,
            self.strength,
            self.gusts,
            self.seed,
            self.frame_start,
            self.loop_frames,
            self.keys,
        )
        self.report({"INFO"}, f"{len(rig.data.bones)} bones sway in a loop of {self.loop_frames} frames")
        return {"FINISHED"}


def _draw_menu(self, _context):
    self.layout.operator(SNOWBOUGH_OT_add_sway.bl_idname, icon="FORCE_WIND")


def register():
    bpy.utils.register_class(SNOWBOUGH_OT_add_sway)
    bpy.types.VIEW3D_MT_object_animation.append(_draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object_animation.remove(_draw_menu)
    bpy.utils.unregister_class(SNOWBOUGH_OT_add_sway)
