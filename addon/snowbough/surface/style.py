# SPDX-License-Identifier: GPL-3.0-or-later
"""The look and the detail of a snow surface, as plain data. No ``bpy``."""

from dataclasses import asdict, dataclass, fields

# Detail: (factor on edge lengths, maximum number of points in a scene).
DETAILS = {"DRAFT": (1.7, 60_000), "DEFAULT": (1.0, 250_000), "FILM": (0.6, 1_000_000)}

# Every receiver may have this many points, however few it needs.
MIN_POINTS = 400
# Under masks and where it thaws, snow ends anywhere on level places: further points at hems for each level one, and
# their maximum.
BORDERS_OF_PATCHES = 10.0
MAX_BORDERS = 40_000.0


@dataclass(frozen=True)
class WantedPoints:
    """Numbers of points that a receiver wants, and those that all receivers of its scene want, at the default detail:
    at hems, and on level places."""

    hems: float = 1.0
    level: float = 0.0
    all_hems: float = 1.0
    all_level: float = 0.0

    def most(self, scale, budget):
        """Maximum number of points of the receiver out of a `budget` for all, with edges `scale` times as long: hems
        first, then level places in proportion. Points that no receiver wants are handed out, too."""
        left = budget * scale**2 - self.all_hems
        level = min(max(left / max(self.all_level, 1.0), 0.0), 1.0)
        part = (self.hems + level * self.level) / max(self.all_hems + level * self.all_level, 1.0)
        return max(MIN_POINTS, int(min(part, 1.0) * budget))

    def expected(self, detail):
        """The number of points that its surface will have, roughly."""
        scale, budget = DETAILS[detail]
        return min((self.hems + self.level) / scale**2, self.most(scale, budget))


def patchy_points(hems, level):
    """(hems, level) of a receiver under a mask or a thaw, from those of a whole cover."""
    return hems + min(BORDERS_OF_PATCHES * level, MAX_BORDERS), level


def shared_out(wanted):
    """{key: WantedPoints} from {key: (hems, level)} of all receivers of a scene."""
    hems, level = (sum(one[k] for one in wanted.values()) for k in (0, 1))
    return {key: WantedPoints(*own, hems, level) for key, own in wanted.items()}


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

    def sliders(self):
        """Keyword arguments of the native SnowSurface.set_style."""
        return {name: getattr(self, name) for name in SLIDERS}

    def as_dict(self):
        return asdict(self)


SLIDERS = tuple(field.name for field in fields(SurfaceStyle) if field.name != "detail")
