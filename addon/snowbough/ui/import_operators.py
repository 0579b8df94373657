# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator ``import_scene.xfrog_tree``: an OBJ tree as one rigged, weighted, unwrapped mesh (tree.import_tree).

In a window a second operator does the work, on a thread of its own, so that the window stays alive and Esc stops it.
"""

import threading
from dataclasses import asdict
from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import compat, native
from ..tree import import_tree
from ..tree.import_options import ImportProperties, options_of


def _tell(operator, report):
    for text in report["warnings"][:5]:
        operator.report({"WARNING"}, text)
    if len(report["warnings"]) > 5:
        operator.report(
            {"WARNING"}, f"and {len(report['warnings']) - 5} more: see the collection's custom property"
        )
    operator.report({"INFO"}, import_tree.summary(report))


class _Job:
    """read_native on a thread of its own: it gets plain values and gives back native data only."""

    def __init__(self, path, options):
        self.share, self.tree, self.error = 0.0, None, None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(path, options), daemon=True)
        native.load()  # on the main thread: a missing module is told at once
        self._thread.start()

    def _progress(self, share):
        self.share = share
        return not self._stop.is_set()

    def _run(self, path, options):
        try:
            self.tree = import_tree.read_native(path, options, self._progress)
        except (ValueError, RuntimeError, OSError, MemoryError, KeyboardInterrupt) as error:
            self.error = error

    def running(self):
        return self._thread.is_alive()

    def stop(self):
        self._stop.set()
        self._thread.join()


class IMPORT_SCENE_OT_xfrog_tree(ImportProperties, bpy.types.Operator, ImportHelper):
    """Import a tree that Xfrog or a similar modeller exported, as one continuous, rigged mesh"""

    bl_idname = "import_scene.xfrog_tree"
    bl_label = "Import Xfrog Tree"
    bl_options = {"PRESET", "UNDO"}

    filename_ext = ".obj"
    filter_glob: StringProperty(
        name="File Names", description="Files that the browser shows", default="*.obj", options={"HIDDEN"}
    )

    def invoke(self, context, event):
        # A file dropped onto the window comes with its path: only the options are asked for.
        self._in_window = True
        if self.properties.is_property_set("filepath") and Path(self.filepath).is_file():
            return context.window_manager.invoke_props_dialog(self)
        return ImportHelper.invoke(self, context, event)

    def execute(self, context):
        if getattr(self, "_in_window", False) and context.window is not None and not bpy.app.background:
            # A job of its own keeps the window alive and listens to Esc.
            values = asdict(options_of(self))
            bpy.ops.snowbough.import_tree_job("INVOKE_DEFAULT", filepath=self.filepath, **values)
            return {"FINISHED"}
        try:
            _collection, report = import_tree.import_file(context, self.filepath, options_of(self))
        except KeyboardInterrupt:
            self.report({"WARNING"}, "The import was stopped; nothing was changed")
            return {"CANCELLED"}
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            self.report({"ERROR"}, import_tree.message(error))
            return {"CANCELLED"}
        _tell(self, report)
        return {"FINISHED"}


class SNOWBOUGH_OT_import_tree_job(ImportProperties, bpy.types.Operator):
    """Read a tree while the window stays alive; Esc stops it and leaves everything as it was"""

    bl_idname = "snowbough.import_tree_job"
    bl_label = "Import Xfrog Tree"
    bl_options = {"INTERNAL", "UNDO"}

    filepath: StringProperty(options={"SKIP_SAVE"})

    def invoke(self, context, _event):
        self._options = options_of(self)
        try:
            self._job = _Job(self.filepath, self._options)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        context.workspace.status_text_set(f"Reading {Path(self.filepath).name} (Esc: stop)")
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"WARNING"}, "The import was stopped; nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        context.window_manager.progress_update(100 * self._job.share)
        if self._job.running():
            return {"RUNNING_MODAL"}
        self._end(context)
        if self._job.error is not None:
            self.report({"ERROR"}, import_tree.message(self._job.error))
            return {"CANCELLED"}
        try:
            import_tree.create_tree(context, Path(self.filepath).stem, self._job.tree, self._options)
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            self.report({"ERROR"}, import_tree.message(error))
            return {"CANCELLED"}
        _tell(self, self._job.tree.report)
        return {"FINISHED"}

    def cancel(self, context):
        self._job.stop()
        self._end(context)

    def _end(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


def _draw_menu(self, _context):
    self.layout.operator(IMPORT_SCENE_OT_xfrog_tree.bl_idname, text="Xfrog Tree (.obj)")


CLASSES = (IMPORT_SCENE_OT_xfrog_tree, SNOWBOUGH_OT_import_tree_job)
_file_handlers = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_import.append(_draw_menu)
    _file_handlers.append(
        compat.register_file_handler(
            "SNOWBOUGH_FH_xfrog_tree", "Xfrog Tree", IMPORT_SCENE_OT_xfrog_tree.bl_idname, ".obj"
        )
    )


def unregister():
    compat.unregister_file_handler(_file_handlers.pop())
    bpy.types.TOPBAR_MT_file_import.remove(_draw_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
