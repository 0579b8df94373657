# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes of ``blender -b`` are killed at random moments, also while they resume, and resumed to the same bytes."""

import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
import shot

ROOT = Path(__file__).resolve().parents[2]
BLENDER = os.environ.get("BLENDER", "blender")
# Each round kills one bake several times.
ROUNDS = int(os.environ.get("SNOWBOUGH_TEST_ROUNDS", 10))
KILLS_PER_ROUND = 5
FRAMES = 12

SCENE = f"""
import sys
sys.path[:0] = [{str(ROOT / "addon")!r}, {str(ROOT / "tests/blender")!r}]
import bpy, snowbough
snowbough.register()
import snow_scene
bpy.ops.wm.read_homefile(use_empty=True)
snow_scene.moving_scene("//cache", frames=(1, {FRAMES}), noise_density=0.5, flutter=0.05, directions=8,
                        blur_radius=1.0, surface_detail="DRAFT", write_normals=True)
bpy.ops.snowbough.setup_displacement(mode="SHELL")
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""


@pytest.fixture(scope="module")
def blend(tmp_path_factory):
    """A scene with a moving cart, a bending flag and snow surfaces."""
    if shutil.which(BLENDER) is None:
        pytest.skip(f"needs Blender ({BLENDER})")
    path = tmp_path_factory.mktemp("scene") / "shot.blend"
    command = [
        BLENDER,
        "-b",
        "--factory-startup",
        "--python-exit-code",
        "1",
        "--python-expr",
        SCENE,
        "--",
        path,
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


def start(blend, cache, engine, *arguments):
    """A bake in a Blender of its own."""
    return subprocess.Popen(
        [
            BLENDER, "-b", "--factory-startup", blend, "--python-exit-code", "1", "-P", ROOT / "addon/snowbough/cli.py",
            "--", "bake", "--cache", cache, "--engine", engine, *arguments,
        ],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def finish(bake):
    _, message = bake.communicate(timeout=180)
    assert bake.returncode == 0, message


def kill(bake, cache, moments):
    """Kills a bake after a random number of frames and a random time; returns the number of frames."""
    wanted, lines = moments.randrange(FRAMES + 1), 0
    while wanted == 0 and not list(cache.rglob("lock-*")) and bake.poll() is None:
        time.sleep(0.005)
    while lines < wanted and (line := bake.stdout.readline()):
        lines += line.startswith("SNOWBOUGH frame=")
    time.sleep(moments.uniform(0.0, 0.08))
    bake.send_signal(signal.SIGKILL)
    bake.communicate()
    return lines


@pytest.fixture(scope="module", params=["CPU", "GL"])
def engine(request, blend, memory_folder):
    """(engine, the bytes of its bake that was never disturbed)"""
    cache = memory_folder / f"whole {request.param}"
    bake = start(blend, cache, request.param)
    message = bake.communicate(timeout=180)[1]
    if bake.returncode == 6:
        pytest.skip("needs OpenGL")
    assert bake.returncode == 0, message
    return request.param, shot.files_of(cache)


def test_a_bake_that_is_killed_again_and_again_resumes_to_the_same_bytes(blend, engine, memory_folder):
    name, whole = engine
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print(f"seed {seed}, engine {name}")
    moments = random.Random(seed)
    # Every fifth round runs on OpenGL, which is slower in software.
    for number in range(ROUNDS - ROUNDS // 5 if name == "CPU" else ROUNDS // 5):
        cache = memory_folder / f"killed {name}"
        frames = [
            kill(start(blend, cache, name, *(["--resume"] if turn else [])), cache, moments)
            for turn in range(KILLS_PER_ROUND)
        ]
        left = len(shot.files_of(cache))
        finish(start(blend, cache, name, "--resume"))
        after = shot.files_of(cache)
        different = [file for file in whole.keys() | after.keys() if whole.get(file) != after.get(file)]
        print(
            f"round {number + 1}: killed after frames {frames}, {left} files left, {len(different)} different"
        )
        assert not different, sorted(different)
        shutil.rmtree(cache)
