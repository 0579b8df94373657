# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangents of vertices, for normal textures: the space that bakers of normal maps and glTF assume. No ``bpy``.

Source: M. S. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, master's thesis, University of Copenhagen, 2008,
chapter 4: mean of the triangles' directions of u in the normal's plane, weighted by their angles there; triangles whose
texture is mirrored do not share vertices with others.
"""

import numpy as np

from .triangle_mesh import unit


def orientations(uv):
    """float32 (T,): -1 for triangles with a mirrored texture, 1 for others. uv (T, 3, 2)."""
    one, other = (uv[:, k].astype(np.float64) - uv[:, 0] for k in (1, 2))
    return np.where(one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0], -1.0, 1.0).astype(np.float32)


def _across(normals):
    """A unit vector at right angles to each normal (N, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    return unit(np.cross(normals, least))


def tangents(points, normals, uv, triangles):
    """float32 (V, 4): the direction of u, at right angles to the normal, and 1, or -1 if the texture is mirrored.

    points, normals (V, 3), uv (V, 2) with v upwards, triangles (T, 3): vertices that are split where they differ, and
    by orientations.
    """
    place, flat = points[triangles].astype(np.float64), uv[triangles].astype(np.float64)
    edges, turns = place[:, 1:] - place[:, :1], flat[:, 1:] - flat[:, :1]
    sign = orientations(flat)
    along = (edges[:, 0] * turns[:, 1, 1, None] - edges[:, 1] * turns[:, 0, 1, None]) * sign[:, None]
    normals = np.asarray(normals, np.float64)
    total = np.zeros(normals.shape)
    for k in range(3):
        vertex = triangles[:, k]
        normal = normals[vertex]

        def in_plane(vectors, normal=normal):
            vectors = vectors - (vectors * normal).sum(axis=1, keepdims=True) * normal
            length = np.linalg.norm(vectors, axis=1, keepdims=True)
            return np.where(length > 0, vectors / np.maximum(length, 1e-300), 0.0)

        onward, backward = (in_plane(place[:, (k + step) % 3] - place[:, k]) for step in (1, 2))
        angle = np.arccos(np.clip((onward * backward).sum(axis=1), -1.0, 1.0))
        np.add.at(total, vertex, angle[:, None] * in_plane(along))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    made = np.empty((len(points), 4), dtype=np.float32)
    made[:, :3] = np.where(length > 1e-9, total / np.maximum(length, 1e-300), _across(normals))
    made[:, 3] = 1.0
    made[triangles.reshape(-1), 3] = np.repeat(sign, 3)
    return made
