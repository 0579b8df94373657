# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of an import, declared once: ImportProperties is the source of the operators' properties, the presets and
the command line.
"""

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..base.names import MAX_RESOLUTION, MIN_RESOLUTION
from ..base.options import options_class

# The detail of limbs with four sides.
BASE = "BASE"
# The details of a LOD chain, the coarsest first.
LOD_CHAIN = (BASE, "GAME", "DEFAULT", "FILM")
# The native module's simplify and tolerance by `detail`; the option `simplify` overrides them.
JOINTS = {
    BASE: ("TOLERANCE", 0.5),
    "DRAFT": ("TOLERANCE", 0.5),
    "GAME": ("TOLERANCE", 1.0),
    "DEFAULT": ("TOLERANCE", 0.5),
    "FILM": ("NONE", 0.0),
}

# Metres of a unit of the file; None: a unit of the file is a Blender unit.
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
        description="Axis of the file that points up",
        items=(
            ("AUTO", "Automatic", "Found by the shape of the tree"),
            ("Y", "Y", "The file's Y axis points up"),
            ("Z", "Z", "The file's Z axis points up"),
        ),
        default="AUTO",
    )
    unit: EnumProperty(
        name="Units",
        description="Unit of length in the file",
        items=(
            ("FILE", "As in the File", "One unit of the file is one Blender unit"),
            ("MILLIMETRES", "Millimetres", "The file is in millimetres"),
            ("CENTIMETRES", "Centimetres", "The file is in centimetres"),
            ("METRES", "Metres", "The file is in metres"),
            ("INCHES", "Inches", "The file is in inches"),
            ("FEET", "Feet", "The file is in feet"),
        ),
        default="FILE",
    )
    height: FloatProperty(
        name="Height",
        description="Height of the imported tree without its leaves; 0 keeps the file's scale (metres)",
        default=0.0,
        min=0.0,
        soft_max=40.0,
    )
    outside_files: BoolProperty(
        name="Files Elsewhere",
        description="Also read material libraries and textures outside the folder of the file and the folder above it. "
        "Leave it off for files that you do not trust",
        default=False,
    )
    levels: StringProperty(
        name="Level Names",
        description="Names of the file's groups from the trunk on, separated by commas. If empty, found automatically",
    )
    simplify: EnumProperty(
        name="Simplify",
        description="For scripts, instead of Detail: points of a branch that become joints of bones",
        items=(
            ("DETAIL", "By Detail", "The joints that Detail chooses"),
            ("NONE", "Keep All", "All points in the file"),
            (
                "THESIS",
                "Attach Points",
                "Only points where other branches start: straight bones between them",
            ),
            (
                "TOLERANCE",
                "Tolerance",
                "Attach points, and the points needed to stay close to the original shape",
            ),
        ),
        default="DETAIL",
        options={"HIDDEN"},
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="For scripts, with Simplify TOLERANCE: largest deviation from the original shape. Higher values "
        "give fewer bones (radii of the limb)",
        default=0.5,
        min=0.0,
        options={"HIDDEN"},
    )
    width: EnumProperty(
        name="Width",
        description="Radii of the branches",
        items=(
            ("ORIGINAL", "Original", "The export's own radii"),
            ("INVERSE", "Flare", "Computed radii that increase towards the root of each branch"),
        ),
        default="ORIGINAL",
    )
    species: EnumProperty(
        name="Species",
        description="Flare of the first-level branches, if Width is Flare",
        items=(
            ("BROADLEAF", "Broad-leaf", "Branches of all levels flare alike"),
            ("EVERGREEN", "Evergreen", "First-level branches are thin and straight with a short flare"),
        ),
        default="BROADLEAF",
    )
    keep_surface: BoolProperty(
        name="Keep Original Surface",
        description="Keep the file's own mesh with its UV maps and normals, and give it the skeleton: for trees that "
        "are fine as they are, scans and stumps. Detail, Width and LOD Chain then have no effect on the surface",
        default=False,
    )
    bones: StringProperty(
        name="SpeedTree Bones",
        description="Raw XML file of SpeedTree, exported with bones beside the mesh: its bones become the skeleton, "
        "and the mesh keeps its surface. If empty, the skeleton is found along the polygons",
        subtype="FILE_PATH",
    )
    detail: EnumProperty(
        name="Detail",
        description="Fineness of the tree: sides of limbs, smoothness of bends and forks, joints of branches",
        items=(
            (BASE, "Base", "Limbs of four sides, as the real-time renderer starts from"),
            ("DRAFT", "Draft", "For a quick look: trunks of up to 8 sides, few faces in bends"),
            ("GAME", "Game", "For game engines with many trees: fewer joints in branches"),
            ("DEFAULT", "Default", "Trunks of up to 16 sides, limbs without visible kinks"),
            ("FILM", "Film", "For close-ups: trunks of up to 32 sides, all points of the file as joints"),
        ),
        default="DEFAULT",
    )
    lod_chain: BoolProperty(
        name="Import LOD Chain",
        description="Import the details Film, Default, Game and Base on one armature, named as in game engines: _LOD0 "
        "is Film",
        default=False,
    )
    max_bones: IntProperty(
        name="Max Bones",
        description="Maximum number of bones, 0 = all. Weights of removed bones move to their parents (bones)",
        default=1000,
        min=0,
    )
    max_bone_level: IntProperty(
        name="Max Bone Level",
        description="Highest branch level with bones, -1 = all (levels)",
        default=-1,
        min=-1,
    )
    show_bones: BoolProperty(
        name="Show Bones",
        description="Show the bones. Hidden bones still move the tree",
        default=False,
    )
    foliage: BoolProperty(
        name="Foliage", description="Import leaves, needles and flowers as a second object", default=True
    )
    foliage_names: StringProperty(
        name="Foliage Names",
        description="Beginnings of the names of groups, objects or materials that are foliage, separated by commas. If "
        "empty, found by common names and by shape",
    )
    snow_resolution: IntProperty(
        name="Snow Resolution",
        description="Side of the height map that the UV maps `snow` are packed for (texels)",
        default=1024,
        min=MIN_RESOLUTION,
        max=MAX_RESOLUTION,
    )
    wind_attributes: BoolProperty(
        name="Wind Attributes",
        description="Store the branch of each point in attributes _PIVOT, _AXIS, _LENGTH and _PHASE, for wind in games",
        default=False,
    )
    mark_asset: BoolProperty(
        name="Mark as Asset", description="Show the tree in the Asset Browser, with a picture", default=False
    )


ImportOptions = options_class("ImportOptions", ImportProperties)

# Headings of the options in dialogs, and the options of each. `simplify` and `tolerance` are for scripts.
SECTIONS = (
    ("file", "File", ("up_axis", "unit", "height", "levels", "outside_files")),
    ("surface", "Surface", ("keep_surface", "bones", "detail", "lod_chain", "width", "species")),
    ("bones", "Bones", ("max_bones", "max_bone_level", "show_bones")),
    ("foliage", "Foliage", ("foliage", "foliage_names")),
    ("extras", "Maps and Extras", ("snow_resolution", "wind_attributes", "mark_asset")),
)
