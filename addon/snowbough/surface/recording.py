# SPDX-License-Identifier: GPL-3.0-or-later
"""Records the shape of a receiver during a bake, so that its snow surface can be computed without the scene. No
``bpy``.

``receiver.ply`` contains the faces in the last pose of the shot. ``positions.pc2`` contains the vertices of every
frame, or of one frame if they do not move in the space of the receiver (for an instance: of its instancer). The
manifest contains the matrix of that space for each frame.
"""

import numpy as np

from ..cache.files import POSITIONS, RECEIVER
from .mesh_file import FileMesh, write_mesh
from .point_cache import PointCacheWriter

# Tolerance of equal positions, as a share of the mesh's size. Positions of instances have rounding errors.
SAME = 1e-6


class ReceiverRecorder:
    """Records the poses of one receiver in the order of the frames. finish() completes the files."""

    def __init__(self, folder):
        self._folder = folder
        self._first = self._last = None
        self._count = 0
        self._cache = None
        self.changed_at = None
        """The first frame whose faces differ from those of the first frame, or None. Such receivers get no surface."""

    def add(self, frame, obj):
        """Records a frame. obj: its scene.pose.ObjectPose."""
        if self._first is None:
            self._first = obj
        elif not self._first.topology.is_same(obj.topology):
            self.changed_at = self.changed_at or frame
        self._last = obj
        if self.changed_at is not None:
            return
        if self._cache is None and not self._stands_still(obj):
            self._cache = PointCacheWriter(self._folder / POSITIONS, len(obj.local))
            for _ in range(self._count):
                self._cache.add(self._first.local)
        if self._cache is not None:
            self._cache.add(obj.local)
        self._count += 1

    def _stands_still(self, obj):
        before, now = self._first.local, obj.local
        if before is now:
            return True
        size = float(np.ptp(before, axis=0).max()) if len(before) else 0.0
        return bool(np.abs(before - now).max() <= SAME * size)

    def finish(self):
        """Writes the files, unless the faces changed. Raises CacheError."""
        if self._last is None or self.changed_at is not None:
            return
        topology = self._last.topology
        smooth = topology.shading
        write_mesh(
            self._folder / RECEIVER,
            FileMesh(
                self._last.local,
                np.zeros((0, 4), np.int32),
                topology.triangles,
                np.zeros((0, 4, 2), np.float32),
                topology.corner_uv,
                smooth,
            ),
        )
        if self._cache is None:
            with PointCacheWriter(self._folder / POSITIONS, len(self._first.local)) as cache:
                cache.add(self._first.local)
                cache.publish()
        else:
            self._cache.publish()

    def close(self):
        """Removes unfinished files."""
        if self._cache is not None:
            self._cache.close()
