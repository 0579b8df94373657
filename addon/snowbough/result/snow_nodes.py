# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group `Snowbough Snow`: how snow looks, mixed over a surface by its depth.

Plain nodes only, so that files render without the add-on. The group is made once and then belongs to
the artist: changes to it are kept.
"""

import bpy

from .. import compat
from ..names import SNOW_GROUP

# Light enters snow some centimetres deep, red less than blue; albedo of fresh snow about 0.9 and
# nearly white (S. G. Warren, Optical Properties of Snow, Reviews of Geophysics 20, 1982).
SNOW_COLOR = (0.90, 0.93, 0.96, 1.0)
SUBSURFACE_RADIUS = (0.010, 0.013, 0.018)

# name, socket type, default, least, most, tooltip
INPUTS = (
    ("Shader", "NodeSocketShader", None, None, None, "The object's own material"),
    (
        "Height",
        "NodeSocketFloat",
        0.0,
        -1000.0,
        1000.0,
        "Thickness of the snow, negative on the back (metres)",
    ),
    ("Edge Depth", "NodeSocketFloat", 0.006, 1e-5, 10.0, "Depth at which snow hides the surface (metres)"),
    ("Edge Noise", "NodeSocketFloat", 0.6, 0.0, 1.0, "How ragged the edge of the snow is (0 to 1)"),
    ("Edge Noise Scale", "NodeSocketFloat", 60.0, 0.0, 1e5, "Flecks of the edge (per metre)"),
    ("Color", "NodeSocketColor", SNOW_COLOR, None, None, "Colour of the snow"),
    ("Subsurface", "NodeSocketFloat", 0.25, 0.0, 1.0, "Share of the light that enters the snow (0 to 1)"),
    ("Sparkle", "NodeSocketFloat", 0.3, 0.0, 1.0, "Share of glittering crystals (0 to 1)"),
    ("Sparkle Scale", "NodeSocketFloat", 900.0, 1.0, 1e6, "Crystals (per metre)"),
    ("Normal", "NodeSocketVector", (0.0, 0.0, 1.0), None, None, "Normal of the snow, in world space"),
)
OUTPUTS = (
    ("Shader", "NodeSocketShader", "The material with snow on it"),
    ("Coverage", "NodeSocketFloat", "0 where the surface shows, 1 where snow hides it"),
)


def _edge(tree, inputs):
    """Coverage from the height, on either side: a smooth step over the edge depth, made ragged by noise."""
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(coordinates.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(inputs["Edge Noise Scale"], noise.inputs["Scale"])

    # factor = 1 + edge noise * (2 * noise - 1), so that the mean depth of the edge stays
    centred = tree.nodes.new("ShaderNodeMath")
    centred.operation = "MULTIPLY_ADD"
    centred.inputs[1].default_value, centred.inputs[2].default_value = 2.0, -1.0
    tree.links.new(compat.noise_value(noise), centred.inputs[0])
    factor = tree.nodes.new("ShaderNodeMath")
    factor.operation = "MULTIPLY_ADD"
    factor.inputs[2].default_value = 1.0
    tree.links.new(centred.outputs[0], factor.inputs[0])
    tree.links.new(inputs["Edge Noise"], factor.inputs[1])
    thickness = tree.nodes.new("ShaderNodeMath")
    thickness.operation = "ABSOLUTE"
    tree.links.new(inputs["Height"], thickness.inputs[0])
    depth = tree.nodes.new("ShaderNodeMath")
    depth.operation = "MULTIPLY"
    tree.links.new(thickness.outputs[0], depth.inputs[0])
    tree.links.new(factor.outputs[0], depth.inputs[1])

    step = tree.nodes.new("ShaderNodeMapRange")
    step.interpolation_type = "SMOOTHSTEP"
    tree.links.new(depth.outputs[0], step.inputs["Value"])
    tree.links.new(inputs["Edge Depth"], step.inputs["From Max"])
    return step.outputs["Result"]


def _roughness(tree, inputs):
    """Rough snow with single crystals that mirror the light."""
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    cells = tree.nodes.new("ShaderNodeTexVoronoi")
    tree.links.new(coordinates.outputs["Object"], cells.inputs["Vector"])
    tree.links.new(inputs["Sparkle Scale"], cells.inputs["Scale"])
    channels = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(cells.outputs["Color"], channels.inputs[0])
    # At full sparkle every tenth crystal mirrors.
    share = tree.nodes.new("ShaderNodeMath")
    share.operation = "MULTIPLY"
    share.inputs[1].default_value = 0.1
    tree.links.new(inputs["Sparkle"], share.inputs[0])
    mirror = tree.nodes.new("ShaderNodeMath")
    mirror.operation = "LESS_THAN"
    tree.links.new(channels.outputs[0], mirror.inputs[0])
    tree.links.new(share.outputs[0], mirror.inputs[1])
    roughness = tree.nodes.new("ShaderNodeMapRange")
    roughness.inputs["To Min"].default_value = 0.8
    roughness.inputs["To Max"].default_value = 0.15
    tree.links.new(mirror.outputs[0], roughness.inputs["Value"])
    return roughness.outputs["Result"]


def _fill(tree):
    group_input = tree.nodes.new("NodeGroupInput")
    group_output = tree.nodes.new("NodeGroupOutput")
    inputs = {name: group_input.outputs[name] for name, *_ in INPUTS}

    snow = tree.nodes.new("ShaderNodeBsdfPrincipled")
    snow.label = "Snow"
    tree.links.new(inputs["Color"], snow.inputs["Base Color"])
    tree.links.new(inputs["Normal"], snow.inputs["Normal"])
    tree.links.new(_roughness(tree, inputs), snow.inputs["Roughness"])
    compat.set_subsurface(tree, snow, inputs["Subsurface"], inputs["Color"], SUBSURFACE_RADIUS)

    coverage = _edge(tree, inputs)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(coverage, mix.inputs[0])
    tree.links.new(inputs["Shader"], mix.inputs[1])
    tree.links.new(snow.outputs["BSDF"], mix.inputs[2])
    tree.links.new(mix.outputs[0], group_output.inputs["Shader"])
    tree.links.new(coverage, group_output.inputs["Coverage"])
    _arrange(tree)


def _arrange(tree):
    """Puts nodes in columns by their distance from the output, so that the group can be read."""
    depth = {node: 0 for node in tree.nodes}
    for _ in tree.nodes:
        for link in tree.links:
            depth[link.from_node] = max(depth[link.from_node], depth[link.to_node] + 1)
    rows = {}
    for node in tree.nodes:
        row = rows.get(depth[node], 0)
        node.location = (-240 * depth[node], -320 * row)
        rows[depth[node]] = row + 1


def ensure_group():
    """The node group of this file, made on first use. Returns a ShaderNodeTree."""
    tree = next(
        (group for group in bpy.data.node_groups if group.name == SNOW_GROUP and not group.library), None
    )
    if tree is None:
        tree = bpy.data.node_groups.new(SNOW_GROUP, "ShaderNodeTree")
        for name, kind, default, least, most, description in INPUTS:
            compat.add_group_socket(tree, "INPUT", kind, name, description, default, least, most)
        for name, kind, description in OUTPUTS:
            compat.add_group_socket(tree, "OUTPUT", kind, name, description)
        _fill(tree)
    return tree
