# SPDX-License-Identifier: GPL-3.0-or-later
"""Two bakes at once, one of them stopped by SIGSTOP, with and without its lock: neither damages the other's files."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import shot

HERE = Path(__file__).resolve().parent
PAIRS = int(os.environ.get("SNOWBOUGH_TEST_PAIRS", 10))


@pytest.fixture
def cache(memory_folder):
    """An empty cache."""
    yield memory_folder / "shot" / "cache"
    shutil.rmtree(memory_folder / "shot", ignore_errors=True)


def start(cache, *arguments):
    return subprocess.Popen(
        [sys.executable, HERE / "shot.py", cache, *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for(bake, frame):
    for line in bake.stdout:
        if line == f"pose {frame}\n":
            return


def suspend_between_files(bake, cache):
    """Sends SIGSTOP while no file is being written: the lock is checked before each file."""
    while True:
        bake.send_signal(signal.SIGSTOP)
        if not [path for path in cache.rglob("*.tmp") if not path.name.startswith("positions")]:
            return
        bake.send_signal(signal.SIGCONT)
        time.sleep(0.01)


def ended(bake):
    message = bake.communicate(timeout=120)[1]
    assert "Traceback" not in message, message
    return bake.returncode, message


def test_of_two_bakes_at_once_one_works_and_the_other_is_refused(cache, whole):
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    moments = random.Random(seed)
    for _ in range(PAIRS):
        first = start(cache, "--wait", "0.02")
        wait_for(first, moments.randrange(1, shot.FRAMES + 1))
        second = start(cache, *moments.choice([[], ["--resume"]]))
        (code, message), (other, text) = ended(first), ended(second)
        assert code in (0, 5) and other in (0, 5) and 0 in (code, other), message + text
        for ended_with, output in ((code, message), (other, text)):
            assert ended_with == 0 or "is being baked by process" in output or "was just finished" in output
        finished = {name: bytes for name, bytes in shot.files_of(cache).items() if "/v002/" not in name}
        assert finished == whole
        shutil.rmtree(cache.parent)


@pytest.mark.parametrize("frame", [2, 4, 8])
def test_a_bake_under_sigstop_keeps_its_lock_and_goes_on(cache, whole, frame):
    first = start(cache, "--wait", "0.05")
    wait_for(first, frame)
    first.send_signal(signal.SIGSTOP)
    code, message = ended(start(cache, "--resume"))
    assert code == 5 and "is being baked by process" in message
    first.send_signal(signal.SIGCONT)
    assert ended(first)[0] == 0
    assert shot.files_of(cache) == whole


@pytest.mark.parametrize("frame", [1, 4, 8])
def test_a_bake_under_sigstop_that_loses_its_lock_leaves_the_other_ones_files(cache, whole, frame):
    first = start(cache, "--wait", "0.2")
    wait_for(first, frame)
    suspend_between_files(first, cache)
    locks = list(cache.rglob("lock-*"))
    for path in locks:
        path.unlink()
    shot.bake(cache)
    first.send_signal(signal.SIGCONT)
    code, message = ended(first)
    if locks:
        assert code == 7 and "was removed or replaced during this bake" in message
    finished = {name: bytes for name, bytes in shot.files_of(cache).items() if "/v002/" not in name}
    assert finished == whole
