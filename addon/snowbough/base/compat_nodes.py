# SPDX-License-Identifier: GPL-3.0-or-later
"""The counterpart of compat for nodes and node groups: their sockets and names in Blender 3.4 to 5.x."""

import bpy

from . import compat


def key_value(tree, socket, values, interpolation):
    """Keyframes a socket of one of the tree's nodes. values: (frame, value); interpolation: that of F-curve keys."""
    for frame, value in values:
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    path = socket.path_from_id("default_value")
    for curve in compat.curves_of(tree):
        if curve.data_path == path:
            for key in curve.keyframe_points:
                key.interpolation = interpolation


def add_group_socket(tree, in_out, kind, name, description="", default=None, least=None, most=None):
    """Adds an input or output socket to a node group (`tree.interface` from 4.0 on)."""
    if hasattr(tree, "interface"):
        socket = tree.interface.new_socket(name, description=description, in_out=in_out, socket_type=kind)
    else:
        socket = (tree.inputs if in_out == "INPUT" else tree.outputs).new(kind, name)
        socket.description = description
    if least is not None:
        socket.min_value, socket.max_value = least, most
    if default is not None:
        socket.default_value = default
    return socket


def group_sockets(tree, in_out):
    """{name: socket} of a node group's inputs or outputs."""
    if hasattr(tree, "interface"):
        items = [item for item in tree.interface.items_tree if getattr(item, "in_out", "") == in_out]
    else:
        items = tree.inputs if in_out == "INPUT" else tree.outputs
    return {item.name: item for item in items}


def noise_value(node):
    """The scalar output of a noise texture node: `Fac`, renamed `Factor` in 5.x."""
    return next(output for output in node.outputs if output.enabled and output.type == "VALUE")


def set_subsurface(tree, principled, weight, color, radius):
    """Links the weight of a Principled BSDF's subsurface and its radius in metres (sockets).

    Before 4.0 subsurface has a colour of its own.
    """
    inputs = principled.inputs
    if "Subsurface Weight" in inputs:
        tree.links.new(weight, inputs["Subsurface Weight"])
        inputs["Subsurface Scale"].default_value = 1.0
    else:
        tree.links.new(weight, inputs["Subsurface"])
        tree.links.new(color, inputs["Subsurface Color"])
    tree.links.new(radius, inputs["Subsurface Radius"])


def set_specular(principled, level):
    """The specular strength of a Principled BSDF; 0.5 is about that of glass or ice."""
    name = "Specular IOR Level" if "Specular IOR Level" in principled.inputs else "Specular"
    principled.inputs[name].default_value = level


def glossy(builder):
    """A node that mirrors (GGX). From 4.0 on, the anisotropic node takes the place of the glossy one."""
    if hasattr(bpy.types, "ShaderNodeBsdfGlossy"):
        return builder.node("ShaderNodeBsdfGlossy", distribution="GGX")
    node = builder.node("ShaderNodeBsdfAnisotropic", distribution="GGX")
    builder.feed(node, Anisotropy=0.0)
    return node
