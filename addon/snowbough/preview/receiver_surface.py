# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface of one receiver in the live preview. No ``bpy``.

The end of the shot is not known yet, so the faces are planned from the current snow, and again after a large change."""

import numpy as np

# A surface is planned again if the depth has changed by these factors, or the covered area of the map by the last one.
DEEPER, THINNER, WIDER = 1.6, 0.5, 1.25
# Metres. Planning assumes at least PLANNED_DEPTH; texels with at most BARE count as bare.
PLANNED_DEPTH = 0.01
BARE = 0.001


class ReceiverSurface:
    """Points of the changing snow on a receiver. native: the module; most_points: approximate maximum; scale: factor on
    edge lengths."""

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
        """(T, 3) int32 indices of points. A change of the faces makes a new array."""
        self.shown = None
        """The last result of points()."""

    def on(self, topology):
        """A new ReceiverSurface for another mesh; the same object if the mesh is the same."""
        if self._topology.is_same(topology):
            return self
        return ReceiverSurface(self._native, topology, self._seed, self._most_points, self._scale)

    def points(self, heights, open_depth, positions, style):
        """((P, 3) metres in world space, (P, 3) unit normals) for heights (R, R) in metres and vertices (V, 3). Stores
        them in `shown`."""
        heights = np.ascontiguousarray(heights, dtype=np.float32)
        covered = int(np.count_nonzero(np.abs(heights) > BARE))
        depth = max(open_depth, PLANNED_DEPTH)
        if self._needs_new_plan(depth, covered):
            self._plan(heights, depth, covered, positions)
        self._surface.set_style(**style.sliders())
        points = self._surface.points(heights, open_depth, positions=positions)
        self.shown = points, self._native.point_normals(points, self.triangles)
        return self.shown

    def _needs_new_plan(self, depth, covered):
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
