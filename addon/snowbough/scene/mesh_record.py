# SPDX-License-Identifier: GPL-3.0-or-later
"""The data of one evaluated mesh: positions, triangles, UV maps, shading, and the holes of its materials.

Shading: corners of a vertex that Blender shades with one normal share a number; corners of flat faces have none. This
covers smooth faces, sharp edges, Auto Smooth and the seams of custom normals. The direction of the shared normals
follows from the mesh's current shape, not from custom normals. The numbers are determined when the mesh is read, and
stay while it deforms.

A MeshRecord reads data from the mesh on first use, and only once. detach() reads everything, so that the record
outlives the mesh.
"""

import numpy as np

from ..base import compat
from .inputs import fingerprint
from .pose import SceneError, TopologyAlpha
from .uv_maps import choose_uv_map


def materials_of(obj, mesh):
    """The materials of an evaluated mesh on an evaluated object, by material index."""
    slots = obj.material_slots
    materials = list(mesh.materials)
    for index, slot in enumerate(slots):
        if slot.link == "OBJECT":
            materials[index : index + 1] = [slot.material]
    return materials


def alpha_uv_map(alpha, mesh):
    """The name of the UV map of a material_alpha.AlphaImage on a mesh, or None."""
    name = alpha.uv_map or _rendered_uv_map(mesh)
    return name if name in mesh.uv_layers else None


def join_alphas(alphas):
    """One TopologyAlpha from the MeshRecord.alpha of each instance, or None."""
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


def join_shadings(shadings, corner_counts):
    """One (T, 3) int32 from the MeshRecord.shading of each instance, or None if all are flat."""
    if all(own is None for own, _ in shadings):
        return None
    joined, offset = [], 0
    for (own, count), corners in zip(shadings, corner_counts):
        flat = np.full((count, 3), -1, dtype=np.int32)
        joined.append(flat if own is None else np.where(own < 0, -1, own + np.int32(offset)))
        offset += corners
    return np.ascontiguousarray(np.concatenate(joined), dtype=np.int32)


def number_corners(vertices, normals):
    """(L,) int32: the index of the first corner with the same vertex and the same normal (within 1/500)."""
    key = vertices.astype(np.int64)
    for axis in range(3):
        key = key * 2048 + np.clip(np.rint(normals[:, axis] * 512.0), -1023, 1023).astype(np.int64) + 1023
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    return first[group.reshape(-1)].astype(np.int32)


def _rendered_uv_map(mesh):
    """The UV map that image textures use without a UV Map node; empty if there is none."""
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), "")


class MeshRecord:
    """An evaluated mesh within one pose; after detach(), independent of it."""

    def __init__(self, mesh, alphas=()):
        self._mesh = mesh
        self._alphas = list(alphas)
        # Since the pose before: corners may differ; UVs may differ, too; or it is another mesh.
        self.may_change = self.is_edited = self.is_another = False
        self.positions = compat.read_positions(mesh)
        self.counts = (len(mesh.vertices), len(mesh.loops), len(mesh.polygons))
        self._corners = None
        self._triangle_corners = None
        self._triangle_materials = None
        self._shading = None
        self._uv = None
        self._active = self._rendered = ""

    def detach(self, with_shading):
        """Reads everything, so that the mesh may be freed. with_shading: shading() is needed."""
        self.corners()
        self.triangle_corners()
        mesh, self._uv = self._mesh, {}
        for layer in mesh.uv_layers:
            self._uv[layer.name] = compat.read_uv(layer, self.counts[1])
        self._active = mesh.uv_layers.active.name if mesh.uv_layers.active else ""
        self._rendered = _rendered_uv_map(mesh)
        if any(self._alphas):
            self.triangle_materials()
        if with_shading:
            self.shading(self.triangle_corners())
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
        """(T,) indices of materials, clamped to the existing ones."""
        if self._triangle_materials is None:
            indices = np.empty(len(self.triangle_corners()), dtype=np.int32)
            self._mesh.loop_triangles.foreach_get("material_index", indices)
            self._triangle_materials = np.clip(indices, 0, max(0, len(self._alphas) - 1))
        return self._triangle_materials

    def shading(self, corner_triangles):
        """((T, 3) int32 of the triangles, or None if all are flat; T). Corners with one number share a smooth normal;
        -1 is flat."""
        if self._shading is None:
            smooth = np.empty(self.counts[2], dtype=bool)
            self._mesh.polygons.foreach_get("use_smooth", smooth)
            self._shading = (smooth, None)
            if smooth.any():
                polygons = np.empty(len(self.triangle_corners()), dtype=np.int32)
                self._mesh.loop_triangles.foreach_get("polygon_index", polygons)
                normals = compat.read_corner_normals(self._mesh)
                self._shading = (smooth[polygons], number_corners(self.corners(), normals))
        smooth, numbers = self._shading
        if numbers is None:
            return None, len(corner_triangles)
        return np.where(smooth[:, None], numbers[corner_triangles], np.int32(-1)), len(corner_triangles)

    def alpha(self, corner_triangles):
        """(uv (T, 3, 2), image (T,), images) of the triangles, or (None, T, ()) if all are opaque."""
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
                continue  # without UVs it is treated as opaque, which preflight reports
            (a, b, c), (d, e, f) = np.array(alpha.transform, dtype=np.float32)
            u, v = layer[..., 0][corner_triangles[own]], layer[..., 1][corner_triangles[own]]
            uv[own] = np.stack([(a * u + b * v) + c, (d * u + e * v) + f], axis=-1)
            image[own] = len(images)
            images.append(alpha)
        return (uv, image, tuple(images)) if images else (None, count, ())

    @property
    def alpha_fingerprint(self):
        """Fingerprint of all that decides where snow falls through; empty for opaque meshes."""
        if not any(self._alphas):
            return ""
        prints = " ".join(alpha.print if alpha else "-" for alpha in self._alphas)
        return fingerprint(np.frombuffer(prints.encode(), np.uint8), self.triangle_materials())

    def _rendered_name(self):
        return _rendered_uv_map(self._mesh) if self._mesh is not None else self._rendered

    def _layer(self, name):
        """(L, 2) float32 of a UV map, or None."""
        if self._mesh is None:
            return self._uv.get(name)
        layer = self._mesh.uv_layers.get(name)
        return compat.read_uv(layer, self.counts[1]) if layer is not None else None

    def layer(self, name, label):
        """(L, 2) float32 of a UV map. Raises SceneError if there is none."""
        found = self._layer(name)
        if found is None:
            raise SceneError(f"The mask of '{label}' has no UV map '{name}': choose one, or set Mask to None")
        return found

    def uv(self, wanted, used, label, frame):
        """(name, (L, 2) float32). used: the map's name at an earlier pose, which must still exist, or empty. Raises
        SceneError if there is no map."""
        if self._mesh is not None:
            names = [layer.name for layer in self._mesh.uv_layers]
            active = self._mesh.uv_layers.active
            active = active.name if active else ""
        else:
            names, active = list(self._uv), self._active
        name = choose_uv_map(used or wanted, names, active)
        if name is None and used:
            raise SceneError(
                f"The faces of '{label}' change at frame {frame}, and its UV map '{used}' is gone, so its snow cannot "
                "follow: apply the modifier that changes the mesh, or remove "
                f"'{label}' from the list of receivers"
            )
        if name is None:
            missing = f"has no UV map '{wanted}'" if wanted and names else "has no UV map"
            raise SceneError(
                f"'{label}' {missing} at frame {frame}: unwrap it without overlaps, or use 'Add Snow to Selected' on "
                "the mesh itself, which adds one"
            )
        if self._mesh is None:
            return name, self._uv[name]
        return name, compat.read_uv(self._mesh.uv_layers[name], self.counts[1])
