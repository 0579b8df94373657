# SPDX-License-Identifier: GPL-3.0-or-later
"""Sand that ran through three holes: round heaps at 34 degrees on a board."""

import math

import bpy
import sample

TOP = 0.4
HOLES = ((-0.5, 0.0, 0.20), (0.36, -0.25, 0.16), (0.1, 0.62, 0.13))


def crate(material):
    made = sample.block("crate", material, (0.85, 0.42, TOP + 0.18), (0.36, 0.36, 0.36))
    made.rotation_euler[2] = 0.4
    return made


def lid():
    """A wide roof with holes, which the camera and the light do not see."""
    made = bpy.data.objects.new("lid", bpy.data.meshes.new("lid"))
    bpy.context.scene.collection.objects.link(made)
    cells, half, edge = 240, 1.5, 30.0
    lines = [-edge, *(-half + 2.0 * half * i / cells for i in range(cells + 1)), edge]
    count = len(lines)
    vertices = [(x, y, 2.0) for y in lines for x in lines]
    faces = []
    for row in range(count - 1):
        for column in range(count - 1):
            x, y = 0.5 * (lines[column] + lines[column + 1]), 0.5 * (lines[row] + lines[row + 1])
            if all(math.hypot(x - a, y - b) > radius for a, b, radius in HOLES):
                first = row * count + column
                faces.append((first, first + 1, first + count + 1, first + count))
    made.data.from_pydata(vertices, [], faces)
    for ray in ("camera", "shadow", "diffuse", "glossy", "transmission", "volume_scatter"):
        setattr(made, f"visible_{ray}", False)


def build():
    lid()
    wood = sample.painted("wood", (0.16, 0.085, 0.035), mottle=0.3, scale=10.0)
    paint = sample.painted("blue paint", (0.03, 0.09, 0.16), roughness=0.5)
    return [sample.board("board", wood, 2.6, (0.0, 0.1, TOP), 16), crate(paint)]


def sand(settings):
    bpy.ops.snowbough.set_kind(kind="SAND")
    settings.flutter = 0.0


sample.run(
    build,
    eye=(0.2, -2.5, 1.75),
    target=(0.0, 0.12, 0.5),
    lens=38.0,
    frames=14,
    depth=0.25,
    resolution=384,
    prepare=sand,
)
