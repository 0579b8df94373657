# SPDX-License-Identifier: GPL-3.0-or-later
"""Continue Bake adds frames to a finished bake and keeps the bytes of the others."""

from pathlib import Path

import bpy
import pytest
import snow_scene as s
from conftest import addon_module


def maps_of(root, version, last=8):
    """{receiver's folder / name: bytes} of the maps up to a frame in a version."""
    return {
        f"{path.parent.name}/{path.name}": path.read_bytes()
        for path in Path(root).glob(f"*/v{version:03d}/*/*_[0-9][0-9][0-9][0-9].exr")
        if int(path.stem[-4:]) <= last
    }


@pytest.fixture
def finished(tmp_path, addon):
    """finished(checkpoint_interval): bakes 8 frames of the moving scene, adds 4 to the shot, and returns the bytes of
    its three receivers' maps."""

    def bake(interval=3, folder="cache"):
        s.moving_scene(
            tmp_path / folder, (1, 8), checkpoint_interval=interval, flutter=0.1, directions=48, blur_radius=2.0,
            end_depth=0.2, surface_detail="DRAFT", texel_size=0.05,
        )  # fmt: skip
        bpy.ops.snowbough.setup_displacement(mode="SHELL")
        s.bake()
        bpy.context.scene.frame_end = 12
        bpy.context.scene.snowbough.end_depth = 0.25
        return maps_of(tmp_path / folder, 1)

    return bake


@pytest.mark.parametrize("interval", [3, 10])
def test_a_continued_bake_keeps_the_bytes_of_finished_frames(tmp_path, native, finished, interval):
    before = finished(interval)
    whole = s.files_of(tmp_path / "cache")
    assert len(before) == 24
    s.bake(extend=True)
    assert maps_of(tmp_path / "cache", 2) == before
    after = s.files_of(tmp_path / "cache")
    assert {name: after[name] for name in whole} == whole  # the finished version stays
    manifest = s.manifest_of(tmp_path / "cache", "Ground", 2)
    assert manifest["complete"] and [entry["frame"] for entry in manifest["frames"]] == list(range(1, 13))
    assert manifest["frames"][11]["depth"] == 0.25
    edge = [s.height(native, tmp_path / "cache", "Ground", frame, 2)[8, 8] for frame in (8, 12)]
    assert edge == pytest.approx([0.2, 0.25], rel=0.05)
    surface = bpy.data.objects["Ground Snow"]
    assert "v002" in surface.modifiers[0].filepath
    told = addon_module("base.session").last_outcome[1]
    assert told.endswith("Frames 1-8 are as they were, frames 9-12 are new")


@pytest.mark.parametrize("stop", [2, 5, 10])
def test_a_continued_bake_that_stops_resumes_to_the_same_files(tmp_path, addon, finished, stop):
    before = finished()
    assert s.bake_part(addon, extend=True).error is None
    whole = s.files_of(tmp_path / "cache")
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    bpy.context.scene.frame_end, bpy.context.scene.snowbough.end_depth = 8, 0.2
    s.bake()
    bpy.context.scene.frame_end, bpy.context.scene.snowbough.end_depth = 12, 0.25
    halt = addon("bake.engine").stop
    running = s.bake_part(
        addon, extend=True, on_frame=lambda result: halt() if result.frame >= stop else None
    )
    assert running.cancelled
    assert s.bake_part(addon, resume=True).error is None
    assert maps_of(tmp_path / "parts", 2) == before
    assert s.files_of(tmp_path / "parts") == whole


def test_a_bake_can_be_continued_again_and_by_parts_of_its_receivers(tmp_path, addon, finished):
    before = finished()
    for names in (["Cart"], ["Ground", "Flag"]):
        assert s.bake_part(addon, objects=names, extend=True).error is None
    assert maps_of(tmp_path / "cache", 2) == before
    repeated = s.bake_part(addon, extend=True)
    assert repeated.error is None and not repeated.job.results
    bpy.context.scene.frame_end = 14
    before = maps_of(tmp_path / "cache", 2, last=12)
    assert s.bake_part(addon, extend=True).error is None
    assert len(before) == 36 and maps_of(tmp_path / "cache", 3, last=12) == before
    assert s.bake_part(addon, resume=True).error is None  # compares everything


def test_resuming_a_longer_shot_names_continue_bake(addon, finished):
    finished()
    refused = str(s.bake_part(addon, resume=True).error)
    assert "frame end: 8, now 12" in refused
    assert "Continue Bake adds the new frames and keeps the others" in refused


def test_a_bake_whose_frames_would_change_is_not_continued(tmp_path, addon, finished):
    finished(interval=10)
    whole = s.files_of(tmp_path / "cache")
    own = bpy.context.scene.snowbough
    own.slide_half_life = 1.0
    assert "was baked with other settings (slide half life" in str(s.bake_part(addon, extend=True).error)
    own.property_unset("slide_half_life")
    cart = bpy.data.objects["Cart"]
    s.key(cart, "location", (6, (0.0, 1.0, 0.0)))
    refused = s.bake_part(addon, extend=True).error
    assert (
        "The scene is not the one that Cart in v001 was baked from (Cart: transform changed at frame 2)"
        in str(refused)
    )
    assert s.files_of(tmp_path / "cache") == whole and not list(tmp_path.glob("cache/*/v002"))


def test_the_panel_offers_to_continue_a_longer_shot_alone(addon, finished):
    can_continue = addon("bake.changes_since_bake").can_continue
    finished()
    scene = bpy.context.scene
    assert can_continue(scene)
    scene.frame_end = 8
    assert not can_continue(scene)
    scene.frame_end, scene.snowbough.end_depth = 12, 0.1
    assert not can_continue(scene)
    repose = scene.snowbough.repose
    scene.snowbough.end_depth, scene.snowbough.repose = 0.25, 0.5
    assert not can_continue(scene)
    scene.snowbough.repose = repose
    s.bake(extend=True)
    assert addon("bake.changes_since_bake").settings_changes(scene) == [] and not can_continue(scene)
