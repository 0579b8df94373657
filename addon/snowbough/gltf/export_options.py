# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an export, declared once: the operator's properties and the command line come from here."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..options import options_class

MOST_LEVELS = 8


class ExportProperties:
    """Mix-in of operators."""

    levels: IntProperty(
        name="Levels",
        description="How many levels of detail are written at most, the finest as it stands in the scene (levels)",
        default=4,
        min=1,
        max=MOST_LEVELS,
    )
    file_per_level: BoolProperty(
        name="One File a Level",
        description="Write <name>_LOD0, <name>_LOD1 and so on instead of one file in which MSFT_lod joins them",
        default=False,
    )
    leaf_share: FloatProperty(
        name="Leaves Kept",
        description="Share of the leaves that each level keeps of the one before; they grow, so that the crown "
        "covers as much (0 to 1)",
        default=0.5,
        min=0.01,
        max=1.0,
    )
    snow: EnumProperty(
        name="Snow",
        description="Baked snow that is written with the tree",
        items=(
            ("NONE", "None", "No snow"),
            (
                "SURFACE",
                "Surface",
                "The snow surface of the current frame as a mesh in the file, as Blender shows it",
            ),
            (
                "FRAME",
                "Map",
                "Heights, and normals where they were baked, of the current frame, beside the file",
            ),
            ("ATLAS", "Atlas", "Maps of several frames side by side in one image"),
        ),
        default="NONE",
    )
    snow_format: EnumProperty(
        name="Heights",
        description="What height maps are written as; normals are PNG images of 8 bits either way",
        items=(
            ("PNG", "PNG, 16 Bits", "Every engine reads it; scale and offset are written beside it"),
            ("EXR", "OpenEXR, 32 Bits", "Metres as they are"),
        ),
        default="PNG",
    )
    atlas_frames: IntProperty(
        name="Frames",
        description="Frames in the atlas, spread evenly over the bake from its first to its last (frames)",
        default=16,
        min=2,
        max=256,
    )
    atlas_tile: IntProperty(
        name="Tile",
        description="Side of a frame in the atlas, 0 = as baked; finer maps are averaged down, where the twigs of "
        "trees run into one another (texels)",
        default=0,
        min=0,
        max=8192,
    )


ExportOptions = options_class("ExportOptions", ExportProperties)
