# SPDX-License-Identifier: GPL-3.0-or-later
"""From an imported tree's objects to a records.Tree: its base from the skeleton that is kept, its pose as the rig has
it."""

import numpy as np

from .. import compat
from ..names import BARK_UV, LEAF_BONE_ATTRIBUTE, ORIGINAL_UV, SNOW_UV
from ..scene.inputs import fingerprint
from ..tree import kept_bark, kept_skeleton
from .materials import bark_of
from .meshes import MeshArrays, painted
from .records import Coat, Leaves, Tree


def rig_of(obj, mode):
    """The armature that moves an object of an imported tree, if that is all that moves it; else None.

    obj: the original object. mode: the depsgraph's. What somebody has put other modifiers on, or has edited, is
    not the tree any more that the importer kept.
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
    """Whether an object is bark with the vertices that the import gave it."""
    return obj.data.snowbough.bark_vertices == len(obj.data.vertices) > 0


class Surfaces:
    """Bases of trees by what their armatures keep, built once."""

    def __init__(self):
        self._known = {}

    def of(self, rig):
        """(arrays, fingerprint) of an armature object; (None, "") where it keeps none that can be read."""
        text = rig.data.snowbough_skeleton
        if text not in self._known:
            arrays = kept_skeleton.base_arrays(rig.data)
            print_ = "" if arrays is None else fingerprint(np.frombuffer(text.encode(), np.uint8))
            self._known[text] = (arrays, print_)
        return self._known[text]


def pose_of(obj, rig, place):
    """(B, 4, 4) float32: what takes each bone's rest pose, in the object's space, to the world.

    obj, rig: evaluated; the object's vertex groups are the bones in the order of the tree's arrays. place: where
    this instance of the object is, (4, 4). Groups whose bone is gone are left out.
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
    back = np.linalg.inv(to_rig)
    return (np.asarray(place, np.float64) @ back @ moved @ to_rig).astype(np.float32)


class BaseArrays:
    """What meshes.painted asks of a mesh, of a tree's four-sided base."""

    corners = 4

    def __init__(self, mesh, surface, kept):
        """mesh: the finest one's data; surface: what the native tree_arrays gave; kept: kept_bark.kept(), or None."""
        self._slots = np.zeros(len(surface["quads"]), np.int32) if kept is None else kept.slots
        self._uv = {BARK_UV: surface["bark_uv"]}
        if kept is not None:
            self._uv[ORIGINAL_UV] = kept.uv
        self._rendered = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")

    def materials(self, count):
        return np.clip(self._slots, 0, count - 1)

    def uv(self, name):
        return self._uv.get(name or self._rendered)


def coat_of(obj, rig, surface, looks):
    """The Coat of a tree's bark object with these looks; None where no image is to be seen on it."""
    kept = kept_bark.kept(rig.data)
    if kept is not None and len(kept.slots) != len(surface["quads"]):
        kept = None
    coat = Coat(*painted(BaseArrays(obj.data, surface, kept), looks))
    return coat if any(paint.image is not None for paint in coat.paints) else None


# Of a side of the map: two places closer to each other are the same one.
SAME_PLACE = 2.0**-20


class SnowPlaces:
    """The UV maps in which a map of snow can lie on a tree's base: that of the import, as long as the bark's mesh
    has it, too."""

    def __init__(self, mesh, surface):
        """mesh: the finest one's data, unedited; surface: what the native tree_arrays gave."""
        self._mesh = mesh
        self._places = surface["snow_uv"]
        self._is_kept = None

    def uv(self, name):
        """(Q, 4, 2) float32 of the base's corners; None where the map is another."""
        if name != SNOW_UV:
            return None
        if self._is_kept is None:
            self._is_kept = self._is_in_mesh()
        return self._places if self._is_kept else None

    def _is_in_mesh(self):
        """Whether the corners of the base are among those of the mesh, which is made by cutting it finer."""
        layer = self._mesh.uv_layers.get(SNOW_UV)
        if layer is None or not len(self._places):
            return False
        fine = _numbered(compat.read_uv(layer, len(self._mesh.loops)))
        return bool(np.isin(_numbered(self._places.reshape(-1, 2)), fine).all())


def _numbered(places):
    """One number a place (N, 2), the same for the same place."""
    cells = np.round(places.astype(np.float64) / SAME_PLACE).astype(np.int64)
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


def tree_of(key, surface, print_, look, pose, coat, snow):
    """A records.Tree without leaves; look: the bark's; print_: of the surface and the Coat; snow: records.LyingSnow
    on it, or None."""
    bark = bark_of(look)
    return Tree(key, surface, print_ + repr(bark), bark, pose, coat=coat, snow=snow)
