# SPDX-License-Identifier: GPL-3.0-or-later
"""The maple in leaf half a second after its snow lay: most leaves have shed theirs, which falls."""

import bpy
import sample


def sheds(settings):
    for entry in settings.receivers:
        if entry.object.name.endswith("_leaves"):
            entry.shed_half_life = 0.4


sample.run(
    lambda: sample.tree("maple", "--leaves"),
    eye=(1.9, -12.0, 2.6),
    target=(0.0, 0.0, 2.85),
    depth=0.05,
    resolution=512,
    frames=16,
    start_depth=0.05,
    prepare=sheds,
    points=True,
    present=bpy.ops.snowbough.show_flying_snow,
)
