# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an import, declared once: the operators' properties, the presets and the command line all come
from ImportProperties.
"""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..names import MAX_RESOLUTION, MIN_RESOLUTION
from ..options import options_class

LOD_COUNT = 4
# The option `lod` where `detail` says how fine the surface is.
BY_DETAIL = -1

# Metres that a unit of the file is; None: as many of Blender's units as the file has.
METRES_OF_UNIT = {
    "FILE": None,
    "MILLIMETRES": 0.001,
    "CENTIMETRES": 0.01,
    "METRES": 1.0,
    "INCHES": 0.0254,
    "FEET": 0.3048,
}


class ImportProperties:
    """Mix-in of operators."""

    up_axis: EnumProperty(
        name="Up Axis",
        description="Which of the file's axes points up",
        items=(
            ("AUTO", "Automatic", "Found from the tree's shape"),
            ("Y", "Y", "The file's Y axis points up"),
            ("Z", "Z", "The file's Z axis points up"),
        ),
        default="AUTO",
    )
    unit: EnumProperty(
        name="Units",
        description="What one unit of the file is",
        items=(
            ("FILE", "As in the File", "One unit of the file is one of Blender's"),
            ("MILLIMETRES", "Millimetres", "The file counts in millimetres"),
            ("CENTIMETRES", "Centimetres", "The file counts in centimetres"),
            ("METRES", "Metres", "The file counts in metres"),
            ("INCHES", "Inches", "The file counts in inches"),
            ("FEET", "Feet", "The file counts in feet"),
        ),
        default="FILE",
    )
    height: FloatProperty(
        name="Height",
        description="How high the wood shall be, whatever the file's units; 0: as they say (metres)",
        default=0.0,
        min=0.0,
        soft_max=40.0,
    )
    outside_files: BoolProperty(
        name="Files Elsewhere",
        description="Also read material libraries and textures that the file names outside of its own folder and "
        "the one above it. Leave it off for files that you do not trust",
        default=False,
    )
    levels: StringProperty(
        name="Level Names",
        description="Names of groups from the trunk on, separated by commas; empty: found from the names themselves",
    )
    simplify: EnumProperty(
        name="Simplify",
        description="Which points of a branch become joints",
        items=(
            ("NONE", "Keep All", "Every point of the export becomes a joint"),
            ("THESIS", "Attach Points", "Straight bones between a branch's children"),
            ("TOLERANCE", "Tolerance", "As Attach Points, and what it takes to stay close to the original"),
        ),
        default="TOLERANCE",
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="How far a limb may stray from the original (radii of the limb)",
        default=0.5,
        min=0.0,
        soft_max=4.0,
    )
    width: EnumProperty(
        name="Width",
        description="How thick branches are along their way",
        items=(
            ("ORIGINAL", "Original", "The export's own radii"),
            ("INVERSE", "Flare", "Radii that flare towards each branch's root"),
        ),
        default="ORIGINAL",
    )
    species: EnumProperty(
        name="Species",
        description="How branches of the first level flare, where Width is Flare",
        items=(
            ("BROADLEAF", "Broad-leaf", "Branches of all levels flare alike"),
            ("EVERGREEN", "Evergreen", "First branches are thin and straight with a short flare"),
        ),
        default="BROADLEAF",
    )
    detail: EnumProperty(
        name="Detail",
        description="How fine the surface is: sides by thickness, limbs that curve, forks that flow",
        items=(
            ("DRAFT", "Draft", "For looking at: trunks of up to 8 sides, as few faces as bends need"),
            ("GAME", "Game", "For engines that draw many trees"),
            ("DEFAULT", "Default", "Trunks of up to 16 sides, limbs without visible kinks"),
            ("FILM", "Film", "For close-ups: trunks of up to 32 sides"),
        ),
        default="DEFAULT",
    )
    lod: IntProperty(
        name="Level of Detail",
        description="For scripts, instead of Detail: 0 has four-sided limbs, each level doubles the sides; "
        "-1: as Detail says (levels)",
        default=BY_DETAIL,
        min=BY_DETAIL,
        max=LOD_COUNT - 1,
        options={"HIDDEN"},
    )
    lod_chain: BoolProperty(
        name="Import LOD Chain",
        description="All four levels of detail on one armature, named as game engines expect: _LOD0 is the finest",
        default=False,
    )
    max_bones: IntProperty(
        name="Max Bones",
        description="Bone budget, 0 = all; the deepest bones hand their weights to their ancestors (bones)",
        default=1000,
        min=0,
    )
    max_bone_level: IntProperty(
        name="Max Bone Level",
        description="Last branch level that gets bones, -1 = all (levels)",
        default=-1,
        min=-1,
    )
    show_bones: BoolProperty(
        name="Show Bones",
        description="Show the bones; off, they are hidden by their levels and move the tree all the same",
        default=False,
    )
    foliage: BoolProperty(
        name="Foliage", description="Keep leaves, needles and flowers as a second object", default=True
    )
    foliage_names: StringProperty(
        name="Foliage Names",
        description="What is foliage: starts of the names of groups, objects or materials, separated by "
        "commas; empty: told by usual names and by shape",
    )
    snow_resolution: IntProperty(
        name="Snow Resolution",
        description="Side of the accumulation map that the UV maps `snow` are laid out for (texels)",
        default=1024,
        min=MIN_RESOLUTION,
        max=MAX_RESOLUTION,
    )
    wind_attributes: BoolProperty(
        name="Wind Attributes",
        description="For cheap wind in engines: each point's branch as attributes _PIVOT, _AXIS, _LENGTH and _PHASE",
        default=False,
    )
    mark_asset: BoolProperty(
        name="Mark as Asset", description="Show the tree in the Asset Browser, with a picture", default=False
    )


ImportOptions = options_class("ImportOptions", ImportProperties)

# Headings of the options in dialogs, and what stands under each. `lod` is for scripts.
SECTIONS = (
    ("file", "File", ("up_axis", "unit", "height", "levels", "outside_files")),
    ("surface", "Surface", ("detail", "lod_chain", "simplify", "tolerance", "width", "species")),
    ("bones", "Bones", ("max_bones", "max_bone_level", "show_bones")),
    ("foliage", "Foliage", ("foliage", "foliage_names")),
    ("extras", "Maps and Extras", ("snow_resolution", "wind_attributes", "mark_asset")),
)
