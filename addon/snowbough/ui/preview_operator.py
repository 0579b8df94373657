# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that starts and stops the live preview."""

import bpy

from ..bake.outcome import one_line
from ..base import session
from ..preview import live
from .editing_lock import NotWhileBaking


class SNOWBOUGH_OT_toggle_preview(NotWhileBaking, bpy.types.Operator):
    """Show snow in the 3D view while the timeline plays and settings change. Nothing is baked, rendered or saved"""

    bl_idname = "snowbough.toggle_preview"
    bl_label = "Live Preview"

    @classmethod
    def refusal(cls, context):
        listed = any(receiver.object for receiver in context.scene.snowbough.receivers)
        if session.preview is None and not listed:
            return "Add receivers first: select meshes and use Add Snow to Selected"
        return None

    def execute(self, context):
        if session.preview is not None:
            live.stop()
            return {"FINISHED"}
        try:
            live.start(context.scene, context.evaluated_depsgraph_get())
        except (ValueError, RuntimeError) as error:
            return self.refuse(one_line(error))
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((SNOWBOUGH_OT_toggle_preview,))
