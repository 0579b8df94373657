# SPDX-License-Identifier: GPL-3.0-or-later
"""The armature of a tree, from arrays of its bones, and the weights of the meshes that it deforms."""

from dataclasses import dataclass
from itertools import compress

import bmesh
import bpy
import numpy as np

from ..base import compat
from .bone_names import fitting_names

# Leaving edit mode silently deletes bones shorter than 1e-6. This share of the tree's height is safely above that, and
# far below any real bone.
SHORTEST_BONE = 1e-5


@dataclass
class BoneArrays:
    """One row per bone, parents before their children. Metres, Z up.

    heads, tails float32 (B, 3); parents int32 (B,), -1 for a root; names: list of str, unique; branches, levels int32
    (B,): the branch of a bone and the branch's level; head_radii, tail_radii float32 (B,): the limb's radius there.
    """

    heads: np.ndarray
    tails: np.ndarray
    parents: np.ndarray
    names: list
    branches: np.ndarray
    levels: np.ndarray
    head_radii: np.ndarray
    tail_radii: np.ndarray


def bone_arrays(tree):
    """BoneArrays of a native mesh, with names that fit Blender's limits."""
    return BoneArrays(
        tree.bone_heads,
        tree.bone_tails,
        tree.bone_parents,
        fitting_names(tree.bone_names),
        tree.bone_branches,
        tree.bone_levels,
        tree.bone_head_radii,
        tree.bone_tail_radii,
    )


def _usable_tails(bones):
    """The tails, with bones that are too short for Blender lengthened."""
    along = bones.tails - bones.heads
    lengths = np.linalg.norm(along, axis=1)
    extent = np.ptp(np.concatenate([bones.heads, bones.tails]), axis=0).max()
    shortest = max(SHORTEST_BONE * float(extent), SHORTEST_BONE)
    short = lengths < shortest
    along[short] = np.where(
        lengths[short, None] > 0, along[short] / np.maximum(lengths[short, None], 1e-30), (0.0, 0.0, 1.0)
    )
    along[short] *= shortest
    return np.where(short[:, None], bones.heads + along, bones.tails).astype(np.float32)


def create_armature(context, name, bones, collection):
    """Makes the armature object in `collection` and returns it; the object is active, in object mode.

    Plain bones (no B-bones) with the names `bones.names`. A segment that continues its branch is connected to the
    segment before, the first of a branch is not, so that the connections separate the limbs. The radii of the limb are
    the head and tail radius of the bones. Bones are grouped by branch level.
    """
    armature = bpy.data.armatures.new(name)
    rig = bpy.data.objects.new(name, armature)
    collection.objects.link(rig)
    context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        edit_bones = [armature.edit_bones.new(bone) for bone in bones.names]
        tails = _usable_tails(bones)
        for attribute, values in (
            ("head", bones.heads),
            ("tail", tails),
            ("head_radius", bones.head_radii),
            ("tail_radius", bones.tail_radii),
        ):
            flat = np.ascontiguousarray(values, dtype=np.float32).reshape(-1)
            armature.edit_bones.foreach_set(attribute, flat)
        continues = (bones.parents >= 0) & (bones.branches[bones.parents] == bones.branches)
        for bone, parent, connect in zip(edit_bones, bones.parents.tolist(), continues.tolist()):
            if parent >= 0:
                bone.parent = edit_bones[parent]
                bone.use_connect = connect
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")

    number = {bone: index for index, bone in enumerate(bones.names)}
    levels = [int(bones.levels[number[bone.name]]) for bone in armature.bones]
    deepest = max(levels, default=0)
    compat.assign_bone_level_groups(armature, levels, [f"Level {level}" for level in range(deepest + 1)])
    armature.display_type = "STICK"
    return rig


def write_weights(mesh, indices, weights):
    """Writes the weights into `mesh`, which has only vertices so far; the object has the names of the groups.

    indices int32 (V, K): vertex groups by number; weights float32 (V, K), 0 if unused; no bone twice in a row. This
    uses a BMesh: VertexGroup.add searches the list of groups for every vertex, which takes several times longer with a
    thousand bones. Edges and faces are added later, so that the BMesh stays small.
    """
    indices, weights = np.asarray(indices), np.asarray(weights)
    work = bmesh.new()
    try:
        work.from_mesh(mesh)
        layer = work.verts.layers.deform.verify()
        # Column by column: an inner loop over each vertex' own entries takes longer.
        for bones, shares in zip(indices.T, weights.T):
            used = shares > 0
            vertices = compress(work.verts, used.tolist())
            for vertex, bone, share in zip(vertices, bones[used].tolist(), shares[used].tolist()):
                vertex[layer][bone] = share
        work.to_mesh(mesh)
    finally:
        work.free()
