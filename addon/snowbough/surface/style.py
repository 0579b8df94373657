# SPDX-License-Identifier: GPL-3.0-or-later
"""How a snow surface looks and how fine it is, as plain data. No ``bpy``."""

from dataclasses import asdict, dataclass

# Detail: (factor on lengths of edges, points that a scene has at most).
DETAILS = {"DRAFT": (1.7, 60_000), "DEFAULT": (1.0, 250_000), "FILM": (0.6, 1_000_000)}

# However small its part of a scene's points, a receiver may have so many.
LEAST_POINTS = 400


@dataclass(frozen=True)
class SurfaceStyle:
    """The settings of one receiver's surface."""

    detail: str = "DEFAULT"
    overhang: float = 1.0
    hem_variation: float = 1.0
    bridging: float = 1.0
    relief: float = 1.0

    @property
    def scale(self):
        """Factor on the lengths of edges."""
        return DETAILS[self.detail][0]

    def most_points(self, share):
        """share: the receiver's part of all points of the scene, 0 to 1."""
        return max(LEAST_POINTS, int(share * DETAILS[self.detail][1]))

    def sliders(self):
        """What the native SnowSurface.set_style takes."""
        return {name: value for name, value in asdict(self).items() if name != "detail"}

    def as_dict(self):
        return asdict(self)
