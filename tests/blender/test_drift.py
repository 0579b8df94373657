# SPDX-License-Identifier: GPL-3.0-or-later
"""Drifts: the wind carries lying snow along Bearing into the shelter of objects."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s


@pytest.fixture
def native(addon):
    return addon("base.native").load()


def scene(root, frames=(1, 4), **values):
    """A ground of 6 m under 0.1 m of snow, a wall of 0.6 m across it, a wind to +X."""
    s.receive(s.square("Ground", 6.0))
    edge = [(0.03, -4.0), (0.03, 4.0)]
    wall = s.mesh_object("Wall", [(*at, z) for z in (0.0, 0.6) for at in edge], [(0, 1, 3, 2)])
    own = s.settings(root, frames, start_depth=0.1, end_depth=0.1, bearing=math.radians(90.0), drift=0.5)
    for name, value in values.items():
        setattr(own, name, value)
    return wall, own


def columns(map_):
    """Mean depth by place along X."""
    rows = map_.shape[0]
    return np.median(map_[rows // 4 : -rows // 4], axis=0)


def test_a_drift_grows_behind_a_wall_and_is_counted(native, tmp_path):
    scene(tmp_path)
    s.bake()
    depth = columns(s.height(native, tmp_path, "Ground", 4))
    half = len(depth) // 2
    assert depth[half + 4 : -4].max() > 0.12 > 0.1001 > depth[4 : half // 2].max()
    entry = s.manifest_of(tmp_path, "Ground")["frames"][-1]
    gone = entry["volume"] + entry["slid"] - entry["landed"] + entry["drifted"]
    assert entry["drifted"] < 0.0
    assert gone == pytest.approx(entry["fallen"] + entry["stretched"], rel=1e-6)


def test_the_pre_roll_is_calm(native, tmp_path):
    scene(tmp_path, (1, 1), drift=0.0)
    s.bake()
    still = s.height(native, tmp_path, "Ground", 1)
    bpy.context.scene.snowbough.drift = 1e-9
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "windy")
    s.bake()
    assert np.abs(s.height(native, tmp_path / "windy", "Ground", 1) - still).max() < 1e-6


def test_no_drift_forms_behind_what_the_wind_passes(native, tmp_path):
    wall, _ = scene(tmp_path)
    wall.snowbough.blocks_wind = False
    s.bake()
    depth = columns(s.height(native, tmp_path, "Ground", 4))
    assert depth[4:-4].max() < 0.101
    assert "drifted" not in s.manifest_of(tmp_path, "Ground")["frames"][-1]


def test_a_drift_that_was_stopped_goes_on_to_the_same_bytes(addon, tmp_path):
    scene(tmp_path / "whole", (1, 6), checkpoint_interval=2)
    s.bake_twice(addon, tmp_path, last=3)


def test_the_live_preview_shows_drifts(addon):
    scene("//", (1, 4))
    live, shown = addon("preview.live"), bpy.context.scene
    shown.frame_set(1)
    live.start(shown, bpy.context.evaluated_depsgraph_get(), draws=False)
    try:
        preview = addon("base.session").preview

        def depths():
            (key,) = preview.simulated.maps
            return columns(preview.heights(key))

        first = depths()
        for frame in (2, 3, 4):
            shown.frame_set(frame)
        last = depths()
        half = len(last) // 2
        assert last[half + 4 : -4].max() > first[half + 4 : -4].max() + 0.01 > 0.115
        assert last[4 : half // 2].max() < 0.1001
        shown.frame_set(1)
        assert (depths() == first).all()
    finally:
        live.stop()


def test_check_scene_says_what_the_wind_passes(addon, tmp_path):
    wall, own = scene(tmp_path)
    assert "The wind passes" not in s.issues(addon, "INFO")
    wall.snowbough.blocks_wind = False
    assert "The wind passes 'Wall': Blocks Wind is off" in s.issues(addon, "INFO")
    s.square("Leaf", 0.1, z=0.5).snowbough.blocks_wind = False
    assert "and 1 other object: Blocks Wind is off" in s.issues(addon, "INFO")
    own.drift = 0.0
    assert "The wind passes" not in s.issues(addon, "INFO")


def test_blocks_wind_says_nothing_without_drifts(addon):
    press_of = addon("settings.pressing").press_of
    own = s.square("Tree").snowbough
    own.blocks_wind = False
    assert press_of(own) is None
    assert press_of(own, drifts=True) == {"kind": "NONE", "blocks_wind": False}


def test_check_scene_names_a_repose_that_keeps_drifts_steep(addon, tmp_path):
    _, own = scene(tmp_path, repose=math.radians(90.0))
    assert "Drifts keep steep sides" in s.issues(addon, "WARNING")
    own.drift = 0.0
    assert "Drifts" not in s.issues(addon, "WARNING")
