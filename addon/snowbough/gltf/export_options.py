# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an export, declared once: the operator's properties and the command line come from here."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..options import options_class

MOST_LEVELS = 8


class ExportProperties:
    """Mix-in of operators."""

    levels: IntProperty(
        name="Levels",
        description="Maximum number of levels of detail. The finest is the tree in the scene (levels)",
        default=4,
        min=1,
        max=MOST_LEVELS,
    )
    file_per_level: BoolProperty(
        name="One File a Level",
        description="Write <name>_LOD0, <name>_LOD1 and so on, instead of one file with the extension MSFT_lod",
        default=False,
    )
    leaf_share: FloatProperty(
        name="Leaves Kept",
        description="Share of leaves that each level keeps from the one before. The kept leaves are enlarged to fill "
        "the crown (0 to 1)",
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
        description="File format of height maps. Normals are always PNG images of 8 bits",
        items=(
            ("PNG", "PNG, 16 Bits", "Readable by every engine. Scale and offset are in a separate file"),
            ("EXR", "OpenEXR, 32 Bits", "Heights in metres"),
        ),
        default="PNG",
    )
    atlas_frames: IntProperty(
        name="Frames",
        description="Number of frames in the atlas, evenly spread from the first to the last baked frame (frames)",
        default=16,
        min=2,
        max=256,
    )
    atlas_tile: IntProperty(
        name="Tile",
        description="Side of a frame in the atlas (texels). 0 keeps the baked size. Larger maps are averaged down, "
        "which blurs neighbouring twigs of trees together",
        default=0,
        min=0,
        max=8192,
    )


ExportOptions = options_class("ExportOptions", ExportProperties)
