# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree in the form that the native module returns, made without an OBJ file."""

from types import SimpleNamespace

import numpy as np


def synthetic_bones(branches=4, segments=3, twigs=2):
    """Bones of a trunk along Z, `branches` limbs along X on it and `twigs` along Y on each limb.

    The trunk has one segment a limb, limbs and twigs have `segments`. Returns the keyword arguments of
    armature.BoneArrays.
    """
    rows = []

    def add(head, tail, parent, branch, level, segment, name, radius):
        rows.append((head, tail, parent, f"{name}.{segment}", branch, level, radius, radius * 0.8))
        return len(rows) - 1

    trunk = []
    for k in range(max(branches, 1)):
        trunk.append(add((0, 0, k), (0, 0, k + 1), k - 1, 0, 0, k, "trunk1", 0.2))
    branch = 1
    for k in range(branches):
        parent, limb = trunk[k], branch
        side = 1.0 if k % 2 else -1.0
        branch += 1
        for s in range(segments):
            head, tail = (side * s * 0.5, 0, k + 0.5), (side * (s + 1) * 0.5, 0, k + 0.5)
            parent = add(head, tail, parent, limb, 1, s, f"branch{limb}", 0.05)
            for t in range(twigs if s == 1 else 0):
                on = parent
                for u in range(segments):
                    at, to = ((side * (0.75 + 0.1 * t), y * 0.2, k + 0.5) for y in (u, u + 1))
                    on = add(at, to, on, branch, 2, u, f"twig{branch}", 0.01)
                branch += 1
    heads, tails, parents, names, of, levels, head_radii, tail_radii = zip(*rows)
    return {
        "heads": np.array(heads, np.float32),
        "tails": np.array(tails, np.float32),
        "parents": np.array(parents, np.int32),
        "names": list(names),
        "branches": np.array(of, np.int32),
        "levels": np.array(levels, np.int32),
        "head_radii": np.array(head_radii, np.float32),
        "tail_radii": np.array(tail_radii, np.float32),
    }


def synthetic_mesh(bones):
    """A four-sided open tube round every bone, weighted half to it and half to its parent at its head."""
    heads, tails, parents = bones["heads"], bones["tails"], bones["parents"]
    along = tails - heads
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    side = np.cross(along, (0.3, 0.5, 0.8))
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
    other = np.cross(along, side)
    ring = np.stack([side, other, -side, -other], axis=1) * bones["head_radii"][:, None, None]
    vertices = np.concatenate([heads[:, None] + ring, tails[:, None] + ring], axis=1).reshape(-1, 3)
    corner = np.array([[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)])
    count = len(heads)
    quads = (corner[None] + np.arange(count)[:, None, None] * 8).reshape(-1, 4).astype(np.int32)
    unit = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    uv = np.tile(unit, (len(quads), 1, 1))
    indices = np.zeros((count * 8, 4), np.int32)
    weights = np.zeros((count * 8, 4), np.float32)
    own = np.repeat(np.arange(count), 8)
    indices[:, 0], weights[:, 0] = own, 1.0
    base = (np.tile(np.arange(8) < 4, count)) & (parents[own] >= 0)
    weights[base, 0] = 0.5
    weights[base, 1] = 0.5
    indices[base, 1] = parents[own[base]]
    return SimpleNamespace(
        vertices=vertices.astype(np.float32),
        quads=quads,
        uv_bark=uv * 0.5,
        uv_snow=uv * 0.25,
        branch_level=np.repeat(bones["levels"], 4),
        bone_indices=indices,
        bone_weights=weights,
    )


def build_synthetic(addon, bones=None):
    """Makes armature and bark in the current scene; returns (rig, bark)."""
    import bpy

    armature, objects = addon("tree.armature"), addon("tree.objects")
    bones = bones or synthetic_bones()
    names = addon("tree.bone_names").fitting_names(bones["names"])
    arrays = armature.BoneArrays(**{**bones, "names": names})
    collection = bpy.data.collections.new("tree")
    bpy.context.scene.collection.children.link(collection)
    rig = armature.create_armature(bpy.context, "tree", arrays, collection)
    material = bpy.data.materials.new("bark")
    bark = objects.create_bark("tree_bark", synthetic_mesh(bones), names, [material])
    collection.objects.link(bark)
    objects.bind(bark, rig)
    return rig, bark


def evaluated_vertices(obj):
    """World positions (V, 3) of the object as its modifiers deform it now."""
    import bpy

    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    flat = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", flat)
    evaluated.to_mesh_clear()
    matrix = np.array(obj.matrix_world)
    return flat.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
