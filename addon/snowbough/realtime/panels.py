# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own panels that this engine shows, and the panels of its settings."""

import bpy

from ..base.names import REALTIME_ENGINE as ENGINE

# Panels for all engines list the former engine BLENDER_RENDER. FROM_EEVEE are EEVEE's panels that also apply here.
SHARED = "BLENDER_RENDER"
FROM_EEVEE = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "EEVEE_WORLD_PT_context_world",
    "DATA_PT_EEVEE_light",
    "RENDER_PT_color_management",
}
# Panels of settings that this engine does not use.
NOT_OURS = {"RENDER_PT_freestyle", "RENDER_PT_simplify_grease_pencil", "VIEWLAYER_PT_filter"}


def _fitting_panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is None or panel.__name__ in NOT_OURS:
            continue
        if SHARED in engines or panel.__name__ in FROM_EEVEE:
            yield panel


class SNOWBOUGH_PT_realtime(bpy.types.Panel):
    bl_label = "Snowbough Realtime"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        layout, settings = self.layout, context.scene.snowbough_realtime
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(align=True)
        column.prop(settings, "samples", text="Render Samples")
        column.prop(settings, "target_pixels")
        column.prop(settings, "shadow_resolution")


class SNOWBOUGH_PT_realtime_flakes(bpy.types.Panel):
    bl_label = "Falling Snow"
    bl_parent_id = "SNOWBOUGH_PT_realtime"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    COMPAT_ENGINES = {ENGINE}

    def draw_header(self, context):
        self.layout.prop(context.scene.snowbough_realtime, "show_flakes", text="")

    def draw(self, context):
        layout, settings = self.layout, context.scene.snowbough_realtime
        layout.use_property_split = True
        layout.active = settings.show_flakes
        column = layout.column(align=True)
        column.prop(settings, "flake_rate")
        column.prop(settings, "flake_speed")
        column.prop(settings, "flake_size")


OWN_PANELS = (SNOWBOUGH_PT_realtime, SNOWBOUGH_PT_realtime_flakes)


def register():
    for panel in OWN_PANELS:
        bpy.utils.register_class(panel)
    for panel in _fitting_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in bpy.types.Panel.__subclasses__():
        getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
    for panel in reversed(OWN_PANELS):
        bpy.utils.unregister_class(panel)
