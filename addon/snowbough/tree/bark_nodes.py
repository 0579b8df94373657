# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural bark: plates between furrows that run along the limb, as colour and as bump.

The map `bark` goes once around a limb and keeps its aspect ratio from trunk to twig. Rolled into a cylinder of radius
1, it gives coordinates for 3D textures without a seam along the limb and with the same density on twigs and trunk.
Plates are the cells of a Voronoi texture whose walls are distorted by noise (S. Worley, A Cellular Texture Basis
Function, 1996). Thinner, younger limbs have weaker plates and are smoother.
"""

import math

from ..base import compat_nodes
from ..base.names import BARK_UV, POINT_LEVEL_ATTRIBUTE
from ..base.node_builder import NodeBuilder

# Ends of the colour ramp.
FURROW, RIDGE = (0.034, 0.026, 0.02), (0.2, 0.165, 0.13)
# Plates per radius, and their ratio of length to width.
PLATES, LENGTH_TO_WIDTH = 3.0, 3.4
# Scale and strength, in radii, of the noise that distorts the walls: coarse and fine.
BENT, RAGGED = (0.9, 0.3), (5.0, 0.09)
# Furrows between plates, and cracks across them: scale relative to plates, width in cells, depth relative to furrows.
FURROWS, CRACKS = (1.0, 0.14, 1.0), (2.6, 0.12, 0.35)
# Scale and depth of the grain on plates.
GRAIN_SCALE, GRAIN = 9.0, 0.8
# Depth of the trunk's furrows in metres, and factor on depth and plates for each level of branches.
DEPTH, YOUNGER = 0.025, 0.5


def _place(builder):
    """The point's position on the rolled-up limb."""
    uv = builder.node("ShaderNodeUVMap", uv_map=BARK_UV)
    angle, along, _ = builder.components(builder.scale(uv.outputs["UV"], 2.0 * math.pi))
    return builder.combine(builder.math("COSINE", angle), builder.math("SINE", angle), along)


def _noise(builder, place, scale, detail, roughness=0.5):
    node = builder.node("ShaderNodeTexNoise")
    return builder.feed(node, Vector=place, Scale=scale, Detail=detail, Roughness=roughness)


def _moved(builder, place, scale, reach):
    """The position, moved by noise."""
    noise = _noise(builder, place, scale, 4.0)
    colour = next(output for output in noise.outputs if output.type == "RGBA")
    away = builder.vector("SUBTRACT", colour, (0.5, 0.5, 0.5))
    return builder.vector("MULTIPLY_ADD", away, (2.0 * reach,) * 3, place)


def _open(builder, place, scale, width, depth):
    """1 on the cells of a Voronoi texture, down to 1 - `depth` at their walls."""
    cells = builder.node("ShaderNodeTexVoronoi", feature="DISTANCE_TO_EDGE")
    builder.feed(cells, Vector=place, Scale=scale * PLATES)
    inside = builder.math("DIVIDE", cells.outputs["Distance"], width, clamp=True)
    # Steep at the wall, flat on the plate.
    return builder.multiply_add(builder.math("POWER", inside, 0.6), depth, 1.0 - depth)


def add_bark(tree, surface, ridge=None):
    """Adds nodes of bark to a material and links them to its Principled BSDF.

    tree: the material's node tree; surface: the Principled BSDF. ridge: the colour of the plates, linear RGB; the
    colour of the furrows follows from it.
    """
    builder = NodeBuilder(tree)
    ridge = ridge or RIDGE
    furrow = tuple(c * f / r for c, f, r in zip(ridge, FURROW, RIDGE))
    level = builder.node("ShaderNodeAttribute", attribute_name=POINT_LEVEL_ATTRIBUTE).outputs["Fac"]
    age = builder.math("POWER", YOUNGER, level)

    place = _place(builder)
    moved = _moved(builder, _moved(builder, place, *BENT), *RAGGED)
    long = builder.vector("MULTIPLY", moved, (1.0, 1.0, 1.0 / LENGTH_TO_WIDTH))
    plates = builder.multiply(_open(builder, long, *FURROWS), _open(builder, long, *CRACKS))
    # Young limbs have hardly any plates.
    hollow = builder.multiply(builder.subtract(1.0, plates), builder.math("POWER", age, 0.5))
    grain = compat_nodes.noise_value(_noise(builder, long, GRAIN_SCALE, 9.0, 0.65))
    height = builder.subtract(builder.multiply_add(grain, GRAIN, 1.0 - 0.5 * GRAIN), hollow)
    patches = compat_nodes.noise_value(_noise(builder, place, 0.55, 3.0))
    bright = builder.multiply_add(height, 0.8, builder.multiply_add(patches, 0.7, -0.35))

    ramp = builder.node("ShaderNodeValToRGB")
    builder.set(ramp.inputs[0], bright)
    ends = ramp.color_ramp.elements
    ends[0].position, ends[0].color = 0.1, (*furrow, 1.0)
    ends[1].position, ends[1].color = 0.95, (*ridge, 1.0)
    bump = builder.node("ShaderNodeBump")
    builder.feed(bump, Strength=1.0, Distance=builder.multiply(age, DEPTH), Height=height)
    builder.set(surface.inputs["Base Color"], ramp.outputs["Color"])
    builder.set(surface.inputs["Normal"], bump.outputs["Normal"])
