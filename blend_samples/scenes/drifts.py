# SPDX-License-Identifier: GPL-3.0-or-later
"""A field in a storm: a board fence and a hut stand in the wind, which digs before them and heaps the snow behind."""

import bpy
import sample

FRAMES = 40
FIELD, TOP = 14.0, 0.4


def roof(material, place, size, rise):
    """A gable roof whose ridge runs along Y."""
    x, y = 0.5 * size[0], 0.5 * size[1]
    points = [(side * x, end * y, 0.0) for end in (-1, 1) for side in (-1, 1)] + [
        (0.0, end * y, rise) for end in (-1, 1)
    ]
    faces = [(0, 4, 5, 2), (1, 3, 5, 4), (0, 1, 4), (2, 5, 3), (0, 2, 3, 1)]
    mesh = bpy.data.meshes.new("roof")
    mesh.from_pydata(points, [], faces)
    made = bpy.data.objects.new("roof", mesh)
    made.location = place
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.objects.active = made
    made.select_set(True)
    return sample.finish(material, smooth=False)


def build():
    wood = sample.painted("wood", (0.16, 0.085, 0.035), mottle=0.3, scale=12.0)
    tar = sample.painted("tar", (0.035, 0.033, 0.032), mottle=0.3, scale=7.0)
    meadow = sample.painted("meadow", (0.07, 0.075, 0.03), mottle=0.4, scale=4.0)
    field = sample.board("field", meadow, FIELD, (0.0, 0.0, TOP))
    fence = [
        sample.block(f"board {row}", wood, (-1.2, -1.4, TOP + 0.12 + 0.21 * row), (0.05, 4.4, 0.2))
        for row in range(4)
    ]
    posts = [
        sample.block(f"post {post}", wood, (-1.26, -3.5 + 1.4 * post, TOP + 0.5), (0.08, 0.08, 1.0))
        for post in range(4)
    ]
    hut = sample.block("hut", wood, (-0.6, 3.2, TOP + 0.6), (1.8, 1.6, 1.2))
    return [field, roof(tar, (-0.6, 3.2, TOP + 1.2), (2.2, 2.0), 0.7), hut, *fence, *posts]


sample.run(
    build,
    eye=(3.4, -8.6, 4.2),
    target=(0.6, 0.2, 0.6),
    lens=32.0,
    frames=FRAMES,
    depth=0.25,
    start_depth=0.12,
    angle=20.0,
    bearing=90.0,
    resolution=512,
    drift=0.6,
)
