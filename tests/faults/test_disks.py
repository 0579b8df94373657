# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks without space, without inodes, or read-only: a bake reports a remedy, keeps its frames and can be resumed."""

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import shot
from snowbough.bake.map_writer import WriteFailed
from snowbough.cache.errors import CacheError

HERE = Path(__file__).resolve().parent
TRIED = int(os.environ.get("SNOWBOUGH_TEST_DISKS", 12))
NOBODY = 65534


@pytest.fixture
def disk(tmp_path):
    """disk(options): an empty disk at tmp/disk; disk.change(options)."""
    folder = tmp_path / "disk"
    folder.mkdir()

    def mount(*options):
        return subprocess.run(["mount", *options], stderr=subprocess.DEVNULL, check=False).returncode == 0

    def make(options):
        if not mount("-t", "tmpfs", "-o", options, "tmpfs", str(folder)):
            pytest.skip("mounting a small disk needs root")
        return folder

    make.change = lambda options: mount("-o", f"remount,{options}", str(folder))
    make.remove = lambda: subprocess.run(["umount", "-l", str(folder)], check=True)
    yield make
    if os.path.ismount(folder):
        make.remove()


@pytest.fixture(scope="module")
def whole(memory_folder):
    """(the bytes of a bake that was never disturbed, their number, the number of files and folders)"""
    cache = memory_folder / "whole" / "cache"
    shot.bake(cache)
    paths = list(cache.rglob("*"))
    return shot.files_of(cache), sum(path.stat().st_blocks * 512 for path in paths), len(paths)


def bakes_with_little(disk, options_of, least, most, grown, whole):
    """Bakes on disks of sizes from the smallest to the largest, resumes on larger ones, and returns the messages."""
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    moments, messages = random.Random(seed), []
    for _ in range(TRIED):
        amount = moments.randrange(least, most)
        cache = disk(options_of(amount)) / "cache"
        try:
            shot.bake(cache)
        except (CacheError, WriteFailed) as error:
            messages.append(str(error))
        else:
            assert shot.files_of(cache) == whole
        assert not list(cache.rglob("*.tmp")), amount
        assert disk.change(grown)
        shot.bake(cache, resume=True)
        assert shot.files_of(cache) == whole, amount
        disk.remove()
    return messages


def test_a_full_disk_loses_no_frame(disk, whole):
    files, size, _ = whole
    messages = bakes_with_little(
        disk, lambda amount: f"size={amount >> 10}k", 20 << 10, size, "size=64m", files
    )
    assert len(messages) > TRIED // 2
    assert all("No space left on device" in text and "free disk space" in text for text in messages), messages


def test_a_disk_without_inodes_loses_no_frame(disk, whole):
    files, _, count = whole
    messages = bakes_with_little(
        disk, lambda amount: f"size=64m,nr_inodes={amount}", 3, count, "nr_inodes=10000", files
    )
    assert len(messages) > TRIED // 2
    assert all("No space left on device" in text for text in messages), messages


def test_a_read_only_disk_is_refused_and_can_be_used_later(disk, whole):
    cache = disk("size=64m") / "cache"
    shot.bake(cache, last=5)
    before = shot.files_of(cache)
    assert disk.change("ro")
    for resume in (False, True):
        with pytest.raises(CacheError, match="Read-only file system. (Choose|Finished)"):
            shot.bake(cache, resume=resume)
    assert shot.files_of(cache) == before
    assert disk.change("rw")
    shot.bake(cache, resume=True)
    assert shot.files_of(cache) == whole[0]


@pytest.mark.skipif(os.getuid() != 0, reason="changing the user needs root")
def test_a_cache_that_becomes_read_only_during_a_bake_keeps_its_frames(memory_folder, whole):
    """As a user who loses the right to write to the receivers' folders at some frame."""
    folder = memory_folder / "user"
    folder.mkdir()
    memory_folder.chmod(0o755)
    os.chown(folder, NOBODY, NOBODY)
    command = [sys.executable, HERE / "shot.py", folder / "cache"]
    bake = subprocess.Popen(
        [*command, "--wait", "0.1"],
        user=NOBODY, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
    )  # fmt: skip
    for line in bake.stdout:
        if line == "pose 5\n":
            break
    receivers = [path.parent for path in (folder / "cache").rglob("object.json")]
    for path in receivers:
        path.chmod(0o555)
    message = bake.communicate(timeout=120)[1]
    assert bake.returncode == 5 and "Permission denied" in message and "allow writing there" in message, (
        message
    )
    for path in receivers:
        path.chmod(0o755)
    subprocess.run([*command, "--resume"], user=NOBODY, check=True, cwd=folder, stdout=subprocess.DEVNULL)
    assert shot.files_of(folder / "cache") == whole[0]
    shutil.rmtree(folder)
