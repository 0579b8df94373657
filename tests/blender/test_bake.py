# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake in the background: receivers, amounts of snow, output files and errors."""

import math
import os

import bpy
import numpy as np
import pytest
import snow_scene as s


def test_open_ground_holds_the_planned_depth_on_every_frame(native, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path, (3, 6), end_depth=0.08)
    s.bake()
    for frame in range(3, 7):
        depth = s.open_ground(s.height(native, tmp_path, "Ground", frame))
        assert depth == pytest.approx(0.02 * (frame - 2), rel=2e-3)


def test_start_depth_lies_there_before_the_first_frame(native, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path, (1, 2), start_depth=0.1, end_depth=0.3)
    s.bake()
    assert s.open_ground(s.height(native, tmp_path, "Ground", 1)) == pytest.approx(0.2, rel=2e-3)
    assert s.open_ground(s.height(native, tmp_path, "Ground", 2)) == pytest.approx(0.3, rel=2e-3)


def test_a_first_frame_below_0_is_refused_and_not_taken_for_0(tmp_path):
    s.receive(s.square("Ground"))
    own = s.settings(tmp_path)
    own.frame_start = -5
    with pytest.raises(
        RuntimeError, match="The first frame is -5: image sequences start at frame 0 or later"
    ):
        s.bake()
    own.frame_start = 0
    s.bake()


def test_a_keyframed_rate_shapes_the_fall(native, tmp_path):
    s.receive(s.square("Ground"))
    own = s.settings(tmp_path, (1, 4))
    for frame, rate in ((1, 1.0), (2, 1.0), (3, 0.0), (4, 0.0)):
        own.rate = rate
        own.keyframe_insert("rate", frame=frame)
    s.bake()
    assert s.open_ground(s.height(native, tmp_path, "Ground", 1)) == pytest.approx(0.05, rel=2e-3)
    assert s.open_ground(s.height(native, tmp_path, "Ground", 3)) == pytest.approx(0.1, rel=2e-3)


def test_a_driven_rate_is_read_from_the_evaluated_scene(native, tmp_path):
    s.receive(s.square("Ground"))
    own = s.settings(tmp_path, (1, 3))
    own.driver_add("rate").driver.expression = "frame == 3"
    s.bake()
    assert s.height(native, tmp_path, "Ground", 2).max() == 0
    assert s.open_ground(s.height(native, tmp_path, "Ground", 3)) == pytest.approx(0.1, rel=2e-3)


def test_a_roof_keeps_the_ground_below_it_bare(native, tmp_path):
    s.receive(s.square("Ground", 2.0))
    s.square("Roof", 1.0, z=1.0)
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.5, 0.5) == 0 and s.texel(map_, 0.1, 0.5) == pytest.approx(0.1, rel=0.05)


def test_an_object_that_does_not_block_snow_keeps_nothing_bare(native, tmp_path):
    s.receive(s.square("Ground", 2.0))
    s.square("Roof", 1.0, z=1.0).snowbough.occlude = False
    s.settings(tmp_path)
    s.bake()
    assert s.texel(s.height(native, tmp_path, "Ground", 4), 0.5, 0.5) == pytest.approx(0.1, rel=0.05)


def test_the_wind_blows_to_the_bearing(native, tmp_path):
    s.receive(s.square("Ground", 4.0))
    s.square("Roof", 0.5, z=1.0)
    s.settings(tmp_path, fall_angle=math.radians(45), bearing=math.radians(90))
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    # Blown to +X under 45 degrees, the shadow lies 1 m towards +X: u = 0.75.
    assert s.texel(map_, 0.75, 0.5) == 0 and s.texel(map_, 0.5, 0.5) > 0.09


def test_snow_stays_where_it_fell_while_a_cart_drives_into_the_open(native, tmp_path):
    cart = s.square("Cart", 1.0, z=0.5)
    s.square("Roof", 2.0, z=2.0)
    s.key(cart, "location", (1, (0, 0, 0)), (2, (0, 0, 0)), (3, (5, 0, 0)), (4, (5, 0, 0)))
    s.receive(cart)
    s.settings(tmp_path)
    s.bake()
    heights = [s.open_ground(s.height(native, tmp_path, "Cart", frame)) for frame in (1, 2, 3, 4)]
    assert heights == pytest.approx([0, 0, 0.025, 0.05], abs=1e-3)


def test_an_armature_bends_what_snow_falls_on(native, tmp_path):
    s.moving_scene(tmp_path)
    s.bake()
    # At frame 1 the flag is upright, so no face is visible from the sky; bent by a radian, its faces are.
    assert s.height(native, tmp_path, "Flag", 1).max() == pytest.approx(0, abs=1e-6)
    assert s.height(native, tmp_path, "Flag", 12).max() > 0.01


def test_snow_falls_on_the_render_evaluation_and_not_on_the_viewports(native, tmp_path):
    s.receive(s.square("Ground"))
    hidden = s.square("HiddenInRender", 1.0, z=1.0)
    hidden.hide_render = True
    only = s.square("OnlyInRender", 0.5, z=1.0, x=0.5)
    only.hide_viewport = True
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.35, 0.5) > 0.09 and s.texel(map_, 0.75, 0.5) == 0


def test_the_scene_is_put_back_as_it_was(native, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    scene = bpy.context.scene
    scene.frame_set(3)
    before = {
        name: getattr(scene.render, name)
        for name in ("engine", "resolution_x", "resolution_y", "use_compositing", "use_lock_interface")
    }
    data = (len(bpy.data.objects), len(bpy.data.cameras), scene.camera)
    s.bake()
    assert scene.frame_current == 3
    assert {name: getattr(scene.render, name) for name in before} == before
    assert (len(bpy.data.objects), len(bpy.data.cameras), scene.camera) == data
    assert not hasattr(bpy.types, "SNOWBOUGH_BAKE")


def test_metres_are_units_times_the_scale_length(native, tmp_path):
    # A scene in centimetres: 200 units are 2 m, and the roof hangs 1 m above.
    ground, roof = s.square("Ground", 200.0), s.square("Roof", 100.0, z=100.0)
    assert ground and roof
    bpy.context.scene.unit_settings.system = "METRIC"
    bpy.context.scene.unit_settings.scale_length = 0.01
    s.receive(ground)
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.1, 0.5) == pytest.approx(0.1, rel=0.05) and s.texel(map_, 0.5, 0.5) == 0
    manifest = s.manifest_of(tmp_path, "Ground")
    assert manifest["frames"][-1]["volume"] == pytest.approx(0.1 * 3.0, rel=0.03)


def test_a_mirrored_object_keeps_its_outside(native, tmp_path):
    ground = s.square("Ground")
    ground.scale = (-1, 1, 1)
    s.receive(ground)
    s.settings(tmp_path)
    s.bake()
    # Scaling by -1 turns the winding but not the side that faces the sky.
    assert s.open_ground(s.height(native, tmp_path, "Ground", 4)) == pytest.approx(0.1, rel=2e-3)


def test_instances_of_a_collection_each_get_a_map(native, tmp_path):
    first = s.instanced(s.square("Rock", 1.0), name="Empty0")
    second = s.instance_of(first.instance_collection, "Empty1")
    second.location.x = 3.0
    s.square("Roof", 2.0, z=1.0)
    s.receive(first, second)
    s.settings(tmp_path)
    s.bake()
    assert s.height(native, tmp_path, "Empty0.Rock", 4).max() == 0
    assert s.open_ground(s.height(native, tmp_path, "Empty1.Rock", 4)) == pytest.approx(0.1, rel=0.05)


def test_linked_and_local_objects_of_one_name_get_folders_of_their_own(native, tmp_path):
    library = tmp_path / "library.blend"
    rock = s.square("Rock", 1.0)
    bpy.data.libraries.write(str(library), {rock})
    with bpy.data.libraries.load(str(library), link=True) as (_, linked):
        linked.objects = ["Rock"]
    copy = linked.objects[0]
    bpy.context.scene.collection.objects.link(copy)
    rock.location.x = 3.0
    s.receive(rock, copy)
    s.settings(tmp_path / "cache")
    s.bake()
    folders = sorted((tmp_path / "cache" / "Scene" / "v001").glob("Rock-*"))
    assert len(folders) == 2
    assert all((folder / "height_0004.exr").is_file() for folder in folders)


def test_a_library_override_receives_where_it_was_moved_to(native, tmp_path):
    rock = s.square("Rock", 1.0)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {rock})
    bpy.data.objects.remove(rock)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, linked):
        linked.objects = ["Rock"]
    bpy.context.scene.collection.objects.link(linked.objects[0])
    override = linked.objects[0].override_create(remap_local_usages=True)
    override.location.x = 5.0
    s.square("Roof", 2.0, z=1.0)
    s.receive(override)
    s.settings(tmp_path / "cache")
    s.bake()
    assert s.open_ground(s.height(native, tmp_path / "cache", "Rock", 4)) == pytest.approx(0.1, rel=0.05)


def test_a_curve_and_instances_shelter_what_is_below(native, tmp_path):
    s.receive(s.square("Ground", 4.0))
    bpy.ops.object.text_add(location=(-1.5, -1, 1))
    bpy.context.object.data.body = "III"
    bpy.context.object.scale = (3, 3, 3)
    s.instanced(s.square("Tile", 0.5)).location = (1.5, 1.5, 1)
    s.settings(tmp_path)
    s.bake()
    map_ = s.height(native, tmp_path, "Ground", 4)
    assert s.texel(map_, 0.875, 0.875) == 0
    assert (map_[16:40, 8:48] == 0).sum() > 20


def test_the_second_bake_does_not_fall_on_the_firsts_snow(native, tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    s.settings(tmp_path, end_depth=0.5)
    s.bake()
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    assert [modifier.show_render for modifier in ground.modifiers] == [True, True]
    s.bake()
    assert [modifier.show_render for modifier in ground.modifiers] == [True, True]
    first, second = (s.folder_of(tmp_path, "Ground", version) for version in (1, 2))
    for name in ("height_0004.exr", "object.json"):
        assert (first / name).read_bytes() == (second / name).read_bytes()


def test_equal_bakes_are_equal_bytes(tmp_path):
    s.moving_scene(tmp_path / "a", noise_density=0.5, flutter=0.05)
    s.bake()
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "b")
    s.bake()
    first, second = s.files_of(tmp_path / "a"), s.files_of(tmp_path / "b")
    assert first == second and len(first) > 30


def test_the_manifest_says_settings_and_statistics(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    s.bake()
    folder = s.folder_of(tmp_path, "Ground")
    manifest = s.manifest_of(tmp_path, "Ground")
    assert manifest["complete"] and manifest["object"] == "Ground" and len(manifest["hash"]) == 32
    assert [frame["frame"] for frame in manifest["frames"]] == [1, 2, 3, 4]
    assert manifest["frames"][-1]["depth"] == pytest.approx(0.1, rel=1e-6)
    assert manifest["frames"][-1]["volume"] == pytest.approx(0.1 * 4.0, rel=5e-3)
    heights = [f"height_000{i}.exr" for i in range(1, 5)]
    assert sorted(os.listdir(folder)) == ["ever_covered.exr", "frames.tsv", *heights, "object.json"]


def test_a_bake_writes_every_kind_of_map_whose_switch_is_on(addon, native, tmp_path):
    kinds = addon("base.map_kinds")
    s.receive(s.square("Ground"))
    s.settings(tmp_path, (1, 1), **{kind.setting: True for kind in kinds.ON_REQUEST})
    s.bake()
    for kind in kinds.MAP_KINDS:
        path = s.folder_of(tmp_path, "Ground") / f"{kind.name}_0001.{kind.ending}"
        if not kind.channels:
            assert len(addon("cache.flying").read_points(path)) == 0 < path.stat().st_size
            continue
        pixels, header = native.read_exr(str(path))
        assert pixels.shape == ((64, 64) if kind.channels == 1 else (64, 64, kind.channels)), kind.name
        assert header["half"] == kind.is_half, kind.name
        if kind.name == "normal":  # of level snow, (0, 0, 1)
            middle = dict(zip(header["channels"], pixels[32, 32].tolist()))
            assert middle == {"R": 0.5, "G": 0.5, "B": 1.0}


def test_ever_covered_marks_where_snow_lay(native, tmp_path):
    s.receive(s.square("Ground"))
    s.square("Roof", 1.0, z=1.0)
    s.settings(tmp_path)
    s.bake()
    mask = native.read_exr(str(s.folder_of(tmp_path, "Ground") / "ever_covered.exr"))[0]
    assert set(np.unique(mask)) == {0.0, 1.0}
    assert s.texel(mask, 0.5, 0.5) == 0 and s.texel(mask, 0.1, 0.1) == 1


def test_a_receiver_knows_where_its_files_are(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    s.bake()
    assert bpy.context.scene.snowbough.receivers[0].folder == str(s.folder_of(tmp_path, "Ground"))


def test_files_are_found_again_after_save_as_elsewhere(tmp_path):
    (tmp_path / "old").mkdir(), (tmp_path / "new").mkdir()
    s.receive(s.square("Ground"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old" / "shot.blend"))
    s.settings("//snowbough_cache")
    s.bake()
    entry = bpy.context.scene.snowbough.receivers[0]
    assert entry.folder.startswith("//snowbough_cache")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "new" / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new" / "shot.blend"))
    entry = bpy.context.scene.snowbough.receivers[0]
    assert os.path.isfile(os.path.join(bpy.path.abspath(entry.folder), "height_0001.exr"))
    bpy.ops.snowbough.free_bake()  # they are the other file's
    assert os.path.isfile(os.path.join(bpy.path.abspath(entry.folder), "height_0001.exr"))


def test_free_removes_what_the_bake_made_and_nothing_else(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    s.bake()
    (s.folder_of(tmp_path, "Ground") / "notes.txt").write_text("mine")
    bpy.ops.snowbough.free_bake()
    assert list(s.files_of(tmp_path)) == [
        f"Scene/v001/{os.listdir(tmp_path / 'Scene' / 'v001')[0]}/notes.txt"
    ]


def test_substeps_spread_a_fast_object_over_its_way(native, tmp_path):
    ground, roof = s.square("Ground", 4.0), s.square("Roof", 0.5, z=1.0, x=-1.0)
    s.key(roof, "location", (1, (0, 0, 0)), (2, (2.0, 0, 0)))
    for curve in roof.animation_data.action.fcurves if hasattr(roof.animation_data.action, "fcurves") else ():
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    s.receive(ground)
    s.settings(tmp_path, (1, 2), substeps=4)
    s.bake()
    gained = s.height(native, tmp_path, "Ground", 2) - s.height(native, tmp_path, "Ground", 1)
    # Half way, x = 0, the roof passes for one of four substeps.
    assert s.texel(gained, 0.5, 0.5) == pytest.approx(0.05 * 0.75, rel=0.05)
    assert s.texel(gained, 0.5, 0.9) == pytest.approx(0.05, rel=0.02)


def test_an_occluder_may_change_its_topology_and_leave(native, tmp_path):
    s.receive(s.square("Ground", 4.0))
    roof = s.square("Roof", 1.0, z=1.0)
    modifier = roof.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    for frame, levels in ((1, 0), (2, 2)):
        modifier.render_levels = levels
        modifier.keyframe_insert("render_levels", frame=frame)
    for frame, hidden in ((1, False), (3, True)):
        roof.hide_render = hidden
        roof.keyframe_insert("hide_render", frame=frame)
    s.settings(tmp_path)
    s.bake()
    middle = [s.texel(s.height(native, tmp_path, "Ground", frame), 0.5, 0.5) for frame in (2, 3, 4)]
    assert middle == pytest.approx([0, 0.025, 0.05], rel=0.05)


# -- what is refused ----------------------------------------------------------------------------------


def refused(match, **arguments):
    with pytest.raises(RuntimeError, match=match):
        s.bake(**arguments)


def test_a_receiver_without_uvs_is_named(tmp_path):
    s.receive(s.mesh_object("Bare", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    s.settings(tmp_path / "cache")
    refused("'Bare' has no UV map")
    assert not (tmp_path / "cache").exists()


def test_a_missing_uv_map_is_named(tmp_path):
    s.receive(s.square("Ground"))
    bpy.context.scene.snowbough.receivers[0].uv_map = "lost"
    s.settings(tmp_path / "cache")
    refused("no UV map 'lost'")


def test_no_receivers_at_all_says_what_to_do(tmp_path):
    s.square("Ground")
    s.settings(tmp_path)
    refused("Add snow to objects first")


def test_only_disabled_receivers_say_what_to_do(tmp_path):
    s.receive(s.square("Ground"))
    bpy.context.scene.snowbough.receivers[0].enabled = False
    s.settings(tmp_path)
    refused("nothing for snow to lie on")


def test_a_receiver_that_the_render_does_not_show_is_named(tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    ground.hide_render = True
    s.settings(tmp_path)
    refused("'Ground' is on the list of receivers, but not rendered on any frame of the shot")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no EGL")
def test_without_a_gpu_nothing_is_begun_and_nothing_is_lost(monkeypatch, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    monkeypatch.setenv("SNOWBOUGH_EGL_DEVICE", "no such device")
    refused("OpenGL.*no such device")
    assert not list(tmp_path.iterdir())
    monkeypatch.delenv("SNOWBOUGH_EGL_DEVICE")
    s.bake()
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    monkeypatch.setenv("SNOWBOUGH_EGL_DEVICE", "no such device")
    refused("OpenGL.*no such device")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_an_unwritable_cache_leaves_nothing_behind(tmp_path):
    (tmp_path / "file").write_text("no folder")
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "file" / "cache")
    refused("cannot be written.*Choose another one")
    assert os.listdir(tmp_path) == ["file"]


def test_an_unsaved_file_needs_a_cache_of_its_own():
    s.receive(s.square("Ground"))
    s.settings("//snowbough_cache")
    refused("Save the .blend first")


def test_a_bake_of_the_same_object_at_the_same_time_is_refused(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path, checkpoint_interval=2)
    key = addon("base.names").receiver_key("Ground", ("", "", ""))
    with addon("cache.lock").lock_receivers(tmp_path / "Scene" / "v001", [key]):
        refused("Ground-.* is being baked by process")
    s.bake()


def test_disabled_scripts_are_refused_with_a_hint(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    driver = bpy.data.objects["Ground"].driver_add("location", 2).driver
    driver.expression = "bpy.context.scene.frame_current * 2"  # needs Python
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"), use_scripts=False)
    refused("Driver.*start Blender with -y")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"), use_scripts=True)
    s.bake()
