# SPDX-License-Identifier: GPL-3.0-or-later
"""Which receivers a bake writes: those of the list that can carry snow at the shot's first pose. No ``bpy``.

One that cannot (it is hidden, has no UV map, is only there as scattered instances) is left out with the reason, and the
others are baked; where none is left, where it was asked for by name, or in a strict bake, the reason is the error.
"""

from dataclasses import dataclass

from . import baked_receiver


@dataclass
class Choice:
    """The receivers of a shot."""

    receivers: list
    """BakedReceiver of those to be baked now."""
    texels: list
    """Texel sizes in metres of all that carry snow in the shot: they fix the grid, whichever are baked."""
    refused: dict
    """Label -> why it is left out."""


def choose_receivers(pose, request):
    """The Choice for the first pose of a BakeRequest's shot. Raises ValueError where nothing is left to do."""
    choice = Choice([], [], dict(pose.refused))
    wanted, known = set(request.objects), set()
    seen = {(o.receiver.name, o.receiver.library) for o in pose.objects.values() if o.receiver}
    for spec in request.receivers:
        if spec.enabled and (spec.name, spec.library) not in seen and spec.name not in choice.refused:
            choice.refused[spec.name] = (
                f"'{spec.name}' is on the list of receivers, but the render does not show it at frame "
                f"{request.frame_start}: make it renderable, or take it off the list"
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
