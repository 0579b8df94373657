# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group `Snowbough Snow`: the look of snow, mixed over a surface by its depth.

It uses only nodes that Cycles and EEVEE share, so files render without the add-on. Everything is fixed to the object by
the coordinate `Position`. The group is made once; later changes by the artist are kept.
"""

import bpy

from ..base import compat_nodes
from ..base.names import SNOW_GROUP
from ..base.node_builder import NodeBuilder
from .relief_nodes import add_lumps, add_relief, add_waves
from .wet_nodes import add_wet

# Light penetrates snow by some centimetres, red less than blue. Fresh snow has an albedo of about 0.9 and is nearly
# white (S. G. Warren, Optical Properties of Snow, Reviews of Geophysics 20, 1982).
SNOW_COLOR = (0.90, 0.93, 0.96, 1.0)
SUBSURFACE_RADIUS = (0.010, 0.013, 0.018)
# Depth in metres from which light scatters as in deep snow.
SCATTERING_DEPTH = 0.05

# Grains of the surface, as a bump of two octaves: waves per metre, height in metres.
GRAIN_SCALE, GRAIN_HEIGHT = 120.0, 0.0034
# Light that hollows lose and crests keep: least of the blue. Bumps have no shadows of their own, so without it snow
# would be blank under an overcast sky.
HOLLOWS = (0.26, 0.24, 0.20)
LIT = 0.97
# A thin dusting: grains per metre. Noise of patches, which are the lumps, and of grains says at which share of the full
# dusting a place is covered; a higher weight spreads them further from the edge. A grain is as soft as this share.
DUST_SCALE = 520.0
PATCHES, GRAINS = 0.35, 1.2
GRAIN_EDGE = 0.12
# Thin snow lets light through: its shadow is that of snow so much thinner. Otherwise its edge has a dark outline.
SHADE = 0.4
ROUGH = 0.65
# Glittering crystals: their size in metres, and as a share of the distance to the camera (about a pixel or two),
# whichever is more; the sizes are powers of two of the first. Their tilt, roughness and reflectance.
CRYSTAL, CRYSTAL_ANGLE = 0.0015, 0.0012
TILT, MIRROR, REFLECTANCE = 1.8, 0.25, 0.18
# Size of a crystal in its cell.
FACET = 0.55
# Cover of materials that show snow on the object itself.
NO_SURFACE = 1000.0

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
    ("Sparkle", "NodeSocketFloat", 0.6, 0.0, 1.0, "Share of glittering crystals (0 to 1)"),
    ("Relief", "NodeSocketFloat", 0.6, 0.0, 10.0, "Height of lumps, drifts and ripples; 0.6 is fresh snow"),
    ("Depth", "NodeSocketFloat", 0.1, 0.0, 1000.0, "Depth of snow on open ground at the end of the shot, with which "
     "drifts grow (metres)"),
    ("Wind", "NodeSocketVector", (0.0, 0.0, 0.0), None, None, "Level direction of the wind on the object. Its length "
     "is the strength of ripples (0 to 1)"),
    ("Wet", "NodeSocketFloat", 0.0, 0.0, 1.0, "Water in the surface: 0 is dry, 1 is soaked, dark and glossy"),
    ("Cover", "NodeSocketFloat", NO_SURFACE, 0.0, NO_SURFACE, "Height of the snow surface above the object. Where it "
     "is lower than Dusting, it shows as grains (metres)"),
    ("Joint", "NodeSocketFloat", 0.0, 0.0, 1.0, "Where the surface goes on within other snow: 1 lets no light enter"),
)  # fmt: skip
OUTPUTS = (
    ("Shader", "NodeSocketShader", "The material with snow on it"),
    ("Coverage", "NodeSocketFloat", "0 where the surface shows, 1 where snow hides it"),
    ("Thickness", "NodeSocketFloat", "Height with waves, for displacement (metres)"),
)


def _noise(tree, position, scale, more_octaves=0.0):
    node = tree.node("ShaderNodeTexNoise")
    tree.feed(node, Vector=position, Scale=scale, Detail=more_octaves, Roughness=0.5)
    return compat_nodes.noise_value(node)


def _coverage(tree, inputs, lumps, thickness, is_shadow):
    """The share of the surface that grains hide; on thin snow there are gaps between them. is_shadow: 1 for shadows."""
    grains = tree.math(
        "MULTIPLY_ADD", _noise(tree, inputs["Position"], DUST_SCALE), GRAINS, 0.5 - 0.5 * GRAINS
    )
    threshold = tree.math("MULTIPLY_ADD", lumps, PATCHES, grains)
    filled = tree.divide(tree.math("MINIMUM", thickness, inputs["Cover"]), inputs["Dusting"])
    filled = tree.multiply(filled, tree.math("MULTIPLY_ADD", is_shadow, SHADE - 1.0, 1.0))
    return tree.smoothstep(filled, tree.subtract(threshold, GRAIN_EDGE), tree.add(threshold, GRAIN_EDGE))


def _bumps(tree, inputs, lumps, thickness):
    """(normal, colour): bumps of grains and of waves, and the snow's colour, darker in hollows."""
    waves, crests = add_waves(tree, inputs["Position"], lumps, inputs["Normal"], thickness,
                              *(inputs[name] for name in ("Depth", "Wind", "Relief")))  # fmt: skip
    grains = _noise(tree, inputs["Position"], GRAIN_SCALE, 1.0)
    height = tree.multiply(inputs["Grain"], GRAIN_HEIGHT)
    node = tree.node("ShaderNodeBump")
    tree.feed(node, Strength=1.0, Distance=1.0, Normal=inputs["Normal"],
              Height=tree.math("MULTIPLY_ADD", grains, height, waves))  # fmt: skip
    light = tree.vector("MULTIPLY_ADD", crests, HOLLOWS, (LIT,) * 3)
    lit = tree.vector("MINIMUM", tree.vector("MULTIPLY", inputs["Color"], light), (1.0, 1.0, 1.0))
    return node.outputs["Normal"], lit


def _sparkle(tree, inputs, normal):
    """A shader: crystals with random orientation, each as large as a pixel or more, reflect the light."""
    distance = tree.output(tree.node("ShaderNodeCameraData"), "View Distance")
    times = tree.math("MAXIMUM", tree.multiply(distance, CRYSTAL_ANGLE / CRYSTAL), 1.0)
    times = tree.math("POWER", 2.0, tree.math("CEIL", tree.math("LOGARITHM", times, 2.0)))
    cells = tree.node("ShaderNodeTexVoronoi")
    tree.feed(cells, Vector=inputs["Position"], Scale=tree.divide(1.0 / CRYSTAL, times))
    color = tree.output(cells, "Color")
    chance = tree.math("FRACT", tree.vector("DOT_PRODUCT", color, (7.0, 11.0, 13.0)))
    chosen = tree.math("LESS_THAN", chance, inputs["Sparkle"])
    facet = tree.math("LESS_THAN", tree.output(cells, "Distance"), FACET)
    tilt = tree.scale(tree.vector("SUBTRACT", color, (0.5, 0.5, 0.5)), TILT)
    mirror = compat_nodes.glossy(tree)
    tree.feed(mirror, Roughness=MIRROR, Normal=tree.vector("NORMALIZE", tree.vector("ADD", normal, tilt)),
              Color=tree.scale((REFLECTANCE,) * 3, tree.multiply(chosen, facet)))  # fmt: skip
    return mirror.outputs[0]


def _fill(tree):
    builder = NodeBuilder(tree)
    group_input = builder.node("NodeGroupInput")
    inputs = {name: group_input.outputs[name] for name, *_ in INPUTS}
    thickness = builder.absolute(inputs["Height"])

    snow = builder.node("ShaderNodeBsdfPrincipled")
    snow.label = "Snow"
    lumps = add_lumps(builder, inputs["Position"])
    normal, color = _bumps(builder, inputs, lumps, thickness)
    builder.feed(snow, Base_Color=color, Normal=normal, Roughness=ROUGH)
    compat_nodes.set_specular(snow, 0.35)
    depth = builder.smoothstep(thickness, 0.0, SCATTERING_DEPTH)
    radius = builder.scale(SUBSURFACE_RADIUS, builder.math("MULTIPLY_ADD", depth, 0.9, 0.1))
    entering = builder.multiply(inputs["Subsurface"], builder.subtract(depth, inputs["Joint"]))
    compat_nodes.set_subsurface(tree, snow, builder.math("MAXIMUM", entering, 0.0), color, radius)
    glittering = builder.node("ShaderNodeAddShader")
    for socket, value in zip(glittering.inputs, (snow.outputs["BSDF"], _sparkle(builder, inputs, normal))):
        builder.set(socket, value)

    # Shadows and light that snow sends to other things need no details: this saves more than the details cost.
    path = builder.node("ShaderNodeLightPath")
    is_shadow, is_diffuse = (builder.output(path, f"Is {ray} Ray") for ray in ("Shadow", "Diffuse"))
    coverage = _coverage(builder, inputs, lumps, thickness, is_shadow)
    plain = builder.feed(builder.node("ShaderNodeBsdfDiffuse"), Color=inputs["Color"]).outputs[0]
    is_plain = builder.math("MAXIMUM", is_shadow, is_diffuse)
    shaded = builder.mixed(is_plain, glittering.outputs[0], plain)
    mixed = builder.mixed(coverage, inputs["Shader"], shaded)
    is_surface = builder.math("LESS_THAN", inputs["Cover"], NO_SURFACE)
    mixed = add_wet(builder, mixed, inputs["Wet"], coverage, is_surface)
    relief = add_relief(builder, inputs["Position"], thickness, inputs["Relief"])
    sign = builder.math("SIGN", inputs["Height"])
    displaced = builder.add(inputs["Height"], builder.multiply(relief, sign))
    group_output = builder.node("NodeGroupOutput")
    for name, value in (("Shader", mixed), ("Coverage", coverage), ("Thickness", displaced)):
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
