# SPDX-License-Identifier: GPL-3.0-or-later
"""Which way snow grows on a mesh as it bends: its smooth points' normals and its flat triangles'. No ``bpy``.

A smooth point's normal is the mean of its triangles' normals, weighted by their angles there (G. Thuermer,
C. A. Wuethrich, Computing Vertex Normals from Polygonal Facets, 1998), as Blender and the simulation have it.
"""

import numpy as np


class NormalTable:
    """A table of normals for a scene.pose.Topology: one a smooth point, then one a triangle."""

    def __init__(self, topology):
        self._triangles = topology.triangles
        count = len(topology.triangles)
        self._smooth = None
        of_triangle = np.arange(count, dtype=np.int32)[:, None]
        self.corners = np.repeat(of_triangle, 3, axis=1)
        """(T, 3) int32: the normal of every corner in the table."""
        if topology.shading is not None and (topology.shading >= 0).any():
            self._smooth = topology.shading >= 0
            numbers, point = np.unique(topology.shading[self._smooth], return_inverse=True)
            self._point = point.reshape(-1)
            self._points = len(numbers)
            self.corners += np.int32(self._points)
            self.corners[self._smooth] = self._point

    def compute(self, positions):
        """(N, 3) float32 unit normals for positions (V, 3); zero where there is no surface."""
        corners = positions[self._triangles]
        edges = np.roll(corners, -1, axis=1) - corners
        flat = _unit(np.cross(edges[:, 0], -edges[:, 2]))
        if self._smooth is None:
            return flat.astype(np.float32)
        along = _unit(edges)
        cosine = -(along * np.roll(along, 1, axis=1)).sum(axis=2)
        weighted = (np.arccos(np.clip(cosine, -1.0, 1.0))[..., None] * flat[:, None])[self._smooth]
        sums = [np.bincount(self._point, weighted[:, axis], self._points) for axis in range(3)]
        return np.concatenate([_unit(np.stack(sums, axis=1)), flat]).astype(np.float32)


def _unit(vectors):
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return vectors / np.maximum(length, 1e-30)
