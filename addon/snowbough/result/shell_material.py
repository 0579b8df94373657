# SPDX-License-Identifier: GPL-3.0-or-later
"""The material of a snow shell: the snow of the scene's kind, over nothing."""

import bpy

from .. import compat
from ..node_builder import NodeBuilder
from ..scene.pose import metres_per_unit
from . import look, snow_nodes
from .shell_nodes import HEIGHT_ATTRIBUTE, POSITION_ATTRIBUTE

# In the Solid view, where all else is greyer.
SOLID_COLOR = (1.0, 1.0, 1.0, 1.0)
# Light goes through thinner snow than the first of these and not through thicker snow than the second, to what lies so
# far below at most (metres).
LIT_THROUGH = (0.006, 0.014)
BELOW = 0.03


def _light_through(builder, height, unit):
    """The share of light that gets through snow of this height (a socket, metres) to what it lies on, besides what
    falls between its grains. unit: of the scene, metres.

    A dusting lies on what it covers, but a shell lies a little above it: what shows between the grains would be in
    their shadow, and a dark line would run along the border of all snow.
    """
    path = builder.node("ShaderNodeLightPath").outputs
    near = builder.math("LESS_THAN", path["Ray Length"], BELOW / unit)
    from_below = builder.multiply(near, path["Is Diffuse Ray"])
    light = builder.math("MAXIMUM", path["Is Shadow Ray"], from_below)
    return builder.multiply(light, builder.smoothstep(height, *LIT_THROUGH, 1.0, 0.0))


def make_material(scene, name):
    """Snow of the scene's kind that thins out to nothing: its depth and its place come with the shell as
    attributes."""
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    material.diffuse_color = SOLID_COLOR
    material.roughness = snow_nodes.ROUGH
    material.node_tree.nodes.clear()
    builder = NodeBuilder(material.node_tree)

    def attribute(name, result):
        return builder.node("ShaderNodeAttribute", attribute_name=name).outputs[result]

    height = attribute(HEIGHT_ATTRIBUTE, "Fac")
    nothing = builder.node("ShaderNodeBsdfTransparent").outputs[0]
    group = builder.node("ShaderNodeGroup", node_tree=snow_nodes.ensure_group())
    look.set_group_inputs(group, look.of(scene))
    builder.feed(
        group,
        Height=height,
        Position=attribute(POSITION_ATTRIBUTE, "Vector"),
        Normal=builder.node("ShaderNodeNewGeometry").outputs["Normal"],
        Shader=nothing,
    )
    through = _light_through(builder, height, metres_per_unit(scene))
    mix = builder.node("ShaderNodeMixShader")
    for socket, value in zip(mix.inputs, (through, group.outputs["Shader"], nothing)):
        builder.set(socket, value)
    builder.feed(builder.node("ShaderNodeOutputMaterial"), Surface=mix.outputs[0])
    compat.set_alpha_clipping(material)
    return material
