# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the objects of an imported tree to a records.Tree. The base comes from the skeleton that the armature
stores, the pose from the rig."""

import numpy as np

from ..base import compat
from ..base.names import BARK_UV, LEAF_BONE_ATTRIBUTE, ORIGINAL_UV, SNOW_UV
from ..scene.inputs import fingerprint
from ..tree import kept_bark, kept_skeleton
from .materials import bark_of
from .meshes import MeshArrays, painted
from .records import BarkImages, Leaves, Tree


def rig_of(obj, mode):
    """The armature object of an object of an imported tree, or None if anything else deforms the object.

    obj: the original object. mode: the depsgraph's mode. An object with other modifiers or with shape keys no longer
    matches the tree that the importer stored.
    """
    shown = "show_render" if mode == "RENDER" else "show_viewport"
    modifiers = [modifier for modifier in obj.modifiers if getattr(modifier, shown)]
    if obj.type != "MESH" or [modifier.type for modifier in modifiers] != ["ARMATURE"]:
        return None
    rig = modifiers[0].object
    if rig is None or rig.type != "ARMATURE" or not rig.data.snowbough_skeleton or obj.data.shape_keys:
        return None
    return rig


def is_leaves(obj):
    return LEAF_BONE_ATTRIBUTE in obj.data.attributes


def is_unedited_bark(obj):
    """Whether an object is bark that still has the number of vertices from the import."""
    return obj.data.snowbough.bark_vertices == len(obj.data.vertices) > 0


class Bases:
    """Bases of trees, each built once from the skeleton that its armature stores."""

    def __init__(self):
        self._known = {}

    def of(self, rig):
        """(arrays, fingerprint) of an armature object; (None, "") if its skeleton cannot be read."""
        text = rig.data.snowbough_skeleton
        if text not in self._known:
            arrays = kept_skeleton.base_arrays(rig.data)
            print_ = "" if arrays is None else fingerprint(np.frombuffer(text.encode(), np.uint8))
            self._known[text] = (arrays, print_)
        return self._known[text]


def pose_of(obj, rig):
    """(B, 4, 4) float32: for each bone the matrix from its rest pose to its pose, in object space.

    obj, rig: evaluated objects. The vertex groups of obj are the bones in the order of the tree's arrays; groups whose
    bone was deleted are omitted.
    """
    bones, posed = rig.data.bones, rig.pose.bones
    count = len(bones)
    matrices = np.empty(16 * count, np.float32)
    posed.foreach_get("matrix", matrices)
    rest = np.empty(16 * count, np.float32)
    bones.foreach_get("matrix_local", rest)
    matrices, rest = (m.reshape(-1, 4, 4).transpose(0, 2, 1).astype(np.float64) for m in (matrices, rest))
    number = {bone.name: index for index, bone in enumerate(bones)}
    order = [number[group.name] for group in obj.vertex_groups if group.name in number]
    moved = matrices[order] @ np.linalg.inv(rest[order])
    to_rig = np.linalg.inv(np.array(rig.matrix_world)) @ np.array(obj.matrix_world)
    return (np.linalg.inv(to_rig) @ moved @ to_rig).astype(np.float32)


class BaseArrays:
    """A tree's four-sided base with the interface that meshes.painted needs."""

    corners = 4

    def __init__(self, mesh, surface, kept):
        """mesh: data of the finest mesh; surface: result of the native tree_arrays; kept: kept_bark.kept(), or None."""
        self._slots = np.zeros(len(surface["quads"]), np.int32) if kept is None else kept.slots
        self._uv = {BARK_UV: surface["bark_uv"]}
        if kept is not None:
            self._uv[ORIGINAL_UV] = kept.uv
        self._rendered = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")

    def materials(self, count):
        return np.clip(self._slots, 0, count - 1)

    def uv(self, name):
        return self._uv.get(name or self._rendered)


def bark_images_of(obj, rig, surface, looks):
    """The BarkImages of a tree's bark object, or None if none of its looks has an image."""
    kept = kept_bark.kept(rig.data)
    if kept is not None and len(kept.slots) != len(surface["quads"]):
        kept = None
    images = BarkImages(*painted(BaseArrays(obj.data, surface, kept), looks))
    return images if any(paint.image is not None for paint in images.paints) else None


# Coordinates are rounded to multiples of this share of the map's side, then compared.
SAME_UV = 2.0**-20


class SnowUvs:
    """The UV maps of a tree's base that a snow map can use: only that of the import, if the bark's mesh still has it
    unchanged."""

    def __init__(self, mesh, surface):
        """mesh: data of the finest mesh, unedited; surface: result of the native tree_arrays."""
        self._mesh = mesh
        self._uvs = surface["snow_uv"]
        self._is_kept = None

    def uv(self, name):
        """(Q, 4, 2) float32, coordinates of the base's corners; None for other UV maps."""
        if name != SNOW_UV:
            return None
        if self._is_kept is None:
            self._is_kept = self._is_in_mesh()
        return self._uvs if self._is_kept else None

    def _is_in_mesh(self):
        """Whether the mesh, a subdivision of the base, has all UV coordinates of the base's corners."""
        layer = self._mesh.uv_layers.get(SNOW_UV)
        if layer is None or not len(self._uvs):
            return False
        fine = _numbered(compat.read_uv(layer, len(self._mesh.loops)))
        return bool(np.isin(_numbered(self._uvs.reshape(-1, 2)), fine).all())


def _numbered(uvs):
    """(N,) numbers of the coordinates (N, 2); equal coordinates have equal numbers."""
    cells = np.round(uvs.astype(np.float64) / SAME_UV).astype(np.int64)
    return cells[:, 0] << 32 | cells[:, 1]


def leaves_of(obj, looks):
    """The Leaves of a tree's leaf object, in the rest pose."""
    mesh = obj.data
    arrays = MeshArrays(mesh)
    vertices = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", vertices.reshape(-1))
    bones = np.empty(len(mesh.vertices), np.int32)
    mesh.attributes[LEAF_BONE_ATTRIBUTE].data.foreach_get("value", bones)
    triangles = arrays.triangles
    return Leaves(vertices[triangles], bones[triangles[:, 0]], *painted(arrays, looks))


def tree_of(key, surface, print_, look, pose, matrix, images, snow):
    """A records.Tree in one instance, without leaves. look: the bark's Look; print_: fingerprint of the surface and the
    BarkImages; snow: the records.LyingSnow on the bark, or None."""
    bark = bark_of(look)
    return Tree(key, surface, print_ + repr(bark), bark, pose, matrix[None], bark_images=images, snow=snow)


def joined(trees):
    """The trees without snow of each rig as one tree in many instances. Those with snow keep a map of their own. trees:
    (name of the rig, key of the instance, records.Tree) of instances."""
    made, alike = [], {}
    for rig, instance, tree in trees:
        if tree.snow is not None:
            tree.key = f"tree {instance}"
            made.append([tree])
            continue
        # The instances of a rig may differ in their leaves. The first kind keeps its key if its look changes.
        kinds = alike.setdefault(rig, {})
        kind = (tree.print, tree.leaves_print)
        if kind not in kinds:
            tree.key = f"trees {rig} {len(kinds)}"
            kinds[kind] = []
            made.append(kinds[kind])
        kinds[kind].append(tree)
    for same in made:
        same[0].matrices = np.concatenate([tree.matrices for tree in same]).astype(np.float32)
    return sorted((same[0] for same in made), key=lambda tree: tree.key)
