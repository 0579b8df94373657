# SPDX-License-Identifier: GPL-3.0-or-later
"""How a resumed bake treats each kind of missing or damaged file, other bakes and other scenes."""

import json
import os
import shutil

import pytest
import shot
from snowbough.bake import resuming
from snowbough.cache import files, folder, integrity, manifest, versions
from snowbough.cache.errors import CacheError, InputsChanged, LockLost, NoCheckpoint


@pytest.fixture(scope="module")
def caches(memory_folder):
    """Caches of a finished bake, and of one that stopped after frame 5."""
    shot.bake(memory_folder / "finished" / "cache")
    shot.bake(memory_folder / "stopped" / "cache", last=5)
    return memory_folder


@pytest.fixture
def finished(caches, tmp_path):
    return shutil.copytree(caches / "finished" / "cache", tmp_path / "a" / "cache")


@pytest.fixture
def stopped(caches, tmp_path):
    return shutil.copytree(caches / "stopped" / "cache", tmp_path / "b" / "cache")


@pytest.fixture(scope="module")
def whole(caches):
    return shot.files_of(caches / "finished" / "cache")


def found(cache, name):
    (path,) = cache.rglob(name)
    return path


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


@pytest.mark.parametrize("harm", [flip, os.unlink])
@pytest.mark.parametrize(
    "name",
    [
        "height_0005.exr",
        "normal_0008.exr",
        "ever_covered.exr",
        "receiver.ply",
        "positions.pc2",
        "surface.pc2",
    ],
)
def test_a_finished_bake_with_a_lost_file_is_repaired_from_the_checkpoint_before_it(
    finished, whole, harm, name
):
    harm(found(finished, f"Flag-*/{name}"))
    job = shot.bake(finished, resume=True)
    begin = 4 if name == "height_0005.exr" else 7
    assert [result.frame for result in job.results] == list(range(begin, shot.FRAMES + 1))
    assert len(job.repaired) == 1 and name in job.repaired[0] and f"frames from {begin} on" in job.repaired[0]
    assert [receiver.label for receiver in job.receivers] == ["Flag"]
    assert shot.files_of(finished) == whole


def test_a_finished_bake_without_an_earlier_checkpoint_is_refused_and_stays(finished):
    flip(found(finished, "Cart-*/height_0002.exr"))
    before = shot.files_of(finished)
    with pytest.raises(
        CacheError, match="height_0002.exr is missing or damaged, and there is no checkpoint before"
    ):
        shot.bake(finished, resume=True)
    assert shot.files_of(finished) == before


def test_a_finished_bake_is_only_repaired_from_the_same_scene(finished):
    flip(found(finished, "Cart-*/height_0005.exr"))
    before = shot.files_of(finished)

    def moved(frame, subframe):
        return shot.pose(frame, subframe + 0.125)

    with pytest.raises(InputsChanged, match="changed at frame 1"):
        shot.bake(finished, moved, resume=True)
    assert shot.files_of(finished) == before


@pytest.mark.parametrize("damaged", ["height_0004.exr", "height_0005.exr"])
def test_a_stopped_bake_goes_on_from_the_checkpoint_before_its_damaged_frame(stopped, whole, damaged):
    flip(found(stopped, f"Ground-*/{damaged}"))
    job = shot.bake(stopped, resume=True)
    assert job.results[0].frame == 4
    assert shot.files_of(stopped) == whole


def test_a_part_is_not_baked_behind_a_damaged_frame(stopped):
    flip(found(stopped, "Ground-*/height_0004.exr"))
    with pytest.raises(CacheError, match="height_0004.exr is missing or damaged: resume the bake"):
        shot.bake(stopped, first=6)


def test_a_part_is_baked_from_its_checkpoint(stopped, whole):
    with pytest.raises(NoCheckpoint, match=r"needs the checkpoint of frame 4 .* \(there are: \[3, 5\]"):
        shot.bake(stopped, first=5)
    shot.bake(stopped, first=6)
    assert shot.files_of(stopped) == whole


@pytest.mark.parametrize("cache", ["finished", "stopped"])
def test_a_damaged_manifest_is_restored_from_a_checkpoint(request, cache, whole):
    cache = request.getfixturevalue(cache)
    flip(found(cache, "Cart-*/object.json"))
    job = shot.bake(cache, resume=True)
    assert len(job.repaired) == 1 and "object.json was damaged and is restored" in job.repaired[0]
    assert job.results[0].frame == (6 if "/b/" in str(cache) else 7)  # after the newest checkpoint
    assert shot.files_of(cache) == whole


@pytest.mark.parametrize("frame", [3, 5])
def test_a_damaged_manifest_is_restored_from_any_checkpoint(stopped, whole, frame):
    flip(found(stopped, "Cart-*/object.json"))
    flip(found(stopped, f"Cart-*/state_{frame:04d}.json"))
    assert folder.restore_manifest(found(stopped, "Cart-*/object.json").parent)
    description = manifest.read_head(found(stopped, "Cart-*/object.json").parent)
    assert description["label"] == "Cart" and not description["complete"]


def test_a_restored_manifest_knows_the_frames_of_the_newest_checkpoint(stopped, whole):
    flip(found(stopped, "Cart-*/object.json"))
    flip(found(stopped, "Cart-*/height_0005.exr"))
    assert shot.bake(stopped, resume=True).results[0].frame == 4
    assert shot.files_of(stopped) == whole


def test_a_damaged_manifest_without_a_checkpoint_says_what_to_do(stopped, whole):
    path = found(stopped, "Cart-*/object.json")
    flip(path)
    for state in path.parent.glob("state_*.json"):
        flip(state)
    before = shot.files_of(stopped)
    with pytest.raises(
        CacheError, match=f"{path} is damaged .*. Resume .* bake again, which makes a new version"
    ):
        shot.bake(stopped, resume=True)
    assert shot.files_of(stopped) == before
    shot.bake(stopped)
    after = shot.files_of(stopped)
    assert {name: after[name] for name in before} == before
    assert {
        name.replace("/v002/", "/v001/"): data for name, data in after.items() if "/v001/" not in name
    } == whole


def test_a_damaged_checkpoint_names_the_file(stopped, whole):
    path = found(stopped, "Cart-*/state_0005")
    flip(path)
    with pytest.raises(
        CacheError, match=f"{path} is damaged .*: delete it to resume from the checkpoint before it"
    ):
        shot.bake(stopped, resume=True)
    path.unlink()
    shot.bake(stopped, resume=True)
    assert shot.files_of(stopped) == whole


def test_frames_behind_the_checkpoint_of_a_killed_bake_are_baked_again(finished, whole):
    for path in finished.rglob("object.json"):
        killed = {**manifest.read_manifest(path.parent), "complete": False}
        del killed["checksums"], killed["end"]
        manifest.write_manifest(path.parent, killed)
        folder.remove_checkpoint(path.parent, 6)
        flip(path.parent / "height_0004.exr")
        (path.parent / "height_0003.exr.12ab34cd.tmp").write_bytes(b"half")
        (path.parent / "state_0006.json").write_bytes(b"{}")
    job = shot.bake(finished, resume=True)
    assert job.results[0].frame == 4 and len(job.repaired) == 3
    assert shot.files_of(finished) == whole


def test_a_receiver_whose_files_are_being_removed_has_no_checkpoint(stopped, whole):
    path = found(stopped, "Cart-*/object.json")
    path.rename(path.with_name(files.REMOVED_MANIFEST))
    (path.parent / "height_0001.exr").unlink()
    job = shot.bake(stopped, resume=True)
    assert job.results[0].frame == 1
    assert shot.files_of(stopped) == whole


def test_the_manifest_is_incomplete_before_frames_are_removed(finished):
    flip(found(finished, "Cart-*/height_0005.exr"))
    for number in range(6, shot.FRAMES + 1):  # a folder, which cannot be removed as a file
        path = found(finished, f"Cart-*/normal_{number:04d}.exr")
        path.unlink()
        path.mkdir()
    with pytest.raises(OSError):
        shot.bake(finished, resume=True)
    cart = manifest.read_manifest(found(finished, "Cart-*/object.json").parent)
    assert not cart["complete"] and [entry["frame"] for entry in cart["frames"]] == [1, 2, 3]


def test_damage_is_the_first_of_all_receivers(stopped, whole):
    flip(found(stopped, "Cart-*/height_0005.exr"))
    flip(found(stopped, "Flag-*/height_0004.exr"))
    flip(found(stopped, "Ground-*/normal_0002.exr"))
    job = shot.bake(stopped, resume=True)
    assert job.results[0].frame == 1 and len(job.repaired) == 3
    assert shot.files_of(stopped) == whole


def test_a_lock_that_is_taken_stops_the_bake_before_the_next_file(tmp_path):
    cache = tmp_path / "cache"

    def evaluate(frame, subframe):
        if frame == 4 and not taken:
            for path in cache.rglob("lock-*"):
                path.unlink()
                path.write_text("another")
            taken.append(len(list(cache.rglob("height_*"))))
        return shot.pose(frame, subframe)

    taken = []
    with pytest.raises(LockLost, match="was removed or replaced"):
        shot.bake(cache, evaluate)
    # Files whose writing had begun may still be finished.
    assert len(list(cache.rglob("height_*"))) <= taken[0] + 1
    assert all(path.read_text() == "another" for path in cache.rglob("lock-*"))


@pytest.mark.parametrize("name", ["frames.tsv", "object.json"])
def test_a_flip_in_the_frames_is_repaired_from_the_checkpoint_before_it(stopped, whole, name):
    path = found(stopped, f"Ground-*/{name}")
    lines = path.read_bytes().splitlines(keepends=True)
    if name == "frames.tsv":  # the line of frame 4
        lines[4] = lines[4].replace(b"depth", b"dEpth")
        path.write_bytes(b"".join(lines))
        job = shot.bake(stopped, resume=True)
        assert job.results[0].frame == 4 and "frames.tsv was missing or damaged" in job.repaired[0]
    else:
        path.unlink()
        shot.bake(stopped, resume=True)
    assert shot.files_of(stopped) == whole


def test_a_checkpoint_takes_the_same_bytes_early_and_late(tmp_path):
    shot.bake(tmp_path / "cache", frame_end=40, last=40, rates=(1.0,) * 40, receivers=shot.SPECS[:1])
    sidecars = (found(tmp_path, f"Cart-*/state_{frame:04d}.json").read_text() for frame in (39, 3))
    late, early = (len(text) - len(json.loads(text)["covered"]) for text in sidecars)
    assert abs(late - early) < 10
    lines = found(tmp_path, "Cart-*/frames.tsv").read_bytes().splitlines()
    assert abs(len(lines[40]) - len(lines[2])) < 100 and len(lines) == 41


def test_lines_of_a_finished_bake_that_are_cut_are_baked_again(finished, whole):
    path = found(finished, "Ground-*/frames.tsv")
    os.truncate(path, path.stat().st_size - 40)
    with pytest.raises(CacheError, match="frames.tsv is missing or damaged from frame 8 on. Resume"):
        manifest.read_manifest(path.parent)
    assert shot.bake(finished, resume=True).results[0].frame == 7
    assert shot.files_of(finished) == whole


def test_damage_is_found_by_bytes_and_by_absence(tmp_path):
    (tmp_path / "a").write_bytes(b"1")
    (tmp_path / "b").write_bytes(b"x" * (3 << 20))
    checksums = integrity.checksums_of(tmp_path, ["a", "b", "c"])
    assert sorted(checksums) == ["a", "b"] and integrity.damaged(tmp_path, checksums) is None
    (tmp_path / "b").write_bytes(b"x" * (3 << 20) + b"y")
    assert integrity.damaged(tmp_path, checksums) == "b"
    assert integrity.damaged(tmp_path, {"c": ""}) == "c" and integrity.damaged(tmp_path, {"a": ""}) is None


def test_finished_receivers_are_told_apart(finished, stopped):
    assert versions.is_finished(found(finished, "Cart-*/object.json").parent)
    assert not versions.is_finished(found(stopped, "Cart-*/object.json").parent)
    assert resuming.find_damage([]) == {}
