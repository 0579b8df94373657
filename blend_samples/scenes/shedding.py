# SPDX-License-Identifier: GPL-3.0-or-later
"""The maple in leaf two seconds after its snow lay: in wind and warmth most leaves have shed theirs onto the ground."""

import sample


def sheds(settings):
    for entry in settings.receivers:
        if entry.object.name.endswith("_leaves"):
            entry.shed_half_life = 0.8


sample.run(
    lambda: sample.tree("maple", "--leaves"),
    eye=(1.9, -12.0, 2.6),
    target=(0.0, 0.0, 2.85),
    depth=0.05,
    resolution=1024,
    frames=32,
    start_depth=0.05,
    prepare=sheds,
)
