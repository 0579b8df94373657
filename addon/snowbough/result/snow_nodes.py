# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group `Snowbough Snow`: how snow looks, mixed over a surface by its depth.

Plain nodes only, so that files render without the add-on, and only such as Cycles and EEVEE have in common. Everything
is fixed to the object: the coordinate `Position` goes with it. The group is made once and then belongs to the artist:
changes to it are kept.
"""

import bpy

from .. import compat_nodes
from ..names import SNOW_GROUP
from ..node_builder import NodeBuilder
from .relief_nodes import OCTAVES, add_relief

# Light enters snow some centimetres deep, red less than blue; albedo of fresh snow about 0.9 and
# nearly white (S. G. Warren, Optical Properties of Snow, Reviews of Geophysics 20, 1982).
SNOW_COLOR = (0.90, 0.93, 0.96, 1.0)
SUBSURFACE_RADIUS = (0.010, 0.013, 0.018)
# From this depth on light is scattered as in deep snow (metres).
SCATTERING_DEPTH = 0.05

# Grains and lumps of the surface, as a bump: (waves a metre, metres up and down).
BUMPS = ((110.0, 0.0011), (420.0, 0.0004))
# Patches and grains of a thin dusting: waves a metre. What patches count decides how far flecks stray from the edge.
DUST_SCALES = (45.0, 520.0)
PATCHES, GRAINS = 0.2, 0.7
CRYSTALS = 650.0
# The share of crystals that mirror at full sparkle.
MOST_SPARKLE = 0.06
ROUGH, MIRROR = 0.65, 0.12

# name, socket type, default, least, most, tooltip
INPUTS = (
    ("Shader", "NodeSocketShader", None, None, None, "The object's own material"),
    ("Height", "NodeSocketFloat", 0.0, -1000.0, 1000.0, "Thickness of the snow (metres)"),
    ("Position", "NodeSocketVector", (0.0, 0.0, 0.0), None, None, "Place on the object, undeformed (metres)"),
    ("Normal", "NodeSocketVector", (0.0, 0.0, 1.0), None, None, "Normal of the snow, in world space"),
    ("Color", "NodeSocketColor", SNOW_COLOR, None, None, "Colour of the snow"),
    ("Dusting", "NodeSocketFloat", 0.004, 1e-5, 1.0, "Depth at which snow hides the surface; less shows it "
     "between the grains (metres)"),
    ("Grain", "NodeSocketFloat", 1.0, 0.0, 4.0, "Bumps of grains and lumps; 1 is fresh snow"),
    ("Subsurface", "NodeSocketFloat", 0.4, 0.0, 1.0, "Share of the light that enters deep snow (0 to 1)"),
    ("Sparkle", "NodeSocketFloat", 0.3, 0.0, 1.0, "Share of glittering crystals (0 to 1)"),
    ("Relief", "NodeSocketFloat", 1.0, 0.0, 10.0, "Relief of materials that displace; fresh snow has 0.6"),
)  # fmt: skip
OUTPUTS = (
    ("Shader", "NodeSocketShader", "The material with snow on it"),
    ("Coverage", "NodeSocketFloat", "0 where the surface shows, 1 where snow hides it"),
    ("Thickness", "NodeSocketFloat", "Height with relief, for displacement (metres)"),
)


def _noise(tree, position, scale, detail=0.0):
    node = tree.node("ShaderNodeTexNoise")
    tree.feed(node, Vector=position, Scale=scale, Detail=detail)
    return compat_nodes.noise_value(node)


def _coverage(tree, inputs, thickness):
    """The share of the surface that grains hide: on thin snow some are there and others are not."""
    patches, grains = (_noise(tree, inputs["Position"], scale, 2.0) for scale in DUST_SCALES)
    threshold = tree.add(tree.multiply(patches, PATCHES), tree.multiply(grains, GRAINS))
    filled = tree.divide(thickness, inputs["Dusting"])
    return tree.smoothstep(filled, tree.subtract(threshold, 0.35), tree.add(threshold, 0.35))


def _grain(tree, inputs):
    """The normal with grains on it."""
    height = None
    for waves, metres in BUMPS:
        wave = tree.multiply(_noise(tree, inputs["Position"], waves, 1.0), 2.0 * metres)
        height = wave if height is None else tree.add(height, wave)
    node = tree.node("ShaderNodeBump")
    tree.feed(node, Strength=1.0, Distance=1.0, Height=tree.multiply(height, inputs["Grain"]),
              Normal=inputs["Normal"])  # fmt: skip
    return node.outputs["Normal"]


def _sparkle(tree, inputs, normal):
    """(roughness, normal): single crystals, turned any way, mirror the light."""
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
    relief = add_relief(builder, inputs["Position"], thickness, inputs["Relief"], OCTAVES)
    sign = builder.math("SIGN", inputs["Height"])
    displaced = builder.add(inputs["Height"], builder.multiply(relief, sign))
    group_output = builder.node("NodeGroupOutput")
    for name, value in (("Shader", mix.outputs[0]), ("Coverage", coverage), ("Thickness", displaced)):
        builder.set(group_output.inputs[name], value)


def _is_current(tree):
    return all(name in compat_nodes.group_sockets(tree, "INPUT") for name, *_ in INPUTS)


def ensure_group():
    """The node group of this file, made on first use. Returns a ShaderNodeTree.

    One of an earlier version, with other inputs, keeps the materials it is in, under another name."""
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
