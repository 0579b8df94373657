# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of the simulation, declared once in SnowProperties. Bakes, previews and manifests pass them on as one
dict (snow_of), under the names that the native ``SnowSimulation`` uses. The unit in brackets in a tooltip is that of
labels and messages, too.
"""

import math

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

MAPPINGS = (
    ("COMPUTE", "Compute", "Texels gather their snow: smooth, and identical in every run"),
    (
        "GEOMETRY",
        "Geometry",
        "Pixels scatter their snow over texels, as in the original thesis: uneven, needs OpenGL; for comparison",
    ),
)


class SnowProperties:
    """Arguments of ``SnowSimulation``, under the same names: metres, seconds, radians."""

    flutter: FloatProperty(
        name="Flutter",
        description="Half angle of the cone of flake directions. Higher values give softer shadows. At 90 dust comes "
        "from the whole sky (degrees)",
        subtype="ANGLE",
        default=math.radians(10.0),
        min=0.0,
        max=math.radians(90.0),
        soft_max=math.radians(45.0),
    )
    max_depth: FloatProperty(
        name="Maximum Depth",
        description="Depth that level ground holds before snow slides off. Higher values keep more snow (metres)",
        default=1.0,
        min=1e-4,
        soft_max=10.0,
    )
    slide_half_life: FloatProperty(
        name="Slide Half-Life",
        description="Time in which half of the excess snow slides off. Higher values slide more slowly (seconds)",
        default=2.0,
        min=1e-3,
        soft_max=60.0,
    )
    repose: FloatProperty(
        name="Repose",
        description="Steepest slope of the snow surface. Steeper snow slides to lower places or over edges: use high "
        "values for wet snow, low values for powder. At 90 snow stays where it fell, even on walls (degrees)",
        subtype="ANGLE",
        default=math.radians(65.0),
        min=math.radians(5.0),
        max=math.radians(90.0),
    )
    cohesion: FloatProperty(
        name="Cohesion",
        description="Height at which a vertical snow face stays up. Higher values give steeper, taller caps on twigs "
        "and wires; 0 is loose snow (metres)",
        default=0.005,
        min=0.0,
        soft_max=0.1,
    )
    adhesion: FloatProperty(
        name="Adhesion",
        description="Fraction of Maximum Depth that sticks to walls and undersides, where Repose is 90 degrees: dust. "
        "Higher values keep more (0 to 1)",
        default=0.0,
        min=0.0,
        max=1.0,
    )
    rising: FloatProperty(
        name="Rising",
        description="Depth that comes from below onto undersides, relative to level ground: dust in moving air. Needs "
        "Adhesion to stay there. Higher values give more (0 to 1)",
        default=0.0,
        min=0.0,
        max=1.0,
    )
    granular: BoolProperty(
        name="Granular",
        description="Heaps are round cones at exactly Repose, as of sand. Cohesion has no effect; bakes take longer",
        default=False,
    )
    density: FloatProperty(
        name="Density",
        description="Density of the snow: fresh snow has 100, wet snow 300. Higher values give more water "
        "(kilograms per cubic metre)",
        default=100.0,
        min=1.0,
        max=20000.0,
        soft_max=600.0,
    )
    sun_share: FloatProperty(
        name="Sun Share",
        description="Part of the thaw of open ground that comes from the sun, the rest from the air. Higher values "
        "keep more snow in shade (0 to 1)",
        default=0.7,
        min=0.0,
        max=1.0,
    )
    unevenness: FloatProperty(
        name="Unevenness",
        description="How uneven snow thaws: in patches, and faster beside bare ground. At 0 it vanishes everywhere at "
        "once (0 to 1)",
        default=0.25,
        min=0.0,
        max=1.0,
    )
    rain: FloatProperty(
        name="Rain",
        description="Water that falls on open ground in a second of the shot, along the direction of the snow. Higher "
        "values wet faster (metres)",
        default=0.0,
        min=0.0,
        max=1.0,
        soft_max=0.005,
        step=0.1,
        precision=4,
    )
    soak: FloatProperty(
        name="Soak",
        description="Water that a surface takes up before more runs off. Higher values keep runs short (metres)",
        default=0.002,
        min=1e-6,
        max=1.0,
        soft_max=0.02,
        step=0.1,
        precision=4,
    )
    wet_spread: FloatProperty(
        name="Wet Spread",
        description="Distance over which water soaks sideways in a second of the shot. Higher values give softer wet "
        "edges (metres)",
        default=0.05,
        min=0.0,
        max=10.0,
        soft_max=0.5,
    )
    drying: FloatProperty(
        name="Drying",
        description="Time of the shot in which half of the water on sunlit ground dries; shade takes three times as "
        "long. Higher values keep it wet (seconds)",
        default=4.0,
        min=1e-3,
        soft_max=120.0,
    )
    drift: FloatProperty(
        name="Drift",
        description="Lying snow that the wind carries along Bearing past each metre across it, over open ground, in a "
        "second of the shot. Higher values give larger drifts sooner. 0: none (square metres)",
        default=0.0,
        min=0.0,
        max=100.0,
        soft_max=2.0,
        step=1.0,
        precision=3,
    )
    landing: BoolProperty(
        name="Landing",
        description="Snow that slides or falls off lands on what lies below, and meets the snow of other receivers. "
        "Off: it disappears, and each receiver's snow depends on its own only. Needs Repose below 90 degrees",
        default=True,
    )
    throw_speed: FloatProperty(
        name="Throw",
        description="Speed at which snow leaves an edge. Higher values move heaps away from the wall "
        "(metres per second)",
        default=0.3,
        min=0.0,
        max=100.0,
        soft_max=5.0,
    )
    spread: FloatProperty(
        name="Spread",
        description="Slope by which falling snow spreads to all sides. Higher values make wider, lower heaps below "
        "high edges",
        default=0.12,
        min=0.0,
        max=10.0,
        soft_max=1.0,
    )
    heap_grain: FloatProperty(
        name="Heap Grain",
        description="Radius over which falling snow lands. Higher values make smoother heaps (metres)",
        default=0.06,
        min=1e-4,
        max=100.0,
        soft_max=1.0,
    )
    fall_time: BoolProperty(
        name="Fall Time",
        description="Falling takes time: snow lands as many frames later as it needs to fall, but before open snow has "
        "grown by 1 cm. Off: it lands at once",
        default=True,
    )
    seed: IntProperty(
        name="Seed",
        description="Random seed of the flakes",
        default=0,
        min=0,
    )
    noise_density: FloatProperty(
        name="Noise Density",
        description="Fraction of pixels that catch a flake in one step. Lower values give grainier snow (0 to 1)",
        default=1.0,
        min=0.001,
        max=1.0,
    )
    mapping: EnumProperty(
        name="Mapping",
        description="How snow is transferred from the occlusion grid to the maps. Geometry is for comparison",
        items=MAPPINGS,
        default="COMPUTE",
    )


# Their places in the panels: rows of fields that align. A setting that is not named here has no field.
STABILITY_ROWS = (
    ("max_depth", "slide_half_life"),
    ("repose", "cohesion"),
    ("adhesion", "rising"),
    ("granular",),
    ("landing",),
)
THAW_ROWS = (("sun_share", "unevenness", "density"),)
DRIFT_ROWS = (("drift", "bearing"),)
WATER_ROWS = (("rain",), ("soak", "wet_spread", "drying"))
ADVANCED_ROWS = (
    ("seed", "noise_density"),
    ("throw_speed", "spread"),
    ("heap_grain", "fall_time"),
    ("mapping",),
)

# With the switches of water and of flying snow (base.map_kinds), which the simulation then follows.
SNOW_SETTINGS = (*SnowProperties.__annotations__, "wet", "points")


def snow_of(settings):
    """{name: value} of ``scene.snowbough``'s SnowProperties, as plain data."""
    return {name: getattr(settings, name) for name in SNOW_SETTINGS}
