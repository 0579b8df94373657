# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group `Snowbough Snow`: the look of snow, mixed over a surface by its depth.

It uses only nodes that Cycles and EEVEE share, so files render without the add-on. Everything is fixed to the object by
the coordinate `Position`. The group is made once; later changes by the artist are kept.
"""

import bpy

from ..base import compat_nodes
from ..base.names import SNOW_GROUP
from ..base.node_builder import NodeBuilder
from .relief_nodes import add_relief

# Light penetrates snow by some centimetres, red less than blue. Fresh snow has an albedo of about 0.9 and is nearly
# white (S. G. Warren, Optical Properties of Snow, Reviews of Geophysics 20, 1982).
SNOW_COLOR = (0.90, 0.93, 0.96, 1.0)
SUBSURFACE_RADIUS = (0.010, 0.013, 0.018)
# Depth in metres from which light scatters as in deep snow.
SCATTERING_DEPTH = 0.05

# Grains and lumps of the surface, as a bump: (waves per metre, amplitude in metres).
BUMPS = ((110.0, 0.0011), (420.0, 0.0004))
# Patches and grains of a thin dusting: waves per metre. A higher weight of patches spreads flecks further from the
# edge.
DUST_SCALES = (45.0, 520.0)
PATCHES, GRAINS = 0.2, 0.7
CRYSTALS = 650.0
# Share of crystals that reflect at full sparkle.
MOST_SPARKLE = 0.06
ROUGH, MIRROR = 0.65, 0.12

# name, socket type, default, minimum, maximum, tooltip
INPUTS = (
    ("Shader", "NodeSocketShader", None, None, None, "The object's own material"),
    ("Height", "NodeSocketFloat", 0.0, -1000.0, 1000.0, "Thickness of the snow (metres)"),
    ("Position", "NodeSocketVector", (0.0, 0.0, 0.0), None, None, "Undeformed position on the object (metres)"),
    ("Normal", "NodeSocketVector", (0.0, 0.0, 1.0), None, None, "Normal of the snow, in world space"),
    ("Color", "NodeSocketColor", SNOW_COLOR, None, None, "Colour of the snow"),
    ("Dusting", "NodeSocketFloat", 0.004, 1e-5, 1.0, "Depth at which snow hides the surface. Thinner snow shows the "
     "surface between its grains (metres)"),
    ("Grain", "NodeSocketFloat", 1.0, 0.0, 4.0, "Height of the bumps of grains and lumps; 1 is fresh snow"),
    ("Subsurface", "NodeSocketFloat", 0.4, 0.0, 1.0, "Share of light that enters deep snow (0 to 1)"),
    ("Sparkle", "NodeSocketFloat", 0.3, 0.0, 1.0, "Share of glittering crystals (0 to 1)"),
    ("Relief", "NodeSocketFloat", 1.0, 0.0, 10.0, "Height of the waves in materials that displace; 0.6 is fresh snow"),
)  # fmt: skip
OUTPUTS = (
    ("Shader", "NodeSocketShader", "The material with snow on it"),
    ("Coverage", "NodeSocketFloat", "0 where the surface shows, 1 where snow hides it"),
    ("Thickness", "NodeSocketFloat", "Height with waves, for displacement (metres)"),
)


def _noise(tree, position, scale, detail=0.0):
    node = tree.node("ShaderNodeTexNoise")
    tree.feed(node, Vector=position, Scale=scale, Detail=detail)
    return compat_nodes.noise_value(node)


def _coverage(tree, inputs, thickness):
    """The share of the surface that grains hide; on thin snow there are gaps between grains."""
    patches, grains = (_noise(tree, inputs["Position"], scale, 2.0) for scale in DUST_SCALES)
    threshold = tree.add(tree.multiply(patches, PATCHES), tree.multiply(grains, GRAINS))
    filled = tree.divide(thickness, inputs["Dusting"])
    return tree.smoothstep(filled, tree.subtract(threshold, 0.35), tree.add(threshold, 0.35))


def _grain(tree, inputs):
    """The normal, with bumps of grains."""
    height = None
    for waves, metres in BUMPS:
        wave = tree.multiply(_noise(tree, inputs["Position"], waves, 1.0), 2.0 * metres)
        height = wave if height is None else tree.add(height, wave)
    node = tree.node("ShaderNodeBump")
    tree.feed(node, Strength=1.0, Distance=1.0, Height=tree.multiply(height, inputs["Grain"]),
              Normal=inputs["Normal"])  # fmt: skip
    return node.outputs["Normal"]


def _sparkle(tree, inputs, normal):
    """(roughness, normal): single crystals with random orientation reflect the light."""
    cells = tree.node("ShaderNodeTexVoronoi")
    tree.feed(cells, Vector=inputs["Position"], Scale=CRYSTALS)
    color = tree.output(cells, "Color")
    chance = tree.components(color)[0]
    mirrors = tree.math("LESS_THAN", chance, tree.multiply(inputs["Sparkle"], MOST_SPARKLE))
    turned = tree.vector("SUBTRACT", color, (0.5, 0.5, 0.5))
    tilt = tree.scale(tree.vector("MULTIPLY", turned, (0.0, 1.2, 1.2)), mirrors)
    facing = tree.vector("NORMALIZE", tree.vector("ADD", normal, tilt))
    return tree.math("MULTIPLY_ADD", mirrors, MIRROR - ROUGH, ROUGH), facing


def _fill(tree):
    builder = NodeBuilder(tree)
    group_input = builder.node("NodeGroupInput")
    inputs = {name: group_input.outputs[name] for name, *_ in INPUTS}
    thickness = builder.absolute(inputs["Height"])

    snow = builder.node("ShaderNodeBsdfPrincipled")
    snow.label = "Snow"
    roughness, normal = _sparkle(builder, inputs, _grain(builder, inputs))
    builder.feed(snow, Base_Color=inputs["Color"], Normal=normal, Roughness=roughness)
    compat_nodes.set_specular(snow, 0.35)
    depth = builder.smoothstep(thickness, 0.0, SCATTERING_DEPTH)
    radius = builder.scale(SUBSURFACE_RADIUS, builder.math("MULTIPLY_ADD", depth, 0.9, 0.1))
    compat_nodes.set_subsurface(
        tree, snow, builder.multiply(inputs["Subsurface"], depth), inputs["Color"], radius
    )

    coverage = _coverage(builder, inputs, thickness)
    mix = builder.node("ShaderNodeMixShader")
    for socket, value in zip(mix.inputs, (coverage, inputs["Shader"], snow.outputs["BSDF"])):
        builder.set(socket, value)
    relief = add_relief(builder, inputs["Position"], thickness, inputs["Relief"])
    sign = builder.math("SIGN", inputs["Height"])
    displaced = builder.add(inputs["Height"], builder.multiply(relief, sign))
    group_output = builder.node("NodeGroupOutput")
    for name, value in (("Shader", mix.outputs[0]), ("Coverage", coverage), ("Thickness", displaced)):
        builder.set(group_output.inputs[name], value)


def _is_current(tree):
    return all(name in compat_nodes.group_sockets(tree, "INPUT") for name, *_ in INPUTS)


def ensure_group():
    """The node group of this file, made on first use. Returns a ShaderNodeTree.

    A group of an earlier version, with other inputs, is renamed and stays in its materials."""
    tree = next(
        (group for group in bpy.data.node_groups if group.name == SNOW_GROUP and not group.library), None
    )
    if tree is not None and not _is_current(tree):
        tree.name = f"{SNOW_GROUP} (before)"
        tree = None
    if tree is None:
        tree = bpy.data.node_groups.new(SNOW_GROUP, "ShaderNodeTree")
        for name, kind, default, least, most, description in INPUTS:
            compat_nodes.add_group_socket(tree, "INPUT", kind, name, description, default, least, most)
        for name, kind, description in OUTPUTS:
            compat_nodes.add_group_socket(tree, "OUTPUT", kind, name, description)
        _fill(tree)
    return tree
