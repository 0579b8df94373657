# SPDX-License-Identifier: GPL-3.0-or-later
"""A long bake in Blender takes no more memory and descriptors, and reads and writes no more per frame, at its end than
at its beginning."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLENDER = os.environ.get("BLENDER", "blender")
FRAMES = int(os.environ.get("SNOWBOUGH_TEST_FRAMES", 1000))
EARLY = FRAMES // 10

BAKE = f"""
import json, os, sys
sys.path[:0] = [{str(ROOT / "addon")!r}, {str(ROOT / "tests/blender")!r}]
import bpy, snowbough
snowbough.register()
import snow_scene
from snowbough.bake import engine, from_scene

def status(name):
    with open("/proc/self/status") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith(name))

def moved():
    # bytes that were read and written
    with open("/proc/self/io") as lines:
        return sum(int(line.split()[1]) for line in lines if line.startswith(("rchar", "wchar")))

taken, begun = {{}}, {{}}

def note(result):
    begun[result.frame] = moved()
    for last in ({EARLY}, {FRAMES}):
        if last - 20 < result.frame <= last:  # maps that wait to be written take memory and a descriptor, now and then
            now = status("VmRSS"), len(os.listdir("/proc/self/fd")), status("Threads")
            taken[last] = list(map(min, now, taken.get(last, now)))

bpy.ops.wm.read_homefile(use_empty=True)
snow_scene.moving_scene(sys.argv[-1], frames=(1, {FRAMES}), flutter=0.05, directions=8, checkpoint_interval=50)
running = from_scene.prepare_bake(bpy.context.scene, from_scene.make_request(bpy.context.scene), note)
engine.run(bpy.context, running)
if running.error is not None:
    raise running.error

def per_frame(first, last):
    return (begun[last] - begun[first]) / (last - first)

# At first, maps with little on them are small.
moves = per_frame({FRAMES} // 2, {FRAMES} // 2 + {EARLY}), per_frame({FRAMES} - {EARLY}, {FRAMES})
print("TAKEN", json.dumps({{**taken, "moves": moves}}))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /proc")
def test_a_long_bake_takes_no_more_at_its_end(memory_folder):
    if shutil.which(BLENDER) is None:
        pytest.skip(f"needs Blender ({BLENDER})")
    command = [BLENDER, "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", BAKE, "--"]
    done = subprocess.run([*command, memory_folder / "cache"], capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("TAKEN"))
    taken = json.loads(line[5:])
    early, late = (taken[str(frame)] for frame in (EARLY, FRAMES))
    print(f"frame {EARLY}: {early[0] // 1024} MiB, {early[1]} descriptors, {early[2]} threads")
    print(f"frame {FRAMES}: {late[0] // 1024} MiB, {late[1]} descriptors, {late[2]} threads")
    before, after = taken["moves"]
    print(f"bytes read and written per frame: {before:.0f} half-way, {after:.0f} late")
    assert after < 1.05 * before
    assert late[0] <= 1.02 * early[0]
    assert late[1:] == early[1:]
