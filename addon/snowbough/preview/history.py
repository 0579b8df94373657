# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow and the pose of played frames, in memory, within a budget. No ``bpy``.

If the budget is exceeded, the moment whose neighbours are closest is removed first (the oldest of equals), so that the
remaining moments are evenly spread over the frames. The first and the newest always stay.
"""

from bisect import bisect_right
from dataclasses import dataclass, replace

# Moments that always stay. With fewer, scrubbing would have to simulate all the snow again.
FEWEST = 2


@dataclass(frozen=True)
class Moment:
    """The snow after a frame."""

    frame: int
    pose: object
    """The scene.pose.ScenePose of the frame."""
    total: float
    """Snow depth in metres on open, level ground after the frame."""
    state: dict
    """snowbough_native.simulation_state; None if only the pose is known."""


class History:
    """Moments by frame. budget: bytes for their maps and positions together."""

    def __init__(self, budget):
        self.budget = budget
        self._moments = {}
        # Frames, ascending.
        self._frames = []

    def __len__(self):
        return len(self._frames)

    @property
    def frames(self):
        return tuple(self._frames)

    @property
    def bytes(self):
        """Bytes in use. Positions that several moments share count once."""
        maps = positions = 0
        seen = set()
        for moment in self._moments.values():
            if moment.state is not None:
                maps += sum(own["height"].nbytes for own in moment.state["objects"].values())
            for obj in moment.pose.objects.values():
                if id(obj.positions) not in seen:
                    seen.add(id(obj.positions))
                    positions += obj.positions.nbytes
        return maps + positions

    def put(self, moment):
        """Adds a moment, which replaces an earlier one of its frame, and removes moments over the budget."""
        if moment.frame not in self._moments:
            self._frames.insert(bisect_right(self._frames, moment.frame), moment.frame)
        self._moments[moment.frame] = moment
        while len(self._frames) > FEWEST and self.bytes > self.budget:
            self._remove(self._most_crowded())

    def at(self, frame):
        """The moment of that frame if its snow is known, or None."""
        moment = self._moments.get(frame)
        return moment if moment is not None and moment.state is not None else None

    def before(self, frame):
        """The newest moment at or before that frame whose snow is known, or None."""
        for known in reversed(self._frames[: bisect_right(self._frames, frame)]):
            if self._moments[known].state is not None:
                return self._moments[known]
        return None

    def poses(self):
        """[(frame, pose)] of all moments."""
        return [(frame, self._moments[frame].pose) for frame in self._frames]

    def forget_snow(self):
        """Keeps only the poses."""
        self._moments = {frame: replace(moment, state=None) for frame, moment in self._moments.items()}

    def drop_after(self, frame):
        """Removes the moments after that frame."""
        for later in [known for known in self._frames if known > frame]:
            self._remove(later)

    def clear(self):
        self._moments.clear()
        self._frames.clear()

    def _most_crowded(self):
        """The frame, neither first nor last, whose neighbours are closest; the first of equals."""
        frames = self._frames
        return frames[min(range(1, len(frames) - 1), key=lambda i: (frames[i + 1] - frames[i - 1], i))]

    def _remove(self, frame):
        self._frames.remove(frame)
        del self._moments[frame]
