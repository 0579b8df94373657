# SPDX-License-Identifier: GPL-3.0-or-later
"""A ball that turns by a third of a turn half-way through the snowfall: the first cap travels to the side, thins where
it is too steep, and new snow lies on top."""

import bpy
import sample


def build():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.6, location=(0.0, 0.0, 0.9))
    ball = sample.finish(sample.painted("red paint", (0.35, 0.03, 0.02), roughness=0.4))
    bpy.ops.mesh.primitive_cylinder_add(radius=0.09, depth=0.6, location=(0.0, 0.0, 0.2), vertices=32)
    post = sample.finish(sample.painted("wood", (0.16, 0.10, 0.06), mottle=0.3, scale=8.0))
    sample.turn(ball, 1, 65.0, (12, 20))
    return [ball, post]


sample.run(build, eye=(0.5, -3.4, 1.7), target=(0.0, 0.0, 0.75), frames=30, depth=0.12)
