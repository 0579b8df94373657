# SPDX-License-Identifier: GPL-3.0-or-later
"""Fingerprints of the scene in each frame, to report later what has changed. No ``bpy``.

Each checkpoint contains the fingerprints of all poses up to it. A resumed bake evaluates those frames again and
compares: if the scene differs, it stops with "Cart: transform changed at frame 12".
"""

import hashlib

import numpy as np

# Label of the snowfall's direction, among the labels of the objects.
SNOWFALL = "Snowfall"

PARTS = ("transform", "shape", "topology or UV map", "alpha image", "mask", "effect on snow")


def fingerprint(*arrays):
    """16 hex digits of arrays (bytes, dtype and shape)."""
    hasher = hashlib.blake2b(digest_size=8)
    for array in arrays:
        array = np.ascontiguousarray(array)
        hasher.update(f"{array.dtype.str}{array.shape}".encode())
        hasher.update(array.data if array.size else b"")
    return hasher.hexdigest()


def pose_name(frame, subframe):
    """``12`` or ``12.25``."""
    return f"{frame + subframe:g}"


class SceneInputs:
    """The fingerprints of a sequence of poses. Only differences from the pose before are stored.

    The prints of an object are a list [transform, shape, topology], with a fourth for the images of its materials'
    alpha if there are any, a fifth for its mask and a sixth for what it does to snow, if there are any.
    """

    def __init__(self, poses=None):
        # List of (pose name, {label: [transform, shape, topology] or None if it left the scene}).
        self.poses = [] if poses is None else poses
        self._current = {}
        for _, changes in self.poses:
            self._apply(changes)

    def _apply(self, changes):
        for label, prints in changes.items():
            if prints is None:
                self._current.pop(label, None)
            else:
                self._current[label] = prints

    def add(self, pose, prints):
        """prints: {label: [transform, shape, topology]} of all objects at this pose."""
        changes = {label: list(p) for label, p in prints.items() if self._current.get(label) != list(p)}
        changes.update({label: None for label in self._current if label not in prints})
        self.poses.append([pose, changes])
        self._apply(changes)

    def at(self, pose):
        """{label: [transform, shape, topology]} at a pose, or None if there was no such pose."""
        state = {}
        for name, changes in self.poses:
            state.update(changes)
            if name == pose:
                return {label: prints for label, prints in state.items() if prints is not None}
        return None

    def first_difference(self, other):
        """A text about the first pose at which other (a later reading of the same frames) differs, or None."""
        before, after = {}, {}
        for (pose, changes), (other_pose, other_changes) in zip(self.poses, other.poses):
            if pose != other_pose:
                return f"the bake's steps changed at frame {other_pose}"
            before.update(changes)
            after.update(other_changes)
            for label in sorted(set(changes) | set(other_changes)):
                text = difference(before.get(label), after.get(label))
                if text and label == SNOWFALL:
                    text = "direction changed"
                if text:
                    return f"{label}: {text} at frame {pose}"
        return None


def difference(before, after):
    """A text such as ``transform changed``, or None. before, after: prints of one object."""
    if before == after:
        return None
    if before is None:
        return "added"
    if after is None:
        return "removed"
    # Alpha and topology first: another alpha may change the topology, and other vertices the shape.
    before, after = ([*prints, "", "", ""][: len(PARTS)] for prints in (before, after))
    for index in (3, 2, 0, 1, 4, 5):
        if before[index] != after[index]:
            return f"{PARTS[index]} changed"
    return None
