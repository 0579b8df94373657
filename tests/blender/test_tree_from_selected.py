# SPDX-License-Identifier: GPL-3.0-or-later
"""Build Tree from Selected: meshes that Blender's importers made give the skeleton of the OBJ file."""

import json

import bmesh
import bpy
import numpy as np
import pytest
from conftest import ROOT

MAPLE = ROOT / "tests" / "data" / "small_maple.obj"


def _through_fbx(folder):
    path = str(folder / "tree.fbx")
    bpy.ops.export_scene.fbx(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.import_scene.fbx(filepath=path)


def _through_gltf(folder):
    # The importer of Blender 3.4 uses a name that NumPy 1.24 dropped.
    if not hasattr(np, "bool"):
        np.bool = bool
    path = str(folder / "tree.glb")
    bpy.ops.export_scene.gltf(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)


def _unchanged(_folder):
    pass


def _through_ply(folder):
    """PLY has coordinates at vertices: it splits surfaces along the seams of the UV map."""
    path = str(folder / "tree.ply")
    (obj,) = bpy.context.scene.objects
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    if "ply_export" in dir(bpy.ops.wm):
        bpy.ops.wm.ply_export(filepath=path, export_uv=True, export_normals=False)
    else:
        bpy.ops.export_mesh.ply(filepath=path, use_normals=False, use_uv_coords=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    if "ply_import" in dir(bpy.ops.wm):
        bpy.ops.wm.ply_import(filepath=path)
    else:
        bpy.ops.import_mesh.ply(filepath=path)


def _torn_apart(_folder):
    """Every face has its own vertices, the finest split of any format."""
    for obj in bpy.context.scene.objects:
        mesh = bmesh.new()
        mesh.from_mesh(obj.data)
        bmesh.ops.split_edges(mesh, edges=mesh.edges)
        mesh.to_mesh(obj.data)
        mesh.free()
        assert len(obj.data.vertices) == len(obj.data.loops)


WAYS = [_unchanged, _through_fbx, _through_gltf, _through_ply, _torn_apart]


def _build(**settings):
    """The collection of the tree that is built from all meshes of the scene."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.type == "MESH")
    before = set(bpy.data.collections)
    assert bpy.ops.snowbough.build_tree_from_selected(**settings) == {"FINISHED"}
    (collection,) = set(bpy.data.collections) - before
    return collection


def _skeleton(addon, collection):
    (rig,) = (obj for obj in collection.objects if obj.type == "ARMATURE")
    assert tuple(rig.location) == (0, 0, 0)
    return addon("tree.kept_skeleton").kept(rig.data)[0]


def _check_same(found, wanted, height):
    assert len(found.branches) == len(wanted.branches)
    for branch, other in zip(found.branches, wanted.branches):
        assert branch.parent == other.parent
        assert np.abs(np.asarray(branch.points) - other.points).max() < 1e-5 * height
        assert np.abs(np.asarray(branch.radii) - other.radii).max() < 1e-5 * height


# FBX splits nothing: a tree of a thousand tubes shows no more than the small one.
CASES = [(MAPLE, way) for way in WAYS]
CASES += [("tubes/AL06a.obj", way) for way in (_through_gltf, _through_ply, _torn_apart)]


@pytest.mark.parametrize("source, way", CASES)
def test_the_skeleton_is_that_of_the_obj(source, way, addon, shared_tree, tmp_path):
    path = shared_tree(source) if isinstance(source, str) else source
    bpy.ops.import_scene.xfrog_tree(filepath=str(path), simplify="NONE")
    wanted = _skeleton(addon, bpy.data.collections[path.stem])
    height = max(branch.points[:, 2].max() for branch in wanted.branches)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.obj_import(filepath=str(path))
    way(tmp_path)
    _check_same(_skeleton(addon, _build(simplify="NONE")), wanted, height)


def _cross(name, place, size):
    """A mesh object of two limbs without shared vertices: a post and a bar on it, along the object's Z and X."""
    vertices, faces = [], []
    for begin, step, radius in (
        (np.zeros(3), (0, 0, 0.5), 0.2),
        (np.array((0, 0, 1.25)), (0.4, 0, 0.1), 0.1),
    ):
        first = len(vertices)
        for ring in range(5):
            for corner in range(6):
                angle = corner * np.pi / 3
                across = (np.cos(angle), np.sin(angle))
                side = (across[0], across[1], 0) if step[2] > 0.2 else (0, across[0], across[1])
                vertices.append(begin + ring * np.array(step) + radius * (1 - 0.15 * ring) * np.array(side))
        for ring in range(4):
            for corner in range(6):
                a, b = first + 6 * ring + corner, first + 6 * ring + (corner + 1) % 6
                faces.append((a, b, b + 6, a + 6))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], faces)
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    obj.location, obj.scale = place, (size,) * 3
    bpy.context.scene.collection.objects.link(obj)
    return obj


def test_the_tree_stands_where_the_objects_are_and_hides_them():
    obj = _cross("Oak.002", (5, 1, 2), 2.0)
    bpy.context.view_layer.objects.active = obj
    collection = _build()
    assert collection.name == "Oak.002.001" or collection.name == "Oak.002"
    (bark,) = (o for o in collection.objects if o.name.endswith("_bark"))
    low = np.array([v.co for v in bark.data.vertices]).min(axis=0)
    assert abs(low[2] - 2.0) < 0.05
    assert abs(np.mean([v.co.y for v in bark.data.vertices]) - 1.0) < 0.05
    assert obj.hide_get() and obj.hide_render
    report = json.loads(collection["snowbough_report"])
    assert report["file"] == "Oak.002"
    assert report["taken"] == ["Oak.002 (48 faces)"]
    assert report["branches"] == 2


def test_materials_are_copied_and_read_the_own_uv_map():
    obj = _cross("Elm", (0, 0, 0), 1.0)
    material = bpy.data.materials.new("Elm bark")
    material.use_nodes = True
    image = material.node_tree.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.new("bark", 4, 4)
    obj.data.materials.append(material)
    layer = obj.data.uv_layers.new(name="map1")
    for item, loop in zip(layer.data, obj.data.loops):
        x, y, z = obj.data.vertices[loop.vertex_index].co
        item.uv = (x, z)
    collection = _build()
    (bark,) = (o for o in collection.objects if o.name.endswith("_bark"))
    (own,) = bark.data.materials
    assert own != material and own.name.startswith("Elm bark")
    assert [layer.name for layer in bark.data.uv_layers] == ["bark", "snow", "original"]
    (node,) = (n for n in own.node_tree.nodes if n.type == "TEX_IMAGE")
    assert node.image == image.image
    assert node.inputs["Vector"].links[0].from_node.uv_map == "original"
    assert not image.inputs["Vector"].is_linked
    report = json.loads(collection["snowbough_report"])
    assert report["taken"] == ["Elm (48 faces, with UV map), material Elm bark"]


def test_objects_that_are_no_tree_are_refused_and_stay_as_they_are():
    bpy.ops.mesh.primitive_plane_add()
    plane = bpy.context.object
    with pytest.raises(RuntimeError, match="Plane: has no branches"):
        bpy.ops.snowbough.build_tree_from_selected()
    assert not plane.hide_get() and not bpy.data.collections


def test_without_a_mesh_the_operator_says_what_to_select():
    with pytest.raises(RuntimeError, match="Select the mesh objects of a tree"):
        bpy.ops.snowbough.build_tree_from_selected()
