# SPDX-License-Identifier: GPL-3.0-or-later
"""What was played: the snow and the pose of frames, in memory, within a budget. No ``bpy``.

Where the budget is exceeded, moments go whose neighbours lie closest together, the oldest of them first, so that
what stays is spread evenly over the frames. The first and the newest always stay.
"""

from bisect import bisect_right
from dataclasses import dataclass, replace

# Fewer are no history: what scrubbing falls back to then is laying anew.
FEWEST = 2


@dataclass(frozen=True)
class Moment:
    """The snow at the end of a frame."""

    frame: int
    pose: object
    """scene.pose.ScenePose that it lay on."""
    total: float
    """Metres on open level ground by then."""
    state: dict
    """snowbough_native.simulation_state; None where only the pose is known any more."""


class History:
    """Moments by frame. budget: bytes that their maps and positions may take together."""

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
        """What is held. Positions that several moments share count once."""
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
        """Keeps a moment, in the place of an earlier one of its frame, and lets go of what is too much."""
        if moment.frame not in self._moments:
            self._frames.insert(bisect_right(self._frames, moment.frame), moment.frame)
        self._moments[moment.frame] = moment
        while len(self._frames) > FEWEST and self.bytes > self.budget:
            self._remove(self._most_crowded())

    def at(self, frame):
        """The moment of that frame where its snow is known, or None."""
        moment = self._moments.get(frame)
        return moment if moment is not None and moment.state is not None else None

    def before(self, frame):
        """The newest moment up to and with that frame whose snow is known, or None."""
        for known in reversed(self._frames[: bisect_right(self._frames, frame)]):
            if self._moments[known].state is not None:
                return self._moments[known]
        return None

    def poses(self):
        """[(frame, pose)] of all moments."""
        return [(frame, self._moments[frame].pose) for frame in self._frames]

    def forget_snow(self):
        """Keeps the poses only."""
        self._moments = {frame: replace(moment, state=None) for frame, moment in self._moments.items()}

    def drop_after(self, frame):
        """Forgets what comes after that frame."""
        for later in [known for known in self._frames if known > frame]:
            self._remove(later)

    def clear(self):
        self._moments.clear()
        self._frames.clear()

    def _most_crowded(self):
        """The frame, neither first nor last, whose neighbours are closest; of several, the first."""
        frames = self._frames
        return frames[min(range(1, len(frames) - 1), key=lambda i: (frames[i + 1] - frames[i - 1], i))]

    def _remove(self, frame):
        self._frames.remove(frame)
        del self._moments[frame]
