# SPDX-License-Identifier: GPL-3.0-or-later
"""A bare maple in wind: snow along the upper sides of trunk, branches and twigs."""

import sample

sample.run(
    lambda: sample.tree("maple")[:1],
    eye=(1.5, -9.4, 2.4),
    target=(0.0, 0.0, 2.7),
    depth=0.10,
    angle=14.0,
    resolution=1024,
)
