# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow in Snowbough Realtime: on trees, which remain trees, and on instanced collections."""

from pathlib import Path

import bpy
import numpy as np
import pytest
import snow_scene
from mathutils import Vector
from realtime_shot import camera_at, material, pixel, rendered, set_up

MAPLE = Path(__file__).resolve().parent.parent / "data" / "small_maple.obj"

scene = pytest.fixture(set_up)


@pytest.fixture
def read(addon):
    """read(live=False): the records.Scene of the viewport's evaluation."""

    def of(live=False):
        bpy.context.view_layer.update()
        reader = addon("realtime.reader").Reader(addon("base.native").load(), shows_live=live)
        return reader.read(bpy.context.evaluated_depsgraph_get())

    return of


def import_maple():
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE), snow_resolution=512)
    return bpy.data.objects["small_maple_bark"], bpy.data.objects["small_maple"]


def baked_maple(folder, **settings):
    """The maple with the snow of a bake of 4 frames on its bark, seen in the last of them."""
    bark, rig = import_maple()
    snow_scene.receive(bark, resolution=512)
    snow_scene.settings(folder, **settings)
    snow_scene.bake()
    bpy.context.scene.frame_set(4)
    return bark, rig


@pytest.mark.parametrize("detail", ["DRAFT", "GAME", "DEFAULT", "FILM", "chain"])
def test_the_places_of_snow_on_a_trees_base_are_those_of_its_bark(scene, addon, detail):
    options = {"lod_chain": True} if detail == "chain" else {"detail": detail}
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE), snow_resolution=512, **options)
    barks = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.find_armature()]
    assert len(barks) == (4 if detail == "chain" else 1)
    trees = addon("realtime.trees")
    for bark in barks:
        surface, _print = trees.Bases().of(trees.rig_of(bark, "VIEWPORT"))
        uvs = trees.SnowUvs(bark.data, surface)
        assert uvs.uv("bark") is None
        assert uvs.uv("snow").shape == (len(surface["quads"]), 4, 2)


def test_a_tree_that_carries_the_snow_of_a_bake_is_drawn_as_a_tree(scene, read, tmp_path):
    bark, rig = baked_maple(tmp_path / "cache")
    (tree,) = read().trees
    assert not read().meshes
    assert tree.snow.heights.shape == (512, 512)
    assert tree.snow.heights.max() == pytest.approx(0.1, rel=0.5)
    scene.frame_set(0)
    assert read().trees[0].snow is None  # before the first frame
    rig.location.x = 1.0
    scene.frame_set(4)
    (moved,) = read().trees
    assert moved.matrices[0, 0, 3] == pytest.approx(tree.matrices[0, 0, 3] + 1.0)
    assert np.array_equal(moved.snow.heights, tree.snow.heights)


def test_its_snow_is_seen_on_top_and_not_below(scene, tmp_path):
    bark, rig = baked_maple(tmp_path / "cache", fall_angle=0.0)
    for slot in bark.material_slots:
        slot.material = material("black", (0.0, 0.0, 0.0))
    points = np.array([rig.matrix_world @ vertex.co for vertex in bark.data.vertices])
    middle = Vector((points.min(0) + points.max(0)) / 2.0)
    bpy.data.objects["Sun"].hide_render = True  # as bright from above as from below
    camera_at(middle + Vector((0.01, 0.0, 9.0)), middle)
    from_above = rendered(scene)
    scene.frame_set(0)
    bare = rendered(scene)
    scene.frame_set(4)
    scene.camera.location = middle - Vector((0.01, 0.0, 9.0))
    scene.camera.rotation_euler = (middle - scene.camera.location).to_track_quat("-Z", "Y").to_euler()
    from_below = rendered(scene)
    scene.frame_set(0)
    bare_below = rendered(scene)
    whitened = (from_above - bare)[..., 0].clip(0).sum()
    assert whitened > 3.0 * (from_below - bare_below)[..., 0].clip(0).sum() > 0.0


def test_a_map_of_the_artists_own_makes_the_tree_a_mesh_with_snow(scene, read, tmp_path):
    bark, _rig = import_maple()
    layer = bark.data.uv_layers["snow"]
    flat = np.empty(2 * len(layer.data), np.float32)
    layer.data.foreach_get("uv", flat)
    layer.data.foreach_set("uv", 0.9 * flat + 0.05)
    bark.data.update()
    snow_scene.receive(bark, resolution=256)
    snow_scene.settings(tmp_path / "cache")
    snow_scene.bake()
    scene.frame_set(4)
    content = read()
    assert not content.trees
    assert content.meshes[0].snow is not None


def test_a_tree_follows_the_live_preview(scene, addon, read):
    bark, _rig = import_maple()
    scene.frame_start, scene.frame_end = 1, 10
    snow_scene.receive(bark, resolution=256)
    scene.frame_set(0)
    live = addon("preview.live")
    try:
        live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
        for frame in range(1, 6):
            scene.frame_set(frame)
        (tree,) = read(live=True).trees
        assert tree.snow.heights.max() > 0.01
    finally:
        live.stop()
    assert read(live=True).trees[0].snow is None


# -- instanced receivers --------------------------------------------------------------------------------


@pytest.fixture
def instanced(scene):
    """An empty that instances two black squares, 1 m above each other and 5 m to the side; a receiver."""
    parts = bpy.data.collections.new("Parts")
    for obj in (snow_scene.square("Low", 2.0), snow_scene.square("High", 1.0, z=1.0)):
        obj.data.materials.append(material("black", (0.0, 0.0, 0.0)))
        scene.collection.objects.unlink(obj)
        parts.objects.link(obj)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", parts
    empty.location = (5.0, 0.0, 0.0)
    scene.collection.objects.link(empty)
    bare = bpy.data.objects.new("Bare", None)  # shows the same map but is not a receiver
    bare.instance_type, bare.instance_collection = "COLLECTION", parts
    scene.collection.objects.link(bare)
    snow_scene.receive(empty, resolution=128)
    scene.frame_start, scene.frame_end = 1, 4
    return empty


def snow_by_place(content):
    """{(name, x): deepest snow or None} of the meshes of a records.Scene."""
    found = {}
    for mesh in content.meshes:
        for matrix in mesh.matrices:
            deepest = None if mesh.snow is None else float(mesh.snow.heights.max())
            found[mesh.key.split()[1], round(float(matrix[0, 3]))] = deepest
    return found


def snow_surfaces(content):
    """Points in the world of the surfaces of snow of a records.Scene."""
    return [
        mesh.shape.vertices @ mesh.matrices[0, :3, :3].T + mesh.matrices[0, :3, 3]
        for mesh in content.meshes
        if mesh.shape.is_snow
    ]


def test_live_snow_lies_on_what_an_empty_instances_and_on_no_other_instance(scene, addon, read, instanced):
    snow_scene.settings("unused")
    scene.frame_set(0)
    live = addon("preview.live")
    try:
        live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
        for frame in range(1, 5):
            scene.frame_set(frame)
        surfaces = snow_surfaces(read(live=True))
        assert len(surfaces) == 2
        for points in surfaces:
            assert points[:, 0].mean() == pytest.approx(5.0, abs=0.1)
            assert np.ptp(points[:, 2]) > 0.08
    finally:
        live.stop()
    assert snow_surfaces(read(live=True)) == []


def test_baked_snow_lies_on_what_an_empty_instances(scene, read, instanced, tmp_path):
    snow_scene.settings(tmp_path / "cache")
    snow_scene.bake()
    scene.frame_set(4)
    found = snow_by_place(read())
    assert found == {
        ("Low", 5): pytest.approx(0.1, rel=0.05),
        ("High", 5): pytest.approx(0.1, rel=0.05),
        ("Low", 0): None,
        ("High", 0): None,
    }
    assert_white_from_above(scene)


def assert_white_from_above(scene):
    camera_at((5.01, 0, 8), (5, 0, 0))
    picture = rendered(scene)
    assert pixel(picture, scene, (5, 0, 1.0))[:3].min() > 0.4
    assert pixel(picture, scene, (5.8, 0, 0))[:3].min() > 0.4


# -- snow surfaces --------------------------------------------------------------------------------------


def test_snow_surfaces_are_meshes_of_the_scene_and_no_layer_lies_below_them(scene, read, instanced, tmp_path):
    snow_scene.settings(tmp_path / "cache")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    snow_scene.bake()
    scene.frame_set(4)
    content = read()
    surfaces = {bpy.data.objects[f"{name} Snow"] for name in ("Low", "High")}
    keys = [mesh.key for mesh in content.meshes]
    assert all(any(surface.name in key for key in keys) for surface in surfaces)
    assert len(keys) == 4 and {mesh.snow for mesh in content.meshes} == {None}
    assert len(snow_surfaces(content)) == 2
    assert_white_from_above(scene)


def test_the_snow_surface_of_a_tree_stands_beside_the_bare_tree(scene, read, tmp_path):
    bark, _rig = import_maple()
    snow_scene.receive(bark, resolution=512)
    snow_scene.settings(tmp_path / "cache")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    snow_scene.bake()
    scene.frame_set(4)
    content = read()
    (tree,) = content.trees
    assert tree.snow is None
    (surface,) = content.meshes
    assert surface.snow is None and "small_maple_bark Snow" in surface.key


def test_the_live_preview_draws_its_own_snow_instead_of_surfaces(scene, addon, read, tmp_path):
    ground = snow_scene.square("Ground")
    snow_scene.receive(ground)
    snow_scene.settings(tmp_path / "cache")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    snow_scene.bake()
    assert len(read().meshes) == 2
    live = addon("preview.live")
    try:
        live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
        content = read(live=True)
        assert len(content.meshes) == 2 and {mesh.snow for mesh in content.meshes} == {None}
        (points,) = snow_surfaces(content)
        surface = live.session.preview.surface(addon("scene.pose").own_key("Ground", ""))
        assert points == pytest.approx(surface.shown[0], abs=1e-6)
        assert points[:, 2].max() > 0.01
    finally:
        live.stop()
    assert len(read(live=True).meshes) == 2
