# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that press, plough and clear snow: from the scene to the baked map, the preview and resuming."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import points_at

CUBE = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def block(name="Tool", size=(0.4, 0.4, 0.4), press="PRESS", occlude=False):
    """A cuboid around the origin that presses snow and lets it through."""
    obj = s.mesh_object(name, [tuple(0.5 * c * e for c, e in zip(corner, size)) for corner in CUBE], FACES)
    obj.snowbough.press = press
    obj.snowbough.occlude = occlude
    return obj


def shot(folder, frames=(1, 8), **values):
    """All the snow lies from the start: 0.1 m on a ground of 2 m."""
    ground = s.square("Ground")
    s.receive(ground, resolution=128)
    s.settings(
        folder, frames, **{"start_depth": 0.1, "end_depth": 0.1, "repose": math.radians(65.0), **values}
    )
    return ground


@pytest.mark.parametrize("kind, left", [("PRESS", 0.06), ("PLOUGH", 0.06), ("CLEAR", 0.06), ("NONE", 0.1)])
def test_an_object_does_its_effect_on_the_snow_it_touches(native, tmp_path, kind, left):
    shot(tmp_path)
    tool = block(press=kind)
    s.key(tool, "location", (1, (0.0, 0.0, 0.4)), (8, (0.0, 0.0, 0.26)))
    s.bake()
    heights = s.height(native, tmp_path, "Ground", 8)
    assert s.texel(heights, 0.5, 0.5) == pytest.approx(left, abs=2e-3)
    assert s.texel(heights, 0.2, 0.5) == pytest.approx(0.1, abs=2e-3)
    # Away from the rims, over which snow falls.
    volume = float(heights[20:-20, 20:-20].sum()) * 4.0 / 128**2
    whole = 0.1 * 88 * 88 * 4.0 / 128**2
    if kind == "PLOUGH":
        assert volume == pytest.approx(whole, rel=1e-4)
    elif kind == "CLEAR":
        assert volume == pytest.approx(whole - 0.04 * 0.4 * 0.4, rel=2e-3)


def test_settings_of_the_object_reach_the_snow(native, tmp_path):
    shot(tmp_path)
    tool = block()
    tool.snowbough.packed_density = 200.0
    tool.snowbough.pushed_aside = 0.0
    s.key(tool, "location", (1, (0.0, 0.0, 0.4)), (8, (0.0, 0.0, 0.18)))
    s.bake()
    # Packed to half its depth, the snow carries.
    assert s.texel(s.height(native, tmp_path, "Ground", 8), 0.5, 0.5) == pytest.approx(0.05, abs=1e-3)


def test_pressing_resumes_byte_for_byte(addon, tmp_path):
    ground = shot(tmp_path / "whole", checkpoint_interval=4, end_depth=0.12)
    tool = block(size=(0.3, 0.3, 0.3))
    s.key(tool, "location", (1, (-0.6, 0.0, 0.2)), (8, (0.6, 0.0, 0.2)))
    s.bake()
    entry = bpy.context.scene.snowbough.receivers[0]
    entry.folder = entry.baked_as = ""
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    s.bake_part(addon, last=4)
    s.bake_part(addon, first=5)
    whole = s.folder_of(tmp_path / "whole", ground.name)
    parts = s.folder_of(tmp_path / "parts", ground.name)
    for frame in range(1, 9):
        name = f"height_{frame:04d}.exr"
        assert (whole / name).read_bytes() == (parts / name).read_bytes(), name


def test_another_effect_makes_a_bake_outdated(addon, tmp_path):
    shot(tmp_path, checkpoint_interval=2)
    tool = block()
    s.bake_part(addon, last=4)
    tool.snowbough.rim_width = 0.1
    with pytest.raises(RuntimeError, match="Tool: effect on snow changed at frame 1"):
        s.bake(resume=True)


def test_the_preview_shows_prints(addon):
    shot("//", (1, 8))
    tool = block()
    s.key(tool, "location", (1, (0.0, 0.0, 0.4)), (8, (0.0, 0.0, 0.26)))
    scene, live = bpy.context.scene, addon("preview.live")
    scene.frame_set(1)
    live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
    try:
        preview = addon("base.session").preview
        (key,) = preview.simulated.maps

        def middle():
            heights = preview.heights(key)
            at = len(heights) // 2
            return float(np.mean(heights[at - 3 : at + 3, at - 3 : at + 3]))

        assert middle() == pytest.approx(0.1, abs=1e-3)
        for frame in range(2, 9):
            scene.frame_set(frame)
        assert middle() == pytest.approx(0.06, abs=2e-3)
        scene.frame_set(1)
        assert middle() == pytest.approx(0.1, abs=1e-3)
    finally:
        live.stop()


@pytest.mark.parametrize("frames", ["KEYS", "CACHE"])
def test_apply_snow_of_a_shot_keeps_its_prints(tmp_path, frames):
    """Plain geometry goes down below a sole when the surface does, also once the bake is gone."""
    ground = shot(tmp_path / "cache")
    tool = block()
    s.key(tool, "location", (1, (0.0, 0.0, 0.4)), (8, (0.0, 0.0, 0.26)))
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    surface = bpy.data.objects[f"{ground.name} Snow"]
    wanted = {frame: points_at(surface, frame) for frame in (1, 6, 8)}

    def depth(points):
        return float(points[(np.abs(points[:, :2]) < 0.15).all(axis=1), 2].mean())

    assert depth(wanted[1]) == pytest.approx(0.1, abs=0.01)
    assert depth(wanted[8]) == pytest.approx(0.06, abs=0.01)
    bpy.ops.snowbough.apply_snow(frames=frames, directory=str(tmp_path / "applied"))
    bpy.ops.snowbough.free_bake()
    plain = bpy.data.objects[f"{ground.name} Snow Applied"]
    for frame, points in wanted.items():
        assert np.abs(points_at(plain, frame) - points).max() < 1e-5
