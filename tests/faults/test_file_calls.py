# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake is killed at, or gets an error from, a call that changes a file; then it is resumed to the same bytes."""

import errno
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import shot
from snowbough.cache import versions

HERE = Path(__file__).resolve().parent
# Number of calls of each kind of bake that are tried, seeded; 0 for all.
TRIED = int(os.environ.get("SNOWBOUGH_TEST_CALLS", 40))
ERRORS = (errno.EIO, errno.ENOSPC, errno.EROFS)
REMEDIES = ("again", "resume", "Choose another", "delete", "allow")


@pytest.fixture(scope="module")
def library(memory_folder):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("needs a C compiler")
    path = memory_folder / "faulty_calls.so"
    subprocess.run(
        [compiler, "-shared", "-fPIC", "-O1", "-o", path, HERE / "faulty_calls.c", "-ldl"], check=True
    )
    return path


@pytest.fixture
def bake(library, memory_folder):
    """bake(fault, arguments of shot.py): a bake into the folder `cache` with a fault; returns the ended process."""
    folder = memory_folder / "shot"

    def start(fault, *arguments):
        environment = {
            **os.environ,
            "LD_PRELOAD": str(library),
            "SNOWBOUGH_FAULT_ROOT": str(folder / "cache"),
            "SNOWBOUGH_FAULT": fault,
        }
        return subprocess.run(
            [sys.executable, HERE / "shot.py", folder / "cache", *arguments],
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )

    start.cache = folder / "cache"
    yield start
    shutil.rmtree(folder, ignore_errors=True)


def prepare(cache, stopped, begun):
    """An empty cache, or one with a stopped bake."""
    shutil.rmtree(cache.parent, ignore_errors=True)
    if begun:
        shutil.copytree(stopped.parent, cache.parent)


@pytest.fixture(scope="module")
def stopped(memory_folder):
    """The cache of a bake that stopped after frame 5."""
    cache = memory_folder / "stopped" / "cache"
    shot.bake(cache, last=5)
    return cache


# A new bake, one that clears a stopped one, and one that resumes it: (starts from the stopped one, arguments).
BAKES = {"new": (False, ()), "again": (True, ()), "resumed": (True, ("--resume",))}


def calls(bake, memory_folder, arguments):
    """[(name of the call, path)] of a bake, in order."""
    log = memory_folder / "calls.log"
    log.unlink(missing_ok=True)
    assert bake(f"log:{log}", *arguments).returncode == 0
    return [tuple(line.split(" ", 1)) for line in log.read_text().splitlines()]


def tried(count):
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print(f"seed {seed}, {count} calls")
    numbers = range(1, count + 1)
    moments = random.Random(seed)
    return moments, sorted(moments.sample(numbers, min(TRIED or count, count)))


# Frees the bake in a scene's folder.
FREE = """
import sys
sys.path.insert(0, sys.argv[1])
import shot
from snowbough.cache import errors, versions
try:
    versions.free(versions.find_bakes(sys.argv[2], (sys.argv[3],)))
except errors.CacheError as error:
    sys.exit(str(error))
"""


def test_a_removal_that_is_interrupted_goes_on_the_next_time(library, stopped, tmp_path):
    identity = shot.request(stopped).cache_id

    def free(fault):
        """Frees a copy of the stopped bake with a fault: (scene's folder, the error)."""
        root = shutil.copytree(stopped, tmp_path / fault.replace("/", "-") / "cache") / scene
        environment = {
            **os.environ,
            "LD_PRELOAD": str(library),
            "SNOWBOUGH_FAULT_ROOT": str(root),
            "SNOWBOUGH_FAULT": fault,
        }
        command = [sys.executable, "-c", FREE, HERE, root, identity]
        return root, subprocess.run(command, env=environment, capture_output=True, text=True).stderr

    (scene,) = (path.name for path in stopped.glob("Scene-*"))
    log = tmp_path / "calls.log"
    assert free(f"log:{log}")[1] == ""
    calls = [line.split(" ", 1) for line in log.read_text().splitlines()]
    of_frames = [
        k + 1 for k, (name, path) in enumerate(calls) if name == "unlink" and "_0" in Path(path).name
    ]
    assert len(of_frames) > 10
    for number in (of_frames[0], of_frames[len(of_frames) // 2], of_frames[-1]):
        root, said = free(f"fail:{number}:{errno.EIO}")
        assert "could not be removed: Input/output error" in said, number
        versions.free(versions.find_bakes(root, (identity,)))
        assert not [path for path in root.rglob("*") if path.is_file() and path.name != "owner.json"]


def test_every_file_is_flushed_before_it_is_renamed(bake, memory_folder):
    prepare(bake.cache, None, False)
    last, renamed = {}, 0
    for name, path in calls(bake, memory_folder, ()):
        if name == "rename" and path.endswith(".tmp"):
            assert last[path] == "fsync", path
            renamed += 1
        last[path] = name
    assert renamed > 50


@pytest.mark.parametrize("kind", BAKES)
def test_a_bake_that_is_killed_at_any_call_resumes_to_the_same_bytes(
    bake, memory_folder, stopped, whole, kind
):
    begun, arguments = BAKES[kind]
    prepare(bake.cache, stopped, begun)
    moments, numbers = tried(len(calls(bake, memory_folder, arguments)))
    for number in numbers:
        prepare(bake.cache, stopped, begun)
        killed = bake(f"kill:{number}", *arguments)
        assert killed.returncode in (-9, 0), killed.stderr
        shot.bake(bake.cache, resume=True)
        assert shot.files_of(bake.cache) == whole, f"killed at call {number}"


@pytest.mark.parametrize("kind", BAKES)
def test_a_bake_that_gets_an_error_says_what_to_do_and_resumes_to_the_same_bytes(
    bake, memory_folder, stopped, whole, kind
):
    begun, arguments = BAKES[kind]
    prepare(bake.cache, stopped, begun)
    moments, numbers = tried(len(calls(bake, memory_folder, arguments)))
    for number in numbers:
        prepare(bake.cache, stopped, begun)
        code = moments.choice(ERRORS)
        failed = bake(f"fail:{number}:{code}", *arguments)
        context = f"call {number}, {os.strerror(code)}: {failed.stderr}"
        assert failed.returncode in (0, 5, 7) and "Traceback" not in failed.stderr, context
        if failed.returncode:
            assert os.strerror(code) in failed.stderr or "lock" in failed.stderr, context
            assert any(remedy in failed.stderr for remedy in REMEDIES), context
        else:  # only a lock that could not be removed may stay
            left = {name: bytes for name, bytes in shot.files_of(bake.cache).items() if "/lock" not in name}
            assert left == whole, context
        shot.bake(bake.cache, resume=True)
        assert shot.files_of(bake.cache) == whole, context
