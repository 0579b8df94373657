# SPDX-License-Identifier: GPL-3.0-or-later
"""How baked maps are shown in the scene and removed again: materials and modifiers. Snow surfaces are in
test_snow_surface.py."""

import json

import bpy
import numpy as np
import pytest
import snow_scene as s

SIZE = 64
FIRST, LAST = 5, 8


def depth_of(frame):
    return 0.1 * (frame - FIRST + 1)


@pytest.fixture
def write_bake(addon, tmp_path):
    """Writes a bake: an even height that grows by 0.1 m a frame; `covered` cuts the map in u."""

    def write(name="Ground-1", covered=1.0, frames=range(FIRST, LAST + 1)):
        native = addon("base.native").load()
        folder = tmp_path / name
        folder.mkdir()
        for frame in frames:
            height = np.full((SIZE, SIZE), depth_of(frame), dtype=np.float32)
            native.write_exr(str(folder / f"height_{frame:04d}.exr"), height)
        ever = np.zeros((SIZE, SIZE), dtype=np.float32)
        ever[:, : int(SIZE * covered)] = 1.0
        native.write_exr(str(folder / "ever_covered.exr"), ever)
        return folder

    return write


@pytest.fixture
def ground():
    """A 2 m square whose UV map `snow` fills the whole map, as the scene's only receiver."""
    receiver = bpy.context.scene.snowbough.receivers.add()
    receiver.object = s.square("Ground")
    return receiver


def evaluated_points(obj):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = obj.evaluated_get(depsgraph).to_mesh()
    points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def image_nodes(material):
    return [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]


def test_sequence_has_the_range_of_the_files_and_no_colour_transform(ground, write_bake):
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    (node,) = image_nodes(ground.object.material_slots[0].material)
    assert node.image.source == "SEQUENCE"
    assert node.image.colorspace_settings.name == "Non-Color"
    assert node.image_user.frame_duration == LAST - FIRST + 1
    assert node.image_user.frame_start == FIRST
    assert node.image_user.frame_offset == FIRST - 1
    assert node.image_user.use_auto_refresh
    assert not node.image_user.use_cyclic


def test_a_gap_in_the_files_ends_the_sequence(addon, write_bake):
    folder = write_bake(frames=[5, 6, 8])
    assert addon("result.baked_images").frames_on_disk(folder, "height") == [5, 6]


def test_a_sequence_has_the_size_of_its_files_and_reads_none_for_it(addon, write_bake):
    images = set(bpy.data.images)
    sequence = addon("result.baked_images").load_sequence(str(write_bake()), "height")
    assert sequence.size == SIZE
    assert set(bpy.data.images) - images == {sequence.image}
    assert not sequence.image.has_data


def test_a_map_beside_the_blend_is_loaded_once(addon, write_bake):
    """Its path has no folder."""
    path = write_bake() / "height_0005.exr"
    bpy.ops.wm.save_as_mainfile(filepath=str(path.parent / "shot.blend"))
    load = addon("result.baked_images")._load
    assert load(path, "height", "Non-Color") == load(path, "height", "Non-Color")
    assert len(bpy.data.images) == 1


def test_cycles_displacement_is_in_metres_from_the_surface(ground, write_bake):
    bpy.context.scene.unit_settings.scale_length = 0.5
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="ADAPTIVE")
    material = ground.object.material_slots[0].material
    (node,) = [node for node in material.node_tree.nodes if node.type == "DISPLACEMENT"]
    assert node.space == "WORLD"
    assert node.inputs["Midlevel"].default_value == 0.0
    assert node.inputs["Scale"].default_value == pytest.approx(2.0)


def test_displacement_of_the_original_material_is_kept(ground, write_bake):
    ground.folder = str(write_bake())
    original = bpy.data.materials.new("Stone")
    original.use_nodes = True
    tree = original.node_tree
    bump = tree.nodes.new("ShaderNodeDisplacement")
    bump.name = "Own"
    tree.links.new(bump.outputs[0], tree.get_output_node("ALL").inputs["Displacement"])
    ground.object.data.materials.append(original)
    bpy.ops.snowbough.setup_displacement(mode="ADAPTIVE")
    tree = ground.object.material_slots[0].material.node_tree
    both = tree.get_output_node("ALL").inputs["Displacement"].links[0].from_node
    sources = {link.from_node.name for socket in both.inputs for link in socket.links}
    assert both.operation == "ADD" and "Own" in sources and len(sources) == 2


@pytest.mark.parametrize("scale, unit", [(1.0, 1.0), (2.0, 1.0), (1.0, 0.1)])
def test_modifiers_raise_the_surface_by_the_height_in_metres(ground, write_bake, scale, unit):
    bpy.context.scene.unit_settings.scale_length = unit
    ground.object.scale = (scale,) * 3
    bpy.context.view_layer.update()
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    bpy.context.scene.frame_set(7)
    points = evaluated_points(ground.object)
    assert points[:, 2] * scale * unit == pytest.approx(depth_of(7), abs=1e-5)


@pytest.mark.parametrize("frame, depth", [(1, 0.0), (FIRST - 1, 0.0), (FIRST, 0.1), (50, 0.4)])
def test_no_snow_before_the_bake_and_the_last_depth_after_it(ground, write_bake, frame, depth):
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    bpy.context.scene.frame_set(frame)
    points = evaluated_points(ground.object)
    assert len(points) and points[:, 2] == pytest.approx(depth, abs=1e-5)


def test_material_shows_no_snow_before_the_first_file(ground, write_bake):
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    tree = ground.object.material_slots[0].material.node_tree
    (switch,) = [node for node in tree.nodes if node.label == "From the first baked frame on"]
    for frame, value in ((1, 0.0), (FIRST - 1, 0.0), (FIRST, 1.0), (50, 1.0)):
        bpy.context.scene.frame_set(frame)
        assert switch.inputs[1].default_value == value


def test_uneven_scale_is_refused_by_modifiers_and_gets_a_snow_surface(addon, ground, write_bake):
    ground.folder = str(write_bake())
    ground.object.scale = (1, 2, 1)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="apply the scale"):
        bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    assert not ground.object.modifiers and not ground.object.material_slots
    bpy.ops.snowbough.setup_displacement(mode="AUTO")
    assert addon("result.displacement").mode_of(ground) == "SHELL"
    assert not ground.object.modifiers and not ground.object.material_slots


def state_of(obj):
    return json.dumps(
        {
            "slots": [
                (slot.link, slot.material.name if slot.material else None) for slot in obj.material_slots
            ],
            "data": [material.name if material else None for material in obj.data.materials],
            "modifiers": [modifier.name for modifier in obj.modifiers],
            "fake": [material.use_fake_user for material in bpy.data.materials],
            "materials": sorted(material.name for material in bpy.data.materials),
            "objects": sorted(obj.name for obj in bpy.data.objects),
            "textures": sorted(texture.name for texture in bpy.data.textures),
            "actions": sorted(action.name for action in bpy.data.actions),
        }
    )


@pytest.mark.parametrize("mode", ["NONE", "ADAPTIVE", "MODIFIER"])
@pytest.mark.parametrize("slots", [0, 2])
def test_remove_restores_the_object_exactly(ground, write_bake, mode, slots):
    for index in range(slots):
        ground.object.data.materials.append(bpy.data.materials.new(f"Own {index}"))
    if slots:
        ground.object.material_slots[1].link = "OBJECT"
        ground.object.material_slots[1].material = bpy.data.materials["Own 0"]
    before = state_of(ground.object)
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode=mode)
    assert state_of(ground.object) != before
    bpy.ops.snowbough.setup_displacement(mode=mode)
    bpy.ops.snowbough.remove()
    assert state_of(ground.object) == before
    assert ground.restore == ""


def test_material_before_a_bake_shows_no_snow_and_no_missing_image(ground):
    bpy.ops.snowbough.setup_material()
    material = ground.object.material_slots[0].material
    assert not image_nodes(material)
    assert any(
        node.type == "GROUP" and node.node_tree.name == "Snowbough Snow" for node in material.node_tree.nodes
    )


def test_muted_displacement_is_off_in_renders_and_comes_back(addon, ground, write_bake):
    ground.folder = str(write_bake())
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    with addon("result.displacement").Muted(bpy.context.scene):
        assert not any(modifier.show_render for modifier in ground.object.modifiers)
    assert all(modifier.show_render for modifier in ground.object.modifiers)
