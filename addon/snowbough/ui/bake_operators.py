# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators ``snowbough.bake``, ``snowbough.stop_bake`` and ``snowbough.free_bake``."""

from pathlib import Path

import bpy

from ..bake import cache_place, engine, from_scene, outcome
from ..base import session
from ..base.names import counted, sized
from ..cache import versions
from ..cache.errors import CacheError
from ..cache.files import MANIFEST
from ..result import displacement
from . import editing_lock
from .text import wrapped

POPUP_LETTERS = 80
DIALOG_WIDTH = 520


def _finished_in_window(running):
    session.last_outcome = outcome.describe(running)
    scene = bpy.data.scenes.get(running.job.request.scene_name)
    if scene is not None:
        session.last_outcome = outcome.conclude(scene, running)
        # The bake gets its own undo step; otherwise Undo would also revert the action before it.
        bpy.ops.ed.undo_push(message=SNOWBOUGH_OT_bake.bl_label)
    severity, text = session.last_outcome
    if severity == "ERROR":

        def draw(self, _context):
            for part in wrapped(text, lambda line: len(line) <= POPUP_LETTERS):
                self.layout.label(text=part)

        bpy.context.window_manager.popup_menu(draw, title="Snowbough", icon="ERROR")


class SNOWBOUGH_OT_bake(editing_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.bake"
    bl_label = "Bake Snow"
    bl_description = (
        "Simulate the snowfall over the shot and write one height map per receiver and frame. "
        "Esc stops after the current frame and keeps the finished frames"
    )
    bl_options = {"REGISTER"}

    resume: bpy.props.BoolProperty(
        name="Resume",
        description="Continue a stopped bake from its last checkpoint",
        default=False,
    )

    extend: bpy.props.BoolProperty(
        name="Continue",
        description="Add the frames by which the shot was made longer to a finished bake. Its frames stay as they are; "
        "over the new ones, the snow grows from the depth that it has to End Depth",
        default=False,
    )

    @classmethod
    def description(cls, _context, properties):
        return cls.bl_rna.properties["extend"].description if properties.extend else cls.bl_description

    @classmethod
    def refusal(cls, context):
        listed = any(entry.object for entry in context.scene.snowbough.receivers)
        return None if listed else "Add snow to objects first"

    def _prepare(self, context):
        request = from_scene.make_request(context.scene, resume=self.resume, extend=self.extend)
        return from_scene.prepare_bake(context.scene, request)

    def invoke(self, context, _event):
        try:
            engine.start(context, self._prepare(context), _finished_in_window)
            editing_lock.lock(context)
        except (ValueError, RuntimeError) as error:
            return self._refuse(error)
        return {"FINISHED"}

    def execute(self, context):
        try:
            running = self._prepare(context)
            if bpy.app.background:  # there is no progress bar: print one line per frame
                running.on_frame = lambda _result: print(f"Snowbough: baked {running.status()}", flush=True)
                running.on_surfaces = engine.seldom(
                    lambda: print(f"Snowbough: {running.status()}", flush=True)
                )
            engine.run(context, running)
        except (ValueError, RuntimeError) as error:
            return self._refuse(error)
        session.last_outcome = outcome.conclude(context.scene, running)
        self.report({session.last_outcome[0]}, session.last_outcome[1])
        return {"CANCELLED"} if running.error or running.cancelled else {"FINISHED"}

    def _refuse(self, error):
        session.last_outcome = ("ERROR", outcome.one_line(error))
        return self.refuse(session.last_outcome[1])


class SNOWBOUGH_OT_stop_bake(bpy.types.Operator):
    bl_idname = "snowbough.stop_bake"
    bl_label = "Stop Baking"
    bl_description = "Stop after the current frame and keep the finished frames"

    @classmethod
    def poll(cls, _context):
        if session.bake is None:
            cls.poll_message_set("No bake is running")
            return False
        return True

    def execute(self, _context):
        engine.stop()
        return {"FINISHED"}


def _removal_texts(scene):
    """Describes what Free Bake would remove, one text per folder."""
    texts = []
    for found in cache_place.own_bakes(scene):
        if found.count:
            texts.append(f"Remove {counted(found.count, 'file')} ({sized(found.size)}) from {found.root}")
        texts += found.skipped
    return texts or ["The cache has no bake of this scene and file: nothing is removed"]


class SNOWBOUGH_OT_free_bake(editing_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.free_bake"
    bl_label = "Free Bake"
    bl_description = (
        "Delete all baked files of this scene from the cache, after showing the folder and the size. "
        "Undo does not restore the files"
    )
    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context, _event):
        try:
            self._questions = _removal_texts(context.scene)
        except (CacheError, OSError) as error:
            return self.refuse(outcome.one_line(error))
        return context.window_manager.invoke_props_dialog(self, width=DIALOG_WIDTH)

    def draw(self, _context):
        for text in self._questions:
            for part in wrapped(text, lambda line: len(line) <= POPUP_LETTERS):
                self.layout.label(text=part)

    def execute(self, context):
        scene = context.scene
        try:
            texts = _removal_texts(scene)
            bakes = cache_place.own_bakes(scene)
            removed = sum(map(versions.free, bakes))
        except (CacheError, OSError) as error:
            return self.refuse(outcome.one_line(error))
        for entry in scene.snowbough.receivers:
            if entry.folder and not (Path(bpy.path.abspath(entry.folder)) / MANIFEST).is_file():
                entry.folder = entry.baked_as = ""
                if entry.object is not None:
                    displacement.refresh(scene, entry)
        if not cache_place.own_bakes(scene):
            scene.snowbough.cache_scene = ""
        kept = [
            f"{path} has changed since its bake, or is not from it: it stays"
            for own in bakes
            for path in own.kept
        ]
        for text in kept if removed else texts:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, f"Removed {counted(removed, 'file')}")
        return {"FINISHED"}


CLASSES = (SNOWBOUGH_OT_bake, SNOWBOUGH_OT_stop_bake, SNOWBOUGH_OT_free_bake)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
