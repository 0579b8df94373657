# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarser levels of detail than the coarsest surface: fewer branches, fewer leaves. No ``bpy``."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np


class Limb(NamedTuple):
    """A branch as the surface has it."""

    points: object
    parent: int
    """The branch whose surface it leaves, -1 for a root: not always the skeleton's."""


def branch_sizes(branches):
    """float64 (B,): the length of each branch, a measure of its visibility, but at least the size of its children, so
    that no branch is removed before its children. branches: Limbs, parents first."""
    size = np.array(
        [np.linalg.norm(np.diff(np.asarray(b.points, np.float64), axis=0), axis=1).sum() for b in branches]
    )
    for index in range(len(branches) - 1, -1, -1):
        if branches[index].parent >= 0:
            size[branches[index].parent] = max(size[branches[index].parent], size[index])
    return size


def kept_branches(branches, faces, target):
    """bool (B,): the largest branches whose faces together are at most `target`; roots stay. faces int (B,)."""
    roots = np.array([branch.parent < 0 for branch in branches])
    # Equal sizes: lower index first, so that a parent comes before its children.
    order = np.lexsort((np.arange(len(branches)), -branch_sizes(branches), ~roots))
    kept = np.zeros(len(branches), dtype=bool)
    kept[order] = np.cumsum(np.asarray(faces)[order]) <= target
    return kept | roots


def _cut_at(branches, kept):
    """int (B,): for each removed branch, its topmost removed ancestor, or itself; -1 for kept branches."""
    top = np.full(len(branches), -1)
    for index, branch in enumerate(branches):
        if not kept[index]:
            above = top[branch.parent] if branch.parent >= 0 else -1
            top[index] = index if above < 0 else above
    return top


def _rims(quads, part):
    """(rims (R, 4), beyond (R, 4)): the loop of four half-edges around each part >= 0 that joins another part, as
    indices 4 * face + corner, in order; and their opposite half-edges.

    part int (F,). Raises ValueError if a rim does not have four edges: the mesh is not a closed four-sided base.
    """
    begin, end = quads.reshape(-1).astype(np.int64), np.roll(quads, -1, axis=1).reshape(-1).astype(np.int64)
    count = int(quads.max()) + 1
    forward, backward = begin * count + end, end * count + begin
    order = np.argsort(forward)
    place = np.minimum(np.searchsorted(forward[order], backward), len(order) - 1)
    twin = order[place]
    if not np.array_equal(forward[twin], backward):
        raise ValueError("the mesh is not closed: branches cannot be removed")
    of = np.repeat(part, 4)
    rim = np.flatnonzero((of >= 0) & (of != of[twin]))
    rim = rim[np.argsort(of[rim], kind="stable")]
    if len(rim) % 4 or (of[rim].reshape(-1, 4) != of[rim].reshape(-1, 4)[:, :1]).any():
        raise ValueError("a branch does not have four sides: only the four-sided base can lose branches")
    rims = rim.reshape(-1, 4)
    for k in range(1, 3):  # sort the edges so that each begins where the one before ends
        follows = begin[rims[:, k:]] == end[rims[:, k - 1]][:, None]
        found = k + np.argmax(follows, axis=1)
        rows = np.arange(len(rims))
        rims[rows, k], rims[rows, found] = rims[rows, found], rims[rows, k]
    if not np.array_equal(begin[np.roll(rims, -1, axis=1)], end[rims]):
        raise ValueError("a branch does not have four sides: only the four-sided base can lose branches")
    return rims, twin[rims]


def without_branches(quads, corner_uvs, face_branch, branches, kept):
    """(quads, corner_uvs, faces): a closed four-sided mesh without the branches that are not `kept`. If a branch is
    kept, its parent must be kept.

    A quad closes the hole of each removed branch. It takes its UVs from the adjacent faces, so that bark and snow
    continue across it. corner_uvs: (F, 4, 2) each. faces int (F',): the index of each face in the input; for a closing
    quad the index of an adjacent face. Raises ValueError if the mesh is not a closed four-sided base.
    """
    part = _cut_at(branches, kept)[face_branch]
    stays = np.flatnonzero(part < 0)
    rims, beyond = _rims(quads, part)
    inside = quads[stays]
    if not len(rims):
        return inside, [uv[stays] for uv in corner_uvs], stays
    caps = quads.reshape(-1)[rims]
    # A corner of the cap is the start of its edge. The opposite half-edge ends there, and the opposite half-edge of the
    # edge before begins there. If both belong to removed branches, any kept face at the point gives the UV.
    anywhere = np.zeros(int(quads.max()) + 1, dtype=np.int64)
    anywhere[inside.reshape(-1)] = (stays[:, None] * 4 + np.arange(4)).reshape(-1)
    source = anywhere[caps]
    before = np.roll(beyond, 1, axis=1)
    source = np.where(part[before // 4] < 0, before, source)
    source = np.where(part[beyond // 4] < 0, beyond // 4 * 4 + (beyond + 1) % 4, source)
    uvs = [np.concatenate([uv[stays], uv.reshape(-1, 2)[source]]) for uv in corner_uvs]
    return np.concatenate([inside, caps]), uvs, np.concatenate([stays, source[:, 0] // 4])


def leaf_of_points(surface):
    """(number of leaves, int32 (V,)): the leaf of each point, a connected component of triangles; -1 for unused
    points."""
    label = np.arange(len(surface.points))
    joined = surface.corner_point[surface.triangles]
    while True:
        least = label[joined].min(axis=1)
        before = label.copy()
        np.minimum.at(label, joined.reshape(-1), np.repeat(least, 3))
        label = label[label]
        if np.array_equal(before, label):
            break
    used = np.zeros(len(label), dtype=bool)
    used[joined.reshape(-1)] = True
    leaves, numbers = np.unique(label[used], return_inverse=True)
    of = np.full(len(label), -1, dtype=np.int32)
    of[used] = numbers
    return len(leaves), of


def thinned_leaves(surface, share, stems=None):
    """A TriangleMesh with `share` of the leaves, each enlarged by 1 / sqrt(share), so that the covered area stays.

    Leaves that share points count as one. The choice is deterministic and evenly spread, and a smaller share is a
    subset of a larger one. A leaf is enlarged about its point nearest to its bone, or about its centre without `stems`.
    stems (V, 3): for each point the nearest position on its bone.

    Source: R. L. Cook, J. Halstead, M. Planck, D. Ryu, Stochastic Simplification of Aggregate Detail, SIGGRAPH 2007.
    """
    count, leaf = leaf_of_points(surface)
    if count == 0 or share >= 1.0:
        return surface
    # Multiples of the golden ratio: each prefix of the order is evenly spread over the tree.
    order = np.argsort((np.arange(1, count + 1) * 0.6180339887498949) % 1.0, kind="stable")
    kept = np.zeros(count, dtype=bool)
    kept[order[: max(1, round(count * share))]] = True
    own = leaf >= 0
    points = surface.points.astype(np.float64)
    anchor = _anchors(points, leaf, own, count, stems)
    larger = 1.0 / np.sqrt(kept.mean())
    points[own] = anchor[leaf[own]] + larger * (points[own] - anchor[leaf[own]])
    wind = surface.wind
    if wind is not None:
        wind = (*wind[:2], (wind[2] * larger).astype(np.float32), wind[3])
    stays = kept[leaf[surface.corner_point[surface.triangles[:, 0]]]]
    return replace(
        surface,
        points=points.astype(np.float32),
        triangles=surface.triangles[stays],
        material=surface.material[stays],
        smooth=surface.smooth[stays],
        wind=wind,
    )


def clustered(points, triangles, cell):
    """(points, triangles) of snow in which the points of each cell of a grid are one point: their mean, but as high as
    the highest, so that thin snow stays on top of its limb. Triangles within fewer than three cells are left out. cell:
    side in metres, 0 changes nothing.

    Source: J. Rossignac, P. Borrel, Multi-Resolution 3D Approximations for Rendering Complex Scenes, Modeling in
    Computer Graphics, 1993.
    """
    if cell <= 0.0:
        return points, triangles
    places = np.floor(points.astype(np.float64) / cell).astype(np.int64)
    places -= places.min(axis=0)
    extent = places.max(axis=0) + 1
    keys = (places[:, 0] * extent[1] + places[:, 1]) * extent[2] + places[:, 2]
    _, cluster, count = np.unique(keys, return_inverse=True, return_counts=True)
    merged = np.full((len(count), 3), -np.inf, dtype=np.float32)
    for axis in (0, 1):
        merged[:, axis] = np.bincount(cluster, points[:, axis].astype(np.float64)) / count
    np.maximum.at(merged[:, 2], cluster, points[:, 2])
    corners = cluster[triangles]
    a, b, c = corners.T
    corners = corners[(a != b) & (b != c) & (c != a)]
    # Several triangles between the same three cells: one stays.
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    corners = corners[np.sort(first)]
    used, index, numbers = np.unique(corners, return_index=True, return_inverse=True)
    # In the order in which the triangles use them.
    order = np.argsort(index)
    number = np.empty(len(used), dtype=np.int32)
    number[order] = np.arange(len(used))
    return merged[used[order]], number[numbers.reshape(-1, 3)]


def _anchors(points, leaf, own, count, stems):
    """(count, 3): the point about which each leaf is enlarged."""
    if stems is None:
        sums = np.stack([np.bincount(leaf[own], points[own, axis], count) for axis in range(3)], axis=1)
        return sums / np.bincount(leaf[own], minlength=count)[:, None]
    number = np.flatnonzero(own)
    away = np.linalg.norm(points[own] - np.asarray(stems)[own], axis=1)
    order = np.lexsort((away, leaf[own]))
    first = np.unique(leaf[own][order], return_index=True)[1]
    return points[number[order[first]]]
