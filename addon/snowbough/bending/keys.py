# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframes of a bend: an action in an NLA track of its own that adds to all other motion of the armature.

The armature's active action, such as sway, stays active and adds to the tracks: in a strip, a loop would end with the
strip, and Add Tree Sway replaces the active action. Track and action carry marks, so that only they are replaced or
removed.
"""

import math

import bpy
import numpy as np

from ..base import compat
from .cantilevers import elementwise

TRACK = "Snow Load"
# Rotations add to those below; with ADD, scales would, too, and a keyed scale of 1 would become 2.
BLEND = "COMBINE"
# On the action: the report of the bend as text, and how the active action was mixed before.
REPORT = "snowbough_bend"
BLEND_BEFORE = "snowbough_blend_before"
# Radians; bones that turn less get no keys.
MIN_ANGLE = 1e-6
OTHER_ROTATIONS = (".rotation_quaternion", ".rotation_axis_angle")


def euler_angles(matrices):
    """XYZ angles (..., 3), as Blender's, of rotation matrices (..., 3, 3)."""
    x = elementwise(math.atan2, matrices[..., 2, 1], matrices[..., 2, 2])
    y = -elementwise(math.asin, np.clip(matrices[..., 2, 0], -1.0, 1.0))
    z = elementwise(math.atan2, matrices[..., 1, 0], matrices[..., 0, 0])
    return np.stack([x, y, z], axis=-1)


def _path(bone):
    return f'pose.bones["{bpy.utils.escape_identifier(bone.name)}"].rotation_euler'


def check(rig):
    """Raises ValueError if the armature's animation cannot take a bend."""
    animation = rig.animation_data
    if animation is None:
        return
    if animation.use_tweak_mode:
        raise ValueError(f"A strip of '{rig.name}' is in tweak mode: leave it (Tab in the NLA editor)")
    for curve in compat.curves_of(rig):
        if curve.data_path.endswith(OTHER_ROTATIONS):
            raise ValueError(
                f"The action of '{rig.name}' has quaternion or axis angle keys, to which no bend can be added: convert "
                "the rotation modes of its bones to XYZ Euler (Pose > Convert Rotation Modes)"
            )


def bend_of(rig):
    """(track, action) of the armature's bend, or (None, None)."""
    for track in rig.animation_data.nla_tracks if rig.animation_data else ():
        actions = [strip.action for strip in track.strips]
        if len(actions) == 1 and actions[0] is not None and REPORT in actions[0]:
            return track, actions[0]
    return None, None


def remove(rig):
    """Removes the bend of an armature; returns whether it had one. All other animation stays."""
    track, action = bend_of(rig)
    if track is None:
        return False
    paths = {curve.data_path for curve in compat.curves_in(action, track.strips[0])}
    rig.animation_data.action_blend_type = action.get(BLEND_BEFORE, "REPLACE")
    rig.animation_data.nla_tracks.remove(track)
    for bone in rig.pose.bones:  # Blender leaves the last pose
        if _path(bone) in paths:
            bone.rotation_euler = (0.0, 0.0, 0.0)
    if action.users == 0:
        bpy.data.actions.remove(action)
    rig.update_tag()
    return True


def write(rig, frames, angles, report):
    """Replaces the bend of an armature. frames float (K,); angles float (K, B, 3): XYZ angles of its bones, in the
    order of `rig.data.bones`; report: text for panels."""
    remove(rig)
    animation = rig.animation_data or rig.animation_data_create()
    active, slot = animation.action, getattr(animation, "action_slot", None)
    action, new_curve = compat.action_curves(rig, f"{rig.name}_snow_load")
    action_slot = getattr(animation, "action_slot", None)
    frames = np.asarray(frames, float).copy()
    frames[0] = np.floor(frames[0])  # strips begin at whole frames
    points = np.empty((len(frames), 2), np.float32)
    points[:, 0] = frames
    bends = np.abs(angles).max(axis=(0, 2)) > MIN_ANGLE
    for index in np.nonzero(bends)[0].tolist():
        bone = rig.pose.bones[rig.data.bones[index].name]
        bone.rotation_mode = "XYZ"
        for axis in range(3):
            curve = new_curve(_path(bone), axis, bone.name)
            curve.keyframe_points.add(len(frames))
            points[:, 1] = angles[:, index, axis]
            curve.keyframe_points.foreach_set("co", points.reshape(-1))
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
            curve.update()
    action[REPORT], action[BLEND_BEFORE] = report, animation.action_blend_type

    animation.action = active
    if active is not None and slot is not None:
        animation.action_slot = slot
    animation.action_blend_type = BLEND
    animation.use_nla = True
    track = animation.nla_tracks.new()
    track.name = TRACK
    strip = track.strips.new(TRACK, int(frames[0]), action)
    if action_slot is not None:
        strip.action_slot = action_slot
    strip.blend_type, strip.extrapolation = BLEND, "HOLD"
    return action
