# SPDX-License-Identifier: GPL-3.0-or-later
"""The skeleton of an imported tree, stored on the armature's data (``armature.snowbough_skeleton``), so that other
levels of detail can be built without the imported file.

Copies of a tree share the armature's data. The skeleton of a real tree with 200 branches takes 70 KB.
"""

import bpy

from ..base import native
from .import_options import LOD_CHAIN
from .skeleton_text import from_text, to_text

# Options that are passed again to build_tree_mesh and reduce_bones.
OPTIONS = ("width", "species", "snow_resolution", "max_bones", "max_bone_level")


def keep(armature, tree, options):
    """Stores the skeleton of a NativeTree, and the detail of its finest mesh, on a new armature."""
    built = {name: getattr(options, name) for name in OPTIONS}
    built["root_bone"] = True
    built["detail"] = tree.meshes[-1].detail
    built["keeps_surface"] = tree.kept is not None
    armature.snowbough_skeleton = to_text(tree.skeleton.branches, built)


def kept(armature):
    """(native Skeleton, dict of the options it was built with) of an imported tree's armature; None if it has none, as
    in older imports. Raises ValueError if it cannot be read."""
    if not armature.snowbough_skeleton:
        return None
    branches, built = from_text(armature.snowbough_skeleton)
    if "detail" not in built:  # older versions counted levels, with the detail empty
        built["detail"] = built["fineness"]["detail"] or LOD_CHAIN[-1]
    built.setdefault("root_bone", False)  # older rigs of several roots have a root bone each
    return native.load().Skeleton.from_branches([vars(branch) for branch in branches]), built


def base_arrays(armature):
    """The four-sided base of an imported tree, which the real-time renderer subdivides, as from the native tree_arrays;
    None if the armature has no readable skeleton."""
    try:
        found = kept(armature)
    except ValueError:
        return None
    if found is None:
        return None
    skeleton, built = found
    module = native.load()
    base = module.build_tree_mesh(
        skeleton,
        built["width"],
        built["species"],
        snow_resolution=built["snow_resolution"],
        root_bone=built["root_bone"],
    )
    return module.tree_arrays(module.reduce_bones(base, built["max_bones"], built["max_bone_level"]))


def register():
    bpy.types.Armature.snowbough_skeleton = bpy.props.StringProperty(
        name="Skeleton", description="Branches of the tree as they were imported", options={"HIDDEN"}
    )


def unregister():
    del bpy.types.Armature.snowbough_skeleton
