# SPDX-License-Identifier: GPL-3.0-or-later
"""The boughs of a laden spruce let their snow go and spring back, and it lands on the ground around it.

./tools/sample.sh bough
"""

import math

import bpy
import sample

FRAMES, WEIGHT = 32, 200.0
# Seconds in which half of the snow goes, swings of the boughs a second, and their damping.
HALF_LIFE, SWINGS, DAMPING = 0.3, 1.4, 0.18


def load_and_swing(settings):
    bpy.context.view_layer.objects.active = rig = next(
        obj for obj in bpy.data.objects if obj.type == "ARMATURE"
    )
    rig.snowbough.bending.species, rig.snowbough.bending.weight = "SPRUCE", WEIGHT
    bpy.ops.snowbough.bend_under_snow()
    for entry in settings.receivers:
        if entry.object.parent == rig or entry.object.find_armature() == rig:
            entry.shed_half_life = HALF_LIFE
    (strip,) = next(track for track in rig.animation_data.nla_tracks if track.name == "Snow Load").strips
    # Its influence counts within the strip only, which has one key, of the last frame.
    strip.frame_start, strip.frame_end = 1, FRAMES + 1
    strip.use_animated_influence = True
    # A damped spring that follows the load.
    bend, speed, parts = 1.0, 0.0, 20
    pull, rate = (2.0 * math.pi * SWINGS) ** 2, 4.0 * math.pi * SWINGS * DAMPING
    for frame in range(1, FRAMES + 1):
        strip.influence = min(max(bend, 0.0), 1.0)
        strip.keyframe_insert("influence", frame=frame)
        for part in range(parts):
            seconds = (frame - 1 + part / parts) / 24.0
            speed += (pull * (0.5 ** (seconds / HALF_LIFE) - bend) - rate * speed) / (24.0 * parts)
            bend += speed / (24.0 * parts)


sample.run(
    lambda: sample.tree("spruce", "--leaves"),
    eye=(2.0, -4.6, 1.3),
    target=(0.5, 0.0, 1.3),
    depth=0.15,
    start_depth=0.15,
    resolution=512,
    frames=FRAMES,
    prepare=load_and_swing,
    points=True,
    present=bpy.ops.snowbough.show_flying_snow,
)
