# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads an imported tree from the scene: its objects, its bones, and its meshes as TriangleMeshes.

The meshes are the objects' own data in rest pose, without modifiers such as those of the snow.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ..base import compat
from ..base.names import BARK_UV, LEAF_UV, ORIGINAL_UV, SNOW_UV
from ..tree.import_tree import LOD_PROPERTY
from ..tree.objects import LEVEL_ATTRIBUTE, point_levels
from ..tree.wind_attributes import AXIS, LENGTH, PHASE, PIVOT
from .tree_data import Joint
from .triangle_mesh import TriangleMesh, strongest, unit

# UV maps in the order of TEXCOORD_0, _1 and so on. ORIGINAL_UV exists only if the imported file had texture
# coordinates.
BARK_MAPS, LEAF_MAPS = (BARK_UV, SNOW_UV, ORIGINAL_UV), (LEAF_UV, SNOW_UV)


@dataclass
class SceneTree:
    """rig: the armature object; barks: mesh objects, the finest first; leaves: mesh objects, may be empty."""

    rig: bpy.types.Object
    barks: list
    leaves: list


def _is_bark(obj):
    return BARK_UV in obj.data.uv_layers and LEVEL_ATTRIBUTE in obj.data.attributes


def find(obj):
    """The SceneTree of an object: its armature, bark or leaves. Raises ValueError if the object is not part of a
    tree."""
    rig = obj if obj is None or obj.type == "ARMATURE" else obj.find_armature()
    meshes = [
        o for o in bpy.data.objects if o.type == "MESH" and rig is not None and o.find_armature() == rig
    ]
    meshes.sort(key=lambda o: o.name_full)
    barks = sorted(filter(_is_bark, meshes), key=lambda o: -o.get(LOD_PROPERTY, 0))
    if not barks:
        named = f"'{obj.name}' is not part of an imported tree" if obj is not None else "no object is active"
        raise ValueError(f"{named}: select the armature, bark or leaves of a tree that Snowbough imported")
    leaves = [o for o in meshes if o not in barks and LEAF_UV in o.data.uv_layers]
    return SceneTree(rig, barks, leaves)


def all_trees(scene):
    """{armature's name: armature} of the trees in a scene."""
    found = {}
    for obj in scene.objects:
        if obj.type == "MESH" and obj.find_armature() is not None and _is_bark(obj):
            found[obj.find_armature().name] = obj.find_armature()
    return found


def linear_part(rig, metres_per_unit):
    """(3, 3): from armature space to world space in metres, without the translation."""
    return np.array(rig.matrix_world.to_3x3(), dtype=np.float64) * metres_per_unit


def joints_of(rig, linear):
    """[Joint] of an armature's rest bones, parents first. linear: see linear_part; its scale and shear change the
    positions of the joints, but not their axes."""
    u, _, v = np.linalg.svd(linear)
    turn = u @ np.diag((1.0, 1.0, np.linalg.det(u @ v))) @ v
    size = abs(np.linalg.det(linear)) ** (1 / 3)
    joints, number = [], {}
    for bone in rig.data.bones:
        matrix = np.array(bone.matrix_local, dtype=np.float64)
        rest = np.eye(4)
        rest[:3, :3] = turn @ matrix[:3, :3]
        rest[:3, 3] = linear @ matrix[:3, 3]
        number[bone.name] = len(joints)
        parent = number[bone.parent.name] if bone.parent else -1
        lengths = (float(bone.length * size), float(bone.head_radius * size))
        joints.append(Joint(bone.name, parent, rest, *lengths, bool(bone.use_connect)))
    return joints


def bone_segments(rig):
    """(heads, tails), float64 (B, 3), in armature space."""
    heads = np.array([bone.head_local for bone in rig.data.bones], dtype=np.float64)
    return heads, np.array([bone.tail_local for bone in rig.data.bones], dtype=np.float64)


def _influences(obj, rig):
    """(joints, weights) of a mesh's points: see surface.strongest."""
    number = {bone.name: index for index, bone in enumerate(rig.data.bones)}
    joint = [number.get(group.name, -1) for group in obj.vertex_groups]
    rows = [
        [(joint[g.group], g.weight) for g in point.groups if g.group < len(joint) and joint[g.group] >= 0]
        for point in obj.data.vertices
    ]
    width = max(map(len, rows), default=0) or 1
    joints = np.zeros((len(rows), width), dtype=np.int32)
    weights = np.zeros((len(rows), width), dtype=np.float32)
    for index, row in enumerate(rows):
        if row:
            joints[index, : len(row)], weights[index, : len(row)] = zip(*row)
    return strongest(joints, weights)


def _point_levels(mesh, corner_point):
    """int32 (V,): the lowest branch level around each point."""
    level = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.attributes[LEVEL_ATTRIBUTE].data.foreach_get("value", level)
    begin = np.empty(len(mesh.polygons), dtype=np.int32)
    total = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", begin)
    mesh.polygons.foreach_get("loop_total", total)
    face = np.repeat(np.arange(len(total)), total)
    corners = np.repeat(begin, total) + np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
    return point_levels(corner_point[corners][:, None], level[face], len(mesh.vertices))


def _wind(mesh):
    """The mesh's wind attributes in the form of TriangleMesh.wind; None if one is missing."""
    found = []
    for name, field, shape in (
        (PIVOT, "vector", (3,)),
        (AXIS, "vector", (3,)),
        (LENGTH, "value", ()),
        (PHASE, "value", ()),
    ):
        attribute = mesh.attributes.get(name)
        if attribute is None or attribute.domain != "POINT" or not hasattr(attribute.data[0], field):
            return None
        values = np.empty((len(mesh.vertices), *shape), dtype=np.float32)
        attribute.data.foreach_get(field, values.reshape(-1))
        found.append(values)
    return tuple(found)


def _normals(mesh, to_rig):
    """float32 (C, 3): custom normals of the mesh in armature space; None without any."""
    if not mesh.has_custom_normals:
        return None
    return unit(compat.read_corner_normals(mesh) @ np.linalg.inv(to_rig)).astype(np.float32)


def surface_of(obj, rig, uv_maps):
    """The TriangleMesh of a mesh object in armature space. uv_maps: names in the order of TEXCOORD_0 and so on. Raises
    ValueError if one of the first two is missing; further missing ones are skipped."""
    mesh = obj.data
    missing = [name for name in uv_maps[:2] if name not in mesh.uv_layers]
    if missing:
        raise ValueError(f"'{obj.name}' has lost its UV map '{missing[0]}': import the tree again")
    if not len(mesh.polygons):
        raise ValueError(f"'{obj.name}' has no faces: import the tree again")
    compat.ensure_triangles(mesh)
    count = len(mesh.loop_triangles)
    triangles = np.empty((count, 3), dtype=np.int32)
    polygon = np.empty(count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", triangles.reshape(-1))
    mesh.loop_triangles.foreach_get("polygon_index", polygon)
    material = np.empty(len(mesh.polygons), dtype=np.int32)
    smooth = np.empty(len(mesh.polygons), dtype=bool)
    mesh.polygons.foreach_get("material_index", material)
    mesh.polygons.foreach_get("use_smooth", smooth)
    to_rig = np.array(rig.matrix_world.inverted() @ obj.matrix_world, dtype=np.float64)
    points = compat.read_positions(mesh) @ to_rig[:3, :3].T + to_rig[:3, 3]
    corner_point = compat.read_corner_vertices(mesh)
    layers = [mesh.uv_layers[name] for name in uv_maps if name in mesh.uv_layers]
    joints, weights = _influences(obj, rig)
    return TriangleMesh(
        points=points.astype(np.float32),
        joints=joints,
        weights=weights,
        corner_point=corner_point,
        corner_uvs=[compat.read_uv(layer, len(mesh.loops)) for layer in layers],
        triangles=triangles,
        material=np.minimum(material[polygon], max(len(obj.material_slots) - 1, 0)),
        smooth=smooth[polygon],
        level=_point_levels(mesh, corner_point) if _is_bark(obj) else None,
        wind=_wind(mesh),
        normals=_normals(mesh, to_rig[:3, :3]),
    )
