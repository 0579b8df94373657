# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object does to the snow of receivers that it touches."""

from bpy.props import EnumProperty, FloatProperty

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


NUMBERS = ("packed_density", "pushed_aside", "rim_width", "walls_stand")


def press_of(settings):
    """The arguments of the native set_presser, from ``object.snowbough``; None if the object does nothing to snow."""
    if settings.press == "NONE":
        return None
    return {"kind": settings.press, **{name: getattr(settings, name) for name in NUMBERS}}
