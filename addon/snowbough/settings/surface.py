# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders of the snow surface. They change the surface and not the maps: the current frame updates at once, the other
frames with Update Surface.
"""

from bpy.props import FloatProperty

SURFACE_DETAILS = (
    ("DRAFT", "Draft", "Up to 60,000 points, for a first look"),
    ("DEFAULT", "Default", "Up to 250,000 points"),
    ("FILM", "Film", "Up to a million points, for close-ups"),
)

# Functions that are called with the context when a slider has changed; result.surface_preview adds its own.
changed = []


def _slider_changed(settings, context):
    for call in changed:
        call(context)


def _slider(name, description):
    return FloatProperty(
        name=name, description=description, default=1.0, min=0.0, soft_max=2.0, update=_slider_changed
    )


class SurfaceProperties:
    """Arguments of the native ``SnowSurface.set_style``, as ``surface_<name>``."""

    surface_overhang: _slider(
        "Overhang",
        "How far snow leans over edges and hangs down where it ends on slopes: 1 is fresh snow, 0 is no overhang",
    )
    surface_hem_variation: _slider(
        "Hem Variation",
        "Unevenness of the lower edge of overhanging snow: 1 is fresh snow, 0 is a straight edge",
    )
    surface_bridging: _slider(
        "Bridging",
        "How fully snow closes gaps up to about half of its height, and how thick cushions on leaves and needles are: "
        "1 is fresh snow, 0 keeps all gaps open",
    )
    surface_relief: _slider(
        "Relief Scale",
        "Height of the waves and bumps of the surface: 1 is fresh snow, 0 is smooth snow",
    )
