# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged manifests, inputs and sidecars are refused with a message, never partly read (without Blender)."""

import base64
import os
import random
import signal
import zlib

import numpy as np
import pytest
from cache_files import write_bake, write_manifest, written
from snowbough.cache import errors, files, folder, journal, manifest, owner, sealed
from snowbough.cache.coverage import Coverage
from snowbough.surface import mesh_file, point_cache

POSES = [["1", {"Cart": ["0123456789abcdef", "s", "u"], "雪": None}], ["1.5", {}]]
FRAMES = [{"frame": 1, "depth": 0.1, "volume": 0.30000000000000004, "slid": 0.0, "highest": 1e-05}]
SIDECAR = {
    "covered": Coverage(64).pack(),
    "driver": "CPU, processor, x86-64",
    "frames": FRAMES,
    "inputs": POSES,
}
SIDECAR = {
    "covered": Coverage(64).pack(),
    "driver": "CPU, processor, x86-64",
    "beside": [],
    "end": {"bytes": 100, "checksum": "0123456789abcdef" * 2},
}


@pytest.fixture
def cache(tmp_path):
    """{name of a file: (path, how it is read)} of a folder with one of each."""
    write_bake(tmp_path, written(cache="me"), FRAMES, POSES)
    folder.write_sidecar(tmp_path, 10, SIDECAR)
    owner.claim(tmp_path, tmp_path.parent / "shot.blend")
    return {
        "object.json": (tmp_path / "object.json", lambda: manifest.read_manifest(tmp_path)),
        "frames.tsv": (tmp_path / "frames.tsv", lambda: manifest.read_inputs(tmp_path)),
        "state_0010.json": (tmp_path / "state_0010.json", lambda: folder.read_sidecar(tmp_path, 10)),
        "owner.json": (tmp_path / "owner.json", lambda: owner.is_owner(tmp_path, tmp_path / "shot.blend")),
    }


NAMES = ("object.json", "frames.tsv", "state_0010.json", "owner.json")


@pytest.mark.parametrize("name", NAMES)
def test_what_was_written_is_read(cache, name):
    read = cache[name][1]()
    expected = {
        "frames.tsv": POSES,
        "state_0010.json": {**SIDECAR, "format": sealed.FORMAT},
        "owner.json": True,
    }
    assert read == expected.get(name, read) and read is not None


@pytest.mark.parametrize("name", NAMES)
def test_any_flipped_bit_is_refused_with_the_file_and_what_to_do(cache, name):
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    moments = random.Random(seed)
    path, read = cache[name]
    whole = path.read_bytes()
    for bit in moments.sample(range(len(whole) * 8), min(300, len(whole) * 8)):
        changed = bytearray(whole)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        with pytest.raises(
            errors.CacheError, match=r"is (damaged|missing or damaged.*) (\(.*\)\. )?(Delete|Resume|Free)"
        ):
            read()


def test_a_line_stands_only_behind_the_lines_that_it_was_written_behind(tmp_path):
    for name in ("Rock", "Stone"):
        (tmp_path / name).mkdir()
        write_bake(tmp_path / name, {**written(), "label": name}, FRAMES)
    own, other = ((tmp_path / name / files.FRAMES) for name in ("Rock", "Stone"))
    header, line = own.read_bytes().splitlines(keepends=True)
    own.write_bytes(header + other.read_bytes().splitlines(keepends=True)[1])
    assert journal.read_lines(own.parent).entries == []
    own.write_bytes(header + line + line)
    assert journal.read_lines(own.parent).entries == FRAMES


def test_frames_follow_one_another(tmp_path):
    write_bake(
        tmp_path, written(frames=range(1, 9)), [{**FRAMES[0], "frame": number} for number in (1, 2, 4)]
    )
    assert [entry["frame"] for entry in journal.read_lines(tmp_path).entries] == [1, 2]


def test_bytes_behind_the_last_line_are_damage(tmp_path):
    write_bake(tmp_path, written(frames=(1, 1)), FRAMES)
    with open(tmp_path / files.FRAMES, "ab") as stream:
        stream.write(b"x")
    assert journal.read_lines(tmp_path).rest == 1
    with pytest.raises(errors.CacheError, match="frames.tsv is missing or damaged from frame 2 on"):
        manifest.read_manifest(tmp_path)


def test_a_line_takes_the_place_of_what_a_failed_attempt_left(tmp_path):
    write_bake(tmp_path, written(), FRAMES)
    own = journal.Journal(tmp_path, journal.read_lines(tmp_path).ends[-1])
    with open(tmp_path / files.FRAMES, "ab") as stream:
        stream.write(b"half a line")
    second = {**FRAMES[0], "frame": 2}
    own.append(second, b"[]")
    lines = journal.read_lines(tmp_path)
    assert (lines.entries, lines.rest) == ([*FRAMES, second], 0)
    os.truncate(tmp_path / files.FRAMES, own.end.bytes - 1)
    with pytest.raises(errors.CacheError, match="it was replaced or cut during this bake"):
        own.append({**FRAMES[0], "frame": 3}, b"[]")


def test_a_checkpoint_counts_only_behind_the_lines_of_its_bake(tmp_path):
    write_bake(tmp_path, written(), FRAMES)
    end = journal.read_lines(tmp_path).ends[-1].as_dict()
    assert folder.lines_until(tmp_path, 1, {**SIDECAR, "end": end}).entries == FRAMES
    other = {**end, "checksum": "0123456789abcdef" * 2}
    with pytest.raises(
        errors.CacheError, match="frames.tsv is missing or damaged before the checkpoint of frame 1"
    ):
        folder.lines_until(tmp_path, 1, {**SIDECAR, "end": other})


def test_a_path_below_a_file_has_no_owner_and_no_damage(tmp_path):
    (tmp_path / "file").write_text("")
    assert owner.is_owner(tmp_path / "file" / "Scene", tmp_path / "shot.blend")


@pytest.mark.parametrize("name", NAMES)
def test_a_file_cut_short_is_refused(cache, name):
    path, read = cache[name]
    whole = path.read_bytes()
    for length in (0, 1, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(errors.CacheError, match="(is|or) damaged"):
            read()


@pytest.mark.parametrize(
    "text",
    [
        b"[]",
        b"null",
        b"{}",
        b'{"format": 2}',
        b'{"format": "2"}',
        b'{"format": NaN}',
        b"\xff\xfe",
        b"[" * 100000,
    ],
)
def test_what_is_no_manifest_at_all_is_refused(tmp_path, text):
    (tmp_path / files.MANIFEST).write_bytes(text)
    with pytest.raises(errors.CacheError, match="object.json (is damaged|was written by another)"):
        manifest.read_manifest(tmp_path)


@pytest.fixture
def patience():
    """Ends a test that waits."""

    def give_up(*_):
        raise TimeoutError("it waits for a pipe")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(10)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes")
@pytest.mark.parametrize("name", NAMES)
def test_a_pipe_in_place_of_a_file_is_refused_and_does_not_wait(cache, patience, name):
    path, read = cache[name]
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(errors.CacheError, match=rf"{name} .*it is not a file.*\. (Delete|Resume|Free)"):
        read()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes")
@pytest.mark.parametrize("is_link", [False, True])
def test_a_pipe_is_never_replaced_by_a_file(tmp_path, patience, is_link):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    path = tmp_path / ("link" if is_link else "pipe")
    with pytest.raises(errors.CacheError, match="a device or a pipe has this name"):
        files.write_report(path, {})
    with pytest.raises(errors.CacheError, match="a device or a pipe has this name"):
        with point_cache.PointCacheWriter(path, 1) as points:
            points.publish()
    with pytest.raises(errors.CacheError, match="it is not a file"):
        point_cache.read_point_cache(path)
    with pytest.raises(errors.CacheError, match="it is not a file"):
        mesh_file.read_mesh(path)
    assert sorted(os.listdir(tmp_path)) == ["link", "pipe"] and path.is_fifo()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes")
def test_a_pipe_in_place_of_the_lines_ends_a_bake_at_once(tmp_path, patience):
    write_bake(tmp_path, written(), FRAMES)
    own = journal.Journal(tmp_path, journal.read_lines(tmp_path).ends[-1])
    (tmp_path / files.FRAMES).unlink()
    os.mkfifo(tmp_path / files.FRAMES)
    with pytest.raises(errors.CacheError, match="frames.tsv could not be written"):
        own.append(FRAMES[0], b"[]")
    os.mkfifo(tmp_path / "height_0001.exr")
    (tmp_path / "height_0002.exr").touch()
    assert folder.baked_frames(tmp_path) == [2]


def test_a_shot_that_blender_does_not_have_is_refused(tmp_path):
    """The names of so many frames' files took 4.6 GB."""
    for wrong in ({"frame_end": 1_100_000}, {"frame_start": -5}, {"flutter": 1e300}):
        bake = written()
        bake["settings"]["snowfall"].update(wrong)
        manifest.write_manifest(tmp_path, bake)
        with pytest.raises(errors.CacheError, match="object.json is damaged"):
            folder.listed_files(tmp_path)


@pytest.mark.parametrize("number", [2, 3])
def test_a_bake_of_a_development_version_is_refused_with_what_to_do(tmp_path, number):
    (tmp_path / files.MANIFEST).write_bytes(files.to_json({**written(), "format": number}))
    with pytest.raises(errors.CacheError, match=f"another version of Snowbough .format {number}.*bake again"):
        manifest.read_manifest(tmp_path)


def test_a_huge_file_is_not_read(tmp_path):
    write_manifest(tmp_path)
    os.truncate(tmp_path / files.MANIFEST, sealed.MAX_BYTES + 1)
    with pytest.raises(errors.CacheError, match="it is larger than"):
        manifest.read_manifest(tmp_path)


def test_a_mask_comes_back(tmp_path):
    mask = np.arange(64 * 64).reshape(64, 64) % 3 == 0
    assert np.array_equal(Coverage.unpack(64, Coverage(64, mask).pack()).mask, mask)


@pytest.mark.parametrize("size", [0, 64 * 64 // 8 - 1, 64 * 64 // 8 + 1, 1 << 30])
def test_a_mask_of_another_size_is_refused_without_being_unpacked(size):
    packer = zlib.compressobj(1)
    block = bytes(1 << 20)
    packed = (
        b"".join(packer.compress(block[: size - at]) for at in range(0, size, len(block))) + packer.flush()
    )
    with pytest.raises(ValueError, match="64 x 64 texels"):
        Coverage.unpack(64, base64.b64encode(packed).decode())


@pytest.mark.parametrize("text", ["", "%%%", "aaaa", "ä"])
def test_what_is_no_mask_is_refused(text):
    with pytest.raises(ValueError, match="mask"):
        Coverage.unpack(64, text)
