# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine Snowbough Realtime in the background: positions and brightness of a tree and a plane in the picture."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
import snow_scene
from realtime_shot import HEIGHT, WIDTH, WORLD, camera_at, material, pixel, read, rendered, set_up

MAPLE = Path(__file__).resolve().parent.parent / "data" / "small_maple.obj"

scene = pytest.fixture(set_up)


def import_maple():
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE))
    return bpy.data.objects["small_maple_bark"], bpy.data.objects["small_maple"]


#: Light reflected by a surface that faces the sun, as a share of its colour.
LIT = 2.0 / math.pi + np.array(WORLD)


def test_a_plane_is_where_the_camera_sees_it_and_as_bright_as_it_is(scene):
    square = snow_scene.square("Square", 2.0)
    square.data.materials.append(material("green", (0.1, 0.5, 0.2)))
    camera_at((3, -5, 4))
    picture = rendered(scene)
    assert picture.shape == (HEIGHT, WIDTH, 4)
    for x in (-0.9, 0.9):
        for y in (-0.9, 0.9):
            assert pixel(picture, scene, (x, y, 0))[:3] == pytest.approx((0.1, 0.5, 0.2) * LIT, rel=0.01)
    for point in ((1.15, 0, 0), (-1.15, 0, 0), (0, 1.15, 0), (0, -1.15, 0)):
        assert pixel(picture, scene, point)[:3] == pytest.approx(WORLD, rel=0.01)
    assert picture[..., 3].min() == 1.0


@pytest.mark.parametrize("lens", ["shift", "orthographic", "aspect", "portrait"])
def test_lens_shift_sensor_and_aspect_are_used(scene, lens):
    snow_scene.square("Square", 1.0, x=0.5)
    data = camera_at((2, -4, 5)).data
    if lens == "shift":
        data.shift_x, data.shift_y = 0.15, -0.1
    elif lens == "orthographic":
        data.type, data.ortho_scale = "ORTHO", 5.0
    elif lens == "aspect":
        scene.render.pixel_aspect_x = 1.6
    else:
        data.sensor_fit, scene.render.resolution_x = "VERTICAL", 110
    picture = rendered(scene)
    for x in (0.1, 0.9):
        for y in (-0.4, 0.4):
            assert pixel(picture, scene, (x, y, 0))[0] > 0.4, (x, y)
    for x, y in ((-0.2, 0), (1.2, 0), (0.5, 0.75), (0.5, -0.75)):
        assert pixel(picture, scene, (x, y, 0))[:3] == pytest.approx(WORLD, rel=0.01), (x, y)


def test_percentage_border_and_film_are_used(scene):
    snow_scene.square("Square", 2.0)
    camera_at((0, 0, 5))
    whole = rendered(scene)
    render = scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1.0
    assert np.array_equal(rendered(scene), whole[60:120, 40:120])
    render.use_border = False
    render.resolution_percentage = 50
    render.film_transparent = True
    half = rendered(scene)
    assert half.shape == (60, 80, 4)
    assert half[30, 40, 3] == pytest.approx(1.0)
    assert half[2, 2].tolist() == [0, 0, 0, 0]


def test_an_image_lies_on_its_uv_map(scene):
    image = bpy.data.images.new("quarters", 4, 4)
    texels = np.ones((4, 4, 4), np.float32)
    texels[:2, :2, :3], texels[:2, 2:, :3], texels[2:, :2, :3] = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    image.pixels.foreach_set(texels.reshape(-1))
    image.update()
    square = snow_scene.square("Square", 2.0)
    square.data.materials.append(material("quarters", (1, 1, 1), image))
    camera_at((0.01, 0, 5))
    picture = rendered(scene)
    for point, color in (((-0.5, -0.5), (1, 0, 0)), ((0.5, -0.5), (0, 1, 0)), ((-0.5, 0.5), (0, 0, 1))):
        assert pixel(picture, scene, (*point, 0))[:3] == pytest.approx(color * LIT, rel=0.01, abs=0.01)


def test_a_tree_stands_on_a_plane_with_its_shadow(scene, addon):
    _bark, rig = import_maple()
    trunk = rig.data.bones[0].head_local.lerp(rig.data.bones[0].tail_local, 0.5)
    snow_scene.square("Ground", 30.0)
    camera_at((2, -5, 2), (0, 0, 0.5))
    picture = rendered(scene)
    again = rendered(scene)
    assert picture.tobytes() == again.tobytes()
    assert pixel(picture, scene, trunk)[0] < 0.25
    assert pixel(picture, scene, (0.5, -1.5, 0))[0] > 0.4  # ground before it

    # A sun from the left: the middle of the trunk's lowest bone throws its shadow to the right of its foot.
    bpy.data.objects["Sun"].rotation_euler = (0, math.radians(-45), 0)
    shaded = rendered(scene)
    dark = pixel(shaded, scene, (trunk.x + trunk.z, trunk.y, 0))
    bright = pixel(shaded, scene, (trunk.x - trunk.z, trunk.y, 0))
    assert dark[0] < 0.5 * bright[0]


def read_scene(addon):
    """The records.Scene of the viewport's evaluation."""
    bpy.context.view_layer.update()
    reader = addon("realtime.reader").Reader(addon("base.native").load())
    return reader.read(bpy.context.evaluated_depsgraph_get())


def test_an_imported_tree_is_drawn_from_its_base_in_its_pose(scene, addon):
    bark, rig = import_maple()
    base = read_scene(addon).trees[0]
    assert len(base.surface["quads"]) < len(bark.data.polygons)
    assert np.allclose(base.pose, np.eye(4), atol=1e-5)
    assert np.allclose(base.matrices, np.eye(4), atol=1e-5)
    rig.location = (1, 2, 3)
    bone = next(bone for bone in rig.pose.bones if bone.parent is None)
    bone.rotation_mode = "XYZ"
    bone.rotation_euler = (0, 0, 1.0)
    rig.scale = (2, 2, 2)
    bpy.context.view_layer.update()

    # The base's vertices, posed by the matrices, lie where Blender's deformed mesh is.
    tree = read_scene(addon).trees[0]
    surface = tree.surface
    skinned = np.einsum("vk,vkij->vij", surface["bone_weights"], tree.pose[surface["bone_indices"]])
    points = np.einsum("vij,vj->vi", skinned, np.c_[surface["vertices"], np.ones(len(skinned))])
    points = (points @ tree.matrices[0].T)[:, :3]
    evaluated = bark.evaluated_get(bpy.context.evaluated_depsgraph_get())
    deformed = np.array([evaluated.matrix_world @ vertex.co for vertex in evaluated.data.vertices])
    assert np.allclose(points.min(0), deformed.min(0), atol=0.1)
    assert np.allclose(points.max(0), deformed.max(0), atol=0.1)


@pytest.mark.parametrize("change", ["edited", "modifier"])
def test_a_tree_that_is_not_the_imported_one_any_more_is_a_mesh(scene, addon, change):
    bark, _rig = import_maple()
    if change == "edited":
        bark.data.vertices.add(1)
    else:
        bark.modifiers.new("Wave", "WAVE")
    read = read_scene(addon)
    assert len(read.trees) == 0 and len(read.meshes) == 1


def test_instances_of_one_mesh_are_one_mesh_in_many_places(scene, addon):
    square = snow_scene.square("Square", 0.1)
    collection = bpy.data.collections.new("Squares")
    collection.objects.link(square)
    scene.collection.objects.unlink(square)
    for number in range(5):
        empty = bpy.data.objects.new("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location.x = number
        scene.collection.objects.link(empty)
    (mesh,) = read_scene(addon).meshes
    assert sorted(mesh.matrices[:, 0, 3].tolist()) == [0, 1, 2, 3, 4]


def test_a_forest_of_one_tree_is_one_tree_in_many_places(scene, addon):
    _bark, rig = import_maple()
    collection = bpy.data.collections["small_maple"]
    for number in range(1, 100):
        empty = bpy.data.objects.new("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location.x = 10 * number
        scene.collection.objects.link(empty)
    content = read_scene(addon)
    (tree,) = content.trees
    assert not content.meshes
    assert sorted(tree.matrices[:, 0, 3].round().tolist()) == [10 * number for number in range(100)]

    # A duplicate has a pose of its own, and shares the rest.
    twin = rig.copy()
    scene.collection.objects.link(twin)
    bark = next(obj for obj in collection.objects if obj.type == "MESH").copy()
    scene.collection.objects.link(bark)
    bark.parent, bark.modifiers[0].object = twin, twin
    twin.location = (0, 7, 0)
    one, other = sorted(read_scene(addon).trees, key=lambda made: len(made.matrices))
    assert len(one.matrices) == 1 and len(other.matrices) == 100
    assert one.key != other.key and one.print == other.print
    assert one.matrices[0, 1, 3] == pytest.approx(7)


def test_an_animation_shows_each_frames_moment(scene, tmp_path):
    square = snow_scene.square("Square", 1.0)
    snow_scene.key(square, "location", (1, (-1, 0, 0)), (3, (1, 0, 0)))
    camera_at((0, 0, 5))
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.filepath = str(tmp_path / "frame_")
    bpy.ops.render.render(animation=True)
    pictures = [read(path) for path in sorted(tmp_path.glob("frame_*.exr"))]
    assert len(pictures) == 3
    for picture, x in zip(pictures, (-1, 0, 1)):
        assert pixel(picture, scene, (x, 0, 0))[0] > 0.4
        assert pixel(picture, scene, (x + 0.7, 0, 0))[:3] == pytest.approx(WORLD, rel=0.01)


def test_the_snow_of_a_bake_lies_white_where_it_fell(scene, tmp_path):
    ground = snow_scene.square("Ground", 4.0)
    ground.data.materials.append(material("black", (0.0, 0.0, 0.0)))
    roof = snow_scene.square("Roof", 1.0, z=1.0, x=1.0)
    snow_scene.receive(ground, resolution=128)
    snow_scene.settings(tmp_path / "cache", frames=(1, 4))
    snow_scene.bake()
    roof.hide_render = True
    camera_at((0.01, 0, 8))
    scene.frame_set(4)
    picture = rendered(scene)
    assert pixel(picture, scene, (-1, 0, 0))[:3].min() > 0.6  # open ground
    assert pixel(picture, scene, (1, 0, 0))[:3].max() < 0.1  # under the roof
    scene.frame_set(0)
    assert pixel(rendered(scene), scene, (-1, 0, 0))[:3].max() < 0.01  # before the first frame


def test_without_a_camera_the_render_says_so(scene):
    snow_scene.square("Square")
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render(write_still=True)


def test_materials_show_the_colour_that_leads_to_the_output(scene, addon):
    look_of = addon("realtime.materials").look_of
    mixed = material("mixed", (0.1, 0.2, 0.3))
    nodes, link = mixed.node_tree.nodes, mixed.node_tree.links.new
    mix = nodes.new("ShaderNodeMixShader")
    link(nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    link(nodes["Principled BSDF"].outputs[0], mix.inputs[2])
    link(mix.outputs[0], nodes["Material Output"].inputs["Surface"])
    assert look_of(mixed).paint.color == pytest.approx((0.1, 0.2, 0.3))

    ramped = material("ramped", (1, 1, 1))
    nodes, link = ramped.node_tree.nodes, ramped.node_tree.links.new
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (0.2, 0.0, 0.0, 1)
    ramp.color_ramp.elements[1].color = (0.6, 0.4, 0.0, 1)
    link(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    look = look_of(ramped)
    assert look.paint.color == pytest.approx((0.4, 0.2, 0.0))
    assert addon("realtime.materials").bark_of(look).light == pytest.approx((0.6, 0.4, 0.0))

    if bpy.app.version < (5, 0, 0):  # where every material has nodes
        plain = bpy.data.materials.new("plain")
        plain.use_nodes = False
        plain.diffuse_color = (0.3, 0.2, 0.1, 1)
        assert look_of(plain).paint.color == pytest.approx((0.3, 0.2, 0.1))
    assert look_of(None).paint.color == (0.8, 0.8, 0.8)


def test_blenders_panels_show_themselves_under_the_engine(addon):
    shown = {
        panel.__name__
        for panel in bpy.types.Panel.__subclasses__()
        if "SNOWBOUGH_REALTIME" in getattr(panel, "COMPAT_ENGINES", ())
    }
    assert {"SNOWBOUGH_PT_realtime", "EEVEE_MATERIAL_PT_surface", "RENDER_PT_format", "DATA_PT_lens"} <= shown
    assert len(shown) > 30
