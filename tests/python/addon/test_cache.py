# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake's folders, manifests and locks (addon/snowbough/cache.py), without Blender."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ADDON = Path(__file__).resolve().parents[2] / "addon" / "snowbough"
sys.path.insert(0, str(ADDON))
import cache  # noqa: E402
from scene_inputs import SceneInputs, fingerprint  # noqa: E402


def baked(folder, frames=(1, 2), complete=True, shot="s"):
    folder.mkdir(parents=True, exist_ok=True)
    for frame in frames:
        (folder / cache.frame_file("height", frame)).write_bytes(b"exr")
    cache.write_manifest(
        folder, {"complete": complete, "settings": {"shot": shot}, "hash": "h", "frames": []}
    )
    return folder


def test_names_become_safe_file_names():
    assert cache.safe_name("Cart") == "Cart"
    assert cache.safe_name("../Bänk: 1/2") == "_B_nk__1_2"
    assert cache.safe_name("...") == "_"


def test_objects_of_one_name_get_folders_of_their_own():
    local = cache.receiver_key("Rock", ("", "", ""))
    linked = cache.receiver_key("Rock", ("//rocks.blend", "", ""))
    instance = cache.receiver_key("Rock", ("", "Empty", "3"))
    assert len({local, linked, instance}) == 3
    assert local == cache.receiver_key("Rock", ("", "", ""))
    assert local.startswith("Rock-") and len(local) == len("Rock-") + 8


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    (tmp_path / "target").mkdir()  # a folder cannot be replaced by a file
    with pytest.raises(cache.CacheError, match="could not be written"):
        cache.write_bytes(tmp_path / "target", b"x")
    assert sorted(os.listdir(tmp_path)) == ["target"]


def test_equal_manifests_are_equal_bytes():
    assert cache.to_json({"b": 1, "a": [1.5, "ä"]}) == cache.to_json({"a": [1.5, "ä"], "b": 1})


def test_a_checkpoint_counts_only_with_its_state(tmp_path):
    cache.write_sidecar(tmp_path, 10, {"x": 1})
    assert cache.checkpoints(tmp_path) == []
    (tmp_path / "state_0010").write_bytes(b"s")
    (tmp_path / "state_0020").write_bytes(b"s")
    assert cache.checkpoints(tmp_path) == [10]
    cache.remove_stray_files(tmp_path)
    assert sorted(os.listdir(tmp_path)) == ["state_0010", "state_0010.json"]
    assert cache.read_sidecar(tmp_path, 10) == {"x": 1}


def test_checkpoints_between_the_regular_ones_go_once_passed(tmp_path):
    for frame in (4, 5, 10, 12):
        cache.write_sidecar(tmp_path, frame, {})
        (tmp_path / cache.state_file(frame)).write_bytes(b"s")
    cache.remove_irregular_checkpoints(tmp_path, frame_start=1, interval=5, before=12)
    assert cache.checkpoints(tmp_path) == [5, 10, 12]


def test_the_first_bake_is_version_1(tmp_path):
    assert cache.choose_version(tmp_path / "none", ["a"], "s") == 1


def test_a_finished_receiver_is_never_overwritten(tmp_path):
    baked(tmp_path / "v001" / "a")
    assert cache.choose_version(tmp_path, ["a"], "s") == 2


def test_an_unfinished_bake_is_done_again_in_place(tmp_path):
    baked(tmp_path / "v001" / "a", complete=False)
    assert cache.choose_version(tmp_path, ["a"], "s") == 1


def test_machines_that_share_a_shot_fill_one_version(tmp_path):
    baked(tmp_path / "v001" / "a", shot="s")
    assert cache.choose_version(tmp_path, ["b"], "s") == 1
    assert cache.choose_version(tmp_path, ["b"], "other shot") == 2


def test_resume_finds_the_unfinished_version(tmp_path):
    baked(tmp_path / "v001" / "a")
    baked(tmp_path / "v002" / "a", complete=False)
    baked(tmp_path / "v002" / "b")
    assert cache.resumable_version(tmp_path, ["a", "b"]) == (2, ["b"])
    assert cache.resumable_version(tmp_path, ["c"]) == (None, [])


def test_reading_takes_the_newest_finished_bake_of_each_receiver(tmp_path):
    first = baked(tmp_path / "v001" / "a")
    baked(tmp_path / "v002" / "a", complete=False)
    assert cache.newest_finished(tmp_path, "a")[0] == first
    assert cache.newest_finished(tmp_path, "b") == (None, None)


def test_free_removes_exactly_what_the_bake_made(tmp_path):
    folder = baked(tmp_path / "v001" / "a")
    baked(tmp_path / "v001" / "b")
    (folder / "notes.txt").write_text("mine")
    cache.free(tmp_path)
    left = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert left == [folder / "notes.txt"]


def test_free_takes_only_the_receivers_named(tmp_path):
    baked(tmp_path / "v001" / "a")
    kept = baked(tmp_path / "v001" / "b")
    assert cache.free(tmp_path, ["a"]) == 3
    assert not (tmp_path / "v001" / "a").exists() and cache.baked_frames(kept) == [1, 2]


def test_a_folder_is_locked_against_a_second_bake(tmp_path):
    with cache.lock_folder(tmp_path / "a"):
        with pytest.raises(cache.CacheBusy, match=f"process {os.getpid()}"):
            with cache.lock_folder(tmp_path / "a"):
                pass
    with cache.lock_folder(tmp_path / "a"):
        pass
    assert not (tmp_path / "a" / "lock").exists()


def test_a_killed_bake_blocks_nobody(tmp_path):
    program = (
        f"import sys, os; sys.path.insert(0, {str(ADDON)!r}); import cache\n"
        f"lock = cache.lock_folder({str(tmp_path / 'a')!r}); lock.__enter__(); os.kill(os.getpid(), 9)"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == -9
    assert (tmp_path / "a" / "lock").exists()
    with cache.lock_folder(tmp_path / "a"):
        pass


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX permissions")
def test_an_unwritable_cache_says_what_to_do(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(cache.CacheError, match="Choose another"):
        cache.make_folder(blocked / "cache")
    if os.getuid() != 0:
        tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
        with pytest.raises(cache.CacheError, match="Choose another"):
            cache.make_folder(tmp_path / "cache")


def test_changed_settings_are_named():
    before = {"end_depth": 0.1, "rates": [1] * 50, "receiver": {"resolution": 1024}, "old": 1}
    after = {"end_depth": 0.2, "rates": [2] * 50, "receiver": {"resolution": 2048}, "new": 1}
    assert cache.describe_changes(before, after) == [
        "end_depth: 0.1 -> 0.2",
        "new: added",
        "old: removed",
        "rates: changed",
        "receiver: resolution: 1024 -> 2048",
    ]


def recorded(*poses):
    inputs = SceneInputs()
    for number, prints in enumerate(poses, 1):
        inputs.add(str(number), prints)
    return inputs


def test_a_changed_object_is_named_with_the_frame():
    still = {"Cart": ["t", "s", "u"], "Ground": ["t", "s", "u"]}
    before = recorded(still, still, still)
    assert before.first_difference(recorded(still, still, still)) is None
    moved = recorded(still, {**still, "Cart": ["x", "s", "u"]}, still)
    assert before.first_difference(moved) == "Cart: transform changed at frame 2"
    assert moved.first_difference(before) == "Cart: transform changed at frame 2"
    bent = recorded(still, still, {**still, "Ground": ["t", "x", "u"]})
    assert before.first_difference(bent) == "Ground: shape changed at frame 3"
    gone = recorded({"Ground": ["t", "s", "u"]})
    assert before.first_difference(gone) == "Cart: removed at frame 1"


def test_only_changes_are_stored_and_survive_json():
    still = {"Cart": ["t", "s", "u"]}
    inputs = recorded(still, still)
    assert inputs.poses[1] == ["2", {}]
    again = SceneInputs(inputs.poses[:1])
    again.add("2", still)
    assert again.poses == inputs.poses


def test_fingerprints_tell_shapes_and_values_apart():
    a = np.arange(6, dtype=np.float32)
    assert fingerprint(a) == fingerprint(a.copy())
    assert fingerprint(a) != fingerprint(a.reshape(2, 3))
    assert fingerprint(a) != fingerprint(a + 1)
    assert fingerprint(np.empty((0, 3))) == fingerprint(np.empty((0, 3)))
