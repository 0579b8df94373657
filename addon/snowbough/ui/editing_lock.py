# SPDX-License-Identifier: GPL-3.0-or-later
"""Prevents edits of the scene during a bake, without blocking the window.

Blender can lock its interface during a render, but then the 3D view is not redrawn and the Stop button does not work.
Instead, a modal operator handles the events of each window first. It passes only events that cannot edit: navigation
(middle mouse button, wheel), Esc, Copy, Quit, and clicks on the Stop button.
"""

import bpy

from ..bake import engine
from ..base import session

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
    """True if an event of this type cannot change the scene. ctrl: whether Ctrl is held."""
    if kind in {"WHEELUPMOUSE", "WHEELDOWNMOUSE"}:
        return not ctrl  # with Ctrl the wheel changes the number under the pointer
    if kind in {"C", "Q"}:
        return ctrl
    return kind in LOOKING or kind.startswith(("TIMER", "NDOF"))


def _region_at(window, x, y):
    """(area, region) at a window position, or (None, None). Regions may overlap; the topmost is the last."""
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
    """True if the pointer is over a Stop button: the button's Python command names its operator."""
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
    bl_description = "Prevent edits of the scene during a bake"
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
    """Mix-in for operators that change what a bake reads: disabled, with the reason, while a bake runs.

    A subclass overrides refusal(context), which returns why the operator cannot run, or None.
    """

    @classmethod
    def poll(cls, context):
        reason = "A bake is running" if session.bake is not None else cls.refusal(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    @classmethod
    def refusal(cls, _context):
        return None

    def refuse(self, error):
        """Reports an error, and returns what a cancelled operator returns."""
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}


def lock(context):
    """Locks all windows until the running bake ends."""
    for window in context.window_manager.windows:
        with context.temp_override(window=window):
            bpy.ops.snowbough.lock_editing("INVOKE_DEFAULT")


register, unregister = bpy.utils.register_classes_factory((SNOWBOUGH_OT_lock_editing,))
