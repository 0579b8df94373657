# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes from pose to pose, for a simulation that wants to hear of changes only. No ``bpy``."""

from dataclasses import dataclass

import numpy as np

from .inputs import SNOWFALL, SceneInputs, fingerprint, pose_name
from .pose import TopologyChanged


@dataclass(frozen=True)
class Registration:
    """A mesh that the simulation is to take over from here on."""

    label: str
    pose: str
    """The frame, for messages."""
    topology: object
    """pose.Topology."""
    positions: np.ndarray
    """(V, 3) metres at its first pose: a receiver's output measures distances there."""


class SceneTracker:
    """Goes from one pose to the next. Which mesh an object has, and where it puts what has gone, follow from
    the poses alone, so a resumed bake that walks them again arrives at the same scene."""

    def __init__(self):
        self.inputs = SceneInputs()
        """Fingerprints of all poses so far."""
        # Key -> its Topology.
        self._topologies = {}
        self._complete = False
        # Key -> positions as the simulation has them after the steps taken so far.
        self._sent = {}
        self._pose_recorded = None

    def register_changes(self, pose, frame, subframe):
        """Notes a pose among the inputs; returns, for the simulation, (objects that are new or have a new
        mesh: {key: Registration}, positions of what is not where it was: {key: (V, 3)}).

        What leaves the render is drawn together in one point, where it shelters nothing.
        """
        name = pose_name(frame, subframe)
        added, changed = {}, {}
        for key, obj in pose.objects.items():
            known = self._topologies.get(key)
            if known is None and obj.receiver is not None and self._complete:
                raise TopologyChanged(
                    f"'{obj.label}' is a receiver that appears at frame {name}, after the shot's first: "
                    "make it renderable from the start, outside the picture"
                )
            if known is None or not known.is_same(obj.topology):
                self._topologies[key] = obj.topology
                added[key] = Registration(obj.label, name, obj.topology, obj.positions)
                if len(obj.positions):
                    changed[key] = self._sent[key] = obj.positions
                else:
                    self._sent.pop(key, None)
            elif len(obj.positions) and self._sent.get(key) is not obj.positions:
                changed[key] = self._sent[key] = obj.positions
        for gone in sorted(self._sent.keys() - pose.objects.keys()):
            last = self._sent[gone]
            if not (last == last[0]).all():
                changed[gone] = self._sent[gone] = np.repeat(last[:1], len(last), axis=0)
        self._complete = True
        if name != self._pose_recorded:
            sky = fingerprint(np.array([pose.fall_angle, pose.bearing], dtype=np.float64))
            self.inputs.add(name, {**dict(_unique_labels(pose.objects)), SNOWFALL: (sky, "", "")})
            self._pose_recorded = name
        return added, changed


def _unique_labels(objects):
    """(label, prints) of every object; a label that several share gets a number, in the order of keys."""
    counts = {}
    for key in sorted(objects):
        label = objects[key].label
        counts[label] = counts.get(label, 0) + 1
        yield (label if counts[label] == 1 else f"{label} ({counts[label]})"), objects[key].prints
