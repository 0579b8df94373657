# SPDX-License-Identifier: GPL-3.0-or-later
"""A yard in the sun of a thaw: snow lasts in the shade of a wall and a crate, and its water darkens the stone."""

import bpy
import sample

FRAMES = 40
YARD, TOP = 4.0, 0.4


def build():
    stone = sample.painted("stone", (0.22, 0.20, 0.175), mottle=0.35, scale=5.0)
    brick = sample.painted("brick", (0.26, 0.085, 0.05), mottle=0.3, scale=9.0)
    wood = sample.painted("wood", (0.20, 0.11, 0.045), mottle=0.3, scale=12.0)
    yard = sample.board("yard", stone, YARD, (0.0, 0.0, TOP))
    slab = sample.block("slab", stone, (0.0, 0.0, 0.5 * TOP - 0.255), (YARD, YARD, TOP + 0.5))
    slab.snowbough.occlude = False
    wall = sample.block("wall", brick, (-0.55, 0.55, TOP + 0.3), (0.2, 1.9, 0.6))
    crate = sample.block("crate", wood, (0.75, -0.35, TOP + 0.22), (0.44, 0.44, 0.44))
    crate.rotation_euler[2] = 0.5
    return [yard, wall, crate]


def thaw(settings):
    settings.sun = bpy.data.objects["low sun"]


sample.run(
    build,
    eye=(0.9, -4.1, 2.9),
    target=(0.1, 0.1, 0.45),
    lens=38.0,
    frames=FRAMES,
    depth=0.015,
    start_depth=0.10,
    resolution=512,
    prepare=thaw,
    wet=True,
    unevenness=0.3,
    density=250.0,
)
