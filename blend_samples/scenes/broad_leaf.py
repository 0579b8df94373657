# SPDX-License-Identifier: GPL-3.0-or-later
"""A maple in leaf, surprised by early snow: the leaves carry snow and shelter the ground."""

import sample

sample.run(
    lambda: sample.tree("maple", "--leaves"),
    eye=(1.9, -12.0, 2.6),
    target=(0.0, 0.0, 2.85),
    depth=0.05,
    resolution=1024,
)
