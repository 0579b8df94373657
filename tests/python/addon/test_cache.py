# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake's folders, manifests and locks (snowbough.cache), without Blender."""

import datetime
import math
import os
import re
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough
from cache_files import write_manifest
from snowbough.bake import log
from snowbough.base import names
from snowbough.base.map_kinds import MAP_KINDS
from snowbough.cache import errors, files, folder, ledger, lock, manifest, owner, sealed, versions
from snowbough.scene.inputs import SceneInputs, fingerprint

UNITS = {"end_depth": "m", "flutter": "°"}
SIDECAR = {"covered": "", "driver": "CPU", "beside": [], "end": {"bytes": 9, "checksum": "0" * 32}}


def baked(path, frames=(1, 2), **given):
    write_manifest(path, frames=frames, **given)
    for frame in frames:
        (path / files.frame_file("height", frame)).write_bytes(b"exr")
    return path


def test_names_become_safe_file_names():
    assert names.safe_name("Cart") == "Cart"
    assert names.safe_name("../Bänk: 1/2") == "_B_nk__1_2"
    assert names.safe_name("...") == "_"
    assert names.safe_name("CON") == "_CON" and names.safe_name("aux.001") == "_aux.001"
    assert names.safe_name("Console") == "Console"


def test_names_that_differ_in_anything_get_folders_that_differ_in_more_than_case():
    alike = ["雪一", "山一", "Shot", "shot", "SHOT", "Shot ", "Sh ot", "Sh_ot", "a" * 64 + "b", "a" * 64 + "c", "CON",
             "con", "_CON", "Con.001", "Shot.", "Shot-0123abcd", ".Shot", "-shot"]  # fmt: skip
    folders = [names.folder_name(name) for name in alike]
    assert len({folder.lower() for folder in folders}) == len(alike), folders
    assert all(re.fullmatch("[A-Za-z0-9_][A-Za-z0-9._-]*[A-Za-z0-9_]", folder) for folder in folders)
    assert names.folder_name("Shot") == "Shot" and names.folder_name("Scene.001") == "Scene.001"


def test_objects_of_one_name_get_folders_of_their_own():
    local = names.receiver_key("Rock", ("", "", ""))
    linked = names.receiver_key("Rock", ("//rocks.blend", "", ""))
    instance = names.receiver_key("Rock", ("", "Empty", "3"))
    assert len({local, linked, instance}) == 3
    assert local == names.receiver_key("Rock", ("", "", ""))
    assert local.startswith("Rock-") and len(local) == len("Rock-") + 8


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    (tmp_path / "target").mkdir()  # a folder cannot be replaced by a file
    with pytest.raises(errors.CacheError, match="could not be written"):
        files.write_bytes(tmp_path / "target", b"x")
    assert sorted(os.listdir(tmp_path)) == ["target"]


def test_what_killed_writes_have_left_goes_and_the_files_of_others_stay(tmp_path):
    own = ("owner.json.0123abcd.tmp", "owner.json.ffffffff.tmp")
    others = ("owner.json", "owner.json.tmp", "owner.json.mine.tmp", "my owner.json.0123abcd.tmp")
    for name in (*own, *others):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "owner.json.00000000.tmp").symlink_to(tmp_path / "owner.json")
    files.remove_half_written(tmp_path / "owner.json")
    assert sorted(os.listdir(tmp_path)) == sorted([*others, "owner.json.00000000.tmp"])


def test_a_file_whose_half_is_removed_by_another_bake_is_written_once_more(tmp_path, monkeypatch):
    flush, path = os.fsync, tmp_path / "owner.json"

    def flush_and_remove(descriptor):
        flush(descriptor)
        monkeypatch.setattr(os, "fsync", flush)
        files.remove_half_written(path)

    monkeypatch.setattr(os, "fsync", flush_and_remove)
    files.write_bytes(path, b"whole")
    assert path.read_bytes() == b"whole" and os.listdir(tmp_path) == ["owner.json"]


@pytest.mark.parametrize("name", [files.OWNER, files.LEDGER])
def test_a_bake_removes_what_killed_writes_of_its_common_files_left(tmp_path, name):
    half = tmp_path / f"{name}.0123abcd.tmp"
    half.write_bytes(b"x")
    owner.claim(tmp_path, tmp_path / "shot.blend")
    ledger.write_ledger(tmp_path, [])
    assert not half.exists()


def test_equal_manifests_are_equal_bytes():
    assert files.to_json({"b": 1, "a": [1.5, "ä"]}) == files.to_json({"a": [1.5, "ä"], "b": 1})


def test_a_checkpoint_counts_only_with_its_state(tmp_path):
    folder.write_sidecar(tmp_path, 10, SIDECAR)
    assert folder.checkpoints(tmp_path) == []
    (tmp_path / "state_0010").write_bytes(b"s")
    (tmp_path / "state_0020").write_bytes(b"s")
    assert folder.checkpoints(tmp_path) == [10]
    folder.remove_stray_files(tmp_path)
    assert sorted(os.listdir(tmp_path)) == ["state_0010", "state_0010.json"]
    assert folder.read_sidecar(tmp_path, 10) == {**SIDECAR, "format": sealed.FORMAT}


def test_checkpoints_between_the_regular_ones_go_once_passed(tmp_path):
    for frame in (4, 5, 10, 12):
        folder.write_sidecar(tmp_path, frame, SIDECAR)
        (tmp_path / files.state_file(frame)).write_bytes(b"s")
    folder.remove_irregular_checkpoints(tmp_path, frame_start=1, interval=5, before=12)
    assert folder.checkpoints(tmp_path) == [5, 10, 12]


def test_a_state_without_its_sidecar_is_never_left(tmp_path):
    """Such a checkpoint would be damaged; a sidecar alone is not a checkpoint."""
    (tmp_path / "state_0004").mkdir()  # which is no file and cannot be removed
    (tmp_path / "state_0004.json").touch()
    with pytest.raises(OSError):
        folder.remove_checkpoint(tmp_path, 4)
    assert (tmp_path / "state_0004.json").exists()


def test_the_frames_after_a_checkpoint_go_and_no_others(tmp_path):
    for name in (
        "height_0003.exr",
        "height_0004.exr",
        "normal_0004.exr",
        "height_0005.exr",
        "height_0004.exr.bak",
    ):
        (tmp_path / name).touch()
    folder.remove_frames_after(tmp_path, 3)
    assert sorted(os.listdir(tmp_path)) == ["height_0003.exr", "height_0004.exr.bak"]


def test_the_manifest_is_the_last_of_the_files_to_remove(tmp_path):
    baked(tmp_path)
    (tmp_path / "state_0002").touch()
    assert [path.name for path in folder.listed_files(tmp_path)] == [
        "height_0001.exr", "height_0002.exr", "state_0002", files.MANIFEST
    ]  # fmt: skip


def test_a_link_to_a_bake_is_not_from_this_bake(tmp_path):
    baked(tmp_path / "a")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    if not (tmp_path / "link").is_symlink():
        pytest.skip("needs symbolic links")
    assert folder.is_foreign(tmp_path / "link") and not folder.is_foreign(tmp_path / "a")


def test_the_first_bake_is_version_1(tmp_path):
    assert versions.choose_version(tmp_path / "none", ["a"], "s") == 1


def test_a_finished_receiver_is_never_overwritten(tmp_path):
    baked(tmp_path / "v001" / "a")
    assert versions.choose_version(tmp_path, ["a"], "s") == 2


def test_an_unfinished_bake_is_done_again_in_place(tmp_path):
    baked(tmp_path / "v001" / "a", complete=False)
    assert versions.choose_version(tmp_path, ["a"], "s") == 1


def test_machines_that_share_a_shot_fill_one_version(tmp_path):
    baked(tmp_path / "v001" / "a", shot="s")
    assert versions.choose_version(tmp_path, ["b"], "s") == 1
    assert versions.choose_version(tmp_path, ["b"], "other shot") == 2


def test_resume_finds_the_unfinished_version(tmp_path):
    baked(tmp_path / "v001" / "a")
    baked(tmp_path / "v002" / "a", complete=False)
    baked(tmp_path / "v002" / "b")
    assert versions.resumable_version(tmp_path, ["a", "b"]) == (2, ["b"])
    assert versions.resumable_version(tmp_path, ["c"]) == (None, [])


def test_a_manifest_of_a_later_format_is_refused(tmp_path):
    (tmp_path / files.MANIFEST).write_bytes(files.to_json({"format": sealed.FORMAT + 1}))
    with pytest.raises(errors.CacheError, match="another version of Snowbough"):
        manifest.read_manifest(tmp_path)
    (tmp_path / files.MANIFEST).write_bytes(files.to_json({"format": sealed.FORMAT}))
    with pytest.raises(errors.CacheError, match="checksum is missing"):
        manifest.read_manifest(tmp_path)


def locks(version):
    return sorted(path.name for path in version.iterdir() if path.name.startswith("lock"))


def own_lock(version):
    (name,) = locks(version)
    return version / name


def test_receivers_are_locked_against_a_second_bake(tmp_path):
    with lock.lock_receivers(tmp_path, ["a", "b"]):
        with pytest.raises(errors.CacheBusy, match=f"b is being baked by process {os.getpid()}"):
            with lock.lock_receivers(tmp_path, ["b", "c"]):
                pass
        with lock.lock_receivers(tmp_path, ["c"]):  # of another machine, in the same version
            assert len(locks(tmp_path)) == 2
    with lock.lock_receivers(tmp_path, ["b"]):
        pass
    assert locks(tmp_path) == []


def test_a_killed_bake_blocks_nobody_and_its_lock_goes(tmp_path):
    program = (
        "import os; from snowbough.cache import lock\n"
        f"held = lock.lock_receivers({str(tmp_path)!r}, 'ab'); held.__enter__(); os.kill(os.getpid(), 9)"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(snowbough.__file__).parent.parent)}
    for _ in range(2):
        assert subprocess.run([sys.executable, "-c", program], env=environment).returncode in (-9, 9)
    assert len(locks(tmp_path)) == 1
    with lock.lock_receivers(tmp_path, "c"):
        assert len(locks(tmp_path)) == 1
    assert subprocess.run([sys.executable, "-c", program], env=environment).returncode in (-9, 9)
    lock.drop_dead_locks(tmp_path)
    assert locks(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="Windows removes no lock file that is open")
def test_a_file_that_took_the_place_of_the_gate_stays(tmp_path):
    with lock._gate(tmp_path):
        (tmp_path / "lock").unlink()
        (tmp_path / "lock").write_text("mine")
    assert (tmp_path / "lock").read_text() == "mine"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /proc")
def test_thousands_of_receivers_take_one_descriptor(tmp_path):
    before = len(os.listdir("/proc/self/fd"))
    with lock.lock_receivers(tmp_path, [f"r{number}" for number in range(2000)]) as held:
        assert len(os.listdir("/proc/self/fd")) == before + 1
        held.check()


@pytest.mark.skipif(os.name != "posix", reason="Windows removes no lock file that is open")
def test_a_lock_that_was_removed_or_replaced_is_noticed_and_the_other_ones_stays(tmp_path):
    with lock.lock_receivers(tmp_path, "a") as held:
        held.check()
        own_lock(tmp_path).unlink()
        with pytest.raises(errors.LockLost, match="was removed or replaced"):
            held.check()
        with lock.lock_receivers(tmp_path, "a") as second:
            with pytest.raises(errors.LockLost):
                held.check()
            second.check()
            path = own_lock(tmp_path)
            text = path.read_text()
            path.unlink()
            path.write_text(text)  # a copy of the file is not the locked one
            with pytest.raises(errors.LockLost):
                second.check()
        with lock.lock_receivers(tmp_path, "a") as second:
            own_lock(tmp_path).write_text("process 1 on elsewhere")
            with pytest.raises(errors.LockLost):
                second.check()
            own_lock(tmp_path).unlink()
    with lock.lock_receivers(tmp_path, "b"):
        own_lock(tmp_path).unlink()
        other = lock.lock_receivers(tmp_path, "b")
        other.__enter__().check()
    assert len(locks(tmp_path)) == 1
    other.__exit__(None, None, None)
    assert locks(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX permissions")
def test_an_unwritable_cache_says_what_to_do(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(errors.CacheError, match="Choose another"):
        files.make_folder(blocked / "cache")
    if os.getuid() != 0:
        tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
        with pytest.raises(errors.CacheError, match="Choose another"):
            files.make_folder(tmp_path / "cache")


def test_changed_settings_are_named_with_their_units():
    before = {
        "shot": "a",
        "end_depth": 0.1,
        "flutter": math.pi / 18,
        "receiver": {"resolution": 1024},
        "old": 1,
    }
    after = {
        "shot": "b",
        "end_depth": 0.2,
        "flutter": math.pi / 9,
        "receiver": {"resolution": 2048},
        "new": 1,
    }
    assert manifest.describe_changes(before, after, UNITS) == [
        "end depth: 0.1 m, now 0.2 m",
        "flutter: 10°, now 20°",
        "new: not set, now 1",
        "old: 1, now not set",
        "resolution: 1024, now 2048",
    ]


def test_the_depths_of_single_frames_are_named_only_if_nothing_else_changed():
    before, deeper = {"end_depth": 0.1, "totals": [0.1]}, {"end_depth": 0.2, "totals": [0.2]}
    assert manifest.describe_changes(before, deeper, UNITS) == ["end depth: 0.1 m, now 0.2 m"]
    animated = {"end_depth": 0.1, "totals": [0.0, 0.1]}
    assert manifest.describe_changes(before, animated, UNITS) == ["rate: its animation changed"]


def test_a_bake_from_before_a_kind_of_map_did_not_write_it(tmp_path):
    write_manifest(tmp_path)
    before = manifest.read_head(tmp_path)["settings"]["snowfall"]
    assert before["write_normals"] is False
    write_manifest(tmp_path, write_normals=True)
    before = manifest.read_head(tmp_path)["settings"]["snowfall"]
    after = {**before, "write_normals": False}
    assert manifest.describe_changes(before, after, {}) == ["write normals: True, now False"]


@pytest.mark.parametrize("kind", MAP_KINDS, ids=lambda kind: kind.name)
def test_every_kind_of_map_has_files_that_a_bake_owns(tmp_path, kind):
    name = files.frame_file(kind.name, 7)
    assert name in files.bake_files(7, 7) and files.is_bake_file(name)
    assert not kind.channels or files.texture_source(f"{kind.name}_0007.tx") == name
    for frame in (7, 8):
        (tmp_path / files.frame_file(kind.name, frame)).write_bytes(b"exr")
    folder.remove_frames_after(tmp_path, 7)
    assert os.listdir(tmp_path) == [name]


@pytest.mark.parametrize(
    "tooltip, unit",
    [
        ("Depth of the snow (metres)", "m"),
        ("Time (seconds)", "s"),
        ("Smoothing (texels)", "texels"),
        ("Steepest slope. Up to 90 (for walls) (degrees)", "°"),
        ("Side of the map (texels). 0 is automatic", "texels"),
        ("Share (0 to 1)", ""),
        ("Random seed", ""),
    ],
)
def test_the_unit_of_a_setting_is_in_brackets_in_its_tooltip(tooltip, unit):
    assert names.unit_of(tooltip) == unit


def test_amounts_are_spelled_for_people():
    assert names.counted(1, "frame") == "1 frame" and names.counted(1204, "frame") == "1,204 frames"
    assert names.counted(2, "branch", "branches") == "2 branches"
    assert [names.sized(size) for size in (1, 640 * 1024, 40 << 20, 3435973837)] == [
        "1 KiB", "640 KiB", "40 MiB", "3.2 GiB"
    ]  # fmt: skip


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


@pytest.mark.skipif(not hasattr(os, "O_NOFOLLOW"), reason="this system has no such links")
@pytest.mark.parametrize("name", ["lock", "lock-0123abcd"])
def test_a_link_in_place_of_a_lock_is_not_followed(tmp_path, name):
    own = tmp_path / "letter.txt"
    own.write_text("keep me")
    (tmp_path / "v001").mkdir()
    (tmp_path / "v001" / name).symlink_to(own)
    with (
        pytest.raises(errors.CacheError, match=f"{name} is a link"),
        lock.lock_receivers(tmp_path / "v001", "a"),
    ):
        pass
    assert own.read_text() == "keep me"


@pytest.mark.skipif(not hasattr(os, "O_NOFOLLOW"), reason="this system has no such links")
def test_a_log_is_not_written_through_a_link(tmp_path, monkeypatch):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "logs").symlink_to("elsewhere")
    with pytest.raises(errors.CacheError, match="logs is a link"), log.open_log(tmp_path):
        pass
    (tmp_path / "logs").unlink()
    with log.open_log(tmp_path) as write:
        write("mine")
    (written_,) = (tmp_path / "logs").iterdir()
    (tmp_path / "letter.txt").write_text("keep me")
    written_.unlink()
    written_.symlink_to(tmp_path / "letter.txt")
    moment = datetime.datetime.strptime(written_.name[:15], "%Y%m%dT%H%M%S")
    clock = type("clock", (), {"now": lambda _: moment})
    monkeypatch.setattr(log.datetime, "datetime", clock)
    with pytest.raises(errors.CacheError, match="could not be written"), log.open_log(tmp_path):
        pass
    assert (tmp_path / "letter.txt").read_text() == "keep me"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes")
@pytest.mark.parametrize("name", ["lock", "lock-0123abcd"])
def test_a_pipe_in_place_of_a_lock_ends_at_once(tmp_path, name):
    os.mkfifo(tmp_path / name)
    with pytest.raises(errors.CacheError, match="not the lock of a bake"), lock.lock_receivers(tmp_path, "a"):
        pass


@pytest.mark.skipif(not hasattr(os, "O_NOFOLLOW"), reason="this system has no such links")
@pytest.mark.parametrize("name", ["v001", "v001/a"])
def test_a_folder_that_is_a_link_is_not_written_to(tmp_path, name):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).symlink_to(tmp_path / "elsewhere")
    with (
        pytest.raises(errors.CacheError, match=f"{name} is a link"),
        lock.lock_receivers(tmp_path / "v001", "a"),
    ):
        pass
    assert list((tmp_path / "elsewhere").iterdir()) == []
