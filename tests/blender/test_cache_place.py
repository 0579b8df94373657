# SPDX-License-Identifier: GPL-3.0-or-later
"""The .blend that a bake belongs to: two files, copies and Save As have separate bakes, and Free Bake removes only
the file's own."""

import shutil
from pathlib import Path

import bpy
import pytest
import snow_scene as s


@pytest.fixture
def shot(tmp_path):
    """A saved scene with one receiver whose cache lies beside it."""
    s.receive(s.square("Ground"))
    s.settings("//snowbough_cache", frames=(1, 2))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    return tmp_path / "shot.blend"


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))


def heights(root):
    return sorted(Path(root).rglob("height_*.exr"))


def shown():
    return Path(bpy.path.abspath(bpy.context.scene.snowbough.receivers[0].folder))


def test_a_copy_of_the_file_beside_it_gets_its_own_folder(shot, tmp_path):
    shutil.copy(shot, tmp_path / "copy.blend")
    s.bake()
    own = shown()
    opened(tmp_path / "copy.blend")
    s.bake()
    assert shown().parent.name == own.parent.name == "v001" and shown() != own
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == heights(own) and len(heights(own)) == 2


def test_free_bake_in_a_copy_leaves_the_bake_of_the_original(shot, tmp_path):
    s.bake()
    bpy.ops.wm.save_mainfile()
    own = shown()
    for place in (tmp_path / "copy.blend", tmp_path / "elsewhere" / "shot.blend"):
        place.parent.mkdir(exist_ok=True)
        shutil.copy(shot, place)
        opened(place)
        bpy.ops.snowbough.free_bake()
        assert len(heights(own)) == 2
        assert bpy.context.scene.snowbough.receivers[0].folder  # the copy's bake still exists


def test_save_as_gets_its_own_folder_and_shows_the_old_bake_until_then(shot, tmp_path):
    s.bake()
    own = shown()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot_v2.blend"))
    assert shown() == own
    s.bake()
    second = shown()
    assert second != own and second.parent.parent != own.parent.parent
    bpy.ops.wm.save_mainfile()
    shot.unlink()  # the second file keeps its bake
    opened(tmp_path / "shot_v2.blend")
    s.bake(resume=True)
    assert shown() == second
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == heights(own)


def test_two_files_of_one_folder_keep_their_snow_apart(shot, tmp_path):
    s.bake()
    first = shown()
    bpy.ops.wm.read_homefile(use_empty=True)
    s.receive(s.square("Ground", 4.0))
    s.settings("//snowbough_cache", frames=(1, 2))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    s.bake()
    assert shown() != first
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == heights(first)


def test_a_renamed_file_goes_on_with_its_bake(shot, addon, tmp_path):
    s.bake()
    own = shown()
    bpy.ops.wm.save_mainfile()
    shot.rename(tmp_path / "final.blend")
    opened(tmp_path / "final.blend")
    assert addon("bake.cache_place").existing_cache(bpy.context.scene) == own.parent.parent
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == [] and not own.parent.parent.exists()


def test_a_renamed_scene_goes_on_with_its_bake(shot, addon, tmp_path):
    addon("bake.outcome").conclude(bpy.context.scene, s.bake_part(addon, last=1))
    own = shown()
    bpy.ops.wm.save_mainfile()
    opened(shot)
    bpy.context.scene.name = "Renamed"
    assert addon("bake.cache_place").existing_cache(bpy.context.scene) == own.parent.parent
    s.bake(resume=True)
    assert shown() == own and len(heights(tmp_path)) == 2
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == [] and bpy.context.scene.snowbough.cache_scene == ""


def test_a_copy_of_a_scene_and_a_new_scene_of_its_old_name_get_their_own_folders(shot, addon, tmp_path):
    s.bake()
    first = bpy.context.scene
    bpy.ops.scene.new(type="FULL_COPY")
    copy = bpy.context.scene
    place = addon("bake.cache_place")
    own, other = place.existing_cache(first), place.existing_cache(copy)
    assert own == shown().parent.parent != other
    first.name = "Renamed"
    copy.name = "Scene"
    copy.snowbough.cache_scene = ""
    assert place.existing_cache(first) == own
    assert place.existing_cache(copy) not in (own, None)


def test_what_was_baked_before_the_file_was_saved_is_resumed_and_freed(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache", frames=(1, 4))
    addon("bake.outcome").conclude(bpy.context.scene, s.bake_part(addon, last=2))
    own = shown()
    assert own.parent.parent.name == "Scene"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    s.bake(resume=True)
    assert shown() == own and len(heights(own)) == 4
    bpy.ops.snowbough.free_bake()
    assert heights(tmp_path) == []


def test_an_undo_to_before_the_file_was_saved_changes_nothing(addon, shot):
    place = addon("bake.cache_place")
    own = place.existing_cache(bpy.context.scene)
    bpy.context.scene.snowbough.cache_identity = ""  # the state after an undo
    assert place.existing_cache(bpy.context.scene) == own


def test_the_confirmation_says_folder_count_and_size(addon, shot, tmp_path):
    s.bake()
    (text,) = addon("ui.bake_operators")._removal_texts(bpy.context.scene)
    (root,) = (tmp_path / "snowbough_cache").iterdir()
    assert text.startswith("Remove 7 files (") and text.endswith(f") from {root}")
    bpy.ops.snowbough.free_bake()
    (text,) = addon("ui.bake_operators")._removal_texts(bpy.context.scene)
    assert "nothing is removed" in text


def test_machines_that_bake_copies_of_the_file_into_a_named_cache_share_it(addon, shot, tmp_path):
    place = addon("bake.cache_place")
    cache, own = place.bake_place(bpy.context.scene, False, str(tmp_path / "farm"))
    shutil.copy(shot, tmp_path / "shot.job.blend")
    opened(tmp_path / "shot.job.blend")
    assert place.bake_place(bpy.context.scene, False, str(tmp_path / "farm")) == (cache, own) != ("", "")
    assert place.bake_place(bpy.context.scene, False, cache) == (cache, own)
