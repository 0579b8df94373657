# SPDX-License-Identifier: GPL-3.0-or-later
"""The garden bench: a cap of snow on each slat and arm, in a light wind."""

import demo_scene
import sample


def build():
    bench = demo_scene.make_bench(sample.painted("green paint", (0.045, 0.115, 0.085), roughness=0.5))
    demo_scene.unwrap(bench)
    bench.rotation_euler[2] = 0.35
    return [bench]


sample.run(build, eye=(0.6, -3.5, 1.55), target=(0.0, 0.0, 0.45), depth=0.10, angle=14.0)
