# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that add objects to the scene's list of receivers and remove them, and set presets.

add_receivers also adds snow material and displacement. They show nothing until a bake refreshes them.
"""

import bpy
from bpy.props import EnumProperty

from ..result import displacement
from ..scene import receivers
from ..scene.reader import SURFACE_TYPES
from ..settings import presets
from .editing_lock import NotWhileBaking


class SNOWBOUGH_OT_add_receivers(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.add_receivers"
    bl_label = "Add Snow to Selected"
    bl_description = (
        "Make the selected objects receive snow: adds a UV map without overlaps where needed, snow material and "
        "displacement. The snow shows after a bake"
    )
    bl_options = {"REGISTER", "UNDO"}

    setup_result: bpy.props.BoolProperty(
        name="Set Up Material and Displacement",
        description="Also add snow material and the displacement that suits each object. Remove Snow removes both",
        default=True,
    )

    @classmethod
    def refusal(cls, context):
        return None if context.selected_objects else "Select meshes, or empties that instance a collection"

    def execute(self, context):
        added, refused, objects = 0, [], list(context.selected_objects)
        progress = context.window_manager
        # Most of the time goes into unwrapping, which takes as long as there are faces.
        done = [0]
        for obj in objects:
            done.append(done[-1] + 1 + (len(obj.data.polygons) if obj.type == "MESH" else 0))
        progress.progress_begin(0, done[-1])
        for number, obj in zip(done, objects):
            progress.progress_update(number)
            try:
                entry = receivers.add(context, obj)
                added += 1
                if self.setup_result and displacement.mode_of(entry) is None:
                    displacement.apply(context.scene, entry, displacement.DEFAULT_MODE)
                for name in receivers.members_without_map(obj):
                    self.report(
                        {"WARNING"},
                        f"'{name}', which '{obj.name}' instances, has no UV map and gets no snow: unwrap it without "
                        "overlaps, or use Add Snow to Selected on the object itself, then remove it from the list",
                    )
                counts = receivers.scattered_by(context, obj) if obj.type == "MESH" else {}
                if counts:
                    self.report(
                        {"INFO"},
                        f"'{obj.name}' scatters {receivers.scattered_text(counts)}, which receive no snow: realize "
                        "the instances and apply the geometry nodes to cover them",
                    )
            except ValueError as error:
                refused.append(str(error))
        progress.progress_end()
        for text in refused:
            self.report({"WARNING"} if added else {"ERROR"}, text)
        return {"FINISHED"} if added else {"CANCELLED"}


class SNOWBOUGH_OT_remove_receiver(NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.remove_receiver"
    bl_label = "Remove from List"
    bl_description = (
        "Remove the active receiver from the list and its snow from the scene. Object and baked files stay"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context):
        return None if len(context.scene.snowbough.receivers) else "The list is empty"

    def execute(self, context):
        settings = context.scene.snowbough
        if 0 <= settings.active_receiver < len(settings.receivers):
            displacement.remove(context.scene, settings.receivers[settings.active_receiver])
        settings.receivers.remove(settings.active_receiver)
        settings.active_receiver = max(0, min(settings.active_receiver, len(settings.receivers) - 1))
        return {"FINISHED"}


class SNOWBOUGH_OT_set_preset(NotWhileBaking, bpy.types.Operator):
    """Set what happens to the snow of this shot"""

    bl_idname = "snowbough.set_preset"
    bl_label = "Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Preset", description="What happens to the snow", items=presets.PRESETS, default="THAW"
    )

    def execute(self, context):
        objects = [obj for obj in context.selected_objects if obj.type in SURFACE_TYPES]
        try:
            presets.apply(self.preset, context.scene, objects)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (SNOWBOUGH_OT_add_receivers, SNOWBOUGH_OT_remove_receiver, SNOWBOUGH_OT_set_preset)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
