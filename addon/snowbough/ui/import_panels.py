# SPDX-License-Identifier: GPL-3.0-or-later
"""The import options, grouped: panels of the file browser, and sections of dialogs."""

import bpy

from ..base import compat
from ..tree.import_options import SECTIONS

OPERATOR = "IMPORT_SCENE_OT_xfrog_tree"

# Options that have an effect only under a condition; they are greyed out otherwise.
ONLY_WITH = {
    "species": lambda options: options.width == "INVERSE" and not options.keep_surface,
    "detail": lambda options: not options.lod_chain,
    "lod_chain": lambda options: not options.keep_surface,
    "width": lambda options: not options.keep_surface,
    "unit": lambda options: options.height == 0.0,
    "foliage_names": lambda options: options.foliage,
}


def draw_options(layout, options, names):
    """Draws the options of one section in a column."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    for name in names:
        row = layout.row()
        row.active = ONLY_WITH.get(name, lambda _options: True)(options)
        row.prop(options, name)


def draw_sections(layout, options, leave_out=()):
    """Draws all sections, in Adjust Last Operation and in the dialog for dropped files."""
    for identifier, text, names in SECTIONS:
        body = compat.section(layout, f"snowbough_import_{identifier}", text)
        if body is not None:
            draw_options(body, options, [name for name in names if name not in leave_out])


class _Panel:
    """A panel of the file browser, below Blender's own panel of the operator."""

    bl_space_type = "FILE_BROWSER"
    bl_region_type = "TOOL_PROPS"
    bl_parent_id = "FILE_PT_operator"

    @classmethod
    def poll(cls, context):
        operator = context.space_data.active_operator
        return operator is not None and operator.bl_idname == OPERATOR

    def draw(self, context):
        draw_options(self.layout, context.space_data.active_operator, self.names)


CLASSES = tuple(
    type(
        f"SNOWBOUGH_PT_import_{identifier}",
        (_Panel, bpy.types.Panel),
        {"bl_label": text, "names": names, "bl_options": set() if number < 2 else {"DEFAULT_CLOSED"}},
    )
    for number, (identifier, text, names) in enumerate(SECTIONS)
)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
