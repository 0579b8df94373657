# SPDX-License-Identifier: GPL-3.0-or-later
"""The material of a snow surface: the scene's kind of snow, with its depth from the baked maps."""

import json

import bpy

from ..base import compat
from ..base.names import SURFACE_BARE_ATTRIBUTE, SURFACE_JOINT_ATTRIBUTE, SURFACE_POSITION_ATTRIBUTE
from ..base.node_builder import NodeBuilder
from . import look, snow_nodes

# Colour in the Solid view, where other objects are greyer.
SOLID_COLOR = (1.0, 1.0, 1.0, 1.0)
# Minimum depth for the material, in metres: its edges dissolve by the height of the mesh, not by the map.
MATERIAL_DEPTH = 0.02
# Depth of bare parts of the mesh below the receiver, in metres.
BARE_DEPTH = 0.001
# Initial values of the material's sliders, as JSON. A new bake keeps the sliders that the artist has changed.
_RECORD = "snowbough_sliders"


def _cover(builder, scale):
    """Height of the mesh above its receiver, in metres."""
    shown = builder.node("ShaderNodeTexCoord").outputs["Object"]
    bare = builder.node("ShaderNodeAttribute", attribute_name=SURFACE_BARE_ATTRIBUTE).outputs["Vector"]
    raised = builder.vector("MULTIPLY", builder.vector("SUBTRACT", shown, bare), scale)
    return builder.subtract(builder.vector("LENGTH", raised), BARE_DEPTH)


def _texel(builder, sequence, uv_map):
    """The value of a BakedSequence on the surface."""
    place = builder.node("ShaderNodeUVMap", uv_map=uv_map).outputs[0]
    texture = builder.node("ShaderNodeTexImage", image=sequence.image, extension="EXTEND")
    sequence.configure(texture.image_user)
    return builder.feed(texture, Vector=place).outputs["Color"]


def make_material(scene, name, sequence, uv_map, snowfall, wet=None):
    """A material with the scene's kind of snow. sequence, wet: the BakedSequences of heights and of water, or None;
    uv_map: UV map of the surface's mesh; snowfall: Snowfall.

    The last millimetres of snow (slider Dusting) dissolve into grains, if the receiver keeps its shape: on others, the
    height above the receiver is unknown.
    """
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    material.diffuse_color = SOLID_COLOR
    material.roughness = snow_nodes.ROUGH
    material.node_tree.nodes.clear()
    builder = NodeBuilder(material.node_tree)
    depth = MATERIAL_DEPTH
    if sequence is not None:
        depth = builder.math("MAXIMUM", builder.absolute(_texel(builder, sequence, uv_map)), MATERIAL_DEPTH)
    place = builder.node("ShaderNodeAttribute", attribute_name=SURFACE_POSITION_ATTRIBUTE).outputs["Vector"]
    group = builder.node("ShaderNodeGroup", node_tree=snow_nodes.ensure_group())
    look.set_group_inputs(group, look.of(scene))
    builder.feed(
        group,
        Height=depth,
        Position=builder.vector("MULTIPLY", place, snowfall.scale),
        Normal=builder.node("ShaderNodeNewGeometry").outputs["Normal"],
        Depth=snowfall.depth,
        Wind=snowfall.wind,
        Joint=builder.node("ShaderNodeAttribute", attribute_name=SURFACE_JOINT_ATTRIBUTE).outputs["Fac"],
    )
    if wet is not None:
        builder.feed(group, Wet=_texel(builder, wet, uv_map))
    if snowfall.is_rigid:
        clear = builder.node("ShaderNodeBsdfTransparent").outputs[0]
        builder.feed(group, Shader=clear, Cover=_cover(builder, snowfall.scale))
        compat.set_alpha_clipping(material)
    output = builder.node("ShaderNodeOutputMaterial")
    builder.feed(output, Surface=group.outputs["Shader"])
    if "Thickness" in output.inputs:  # EEVEE from 4.2 on
        builder.set(output.inputs["Thickness"], depth)
    material[_RECORD] = json.dumps(_sliders(material))
    return material


def _sliders(material):
    values = {}
    for node in look.group_nodes(material):
        for socket in node.inputs:
            if not socket.is_linked and socket.type in ("VALUE", "RGBA", "VECTOR"):
                value = socket.default_value
                values[socket.name] = float(value) if socket.type == "VALUE" else list(value)
    return values


def touched(material):
    """{name: value} of the sliders that differ from their initial values."""
    begun = json.loads(material.get(_RECORD, "{}"))
    return {name: value for name, value in _sliders(material).items() if begun.get(name) != value}


def put_back(material, values):
    """Sets sliders. values: result of touched() for another material."""
    for node in look.group_nodes(material):
        for name, value in values.items():
            if name in node.inputs:
                node.inputs[name].default_value = value
