# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator ``snowbough.add_sway``: animates a tree in the wind (tree.sway)."""

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from ..base.names import counted
from ..tree import sway
from .editing_lock import NotWhileBaking


class SNOWBOUGH_OT_add_sway(NotWhileBaking, bpy.types.Operator):
    """Animate the active armature in the wind, as a seamless loop"""

    bl_idname = "snowbough.add_sway"
    bl_label = "Add Tree Sway"
    bl_options = {"REGISTER", "UNDO"}

    bearing: FloatProperty(
        name="Bearing",
        description="Direction that the wind blows to, clockwise from +Y seen from above (degrees)",
        subtype="ANGLE",
        default=1.5707964,
    )
    force: EnumProperty(
        name="Force",
        description="Strength and Gusts of the wind",
        items=(
            ("BREEZE", "Breeze", "Tips swing by 2 % of their limb's length"),
            ("WIND", "Wind", "Tips swing by 5 % of their limb's length"),
            ("STORM", "Storm", "Tips swing by 12 % of their limb's length, in strong gusts"),
            ("OWN", "Own Values", "Use the values of Strength and Gusts"),
        ),
        default="WIND",
    )
    strength: FloatProperty(
        name="Strength",
        description="Swing of a limb's tip: at 1 by 5 % of the limb's length, whatever the tree and its bones. Higher "
        "values bend the branches more",
        default=1.0,
        min=0.0,
        soft_max=3.0,
    )
    gusts: FloatProperty(
        name="Gusts",
        description="Variation of the wind speed over the loop (0 to 1)",
        default=0.4,
        min=0.0,
        max=1.0,
    )
    seed: IntProperty(name="Seed", description="Random seed; each value gives another sway", default=0, min=0)
    frame_start: IntProperty(name="First Frame", description="First frame of the loop (frames)", default=1)
    loop_frames: IntProperty(
        name="Loop Length",
        description="Length of the loop, after which the sway repeats (frames)",
        default=96,
        min=8,
        soft_max=1000,
    )
    keys: IntProperty(
        name="Keys",
        description="Number of keyframes per channel in the loop. A swing needs at least four (keys)",
        default=16,
        min=4,
        max=256,
    )

    @classmethod
    def refusal(cls, context):
        if sway.rig_of(context.object) is None:
            return "Select a tree: its armature, or a mesh that the armature deforms"
        return None

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in self.bl_rna.properties.keys():
            if name != "rna_type" and (self.force == "OWN" or name not in ("strength", "gusts")):
                layout.prop(self, name)

    def _force(self):
        """(strength, gusts). Scripts may set these without Force."""
        given = any(map(self.properties.is_property_set, ("strength", "gusts")))
        if self.force == "OWN" or given and not self.properties.is_property_set("force"):
            return self.strength, self.gusts
        return sway.FORCES[self.force]

    def execute(self, context):
        rig = sway.rig_of(context.object)
        if not rig.data.bones:
            return self.refuse(f"The armature {rig.name} has no bones")
        if rig.library or rig.data.library and not rig.override_library:
            return self.refuse(f"{rig.name} is linked: make a library override to animate it")
        sway.add_sway(
            rig,
            context.scene,
            self.bearing,
            *self._force(),
            self.seed,
            self.frame_start,
            self.loop_frames,
            self.keys,
        )
        bones, frames = counted(len(rig.data.bones), "bone"), counted(self.loop_frames, "frame")
        self.report({"INFO"}, f"Animated {bones} in a loop of {frames}")
        return {"FINISHED"}


def _draw_menu(self, _context):
    self.layout.operator(SNOWBOUGH_OT_add_sway.bl_idname, icon="FORCE_WIND")


def register():
    bpy.utils.register_class(SNOWBOUGH_OT_add_sway)
    bpy.types.VIEW3D_MT_object_animation.append(_draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object_animation.remove(_draw_menu)
    bpy.utils.unregister_class(SNOWBOUGH_OT_add_sway)
