# SPDX-License-Identifier: GPL-3.0-or-later
"""Resolution of the viewport's frames: low while something moves, full when nothing moves. No ``bpy``."""

from dataclasses import dataclass

# Seconds without a change before a frame in full resolution is requested.
STILL_SECONDS = 0.15
# While something moves, one pixel of the frame covers this many pixels of the region along each axis.
MOVING_DIVISOR = 2
MOVING_DIVISOR_SOFTWARE = 4


@dataclass(frozen=True)
class Quality:
    divisor: int
    antialias: bool


FULL = Quality(1, False)
FINE = Quality(1, True)


class Pacing:
    """The pacing of one viewport. All times are seconds of the same clock."""

    def __init__(self):
        self.software = False
        self._changed_at = None
        self.last_shown = None
        """Quality of the shown frame if it shows the current view and scene, otherwise None."""

    def changed(self, now):
        """Call it when the view or the scene has changed."""
        self._changed_at = now
        self.last_shown = None

    def shown(self, quality):
        """Call it when a frame of the current view and scene is shown."""
        self.last_shown = quality

    def wanted(self, now):
        """The Quality of the next frame to request: full resolution first, then with antialiasing."""
        if self._changed_at is not None and now - self._changed_at < STILL_SECONDS:
            return Quality(MOVING_DIVISOR_SOFTWARE if self.software else MOVING_DIVISOR, False)
        return FINE if self.last_shown in (FULL, FINE) else FULL

    def is_done(self):
        """Whether the shown frame has the best Quality."""
        return self.last_shown == FINE
