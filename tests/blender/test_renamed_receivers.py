# SPDX-License-Identifier: GPL-3.0-or-later
"""A renamed receiver keeps its bake; different names have separate folders."""

from pathlib import Path

import bpy
import pytest
import snow_scene as s


@pytest.fixture
def undisturbed(tmp_path):
    """The moving scene and the bytes of its whole bake. The cache is tmp/cache then."""
    s.moving_scene(tmp_path / "whole")
    s.bake()
    files = s.files_of(tmp_path / "whole")
    for entry in bpy.context.scene.snowbough.receivers:
        entry.folder = entry.baked_as = ""
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "cache")
    return files


def bake_part(addon, last, objects=()):
    running = s.bake_part(addon, last=last, objects=objects)
    addon("bake.outcome").conclude(bpy.context.scene, running)
    return running


def entry_of(name):
    return next(entry for entry in bpy.context.scene.snowbough.receivers if entry.object.name == name)


def test_a_bake_goes_on_after_a_receiver_was_renamed(addon, undisturbed, tmp_path):
    assert bake_part(addon, 6).error is None
    bpy.data.objects["Cart"].name = "Sledge"
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed
    assert (
        addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())[-1].severity
        == "INFO"
    )
    bpy.data.objects["Flag"].name = "Banner"
    s.bake(resume=True)  # compares everything
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_messages_and_the_command_line_know_it_by_its_name_of_today(addon, undisturbed, tmp_path):
    bake_part(addon, 6)
    bpy.data.objects["Cart"].name = "Sledge"
    running = bake_part(addon, 6, ["Sledge"])
    assert running.error is None and list(running.job.folders) == ["Sledge"]
    entry_of("Sledge").resolution = 128
    with pytest.raises(RuntimeError, match="^Error: Sledge in v001 was baked with other settings"):
        s.bake(resume=True)


def test_a_new_receiver_of_the_old_name_gets_a_folder_of_its_own(addon, undisturbed, tmp_path):
    bake_part(addon, 12)
    own = bpy.path.abspath(entry_of("Cart").folder)
    bpy.data.objects["Cart"].name = "Sledge"
    s.receive(s.square("Cart", 0.5, z=2.0))
    s.bake()
    assert Path(bpy.path.abspath(entry_of("Sledge").folder)).name == Path(own).name
    assert Path(bpy.path.abspath(entry_of("Cart").folder)).name != Path(own).name
    folders = {bpy.path.abspath(entry.folder) for entry in bpy.context.scene.snowbough.receivers}
    assert len(folders) == 4


def test_another_object_of_the_old_name_shelters_and_is_not_taken_for_it(addon, undisturbed, tmp_path):
    native = addon("base.native").load()
    bake_part(addon, 12)
    before = s.height(native, tmp_path / "cache", "Cart", 12)
    bpy.data.objects["Cart"].name = "Sledge"
    roof = s.square("Cart", 8.0, z=3.0)
    s.bake()
    assert before.max() > 0.05 and s.height(native, tmp_path / "cache", "Cart", 12, version=2).max() == 0.0
    roof.name = "Roof"


def test_a_renamed_empty_keeps_the_bakes_of_what_it_shows(addon, tmp_path):
    empty = s.instanced(s.square("Stone", 1.0), name="Pile")
    s.receive(empty)
    s.settings(tmp_path / "cache")
    s.bake()
    files = s.files_of(tmp_path / "cache")
    empty.name = "Cairn"
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == files
    members = addon("result.baked_images").folders_of_members(entry_of("Cairn").folder, "Cairn")
    assert list(members) == [("Stone", "")]


def test_free_bake_forgets_the_old_name(addon, undisturbed, tmp_path):
    bake_part(addon, 12)
    bpy.data.objects["Cart"].name = "Sledge"
    bpy.ops.snowbough.free_bake()
    s.bake()
    assert Path(bpy.path.abspath(entry_of("Sledge").folder)).name.startswith("Sledge-")


def test_scenes_whose_names_differ_in_other_letters_only_keep_their_snow_apart(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path, frames=(1, 1))
    scene = bpy.context.scene
    for name in ("雪一", "山一", "shot", "Shot", "SHOT"):
        scene.name, scene.snowbough.cache_scene = name, ""
        s.bake()
    folders = {path.name.lower() for path in tmp_path.iterdir()}
    assert len(folders) == 5 and all((path / "v001").is_dir() for path in tmp_path.iterdir())


# -- Remove Snow on appended objects ----------------------------------------------------------------------


def append(path, *names):
    with bpy.data.libraries.load(str(path)) as (_, into):
        into.objects = list(names)
    for obj in into.objects:
        bpy.context.scene.collection.objects.link(obj)
        obj.select_set(True)
    return into.objects


def painted(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.125
    return material


@pytest.fixture
def snowy_file(tmp_path):
    """A saved file with a baked ground that has snow of one kind: snowy_file(mode, object-linked material?)."""

    def make(mode, linked_to_object=False):
        ground = s.square("Ground")
        material = painted("Paint")
        ground.data.materials.append(None if linked_to_object else material)
        if linked_to_object:
            ground.material_slots[0].link = "OBJECT"
            ground.material_slots[0].material = material
        s.receive(ground)
        s.settings(tmp_path / "cache", frames=(1, 2))
        bpy.ops.snowbough.setup_displacement(mode=mode)
        s.bake()
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "snowy.blend"))
        bpy.ops.wm.read_homefile(use_empty=True)
        return tmp_path / "snowy.blend"

    return make


@pytest.mark.parametrize("mode", ["MODIFIER", "ADAPTIVE", "NONE"])
def test_remove_snow_works_on_an_appended_object(snowy_file, mode):
    (ground,) = append(snowy_file(mode), "Ground")
    assert "snow" in ground.material_slots[0].material.name
    bpy.ops.snowbough.remove()
    slot = ground.material_slots[0]
    assert (slot.link, slot.material.name) == ("DATA", "Paint") and not ground.modifiers
    assert [material.name for material in bpy.data.materials] == ["Paint"]


def test_remove_snow_takes_the_nodes_out_where_the_material_was_the_objects_own(snowy_file):
    (ground,) = append(snowy_file("ADAPTIVE", linked_to_object=True), "Ground")
    bpy.ops.snowbough.remove()
    tree = ground.material_slots[0].material.node_tree
    assert sorted(node.type for node in tree.nodes) == ["BSDF_PRINCIPLED", "OUTPUT_MATERIAL"]
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    shader = output.inputs["Surface"].links[0].from_node
    assert shader.inputs["Roughness"].default_value == 0.125 and not output.inputs["Displacement"].links


@pytest.mark.parametrize("selected", [["Ground"], ["Ground Snow"], ["Ground", "Ground Snow"]])
def test_remove_snow_removes_an_appended_surface(snowy_file, selected):
    append(snowy_file("SHELL"), "Ground Snow", "Ground")
    for obj in bpy.context.scene.objects:
        obj.select_set(obj.name in selected)
    bpy.ops.snowbough.remove()
    assert [obj.name for obj in bpy.data.objects] == ["Ground"]


def test_remove_snow_of_this_scene_leaves_appended_snow_that_is_not_selected(snowy_file, tmp_path):
    path = snowy_file("NONE")
    own = s.square("Own")
    s.receive(own)
    (ground,) = append(path, "Ground")
    ground.select_set(False)
    bpy.ops.snowbough.remove()
    assert "snow" in ground.material_slots[0].material.name
