# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview's simulation as the timeline and the settings change; it leaves the scene unchanged. Its drawing is
tested in tests/ui/test_preview.py."""

import math
import os

import bpy
import numpy as np
import pytest
import snow_scene as s

PACKAGE = os.environ["SNOWBOUGH_TEST_ADDON"]


@pytest.fixture
def ground():
    """A 2 m square in the ground as the only receiver; 10 frames lay 0.1 m."""
    obj = s.square("Ground")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 10
    scene.snowbough.flutter = 0.0
    scene.snowbough.receivers.add().object = obj
    return obj


@pytest.fixture
def preview(addon):
    """preview(): the preview of the current frame, started without a picture, which needs a window."""
    live = addon("preview.live")

    def start():
        live.start(bpy.context.scene, bpy.context.evaluated_depsgraph_get(), draws=False)
        return addon("base.session").preview

    yield start
    live.stop()


def play(first, last):
    for frame in range(first, last + 1):
        bpy.context.scene.frame_set(frame)


def height(running, name="Ground"):
    """Mean height of a receiver's map away from its border, in metres."""
    (key,) = [key for key in running.simulated.maps if key.startswith(name)]
    map_ = running.simulation.output(key, normal=False)["height"]
    edge = len(map_) // 4
    return float(np.mean(map_[edge:-edge, edge:-edge]))


def settle(running):
    """The timer of a window: checks immediately, and again after a while without changes."""
    for now in (0.0, 10.0):
        running.watch(bpy.context.scene, bpy.context.evaluated_depsgraph_get(), now)


# -- along the timeline ----------------------------------------------------------------------------------


def test_every_frame_shows_the_depth_that_a_bake_has_there(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    assert height(running) == pytest.approx(0.01, rel=0.02)
    play(2, 6)
    assert height(running) == pytest.approx(0.06, rel=0.02)


def test_a_slider_of_the_surface_shows_while_the_timeline_stands_still(ground, preview):
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    bpy.context.scene.frame_set(5)
    running = preview()
    (key,) = running.simulated.maps
    before, revision = running.surface(key).shown[0], running.revision
    settle(running)
    assert running.revision == revision
    bpy.context.scene.snowbough.surface_relief = 0.0
    settle(running)
    shown = running.surface(key).shown[0]
    assert running.revision == revision + 1
    assert 0.001 < abs(shown - before).max() < 0.05


def test_started_in_the_middle_all_of_that_frames_snow_lies(ground, preview):
    bpy.context.scene.frame_set(5)
    assert height(preview()) == pytest.approx(0.05, rel=0.02)


def test_dropped_frames_are_made_up_for(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    bpy.context.scene.frame_set(6)
    assert height(running) == pytest.approx(0.06, rel=0.02)


def test_going_back_shows_the_very_snow_of_then(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    maps = {}
    for frame in range(2, 9):
        bpy.context.scene.frame_set(frame)
        (key,) = running.simulated.maps
        maps[frame] = running.simulation.height(key)
    for frame in (4, 7, 2, 8):
        bpy.context.scene.frame_set(frame)
        assert (running.simulation.height(key) == maps[frame]).all()


def test_where_memory_has_let_go_the_frame_before_is_snowed_on(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    history = running.simulated.history
    history.budget = 4 * history.bytes
    play(2, 10)
    assert len(history) <= 4
    (missing, *_) = set(range(2, 10)) - set(history.frames)
    bpy.context.scene.frame_set(missing)
    assert height(running) == pytest.approx(0.01 * missing, rel=0.02)


def test_snow_goes_on_from_a_frame_that_was_gone_back_to(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 5)
    play(3, 7)
    assert height(running) == pytest.approx(0.07, rel=0.02)


def test_a_jump_beyond_what_was_played_lays_that_frames_snow(ground, preview):
    bpy.context.scene.frame_end = 50
    bpy.context.scene.frame_set(1)
    running = preview()
    bpy.context.scene.frame_set(40)
    assert height(running) == pytest.approx(0.08, rel=0.02)


def test_a_cart_keeps_the_snow_of_where_it_was(ground, preview, addon):
    """It stands below a roof for half of the shot."""
    roof = s.square("Roof", 3.0, z=2.0)
    s.key(ground, "location", (1, (0, 0, 0)), (5, (0, 0, 0)), (6, (9, 0, 0)), (10, (9, 0, 0)))
    for curve in addon("base.compat").curves_of(ground):
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 5)
    assert height(running) < 0.002
    play(6, 10)
    assert height(running) == pytest.approx(0.05, rel=0.05)
    assert roof.name not in {
        pose.name for key, pose in running.simulated.pose.objects.items() if pose.receiver
    }


def test_its_maps_are_those_that_a_bake_has_on_that_frame(preview, native, tmp_path):
    """A ground, a cart that drives and a flag that bends."""
    s.moving_scene(tmp_path, frames=(1, 8), directions=1)
    s.bake()
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 8)
    for name in ("Ground", "Cart", "Flag"):
        (key,) = [key for key in running.simulated.maps if key.startswith(name)]
        baked = s.height(native, tmp_path, name, 8)
        shown = running.simulation.output(key, normal=False)["height"]
        assert np.abs(shown - baked).mean() < 0.03 * np.abs(baked).mean(), name


# -- settings ----------------------------------------------------------------------------------------------


def test_another_depth_shows_at_once(ground, preview):
    bpy.context.scene.frame_set(5)
    running = preview()
    simulation = running.simulation
    bpy.context.scene.snowbough.end_depth = 0.3
    settle(running)
    assert height(running) == pytest.approx(0.15, rel=0.02)
    assert running.simulation is simulation


def test_another_depth_counts_for_frames_in_memory(ground, preview):
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 6)
    bpy.context.scene.snowbough.end_depth = 0.2
    bpy.context.scene.frame_set(3)
    assert height(running) == pytest.approx(0.06, rel=0.02)


def test_the_first_depth_shows_though_nothing_can_be_scaled(ground, preview):
    bpy.context.scene.snowbough.end_depth = 0.0
    bpy.context.scene.frame_set(5)
    running = preview()
    bpy.context.scene.snowbough.end_depth = 0.1
    settle(running)
    assert height(running) == pytest.approx(0.05, rel=0.02)


@pytest.fixture
def windy(ground):
    """A wall of 1 m west of the ground's middle: snow that comes from the west leaves its lee bare."""
    s.mesh_object("Wall", [(-0.5, -2, 0), (-0.5, 2, 0), (-0.5, 2, 1), (-0.5, -2, 1)], [(0, 1, 2, 3)])
    bpy.context.scene.snowbough.repose = math.pi / 2
    return ground


def lee(running):
    """Height east of the wall, within its shadow."""
    (key,) = [key for key in running.simulated.maps if key.startswith("Ground")]
    return s.texel(running.simulation.output(key, normal=False)["height"], 0.35, 0.5)


def test_another_direction_shows_at_once_and_on_the_same_simulation(windy, preview):
    bpy.context.scene.frame_set(5)
    running = preview()
    simulation = running.simulation
    assert lee(running) == pytest.approx(0.05, rel=0.05)
    bpy.context.scene.snowbough.bearing = math.radians(90.0)
    bpy.context.scene.snowbough.fall_angle = math.radians(45.0)
    settle(running)
    assert lee(running) < 0.002
    assert running.simulation is simulation


def test_another_direction_is_laid_over_the_poses_that_were_played(windy, preview, addon):
    """The wall is there in the second half of the shot only, so half of the snow lies in its lee."""
    wall = bpy.data.objects["Wall"]
    s.key(wall, "location", (1, (0, 0, -5)), (5, (0, 0, -5)), (6, (0, 0, 0)))
    for curve in addon("base.compat").curves_of(wall):
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 10)
    bpy.context.scene.snowbough.fall_angle = math.radians(45.0)
    bpy.context.scene.snowbough.bearing = math.radians(90.0)
    settle(running)
    assert lee(running) == pytest.approx(0.05, rel=0.1)


def test_another_repose_shows_at_once(ground, preview):
    bpy.context.scene.snowbough.repose = math.pi / 2
    bpy.context.scene.snowbough.end_depth = 0.5
    bpy.context.scene.frame_set(10)
    running = preview()
    (key,) = running.simulated.maps
    rim = running.simulation.height(key)[:, 0].mean()
    bpy.context.scene.snowbough.repose = math.radians(40.0)
    settle(running)
    assert running.simulation.height(key)[:, 0].mean() < 0.5 * rim


def test_another_blur_shows_at_once_and_leaves_the_snow(ground, preview):
    # Flutter brings thin snow under the roof: to bare ground nothing is smoothed.
    s.square("Roof", 0.5, z=0.5)
    bpy.context.scene.snowbough.flutter = math.radians(40.0)
    bpy.context.scene.snowbough.blur_radius = 0.0
    bpy.context.scene.snowbough.repose = math.pi / 2
    bpy.context.scene.frame_set(5)
    running = preview()
    (key,) = running.simulated.maps
    stored = running.simulation.height(key)

    def steepest():
        return np.abs(np.diff(running.simulation.output(key, normal=False)["height"], axis=1)).max()

    before = steepest()
    bpy.context.scene.snowbough.blur_radius = 8.0
    settle(running)
    assert steepest() < 0.5 * before
    assert (running.simulation.height(key) == stored).all()


def test_an_animated_rate_is_no_changed_setting(ground, preview):
    s.key(bpy.context.scene.snowbough, "rate", (1, 1.0), (10, 3.0))
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 6)
    assert not running.simulated.stale
    assert running.simulated.history.frames == (1, 2, 3, 4, 5, 6)


def test_an_object_that_is_moved_by_hand_takes_its_snow_along(ground, preview):
    bpy.context.scene.frame_set(5)
    running = preview()
    ground.location.x = 7.0
    bpy.context.view_layer.update()
    (pose,) = running.simulated.pose.objects.values()
    assert pose.positions[:, 0].mean() == pytest.approx(7.0)
    assert height(running) == pytest.approx(0.05, rel=0.02)


def test_another_receiver_begins_anew_with_it(ground, preview):
    bpy.context.scene.frame_set(5)
    running = preview()
    bpy.context.scene.snowbough.receivers.add().object = s.square("Box", 0.5, z=1.0)
    bpy.context.scene.frame_set(6)
    assert len(running.simulated.maps) == 2


# -- display -----------------------------------------------------------------------------------------------


@pytest.fixture
def preferences():
    """The add-on's preferences; restores the largest map afterwards."""
    own = bpy.context.preferences.addons[PACKAGE].preferences
    before = own.preview_resolution
    yield own
    own.preview_resolution = before


def test_maps_are_as_large_as_the_receiver_says_but_no_larger_than_allowed(ground, preview, preferences):
    bpy.context.scene.snowbough.receivers[0].resolution = 512
    for largest, side in (("1024", 512), ("256", 256)):
        preferences.preview_resolution = largest
        assert [own.resolution for own in preview().simulated.maps.values()] == [side]


def test_thin_slats_beside_a_wide_ground_get_the_points_that_their_hems_need(ground, preview):
    ground.scale = (10.0, 10.0, 1.0)
    for i in range(8):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.05 * i, 1.0), scale=(0.3, 0.02, 0.02))
    bpy.ops.object.select_pattern(pattern="Cube*", extend=False)
    bpy.ops.object.join()
    bpy.ops.snowbough.add_receivers()
    bpy.context.scene.frame_set(10)
    running = preview()
    (slats,) = [key for key in running.simulated.maps if key.startswith("Cube")]
    assert len(running.surface(slats).shown[0]) > 4000


def test_members_of_instanced_collections_are_there(ground, preview):
    empty = s.instanced(s.square("Inner", 0.5), name="Prop")
    empty.location.z = 1.0
    bpy.context.scene.snowbough.receivers.add().object = empty
    bpy.context.scene.frame_set(10)
    running = preview()
    assert height(running, "Prop") == pytest.approx(0.1, rel=0.05)


def test_snow_stays_when_the_mesh_gets_finer(ground, preview):
    modifier = ground.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    for frame, levels in ((1, 0), (4, 2)):
        modifier.levels = levels
        modifier.keyframe_insert("levels", frame=frame)
    bpy.context.scene.frame_set(1)
    running = preview()
    play(2, 6)
    assert height(running) == pytest.approx(0.06, rel=0.02)


def test_where_things_are_is_known_after_the_shots_end_too(ground, preview):
    bpy.context.scene.frame_set(10)
    running = preview()
    for frame, scale in ((12, 2.0), (13, 3.0)):
        ground.scale = (scale, scale, scale)
        bpy.context.scene.frame_set(frame)
    (key,) = running.simulated.maps
    assert running.simulation.texel_area(key).sum() == pytest.approx(36.0, rel=1e-3)


# -- the scene stays unchanged -------------------------------------------------------------------------------


def everything():
    return {
        name: sorted(block.name for block in getattr(bpy.data, name))
        for name in ("objects", "meshes", "materials", "images", "collections", "node_groups")
    }


def test_it_adds_nothing_while_it_runs(ground, preview):
    before = everything()
    preview()
    play(2, 4)
    assert everything() == before


@pytest.fixture
def baked(ground, tmp_path):
    """The ground with the snow surface of a bake."""
    bpy.context.scene.snowbough.cache_directory = str(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    bpy.ops.snowbough.bake()
    return bpy.data.objects["Ground Snow"]


def test_baked_snow_is_out_of_sight_meanwhile(baked, preview, addon):
    preview()
    assert baked.hide_viewport
    addon("preview.live").stop()
    assert not baked.hide_viewport
    assert baked.snowbough.hidden_by_preview == ""


def test_a_surface_that_was_hidden_before_stays_so(baked, preview, addon):
    baked.hide_viewport = True
    preview()
    addon("preview.live").stop()
    assert baked.hide_viewport


def test_a_file_saved_meanwhile_is_as_without_it_and_the_preview_goes_on(baked, preview, addon, tmp_path):
    preview()
    path = str(tmp_path / "shot.blend")
    # A copy: Blender does not read from the file that is open.
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    assert addon("base.session").preview is not None and baked.hide_viewport
    with bpy.data.libraries.load(path) as (content, loaded):
        assert sorted(content.objects) == ["Ground", "Ground Snow"]
        loaded.objects = ["Ground Snow"]
    (saved,) = loaded.objects
    assert not saved.hide_viewport and saved.snowbough.hidden_by_preview == ""


def test_what_a_recovered_file_hides_is_shown_when_it_is_opened(baked, preview, addon, tmp_path):
    """Blender autosaves without calling handlers."""
    preview()
    path = str(tmp_path / "recovered.blend")
    handler = addon("preview.live")._before_save
    bpy.app.handlers.save_pre.remove(handler)
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    bpy.app.handlers.save_pre.append(handler)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert addon("base.session").preview is None
    assert not bpy.data.objects["Ground Snow"].hide_viewport


def test_modifiers_of_a_bake_are_off_meanwhile(ground, preview, addon, tmp_path):
    bpy.context.scene.snowbough.cache_directory = str(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    bpy.ops.snowbough.bake()
    before = [(modifier.name, modifier.show_viewport) for modifier in ground.modifiers]
    assert before
    preview()
    assert not any(modifier.show_viewport for modifier in ground.modifiers)
    addon("preview.live").stop()
    assert [(modifier.name, modifier.show_viewport) for modifier in ground.modifiers] == before


# -- refusals and settings -------------------------------------------------------------------------------


def test_without_anything_to_snow_on_it_says_so(ground, preview):
    bpy.context.scene.snowbough.receivers[0].enabled = False
    with pytest.raises(ValueError, match="nothing for snow to lie on"):
        preview()


@pytest.mark.skipif(bpy.app.version >= (5, 2, 0), reason="from 5.2 on Blender draws in the background, too")
def test_the_button_says_why_nothing_can_be_drawn_in_the_background(ground, addon):
    with pytest.raises(RuntimeError, match="open the file in Blender's window, or bake"):
        bpy.ops.snowbough.toggle_preview()
    assert addon("base.session").preview is None


ERRORS = [
    RuntimeError("the driver was lost"),
    ValueError("out of range"),
    MemoryError("no room"),
    KeyError("gone"),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("when", ["frame", "edit", "setting"])
def test_any_error_ends_it_and_is_shown(ground, preview, addon, error, when):
    running = preview()
    simulated = running.simulated

    class Failing:
        """The simulated shot, whose updates raise an error."""

        def go_to(self, *_arguments):
            raise error

        apply_scene = apply_settings = go_to

        def __getattr__(self, name):
            return getattr(simulated, name)

    running.simulated = Failing()
    if when == "frame":
        bpy.context.scene.frame_set(3)
    elif when == "edit":
        ground.location.z = 1.0
        bpy.context.view_layer.update()
    else:
        assert addon("preview.live")._watch() is None
    session = addon("base.session")
    assert session.preview is None
    assert session.last_outcome[0] == "ERROR"
    assert "live preview has ended" in session.last_outcome[1] and error.args[0] in session.last_outcome[1]
    bpy.context.scene.frame_set(4)  # and no data remains


@pytest.mark.parametrize("how", ["renamed", "removed"])
def test_it_ends_with_its_scene(ground, preview, addon, how):
    running, scene = preview(), bpy.context.scene
    bpy.data.scenes.new("Other")
    if how == "renamed":
        scene.name = "Shot"
    else:
        bpy.data.scenes.remove(scene)
    assert addon("preview.live")._watch() is None
    assert addon("base.session").preview is None
    assert "'Scene' was removed or renamed" in addon("base.session").last_outcome[1]
    assert running.simulated.simulation is None


def test_it_sets_its_simulation_up_as_the_bake_does(addon, ground, preview, tmp_path, stand_in):
    """The same grid, the same objects, the same map and blur, from one function."""
    real, made = addon("base.native").load(), []

    class Recorded(real.SnowSimulation):
        def __init__(self, **settings):
            super().__init__(**settings)
            made.append((settings["pixel_size"], []))

        def add_object(self, name, triangles, uv, **options):
            super().add_object(name, triangles, uv, **options)
            made[-1][1].append((name, triangles.tolist(), uv.tolist(), options["resolution"], options["receive"],
                                options["blur_radius"], options["alpha"]))  # fmt: skip

    stand_in(SnowSimulation=Recorded)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, 2))
    snow = bpy.context.scene.snowbough
    snow.receivers[0].resolution = 256
    snow.cache_directory = str(tmp_path)
    bpy.ops.snowbough.bake()
    bpy.context.scene.frame_set(1)
    preview()
    assert len(made) == 2 and len(made[0][1]) == 2
    assert made[0] == made[1]
