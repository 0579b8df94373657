# SPDX-License-Identifier: GPL-3.0-or-later
"""The sliders of a snow shell, on its nodes and its material: what an artist has set there outlives the shell, which
is made anew after each bake.

A shell notes what it began with, so that what nobody has touched is chosen anew with the next one.
"""

import json

from .. import compat_nodes
from ..names import SHELL_MODIFIER
from . import look

_RECORD = "snowbough_sliders"


def _of_nodes(shell):
    modifier = shell.modifiers.get(SHELL_MODIFIER)
    if modifier is None or modifier.node_group is None:
        return {}
    sockets = compat_nodes.group_sockets(modifier.node_group, "INPUT")
    names = [name for name, socket in sockets.items() if hasattr(socket, "default_value")]  # not the geometry
    return {name: compat_nodes.modifier_input(modifier, name) for name in names}


def _of_material(shell):
    values = {}
    for slot in shell.material_slots:
        for node in look.group_nodes(slot.material):
            for socket in node.inputs:
                if not socket.is_linked and socket.type in ("VALUE", "RGBA"):
                    value = socket.default_value
                    values[socket.name] = list(value) if socket.type == "RGBA" else float(value)
    return values


def _all(shell):
    return {"nodes": _of_nodes(shell), "material": _of_material(shell)}


def note(shell):
    """Notes the sliders of a shell that has just been made."""
    shell[_RECORD] = json.dumps(_all(shell))


def touched(shell):
    """{"nodes": {name: value}, "material": {name: value}} of the sliders that are not as the shell began. All of a
    shell that noted nothing, as older ones."""
    begun = json.loads(shell.get(_RECORD, "{}"))
    return {
        where: {name: value for name, value in now.items() if begun.get(where, {}).get(name) != value}
        for where, now in _all(shell).items()
    }


def put_back(shell, values):
    """Sets sliders to what touched() of another shell said; those that this one does not have are left out."""
    for name, value in values["nodes"].items():
        compat_nodes.set_modifier_input(shell.modifiers[SHELL_MODIFIER], name, value)
    for slot in shell.material_slots:
        for node in look.group_nodes(slot.material):
            for name, value in values["material"].items():
                if name in node.inputs:
                    node.inputs[name].default_value = value
    shell.update_tag()
