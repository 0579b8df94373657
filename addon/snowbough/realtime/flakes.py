# SPDX-License-Identifier: GPL-3.0-or-later
"""Flakes in the air. The engine's settings and the direction and flutter of the scene's snow determine them."""

import math

from ..bake.plan import fall_direction
from ..scene.pose import metres_per_unit
from .records import Flakes

SECONDS_AN_HOUR = 3600.0


# Flakes in the air sway about their way; dust from the whole sky has no other.
MAX_FLUTTER = math.pi / 4


def flakes_of(scene):
    """The records.Flakes of an evaluated scene's current frame, or None if it shows no flakes."""
    options, snow = scene.snowbough_realtime, scene.snowbough
    rate = options.flake_rate / SECONDS_AN_HOUR * snow.rate
    if not options.show_flakes or rate <= 0.0:
        return None
    render = scene.render
    fps = render.fps / render.fps_base
    return Flakes(
        rate=rate,
        direction=tuple(fall_direction(snow.fall_angle, snow.bearing)),
        speed=options.flake_speed,
        flutter=min(snow.flutter, MAX_FLUTTER),
        radius=options.flake_size,
        shutter=min(render.motion_blur_shutter / fps, 1.0),
        time=scene.frame_current_final / fps,
        seed=snow.seed,
        metre=1.0 / metres_per_unit(scene),
    )
