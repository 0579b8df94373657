# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake records of a receiver's shape, so that its snow surface can be computed without the scene. No ``bpy``.

``receiver.ply`` has the faces in the shot's last pose, ``positions.pc2`` the vertices of every frame, or of one where
they stand still in the space of the receiver (of an instance: of its instancer). Where that space is in each frame
stands in the manifest.
"""

import numpy as np

from ..cache.files import POSITIONS, RECEIVER
from .mesh_file import FileMesh, write_mesh
from .point_cache import PointCacheWriter

# Positions that differ by less than this part of the mesh's size are the same: those of an instance come from matrices.
SAME = 1e-6


class ReceiverRecorder:
    """Takes the poses of one receiver in the order of the frames and writes them with finish()."""

    def __init__(self, folder):
        self._folder = folder
        self._first = self._last = None
        self._count = 0
        self._cache = None
        self.changed_at = None
        """The first frame with other faces than the shot's first; no surface is made of such a receiver."""

    def add(self, frame, obj):
        """obj: the scene.pose.ObjectPose of the frame."""
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
        """Writes the files. Nothing for a receiver whose faces changed. Raises CacheError."""
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
        """Drops what was not finished."""
        if self._cache is not None:
            self._cache.close()
