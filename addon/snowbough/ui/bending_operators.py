# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators ``snowbough.bend_under_snow`` and ``snowbough.remove_bend``, and their panel."""

import bpy

from ..base import native, session
from ..bending import bend, keys
from ..settings.bending import OWN_WOOD
from ..tree import sway
from . import panel_parts
from .editing_lock import NotWhileBaking

SELECT = "Select a tree: its armature, or a mesh that the armature deforms"


class SNOWBOUGH_OT_bend_under_snow(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.bend_under_snow"
    bl_label = "Bend under Snow"
    bl_description = (
        "Simulate the snow of the shot on the active tree and keyframe its armature so that it bends under the load. "
        "Adds to sway and other motion. Bake afterwards"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context):
        return None if sway.rig_of(context.object) is not None else SELECT

    def execute(self, context):
        try:
            report = bend.bend_under_snow(context, sway.rig_of(context.object))
        except (ValueError, RuntimeError) as error:
            return self.refuse(native.error_text(error))
        self.report({"WARNING" if report.broken else "INFO"}, report.text())
        return {"FINISHED"}


class SNOWBOUGH_OT_remove_bend(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.remove_bend"
    bl_label = "Remove Bend"
    bl_description = "Remove the keyframes of Bend under Snow from the active tree. All other animation stays"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context):
        rig = sway.rig_of(context.object)
        if rig is None:
            return SELECT
        return None if keys.bend_of(rig)[0] is not None else "The tree is not bent"

    def execute(self, context):
        keys.remove(sway.rig_of(context.object))
        return {"FINISHED"}


class SNOWBOUGH_PT_bending(bpy.types.Panel):
    bl_label = "Bend under Snow"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Snowbough"
    bl_parent_id = "SNOWBOUGH_PT_tree"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return sway.rig_of(context.object) is not None

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.enabled = session.bake is None
        rig = sway.rig_of(context.object)
        settings = rig.snowbough.bending
        column = layout.column(align=True)
        names = ["weight", "snow_density", "species"]
        names += ["wood_stiffness", "wood_strength"] if settings.species == OWN_WOOD else []
        for name in names:
            column.prop(settings, name, text=panel_parts.setting_label(settings, name))
        column = layout.column(align=True)
        column.operator("snowbough.bend_under_snow", icon="MOD_SIMPLEDEFORM")
        _track, action = keys.bend_of(rig)
        if action is not None:
            column.operator("snowbough.remove_bend", icon="X")
            panel_parts.draw_text(layout.column(align=True), context, action[keys.REPORT], "INFO")


CLASSES = (SNOWBOUGH_OT_bend_under_snow, SNOWBOUGH_OT_remove_bend, SNOWBOUGH_PT_bending)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
