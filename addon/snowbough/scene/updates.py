# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes have changed since the pose before, other than by what deforms them: frame handlers edit them.

While it renders Blender lists what each evaluation updated (``depsgraph.updates``): a mesh is among it when it was
edited, and at every frame when it has shape keys or animation of its own. Elsewhere the list may be that of another
moment, so meshes that should stand still are compared.
"""

import numpy as np

from .. import compat
from .pose import library_path


class Updates:
    """What one evaluation of a depsgraph updated."""

    def __init__(self, depsgraph):
        self._listed = None
        if depsgraph.mode == "RENDER":
            self._listed = {
                (type(update.id).__name__, update.id.name, library_path(update.id))
                for update in depsgraph.updates
                if update.is_updated_geometry
            }

    def _lists(self, id_block):
        return (type(id_block).__name__, id_block.name, library_path(id_block)) in self._listed

    def is_edited(self, obj):
        """Whether an evaluated object's mesh was edited."""
        return bool(self._listed) and self._lists(obj.original.data)

    def may_be_edited(self, obj):
        """Whether it was, or nobody can tell."""
        return self._listed is None or self.is_edited(obj)

    def is_unchanged(self, obj, record):
        """Whether an evaluated object that nothing deforms still has the mesh of a mesh_record.MeshRecord."""
        if self._listed is not None:
            return not (self._listed and (self._lists(obj.original) or self._lists(obj.original.data)))
        mesh = obj.data
        return (
            record.counts == (len(mesh.vertices), len(mesh.loops), len(mesh.polygons))
            and np.array_equal(record.positions, compat.read_positions(mesh))
            and np.array_equal(record.corners(), compat.read_corner_vertices(mesh))
        )
