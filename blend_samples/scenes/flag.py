# SPDX-License-Identifier: GPL-3.0-or-later
"""A flapping flag: snow collects in its folds for a moment and slides off, and lies on the pole."""

import math

import sample
import windy_shot


def build():
    return windy_shot.make_flag()


sample.run(
    build,
    eye=(1.6, -6.0, 2.6),
    target=(-0.6, -2.0, 1.45),
    frames=36,
    depth=0.03,
    angle=12.0,
    bearing=75.0,
    max_depth=0.06,
    slide_half_life=0.08,
    repose=math.radians(80.0),
)
