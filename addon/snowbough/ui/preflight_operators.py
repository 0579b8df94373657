# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that check the scene before a bake and fix problems."""

import bpy

from ..bake import preflight
from ..bake.outcome import one_line
from ..base import session
from ..base.names import counted
from ..scene import uv_maps
from .editing_lock import NotWhileBaking


class SNOWBOUGH_OT_preflight(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.preflight"
    bl_label = "Check Scene"
    bl_description = (
        "Find problems before a bake: UV maps, visibility, scale, map sizes, cache, disk and memory"
    )
    bl_options = {"REGISTER"}

    def execute(self, context):
        issues = preflight.check(context.scene, context.evaluated_depsgraph_get())
        session.issues[context.scene.name] = issues
        counts = [
            counted(sum(issue.severity == kind.upper() for issue in issues), kind)
            for kind in ("error", "warning")
        ]
        self.report({"INFO"}, ", ".join(counts))
        return {"FINISHED"}


class SNOWBOUGH_OT_fix(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.fix"
    bl_label = "Fix"
    bl_description = "Fix this problem, then check again"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.StringProperty(name="Kind", description="Problem to fix", options={"HIDDEN"})
    object_name: bpy.props.StringProperty(
        name="Object", description="Receiver that has the problem", options={"HIDDEN"}
    )

    def execute(self, context):
        if self.kind == "SAVE":
            return bpy.ops.wm.save_as_mainfile("INVOKE_DEFAULT")
        if self.kind == "BAKE_SIMULATIONS":
            bpy.ops.ptcache.bake_all(bake=True)
            return bpy.ops.snowbough.preflight()
        entries = [entry for entry in context.scene.snowbough.receivers if entry.object is not None]
        entry = next((entry for entry in entries if entry.object.name == self.object_name), None)
        if entry is None:
            return self.refuse(f"'{self.object_name}' is not a receiver any more: check again")
        try:
            if self.kind == "SHOW_IN_RENDER":
                entry.object.hide_render = False
            elif self.kind == "UNWRAP":
                clean = uv_maps.clean_uv_map(entry.object.data)
                entry.uv_map = clean or uv_maps.make_uv_map(context, entry.object)
        except (ValueError, RuntimeError) as error:
            return self.refuse(one_line(error))
        return bpy.ops.snowbough.preflight()


CLASSES = (SNOWBOUGH_OT_preflight, SNOWBOUGH_OT_fix)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
