# SPDX-License-Identifier: GPL-3.0-or-later
"""Things in an attic under the dust of years: thick on what lies open, thin on walls, none below a shelf."""

import bpy
import sample

TOP = 0.4


def ball(material, place, radius):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=radius)
    made = sample.finish(material)
    made.name, made.location = "ball", place
    return made


def build():
    wood = sample.painted("wood", (0.085, 0.036, 0.014), roughness=0.35, mottle=0.3, scale=12.0)
    lacquer = sample.painted("lacquer", (0.20, 0.012, 0.010), roughness=0.2)
    green = sample.painted("green paint", (0.012, 0.055, 0.030), roughness=0.3)
    table = sample.block("table", wood, (0.0, 0.0, TOP), (2.0, 1.3, 0.06))
    chest = sample.block("chest", green, (-0.45, 0.1, TOP + 0.18), (0.5, 0.34, 0.3))
    chest.rotation_euler[2] = 0.35
    shelf = sample.block("shelf", wood, (0.45, 0.35, TOP + 0.5), (0.7, 0.4, 0.03))
    post = sample.block("post", wood, (0.45, 0.53, TOP + 0.26), (0.7, 0.03, 0.46))
    below = sample.block("box", green, (0.5, 0.33, TOP + 0.11), (0.2, 0.2, 0.16))
    return [table, chest, shelf, post, below, ball(lacquer, (0.25, -0.3, TOP + 0.2), 0.17)]


def dust(_settings):
    bpy.ops.snowbough.set_kind(kind="DUST")


sample.run(
    build,
    eye=(0.5, -2.2, 1.55),
    target=(0.05, 0.05, 0.62),
    lens=40.0,
    frames=12,
    depth=0.003,
    resolution=512,
    prepare=dust,
)
