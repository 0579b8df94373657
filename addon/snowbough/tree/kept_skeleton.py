# SPDX-License-Identifier: GPL-3.0-or-later
"""What an imported tree keeps of its skeleton, so that other levels of detail of it can be built at any time, without
the file that it came from.

It lies on the armature's data (``armature.snowbough_skeleton``), not on an object: copies of a tree share it. A real
tree of 200 branches takes 70 KB.
"""

from dataclasses import asdict

import bpy

from .. import native
from .skeleton_text import from_text, to_text

# What build_tree_mesh and reduce_bones are told again.
OPTIONS = ("width", "species", "snow_resolution", "max_bones", "max_bone_level")


def keep(armature, tree, options):
    """Writes the skeleton of a NativeTree, and how fine its finest mesh is, onto a new armature."""
    built = {name: getattr(options, name) for name in OPTIONS}
    built["fineness"] = asdict(tree.meshes[-1].fineness)
    armature.snowbough_skeleton = to_text(tree.skeleton.branches, built)


def kept(armature):
    """(native Skeleton, what it was built with: a dict) of an imported tree's armature; None where it keeps none,
    as those of older imports. Raises ValueError for one that cannot be read."""
    if not armature.snowbough_skeleton:
        return None
    branches, built = from_text(armature.snowbough_skeleton)
    return native.load().Skeleton.from_branches([vars(branch) for branch in branches]), built


def base_arrays(armature):
    """The four-sided base of an imported tree, which the real-time renderer subdivides itself: what the native
    tree_arrays gives; None where the armature keeps no skeleton that can be read."""
    try:
        found = kept(armature)
    except ValueError:
        return None
    if found is None:
        return None
    skeleton, built = found
    module = native.load()
    base = module.build_tree_mesh(
        skeleton, built["width"], built["species"], lod=0, snow_resolution=built["snow_resolution"]
    )
    return module.tree_arrays(module.reduce_bones(base, built["max_bones"], built["max_bone_level"]))


def register():
    bpy.types.Armature.snowbough_skeleton = bpy.props.StringProperty(
        name="Skeleton", description="The tree's branches as they were imported", options={"HIDDEN"}
    )


def unregister():
    del bpy.types.Armature.snowbough_skeleton
