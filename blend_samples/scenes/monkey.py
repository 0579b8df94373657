# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's monkey: snow lies on brow, ears and nose, and the sheltered chin stays bare."""

import bpy
import sample


def build():
    bpy.ops.mesh.primitive_monkey_add(size=1.5, location=(0.0, 0.0, 0.72), rotation=(-0.5, 0.0, 0.3))
    return [sample.finish(sample.painted("bronze", (0.20, 0.09, 0.035), roughness=0.5), subdivisions=2)]


sample.run(build, eye=(0.9, -3.6, 1.5), target=(0.0, 0.0, 0.75), depth=0.09)
