# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of one pose in the space of their objects, read as rarely as possible.

The mesh of an object that nothing deforms is read once, and again if it was edited or replaced (scene.updates).
"""

from ..base.names import OWN_MODIFIERS
from . import material_alpha
from .libraries import library_name
from .mesh_record import MeshRecord, materials_of
from .updates import Updates

# These modifiers only move vertices: an object that has no others keeps its topology.
DEFORMING_MODIFIERS = {
    "ARMATURE", "CAST", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LATTICE", "MESH_DEFORM",
    "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "CORRECTIVE_SMOOTH", "LAPLACIANSMOOTH", "SURFACE_DEFORM",
    "WARP", "WAVE", "CLOTH", "COLLISION", "SOFT_BODY", "MESH_CACHE", "NORMAL_EDIT", "WEIGHTED_NORMAL",
    "UV_PROJECT", "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY",
    "SUBSURF", "MULTIRES", "MIRROR", "ARRAY", "SOLIDIFY", "TRIANGULATE",
}  # fmt: skip


def _is_deforming_only(obj):
    return all(modifier.type in DEFORMING_MODIFIERS for modifier in obj.modifiers)


def _is_rigid(obj, switch):
    """Whether the object's mesh in its own space is the same on every frame. Our own displacement is off during bakes
    and previews. switch: the property that says whether a modifier is on, as in Muted."""
    original = obj.original
    data = original.data
    return (
        original.type == "MESH"
        and all(
            modifier.name in OWN_MODIFIERS and not getattr(modifier, switch)
            for modifier in original.modifiers
        )
        and data.shape_keys is None
        and data.animation_data is None
        and not original.is_evaluated
    )


class LocalMeshes:
    """Reads the meshes of evaluated objects, pose by pose."""

    def __init__(self):
        # (object's name, library, whether it receives) -> result of read() for a rigid object.
        self._rigid = {}
        # The same -> identity of its mesh at the last pose.
        self._identities = {}
        # Results of read() in this pose.
        self._shared = {}
        self._updates = None
        self._switch = ""
        # Material's (name, library) -> material_alpha.AlphaImage or None; images are read once while it is unchanged.
        self._alphas = {}
        # (object's name, library, whether it receives) -> the alphas of its materials at the last pose.
        self._painted = {}

    def begin(self, depsgraph):
        """Starts the pose that a depsgraph has now."""
        self._switch = "show_render" if depsgraph.mode == "RENDER" else "show_viewport"
        self._updates = Updates(depsgraph)
        self._shared = {}
        self._current_alphas = {}

    def read(self, obj, receives):
        """(positions in the object's space, MeshRecord). Instances of one evaluated mesh share both within a pose, and
        poses share them while nothing can deform the object. receives: whether its shading is needed. (None, None) for
        objects without faces."""
        pointer = (obj.original.as_pointer(), obj.data.as_pointer() if obj.data else 0, receives)
        if pointer in self._shared:
            return self._shared[pointer]
        temporary = obj.type != "MESH"
        own = (obj.original.name, library_name(obj.original), receives)
        rigid = self._rigid.get(own)
        alphas = [] if temporary else [self._alpha_of(material) for material in materials_of(obj, obj.data)]
        is_repainted = self._is_repainted(own, alphas)
        is_still = rigid is not None and not is_repainted and self._updates.is_still(own[0])
        swapped = not temporary and not is_still and self._has_another_mesh(own, obj)
        if is_still or (
            rigid is not None
            and not is_repainted
            and not swapped
            and self._updates.is_unchanged(obj, rigid[1])
        ):
            rigid[1].may_change = rigid[1].is_edited = rigid[1].is_another = False
            self._shared[pointer] = rigid
            return rigid
        self._rigid.pop(own, None)
        mesh = obj.to_mesh() if temporary else obj.data
        if mesh is None or not len(mesh.polygons):
            self._shared[pointer] = (None, None)
            return self._shared[pointer]
        try:
            if temporary:
                alphas = [self._alpha_of(material) for material in materials_of(obj, mesh)]
            record = MeshRecord(mesh, alphas)
            record.is_another, record.is_edited = swapped, self._updates.is_edited(obj)
            record.may_change = (
                temporary
                or is_repainted
                or not _is_deforming_only(obj.original)
                or self._updates.may_be_edited(obj)
            )
            if temporary:
                record.detach(receives)
            found = (record.positions, record)
        finally:
            if temporary:
                obj.to_mesh_clear()
        if not temporary and _is_rigid(obj, self._switch):
            record.detach(receives)
            self._rigid[own] = found
        self._shared[pointer] = found
        return found

    def _has_another_mesh(self, own, obj):
        """Whether an object has another mesh than at the pose before."""
        data = obj.original.data
        mesh = (data.name, library_name(data), data.as_pointer())
        before = self._identities.get(own, mesh)
        self._identities[own] = mesh
        return mesh != before

    def _is_repainted(self, own, alphas):
        """Whether the alphas of an object's materials are others than at the pose before."""
        before = self._painted.get(own, alphas)
        self._painted[own] = alphas
        return len(before) != len(alphas) or any(a is not b for a, b in zip(before, alphas))

    def _alpha_of(self, material):
        """The alpha of a material at this pose: the same object while it is the same."""
        if material is None:
            return None
        known = (material.name, library_name(material))
        if known not in self._current_alphas:
            before = self._alphas.get(known)
            if known not in self._alphas or self._updates.is_repainted(material.name):
                try:
                    now = material_alpha.of_material(material)
                except material_alpha.UnknownAlpha:  # treated as opaque; preflight reports it
                    now = None
                is_same = before is not None and now is not None and before.print == now.print
                self._alphas[known] = before if is_same else now
            self._current_alphas[known] = self._alphas[known]
        return self._current_alphas[known]
