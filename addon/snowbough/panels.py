# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an artist finds everything: Scene properties (all settings and the list of receivers), the sidebar
of the 3D view (quick actions), and the Physics properties of an object.

Panels only read; what takes time is done by operators, which leave their results for the panels.
"""

import time

import blf
import bpy

from . import (
    bake_engine,
    bake_operators,
    cache,
    compat,
    displacement,
    preflight,
    preview,
    receivers,
    scene_reader,
    stale,
)

ICONS = {"ERROR": "CANCEL", "WARNING": "ERROR", "INFO": "INFO"}


def state_of(scene):
    """EMPTY (no receivers), BAKING, BAKED (all enabled receivers have files), or READY."""
    if bake_engine.session() is not None:
        return "BAKING"
    enabled = [entry for entry in scene.snowbough.receivers if entry.object and entry.enabled]
    if not enabled:
        return "EMPTY"
    return "BAKED" if all(entry.folder for entry in enabled) else "READY"


# So many changes are named in the panel.
MAX_CHANGES = 5

# A look into the cache is a few file reads; panels redraw with every movement of the mouse.
LOOK_SECONDS = 1.0
_looked = {}


def _resumable(scene):
    """Whether the newest version holds an unfinished bake, as it was at most LOOK_SECONDS ago."""
    root = bake_operators.existing_cache(scene)
    if root is None:
        return False
    when, found = _looked.get(str(root), (0.0, False))
    if time.monotonic() - when > LOOK_SECONDS:
        found = _has_unfinished(root)
        _looked[str(root)] = (time.monotonic(), found)
    return found


def _has_unfinished(root):
    numbers = cache.versions(root)
    if not numbers:
        return False
    folder = cache.version_folder(root, numbers[-1])
    for child in folder.iterdir():
        try:
            manifest = cache.read_manifest(child)
        except cache.CacheError:
            continue
        if manifest is not None and not manifest["complete"]:
            return True
    return False


# Pixels that a line of text loses to its icon, the margins of panel and box, and a scroll bar; to the tabs of
# a sidebar; and to a button beside it.
MARGIN, TABS, BUTTON = 71, 20, 48
FEWEST_LETTERS = 12
UI_FONT = 0


def draw_text(column, context, text, icon, taken=0):
    """A text in as many lines as the region's width asks for; taken: pixels that something else needs."""
    preferences, region = context.preferences, context.region
    scale = preferences.system.ui_scale
    room = region.width - scale * (MARGIN + taken + (TABS if region.type == "UI" else 0))
    blf.size(UI_FONT, preferences.ui_styles[0].widget.points * scale)

    def fits(line):
        return len(line) <= FEWEST_LETTERS or blf.dimensions(UI_FONT, line)[0] <= room

    for index, line in enumerate(bake_operators.wrapped(text, fits)):
        column.label(text=line, icon=icon if index == 0 else "BLANK1")


def draw_bake(layout, context):
    """The buttons of the bake, or its progress while one runs."""
    scene = context.scene
    running = bake_engine.session()
    column = layout.column()
    if running is not None:
        where, _, left = running.status().partition(", ")
        column.label(text=where.capitalize(), icon="RENDER_ANIMATION")
        if left:
            compat.draw_progress(column, running.fraction, f"{running.fraction:.0%}, {left}")
        column.operator("snowbough.stop_bake", icon="CANCEL")
        draw_text(column, context, "Editing is locked. Esc stops, too", "LOCKED")
        return
    state, unfinished = state_of(scene), _resumable(scene)
    changes = stale.settings_changes(scene) if state == "BAKED" else []
    buttons = column.column(align=True)
    main = buttons.row(align=True)
    main.scale_y = 1.3
    if state != "EMPTY" and unfinished:
        main.operator("snowbough.bake", text="Resume", icon="PLAY").resume = True
        buttons.operator("snowbough.bake", text="Bake from the Start", icon="FREEZE").resume = False
    else:
        again = state == "BAKED"
        main.operator(
            "snowbough.bake", text="Bake Again" if again else "Bake Snow", icon="FREEZE"
        ).resume = False
    if state == "BAKED" and not unfinished:
        buttons.operator("snowbough.bake", text="Compare with Scene", icon="VIEWZOOM").resume = True
    if state == "BAKED" or unfinished:
        buttons.operator("snowbough.free_bake", icon="TRASH")
    if changes:
        box = column.box().column(align=True)
        draw_text(box, context, "Baked with other settings. Bake again to see these:", "ERROR")
        for change in changes[:MAX_CHANGES]:
            draw_text(box, context, change, "DOT")
        if len(changes) > MAX_CHANGES:
            draw_text(box, context, f"and {len(changes) - MAX_CHANGES} more", "BLANK1")
    severity, text = bake_operators.last_outcome
    if text:
        draw_text(column.box().column(align=True), context, text, ICONS[severity])


def draw_issues(layout, context):
    issues = preflight.found.get(context.scene.name)
    layout.operator("snowbough.preflight", icon="CHECKMARK")
    if issues is None:
        return
    if not any(issue.severity != "INFO" for issue in issues):
        layout.label(text="Nothing in the way", icon="CHECKMARK")
    for issue in issues:
        row = layout.row()
        draw_text(
            row.column(align=True), context, issue.text, ICONS[issue.severity], BUTTON if issue.fix else 0
        )
        if issue.fix:
            button = row.row()
            button.alignment = "RIGHT"
            fix = button.operator("snowbough.fix", text="Fix")
            fix.kind, fix.object_name = issue.fix, issue.object_name


def draw_result(layout, context):
    column = layout.column(align=True)
    column.enabled = state_of(context.scene) == "BAKED"
    column.operator("snowbough.setup_material", icon="MATERIAL")
    column.operator_menu_enum(
        "snowbough.setup_displacement", "mode", text="Displacement", icon="MOD_DISPLACE"
    )
    column.operator("snowbough.apply_at_frame", icon="MESH_DATA")
    layout.operator("snowbough.remove", icon="X")
    if not column.enabled:
        layout.label(text="Bake first", icon="INFO")
    if not compat.eevee_displaces():
        text = "EEVEE of this Blender shows Cycles Displacement as bumps only"
        draw_text(layout.column(align=True), context, text, "INFO")


MODE_NAMES = {mode[0]: mode[1] for mode in displacement.MODES} | {"NONE": "Material Only"}


class SNOWBOUGH_UL_receivers(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, _index=0):
        if item.object is None:
            layout.label(text="Object is gone: take this line off", icon="ERROR")
            return
        split = layout.split(factor=0.62)
        row = split.row(align=True)
        row.prop(item, "enabled", text="")
        row.prop(item.object, "name", text="", emboss=False, icon="OUTLINER_OB_" + _icon_kind(item.object))
        size = split.row(align=True)
        size.alignment = "RIGHT"
        size.label(text=str(item.resolution) if item.resolution else "auto")
        size.label(text="", icon="CHECKMARK" if item.folder else "BLANK1")


def _icon_kind(obj):
    return obj.type if obj.type in {"MESH", "EMPTY"} else "MESH"


class _ScenePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "scene"


class SNOWBOUGH_PT_scene(_ScenePanel, bpy.types.Panel):
    bl_label = "Snowbough"

    def draw(self, context):
        scene = context.scene
        if state_of(scene) == "EMPTY":
            column = self.layout.column()
            draw_text(column, context, "No object gathers snow yet. Select some, then:", "INFO")
            column.operator("snowbough.add_receivers", icon="ADD")
            return
        draw_bake(self.layout, context)


class SNOWBOUGH_PT_receivers(_ScenePanel, bpy.types.Panel):
    bl_label = "Receivers"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        settings = context.scene.snowbough
        layout = self.layout
        layout.enabled = bake_engine.session() is None
        row = layout.row()
        row.template_list(
            "SNOWBOUGH_UL_receivers", "", settings, "receivers", settings, "active_receiver", rows=3
        )
        buttons = row.column(align=True)
        buttons.operator("snowbough.add_receivers", text="", icon="ADD")
        buttons.operator("snowbough.remove_receiver", text="", icon="REMOVE")
        if not 0 <= settings.active_receiver < len(settings.receivers):
            return
        draw_receiver(layout, settings.receivers[settings.active_receiver])


def draw_receiver(layout, entry):
    """The settings of one line of the list."""
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(entry, "resolution")
    if entry.object is not None and entry.object.type == "MESH":
        column.prop_search(entry, "uv_map", entry.object.data, "uv_layers", icon="GROUP_UVS")
        mode = displacement.mode_of(entry)
        if mode:
            split = column.split(factor=0.4)
            name = split.row()
            name.alignment = "RIGHT"
            name.label(text="Shown With")
            split.label(text=MODE_NAMES[mode], icon="MATERIAL")
    if entry.folder:
        column.prop(entry, "folder", text="Baked Files")


class _Settings(_ScenePanel):
    bl_parent_id = "SNOWBOUGH_PT_scene"
    names = ()

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.enabled = bake_engine.session() is None
        for group in self.names:
            column = layout.column(align=True)
            for name in group:
                column.prop(context.scene.snowbough, name)


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


class SNOWBOUGH_PT_settling(_Settings, bpy.types.Panel):
    bl_label = "Settling"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("max_depth", "slide_half_life"), ("blur_radius",))


class SNOWBOUGH_PT_cache(_Settings, bpy.types.Panel):
    bl_label = "Maps and Cache"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("cache_directory",), ("texel_size", "pixel_size"), ("checkpoint_interval",), ("write_normals",))


class SNOWBOUGH_PT_advanced(_Settings, bpy.types.Panel):
    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("substeps",), ("seed", "noise_density"), ("mapping",))


class SNOWBOUGH_PT_preflight(_ScenePanel, bpy.types.Panel):
    bl_label = "Check"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        draw_issues(self.layout, context)


class SNOWBOUGH_PT_result(_ScenePanel, bpy.types.Panel):
    bl_label = "Result"
    bl_parent_id = "SNOWBOUGH_PT_scene"

    def draw(self, context):
        draw_result(self.layout, context)


class SNOWBOUGH_PT_sidebar(bpy.types.Panel):
    bl_label = "Snow"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Snowbough"

    def draw(self, context):
        layout = self.layout
        settings = context.scene.snowbough
        column = layout.column()
        column.enabled = bake_engine.session() is None
        column.operator("snowbough.add_receivers", icon="ADD")
        if len(settings.receivers):
            split = column.column(align=True)
            split.use_property_split = True
            split.use_property_decorate = False
            for name in ("end_depth", "fall_angle", "bearing"):
                split.prop(settings, name)
            running = preview.is_running()
            column.operator("snowbough.toggle_preview", depress=running, icon="PAUSE" if running else "PLAY")
        draw_bake(layout, context)


class SNOWBOUGH_PT_sidebar_result(bpy.types.Panel):
    bl_label = "Result"
    bl_parent_id = "SNOWBOUGH_PT_sidebar"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Snowbough"

    @classmethod
    def poll(cls, context):
        return state_of(context.scene) == "BAKED"

    def draw(self, context):
        draw_result(self.layout, context)


class SNOWBOUGH_PT_tree(bpy.types.Panel):
    bl_label = "Tree"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Snowbough"

    def draw(self, context):
        column = self.layout.column()
        column.enabled = bake_engine.session() is None
        column.operator("import_scene.xfrog_tree", text="Import Xfrog Tree", icon="IMPORT")
        column.operator("snowbough.add_sway", icon="FORCE_WIND")


class SNOWBOUGH_PT_object(bpy.types.Panel):
    bl_label = "Snowbough"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "physics"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        kinds = scene_reader.SURFACE_TYPES | {"EMPTY"}
        return context.object is not None and context.object.type in kinds

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.enabled = bake_engine.session() is None
        entry = receivers.find(context.scene, context.object)
        if entry is None:
            layout.prop(context.object.snowbough, "occlude")
            layout.operator("snowbough.add_receivers", icon="ADD")
            return
        layout.prop(entry, "enabled")
        draw_receiver(layout, entry)


CLASSES = (
    SNOWBOUGH_UL_receivers,
    SNOWBOUGH_PT_scene,
    SNOWBOUGH_PT_receivers,
    SNOWBOUGH_PT_snowfall,
    SNOWBOUGH_PT_settling,
    SNOWBOUGH_PT_cache,
    SNOWBOUGH_PT_advanced,
    SNOWBOUGH_PT_preflight,
    SNOWBOUGH_PT_result,
    SNOWBOUGH_PT_sidebar,
    SNOWBOUGH_PT_sidebar_result,
    SNOWBOUGH_PT_tree,
    SNOWBOUGH_PT_object,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
