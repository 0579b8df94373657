# SPDX-License-Identifier: GPL-3.0-or-later
"""The look and the detail of a snow surface, as plain data. No ``bpy``."""

from dataclasses import asdict, dataclass

# Detail: (factor on edge lengths, maximum number of points in a scene).
DETAILS = {"DRAFT": (1.7, 60_000), "DEFAULT": (1.0, 250_000), "FILM": (0.6, 1_000_000)}

# Every receiver may have this many points, however small its share.
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
        """Factor on edge lengths."""
        return DETAILS[self.detail][0]

    def most_points(self, share):
        """Maximum number of points. share: the receiver's share of the points of the scene, 0 to 1."""
        return max(LEAST_POINTS, int(share * DETAILS[self.detail][1]))

    def sliders(self):
        """Keyword arguments of the native SnowSurface.set_style."""
        return {name: value for name, value in asdict(self).items() if name != "detail"}

    def as_dict(self):
        return asdict(self)
