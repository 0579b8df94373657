# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes from pose to pose, for a simulation that takes only changes. No ``bpy``."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .inputs import SNOWFALL, SceneInputs, fingerprint, pose_name
from .pose import TopologyChanged


@dataclass(frozen=True)
class Registration:
    """A mesh that the simulation uses from this pose on."""

    label: str
    pose: str
    """The frame, for messages."""
    topology: object
    """pose.Topology."""
    positions: np.ndarray
    """(V, 3) metres at its first pose, where a receiver's output measures distances."""
    occludes: bool = True


class Changes(NamedTuple):
    """What a simulation needs for a pose."""

    added: dict
    """{key: Registration} of objects that are new or have a new mesh."""
    moved: dict
    """{key: (V, 3)} of moved positions."""
    hidden: frozenset
    """Keys of all objects that are not shown in this pose."""
    masks: dict
    """{key: pose.Mask, or None for none} of receivers with another mask, or another mesh."""
    pressers: dict
    """{key: ObjectPose.press} of objects that do something else to snow."""

    def then(self, later):
        """These changes and later ones as one: of what changed twice, the last."""
        both = [{**before, **after} for before, after in zip(self, later) if isinstance(before, dict)]
        return Changes(*both[:2], later.hidden, *both[2:])


class SceneTracker:
    """Follows the poses. The mesh of an object, and its place while it is hidden, depend on the poses alone, so a
    resumed bake that evaluates them again arrives at the same scene."""

    def __init__(self):
        self.inputs = SceneInputs()
        """Fingerprints of all poses so far."""
        # Key -> its current Topology.
        self._topologies = {}
        self._complete = False
        # Key -> positions that the simulation has after the steps so far.
        self._sent = {}
        # Key -> its current Mask, and its current press, or None.
        self._masks, self._pressers = {}, {}
        self._pose_recorded = None

    def register_changes(self, pose, frame, subframe):
        """Adds a pose to the inputs; returns its Changes."""
        name = pose_name(frame, subframe)
        added, moved, masks, pressers = {}, {}, {}, {}
        for key, obj in pose.known.items():
            known = self._topologies.get(key)
            if known is None and obj.receives and self._complete:
                raise TopologyChanged(
                    f"'{obj.label}' is a receiver that appears at frame {name} for the first time: show it on a whole "
                    "frame of the shot before its snow is baked"
                )
            if key in pose.hidden and known is not None:
                continue
            if known is None or not known.is_same(obj.topology):
                self._topologies[key] = obj.topology
                added[key] = Registration(obj.label, name, obj.topology, obj.positions, obj.occludes)
                self._sent.pop(key, None)
            if len(obj.positions) and self._sent.get(key) is not obj.positions:
                moved[key] = self._sent[key] = obj.positions
            if self._masks.get(key) is not obj.mask or (key in added and obj.mask is not None):
                masks[key] = self._masks[key] = obj.mask
            if self._pressers.get(key) != obj.press:
                pressers[key] = self._pressers[key] = obj.press
        self._complete = True
        if name != self._pose_recorded:
            sky = fingerprint(np.array(pose.weather, dtype=np.float64))
            self.inputs.add(name, {**dict(_unique_labels(pose.objects)), SNOWFALL: (sky, "", "")})
            self._pose_recorded = name
        return Changes(
            added, moved, frozenset(self._topologies.keys() - pose.objects.keys()), masks, pressers
        )


def _unique_labels(objects):
    """(label, prints) of every object; repeated labels get a number, in the order of keys."""
    counts = {}
    for key in sorted(objects):
        label = objects[key].label
        counts[label] = counts.get(label, 0) + 1
        yield (label if counts[label] == 1 else f"{label} ({counts[label]})"), objects[key].prints
