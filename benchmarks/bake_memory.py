# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory of a long bake: the process's resident size after chosen frames. Prints a table.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/bake_memory.py -- [--frames 200]
        [--resolution 512]

The shot: a ground, a cart that drives over it, and a flag that an armature bends, all receivers. The
size must stay flat after the first ten frames.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tests" / "blender")]
import snow_scene  # noqa: E402
import snowbough  # noqa: E402

PAGE = os.sysconf("SC_PAGESIZE")


def resident_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE / 2**20


def main():
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="bake_memory.py")
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--resolution", type=int, default=512)
    options = parser.parse_args(given)
    snowbough.register()
    from snowbough.bake import engine, from_scene  # as register() has loaded them

    bpy.ops.wm.read_homefile(use_empty=True)
    sizes = {}
    with tempfile.TemporaryDirectory() as folder:
        snow_scene.moving_scene(folder, (1, options.frames))
        for entry in bpy.context.scene.snowbough.receivers:
            entry.resolution = options.resolution
        bpy.context.scene.snowbough.checkpoint_interval = 10
        running = from_scene.prepare_bake(bpy.context.scene, from_scene.make_request(bpy.context.scene))
        running.on_frame = lambda result: sizes.update({result.frame: resident_mib()})
        engine.run(bpy.context, running)
        assert running.error is None, running.error
    print(f"{'frame':>6} {'MiB':>8}")
    for frame in sorted({1, 10, 20, 50, 100, 150, options.frames} & sizes.keys()):
        print(f"{frame:>6} {sizes[frame]:>8.1f}")
    late = [size for frame, size in sizes.items() if frame > 10]
    print(f"after frame 10: {min(late):.1f} to {max(late):.1f} MiB")


main()
