# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts Blender's lights and world to the sun and the sky of the real-time renderer. No ``bpy``.

The strength of Blender's sun is in watts per square metre: a white diffuse surface that faces it has the radiance
strength / pi. A world of one colour lights the scene from all directions with that colour.
"""

import math
from dataclasses import dataclass

from .records import Light

# Light from below as a share of the light from above. Objects and ground block most of the sky there.
GROUND_SHARE = 0.5


@dataclass(frozen=True)
class Lamp:
    """A light object of Blender."""

    kind: str
    """SUN, POINT, SPOT or AREA."""
    location: tuple
    direction: tuple
    """Unit vector in which the light shines."""
    color: tuple
    """Linear RGB."""
    energy: float
    """Watts per square metre for a sun, otherwise watts."""


def _brightness(color):
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]


def _towards(lamp, centre):
    """Unit vector from the centre towards the light's source, and the lamp's distance (1 for a sun)."""
    if lamp.kind == "SUN":
        return tuple(-d for d in lamp.direction), 1.0
    offset = [a - b for a, b in zip(lamp.location, centre)]
    away = math.sqrt(sum(d * d for d in offset))
    return (tuple(d / away for d in offset), away) if away > 0.0 else ((0.0, 0.0, 1.0), 1e-3)


def _irradiance(lamp, direction, away):
    """Watts per square metre on a surface that faces the lamp at that distance."""
    if lamp.kind == "SUN":
        return lamp.energy
    if lamp.kind == "AREA":
        facing = -sum(a * b for a, b in zip(lamp.direction, direction))
        return max(facing, 0.0) * lamp.energy / (math.pi * away * away)
    return lamp.energy / (4.0 * math.pi * away * away)


# Light of a view that does not use the scene's lights or its world.
STUDIO_SUN = Light((0.35, -0.55, 0.76), (0.9, 0.9, 0.9))
STUDIO_SKY = (0.3, 0.3, 0.3)


def shown(light, with_lamps, with_world):
    """The records.Light of a 3D view, with studio light instead of the scene's lamps or world where the view excludes
    them."""
    sky, ground = (light.sky, light.ground) if with_world else (STUDIO_SKY, STUDIO_SKY)
    sun = light if with_lamps else STUDIO_SUN
    behind = light.behind if with_world else STUDIO_SKY
    return Light(sun.direction, sun.sun, sky, ground, behind)


NO_SUN = (Light().direction, Light().sun)


def light_of(lamps, world, centre=(0.0, 0.0, 0.0)):
    """The records.Light of lamps and of a world's colour (linear, multiplied by its strength).

    The renderer has one sun with shadows: the brightest sun lamp. If there is no sun lamp, the lamp that is brightest
    at `centre` becomes the sun, with its direction there. Other sun lamps are added to the light from above or below,
    with their irradiance on a horizontal surface. Other lamps are ignored.
    """
    suns = [lamp for lamp in lamps if lamp.kind == "SUN"]
    sky, ground = list(world), [GROUND_SHARE * c for c in world]
    shining = []
    for lamp in suns or lamps:
        direction, away = _towards(lamp, centre)
        color = tuple(c * _irradiance(lamp, direction, away) / math.pi for c in lamp.color)
        shining.append((direction, color))
    shining.sort(key=lambda sun: -_brightness(sun[1]))
    for direction, color in shining[1:] if suns else ():
        side = sky if direction[2] > 0.0 else ground
        side[:] = (old + abs(direction[2]) * c for old, c in zip(side, color))
    direction, sun = shining[0] if shining and _brightness(shining[0][1]) > 0.0 else NO_SUN
    return Light(direction, sun, tuple(sky), tuple(ground), tuple(world))
