# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object does to the snow of receivers that it touches."""

from bpy.props import BoolProperty, EnumProperty, FloatProperty

KINDS = (
    ("NONE", "Nothing", "Snow lies as if this object did not touch it"),
    (
        "PRESS",
        "Presses Snow",
        "Packs the snow below itself and pushes a part of it aside: feet, wheels, paws",
    ),
    ("PLOUGH", "Ploughs Snow", "Pushes all snow ahead and aside: blades, skis that slip"),
    ("CLEAR", "Clears Snow", "Removes the snow that it touches: brooms, hands, wipers"),
)


class PressProperties:
    press: EnumProperty(
        name="On Contact",
        description="What this object does to the snow of receivers where it touches them while it moves",
        items=KINDS,
        default="NONE",
    )
    packed_density: FloatProperty(
        name="Packed Density",
        description="Density up to which snow is packed; fresh snow has 100, and packed snow carries. Higher values "
        "give deeper prints with lower rims (kilograms per cubic metre)",
        default=400.0,
        min=100.0,
        max=917.0,
    )
    pushed_aside: FloatProperty(
        name="Pushed Aside",
        description="Fraction of the displaced snow that is pushed aside instead of packed. Higher values give higher "
        "rims (0 to 1)",
        default=0.2,
        min=0.0,
        max=1.0,
    )
    rim_width: FloatProperty(
        name="Rim Width",
        description="Radius over which snow that is pushed aside spreads. Higher values give softer rims (metres)",
        default=0.05,
        min=0.0,
        max=100.0,
        soft_max=0.5,
    )
    walls_stand: FloatProperty(
        name="Walls Stand",
        description="Height up to which walls of packed snow stand. At 0 the sides of prints slump (metres)",
        default=0.3,
        min=0.0,
        max=100.0,
        soft_max=1.0,
    )
    blocks_wind: BoolProperty(
        name="Blocks Wind",
        description="Drifts form in the shelter of this object, and the wind carries its snow. If off, the wind passes "
        "it, as a tree or a loose fence",
        default=True,
    )


NUMBERS = ("packed_density", "pushed_aside", "rim_width", "walls_stand")


def press_of(settings, drifts=False):
    """The arguments of the native set_presser, from ``object.snowbough``; None for those that objects have at first.
    drifts: whether the wind carries snow."""
    passes = {"blocks_wind": False} if drifts and settings.occlude and not settings.blocks_wind else {}
    if settings.press == "NONE":
        return {"kind": "NONE", **passes} if passes else None
    return {"kind": settings.press, **{name: getattr(settings, name) for name in NUMBERS}, **passes}
