# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface of one receiver in the live preview. No ``bpy``.

It is planned from the snow that lies now, since the end of the shot is not known yet, and planned again when that snow
has changed much."""

import numpy as np

from ..surface.style import SurfaceStyle

# A surface is planned again once the depth has changed by these factors, or snow lies on so much more of the map.
DEEPER, THINNER, WIDER = 1.6, 0.5, 1.25
# Metres: thinner snow is planned for as if it were so deep, and counts as none on a map.
LEAST_DEPTH = 0.01
BARE = 0.001


class ReceiverSurface:
    """Points of the snow on a receiver as it changes. native: the module; most_points: about as many it may have."""

    def __init__(self, native, topology, seed, most_points, scale):
        self._native = native
        self._topology = topology
        self._seed = seed
        self._most_points = most_points
        self._scale = scale
        self._surface = None
        self._depth = 0.0
        self._covered = 0
        self.triangles = np.zeros((0, 3), np.int32)
        """(T, 3) of the points; another array once the faces are others."""
        self.shown = None
        """What points() gave last."""

    def on(self, topology):
        """The same snow on another mesh; itself while the mesh is the same."""
        if self._topology.is_same(topology):
            return self
        return ReceiverSurface(self._native, topology, self._seed, self._most_points, self._scale)

    def points(self, heights, open_depth, positions, style=None):
        """((P, 3) metres in the world, (P, 3) unit normals) for heights (R, R) in metres and vertices (V, 3); `shown`
        from now on."""
        heights = np.ascontiguousarray(heights, dtype=np.float32)
        covered = int(np.count_nonzero(np.abs(heights) > BARE))
        depth = max(open_depth, LEAST_DEPTH)
        if self._is_outgrown(depth, covered):
            self._plan(heights, depth, covered, positions)
        self._surface.set_style(**(style or SurfaceStyle()).sliders())
        points = self._surface.points(heights, open_depth, positions=positions)
        self.shown = points, self._native.point_normals(points, self.triangles)
        return self.shown

    def _is_outgrown(self, depth, covered):
        return (
            self._surface is None
            or not THINNER * self._depth <= depth <= DEEPER * self._depth
            or covered > WIDER * self._covered
        )

    def _plan(self, heights, depth, covered, positions):
        self._depth, self._covered = depth, covered
        self._surface = self._native.SnowSurface(
            self._topology.triangles,
            self._topology.corner_uv,
            positions,
            heights,
            np.abs(heights),
            depth,
            shading=self._topology.shading,
            scale=self._scale,
            most_points=self._most_points,
            seed=self._seed,
        )
        begin, corners, _ = self._surface.faces()
        sides = np.diff(begin)
        fans = [
            corners[begin[:-1][:, None] + (0, 1, 2)],
            corners[begin[:-1][sides == 4][:, None] + (0, 2, 3)],
        ]
        self.triangles = np.ascontiguousarray(np.concatenate(fans), dtype=np.int32)
