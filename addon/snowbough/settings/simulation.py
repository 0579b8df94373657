# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of the simulation itself. They stand in SnowProperties and nowhere else: bakes, previews and manifests
carry them all as one dict (snow_of), under the names that the native ``SnowSimulation`` has for them.
"""

import math

from bpy.props import EnumProperty, FloatProperty, IntProperty

MAPPINGS = (
    ("COMPUTE", "Compute", "Texels gather what they see of the sky: smooth, and the same bytes every time"),
    (
        "GEOMETRY",
        "Geometry",
        "Pixels scatter their snow over texels, as first published: uneven, needs OpenGL; for comparison",
    ),
)


class SnowProperties:
    """What ``SnowSimulation`` takes under the same names: metres, seconds, radians."""

    flutter: FloatProperty(
        name="Flutter",
        description="Half angle of the cone in which flakes stray from the direction (degrees)",
        subtype="ANGLE",
        default=math.radians(10.0),
        min=0.0,
        max=math.radians(45.0),
    )
    max_depth: FloatProperty(
        name="Maximum Depth",
        description="Snow that level ground holds before it slides off (metres)",
        default=1.0,
        min=1e-4,
        soft_max=10.0,
    )
    slide_half_life: FloatProperty(
        name="Slide Half-Life",
        description="Time in which half of the excess snow slides off (seconds)",
        default=2.0,
        min=1e-3,
        soft_max=60.0,
    )
    repose: FloatProperty(
        name="Repose",
        description="Steepest slope of snow's own surface before it moves to what lies lower or falls over an edge: "
        "wet snow stands steeper than powder. At 90 snow stays where it fell, on walls too (degrees)",
        subtype="ANGLE",
        default=math.radians(65.0),
        min=math.radians(5.0),
        max=math.radians(90.0),
    )
    cohesion: FloatProperty(
        name="Cohesion",
        description="How high a front of snow stands by itself: what is smooth and about as thin as that, twigs and "
        "wires, carries steeper, taller caps. 0 for snow that does not hold together (metres)",
        default=0.005,
        min=0.0,
        soft_max=0.1,
    )
    seed: IntProperty(
        name="Seed",
        description="Another number gives other random flakes (no unit)",
        default=0,
        min=0,
    )
    noise_density: FloatProperty(
        name="Noise Density",
        description="Share of pixels that catch a flake in one step; below 1 the snow gets grainy (0 to 1)",
        default=1.0,
        min=0.001,
        max=1.0,
    )
    mapping: EnumProperty(
        name="Mapping",
        description="How snow gets from the occlusion grid onto the maps; both give the same snow",
        items=MAPPINGS,
        default="COMPUTE",
    )


SNOW_SETTINGS = tuple(SnowProperties.__annotations__)


def snow_of(settings):
    """{name: value} of ``scene.snowbough``'s SnowProperties, as plain data."""
    return {name: getattr(settings, name) for name in SNOW_SETTINGS}
