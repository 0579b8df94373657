# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator ``export_scene.snowbough_tree``: exports an imported tree for game engines and other programs
(gltf.export_tree)."""

from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from ..base.names import FAILURES, safe_name
from ..base.options import options_of
from ..gltf import export_tree, scene_tree
from ..gltf.export_options import ExportOptions, ExportProperties
from . import export_formats
from .editing_lock import NotWhileBaking

SECTIONS = (
    ("Tree", ("levels", "file_per_level", "leaf_share", "cards", "vertices", "texture_size")),
    ("Animation", ("motion", "loop_keys", "loop_frames", "loop_start")),
    ("Snow", ("snow", "snow_cell", "snow_format", "atlas_frames", "atlas_tile")),
)
ATLAS_OPTIONS = ("atlas_frames", "atlas_tile")
# Options that USD has no use for: it contains the finest level.
GLTF_OPTIONS = ("levels", "file_per_level", "leaf_share", "cards", "vertices")


class EXPORT_SCENE_OT_snowbough_tree(NotWhileBaking, ExportProperties, bpy.types.Operator, ExportHelper):
    """Export the active tree: glTF with levels of detail for game engines, or USD for Unreal and Houdini; with bones,
    animation and baked snow"""

    bl_idname = "export_scene.snowbough_tree"
    bl_label = "Export Tree"
    bl_options = {"PRESET"}

    filename_ext = ".glb"
    filter_glob: StringProperty(
        name="File Names",
        description="Pattern of the file names that the browser shows",
        default="*.glb;*.gltf;*.usda;*.usdc;*.usd",
        options={"HIDDEN"},
    )

    @classmethod
    def refusal(cls, context):
        try:
            scene_tree.find(context.object)
        except ValueError as error:
            text = str(error)
            return text[0].upper() + text[1:]
        return None

    def invoke(self, context, event):
        if not self.filepath:
            name = safe_name(scene_tree.find(context.object).rig.name)
            self.filepath = str(Path(bpy.path.abspath("//")) / f"{name}{self.filename_ext}")
        return ExportHelper.invoke(self, context, event)

    def check(self, _context):
        # ExportHelper would turn .gltf into .gltf.glb.
        if self.filepath.lower().endswith(tuple(export_formats.WRITERS)):
            return False
        self.filepath += self.filename_ext
        return True

    def _is_used(self, name):
        """Whether an option has an effect with the others as they are."""
        if name in GLTF_OPTIONS and not self.filepath.lower().endswith(tuple(export_tree.GLTF)):
            return False
        if name.startswith("loop_"):
            return self.motion and (name != "loop_start" or self.loop_frames > 0)
        if name in ATLAS_OPTIONS:
            return self.snow == "ATLAS"
        if name == "snow_cell":
            return self.snow == "SURFACE"
        return name != "snow_format" or self.snow in ("FRAME", "ATLAS")

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for title, names in SECTIONS:
            box = layout.box()
            box.label(text=title)
            for name in names:
                row = box.row()
                row.enabled = self._is_used(name)
                row.prop(self, name)

    def execute(self, context):
        try:
            report = export_formats.export(
                context, context.object, self.filepath, options_of(ExportOptions, self)
            )
        except FAILURES as error:
            return self.refuse(error)
        for text in report["warnings"]:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, export_tree.summary(report))
        return {"FINISHED"}


def _draw_menu(self, _context):
    self.layout.operator(
        EXPORT_SCENE_OT_snowbough_tree.bl_idname, text="Snowbough Tree for Engines (.glb/.gltf/.usd)"
    )


def register():
    bpy.utils.register_class(EXPORT_SCENE_OT_snowbough_tree)
    bpy.types.TOPBAR_MT_file_export.append(_draw_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_draw_menu)
    bpy.utils.unregister_class(EXPORT_SCENE_OT_snowbough_tree)
