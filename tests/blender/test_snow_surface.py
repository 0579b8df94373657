# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface in the scene: its position, its motion, its creation and removal."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import bake_surfaces, box, inner, points_at, points_of, surface_of

DEPTH = 0.1
SURFACE_FILES = ("surface.ply", "surface.pc2", "surface.json")


@pytest.fixture
def ground(tmp_path):
    """The surface of a level square of 2 m, baked in frames 1 to 4; the cache is tmp/cache."""
    (surface,) = bake_surfaces(tmp_path / "cache", s.square("Ground"))
    return surface


def surface_files(files):
    return {name for name in files if Path(name).name in SURFACE_FILES}


# -- the object ----------------------------------------------------------------------------------------------


def test_a_surface_is_a_child_of_its_receiver_that_reads_a_point_cache(ground, tmp_path):
    assert ground.name == "Ground Snow" and ground.parent == bpy.data.objects["Ground"]
    (modifier,) = ground.modifiers
    assert (modifier.type, modifier.cache_format, modifier.interpolation) == ("MESH_CACHE", "PC2", "LINEAR")
    assert bpy.path.abspath(modifier.filepath) == str(
        s.folder_of(tmp_path / "cache", "Ground") / "surface.pc2"
    )
    assert not [group for group in bpy.data.node_groups if group.bl_idname == "GeometryNodeTree"]


def test_on_level_ground_it_is_as_high_as_the_map(ground, addon, tmp_path):
    native = addon("base.native").load()
    for frame in (1, 2, 3, 4):
        wanted = s.open_ground(s.height(native, tmp_path / "cache", "Ground", frame))
        assert wanted == pytest.approx(DEPTH * frame / 4, rel=0.05)
        heights = inner(points_at(ground, frame))[:, 2]
        assert heights == pytest.approx(wanted, rel=0.15)


def test_the_faces_stay_the_same_during_the_shot(ground):
    counts = {frame: len(points_at(ground, frame)) for frame in (-3, 1, 4, 20)}
    assert len(set(counts.values())) == 1 and counts[1] > 100


def test_it_covers_only_what_snow_ever_lies_on(tmp_path):
    """A roof shelters the right half of the ground."""
    s.square("Roof", 4.0, z=1.0, x=2.0)
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"), fall_angle=0.0)
    points = points_at(surface, 4)
    assert points[:, 0].min() == pytest.approx(-1.0, abs=0.05)
    snowy = points[points[:, 2] > 0.001]
    assert -0.05 < snowy[:, 0].max() < DEPTH
    assert points[:, 0].max() < 0.4


def test_nothing_shows_before_the_first_frame_and_the_last_depth_stays(tmp_path):
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"), frames=(5, 8))
    for frame in (-10, 1, 4):
        assert points_at(surface, frame)[:, 2].max() <= 0.0
    assert points_at(surface, 5)[:, 2].max() > 0.01
    assert np.array_equal(points_at(surface, 50), points_at(surface, 8))


def test_between_two_frames_it_is_half_way(ground):
    before, after = points_at(ground, 2), points_at(ground, 3)
    assert np.abs(points_at(ground, 2, 0.5) - (before + after) / 2).max() < 1e-6


def test_the_material_finds_the_map_by_the_surfaces_own_coordinates(ground):
    layer = ground.data.uv_layers["snow"]
    for polygon in ground.data.polygons:
        for corner in polygon.loop_indices:
            x, y, z = ground.data.vertices[ground.data.loops[corner].vertex_index].co
            if max(abs(x), abs(y)) < 0.5:
                assert tuple(layer.data[corner].uv) == pytest.approx((x / 2 + 0.5, y / 2 + 0.5), abs=0.01)


# -- receivers that move, bend and are scaled -----------------------------------------------------------------


def test_it_follows_a_receiver_that_turns(tmp_path):
    cart = s.square("Cart", 1.0)
    s.key(cart, "rotation_euler", (1, (0.0, 0.0, 0.0)), (4, (0.0, math.radians(-20.0), 0.0)))
    (surface,) = bake_surfaces(tmp_path, cart)
    points = points_at(surface, 4)
    along = points[(np.abs(points[:, 1]) < 0.2) & (np.abs(points[:, 0]) < 0.3)]
    slope, _ = np.polyfit(along[:, 0], along[:, 2], 1)
    assert slope == pytest.approx(math.tan(math.radians(20.0)), rel=0.1)


def test_it_follows_an_armature(tmp_path):
    cells = 8
    sheet = s.strip("Sheet", cells)
    s.bend(sheet, cells, (1, 0.0), (4, math.radians(30.0)))
    (surface,) = bake_surfaces(tmp_path, sheet)
    for frame in (1, 4):
        points = inner(points_at(surface, frame))
        (x0, y0, z0), (_, y1, z1) = points_of(sheet).reshape(2, cells + 1, 3).transpose(0, 2, 1)
        near, far = (np.interp(points[:, 0], x0, y) for y in (y0, y1))
        below, above = (np.interp(points[:, 0], x0, z) for z in (z0, z1))
        level = below + (points[:, 1] - near) / (far - near) * (above - below)
        assert points[:, 2] - level == pytest.approx(DEPTH * frame / 4, rel=0.3)
    assert np.ptp(z1) > 0.2


SCALES = [(-1, 1, 1), (-1, -1, 1), (2, 2, -2), (-1, -1, -1), (0.5, 3.0, 2.0)]


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("shape", ["sheet", "box"])
def test_depth_is_in_metres_however_the_receiver_is_scaled(tmp_path, scale, shape):
    obj = s.square("Thing") if shape == "sheet" else box("Thing", 2.0, z=-1.0)
    obj.scale = scale
    top = 0.0 if shape == "sheet" else abs(scale[2])
    (surface,) = bake_surfaces(tmp_path, obj, resolution=128)
    points = points_at(surface, 4)
    heights = inner(points[points[:, 2] > top], 0.5)[:, 2] - top
    assert heights.mean() == pytest.approx(DEPTH, rel=0.05)
    assert heights == pytest.approx(DEPTH, rel=0.2)  # with its relief


def test_depth_is_in_metres_while_the_scale_is_animated(tmp_path):
    obj = s.square("Ground")
    s.key(obj, "scale", (1, (1.0, 1.0, 1.0)), (4, (2.0, 3.0, 0.5)))
    (surface,) = bake_surfaces(tmp_path, obj)
    assert inner(points_at(surface, 1))[:, 2] == pytest.approx(DEPTH / 4, rel=0.15)
    points = points_at(surface, 4)
    assert np.ptp(points[:, 1]) == pytest.approx(6.0, rel=0.1)
    # The snow of the first frames was spread as the square grew.
    assert 0.3 * DEPTH < inner(points)[:, 2].mean() < 1.15 * DEPTH


def test_snow_stands_on_the_upper_side_of_a_card_that_faces_down(tmp_path):
    card = s.square("Card")
    card.data.flip_normals()
    (surface,) = bake_surfaces(tmp_path, card)
    assert inner(points_at(surface, 4))[:, 2] == pytest.approx(DEPTH, rel=0.15)


# -- linked meshes --------------------------------------------------------------------------------------------


def test_two_objects_of_one_mesh_get_snow_and_are_not_changed(tmp_path):
    ground = s.square("Ground")
    twin = bpy.data.objects.new("Twin", ground.data)
    bpy.context.scene.collection.objects.link(twin)
    twin.location.x = 5.0
    surfaces = bake_surfaces(tmp_path, ground, twin)
    assert not ground.data.materials and not ground.modifiers and not twin.modifiers
    for surface, x in zip(surfaces, (0.0, 5.0)):
        points = inner(points_at(surface, 4))
        assert points[:, 0].mean() == pytest.approx(x, abs=0.02)
        assert points[:, 2] == pytest.approx(DEPTH, rel=0.15)


def test_an_object_of_a_library_gets_snow_and_is_not_changed(tmp_path):
    s.square("Ground")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, loaded):
        loaded.objects = ["Ground"]
    (ground,) = loaded.objects
    bpy.context.scene.collection.objects.link(ground)
    (surface,) = bake_surfaces(tmp_path / "cache", ground)
    assert ground.library and not ground.data.materials and not ground.modifiers
    assert surface.library is None and surface.parent == ground
    assert inner(points_at(surface, 4))[:, 2] == pytest.approx(DEPTH, rel=0.15)


def test_a_receiver_whose_faces_change_has_no_surface_and_it_is_said(addon, tmp_path):
    ground = s.square("Ground")
    modifier = ground.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    for frame, levels in ((1, 0), (2, 0), (3, 2)):
        modifier.render_levels = levels
        modifier.keyframe_insert("render_levels", frame=frame)
    s.receive(ground)
    s.settings(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    assert "Ground Snow" not in bpy.data.objects
    severity, text = addon("base.session").last_outcome
    assert severity == "WARNING"
    assert "'Ground' has other faces from frame 3 on, so it has no snow surface: choose Displacement" in text
    assert s.height(addon("base.native").load(), tmp_path, "Ground", 4).max() > 0.05


# -- sliders --------------------------------------------------------------------------------------------------


def with_slider(surface, frame, name, value):
    """The points of a frame with a slider of the scene's set, computed for all frames."""
    setattr(bpy.context.scene.snowbough, name, value)
    bpy.ops.snowbough.update_surface()
    return points_at(surface_of(surface), frame)


def test_overhang_lets_snow_lean_out_farther(tmp_path):
    thing = box("Thing")
    bake_surfaces(tmp_path, thing, resolution=128)
    reach = [
        np.abs(with_slider(thing, 4, "surface_overhang", value)[:, :2]).max() for value in (0.0, 1.0, 2.0)
    ]
    assert 0.5 <= reach[0] + 0.005 < reach[1] < reach[2] - 0.005
    assert reach[2] < 0.5 + DEPTH


def test_relief_zero_is_flat_on_level_ground(tmp_path):
    ground = s.square("Ground")
    bake_surfaces(tmp_path, ground)
    flat, fresh = (inner(with_slider(ground, 4, "surface_relief", value))[:, 2] for value in (0.0, 1.0))
    assert np.ptp(flat) < 0.02 * DEPTH
    assert np.ptp(fresh) > 3.0 * np.ptp(flat)


@pytest.mark.parametrize("name", ["overhang", "hem_variation", "relief"])
def test_a_slider_shows_in_the_current_frame_at_once_and_files_stay(ground, tmp_path, name):
    before, files = points_at(ground, 3), s.files_of(tmp_path / "cache")
    setattr(bpy.context.scene.snowbough, f"surface_{name}", 0.0)
    assert np.abs(points_of(ground) - before).max() > 0.0005
    assert s.files_of(tmp_path / "cache") == files
    setattr(bpy.context.scene.snowbough, f"surface_{name}", 1.0)
    assert np.abs(points_of(ground) - before).max() < 1e-6


def test_another_frame_shows_the_files_again(ground, tmp_path):
    before = points_at(ground, 4)
    bpy.context.scene.frame_set(3)
    bpy.context.scene.snowbough.surface_relief = 0.0
    assert np.array_equal(points_at(ground, 4), before)
    assert bpy.path.abspath(ground.modifiers[0].filepath).startswith(str(tmp_path))


def test_what_a_slider_shows_is_what_update_surface_writes(ground):
    bpy.context.scene.frame_set(3)
    bpy.context.scene.snowbough.surface_overhang = 2.0
    shown = points_of(ground)
    bpy.ops.snowbough.update_surface()
    assert np.abs(points_at(bpy.data.objects["Ground Snow"], 3) - shown).max() < 1e-6


def test_a_receiver_may_have_sliders_of_its_own(tmp_path):
    things = [box("One"), box("Two", z=5.0)]
    bake_surfaces(tmp_path, *things, resolution=128)
    before = [points_at(surface_of(thing), 4) for thing in things]
    own = bpy.context.scene.snowbough.receivers[1]
    own.own_surface, own.surface_overhang = True, 0.0
    bpy.ops.snowbough.update_surface()
    after = [points_at(surface_of(thing), 4) for thing in things]
    assert np.array_equal(after[0], before[0])
    assert np.abs(after[1] - before[1]).max() > 0.005


def test_update_surface_changes_only_surfaces_and_simulates_nothing(ground, tmp_path, stand_in):
    before = s.files_of(tmp_path / "cache")
    assert len(surface_files(before)) == len(SURFACE_FILES)

    def simulate(**_settings):
        raise AssertionError("update_surface simulates")

    stand_in(SnowSimulation=simulate)
    bpy.context.scene.snowbough.surface_relief = 0.0
    bpy.ops.snowbough.update_surface()
    after = s.files_of(tmp_path / "cache")
    assert set(after) == set(before)
    changed = {name for name in before if after[name] != before[name]}
    assert changed == surface_files(before)


def test_update_surface_twice_gives_the_same_bytes(ground, tmp_path):
    before = s.files_of(tmp_path / "cache")
    bpy.ops.snowbough.update_surface()
    assert s.files_of(tmp_path / "cache") == before


def test_finer_detail_has_more_points(tmp_path):
    thing = box("Thing")
    bake_surfaces(tmp_path, thing, resolution=128)
    counts = []
    for detail in ("DRAFT", "DEFAULT", "FILM"):
        bpy.context.scene.snowbough.surface_detail = detail
        bpy.ops.snowbough.update_surface()
        counts.append(len(points_of(surface_of(thing))))
    assert counts[0] < counts[1] < counts[2]


def test_the_panel_names_a_receiver_that_lacks_points(addon, tmp_path, monkeypatch):
    coarsened = addon("result.snow_surface").coarsened
    bake_surfaces(tmp_path, box("Thing"), resolution=128)
    assert coarsened(bpy.context.scene) == []
    monkeypatch.setitem(addon("surface.style").DETAILS, "DRAFT", (1.0, 500))
    bpy.context.scene.snowbough.surface_detail = "DRAFT"
    bpy.ops.snowbough.update_surface()
    assert coarsened(bpy.context.scene) == ["Thing"]


# -- creation and removal -----------------------------------------------------------------------------------------


def snow_inputs(addon, surface):
    (node,) = addon("result.look").group_nodes(surface.material_slots[0].material)
    return node.inputs


def test_touched_sliders_of_the_material_outlive_another_bake(ground, addon):
    inputs = snow_inputs(addon, ground)
    inputs["Grain"].default_value = 2.0
    inputs["Color"].default_value = (0.5, 0.25, 0.125, 1.0)
    for _ in range(2):
        s.bake()
        inputs = snow_inputs(addon, bpy.data.objects["Ground Snow"])
        assert inputs["Grain"].default_value == 2.0
        assert tuple(inputs["Color"].default_value) == (0.5, 0.25, 0.125, 1.0)
    assert [material.name for material in bpy.data.materials] == ["Ground Snow"]


def test_sliders_that_nobody_touched_follow_the_scenes_kind_in_the_next_bake(ground, addon):
    snow_inputs(addon, ground)["Grain"].default_value = 2.0
    bpy.context.scene.snowbough.kind = "OLD"
    s.bake()
    inputs = snow_inputs(addon, bpy.data.objects["Ground Snow"])
    assert inputs["Grain"].default_value == 2.0
    assert inputs["Sparkle"].default_value == pytest.approx(addon("result.look").LOOKS["OLD"].sparkle)


def test_apply_snow_makes_plain_geometry_of_the_current_frame(ground):
    wanted = points_at(ground, 3)
    bpy.ops.snowbough.apply_snow()
    plain = bpy.data.objects["Ground Snow 0003"]
    assert not plain.modifiers and plain.parent is None and not plain.snowbough.is_shell
    assert np.abs(points_of(plain) - wanted).max() < 1e-6
    assert np.abs(points_at(plain, 1) - wanted).max() < 1e-6


@pytest.mark.parametrize("frames", ["KEYS", "CACHE"])
def test_apply_snow_of_a_shot_moves_like_the_surface_and_outlives_the_bake(tmp_path, frames):
    obj = s.square("Ground")
    s.bend(obj, 4, (1, 0.0), (4, -0.3))
    obj.location.x = 0.0
    obj.keyframe_insert("location", frame=1)
    obj.location.x = 1.0
    obj.keyframe_insert("location", frame=4)
    (surface,) = bake_surfaces(tmp_path / "cache", obj)
    shown = {
        (frame, part): points_at(surface, frame, part)
        for frame, part in ((1, 0.0), (2, 0.5), (4, 0.0), (9, 0.0))
    }
    bpy.ops.snowbough.apply_snow(frames=frames, directory=str(tmp_path / "applied"))
    assert surface.hide_render and surface.hide_get()
    bpy.ops.snowbough.free_bake()
    plain = bpy.data.objects["Ground Snow Applied"]
    assert [modifier.type for modifier in plain.modifiers] == ([] if frames == "KEYS" else ["MESH_CACHE"])
    assert not plain.snowbough.is_shell and not plain.snowbough.occlude
    for (frame, part), wanted in shown.items():
        assert np.abs(points_at(plain, frame, part) - wanted).max() < 1e-5
    assert np.ptp(shown[4, 0.0][:, 2]) > 0.2


def test_apply_snow_of_a_shot_keeps_earlier_files(tmp_path):
    (surface,) = bake_surfaces(tmp_path / "cache", s.square("Ground"))
    folder = tmp_path / "applied"
    folder.mkdir()
    (folder / "Ground Snow.pc2").write_bytes(b"mine")
    bpy.ops.snowbough.apply_snow(frames="CACHE", directory=str(folder))
    assert (folder / "Ground Snow.pc2").read_bytes() == b"mine"
    assert sorted(path.name for path in folder.iterdir()) == ["Ground Snow.001.pc2", "Ground Snow.pc2"]


def test_apply_snow_refuses_more_shape_keys_than_a_file_should_hold(tmp_path, addon, monkeypatch):
    bake_surfaces(tmp_path / "cache", s.square("Ground"))
    monkeypatch.setattr(addon("result.applied_snow"), "MAX_KEY_BYTES", 1000)
    objects = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match="points on 4 frames.*use Mesh Cache"):
        bpy.ops.snowbough.apply_snow(frames="KEYS")
    with pytest.raises(RuntimeError, match="Save the .blend first"):
        bpy.ops.snowbough.apply_snow(frames="CACHE")
    assert set(bpy.data.objects) == objects


def test_apply_snow_says_what_to_do_where_no_surface_was_computed(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    s.bake()
    objects = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match="no snow surface.*Snow Surface, then bake"):
        bpy.ops.snowbough.apply_snow()
    assert set(bpy.data.objects) == objects


def blocks():
    return {
        kind: sorted(block.name for block in getattr(bpy.data, kind))
        for kind in ("objects", "meshes", "materials")
    }


def slots(obj):
    return [(slot.link, slot.material.name) for slot in obj.material_slots]


@pytest.fixture
def bare_and_snowy(tmp_path):
    """The file's data before the snow. The square, which has its own materials, is then baked."""
    ground = s.square("Ground")
    for name in ("Soil", "Stone"):
        ground.data.materials.append(bpy.data.materials.new(name))
    ground.material_slots[1].link = "OBJECT"
    ground.material_slots[1].material = bpy.data.materials["Soil"]
    bpy.data.materials["Stone"].use_fake_user = True
    bare = blocks()
    bake_surfaces(tmp_path / "cache", ground)
    assert blocks() != bare
    assert slots(ground) == [("DATA", "Soil"), ("OBJECT", "Soil")] and not ground.modifiers
    return bare


def test_remove_snow_removes_it(bare_and_snowy):
    bpy.ops.snowbough.remove()
    assert blocks() == bare_and_snowy
    (receiver,) = bpy.context.scene.snowbough.receivers
    assert receiver.restore == "" and slots(receiver.object) == [("DATA", "Soil"), ("OBJECT", "Soil")]


def test_remove_snow_removes_a_renamed_one(bare_and_snowy):
    bpy.data.objects["Ground Snow"].name = "Blanket"
    bpy.ops.snowbough.remove()
    assert set(blocks()["objects"]) == {"Ground"}


def test_taking_the_line_off_the_list_removes_it(bare_and_snowy, tmp_path):
    bpy.ops.snowbough.remove_receiver()
    assert blocks() == bare_and_snowy
    assert list((tmp_path / "cache").rglob("surface.pc2"))


@pytest.mark.parametrize("how", ["delete", "remove"])
def test_it_goes_with_its_receiver(bare_and_snowy, addon, how):
    ground = bpy.data.objects["Ground"]
    if how == "delete":
        for obj in bpy.context.scene.objects:
            obj.select_set(obj == ground)
        bpy.ops.object.delete()
    else:
        bpy.data.objects.remove(ground)
    bpy.context.view_layer.update()
    addon("result.deleted_receivers")._remove()  # a timer in the window
    assert not bpy.context.scene.objects


def test_free_bake_removes_its_files_and_the_object(bare_and_snowy, tmp_path):
    bpy.ops.snowbough.free_bake()
    assert not [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]
    assert blocks() == bare_and_snowy


def test_another_bake_replaces_it(ground, tmp_path):
    bpy.context.scene.snowbough.end_depth = 0.2
    s.bake()
    assert len([obj for obj in bpy.data.objects if obj.snowbough.is_shell]) == 1
    surface = bpy.data.objects["Ground Snow"]
    assert "v002" in surface.modifiers[0].filepath
    assert inner(points_at(surface, 4))[:, 2] == pytest.approx(0.2, rel=0.15)


def test_another_bake_does_not_snow_on_it(ground, addon, tmp_path):
    bpy.context.scene.snowbough.checkpoint_interval += 1
    s.bake()
    native = addon("base.native").load()
    first, second = (s.height(native, tmp_path / "cache", "Ground", 4, version) for version in (1, 2))
    assert np.array_equal(first, second)


def test_while_a_bake_runs_it_reads_no_points(ground, addon):
    (modifier,) = ground.modifiers
    with addon("result.displacement").Muted(bpy.context.scene):
        assert not modifier.show_render
    assert modifier.show_render


def test_saved_elsewhere_it_still_finds_its_point_cache(tmp_path):
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "here" / "shot.blend"))
    (surface,) = bake_surfaces("//cache", s.square("Ground"))
    assert surface.modifiers[0].filepath.startswith("//cache")
    before = points_at(surface, 3)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "there" / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "there" / "shot.blend"))
    assert np.array_equal(points_at(bpy.data.objects["Ground Snow"], 3), before)


def test_a_folder_that_moves_with_its_blend_keeps_it(tmp_path):
    (tmp_path / "here").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "here" / "shot.blend"))
    (surface,) = bake_surfaces("//cache", s.square("Ground"))
    before = points_at(surface, 3)
    bpy.ops.wm.save_mainfile()
    (tmp_path / "here").rename(tmp_path / "there")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "there" / "shot.blend"))
    assert np.array_equal(points_at(bpy.data.objects["Ground Snow"], 3), before)


# -- the same bytes -------------------------------------------------------------------------------------------


@pytest.fixture
def undisturbed(tmp_path):
    """A ground, a cart and a flag that bends, with surfaces, and the bytes of their whole bake. The cache is tmp/cache
    then."""
    s.moving_scene(tmp_path / "whole", (1, 6))
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    files = s.files_of(tmp_path / "whole")
    assert len(surface_files(files)) == 3 * len(SURFACE_FILES)
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "cache")
    return files


# The thin snow of frame 1 alone would take ten times as many points.
@pytest.mark.parametrize("last", [2, 5])
def test_a_resumed_bake_writes_the_same_surfaces(addon, undisturbed, tmp_path, last):
    assert s.bake_part(addon, 1, last).error is None
    half = s.files_of(tmp_path / "cache")
    assert surface_files(half) == surface_files(undisturbed)
    assert any(half[name] != undisturbed[name] for name in surface_files(half))
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_stopped_bake_has_surfaces_of_what_is_done(addon, undisturbed, tmp_path):
    from_scene, engine = addon("bake.from_scene"), addon("bake.engine")
    running = from_scene.prepare_bake(bpy.context.scene, from_scene.make_request(bpy.context.scene))
    running.job.stopping_seconds = 1e6  # however busy the machine is
    running.on_frame = lambda result: engine.stop() if result.frame == 2 else None
    engine.run(bpy.context, running)
    addon("bake.outcome").conclude(bpy.context.scene, running)
    last = running.job.results[-1].frame
    assert running.cancelled and last < 6
    assert surface_files(s.files_of(tmp_path / "cache")) == surface_files(undisturbed)
    heights = inner(points_at(bpy.data.objects["Ground Snow"], last), 0.9)[:, 2]
    assert heights.max() == pytest.approx(DEPTH * last / 6, rel=0.2)
    # Mesh Cache rounds beyond its last sample.
    held = points_at(bpy.data.objects["Ground Snow"], 6)[:, 2].max()
    assert held == pytest.approx(heights.max(), abs=1e-6)


def test_a_bake_that_was_stopped_while_its_surfaces_were_made_resumes(addon, undisturbed, tmp_path):
    stop = addon("bake.engine").stop
    assert s.bake_part(addon, on_frame=lambda result: stop() if result.frame == 6 else None).cancelled
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_bake_in_parts_of_the_receivers_writes_the_same_bytes(addon, undisturbed, tmp_path):
    assert s.bake_part(addon, 1, 6, ["Flag"]).error is None
    assert s.bake_part(addon, 1, 6, ["Ground", "Cart"]).error is None
    assert s.files_of(tmp_path / "cache") == undisturbed
