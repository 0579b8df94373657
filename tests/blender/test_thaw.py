# SPDX-License-Identifier: GPL-3.0-or-later
"""Thaw and rain: End Depth below Start Depth, a sun lamp, and maps of water."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s


@pytest.fixture
def native(addon):
    return addon("base.native").load()


def sun(direction_angle=0.0):
    """A sun lamp; 0 shines straight down, positive angles from +X."""
    lamp = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    lamp.rotation_euler = (0.0, direction_angle, 0.0)
    bpy.context.scene.collection.objects.link(lamp)
    return lamp


def wet(native, root, name, frame):
    return native.read_exr(str(s.folder_of(root, name) / f"wet_{frame:04d}.exr"))[0]


def middle(map_):
    return float(np.median(s.open_ground(map_)))


def thawing(tmp_path, frames=(1, 4), **values):
    own = s.settings(tmp_path, frames, start_depth=0.1, end_depth=0.04, unevenness=0.0)
    for name, value in values.items():
        setattr(own, name, value)
    return own


def test_snow_thaws_to_the_end_depth_and_is_counted(native, tmp_path):
    s.receive(s.square("Ground"))
    thawing(tmp_path)
    s.bake()
    depths = [middle(s.height(native, tmp_path, "Ground", frame)) for frame in (1, 2, 3, 4)]
    assert depths == pytest.approx([0.085, 0.07, 0.055, 0.04], abs=1e-4)
    entry = s.manifest_of(tmp_path, "Ground")["frames"][-1]
    assert entry["melted"] == pytest.approx(0.6 * entry["fallen"], rel=1e-5)


def test_the_sun_thaws_less_in_the_shade(native, tmp_path):
    ground, roof = s.square("Ground", 2.0), s.square("Roof", 1.0, z=1.0)
    s.receive(ground)
    roof.snowbough.occlude = False
    own = thawing(tmp_path, sun_share=1.0)
    own.sun = sun()
    s.bake()
    open_ground = middle(s.height(native, tmp_path, "Ground", 4))
    assert open_ground == pytest.approx(0.04, abs=1e-3)
    roof.snowbough.occlude = True
    own.cache_directory = str(tmp_path / "shaded")
    s.bake()
    height = s.height(native, tmp_path / "shaded", "Ground", 4)
    # The roof keeps the snow off, too: beside it the ground is open.
    assert s.texel(height, 0.9, 0.9) == pytest.approx(0.04, abs=2e-3)


def test_a_thaw_that_was_stopped_goes_on_to_the_same_bytes(addon, tmp_path):
    s.receive(s.square("Ground"))
    own = thawing(tmp_path / "whole", (1, 6), wet=True, unevenness=0.3, checkpoint_interval=2)
    own.sun = sun(0.5)
    whole = s.bake_twice(addon, tmp_path, last=3)
    assert any(name.endswith("wet_0006.exr") for name in whole)


def test_rain_writes_a_map_of_water_without_snow(native, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path, (1, 4), end_depth=0.0, rain=0.012, wet=True, drying=1000.0)
    s.bake()
    assert middle(s.height(native, tmp_path, "Ground", 4)) == 0.0
    fps = bpy.context.scene.render.fps
    assert middle(wet(native, tmp_path, "Ground", 2)) == pytest.approx(2 * 0.012 / fps / 0.002, rel=1e-2)
    assert not list(s.folder_of(tmp_path, "Ground").glob("normal_*"))


def test_wet_ground_shows_in_the_material_and_goes_with_the_snow(tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    ground.data.materials.append(bpy.data.materials.new("Stone"))
    thawing(tmp_path, wet=True)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    nodes = ground.material_slots[0].material.node_tree.nodes
    group = next(node for node in nodes if node.type == "GROUP")
    assert group.inputs["Wet"].is_linked and not group.inputs["Height"].is_linked
    image = next(node.image for node in nodes if node.type == "TEX_IMAGE")
    assert "wet_" in image.filepath
    bpy.ops.snowbough.remove()
    assert ground.material_slots[0].material.name == "Stone"


def wet_image(material):
    """The image behind the slider Wet of a snow material, or None."""
    group = next(node for node in material.node_tree.nodes if node.type == "GROUP")
    links = group.inputs["Wet"].links
    return links[0].from_node.image if links else None


@pytest.mark.parametrize("follows", [True, False])
def test_the_snow_surface_gets_wet_where_water_is_followed(tmp_path, follows):
    s.receive(s.square("Ground"))
    thawing(tmp_path, wet=follows)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    image = wet_image(bpy.data.objects["Ground Snow"].data.materials[0])
    assert (image is not None) == follows
    if follows:
        assert "wet_0001.exr" in image.filepath


def test_dry_ground_keeps_its_material(tmp_path):
    ground = s.square("Ground")
    s.receive(ground)
    ground.data.materials.append(bpy.data.materials.new("Stone"))
    thawing(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    assert ground.material_slots[0].material.name == "Stone"


def test_the_live_preview_thaws(addon, tmp_path):
    s.receive(s.square("Ground"))
    own = thawing(tmp_path)
    own.sun = sun()
    live = addon("preview.live")
    scene = bpy.context.scene
    scene.frame_set(1)
    live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
    try:
        depths = []
        for frame in (1, 2, 3, 4, 2):
            scene.frame_set(frame)
            preview = addon("base.session").preview
            (key,) = preview.simulated.maps
            depths.append(middle(preview.heights(key)))
    finally:
        live.stop()
    assert depths == pytest.approx([0.085, 0.07, 0.055, 0.04, 0.07], abs=1e-3)


def test_the_preset_thaws_what_lies_there(addon, tmp_path):
    s.receive(s.square("Ground"))
    own = s.settings(tmp_path, end_depth=0.2)
    lamp = sun()
    bpy.ops.snowbough.set_preset(preset="THAW")
    assert (own.start_depth, own.end_depth, own.wet, own.sun) == (pytest.approx(0.2), 0.0, True, lamp)
    assert s.warnings(addon) == []


def test_presets_for_boots_and_tyres_need_an_object():
    boot = s.square("Boot")
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="Select the objects that press"):
        bpy.ops.snowbough.set_preset(preset="WALK")
    boot.select_set(True)
    bpy.ops.snowbough.set_preset(preset="DRIVE")
    assert boot.snowbough.press == "PRESS" and boot.snowbough.packed_density == pytest.approx(500.0)


@pytest.mark.parametrize(
    "values, text",
    [
        ({"wet": True}, "Wet Ground has no water"),
        ({"rain": 0.001}, "Rain wets nothing"),
        ({"adhesion": 0.5, "repose": 1.0}, "Adhesion needs a Repose of 90"),
        ({"rising": 0.5}, "Rising sticks to no underside"),
        ({"points": True}, "Flying Snow has no points"),
        ({"points": True, "repose": 1.0, "landing": False}, "Flying Snow has no points"),
        ({"granular": True}, "Granular needs a Repose below 90"),
        ({"sun": "BELOW", "start_depth": 0.2}, "below the horizon"),
        ({"sun": "ABOVE"}, "The Sun thaws nothing"),
    ],
)
def test_check_scene_names_what_cannot_work(addon, tmp_path, values, text):
    s.receive(s.square("Ground"))
    own = s.settings(tmp_path)
    for name, value in values.items():
        if name == "sun":
            value = sun(math.pi if value == "BELOW" else 0.0)
        setattr(own, name, value)
    bpy.context.view_layer.update()
    (found,) = s.warnings(addon)
    assert text in found
