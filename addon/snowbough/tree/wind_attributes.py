# SPDX-License-Identifier: GPL-3.0-or-later
"""Point attributes by which a shader in a game engine can bend branches without bones.

As in Pivot Painter 2 (J. Lindquist, Epic Games, 2017), every point has the pivot and the direction of its branch. All
branches have the same attributes, so one shader suffices. Their names begin with an underscore, since glTF exports no
others.
"""

import numpy as np

# Base of the branch, in metres from the tree's origin; unit vector from there to its tip; distance between both in
# metres; a number from 0 to 1 that lets neighbours swing out of phase.
PIVOT, AXIS, LENGTH, PHASE = "_PIVOT", "_AXIS", "_LENGTH", "_PHASE"

_GOLDEN = 0.6180339887498949


def phases(count):
    """float32 (count,): multiples of the golden section modulo 1: evenly spread, neighbours far apart."""
    return ((np.arange(1, count + 1) * _GOLDEN) % 1.0).astype(np.float32)


def branch_axes(branches):
    """(pivot (B, 3), axis (B, 3), length (B,)) of native branches, float32."""
    pivot = np.array([branch.points[0] for branch in branches], dtype=np.float32)
    reach = np.array([branch.points[-1] for branch in branches], dtype=np.float32) - pivot
    length = np.linalg.norm(reach, axis=1)
    up = np.array((0.0, 0.0, 1.0), dtype=np.float32)
    axis = np.where(length[:, None] > 0, reach / np.maximum(length, 1e-30)[:, None], up)
    return pivot, axis.astype(np.float32), length.astype(np.float32)


def branch_of_points(quads, face_branch, branch_level, count):
    """int32 (count,): the branch of each point. If several meet, it is the one with the lowest level, then number, so
    that shared points move with the parent and nothing tears."""
    # Deepest level first: later ones overwrite it.
    order = np.lexsort((-face_branch, -branch_level[face_branch]))
    points = np.zeros(count, dtype=np.int32)
    points[quads[order].reshape(-1)] = np.repeat(face_branch[order], 4)
    return points


def _write(mesh, name, kind, values):
    attribute = mesh.attributes.new(name, kind, "POINT")
    field = "vector" if kind == "FLOAT_VECTOR" else "value"
    attribute.data.foreach_set(field, np.ascontiguousarray(values, dtype=np.float32).reshape(-1))


def _write_all(mesh, pivot, axis, length, phase):
    _write(mesh, PIVOT, "FLOAT_VECTOR", pivot)
    _write(mesh, AXIS, "FLOAT_VECTOR", axis)
    _write(mesh, LENGTH, "FLOAT", length)
    _write(mesh, PHASE, "FLOAT", phase)


def of_bark(branches, native_mesh):
    """(pivot (V, 3), axis (V, 3), length (V,), phase (V,)) of a native mesh of these branches, float32."""
    levels = np.array([branch.level for branch in branches], dtype=np.int32)
    of = branch_of_points(native_mesh.quads, native_mesh.face_branch, levels, len(native_mesh.vertices))
    return _of_points(branches, of)


def _of_points(branches, of):
    pivot, axis, length = branch_axes(branches)
    return pivot[of], axis[of], length[of], phases(len(branches))[of]


def add_to_points(mesh, branches, of):
    """Writes the attributes of a mesh whose points belong to the branches `of` (V,)."""
    _write_all(mesh, *_of_points(branches, np.asarray(of)))


def add_to_bark(mesh, skeleton, native_mesh):
    """Writes the attributes of a bark mesh."""
    _write_all(mesh, *of_bark(skeleton.branches, native_mesh))


def add_to_leaves(mesh, skeleton):
    """Writes the attributes of the leaves: the pivot is the attach point, and the axis points to the farthest point."""
    foliage = skeleton.foliage
    points = np.asarray(foliage.vertices)
    leaf = np.zeros(len(points), dtype=np.int32)
    leaf[foliage.corner_vertex] = np.repeat(foliage.face_leaf, np.diff(foliage.face_begin))
    pivot = np.asarray(foliage.leaf_attach_point)
    off = points - pivot[leaf]
    far = np.linalg.norm(off, axis=1)
    order = np.lexsort((far, leaf))
    last = order[np.r_[leaf[order][1:] != leaf[order][:-1], True]]
    tip = np.zeros(len(pivot), dtype=np.int64)
    tip[leaf[last]] = last
    length = far[tip]
    axis = off[tip] / np.maximum(length, 1e-30)[:, None]
    _write_all(mesh, pivot[leaf], axis[leaf], length[leaf], phases(len(pivot))[leaf])
