# SPDX-License-Identifier: GPL-3.0-or-later
"""The receivers that a bake writes: those of the list that can carry snow on the first frame that shows them.
No ``bpy``.

A receiver that cannot (it is hidden on all frames, has no UV map, or exists only as scattered instances) is left out
with a reason, and the others are baked. The reason is an error if no receiver remains, if it was asked for by name, or
in a strict bake.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..base.names import MIN_DEPTH
from ..surface.compute import expected_seconds
from ..surface.side_by_side import for_each
from ..surface.style import patchy_points, shared_out
from . import baked_receiver

# Growth from frame to frame, as a factor, below which a receiver counts as full-grown.
GROWTH = 1.001


@dataclass
class Choice:
    """The receivers of a shot."""

    receivers: list
    """BakedReceiver of those to bake now."""
    others: list
    """BakedReceiver of the shot's other receivers."""
    texels: list
    """Texel sizes in metres of all receivers of the shot: they determine the grid, whichever receivers are baked."""
    refused: dict
    """Label -> reason why it is left out."""


def choose_receivers(pose, request):
    """The Choice for the complete_pose of a BakeRequest's shot. Raises ValueError if no receiver remains."""
    choice = Choice([], [], [], dict(pose.refused))
    wanted, known = set(request.objects), set()
    for spec in _missing(pose, request):
        choice.refused[spec.name] = pose.reasons.get(spec.name) or (
            f"'{spec.name}' is on the list of receivers, but not rendered on any frame of the shot: make it "
            "renderable, or remove it from the list"
        )
    for obj in pose.known.values():
        if obj.receiver is None or not obj.receiver.enabled:
            continue
        names = {obj.receiver.name, obj.receiver.shown(obj.label), obj.key}
        known.add(obj.receiver.name)
        try:
            receiver = baked_receiver.measure(obj, request.texel_size)
        except ValueError as error:
            choice.refused[obj.receiver.shown(obj.label)] = str(error)
            continue
        choice.texels.append(receiver.texel)
        is_wanted = not request.objects or names & set(request.objects)
        (choice.receivers if is_wanted else choice.others).append(receiver)
        wanted -= names
    _check(choice, request, wanted, known)
    return choice


def share_points(native, request, pose, receivers):
    """Gives each BakedReceiver its WantedPoints and the time that its surface takes. Computed from all receivers of the
    complete_pose, so that machines that bake some of them agree."""
    shown = {key: obj for key, obj in pose.known.items() if obj.receives and obj.receiver.surface is not None}
    shares = wanted_points(native, shown, request.start_depth, request.end_depth)
    for receiver in receivers:
        if receiver.key in shares:
            receiver.wanted = shares[receiver.key]
            points = receiver.wanted.expected(receiver.spec.surface.detail)
            receiver.surface_seconds = expected_seconds(points, request.last - request.frame_start + 1)


def wanted_points(native, objects, start_depth, end_depth):
    """{key: WantedPoints} of the surfaces on the receivers {key: object of a Pose}. Depths in metres, on open ground at
    the first and the last frame."""

    def wanted_by(obj):
        mesh = obj.topology
        depth = max(start_depth, end_depth, MIN_DEPTH)
        points = native.wanted_surface_points(mesh.triangles, obj.positions, depth, mesh.shading)
        is_patchy = end_depth < start_depth or obj.receiver.mask is not None
        return patchy_points(*points) if is_patchy else points

    return shared_out(dict(zip(objects, for_each(objects.values(), wanted_by))))


def _missing(pose, request):
    """The enabled receivers of a BakeRequest that no object of a pose belongs to."""
    seen = {(obj.receiver.name, obj.receiver.library) for obj in pose.known.values() if obj.receiver}
    return [
        spec
        for spec in request.receivers
        if spec.enabled and (spec.name, spec.library) not in seen and spec.name not in pose.refused
    ]


def complete_pose(evaluate, request):
    """The pose of the shot's first frame. Receivers that it does not show are hidden in it, as they are at the first
    frame that shows them, or when they have stopped growing: one that is scaled up from 0 must not get tiny texels.
    evaluate: see BakeJob.run."""
    pose, is_growing = evaluate(request.frame_start, 0.0), False
    for frame in range(request.frame_start + 1, request.frame_end + 1):
        if not (is_growing or _missing(pose, request) or _hides_members(pose, request)):
            break
        later = evaluate(frame, 0.0)
        larger = {
            key: obj
            for key, obj in later.objects.items()
            if obj.receives
            and key not in pose.objects
            and (key not in pose.hidden or _size(obj) > GROWTH * _size(pose.hidden[key]))
        }
        is_growing = bool(larger)
        pose = replace(pose, hidden={**pose.hidden, **larger}, refused=later.refused)
    return pose


def _hides_members(pose, request):
    """Whether a pose lacks objects of a collection that a receiver of a BakeRequest instances."""
    return any(
        (spec.known_as, *member) not in shown and f"{spec.name} / {member[0]}" not in pose.refused
        for shown in [{(o.receiver.known_as, o.name, o.library) for o in pose.known.values() if o.receiver}]
        for spec in request.receivers
        if spec.enabled
        for member in spec.members
    )


def _size(obj):
    return float(np.ptp(obj.positions, axis=0).sum())


def _check(choice, request, wanted, known):
    reasons = list(choice.refused.values())
    asked = [reason for label, reason in choice.refused.items() if label in wanted]
    if asked:
        raise ValueError("; ".join(asked))
    if wanted:
        raise ValueError(
            f"No enabled receiver is named {', '.join(sorted(wanted))}; there are: {', '.join(sorted(known))}"
        )
    if reasons and (request.strict or not choice.receivers):
        raise ValueError("; ".join(reasons))
    if not choice.receivers:
        raise ValueError("There is nothing for snow to lie on: select objects and use 'Add Snow to Selected'")
