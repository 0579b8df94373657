# SPDX-License-Identifier: GPL-3.0-or-later
"""How fine the viewport's pictures are: coarse while something moves, whole when it stands still. No ``bpy``."""

from dataclasses import dataclass

# Seconds without a change after which a picture in all pixels is worth its time.
STILL_SECONDS = 0.15
# Pixels of the region a side that one of the picture covers while something moves.
MOVING_DIVISOR = 2
MOVING_DIVISOR_SOFTWARE = 4


@dataclass(frozen=True)
class Quality:
    divisor: int
    antialias: bool


FULL = Quality(1, False)
FINE = Quality(1, True)


class Pacing:
    """Of one viewport. Times in seconds of any one clock."""

    def __init__(self):
        self.software = False
        self._changed_at = None
        self.last_shown = None
        """Quality of what is on the screen, where it is of the present view and scene; else None."""

    def changed(self, now):
        """The view or the scene is another."""
        self._changed_at = now
        self.last_shown = None

    def shown(self, quality):
        """A picture of the present view and scene is there."""
        self.last_shown = quality

    def wanted(self, now):
        """The Quality to ask for. A whole picture comes first, one with smooth edges once that is shown."""
        if self._changed_at is not None and now - self._changed_at < STILL_SECONDS:
            return Quality(MOVING_DIVISOR_SOFTWARE if self.software else MOVING_DIVISOR, False)
        return FINE if self.last_shown in (FULL, FINE) else FULL

    def is_done(self):
        """Whether nothing better is to come."""
        return self.last_shown == FINE
