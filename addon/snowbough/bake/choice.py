# SPDX-License-Identifier: GPL-3.0-or-later
"""The receivers that a bake writes: those of the list that can carry snow in the shot's first pose. No ``bpy``.

A receiver that cannot (it is hidden, has no UV map, or exists only as scattered instances) is left out with a reason,
and the others are baked. The reason is an error if no receiver remains, if it was asked for by name, or in a strict
bake.
"""

from dataclasses import dataclass

from . import baked_receiver


@dataclass
class Choice:
    """The receivers of a shot."""

    receivers: list
    """BakedReceiver of those to bake now."""
    texels: list
    """Texel sizes in metres of all receivers of the shot: they determine the grid, whichever receivers are baked."""
    refused: dict
    """Label -> reason why it is left out."""


def choose_receivers(pose, request):
    """The Choice for the first pose of a BakeRequest's shot. Raises ValueError if no receiver remains."""
    choice = Choice([], [], dict(pose.refused))
    wanted, known = set(request.objects), set()
    seen = {(o.receiver.name, o.receiver.library) for o in pose.objects.values() if o.receiver}
    for spec in request.receivers:
        if spec.enabled and (spec.name, spec.library) not in seen and spec.name not in choice.refused:
            choice.refused[spec.name] = (
                f"'{spec.name}' is on the list of receivers, but not rendered at frame {request.frame_start}: make it "
                "renderable, or remove it from the list"
            )
    for obj in pose.objects.values():
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
        if not request.objects or names & set(request.objects):
            choice.receivers.append(receiver)
        wanted -= names
    _check(choice, request, wanted, known)
    return choice


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
