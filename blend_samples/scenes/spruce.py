# SPDX-License-Identifier: GPL-3.0-or-later
"""A spruce with its needles, loaded with snow."""

import sample

sample.run(
    lambda: sample.tree("spruce", "--leaves"),
    eye=(1.5, -9.4, 2.4),
    target=(0.0, 0.0, 2.7),
    depth=0.10,
    resolution=1024,
)
