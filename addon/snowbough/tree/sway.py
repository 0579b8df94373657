# SPDX-License-Identifier: GPL-3.0-or-later
"""Looping wind keyframes for a tree's armature.

Each bone gets two channels (bending, no twist) of about 16 keys, repeated by a Cycles modifier: a key on every frame
for 1,000 bones would make a file of 63 MB. The physics is in :mod:`.wind`.
"""

import bpy
import numpy as np

from ..base import compat
from . import wind

# (strength, gusts) of the operator's presets.
FORCES = {"BREEZE": (0.4, 0.3), "WIND": (1.0, 0.4), "STORM": (2.4, 0.7)}


def wind_direction(bearing):
    """Unit vector of the wind's direction: 0 is +Y, clockwise seen from above, as for snowfall."""
    return np.array([np.sin(bearing), np.cos(bearing), 0.0])


def bone_arrays(armature):
    """(parents, connected, heads, tails, head radii, axes) of all bones in armature space, parents before children.
    axes (B, 3, 3): those of a bone are rows."""
    bones = armature.bones
    count = len(bones)
    heads, tails = np.empty(count * 3, np.float32), np.empty(count * 3, np.float32)
    radii, matrices = np.empty(count, np.float32), np.empty(count * 16, np.float32)
    connected = np.empty(count, bool)
    bones.foreach_get("head_local", heads)
    bones.foreach_get("tail_local", tails)
    bones.foreach_get("head_radius", radii)
    bones.foreach_get("matrix_local", matrices)
    bones.foreach_get("use_connect", connected)
    number = {bone.name: index for index, bone in enumerate(bones)}
    parents = np.array([number[bone.parent.name] if bone.parent else -1 for bone in bones], dtype=np.int32)
    # Column-major in memory: columns 0 to 2 are the bone's axes in armature space.
    axes = matrices.reshape(count, 4, 4)[:, :3, :3]
    return parents, connected, heads.reshape(-1, 3), tails.reshape(-1, 3), radii, axes


def sway_angles(armature, to_world, direction, strength, gusts, seed, keys, seconds, scale):
    """Euler angles (B, keys, 2) about each bone's own X and Z axis, in the order of `armature.bones`.

    to_world: the armature's 3 x 3 world matrix as numpy; scale: metres of a Blender unit.
    """
    parents, connected, heads, tails, radii, local_axes = bone_arrays(armature)
    # The armature may be rotated and scaled; the physics uses world metres.
    size = abs(np.linalg.det(to_world)) ** (1 / 3) * scale
    rotation = to_world / max(np.cbrt(abs(np.linalg.det(to_world))), 1e-12)
    along = tails - heads
    lengths = np.maximum(np.linalg.norm(along, axis=1) * size, 1e-9)
    radii = radii * size

    chains = wind.find_chains(parents, connected, lengths, radii)
    shares = wind.bone_shares(chains, lengths, radii)
    bone_y = local_axes[:, 1]
    first = np.unique(chains.limb, return_index=True)[1]
    roots = heads[first] * size
    blow = rotation.T @ direction
    blow /= max(np.linalg.norm(blow), 1e-12)
    vectors = wind.sway_vectors(
        chains, shares, lengths, bone_y, roots, blow, strength, gusts, seed, keys, seconds
    )
    # A rotation vector perpendicular to the bone has only X and Z components in the bone's own frame.
    return np.einsum("bki,bai->bka", vectors, local_axes[:, (0, 2)])


def _write_curves(new_curve, bones, angles, start, step):
    """One F-curve per bone and axis: keys at start + k * step, and the first key's value again at the end.

    Handles are the tangents of the periodic cubic, so the loop closes in value and in speed.
    """
    keys = angles.shape[1]
    closed = np.concatenate([angles, angles[:, :1]], axis=1)
    slope = (np.roll(angles, -1, axis=1) - np.roll(angles, 1, axis=1)) / 2
    slope = np.concatenate([slope, slope[:, :1]], axis=1) / 3
    frames = start + step * np.arange(keys + 1)
    points = np.empty((keys + 1, 2), dtype=np.float32)
    points[:, 0] = frames
    before, after = points.copy(), points.copy()
    before[:, 0] -= step / 3
    after[:, 0] += step / 3
    for index, bone in enumerate(bones):
        path = f'pose.bones["{bpy.utils.escape_identifier(bone.name)}"].rotation_euler'
        for column, axis in enumerate((0, 2)):
            curve = new_curve(path, axis, bone.name)
            curve.keyframe_points.add(keys + 1)
            points[:, 1] = closed[index, :, column]
            before[:, 1] = points[:, 1] - slope[index, :, column]
            after[:, 1] = points[:, 1] + slope[index, :, column]
            write = curve.keyframe_points.foreach_set
            write("co", points.reshape(-1))
            write("handle_left", before.reshape(-1))
            write("handle_right", after.reshape(-1))
            # foreach_set cannot write enumerations. New keys are Bezier keys.
            for key in curve.keyframe_points:
                key.handle_left_type = key.handle_right_type = "FREE"
            curve.modifiers.new("CYCLES")


def add_sway(rig, scene, bearing, strength, gusts, seed, frame_start, loop_frames, keys):
    """Replaces the action of the armature object by a looping sway; returns the action.

    bearing in radians, strength: see wind.swing_angles, gusts 0 to 1, loop_frames > 0, keys >= 4.
    """
    seconds = loop_frames * scene.render.fps_base / scene.render.fps
    to_world = np.array(rig.matrix_world, dtype=float)[:3, :3]
    angles = sway_angles(
        rig.data,
        to_world,
        wind_direction(bearing),
        strength,
        gusts,
        seed,
        keys,
        seconds,
        scene.unit_settings.scale_length,
    )
    for bone in rig.pose.bones:
        bone.rotation_mode = "XYZ"
    old = rig.animation_data.action if rig.animation_data else None
    action, new_curve = compat.action_curves(rig, f"{rig.name}_sway")
    _write_curves(new_curve, rig.data.bones, angles, frame_start, loop_frames / keys)
    if old is not None and old.get("snowbough_sway") and old.users == 0:
        bpy.data.actions.remove(old)
    action["snowbough_sway"] = True
    return action


def rig_of(obj):
    """The object itself if it is an armature, else the armature that deforms it; None if there is none."""
    if obj is None:
        return None
    if obj.type == "ARMATURE":
        return obj
    return obj.find_armature() if obj.type == "MESH" else None
