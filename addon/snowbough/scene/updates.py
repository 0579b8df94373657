# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that were edited since the pose before, e.g. by frame handlers, and not only deformed.

During a render Blender lists what each evaluation updated (``depsgraph.updates``), including edited meshes. Otherwise
the list may be from another moment, so meshes that should be still are compared.
"""

import bpy
import numpy as np

from ..base import compat


class Updates:
    """The updates of one evaluation of a depsgraph."""

    def __init__(self, depsgraph):
        self._is_sure = depsgraph.mode == "RENDER"
        # Names of objects and of meshes. A name may stand for several; then more are read than needed.
        self._objects, self._meshes = set(), set()
        for update in depsgraph.updates if self._is_sure else ():
            if update.is_updated_geometry:
                names = self._objects if isinstance(update.id, bpy.types.Object) else self._meshes
                names.add(update.id.name)

    def is_still(self, name):
        """Whether the shape of objects of that name, which nothing deforms, is unchanged: neither edited nor given
        another mesh."""
        return self._is_sure and name not in self._objects

    def is_edited(self, obj):
        """Whether an evaluated object's mesh was edited. Meshes with shape keys are listed at every frame and only
        move."""
        if not self._meshes:
            return False
        data = obj.original.data
        return (
            data.name in self._meshes
            and data.animation_data is None
            and not getattr(data, "shape_keys", None)
        )

    def may_be_edited(self, obj):
        """Whether the mesh was edited, or this is unknown."""
        return not self._is_sure or self.is_edited(obj)

    def is_unchanged(self, obj, record):
        """Whether an evaluated object that nothing deforms still has the mesh of a MeshRecord."""
        if self._is_sure:
            return False
        mesh = obj.data
        return (
            record.counts == (len(mesh.vertices), len(mesh.loops), len(mesh.polygons))
            and np.array_equal(record.positions, compat.read_positions(mesh))
            and np.array_equal(record.corners(), compat.read_corner_vertices(mesh))
        )
