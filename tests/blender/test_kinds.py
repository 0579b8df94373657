# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of snow set the sliders of existing and of later snow."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import inner, points_of


@pytest.fixture
def receivers(tmp_path):
    """A baked ground with a snow surface and one whose own material is snowy."""
    surface, plain = s.square("Surface"), s.square("Plain", x=5.0)
    s.receive(surface, plain)
    s.settings(tmp_path)
    for obj, mode in ((surface, "SHELL"), (plain, "NONE")):
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        bpy.ops.snowbough.setup_displacement(mode=mode, only_selected=True)
    s.bake()
    return bpy.data.objects["Surface Snow"], plain


def slider(obj, name):
    nodes = obj.material_slots[0].material.node_tree.nodes
    return next(node for node in nodes if node.type == "GROUP").inputs[name].default_value


@pytest.mark.parametrize("kind", ["POWDER", "FRESH", "WET", "OLD", "SAND", "DUST", "ASH"])
def test_a_kind_sets_all_sliders(addon, receivers, kind):
    bpy.ops.snowbough.set_kind(kind=kind)
    look = addon("result.look").LOOKS[kind]
    for obj in receivers:
        for name, value in look.inputs().items():
            assert np.allclose(slider(obj, name), value), name
    # Fresh snow, whose relief is 0.6, has the surface's own slider at 1.
    assert bpy.context.scene.snowbough.surface_relief == pytest.approx(look.relief / 0.6)


def test_a_kind_shows_in_the_relief_of_the_current_frame(receivers):
    surface, _ = receivers
    reliefs = []
    for kind in ("OLD", "WET"):
        bpy.ops.snowbough.set_kind(kind=kind)
        reliefs.append(inner(points_of(surface))[:, 2].std())
    assert reliefs[0] > 2.0 * reliefs[1] > 0.0


def test_snow_that_is_made_later_is_of_the_scenes_kind(receivers):
    bpy.ops.snowbough.set_kind(kind="WET")
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    assert slider(bpy.data.objects["Plain Snow"], "Grain") == pytest.approx(0.5)


def test_what_an_artist_sets_stays_until_another_kind_is_chosen(receivers):
    surface, _ = receivers
    node = next(node for node in surface.material_slots[0].material.node_tree.nodes if node.type == "GROUP")
    node.inputs["Sparkle"].default_value = 0.9
    bpy.context.scene.frame_set(5)
    assert slider(surface, "Sparkle") == pytest.approx(0.9)
    bpy.ops.snowbough.set_kind(kind="OLD")
    assert slider(surface, "Sparkle") == pytest.approx(0.3)


def test_a_group_of_an_earlier_version_keeps_its_materials(addon):
    old = bpy.data.node_groups.new("Snowbough Snow", "ShaderNodeTree")
    made = addon("result.snow_nodes").ensure_group()
    assert (
        made is not old
        and made.name == "Snowbough Snow"
        and "Position" in addon("base.compat_nodes").group_sockets(made, "INPUT")
    )
    assert old.name != "Snowbough Snow"


@pytest.mark.parametrize(
    "kind, degrees, millimetres",
    [("POWDER", 40, 2), ("FRESH", 65, 5), ("WET", 80, 12), ("OLD", 60, 4), ("SAND", 34, 0), ("DUST", 90, 0)],
)
def test_a_kind_says_how_steep_snow_lies(kind, degrees, millimetres):
    bpy.context.scene.snowbough.repose = 0.5
    bpy.ops.snowbough.set_kind(kind=kind)
    assert math.degrees(bpy.context.scene.snowbough.repose) == pytest.approx(degrees)
    assert bpy.context.scene.snowbough.cohesion == pytest.approx(millimetres / 1000.0)


def test_every_kind_has_a_look_and_another_kind_takes_all_of_it_back(addon):
    settings = bpy.context.scene.snowbough
    names, looks = addon("base.names"), addon("result.look").LOOKS
    assert list(looks) == [kind for kind, *_ in names.SNOW_KINDS]
    changed = list(looks["FRESH"].settings())
    fresh = [getattr(settings, name) for name in changed]
    for kind in ("DUST", "SAND"):
        bpy.ops.snowbough.set_kind(kind=kind)
    assert settings.granular and settings.flutter == pytest.approx(math.radians(10))
    assert settings.blur_radius == 0.0
    bpy.ops.snowbough.set_kind(kind="FRESH")
    assert settings.blur_radius == 2.0
    assert [getattr(settings, name) for name in changed] == pytest.approx(fresh)


def test_dust_stays_on_walls(addon, tmp_path):
    """Level ground gets End Depth, each side of an upright sheet half of it and a little that rises."""
    ground, wall = s.square("Ground"), s.square("Wall", x=5.0)
    wall.rotation_euler = (math.pi / 2, 0.0, 0.0)
    s.receive(ground, wall)
    s.settings(tmp_path, (1, 2), end_depth=0.001)
    bpy.ops.snowbough.set_kind(kind="DUST")
    s.bake()
    for name, least, most in (("Ground", 0.95, 1.05), ("Wall", 0.9, 1.2)):
        height = np.abs(s.height(addon("base.native").load(), tmp_path, name, 2))
        middle = height[height.shape[0] // 2, height.shape[1] // 2]
        assert least < middle / 0.001 < most, name


@pytest.fixture
def previewed(addon):
    """A function that plays the scene's shot in the live preview and returns {name: heights} of its last frame."""
    live, scene = addon("preview.live"), bpy.context.scene

    def play():
        scene.frame_set(scene.frame_start)
        live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
        for frame in range(scene.frame_start + 1, scene.frame_end + 1):
            scene.frame_set(frame)
        preview = addon("base.session").preview
        return {key.split("/")[-1]: np.abs(preview.heights(key)) for key in preview.simulated.maps}

    yield play
    live.stop()


def test_the_live_preview_shows_sand_as_the_bake(previewed, addon, tmp_path):
    """A heap that is level in the middle and no steeper than Repose at the border of its board."""
    s.receive(s.square("Board"), resolution=128)
    s.settings(tmp_path, (1, 2), start_depth=0.2, end_depth=0.21)
    bpy.ops.snowbough.set_kind(kind="SAND")
    (sand,) = previewed().values()
    assert sand[64, 64] == pytest.approx(0.21, abs=2e-3)
    steep = np.degrees(np.arctan(np.hypot(*np.gradient(sand, 2.0 / 128))))
    assert 30.0 < np.median(steep[4:18, 40:88]) < 34.0
    s.bake()
    assert np.abs(sand - s.height(addon("base.native").load(), tmp_path, "Board", 2)).max() < 2e-3


def test_the_live_preview_shows_dust_as_the_bake(previewed, addon, tmp_path):
    """An upright sheet takes it from both sides; fresh snow leaves it bare. The preview has one direction a frame:
    32 come within 12 % of the whole sky."""
    wall = s.square("Wall")
    wall.rotation_euler = (math.pi / 2, 0.0, 0.0)
    s.receive(wall)
    s.settings(tmp_path, (1, 33), end_depth=0.001)
    bpy.ops.snowbough.set_kind(kind="DUST")
    (dust,) = previewed().values()
    s.bake()
    baked = np.abs(s.height(addon("base.native").load(), tmp_path, "Wall", 33))
    assert np.abs(dust - baked).max() < 0.12 * baked.max()
    bpy.ops.snowbough.set_kind(kind="FRESH")
    (snow,) = previewed().values()
    assert snow.max() < 0.1 * dust.min()
