# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that were edited since the pose before, e.g. by frame handlers, and not only deformed.

During a render Blender lists what each evaluation updated (``depsgraph.updates``), including edited meshes. Otherwise
the list may be from another moment, so meshes that should be still are compared.
"""

import bpy
import numpy as np

from ..base import compat


class SwitchedModifiers:
    """Evaluates objects again whose modifiers Python has switched on or off. Blender then only copies the switch, while
    a render of that frame alone would evaluate it."""

    def __init__(self):
        # Pointer of an object -> its modifiers' switches at the last pose.
        self._switches = {}

    def update(self, depsgraph):
        """Only for render evaluation."""
        if depsgraph.mode != "RENDER":
            return
        is_outdated = False
        for evaluated in depsgraph.objects:
            if not evaluated.modifiers:
                continue
            obj = evaluated.original
            now = tuple((modifier.name, modifier.show_render) for modifier in obj.modifiers)
            if self._switches.get(obj.as_pointer(), now) != now:
                obj.update_tag(refresh={"DATA"})
                is_outdated = True
            self._switches[obj.as_pointer()] = now
        if is_outdated:
            depsgraph.update()


class Updates:
    """The updates of one evaluation of a depsgraph."""

    def __init__(self, depsgraph):
        self._is_sure = depsgraph.mode == "RENDER"
        # Names of objects and of meshes. A name may stand for several; then more are read than needed.
        self._objects, self._meshes = set(), set()
        self._materials, self._has_group = set(), False
        for update in depsgraph.updates if self._is_sure else ():
            if isinstance(update.id, bpy.types.Material):
                self._materials.add(update.id.name)
            elif isinstance(update.id, bpy.types.ShaderNodeTree) and update.id.name in bpy.data.node_groups:
                self._has_group = True
            if update.is_updated_geometry:
                names = self._objects if isinstance(update.id, bpy.types.Object) else self._meshes
                names.add(update.id.name)

    def is_repainted(self, material):
        """Whether the nodes of the material with that name may have changed. Groups do not say who uses them."""
        return self._has_group or material in self._materials

    def is_still(self, name):
        """Whether the shape of objects of that name, which nothing deforms, is unchanged: neither edited nor given
        another mesh."""
        return self._is_sure and name not in self._objects

    def is_edited(self, obj):
        """Whether an evaluated object's mesh may have been edited. Meshes with animation or shape keys are listed at
        every frame."""
        return bool(self._meshes) and obj.original.data.name in self._meshes

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
