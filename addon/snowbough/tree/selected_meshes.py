# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a tree from mesh objects, as Blender's importers for other formats make them.

The objects' polygons take the place of an OBJ file: object names are its group names, material names its materials,
and pieces that share no vertices its loose parts.
"""

import json
import time
from typing import NamedTuple

import numpy as np

from ..base import compat
from ..base.names import counted
from . import import_tree, materials
from .native_tree import read_polygons

# Texture coordinates are compared in steps of 1 / UV_STEPS: formats that flip the V axis round them.
UV_STEPS = 1e5


class Polygons(NamedTuple):
    """The arguments of the native read_tree_mesh."""

    name: str
    vertices: np.ndarray  # float64 (V, 3), in the scene's space
    face_begin: np.ndarray
    corner_vertex: np.ndarray
    corner_uv: object  # float32 (C, 2), or None if no mesh has coordinates
    face_names: np.ndarray  # int32 (F, 2): index into names and into materials, -1 = none
    names: list
    materials: list


def _read_values(elements, name, kind, columns=1):
    values = np.empty(len(elements) * columns, dtype=kind)
    elements.foreach_get(name, values)
    return values


def _read_uv(mesh):
    """float32 (corners, 2), zero without a UV map; and whether there is one."""
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is None:
        return np.zeros((len(mesh.loops), 2), dtype=np.float32), False
    return compat.read_uv(layer, len(mesh.loops)), True


def _components(count, begin, end):
    """int64 (count,): the smallest vertex of each vertex's connected component. Edges run from begin to end."""
    label = np.arange(count)
    while True:
        joined = label.copy()
        least = np.minimum(label[begin], label[end])
        np.minimum.at(joined, begin, least)
        np.minimum.at(joined, end, least)
        joined = joined[joined]
        if np.array_equal(joined, label):
            return label
        label = joined


def _numbers(columns):
    """int64 (n,): equal numbers for rows that are equal in all columns."""
    order = np.lexsort(columns)
    is_other = np.zeros(len(order), dtype=bool)
    for column in columns:
        is_other[1:] |= np.diff(column[order]) != 0
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(is_other)
    return number


def _close_seams(vertices, counts, corners, uvs):
    """The vertex of each corner, after closing the seams at which glTF and PLY split a surface.

    Two open edges belong together if they lie at the same place in opposite directions and no third one lies there.
    Edges with the same texture coordinates come first: they distinguish the collapsed rings of a tube, whose faces have
    no area and whose edges lie at one place. Open ends of tubes that touch another branch keep their vertices.
    """
    place = _numbers(vertices.T)[corners]
    textured_place = _numbers([place, *np.round(uvs.T * UV_STEPS)])
    end = np.cumsum(counts)
    following = np.arange(1, len(corners) + 1)
    following[end - 1] = end - counts

    def edges(ends, among):
        """For each edge the number of its pair of ends; for each pair the number of its edges."""
        one, other = ends[among], ends[following[among]]
        number = _numbers([np.minimum(one, other), np.maximum(one, other)])
        return number, np.bincount(number)

    number, uses = edges(corners, np.arange(len(corners)))
    open_edges = np.flatnonzero(uses[number] == 1)
    joined = np.empty((2, 0), dtype=np.int64)
    for ends in (textured_place, place):
        number, uses = edges(ends, open_edges)
        order = np.argsort(number, kind="stable")
        begin = (np.cumsum(uses) - uses)[uses == 2]
        pairs = open_edges[np.stack([order[begin], order[begin + 1]])]
        pairs = pairs[:, ends[pairs[0]] == ends[following[pairs[1]]]]
        joined = np.concatenate([joined, pairs], axis=1)
        open_edges = np.setdiff1d(open_edges, pairs)
    one, other = joined
    return _components(
        len(vertices),
        corners[np.concatenate([one, following[one]])],
        corners[np.concatenate([following[other], other])],
    )[corners]


def read(context, objects):
    """(Polygons, {material name: material}, [a text for each object]) of mesh objects as the scene shows them. Raises
    ValueError if they have no faces."""
    graph = context.evaluated_depsgraph_get()
    active = context.view_layer.objects.active
    title = active.name if active in objects else objects[0].name
    vertices, counts, corners, uvs, textured, faces, taken, texts = [], [], [], [], False, [], {}, []
    first = 0
    for number, obj in enumerate(objects):
        evaluated = obj.evaluated_get(graph)
        mesh = evaluated.to_mesh()
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        local = _read_values(mesh.vertices, "co", np.float32, 3).reshape(-1, 3).astype(np.float64)
        vertices.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        counts.append(_read_values(mesh.polygons, "loop_total", np.int32))
        uv, has_uv = _read_uv(mesh)
        uvs.append(uv)
        indices = _close_seams(local, counts[-1], _read_values(mesh.loops, "vertex_index", np.int32), uv)
        corners.append(indices.astype(np.int32) + first)
        textured |= has_uv
        used = [slot.material for slot in evaluated.material_slots]
        used = [material and material.original for material in used]
        taken.update((material.name_full, material) for material in used if material is not None)
        known = list(taken)
        of_slot = [-1 if material is None else known.index(material.name_full) for material in used] or [-1]
        slots = _read_values(mesh.polygons, "material_index", np.int32).clip(0, len(of_slot) - 1)
        faces.append(np.stack([np.full(len(slots), number), np.array(of_slot)[slots]], axis=1))
        first += len(local)
        text = f"{obj.name} ({counted(len(slots), 'face')}{', with UV map' if has_uv else ''})"
        names = ", ".join(material.name for material in used if material is not None)
        texts.append(f"{text}, material {names}" if names else text)
        evaluated.to_mesh_clear()
    face_begin = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    if len(face_begin) == 1:
        raise ValueError(f"{title} has no faces: select the mesh objects of a tree")
    polygons = Polygons(
        title,
        np.concatenate(vertices),
        face_begin.astype(np.int32),
        np.concatenate(corners),
        np.concatenate(uvs) if textured else None,
        np.concatenate(faces).astype(np.int32),
        [obj.name for obj in objects],
        list(taken),
    )
    return polygons, taken, texts


def build(context, options):
    """Builds a tree from the selected mesh objects and hides them; returns (collection, report). Raises ValueError if
    they are not a tree."""
    started = time.perf_counter()
    objects = [obj for obj in context.selected_objects if obj.type == "MESH"]
    polygons, taken, texts = read(context, objects)
    tree = read_polygons(polygons, options, import_tree.units_per_metre(context.scene))
    tree.report["taken"] = texts
    own = materials.OwnMaterials(taken)
    collection = import_tree.create_trees(context, [(polygons.name, tree)], options, own)[0]
    for obj in objects:
        obj.hide_set(True)
        obj.hide_render = True
    tree.report["seconds"] = round(time.perf_counter() - started, 4)
    collection[import_tree.REPORT_PROPERTY] = json.dumps(tree.report)
    return collection, tree.report
