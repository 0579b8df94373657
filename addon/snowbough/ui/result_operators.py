# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that show the baked result in the scene: material, displacement, plain geometry; and remove it."""

import os

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

from ..base.names import SNOW_KINDS, counted
from ..cache.errors import CacheError
from ..result import (
    applied_snow,
    baked_images,
    displacement,
    flying_snow,
    look,
    snow_material,
    snow_surface,
    unlisted_snow,
)
from .editing_lock import NotWhileBaking


def _chosen(context, only_selected):
    """The receivers to process: all, or those of the selected objects."""
    receivers = [receiver for receiver in context.scene.snowbough.receivers if receiver.object is not None]
    if only_selected:
        receivers = [receiver for receiver in receivers if receiver.object.select_get()]
    return receivers


def _unlisted(context):
    """The selected objects that have snow but are on no list of receivers."""
    listed = {
        name
        for scene in bpy.data.scenes
        for entry in scene.snowbough.receivers
        if entry.object is not None
        for name in (entry.object.name, *(surface.name for surface in snow_surface.find(entry)))
    }
    return [obj for obj in context.selected_objects if obj.name not in listed and unlisted_snow.is_snowy(obj)]


class _ReceiverOperator(NotWhileBaking):
    """Calls `work` for each chosen receiver. An error is reported, and the other receivers are still processed."""

    bl_options = {"REGISTER", "UNDO"}

    only_selected: BoolProperty(
        name="Only Selected", description="Process only the receivers of the selected objects", default=False
    )

    @classmethod
    def refusal(cls, context):
        if not any(receiver.object for receiver in context.scene.snowbough.receivers):
            return "Add receivers first: select meshes and use Add Snow to Selected"
        return None

    def execute(self, context):
        receivers = _chosen(context, self.only_selected)
        if not receivers:
            return self.refuse("No selected object is a receiver: select one, or add it first")
        done = 0
        for receiver in receivers:
            try:
                self.work(context, receiver)
                done += 1
            except (ValueError, CacheError) as error:
                self.report({"WARNING" if len(receivers) > 1 else "ERROR"}, str(error))
        if not done:
            return {"CANCELLED"}
        self.report({"INFO"}, f"{self.done_text}: {done} of {counted(len(receivers), 'receiver')}")
        return {"FINISHED"}


class SNOWBOUGH_OT_setup_material(_ReceiverOperator, bpy.types.Operator):
    """Mix snow over the materials of the receivers. The original materials stay unchanged"""

    bl_idname = "snowbough.setup_material"
    bl_label = "Set Up Snow Material"
    done_text = "Snow material"

    def work(self, context, receiver):
        mode = displacement.mode_of(receiver)
        if mode == "SHELL" or (mode is None and snow_material.is_shared(receiver.object)):
            return displacement.apply(context.scene, receiver, "SHELL")
        return displacement.apply(context.scene, receiver, mode or "NONE")


class SNOWBOUGH_OT_setup_displacement(_ReceiverOperator, bpy.types.Operator):
    """Give the baked snow its thickness: as a surface, with modifiers or in the material"""

    bl_idname = "snowbough.setup_displacement"
    bl_label = "Set Up Snow Displacement"
    done_text = "Displacement"

    mode: EnumProperty(
        name="Displacement",
        description="How the snow gets its thickness",
        items=(("AUTO", "Automatic", "A snow surface, which suits all objects"),) + displacement.MODES,
        default="AUTO",
    )

    def work(self, context, receiver):
        mode = displacement.DEFAULT_MODE if self.mode == "AUTO" else self.mode
        return displacement.apply(context.scene, receiver, mode)


class SNOWBOUGH_OT_apply_snow(_ReceiverOperator, bpy.types.Operator):
    """Create mesh objects from the snow, which bakes no longer change"""

    bl_idname = "snowbough.apply_snow"
    bl_label = "Apply Snow"
    done_text = "Snow as plain geometry"

    frames: EnumProperty(
        name="Frames",
        description="Which frames the new objects show, and how",
        items=(
            ("CURRENT", "Current Frame", "Plain meshes of the current frame"),
            ("KEYS", "Shot as Shape Keys", "Meshes with a shape key for each frame, all in the .blend file"),
            ("CACHE", "Shot as Mesh Cache", "Meshes with point caches of their own, for large shots"),
        ),
        default="CURRENT",
    )
    directory: StringProperty(
        name="Folder",
        description="Folder of the point caches. // is the folder of the .blend",
        subtype="DIR_PATH",
        default="//applied_snow",
    )

    def work(self, context, receiver):
        if baked_images.load_sequence(receiver.folder, "height") is None:
            raise ValueError(f"{receiver.object.name} has no baked snow: bake first")
        if self.frames == "CURRENT":
            applied = applied_snow.at_frame(context.scene, receiver, context.evaluated_depsgraph_get())
        else:
            applied = applied_snow.of_shot(receiver, None if self.frames == "KEYS" else self._folder())
        if not applied:
            raise ValueError(
                f"{receiver.object.name} has no snow surface to take the geometry from: "
                "choose Displacement > Snow Surface, then bake"
            )

    def _folder(self):
        path = bpy.path.abspath(self.directory)
        if not os.path.isabs(path) or (self.directory.startswith("//") and not bpy.data.filepath):
            raise ValueError(
                "Save the .blend first, so that the point caches lie beside it, or choose an absolute Folder"
            )
        return path


class SNOWBOUGH_OT_remove(_ReceiverOperator, bpy.types.Operator):
    """Remove the snow: restores materials and modifiers, and deletes snow surfaces. Baked files stay. Also works on
    selected objects that were appended with their snow"""

    bl_idname = "snowbough.remove"
    bl_label = "Remove Snow"
    done_text = "Removed snow"

    @classmethod
    def refusal(cls, context):
        return None if _unlisted(context) else super().refusal(context)

    def execute(self, context):
        unlisted = _unlisted(context)
        for name in [obj.name for obj in unlisted]:
            if name in bpy.data.objects:  # removing a receiver may have removed its surface
                unlisted_snow.remove(bpy.data.objects[name])
        if unlisted and not _chosen(context, self.only_selected):
            self.report(
                {"INFO"}, f"{self.done_text}: {counted(len(unlisted), 'object')} on no list of receivers"
            )
            return {"FINISHED"}
        return super().execute(context)

    def work(self, context, receiver):
        displacement.remove(context.scene, receiver)


class SNOWBOUGH_OT_show_flying_snow(NotWhileBaking, bpy.types.Operator):
    """Add an object whose points are the snow in the air of the current frame, for geometry nodes and particles"""

    bl_idname = "snowbough.show_flying_snow"
    bl_label = "Show Flying Snow"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        try:
            flying_snow.show(context.scene)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class SNOWBOUGH_OT_set_kind(NotWhileBaking, bpy.types.Operator):
    """Make all snow of another kind, or sand, dust or ash. Its look changes at once, its slopes with the next bake"""

    bl_idname = "snowbough.set_kind"
    bl_label = "Set Kind of Snow"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(
        name="Kind of Snow", description="Kind of snow to set", items=SNOW_KINDS, default="FRESH"
    )

    def execute(self, context):
        look.apply(context.scene, self.kind)
        return {"FINISHED"}


CLASSES = (
    SNOWBOUGH_OT_set_kind,
    SNOWBOUGH_OT_setup_material,
    SNOWBOUGH_OT_setup_displacement,
    SNOWBOUGH_OT_apply_snow,
    SNOWBOUGH_OT_show_flying_snow,
    SNOWBOUGH_OT_remove,
)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
