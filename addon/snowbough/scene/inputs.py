# SPDX-License-Identifier: GPL-3.0-or-later
"""Fingerprints of what snow fell on, frame by frame, to say later what changed. No ``bpy``.

Each checkpoint carries the fingerprints of all poses up to it. A resumed bake walks those frames again
and compares: a scene that is not the same ends with "Cart: transform changed at frame 12" instead of
snow that belongs to no scene.
"""

import hashlib

import numpy as np

# Label of the direction that snow falls in, among the objects' labels.
SNOWFALL = "Snowfall"

PARTS = ("transform", "shape", "topology or UV map", "alpha image")


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
    """The fingerprints of a sequence of poses. Only what differs from the pose before is stored.

    Prints of an object are a list [transform, shape, topology], with a fourth, of the images that give its
    materials alpha, where there are such.
    """

    def __init__(self, poses=None):
        # List of (pose name, {label: [transform, shape, topology] or None where it left the scene}).
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
        """prints: {label: [transform, shape, topology]} of all that is there at this pose."""
        changes = {label: list(p) for label, p in prints.items() if self._current.get(label) != list(p)}
        changes.update({label: None for label in self._current if label not in prints})
        self.poses.append([pose, changes])
        self._apply(changes)

    def at(self, pose):
        """{label: [transform, shape, topology]} at a pose, or None where there was no such pose."""
        state = {}
        for name, changes in self.poses:
            _patch(state, changes)
            if name == pose:
                return {label: prints for label, prints in state.items() if prints is not None}
        return None

    def first_difference(self, other):
        """Text on the first pose at which other (a later look at the same frames) differs, or None."""
        ours, theirs = {}, {}
        for (pose, changes), (other_pose, other_changes) in zip(self.poses, other.poses):
            if pose != other_pose:
                return f"the bake's steps changed at frame {other_pose}"
            _patch(ours, changes)
            _patch(theirs, other_changes)
            for label in sorted(set(changes) | set(other_changes)):
                text = difference(ours.get(label), theirs.get(label))
                if text and label == SNOWFALL:
                    text = "direction changed"
                if text:
                    return f"{label}: {text} at frame {pose}"
        return None


def _patch(current, changes):
    for label, prints in changes.items():
        current[label] = prints


def difference(before, after):
    """``transform changed`` and the like, or None: prints of one object before and after."""
    if before == after:
        return None
    if before is None:
        return "added"
    if after is None:
        return "removed"
    # Alpha and topology first: with another alpha the topology may differ, with other vertices the shape.
    before, after = ([*prints, ""][: len(PARTS)] for prints in (before, after))
    for index in (3, 2, 0, 1):
        if before[index] != after[index]:
            return f"{PARTS[index]} changed"
    return None
