# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Snow on objects whose geometry nodes scatter others, on meshes of cards, and on meshes without faces."""

import time

import bpy
import numpy as np
import pytest
import snow_scene as s


def scatter(obj, instance, realize=True, with_mesh=False):
    """Distribute Points > Instance on Points (> Realize Instances) on an object."""
    tree, given, made = s.node_tree()
    points = tree.nodes.new("GeometryNodeDistributePointsOnFaces")
    on_points = tree.nodes.new("GeometryNodeInstanceOnPoints")
    points.inputs["Density"].default_value = 10.0
    tree.links.new(given.outputs[0], points.inputs["Mesh"])
    tree.links.new(points.outputs["Points"], on_points.inputs["Points"])
    tree.links.new(s.instance_geometry(tree, instance), on_points.inputs["Instance"])
    last = on_points.outputs["Instances"]
    if realize:
        node = tree.nodes.new("GeometryNodeRealizeInstances")
        tree.links.new(last, node.inputs[0])
        last = node.outputs[0]
    if with_mesh:
        join = tree.nodes.new("GeometryNodeJoinGeometry")
        tree.links.new(last, join.inputs[0])
        tree.links.new(given.outputs[0], join.inputs[0])
        last = join.outputs[0]
    tree.links.new(last, made.inputs[0])
    obj.modifiers.new("Scatter", "NODES").node_group = tree


def add_snow(obj):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return bpy.ops.snowbough.add_receivers(setup_result=False)


def plain_square(name, size=1.0):
    h = size / 2
    return s.mesh_object(name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)])


@pytest.mark.parametrize("stone_has_uv", [False, True])
def test_realized_instances_are_refused_at_once_with_the_way_out(addon, stone_has_uv):
    ground = plain_square("Ground", 4.0)
    scatter(ground, s.square("Stone", 0.2) if stone_has_uv else plain_square("Stone", 0.2))
    with pytest.raises(RuntimeError, match="'Ground' make faces that have no place.*Visual Geometry to Mesh"):
        add_snow(ground)
    assert not len(bpy.context.scene.snowbough.receivers)
    assert not ground.data.uv_layers


def test_after_that_way_out_they_carry_snow(addon, tmp_path):
    ground = plain_square("Ground", 4.0)
    scatter(ground, plain_square("Stone", 0.2))
    ground.select_set(True)
    bpy.context.view_layer.objects.active = ground
    bpy.ops.object.convert(target="MESH")
    assert add_snow(ground) == {"FINISHED"}
    s.settings(tmp_path / "cache")
    s.bake()
    assert s.height(addon("base.native").load(), tmp_path / "cache", "Ground", 4).max() > 0.05


def test_ground_joined_with_instances_that_have_no_place_on_its_map_is_refused(addon):
    ground = s.square("Ground", 4.0)
    scatter(ground, plain_square("Stone", 0.2), with_mesh=True)
    with pytest.raises(RuntimeError, match="that have no place on the UV map 'snow'"):
        add_snow(ground)
    assert "snow" in ground.data.uv_layers


def test_instances_alone_are_refused_by_name_and_number(addon):
    ground = s.square("Ground", 4.0)
    scatter(ground, s.square("Stone", 0.2), realize=False)
    count = sum(i.is_instance for i in bpy.context.evaluated_depsgraph_get().object_instances)
    assert count > 50
    with pytest.raises(
        RuntimeError, match=rf"scatter {count} instances \('Stone' {count}\).*Realize Instances"
    ):
        add_snow(ground)


def test_ground_that_scatters_is_taken_and_the_instances_are_counted(addon):
    ground = s.square("Ground", 4.0)
    scatter(ground, s.square("Stone", 0.2), realize=False, with_mesh=True)
    assert add_snow(ground) == {"FINISHED"}
    receivers = addon("scene.receivers")
    counts = receivers.scattered_by(bpy.context, ground)
    assert list(counts) == ["Stone"] and counts["Stone"] > 50
    assert receivers.scattered_text({"Leaf": 1, "Stone": 2}) == "3 instances ('Leaf' 1, 'Stone' 2)"


def test_a_mesh_of_points_is_refused(addon):
    points = s.mesh_object("Points", [(0, 0, 0), (1, 0, 0)], [])
    with pytest.raises(RuntimeError, match="'Points' has no faces: it consists of points only"):
        add_snow(points)


def test_faces_that_only_nodes_make_are_refused_with_the_way_out(addon):
    points = s.mesh_object("Points", [(0, 0, 0), (1, 0, 0)], [])
    tree, _, made = s.node_tree()
    cube = tree.nodes.new("GeometryNodeMeshCube")
    tree.links.new(cube.outputs[0], made.inputs[0])
    points.modifiers.new("Cube", "NODES").node_group = tree
    with pytest.raises(RuntimeError, match="made by its geometry nodes.*Visual Geometry to Mesh"):
        add_snow(points)


def test_thousands_of_cards_get_snow_at_once():
    """The whole button; Blender's own unwrapping took 79 s. The cards of a tree share one place on its UV map."""
    chance = np.random.default_rng(1)
    turns = np.linalg.qr(chance.normal(size=(6283, 3, 3)))[0]
    corners = np.array([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0), (0, 0.1, 0)]) @ turns
    places = (corners + chance.normal(size=(6283, 1, 3))).reshape(-1, 3)
    faces = np.arange(4 * 6283).reshape(-1, 4)
    tree = s.mesh_object("Tree", places.tolist(), faces.tolist(), [(0, 0), (1, 0), (1, 1), (0, 1)] * 6283)
    tree.data.uv_layers[0].name = "UVMap"
    tree.select_set(True)
    bpy.context.view_layer.objects.active = tree
    begun = time.process_time()
    assert bpy.ops.snowbough.add_receivers() == {"FINISHED"}
    assert time.process_time() - begun < 4.0
    assert [layer.name for layer in tree.data.uv_layers] == ["UVMap", "snow"]
