# SPDX-License-Identifier: GPL-3.0-or-later
"""Shorthand for building shader node trees: nodes, links, arithmetic, named inputs.

Values are numbers, tuples or output sockets; a socket is linked and anything else becomes the input's default.
"""

import bpy

COLUMN = 190
ROW = 180


class NodeBuilder:
    """Adds nodes to a tree, from left to right in the order of the calls."""

    def __init__(self, tree):
        self.tree = tree
        self._column = 0

    def node(self, kind, **properties):
        node = self.tree.nodes.new(kind)
        node.location = (COLUMN * self._column, -ROW * (self._column % 3))
        self._column += 1
        for name, value in properties.items():
            setattr(node, name, value)
        return node

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def feed(self, node, **inputs):
        """Sets the enabled inputs with those names, `_` for a blank. Returns the node.

        A socket that later Blender versions rename is found by its identifier.
        """
        for name, value in inputs.items():
            wanted = name.replace("_", " ").strip()
            enabled = [socket for socket in node.inputs if socket.enabled]
            named = [socket for socket in enabled if socket.name == wanted]
            self.set((named or [socket for socket in enabled if socket.identifier == wanted])[0], value)
        return node

    def output(self, node, name=None):
        """The node's first enabled output, or the one of that name."""
        return next(s for s in node.outputs if s.enabled and name in (None, s.name))

    # -- numbers ---------------------------------------------------------------------------------------

    def math(self, operation, *values, clamp=False):
        node = self.node("ShaderNodeMath", operation=operation, use_clamp=clamp)
        for socket, value in zip(node.inputs, values):
            self.set(socket, value)
        return node.outputs[0]

    def add(self, a, b):
        return self.math("ADD", a, b)

    def subtract(self, a, b):
        return self.math("SUBTRACT", a, b)

    def multiply(self, a, b):
        return self.math("MULTIPLY", a, b)

    def divide(self, a, b):
        return self.math("DIVIDE", a, b)

    def multiply_add(self, a, b, c):
        """a times b, plus c."""
        return self.math("MULTIPLY_ADD", a, b, c)

    def absolute(self, a):
        return self.math("ABSOLUTE", a)

    def smoothstep(self, value, low, high, start=0.0, end=1.0):
        """From `start` at low to `end` at high, without a corner at either."""
        node = self.node("ShaderNodeMapRange", interpolation_type="SMOOTHSTEP")
        self.feed(node, Value=value, From_Min=low, From_Max=high, To_Min=start, To_Max=end)
        return node.outputs[0]

    # -- vectors ---------------------------------------------------------------------------------------

    def vector(self, operation, *values):
        """A vector operation; returns a number for DOT_PRODUCT and LENGTH, else a vector."""
        node = self.node("ShaderNodeVectorMath", operation=operation)
        for socket, value in zip(node.inputs, values):
            self.set(socket, value)
        return self.output(node)

    def scale(self, vector, factor):
        node = self.node("ShaderNodeVectorMath", operation="SCALE")
        self.set(node.inputs[0], vector)
        self.set(node.inputs["Scale"], factor)
        return node.outputs[0]

    def components(self, vector):
        node = self.node("ShaderNodeSeparateXYZ")
        self.set(node.inputs[0], vector)
        return node.outputs[:3]

    def combine(self, x, y, z):
        node = self.node("ShaderNodeCombineXYZ")
        for socket, value in zip(node.inputs, (x, y, z)):
            self.set(socket, value)
        return node.outputs[0]

    # -- shaders ---------------------------------------------------------------------------------------

    def mixed(self, factor, first, second):
        """The first shader at factor 0, the second at 1."""
        node = self.node("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (factor, first, second)):
            self.set(socket, value)
        return node.outputs[0]
