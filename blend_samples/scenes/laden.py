# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree that bends under its snow.

./tools/sample.sh laden [spruce|maple] [KILOGRAMS]     0: the tree stays straight; default: a spruce, automatic weight
"""

import bpy
import sample

SPECIES, WEIGHT = (*sample.ARGUMENTS, *("spruce", "")[len(sample.ARGUMENTS) :])[:2]


def bend(_settings):
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    rig.snowbough.bending.species = SPECIES.upper()
    rig.snowbough.bending.weight = float(WEIGHT or 0)
    bpy.context.view_layer.objects.active = rig
    if WEIGHT != "0":
        bpy.ops.snowbough.bend_under_snow()


sample.run(
    lambda: sample.tree(SPECIES, "--leaves") if SPECIES == "spruce" else sample.tree(SPECIES)[:1],
    eye=(1.5, -9.4, 2.4),
    target=(0.0, 0.0, 2.5),
    depth=0.15,
    resolution=1024,
    name=f"laden_{SPECIES}_{WEIGHT or 'automatic'}",
    frames=1,
    prepare=bend,
)
