# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes from pose to pose, for a simulation that wants to hear of changes only. No ``bpy``."""

import numpy as np

from .bake_request import TopologyChanged
from .scene_inputs import SNOWFALL, SceneInputs, fingerprint, pose_name


class SceneTracker:
    """Takes one pose after the other. The names it gives to objects, and where it puts what has gone,
    follow from the poses alone, so a resumed bake that walks them again arrives at the same scene."""

    def __init__(self):
        self.inputs = SceneInputs()
        """Fingerprints of all poses so far."""
        # Per key: [name in the simulation, its Topology, how often that has changed].
        self._entries = {}
        self._entries_complete = False
        # Name -> positions as the simulation has them after the steps taken so far.
        self._sent = {}
        self._pose_recorded = None

    def take(self, pose, frame, subframe):
        """Notes a pose among the inputs; returns (objects to add: [(name, Topology)], positions of what is
        not where it was: {name: (V, 3)}) for the simulation.

        Names are the keys. An occluder whose topology changes goes on under a new name, key~1, key~2 and
        so on, and its former self is drawn together in one point, where it shelters nothing; so is what
        leaves the render.
        """
        name = pose_name(frame, subframe)
        added, changed, present = [], {}, set()
        for key, obj in pose.objects.items():
            entry = self._entries.get(key)
            if entry is None:
                if obj.receiver is not None and self._entries_complete:
                    raise TopologyChanged(
                        f"'{obj.label}' is a receiver that appears at frame {name}, after the shot's first: "
                        "make it renderable from the start, outside the picture"
                    )
                entry = self._entries[key] = [key, obj.topology, 0]
                added.append((key, obj.topology))
            elif entry[1] is not obj.topology and entry[1].print != obj.topology.print:
                if obj.receiver is not None:
                    raise TopologyChanged(
                        f"'{obj.label}' has other vertices, faces or UVs at frame {name} than before: snow "
                        "needs one topology for the whole shot. Apply the modifier that changes it, or take "
                        "it off the list of receivers"
                    )
                number = entry[2] + 1
                entry = self._entries[key] = [f"{key}~{number}", obj.topology, number]
                added.append((entry[0], obj.topology))
            present.add(entry[0])
            if len(obj.positions) and self._sent.get(entry[0]) is not obj.positions:
                changed[entry[0]] = self._sent[entry[0]] = obj.positions
        for gone in self._sent.keys() - present:
            last = self._sent[gone]
            if not (last == last[0]).all():
                changed[gone] = self._sent[gone] = np.repeat(last[:1], len(last), axis=0)
        self._entries_complete = True
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
