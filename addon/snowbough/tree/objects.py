# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes Blender's meshes and objects from native arrays.

A :class:`Ledger` records the data-blocks that are made, so that an error leaves nothing behind.
"""

import bpy
import numpy as np

from ..base import compat, native
from ..base.names import BARK_UV, LEAF_BONE_ATTRIBUTE, LEAF_UV, ORIGINAL_UV, POINT_LEVEL_ATTRIBUTE, SNOW_UV
from . import armature
from .bone_names import NAME_BYTES, clip_utf8

LEVEL_ATTRIBUTE = "branch_level"


class Ledger:
    """A context that removes all data-blocks made in it if an error leaves it."""

    KINDS = ("objects", "meshes", "armatures", "collections", "materials", "images", "actions")

    def __enter__(self):
        self._before = {kind: {block.name_full for block in getattr(bpy.data, kind)} for kind in self.KINDS}
        return self

    def __exit__(self, kind, error, trace):
        if error is not None:
            made = [
                block
                for kind in self.KINDS
                for block in getattr(bpy.data, kind)
                if block.name_full not in self._before[kind]
            ]
            bpy.data.batch_remove(made)
        return False


def file_title(path_stem, room):
    """The file's name for data-blocks, with `room` bytes left for a suffix."""
    return clip_utf8(path_stem, NAME_BYTES - room) or "tree"


def _checked(corner_vertex, vertex_count):
    if len(corner_vertex) and (corner_vertex.min() < 0 or corner_vertex.max() >= vertex_count):
        raise ValueError("a face refers to a vertex that does not exist")
    return corner_vertex


def create_mesh(name, vertices, corner_vertex, face_begin, uvs, smooth, bones, weights, edges=None):
    """A mesh from flat arrays.

    vertices float32 (V, 3); corner_vertex int32 (L,); face_begin int32 (F + 1,): polygon f has the corners from
    face_begin[f] to face_begin[f + 1]; uvs: list of (name, float32 (L, 2)), in the order of the layers; bones int32,
    weights float32 (V, K): see armature.write_weights. edges: the native quad_edges of the polygons; otherwise Blender
    finds them, which takes longer. Raises ValueError for an index out of range.
    """
    corner_vertex = _checked(np.ascontiguousarray(corner_vertex, dtype=np.int32).reshape(-1), len(vertices))
    face_begin = np.ascontiguousarray(face_begin, dtype=np.int32)
    faces = len(face_begin) - 1
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    armature.write_weights(mesh, bones, weights)
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, dtype=np.float32).reshape(-1))
    mesh.loops.add(len(corner_vertex))
    compat.set_indices(mesh.loops, "vertex_index", corner_vertex)
    mesh.polygons.add(faces)
    compat.set_polygons(mesh, face_begin[:-1], np.diff(face_begin))
    mesh.polygons.foreach_set("use_smooth", np.full(faces, smooth, dtype=bool))
    for layer_name, _uv in uvs:
        mesh.uv_layers.new(name=layer_name, do_init=False)
    for layer_name, uv in uvs:
        compat.set_uv(mesh.uv_layers[layer_name], uv)
    if edges is not None:
        ends, of_corner = edges
        mesh.edges.add(len(ends))
        compat.set_indices(mesh.edges, "vertices", ends)
        compat.set_indices(mesh.loops, "edge_index", of_corner)
    mesh.update(calc_edges=edges is None)
    return mesh


def create_object(name, mesh, bone_names):
    """An object with `mesh` and a vertex group for each bone, in their order."""
    obj = bpy.data.objects.new(name, mesh)
    for bone in bone_names:
        obj.vertex_groups.new(name=bone)
    return obj


def point_levels(quads, face_level, vertex_count):
    """int32 (V,): the lowest branch level of the faces of each vertex; 0 without faces."""
    levels = np.zeros(vertex_count, dtype=np.int32)
    # Deepest level first: later ones overwrite it.
    for level in np.unique(face_level)[::-1]:
        levels[quads[face_level == level].reshape(-1)] = level
    return levels


def used_indices(chosen):
    """The different values of small indices >= 0, in order: np.unique would sort all."""
    return np.flatnonzero(np.bincount(chosen))


def _fill_slots(mesh, materials, chosen):
    """Gives the mesh the materials that its faces use, in order, and each face its slot.

    chosen int (F,): index into materials.
    """
    used = used_indices(chosen)
    slots = np.zeros(len(materials), dtype=np.int32)
    slots[used] = np.arange(len(used))
    for index in used.tolist():
        mesh.materials.append(materials[index])
    if len(used) > 1:
        compat.set_indices(mesh.polygons, "material_index", slots[chosen])


def create_bark(name, tree, bone_names, materials, face_material=None, original_uv=None):
    """The bark object: UV maps `bark`, `snow` and, if the export has it, `original` (in this order), branch levels,
    weights, and the materials in use.

    tree: the native mesh (vertices, quads, uv_bark, uv_snow, branch_level, bone_indices, bone_weights); bone_names: of
    the armature, one per native bone. materials: those of the export, then one for faces without; face_material int
    (F,): index into them, -1 for none; without it all faces have none. original_uv float32 (F, 4, 2) or None.
    """
    quads = np.asarray(tree.quads, dtype=np.int32)
    vertices = np.asarray(tree.vertices, dtype=np.float32)
    uvs = [(BARK_UV, tree.uv_bark), (SNOW_UV, tree.uv_snow)]
    if original_uv is not None:
        uvs.append((ORIGINAL_UV, original_uv))
    mesh = create_mesh(
        name,
        vertices,
        quads,
        np.arange(len(quads) + 1) * 4,
        uvs,
        smooth=True,
        bones=tree.bone_indices,
        weights=tree.bone_weights,
        edges=native.load().quad_edges(quads, len(vertices)),
    )
    levels = np.ascontiguousarray(tree.branch_level, dtype=np.int32)
    mesh.attributes.new(LEVEL_ATTRIBUTE, "INT", "FACE").data.foreach_set("value", levels)
    # As floats, since glTF has no 32-bit integer attributes.
    at_points = point_levels(quads, levels, len(vertices)).astype(np.float32)
    mesh.attributes.new(POINT_LEVEL_ATTRIBUTE, "FLOAT", "POINT").data.foreach_set("value", at_points)
    if face_material is None:
        face_material = np.full(len(quads), -1)
    _fill_slots(mesh, materials, face_material % len(materials))
    return create_object(name, mesh, bone_names)


def create_kept(name, surface, levels, kept, bone_names, materials):
    """The bark object that has the file's own polygons and normals: UV maps `bark`, `snow` and, if the file has
    coordinates, `original`; branch levels and weights.

    surface: the native KeptSurface; levels int (branches,); kept: native_tree.KeptBark; materials: one per native
    material, then one for faces without.
    """
    corner_vertex, face_begin = np.asarray(surface.corner_vertex), np.asarray(surface.face_begin)
    uvs = [(BARK_UV, kept.layout["bark"]), (SNOW_UV, kept.layout["snow"])]
    if surface.textured:
        uvs.append((ORIGINAL_UV, surface.corner_uv))
    mesh = create_mesh(
        name,
        surface.vertices,
        corner_vertex,
        face_begin,
        uvs,
        smooth=not surface.flat,
        bones=kept.bones,
        weights=kept.weights,
    )
    of_points = np.asarray(levels, dtype=np.int32)[np.asarray(surface.vertex_branch)]
    of_faces = of_points[corner_vertex[face_begin[:-1]]]
    mesh.attributes.new(LEVEL_ATTRIBUTE, "INT", "FACE").data.foreach_set("value", of_faces)
    attribute = mesh.attributes.new(POINT_LEVEL_ATTRIBUTE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", of_points.astype(np.float32))
    _fill_slots(mesh, materials, np.asarray(surface.face_material) % len(materials))
    if len(surface.corner_normal):
        compat.set_corner_normals(mesh, surface.corner_normal)
    return create_object(name, mesh, bone_names)


def create_leaves(name, foliage, snow_uv, leaf_bones, bone_names, materials):
    """The leaves object: UV maps `leaf` (the export's) and `snow`, the export's normals unless they are flat, each leaf
    with weight 1 for its bone.

    foliage: the native arrays. snow_uv float32 (C, 2). leaf_bones int32 (leaves,) into bone_names. materials: one per
    native material, then one for faces without; the slots are those in use.
    """
    corner_vertex, face_begin = np.asarray(foliage.corner_vertex), np.asarray(foliage.face_begin)
    uvs = [(LEAF_UV, foliage.corner_uv), (SNOW_UV, snow_uv)]
    vertex_leaf = np.full(len(foliage.vertices), -1, dtype=np.int32)
    vertex_leaf[corner_vertex] = np.repeat(foliage.face_leaf, np.diff(face_begin))
    bones = np.where(vertex_leaf >= 0, np.asarray(leaf_bones)[vertex_leaf], 0).astype(np.int32)[:, None]
    mesh = create_mesh(
        name,
        foliage.vertices,
        corner_vertex,
        face_begin,
        uvs,
        smooth=False,
        bones=bones,
        weights=np.ones(bones.shape, dtype=np.float32),
    )
    mesh.attributes.new(LEAF_BONE_ATTRIBUTE, "INT", "POINT").data.foreach_set("value", bones.reshape(-1))
    # -1, no material, becomes the last index.
    _fill_slots(mesh, materials, np.asarray(foliage.face_material) % len(materials))
    if len(foliage.corner_normal):
        compat.set_corner_normals(mesh, foliage.corner_normal)
    return create_object(name, mesh, bone_names)


def bind(obj, rig):
    """Parents `obj` to the armature and adds the modifier that deforms it."""
    obj.parent = rig
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    modifier.use_vertex_groups = True
    modifier.use_bone_envelopes = False
