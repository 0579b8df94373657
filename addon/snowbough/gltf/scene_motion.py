# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the armature's action as a loop of poses, one key at a time, from Blender's own evaluation."""

import bpy
import numpy as np

from ..base import compat
from .tree_data import STILL, Motion


def _loop(rig, options):
    """(first frame, length in frames) of the loop; None if the armature has no action."""
    curves = compat.curves_of(rig)
    keys = [
        point.co[0] for curve in curves for point in (curve.keyframe_points[0], curve.keyframe_points[-1])
    ]
    if not keys:
        return None
    first = min(keys)
    if options.loop_frames:
        return options.loop_start, options.loop_frames
    return (first, max(keys) - first) if max(keys) > first else None


def motion_of(scene, rig, options, warnings):
    """The Motion of the armature, evaluated at options.loop_keys moments of its loop; None if no bone turns.
    warnings: receives the losses."""
    loop = _loop(rig, options)
    if loop is None:
        return None
    if any(curve.data_path.endswith(("location", "scale")) for curve in compat.curves_of(rig)):
        warnings.append(
            f"the action of '{rig.name}' has locations or scales: only rotations of bones were exported"
        )
    first, length = loop
    keys = options.loop_keys
    turns = np.empty((keys + 1, len(rig.pose.bones), 4))
    places = np.arange(keys + 1) / keys * length
    # A scene with nothing but the armature: the meshes of the tree and its snow take seconds per frame.
    alone = bpy.data.scenes.new("snowbough_motion")
    try:
        alone.collection.objects.link(rig)
        for number, place in enumerate(places[:-1]):
            frame = first + place
            alone.frame_set(int(np.floor(frame)), subframe=float(frame - np.floor(frame)))
            posed = rig.evaluated_get(alone.view_layers[0].depsgraph).pose.bones
            for index, bone in enumerate(posed):
                w, x, y, z = bone.matrix_basis.to_quaternion()
                turns[number, index] = x, y, z, w
    finally:
        bpy.data.scenes.remove(alone)
    turns[-1] = turns[0]
    if np.abs(turns[..., :3]).max() < STILL:
        return None
    return Motion(places * scene.render.fps_base / scene.render.fps, turns)
