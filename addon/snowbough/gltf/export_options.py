# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an export. The operator and the command line both use these declarations."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..base.options import options_class

MAX_LEVELS = 8


class ExportProperties:
    """A mix-in for operators."""

    levels: IntProperty(
        name="Levels",
        description="Maximum number of levels of detail. The finest level is the tree in the scene (levels)",
        default=4,
        min=1,
        max=MAX_LEVELS,
    )
    file_per_level: BoolProperty(
        name="One File a Level",
        description="Write <name>_LOD0, <name>_LOD1 and so on, instead of one file with the extension MSFT_lod",
        default=False,
    )
    leaf_share: FloatProperty(
        name="Leaves Kept",
        description="Share of leaves that each level keeps from the level before. The kept leaves are enlarged "
        "to fill the crown (0 to 1)",
        default=0.5,
        min=0.01,
        max=1.0,
    )
    cards: BoolProperty(
        name="Cards",
        description="Add a last level of detail: eight pictures of the tree, with its snow surface, on crossed cards",
        default=True,
    )
    vertices: EnumProperty(
        name="Vertices",
        description="Form in which vertices are stored",
        items=(
            (
                "FLOAT",
                "32-Bit Floats",
                "Largest files, for programs without glTF extensions, such as Blender",
            ),
            (
                "SMALL",
                "Small",
                "Positions with 16 bits, normals and weights with 8 bits (KHR_mesh_quantization)",
            ),
            (
                "COMPRESSED",
                "Compressed",
                "Small vertices, which the program must decompress (EXT_meshopt_compression): smallest files",
            ),
        ),
        default="SMALL",
    )
    texture_size: IntProperty(
        name="Texture Size",
        description="Maximum side of textures (texels). Larger images are reduced, and procedural bark is baked to a "
        "texture of this size. 0 keeps images as they are and exports procedural bark as one colour",
        default=1024,
        min=0,
        max=8192,
    )
    motion: BoolProperty(
        name="Animation",
        description="Export the armature's action, such as the sway, as a looping animation of the joints",
        default=True,
    )
    loop_start: IntProperty(
        name="First Frame",
        description="First frame of the exported loop, used if Loop Frames is above 0 (frames)",
        default=1,
    )
    loop_frames: IntProperty(
        name="Loop Frames",
        description="Length of the exported loop (frames). 0 takes the range of the action's keys",
        default=0,
        min=0,
    )
    loop_keys: IntProperty(
        name="Keys",
        description="Number of keys of each joint in the loop. More keys follow fast twigs better (keys)",
        default=32,
        min=4,
        max=1000,
    )
    snow: EnumProperty(
        name="Snow",
        description="Form in which the baked snow is exported with the tree",
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
                "Height map of the current frame, and normal map if it was baked, as separate image files",
            ),
            ("ATLAS", "Atlas", "Maps of several frames side by side in one image"),
        ),
        default="NONE",
    )
    snow_cell: FloatProperty(
        name="Snow Cell",
        description="Side of the cubes within which points of the snow surface merge (metres). Larger "
        "values give fewer triangles and lose thin snow. 0 keeps all triangles",
        default=0.02,
        min=0.0,
        max=1.0,
        precision=3,
    )
    snow_format: EnumProperty(
        name="Heights",
        description="File format of height maps. Normals are always PNG images of 8 bits",
        items=(
            ("PNG", "PNG, 16 Bits", "Readable by every engine. The glTF file contains scale and offset"),
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
        description="Side of a frame in the atlas (texels). 0 keeps the baked size. Smaller sizes average texels, "
        "which mixes the snow of neighbouring twigs",
        default=0,
        min=0,
        max=8192,
    )


ExportOptions = options_class("ExportOptions", ExportProperties)
