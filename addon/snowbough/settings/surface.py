# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders of the snow surface. They change the surface and never the maps: the frame that is shown follows at once, the
others with Update Surface.
"""

from bpy.props import FloatProperty

SURFACE_DETAILS = (
    ("DRAFT", "Draft", "Up to 60,000 points, for a first look"),
    ("DEFAULT", "Default", "Up to 250,000 points"),
    ("FILM", "Film", "Up to a million points, for close-ups"),
)

# Called with the settings that a slider belongs to: result.surface_preview sets it.
changed = []


def _slider_changed(settings, context):
    for call in changed:
        call(context)


def _slider(name, description):
    return FloatProperty(
        name=name, description=description, default=1.0, min=0.0, soft_max=2.0, update=_slider_changed
    )


class SurfaceProperties:
    """What the native ``SnowSurface.set_style`` takes, as ``surface_<name>``."""

    surface_overhang: _slider(
        "Overhang",
        "How far snow leans out over rims and hangs down where it ends on slopes: 1 is fresh snow, 0 is none (no unit)",
    )
    surface_hem_variation: _slider(
        "Hem Variation",
        "How unevenly the lower edge of snow runs along rims: 1 is fresh snow, 0 makes it straight (no unit)",
    )
    surface_bridging: _slider(
        "Bridging",
        "How readily snow closes narrow gaps, as between boards or stones: 1 is fresh snow, 0 leaves all gaps "
        "open (no unit)",
    )
    surface_relief: _slider(
        "Relief Scale",
        "Height of the waves and bumps of the surface: 1 is fresh snow, 0 is smooth (no unit)",
    )
