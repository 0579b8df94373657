# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators ``import_scene.xfrog_tree``: imports OBJ trees as rigged, weighted, unwrapped meshes (tree.import_tree);
and ``snowbough.build_tree_from_selected``: builds them from mesh objects (tree.selected_meshes).

In a window, a second operator does the work in a background thread, so the window stays responsive and Esc stops it.
"""

import threading
from dataclasses import asdict
from pathlib import Path

import bpy
from bpy.props import CollectionProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..base import compat, native
from ..base.names import FAILURES
from ..tree import import_tree, selected_meshes
from ..tree.import_options import ImportProperties
from ..tree.import_tree import REPORT_PROPERTY
from .editing_lock import NotWhileBaking
from .import_panels import draw_sections


def _report_import(operator, reports, failures):
    """Reports the import: all warnings of one tree, one summary of several."""
    texts = [failure.text() for failure in failures]
    several = len(reports) + len(failures) > 1
    for report in reports:
        texts += [
            f"{report['file']}: {text}" if several else text for text in import_tree.warning_lines(report)
        ]
    for text in texts[:5]:
        operator.report({"WARNING"}, text)
    if len(texts) > 5:
        operator.report(
            {"WARNING"},
            f"{len(texts) - 5} more warnings are in the collections' custom property {REPORT_PROPERTY}",
        )
    summary = import_tree.summary_of_all(reports, failures) if several else import_tree.summary(reports[0])
    operator.report({"INFO"}, summary)


def _refuse(operator, failures):
    """Reports that nothing was imported."""
    for failure in failures:
        operator.report({"ERROR"}, failure.text())
    return {"CANCELLED"}


class _Job:
    """Runs read_files in a background thread, which takes plain values and returns native data only."""

    def __init__(self, paths, options, units):
        self.share, self.trees, self.failures, self.error = 0.0, [], [], None
        self._stop = False
        self._thread = threading.Thread(target=self._run, args=(paths, options, units), daemon=True)
        native.load()  # on the main thread, so that a missing module is reported at once
        self._thread.start()

    def _progress(self, share):
        self.share = share
        return not self._stop

    def _run(self, paths, options, units):
        try:
            self.trees, self.failures = import_tree.read_files(paths, options, self._progress, units)
        except KeyboardInterrupt as error:
            self.error = error

    def running(self):
        return self._thread.is_alive()

    def stop(self):
        self._stop = True
        self._thread.join()


class _Files:
    """Mix-in: the files to import, as Blender's file browser passes them."""

    directory: StringProperty(
        name="Folder", description="Folder of Files", subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"}
    )
    files: CollectionProperty(
        name="Files",
        description="Names of files in Folder, to import several files instead of one path",
        type=bpy.types.OperatorFileListElement,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    def chosen(self):
        """The chosen paths. Raises ValueError if there are none."""
        return import_tree.chosen_files(self.filepath, self.directory, [file.name for file in self.files])

    def import_now(self, context):
        try:
            made, failures = import_tree.import_files(context, self.chosen(), import_tree.options_from(self))
        except KeyboardInterrupt:
            self.report({"WARNING"}, "The import was stopped; nothing was changed")
            return {"CANCELLED"}
        except FAILURES as error:
            self.report({"ERROR"}, import_tree.message(error))
            return {"CANCELLED"}
        if not made:
            return _refuse(self, failures)
        _report_import(self, [report for _collection, report in made], failures)
        return {"FINISHED"}


class IMPORT_SCENE_OT_xfrog_tree(ImportProperties, _Files, bpy.types.Operator, ImportHelper):
    """Import a tree from Xfrog or a similar modeller as one continuous, rigged mesh"""

    bl_idname = "import_scene.xfrog_tree"
    bl_label = "Import Xfrog Tree"
    # In a window the job pushes the undo step; a script pushes its own.
    bl_options = {"PRESET"}

    filename_ext = ".obj"
    filter_glob: StringProperty(
        name="File Names",
        description="Pattern of the file names that the browser shows",
        default="*.obj",
        options={"HIDDEN"},
    )

    def draw(self, context):
        # The file browser shows the panels of ui.import_panels instead.
        if context.space_data is None or context.space_data.type != "FILE_BROWSER":
            draw_sections(self.layout, self)

    def invoke(self, context, event):
        # Dropped files come with their paths: ask for the options only.
        self._in_window = True
        dropped = self.properties.is_property_set("filepath") and Path(self.filepath).is_file()
        if dropped or any(file.name for file in self.files):
            return context.window_manager.invoke_props_dialog(self)
        return ImportHelper.invoke(self, context, event)

    def execute(self, context):
        if getattr(self, "_in_window", False) and context.window is not None and not bpy.app.background:
            # A separate job keeps the window responsive, handles Esc, and can be adjusted afterwards.
            try:
                files = [{"name": str(path)} for path in self.chosen()]
            except (ValueError, OSError) as error:
                self.report({"ERROR"}, str(error))
                return {"CANCELLED"}
            bpy.ops.snowbough.import_tree_job(
                "INVOKE_DEFAULT", files=files, **asdict(import_tree.options_from(self))
            )
            return {"FINISHED"}
        return self.import_now(context)


class SNOWBOUGH_OT_import_tree_job(ImportProperties, _Files, bpy.types.Operator):
    """Import trees in the background; Esc stops the import and changes nothing"""

    bl_idname = "snowbough.import_tree_job"
    bl_label = "Import Tree"
    bl_options = {"INTERNAL", "REGISTER", "UNDO"}

    filepath: StringProperty(options={"SKIP_SAVE"})

    def draw(self, _context):
        draw_sections(self.layout, self)

    def execute(self, context):
        # Adjust Last Operation: Blender has undone the import and passes the new options.
        return self.import_now(context)

    def invoke(self, context, _event):
        self._options = import_tree.options_from(self)
        try:
            paths = self.chosen()
            self._job = _Job(paths, self._options, import_tree.units_per_metre(context.scene))
        except (ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        name = paths[0].name if len(paths) == 1 else f"{len(paths)} trees"
        context.workspace.status_text_set(f"Reading {name} (Esc: stop)")
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
        job = self._job
        if job.error is not None or not job.trees:
            return _refuse(self, job.failures)
        try:
            import_tree.create_trees(context, job.trees, self._options)
        except FAILURES as error:
            self.report({"ERROR"}, import_tree.message(error))
            return {"CANCELLED"}
        _report_import(self, [tree.report for _path, tree in job.trees], job.failures)
        self._job = None
        return {"FINISHED"}

    def cancel(self, context):
        self._job.stop()
        self._end(context)

    def _end(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


class SNOWBOUGH_OT_build_tree_from_selected(NotWhileBaking, ImportProperties, bpy.types.Operator):
    """Build a continuous, rigged tree from the selected mesh objects, as an importer of another format made them, with
    their materials and UV maps. The selected objects are hidden"""

    bl_idname = "snowbough.build_tree_from_selected"
    bl_label = "Build Tree from Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context):
        if not any(obj.type == "MESH" for obj in context.selected_objects):
            return "Select the mesh objects of a tree"
        return None

    def draw(self, _context):
        draw_sections(self.layout, self, leave_out={"outside_files"})

    def execute(self, context):
        try:
            _collection, report = selected_meshes.build(context, import_tree.options_from(self))
        except FAILURES as error:
            return self.refuse(import_tree.message(error))
        texts = report["taken"]
        more = f" and {len(texts) - 5} more objects" if len(texts) > 5 else ""
        self.report({"INFO"}, f"Used: {'; '.join(texts[:5])}{more}")
        _report_import(self, [report], [])
        return {"FINISHED"}


def _draw_menu(self, _context):
    self.layout.operator(IMPORT_SCENE_OT_xfrog_tree.bl_idname, text="Xfrog Tree (.obj)")


CLASSES = (
    IMPORT_SCENE_OT_xfrog_tree,
    SNOWBOUGH_OT_import_tree_job,
    SNOWBOUGH_OT_build_tree_from_selected,
)
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
