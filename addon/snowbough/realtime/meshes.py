# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts evaluated Blender meshes to records.Shape."""

import numpy as np

from ..base import compat
from ..scene.mesh_record import materials_of
from ..scene.pose import outliers
from .records import Paint, Shape


class MeshArrays:
    """The arrays of a mesh, each read once. Valid only while the mesh exists."""

    corners = 3
    """Corners per face."""

    def __init__(self, mesh):
        self._mesh = mesh
        compat.ensure_triangles(mesh)
        flat = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("loops", flat)
        self.triangle_corners = flat.reshape(-1, 3)
        self.positions = compat.read_positions(mesh)
        """(N, 3) float32. Vertices beyond names.FARTHEST or with non-finite coordinates are 0; their triangles are
        omitted."""
        self._kept = slice(None)
        lost = outliers(self.positions)
        self.has_outliers = lost is not None
        if self.has_outliers:
            self._kept = ~lost[self.triangles].any(axis=1)
            self.triangle_corners = self.triangle_corners[self._kept]
            self.positions[lost] = 0.0
        self._uv = {}

    @property
    def triangles(self):
        """(T, 3) int32 vertex indices."""
        return compat.read_corner_vertices(self._mesh)[self.triangle_corners]

    @property
    def normals(self):
        """(T, 3, 3) float32."""
        return compat.read_corner_normals(self._mesh)[self.triangle_corners]

    def materials(self, count):
        """(T,) int32 material indices, clamped below `count`."""
        indices = np.empty(len(self._mesh.loop_triangles), dtype=np.int32)
        self._mesh.loop_triangles.foreach_get("material_index", indices)
        return np.clip(indices, 0, count - 1)[self._kept]

    def uv(self, name):
        """(T, 3, 2) float32 of a UV map, or None if there is none. An empty name is the active UV map for rendering."""
        layers = self._mesh.uv_layers
        if not name:
            name = next((layer.name for layer in layers if layer.active_render), "")
        if name not in layers:
            return None
        if name not in self._uv:
            corners = compat.read_uv(layers[name], len(self._mesh.loops))
            self._uv[name] = corners[self.triangle_corners]
        return self._uv[name]


def painted(arrays, looks):
    """(uv (T, corners, 2), paint (T,), paints) of MeshArrays, or of an object with the same interface. looks: the Look
    of each material.

    If the mesh lacks the UV map of a material's image, the material shows only its colour.
    """
    paint = arrays.materials(len(looks))
    uv = np.zeros((len(paint), arrays.corners, 2), dtype=np.float32)
    paints = []
    for index, look in enumerate(looks):
        own = paint == index
        layer = arrays.uv(look.uv_map) if look.paint.image is not None else None
        if layer is None:
            paints.append(Paint(look.paint.color))
            continue
        (a, b, c), (d, e, f) = np.array(look.transform, dtype=np.float32)
        u, v = layer[own, :, 0], layer[own, :, 1]
        uv[own] = np.stack([a * u + b * v + c, d * u + e * v + f], axis=-1)
        paints.append(look.paint)
    return uv, paint, tuple(paints)


def looks_of(obj, mesh, look_of, plain):
    """The Look of each material index of an evaluated object's mesh; [plain] if it has no materials."""
    return [look_of(material) for material in materials_of(obj, mesh)] or [plain]


def shape_of(arrays, looks):
    """The Shape of MeshArrays. looks: the Look of each material."""
    return Shape(arrays.positions, arrays.triangles, arrays.normals, *painted(arrays, looks))
