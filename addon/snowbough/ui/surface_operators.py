# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator ``snowbough.update_surface``."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import bpy

from ..base import native
from ..base.names import counted
from ..cache.errors import CacheError
from ..result import surface_preview
from ..surface import compute
from ..surface.side_by_side import run_side_by_side
from .editing_lock import NotWhileBaking

POLL_SECONDS = 0.05
FAILURES = (ValueError, CacheError, RuntimeError, OSError, MemoryError)


class _Update:
    """Computes surfaces in a background thread, from plain data."""

    def __init__(self, module, tasks):
        self.receivers = [receiver.object.name for receiver, _, _ in tasks]
        self._jobs = [partial(compute.update, module, folder, style) for _, folder, style in tasks]
        self.share = 0.0
        self.stop = False
        self.error = None

    def run(self):
        def progress(share):
            self.share = share
            return not self.stop

        try:
            run_side_by_side(self._jobs, progress)
        except FAILURES as error:
            self.error = error


class SNOWBOUGH_OT_update_surface(NotWhileBaking, bpy.types.Operator):
    """Compute the snow surfaces of all frames with the current sliders, without simulating. Esc stops"""

    bl_idname = "snowbough.update_surface"
    bl_label = "Update Surface"
    bl_options = {"REGISTER"}

    @classmethod
    def refusal(cls, context):
        baked = any(entry.folder for entry in context.scene.snowbough.receivers)
        return None if baked else "Bake the snow first"

    def _begin(self, context):
        tasks = surface_preview.tasks(context.scene)
        if not tasks:
            raise ValueError(
                "No receiver shows its snow as a surface: choose Displacement > Snow Surface first"
            )
        return _Update(native.load(), tasks)

    def _end(self, context, update):
        scene = context.scene
        surface_preview.refresh(scene, [entry for entry in scene.snowbough.receivers if entry.folder])
        if update.error is not None:
            return self.refuse(update.error)
        if update.stop:
            self.report({"WARNING"}, "Stopped. Unfinished surfaces are unchanged")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Updated the surfaces of {counted(len(set(update.receivers)), 'receiver')}")
        return {"FINISHED"}

    def execute(self, context):
        try:
            update = self._begin(context)
        except FAILURES as error:
            return self.refuse(error)
        update.run()
        return self._end(context, update)

    def invoke(self, context, _event):
        try:
            self._update = self._begin(context)
        except FAILURES as error:
            return self.refuse(error)
        worker = ThreadPoolExecutor(1, "snowbough-surface")
        self._running = worker.submit(self._update.run)
        worker.shutdown(wait=False)
        manager = context.window_manager
        manager.progress_begin(0.0, 1.0)
        self._timer = manager.event_timer_add(POLL_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        update = self._update
        if event.type == "ESC":
            update.stop = True
        if event.type != "TIMER" or not self._running.done():
            context.window_manager.progress_update(update.share)
            return {"RUNNING_MODAL"} if event.type in {"ESC", "TIMER"} else {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        self._running.result()
        outcome = self._end(context, update)
        if outcome == {"FINISHED"}:
            bpy.ops.ed.undo_push(message=self.bl_label)
        return outcome


register, unregister = bpy.utils.register_classes_factory((SNOWBOUGH_OT_update_surface,))
