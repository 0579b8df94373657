# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow that is driven nearly level against a wall, a post and a ball, and sticks on the windward side.

./tools/sample.sh wind [DEGREES]      from the vertical; default: 80
"""

import math

import bpy
import sample

DEGREES = float(sample.ARGUMENTS[0]) if sample.ARGUMENTS else 80.0


def build():
    stone = sample.painted("stone", (0.12, 0.11, 0.10), mottle=0.3, scale=5.0)
    wood = sample.painted("wood", (0.16, 0.10, 0.06), mottle=0.3, scale=8.0)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(1.1, 0.4, 0.5))
    bpy.context.object.scale = (0.25, 1.6, 1.1)
    bpy.ops.object.transform_apply(location=False, rotation=False)
    wall = sample.finish(stone, smooth=False)
    bpy.ops.mesh.primitive_cylinder_add(radius=0.08, depth=1.6, location=(-0.2, -0.5, 0.7), vertices=32)
    post = sample.finish(wood, smooth=False)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.3, location=(-1.0, 0.1, 0.28))
    ball = sample.finish(stone)
    return [wall, post, ball]


# The wind blows from the left. Snow at this angle falls slowly on level ground, and wet snow sticks to walls.
sample.run(
    build,
    eye=(-1.6, -4.0, 1.5),
    target=(0.1, 0.0, 0.5),
    angle=DEGREES,
    bearing=80.0,
    depth=0.10 * math.cos(math.radians(DEGREES)),
    repose=math.radians(90.0),
    name=f"wind_{DEGREES:.0f}",
)
