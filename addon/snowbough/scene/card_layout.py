# SPDX-License-Identifier: GPL-3.0-or-later
"""A UV layout for meshes of thousands of small pieces, such as the leaf cards of a tree. No ``bpy``.

Blender's unwrappers place islands by comparing each with the others, which takes minutes for thousands of cards. Here
each piece is projected onto its mean plane and becomes a rectangle; rectangles are packed in shelves, the highest
first. All pieces keep their size relative to each other.
"""

import numpy as np

# Meshes with fewer pieces, or with larger ones, are left to Blender.
MIN_PIECES, MAX_FACES = 300, 16
# Faces of a piece may be turned from its mean plane by at most this angle (cosine), as for Smart UV Project.
FLAT = 0.41
# Space between rectangles, as a share of the mean side of a piece.
MARGIN = 0.15
MAX_ROUNDS = 64


def card_layout(positions, corners, begin):
    """(L, 2) UVs of a mesh's corners without overlaps between its pieces, or None if it does not consist of many small
    pieces. A folded piece is cut into its faces.

    positions: (V, 3); corners: (L,) vertices of all faces, one face after another; begin: (F,) first corner of each.
    """
    positions = np.asarray(positions, dtype=np.float64)
    faces = np.repeat(np.arange(len(begin)), np.diff(begin, append=len(corners)))
    onward = np.arange(1, len(corners) + 1)
    onward[np.append(begin[1:], len(corners)) - 1] = begin
    pieces = _pieces(len(positions), corners, corners[onward])
    if pieces is None:
        return None
    _, of_face = np.unique(pieces[corners[begin]], return_inverse=True)
    count = of_face.max(initial=-1) + 1
    if count < MIN_PIECES or len(begin) > MAX_FACES * count:
        return None
    relative = positions[corners] - positions[corners[begin]][faces]
    areas = np.add.reduceat(np.cross(relative, relative[onward]), begin)
    of_face = _cut(of_face, count, areas)
    count = of_face.max() + 1
    normals = _sums(of_face, areas, count)
    return _packed(*_flattened(positions[corners], onward, of_face[faces], _units(normals), count))


def _pieces(count, a, b):
    """A number per vertex that is equal for all vertices of a connected piece, None if pieces are long. a, b: the
    vertices of each edge."""
    label = np.arange(count)
    for _ in range(MAX_ROUNDS):
        before = label.copy()
        low = np.minimum(label[a], label[b])
        np.minimum.at(label, a, low)
        np.minimum.at(label, b, low)
        label = label[label]
        if np.array_equal(label, before):
            return label
    return None


def _sums(index, values, count):
    return np.stack([np.bincount(index, values[:, axis], count) for axis in range(values.shape[1])], axis=1)


def _units(vectors):
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors) + (0.0, 0.0, 1.0), where=length > 0.0)


def _cut(of_face, count, areas):
    """The piece of each face, after cutting folded pieces into faces."""
    facing = (_units(areas) * _units(_sums(of_face, areas, count))[of_face]).sum(axis=1)
    is_turned = (facing < FLAT) & (np.abs(areas).sum(axis=1) > 0.0)
    is_folded = np.bincount(of_face, is_turned, count)[of_face] > 0
    cut = np.where(is_folded, count + np.arange(len(of_face)), of_face)
    return np.unique(cut, return_inverse=True)[1]


def _flattened(places, onward, pieces, normals, count):
    """(places of the corners on the planes of their pieces, (L, 2), from 0; piece of each corner; (P, 2) sizes). The
    longest edge of a piece is level."""
    edges = places[onward] - places
    normal = normals[pieces]
    edges -= (edges * normal).sum(axis=1, keepdims=True) * normal
    longest = np.lexsort((-(edges**2).sum(axis=1), pieces))
    first = longest[np.searchsorted(pieces[longest], np.arange(count))]
    right = _units(edges[first])
    up = np.cross(normals, right)
    flat = np.stack([(places * axis[pieces]).sum(axis=1) for axis in (right, up)], axis=1)
    order = np.argsort(pieces, kind="stable")
    starts = np.searchsorted(pieces[order], np.arange(count))
    low = np.minimum.reduceat(flat[order], starts)
    high = np.maximum.reduceat(flat[order], starts)
    return flat - low[pieces], pieces, high - low


def _packed(flat, pieces, sizes):
    """UVs from 0 to 1 of the corners of rectangles."""
    margin = MARGIN * np.sqrt((sizes[:, 0] * sizes[:, 1]).mean()) or 1.0
    outer = sizes + margin
    width = max(np.sqrt(outer.prod(axis=1).sum()), outer[:, 0].max())
    for _ in range(4):
        places, height = _shelves(outer, width)
        width = max(np.sqrt(width * height), outer[:, 0].max())
    side = max((places[:, 0] + outer[:, 0]).max(), height)
    return (flat + places[pieces] + 0.5 * margin) / side


def _shelves(sizes, width):
    """((P, 2) places of rectangles, the height of all shelves)."""
    places = np.empty_like(sizes)
    x = y = shelf = 0.0
    for piece in np.argsort(-sizes[:, 1], kind="stable"):
        if x and x + sizes[piece, 0] > width:
            x, y, shelf = 0.0, y + shelf, 0.0
        places[piece] = x, y
        x, shelf = x + sizes[piece, 0], max(shelf, sizes[piece, 1])
    return places, y + shelf
