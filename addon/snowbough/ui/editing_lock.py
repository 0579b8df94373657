# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the artist's hands off the scene while it is baked, without taking the window away.

Blender can lock its interface during a render, but then the 3D view is not drawn any more and no button
can be pressed, the Stop button neither. So a modal operator stands before all other handlers of each window
and lets through what cannot edit: looking around (middle mouse button, wheel), Esc, copying, quitting, and
clicks on the Stop button.
"""

import bpy

from .. import session
from ..bake import engine

LOOKING = {
    "NONE",
    "MOUSEMOVE",
    "INBETWEEN_MOUSEMOVE",
    "MIDDLEMOUSE",
    "TRACKPADPAN",
    "TRACKPADZOOM",
    "MOUSEROTATE",
    "MOUSESMARTZOOM",
    "WINDOW_DEACTIVATE",
    "ESC",
}
STOP = "bpy.ops.snowbough.stop_bake("


def is_harmless(kind, ctrl):
    """Whether an event (its type, and whether Ctrl is held) can change nothing in the scene."""
    if kind in {"WHEELUPMOUSE", "WHEELDOWNMOUSE"}:
        return not ctrl  # with Ctrl the wheel changes the number under the pointer
    if kind in {"C", "Q"}:
        return ctrl
    return kind in LOOKING or kind.startswith(("TIMER", "NDOF"))


def _region_at(window, x, y):
    """(area, region) at a place of the window, or (None, None). Regions may overlap: the uppermost is last."""
    for area in window.screen.areas:
        for region in reversed(area.regions):
            if (
                region.type != "WINDOW"
                or not any(_inside(other, x, y) for other in area.regions if other != region)
            ) and _inside(region, x, y):
                return area, region
    return None, None


def _inside(region, x, y):
    return 0 <= x - region.x < region.width and 0 <= y - region.y < region.height


def _is_over_stop(context, event):
    """Whether the pointer is over a Stop button: copied as Python, as Ctrl+C does, it names its operator."""
    area, region = _region_at(context.window, event.mouse_x, event.mouse_y)
    if region is None:
        return False
    manager = context.window_manager
    before = manager.clipboard
    with context.temp_override(area=area, region=region):
        if not bpy.ops.ui.copy_python_command_button.poll():
            return False
        bpy.ops.ui.copy_python_command_button()
    over, manager.clipboard = manager.clipboard.startswith(STOP), before
    return over


class SNOWBOUGH_OT_lock_editing(bpy.types.Operator):
    bl_idname = "snowbough.lock_editing"
    bl_label = "Lock Editing"
    bl_description = "Keep the scene as it is while it is baked"
    bl_options = {"INTERNAL"}

    def invoke(self, context, _event):
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if session.bake is None:
            return {"FINISHED", "PASS_THROUGH"}
        if is_harmless(event.type, event.ctrl):
            return {"PASS_THROUGH"}
        if event.type == "LEFTMOUSE" and event.value == "PRESS" and _is_over_stop(context, event):
            engine.stop()
        return {"RUNNING_MODAL"}


class NotWhileBaking:
    """Mix-in of operators that change what a bake reads: greyed with the reason while one runs.

    A class says in ready(context) what else it needs, with poll_message_set where it is not there.
    """

    @classmethod
    def poll(cls, context):
        if session.bake is not None:
            cls.poll_message_set("A bake is running")
            return False
        return cls.ready(context)

    @classmethod
    def ready(cls, _context):
        return True


def lock(context):
    """Locks all windows until the running bake has ended."""
    for window in context.window_manager.windows:
        with context.temp_override(window=window):
            bpy.ops.snowbough.lock_editing("INVOKE_DEFAULT")


def register():
    bpy.utils.register_class(SNOWBOUGH_OT_lock_editing)


def unregister():
    bpy.utils.unregister_class(SNOWBOUGH_OT_lock_editing)
