# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that several panels share: the bake and its progress, the findings of the check, the result's buttons, the
settings of one receiver, and wrapped text."""

import blf

from ..bake import changes_since_bake
from ..bake import state as bake_state
from ..base import compat, native, session
from ..base.names import unit_of
from ..result import displacement, snow_material
from ..settings import pressing
from ..settings.surface import SurfaceProperties
from ..tree.import_tree import COVERAGE_PROPERTY, LOW_COVERAGE
from .text import wrapped

ICONS = {"ERROR": "CANCEL", "WARNING": "ERROR", "INFO": "INFO"}
MODE_NAMES = {mode[0]: mode[1] for mode in displacement.MODES} | {"NONE": "Material Only"}

# The panel lists at most this many changed settings.
MAX_CHANGES = 5

# Width in pixels that a line of text loses: to its icon, the margins of panel and box, and a scroll bar; to the tabs
# of the sidebar; and to a button beside it.
MARGIN, TABS, BUTTON = 71, 20, 48
MIN_LETTERS = 12
UI_FONT = 0


def draw_text(column, context, text, icon, reserved=0):
    """A text, wrapped to the width of the region. reserved: pixels for other items in the row."""
    preferences, region = context.preferences, context.region
    scale = preferences.system.ui_scale
    room = region.width - scale * (MARGIN + reserved + (TABS if region.type == "UI" else 0))
    blf.size(UI_FONT, preferences.ui_styles[0].widget.points * scale)

    def fits(line):
        return len(line) <= MIN_LETTERS or blf.dimensions(UI_FONT, line)[0] <= room

    for index, line in enumerate(wrapped(text, fits)):
        column.label(text=line, icon=icon if index == 0 else "BLANK1")


def draw_problem(layout, context):
    """One line where the native module cannot be had."""
    text = native.problem()
    if text:
        draw_text(layout.column(align=True), context, text, "ERROR")


def draw_coverage(column, context):
    """The share of its file's wood that the active tree represents."""
    homes = context.object.users_collection if context.object is not None else ()
    coverage = next((c for home in homes if (c := home.get(COVERAGE_PROPERTY)) is not None), None)
    if coverage is None:
        return
    column.label(text=f"Coverage: {coverage:.0%} of the wood", icon="INFO")
    if coverage < LOW_COVERAGE:
        draw_text(column, context, "Parts are missing: try Keep Original Surface", "ERROR")


def draw_bake(layout, context):
    """The buttons of the bake, or its progress while one runs."""
    scene = context.scene
    running = session.bake
    column = layout.column()
    if running is not None:
        where, _, left = running.status().partition(", ")
        column.label(text=where.capitalize(), icon="RENDER_ANIMATION")
        if left:
            compat.draw_progress(column, running.fraction, f"{running.fraction:.0%}, {left}")
        column.operator("snowbough.stop_bake", icon="CANCEL")
        draw_text(column, context, "Editing is locked. Press Esc to stop", "LOCKED")
        return
    state, unfinished = bake_state.state_of(scene), bake_state.resumable(scene)
    changes = changes_since_bake.settings_changes(scene) if state == "BAKED" else []
    is_longer = bool(changes) and not unfinished and changes_since_bake.can_continue(scene)
    buttons = column.column(align=True)
    main = buttons.row(align=True)
    main.scale_y = 1.3
    if state != "EMPTY" and unfinished:
        main.operator("snowbough.bake", text="Resume", icon="PLAY").resume = True
        buttons.operator("snowbough.bake", text="Bake from the Start", icon="FREEZE").resume = False
    else:
        again = state == "BAKED"
        if is_longer:
            main.operator("snowbough.bake", text="Continue Bake", icon="PLAY").extend = True
            main = buttons
        main.operator(
            "snowbough.bake", text="Bake Again" if again else "Bake Snow", icon="FREEZE"
        ).resume = False
    if state == "BAKED" and not unfinished:
        buttons.operator("snowbough.bake", text="Compare with Scene", icon="VIEWZOOM").resume = True
    if state == "BAKED" or unfinished:
        buttons.operator("snowbough.free_bake", icon="TRASH")
    if changes:
        box = column.box().column(align=True)
        text = "These settings have changed. Bake again to apply them:"
        if is_longer:
            text = "The shot is longer. Continue Bake adds the new frames and keeps the others:"
        draw_text(box, context, text, "INFO" if is_longer else "ERROR")
        for change in changes[:MAX_CHANGES]:
            draw_text(box, context, change, "DOT")
        if len(changes) > MAX_CHANGES:
            draw_text(box, context, f"and {len(changes) - MAX_CHANGES} more", "BLANK1")
    severity, text = session.last_outcome
    if text:
        draw_text(column.box().column(align=True), context, text, ICONS[severity])


def draw_issues(layout, context):
    issues = session.issues.get(context.scene.name)
    layout.operator("snowbough.preflight", icon="CHECKMARK")
    if issues is None:
        return
    if not any(issue.severity != "INFO" for issue in issues):
        layout.label(text="No problems found", icon="CHECKMARK")
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
    column.enabled = bake_state.state_of(context.scene) == "BAKED"
    column.operator("snowbough.setup_material", icon="MATERIAL")
    column.operator_menu_enum(
        "snowbough.setup_displacement", "mode", text="Displacement", icon="MOD_DISPLACE"
    )
    column.operator_menu_enum("snowbough.set_kind", "kind", icon="FREEZE")
    column.operator_menu_enum("snowbough.apply_snow", "frames", icon="MESH_DATA")
    if context.scene.snowbough.points:
        column.operator("snowbough.show_flying_snow", icon="OUTLINER_OB_POINTCLOUD")
    layout.operator("snowbough.remove", icon="X")
    if not column.enabled:
        layout.label(text="Bake first", icon="INFO")
    lost = changes_since_bake.lost_snow(context.scene)
    if lost:
        draw_text(layout.column(align=True), context, lost, "INFO")
    if not compat.eevee_displaces():
        text = "In this Blender version, EEVEE shows Cycles Displacement as bumps only"
        draw_text(layout.column(align=True), context, text, "INFO")


def setting_label(settings, name):
    """The label of a setting's field, with the unit where Blender shows none: ``End Depth (m)``."""
    known = settings.bl_rna.properties[name]
    unit = unit_of(known.description)
    return known.name if unit in ("", "°") else f"{known.name} ({unit})"


# Water in millimetres that a day of one degree over zero melts out of snow (degree-day factor; R. Hock, Temperature
# index melt modelling in mountain areas, Journal of Hydrology 282, 2003, has 2 to 6), and the example of the panel.
DEGREE_DAY, MILD = 3.5, 5.0


def draw_thaw(layout, context):
    """How long nature takes for the thaw of the shot."""
    settings = context.scene.snowbough
    melted = settings.start_depth - settings.end_depth
    if melted <= 0.0:
        draw_text(layout.column(align=True), context, "Snow thaws if End Depth is below Start Depth", "INFO")
        return
    days = melted * settings.density / (DEGREE_DAY * MILD)
    text = f"A thaw of {1000 * melted:.3g} mm takes about {days:.2g} days at {MILD:g} °C"
    draw_text(layout.column(align=True), context, text, "INFO")


def draw_mask(layout, entry):
    """The mask of one receiver."""
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(entry, "mask")
    obj = entry.object
    if entry.mask == "NONE" or obj is None:
        return
    if entry.mask == "GROUP":
        column.prop_search(entry, "mask_group", obj, "vertex_groups")
    else:
        column.prop(entry, "mask_image")
        if obj.type == "MESH":
            column.prop_search(entry, "mask_uv_map", obj.data, "uv_layers", icon="GROUP_UVS")
    column.prop(entry, "mask_inverted")


def draw_pressing(layout, settings):
    """What an object does to snow. settings: ``object.snowbough``."""
    column = layout.column()
    column.use_property_split = True
    column.prop(settings, "blocks_wind")
    column.prop(settings, "press")
    if settings.press == "PRESS":
        for name in pressing.NUMBERS:
            column.prop(settings, name, text=setting_label(settings, name))
    elif settings.press == "PLOUGH":
        column.prop(settings, "rim_width", text=setting_label(settings, "rim_width"))


def draw_receiver(layout, entry):
    """The settings of one receiver."""
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(entry, "resolution")
    column.prop(entry, "sides")
    column.prop(entry, "shed_half_life", text=setting_label(entry, "shed_half_life"))
    if entry.object is not None and entry.object.type == "MESH":
        column.prop_search(entry, "uv_map", entry.object.data, "uv_layers", icon="GROUP_UVS")
        mode = displacement.mode_of(entry)
        if mode:
            split = column.split(factor=0.4)
            name = split.row()
            name.alignment = "RIGHT"
            name.label(text="Shown With")
            split.label(text=MODE_NAMES[mode], icon="MATERIAL")
        foreign = snow_material.foreign_scene(entry)
        if foreign:
            column.label(text=f"Its material shows the maps of scene '{foreign}'", icon="INFO")
        if mode == "SHELL":
            column.prop(entry, "own_surface")
            sliders = column.column(align=True)
            sliders.enabled = entry.own_surface
            for name in SurfaceProperties.__annotations__:
                sliders.prop(entry, name)
    if entry.folder:
        column.prop(entry, "folder", text="Baked Files")
