# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowbough Realtime when rendering fails: no black frame with the exit code 0."""

import json
import os
import shutil
import subprocess

import bpy
import numpy as np
import pytest
import snow_scene
from realtime_shot import camera_at, rendered, set_up

scene = pytest.fixture(set_up)


@pytest.fixture
def shot(scene, tmp_path):
    """The path of a saved shot whose square carries baked snow."""
    square = snow_scene.square("Square")
    snow_scene.receive(square)
    snow_scene.settings(tmp_path / "cache", frames=(1, 2))
    snow_scene.bake()
    camera_at((0, 0, 5))
    scene.frame_set(2)
    path = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def folder_of(scene):
    return bpy.path.abspath(scene.snowbough.receivers[0].folder)


def rendered_by_blender(shot, *arguments):
    """Runs blender -b on the shot with further arguments; returns the process and the picture's path."""
    if not bpy.app.binary_path:
        pytest.skip("needs a Blender program")
    picture = shot.parent / "out_0002.exr"
    addon = os.environ["SNOWBOUGH_TEST_ADDON"]
    command = [bpy.app.binary_path, "-b", "--factory-startup", "--addons", addon, str(shot)]
    command += ["-o", str(shot.parent / "out_"), "-F", "OPEN_EXR", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120), picture


def damage_map(folder):
    path = f"{folder}/height_0002.exr"
    with open(path, "r+b") as stream:
        stream.truncate(os.path.getsize(path) // 2)
    return "height_0002.exr"


def damage_manifest(folder):
    with open(f"{folder}/object.json", "w") as stream:
        stream.write('{"format": ')
    return "object.json"


def empty_manifest(folder):
    with open(f"{folder}/object.json", encoding="utf-8") as stream:
        kept = json.load(stream)["format"]
    with open(f"{folder}/object.json", "w", encoding="utf-8") as stream:
        json.dump({"format": kept}, stream)
    return ""


DAMAGES = [damage_map, damage_manifest, empty_manifest]


@pytest.mark.parametrize(
    "how, damages",
    [(("-f", "2"), DAMAGES), (("-s", "2", "-e", "2", "-a"), [damage_map])],
    ids=["frame", "animation"],
)
def test_a_damaged_cache_ends_a_render_in_the_background(shot, scene, tmp_path, how, damages):
    done, picture = rendered_by_blender(shot, *how)
    assert done.returncode == 0
    assert picture.exists()
    picture.unlink()
    folder = folder_of(scene)
    shutil.copytree(folder, tmp_path / "whole")
    for damage in damages:
        named = damage(folder)
        done, picture = rendered_by_blender(shot, *how)
        assert done.returncode != 0
        assert "Snowbough Realtime: " in done.stdout + done.stderr
        assert named in done.stdout + done.stderr
        assert not picture.exists()
        shutil.copytree(tmp_path / "whole", folder, dirs_exist_ok=True)


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_cache_ends_a_render_of_a_script(shot, scene, damage):
    damage(folder_of(scene))
    with pytest.raises(RuntimeError, match="Snowbough Realtime: "):
        rendered(scene)


def test_a_render_without_a_camera_fails(scene):
    with pytest.raises(RuntimeError, match="[Nn]o camera"):
        rendered(scene)


def assert_alike(one, other):
    """Equal except for single samples on edges."""
    differs = np.abs(one - other).max(axis=2) > 0.005
    assert differs.mean() < 0.002
    assert np.abs(one - other).max() < 0.3


def test_large_pictures_are_drawn_in_tiles(scene, addon):
    snow_scene.square("Square", 2.0, x=0.3)
    camera_at((2, -4, 5)).data.shift_x = 0.1
    render = scene.render
    render.resolution_x, render.resolution_y = addon("realtime.final").LARGEST_TILE + 904, 60
    tiled = rendered(scene)
    assert tiled.shape == (60, 5000, 4)
    assert tiled[..., 0].max() > tiled[..., 0].min() + 0.3
    # A part over the border of two tiles, in one tile.
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.95, 0.5, 1.0
    assert_alike(rendered(scene), tiled[30:60, 1250:4750])


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_a_picture_may_be_wider_than_the_largest_texture(scene, kind):
    snow_scene.square("Square", 2.0)
    data = camera_at((0, 0, 5)).data
    data.type, data.ortho_scale = kind, 4.0
    render = scene.render
    render.resolution_x, render.resolution_y = 20_000, 8
    scene.snowbough_realtime.samples = 1
    line = rendered(scene)[4, :, 0]
    assert line.shape == (20_000,)
    # Half of 4 units; by the lens of 50 mm on a sensor of 36 mm the view is 3.6 wide at 5.
    share = 0.5 if kind == "ORTHO" else 2.0 / 3.6
    on_square = np.flatnonzero(line > 0.3)
    assert on_square[0] == pytest.approx(10_000 - 10_000 * share, abs=2)
    assert on_square[-1] == pytest.approx(10_000 + 10_000 * share, abs=2)
    assert len(on_square) == on_square[-1] - on_square[0] + 1
