# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes snow from objects that are in no list of receivers, such as appended objects.

The record of an object's original state remains in its original scene. So this module finds our additions by their
properties: modifiers by name, copies of materials by their node group, surfaces by their parent. If the mesh still has
its own materials, the copies are removed; otherwise our nodes are removed from the copies.
"""

import bpy

from ..base.names import DISPLACE_MODIFIER, OWN_MODIFIERS
from . import look, snow_surface
from .snow_material import FRAME_LABEL, output_node


def is_snowy(obj):
    """Whether an object has our snow and can be changed, or is a snow surface."""
    if obj.type != "MESH" or obj.library is not None:
        return False
    return obj.snowbough.is_shell or bool(_modifiers(obj) or _snowy_slots(obj) or _shells_of(obj))


def remove(obj):
    """Removes the snow. If `obj` is a snow surface, it is deleted."""
    if obj.snowbough.is_shell:
        snow_surface.delete_object(obj)
        return
    for shell in _shells_of(obj):
        snow_surface.delete_object(shell)
    for modifier in _modifiers(obj):
        texture = modifier.texture if modifier.name == DISPLACE_MODIFIER else None
        obj.modifiers.remove(modifier)
        if texture is not None and texture.users == 0:
            bpy.data.textures.remove(texture)
    for slot in _snowy_slots(obj):
        copy = slot.material
        if obj.data.materials[slot.slot_index] is not None:
            slot.material = None
            slot.link = "DATA"
        else:
            remove_snow_nodes(copy)
        if copy.users == 0:
            bpy.data.materials.remove(copy)


def _modifiers(obj):
    return [modifier for modifier in obj.modifiers if modifier.name in OWN_MODIFIERS]


def _snowy_slots(obj):
    return [slot for slot in obj.material_slots if slot.link == "OBJECT" and look.group_nodes(slot.material)]


def _shells_of(obj):
    """Snow surfaces of an object."""
    surfaces = (own for own in bpy.data.objects if own.library is None and own.snowbough.is_shell)
    return [surface for surface in surfaces if surface.parent == obj]


def remove_snow_nodes(material):
    """Removes the snow nodes from a material, so that the surface below them shows again."""
    tree = material.node_tree
    frames = {node for node in tree.nodes if node.type == "FRAME" and node.label == FRAME_LABEL}
    ours = {node for node in tree.nodes if node.parent in frames}
    output = output_node(tree)
    for group in look.group_nodes(material):
        _reconnect(tree, group.inputs["Shader"], output.inputs["Surface"], ours)
    for node in ours:
        if node.type == "VECT_MATH" and node.operation == "ADD":
            _reconnect(tree, node.inputs[0], output.inputs["Displacement"], ours)
    for node in ours | frames:
        tree.nodes.remove(node)


def _reconnect(tree, under, input_, ours):
    """Links the input of one of our nodes to the socket that the node was linked to."""
    if input_.links and input_.links[0].from_node in ours:
        for link in under.links:
            tree.links.new(link.from_socket, input_)
