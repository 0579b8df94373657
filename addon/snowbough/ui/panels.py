# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels: Scene properties (all settings and the receivers), sidebar of the 3D view (quick actions), and Physics
properties of an object.

Panels only read. Slow work runs in operators, which store their results in `session`.
"""

import bpy

from ..bake import state
from ..base import session
from ..base.map_kinds import ON_REQUEST
from ..result import snow_surface
from ..scene import receivers
from ..scene.reader import SURFACE_TYPES
from ..settings import simulation
from ..settings.surface import SurfaceProperties
from . import panel_parts


class SNOWBOUGH_UL_receivers(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, _index=0):
        if item.object is None:
            layout.label(text="Object was deleted: remove this entry", icon="ERROR")
            return
        split = layout.split(factor=0.62)
        row = split.row(align=True)
        row.prop(item, "enabled", text="")
        kind = "EMPTY" if item.object.type == "EMPTY" else "MESH"
        row.prop(item.object, "name", text="", emboss=False, icon=f"OUTLINER_OB_{kind}")
        size = split.row(align=True)
        size.alignment = "RIGHT"
        size.label(text=str(item.resolution) if item.resolution else "auto")
        size.label(text="", icon="CHECKMARK" if item.folder else "BLANK1")


class _ScenePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "scene"


class SNOWBOUGH_PT_scene(_ScenePanel, bpy.types.Panel):
    bl_label = "Snowbough"

    def draw(self, context):
        scene = context.scene
        panel_parts.draw_problem(self.layout, context)
        if state.state_of(scene) == "EMPTY":
            column = self.layout.column()
            panel_parts.draw_text(column, context, "There are no receivers. Select objects, then:", "INFO")
            column.operator("snowbough.add_receivers", icon="ADD")
            return
        panel_parts.draw_bake(self.layout, context)


class SNOWBOUGH_PT_receivers(_ScenePanel, bpy.types.Panel):
    bl_label = "Receivers"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        settings = context.scene.snowbough
        layout = self.layout
        layout.enabled = session.bake is None
        row = layout.row()
        row.template_list(
            "SNOWBOUGH_UL_receivers", "", settings, "receivers", settings, "active_receiver", rows=3
        )
        buttons = row.column(align=True)
        buttons.operator("snowbough.add_receivers", text="", icon="ADD")
        buttons.operator("snowbough.remove_receiver", text="", icon="REMOVE")
        if not 0 <= settings.active_receiver < len(settings.receivers):
            return
        panel_parts.draw_receiver(layout, settings.receivers[settings.active_receiver])


class SNOWBOUGH_PT_mask(_ScenePanel, bpy.types.Panel):
    bl_label = "Mask"
    bl_parent_id = "SNOWBOUGH_PT_receivers"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        settings = context.scene.snowbough
        return 0 <= settings.active_receiver < len(settings.receivers)

    def draw(self, context):
        settings = context.scene.snowbough
        self.layout.enabled = session.bake is None
        panel_parts.draw_mask(self.layout, settings.receivers[settings.active_receiver])


class _Settings(_ScenePanel):
    bl_parent_id = "SNOWBOUGH_PT_scene"
    names = ()

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.enabled = session.bake is None
        settings = context.scene.snowbough
        for group in self.names:
            column = layout.column(align=True)
            for name in group:
                column.prop(settings, name, text=panel_parts.setting_label(settings, name))


class SNOWBOUGH_PT_snowfall(_Settings, bpy.types.Panel):
    bl_label = "Snowfall"
    names = (
        ("start_depth", "end_depth"),
        ("rate",),
        ("fall_angle", "bearing", "flutter"),
    )

    def draw(self, context):
        super().draw(context)
        settings = context.scene.snowbough
        column = self.layout.column(align=True)
        column.prop(settings, "show_direction")
        column.operator("snowbough.add_direction_arrow", icon="EMPTY_SINGLE_ARROW")
        column = self.layout.column(align=True)
        column.prop(settings, "use_scene_range")
        sub = column.column(align=True)
        sub.enabled = not settings.use_scene_range
        sub.prop(settings, "frame_start")
        sub.prop(settings, "frame_end")


class SNOWBOUGH_PT_stability(_Settings, bpy.types.Panel):
    bl_label = "Stability"
    bl_options = {"DEFAULT_CLOSED"}
    names = (*simulation.STABILITY_ROWS, ("blur_radius",))


class SNOWBOUGH_PT_thaw(_Settings, bpy.types.Panel):
    bl_label = "Thaw and Rain"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("sun",), *simulation.THAW_ROWS, ("wet",), *simulation.WATER_ROWS)

    def draw(self, context):
        super().draw(context)
        panel_parts.draw_thaw(self.layout, context)
        self.layout.operator_menu_enum("snowbough.set_preset", "preset", icon="PRESET")


class SNOWBOUGH_PT_drift(_Settings, bpy.types.Panel):
    bl_label = "Drifts"
    bl_options = {"DEFAULT_CLOSED"}
    names = simulation.DRIFT_ROWS


class SNOWBOUGH_PT_cache(_Settings, bpy.types.Panel):
    bl_label = "Maps and Cache"
    bl_options = {"DEFAULT_CLOSED"}
    names = (
        ("cache_directory",),
        ("texel_size", "pixel_size"),
        ("checkpoint_interval",),
        tuple(kind.setting for kind in ON_REQUEST),
    )


class SNOWBOUGH_PT_advanced(_Settings, bpy.types.Panel):
    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("substeps", "directions"), *simulation.ADVANCED_ROWS)


class SNOWBOUGH_PT_preflight(_ScenePanel, bpy.types.Panel):
    bl_label = "Check"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        panel_parts.draw_issues(self.layout, context)


class SNOWBOUGH_PT_result(_ScenePanel, bpy.types.Panel):
    bl_label = "Result"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        panel_parts.draw_result(self.layout, context)


class _SidebarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Snowbough"


class SNOWBOUGH_PT_sidebar(_SidebarPanel, bpy.types.Panel):
    bl_label = "Snow"

    def draw(self, context):
        layout = self.layout
        settings = context.scene.snowbough
        panel_parts.draw_problem(layout, context)
        column = layout.column()
        column.enabled = session.bake is None
        column.operator("snowbough.add_receivers", icon="ADD")
        if len(settings.receivers):
            fields = column.column(align=True)
            for name in ("end_depth", "fall_angle", "bearing"):
                fields.prop(settings, name, text=panel_parts.setting_label(settings, name))
            running = session.preview is not None
            column.operator("snowbough.toggle_preview", depress=running, icon="PAUSE" if running else "PLAY")
        panel_parts.draw_bake(layout, context)


class SNOWBOUGH_PT_surface(_Settings, bpy.types.Panel):
    bl_label = "Surface"
    names = (
        ("surface_detail",),
        tuple(SurfaceProperties.__annotations__),
    )

    def draw(self, context):
        super().draw(context)
        self.layout.operator("snowbough.update_surface", icon="FILE_REFRESH")
        for name in snow_surface.coarsened(context.scene):
            self.layout.label(text=f"Too few points for '{name}': raise Detail", icon="INFO")


class SNOWBOUGH_PT_sidebar_result(_SidebarPanel, bpy.types.Panel):
    bl_label = "Result"
    bl_parent_id = "SNOWBOUGH_PT_sidebar"

    @classmethod
    def poll(cls, context):
        return state.state_of(context.scene) == "BAKED"

    def draw(self, context):
        panel_parts.draw_result(self.layout, context)


class SNOWBOUGH_PT_tree(_SidebarPanel, bpy.types.Panel):
    bl_label = "Tree"

    def draw(self, context):
        panel_parts.draw_problem(self.layout, context)
        column = self.layout.column()
        column.enabled = session.bake is None
        column.operator("import_scene.xfrog_tree", text="Import Xfrog Tree", icon="IMPORT")
        # Both set the option, since Blender remembers that of the last call.
        operator = "snowbough.build_tree_from_selected"
        column.operator(operator, icon="MESH_DATA").keep_surface = False
        column.operator(operator, text="Rig Selected as It Is", icon="ARMATURE_DATA").keep_surface = True
        column.operator("snowbough.add_sway", icon="FORCE_WIND")
        panel_parts.draw_coverage(column, context)


class SNOWBOUGH_PT_object(bpy.types.Panel):
    bl_label = "Snowbough"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "physics"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        kinds = SURFACE_TYPES | {"EMPTY"}
        return context.object is not None and context.object.type in kinds

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.enabled = session.bake is None
        entry = receivers.find(context.scene, context.object)
        if entry is None:
            layout.prop(context.object.snowbough, "occlude")
            layout.operator("snowbough.add_receivers", icon="ADD")
            return
        layout.prop(entry, "enabled")
        panel_parts.draw_receiver(layout, entry)


class SNOWBOUGH_PT_pressing(bpy.types.Panel):
    bl_label = "Effect on Snow"
    bl_parent_id = "SNOWBOUGH_PT_object"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "physics"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in SURFACE_TYPES

    def draw(self, context):
        self.layout.enabled = session.bake is None
        panel_parts.draw_pressing(self.layout, context.object.snowbough)
        self.layout.operator_menu_enum("snowbough.set_preset", "preset", icon="PRESET")


CLASSES = (
    SNOWBOUGH_UL_receivers,
    SNOWBOUGH_PT_scene,
    SNOWBOUGH_PT_receivers,
    SNOWBOUGH_PT_mask,
    SNOWBOUGH_PT_snowfall,
    SNOWBOUGH_PT_stability,
    SNOWBOUGH_PT_thaw,
    SNOWBOUGH_PT_drift,
    SNOWBOUGH_PT_cache,
    SNOWBOUGH_PT_advanced,
    SNOWBOUGH_PT_preflight,
    SNOWBOUGH_PT_result,
    SNOWBOUGH_PT_surface,
    SNOWBOUGH_PT_sidebar,
    SNOWBOUGH_PT_sidebar_result,
    SNOWBOUGH_PT_tree,
    SNOWBOUGH_PT_object,
    SNOWBOUGH_PT_pressing,
)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
