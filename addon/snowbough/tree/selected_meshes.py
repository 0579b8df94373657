# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a tree from mesh objects, as Blender's importers for other formats make them.

The objects' polygons take the place of an OBJ file: object names are its group names, material names its materials,
and pieces that share no vertices its loose parts.
"""

import json
import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base import compat
from ..base.names import counted
from . import import_tree, materials
from .native_tree import read_polygons


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
    corner_normal: np.ndarray  # float32 (C, 3), in the scene's space


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


def _normal_matrix(matrix):
    """(3, 3), by which rows of normals are multiplied where `matrix` moves points. A mirror turns polygons
    inside out, and their normals with them."""
    return np.linalg.pinv(matrix) * np.sign(np.linalg.det(matrix) or 1.0)


def read(context, objects):
    """(Polygons, {material name: material}, [a text for each object]) of mesh objects as the scene shows them. Raises
    ValueError if they have no faces."""
    graph = context.evaluated_depsgraph_get()
    active = context.view_layer.objects.active
    title = active.name if active in objects else objects[0].name
    vertices, counts, corners, uvs, textured, faces, taken, texts = [], [], [], [], False, [], {}, []
    normals = []
    first = 0
    for number, obj in enumerate(objects):
        evaluated = obj.evaluated_get(graph)
        mesh = evaluated.to_mesh()
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        local = _read_values(mesh.vertices, "co", np.float32, 3).reshape(-1, 3).astype(np.float64)
        vertices.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        normals.append(compat.read_corner_normals(mesh) @ _normal_matrix(matrix[:3, :3]))
        counts.append(_read_values(mesh.polygons, "loop_total", np.int32))
        uv, has_uv = _read_uv(mesh)
        uvs.append(uv)
        corners.append(_read_values(mesh.loops, "vertex_index", np.int32) + first)
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
        np.concatenate(normals).astype(np.float32),
    )
    return polygons, taken, texts


def _title(scene, objects, wood):
    """The name of the tree: that of the empty or the collection that holds its objects, or else of its wood.

    wood: name of the object with most wood, or "".
    """
    if len(objects) == 1:
        return _parent_name(objects[0]) or objects[0].name
    parents = {_parent_name(obj) for obj in objects}
    if len(parents) == 1 and parents != {""}:
        return parents.pop()
    homes = [{home.name for home in obj.users_collection} for obj in objects]
    shared = set.intersection(*homes) - {scene.collection.name}
    # Blender's own name says nothing.
    shared = sorted(name for name in shared if not name.startswith("Collection"))
    return shared[0] if shared else wood or objects[0].name


def _parent_name(obj):
    return obj.parent.name if obj.parent is not None and obj.parent.type == "EMPTY" else ""


def build(context, options):
    """Builds a tree from the selected mesh objects and hides them; returns (collection, report). Raises ValueError if
    they are not a tree. Up is Z, as in the scene, unless the options say Y."""
    started = time.perf_counter()
    if options.up_axis == "AUTO":
        options = replace(options, up_axis="Z")
    objects = [obj for obj in context.selected_objects if obj.type == "MESH"]
    polygons, taken, texts = read(context, objects)
    tree = read_polygons(polygons, options, import_tree.units_per_metre(context.scene))
    tree.report["taken"] = texts
    own = materials.OwnMaterials(taken)
    title = _title(context.scene, objects, tree.report["wood_name"])
    tree.report["file"] = title
    collection = import_tree.create_trees(context, [(title, tree)], options, own)[0]
    for obj in objects:
        obj.hide_set(True)
        obj.hide_render = True
    tree.report["seconds"] = round(time.perf_counter() - started, 4)
    collection[import_tree.REPORT_PROPERTY] = json.dumps(tree.report)
    return collection, tree.report
