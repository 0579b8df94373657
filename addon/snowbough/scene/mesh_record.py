# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of one evaluated mesh: positions, triangles, UV maps, and where its materials have holes.

A MeshRecord reads from the mesh what it is asked for, and only once; detach() reads all of it, so that the
record outlives the mesh.
"""

import numpy as np

from .. import compat
from .pose import SceneError, TopologyAlpha
from .uv_maps import choose_uv_map


def materials_of(obj, mesh):
    """The materials that an evaluated mesh shows on an evaluated object, by material index."""
    slots = obj.material_slots
    materials = list(mesh.materials)
    for index, slot in enumerate(slots):
        if slot.link == "OBJECT":
            materials[index : index + 1] = [slot.material]
    return materials


def alpha_uv_map(alpha, mesh):
    """The name of the UV map in which a mesh shows a material_alpha.AlphaImage, or None."""
    name = alpha.uv_map or _rendered_uv_map(mesh)
    return name if name in mesh.uv_layers else None


def join_alphas(alphas):
    """One TopologyAlpha of what MeshRecord.alpha gave for each instance, or None."""
    images = []
    for _, _, own in alphas:
        images += [image for image in own if not any(image is known for known in images)]
    if not images:
        return None
    uvs, indices = [], []
    for uv, index, own in alphas:
        if uv is None:
            uvs.append(np.zeros((index, 3, 2), dtype=np.float32))
            indices.append(np.full(index, -1, dtype=np.int32))
            continue
        place = [next(i for i, known in enumerate(images) if known is image) for image in own]
        uvs.append(uv)
        indices.append(np.array([*place, -1], dtype=np.int32)[index])
    return TopologyAlpha(np.concatenate(uvs), np.concatenate(indices), tuple(images))


def _rendered_uv_map(mesh):
    """The UV map that image textures show without a UV Map node; empty without any."""
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), "")


class MeshRecord:
    """An evaluated mesh within one pose; after detach() without it."""

    def __init__(self, mesh, may_change, alphas=()):
        self._mesh = mesh
        self._alphas = list(alphas)
        self.may_change = may_change
        self.positions = compat.read_positions(mesh)
        self.counts = (len(mesh.vertices), len(mesh.loops), len(mesh.polygons))
        self._corners = None
        self._triangle_corners = None
        self._triangle_materials = None
        self._uv = None
        self._active = self._rendered = ""

    def detach(self):
        """Reads everything, so that the mesh may go."""
        self.corners()
        self.triangle_corners()
        mesh, self._uv = self._mesh, {}
        for layer in mesh.uv_layers:
            self._uv[layer.name] = compat.read_uv(layer, self.counts[1])
        self._active = mesh.uv_layers.active.name if mesh.uv_layers.active else ""
        self._rendered = _rendered_uv_map(mesh)
        if any(self._alphas):
            self.triangle_materials()
        self._mesh = None

    def corners(self):
        if self._corners is None:
            self._corners = compat.read_corner_vertices(self._mesh)
        return self._corners

    def triangle_corners(self):
        """(T, 3) corner indices."""
        if self._triangle_corners is None:
            compat.ensure_triangles(self._mesh)
            flat = np.empty(len(self._mesh.loop_triangles) * 3, dtype=np.int32)
            self._mesh.loop_triangles.foreach_get("loops", flat)
            self._triangle_corners = flat.reshape(-1, 3)
        return self._triangle_corners

    def triangle_materials(self):
        """(T,) indices of materials, clamped to those there are."""
        if self._triangle_materials is None:
            indices = np.empty(len(self.triangle_corners()), dtype=np.int32)
            self._mesh.loop_triangles.foreach_get("material_index", indices)
            self._triangle_materials = np.clip(indices, 0, max(0, len(self._alphas) - 1))
        return self._triangle_materials

    def alpha(self, corner_triangles):
        """(uv (T, 3, 2), image (T,), images) of the triangles, or (None, T, ()) where all are opaque."""
        count = len(corner_triangles)
        if not any(self._alphas):
            return None, count, ()
        uv = np.zeros((count, 3, 2), dtype=np.float32)
        image = np.full(count, -1, dtype=np.int32)
        images = []
        for index, alpha in enumerate(self._alphas):
            if alpha is None:
                continue
            own = self.triangle_materials() == index
            layer = self._layer(alpha.uv_map or self._rendered_name()) if own.any() else None
            if layer is None:
                continue  # without UVs it counts as opaque: preflight says so
            (a, b, c), (d, e, f) = np.array(alpha.transform, dtype=np.float32)
            u, v = layer[..., 0][corner_triangles[own]], layer[..., 1][corner_triangles[own]]
            uv[own] = np.stack([(a * u + b * v) + c, (d * u + e * v) + f], axis=-1)
            image[own] = len(images)
            images.append(alpha)
        return (uv, image, tuple(images)) if images else (None, count, ())

    def _rendered_name(self):
        return _rendered_uv_map(self._mesh) if self._mesh is not None else self._rendered

    def _layer(self, name):
        """(L, 2) float32 of a UV map, or None."""
        if self._mesh is None:
            return self._uv.get(name)
        layer = self._mesh.uv_layers.get(name)
        return compat.read_uv(layer, self.counts[1]) if layer is not None else None

    def uv(self, wanted, used, label, frame):
        """(name, (L, 2) float32). used: the map's name at an earlier pose, which it must still be, or empty.
        Raises SceneError where there is none."""
        if self._mesh is not None:
            names = [layer.name for layer in self._mesh.uv_layers]
            active = self._mesh.uv_layers.active
            active = active.name if active else ""
        else:
            names, active = list(self._uv), self._active
        name = choose_uv_map(used or wanted, names, active)
        if name is None and used:
            raise SceneError(
                f"'{label}' has other faces at frame {frame} than before, and its UV map '{used}' is gone, so "
                "its snow has no place to stay: apply the modifier that changes the mesh, or take "
                f"'{label}' off the list of receivers"
            )
        if name is None:
            missing = f"has no UV map '{wanted}'" if wanted and names else "has no UV map"
            raise SceneError(
                f"'{label}' {missing} at frame {frame}: use 'Add Snow to Selected', which makes one, "
                "or unwrap it without overlaps"
            )
        if self._mesh is None:
            return name, self._uv[name]
        return name, compat.read_uv(self._mesh.uv_layers[name], self.counts[1])
