# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of small production shots share.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import numpy as np
import pytest
import snow_scene as s
from conftest import addon_module
from surface_scene import points_at

QUARTER = 0.025


def quarters(*counts):
    """That many quarters of the snow, each within 1 %."""
    return pytest.approx([QUARTER * count for count in counts], rel=0.01, abs=1e-6)


def spread(points):
    """Largest extent of points along an axis."""
    return float(np.ptp(points, axis=0).max())


def sizes(surface, *times):
    """Extents of a surface at (frame, subframe)."""
    return [spread(points_at(surface, frame, subframe)) for frame, subframe in times]


def hide_by_key(obj, frames):
    for frame in range(1, 5):
        obj.hide_render = frame in frames
        obj.keyframe_insert("hide_render", frame=frame)


def hide_by_scale(obj, frames):
    s.key(obj, "scale", *((frame, (0.0 if frame in frames else 1.0,) * 3) for frame in range(1, 5)))


def straighten(animated):
    """Makes all keys linear."""
    for curve in addon_module("base.compat").curves_of(animated):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
