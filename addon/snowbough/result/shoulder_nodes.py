# SPDX-License-Identifier: GPL-3.0-or-later
"""The shoulders of snow at the rims of what carries it: upright and round, a little out over the rim.

A map holds one thickness a place, so snow that ends at a rim ends there as a slope at its angle of repose. Lying snow
holds together and has a steep, round front. These nodes draw the slope out towards its rim. With d the distance from
the rim, h the thickness and s the slope of the snow's own surface, s d / h is 1 on a slope that begins at the rim and
0 on level snow; a bank that ends somewhere else is far from any rim for its thickness. Of the snow elsewhere only this
is asked: how thick the map has it at three places behind a point, farther from its rim. The point's own part of that
says where on the front's round profile it belongs, and both change as smoothly over the shot as the map does.

A smooth surface has no rim: as it gets steeper, its snow thins out to nothing. There snow ends in a lip (add_lips).
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

from .. import compat_nodes

# The slider of shells; 0 leaves slopes as the map has them.
SHOULDERS_INPUT = "Shoulders"

# Edges with a larger angle between their faces are rims where the surface falls off beyond them (radians).
RIM_ANGLE = 0.6
# s d / h from which a point is drawn out, and from which on it is drawn all the way.
BEGINS, COMPLETE = 0.4, 1.1
# Distances to the rim, in parts of the thickness, from which on and beyond which it means less and nothing.
FAR, FARTHER = 2.1, 2.7
# What a slope from the first to the second of these adds to s d / h, since snow has some thickness at the rim itself.
SLOPES = (0.2, 0.9)
FOOT = 0.5
# What s d / h gains, at most, on a surface that falls towards its rim: at eaves snow at its angle of repose is less
# steep beside the roof. And cosines of walls, which gain nothing, and of roofs.
EAVES = 2.0
ROOFS = (0.2, 0.5)
# Cosine between the snow's own normal and the surface's from which it counts, and from which it counts fully.
UNFOLDED = (0.1, 0.3)
# Cosine between a slope's direction and the rim's from which it counts, and from which it counts fully; and the sine of
# its fall in that direction.
TOWARDS = (0.35, 0.75)
FALLS = (0.1, 0.35)
# The same sine of the surface's own fall, negative where it rises.
RISES = (-0.3, -0.1)
# Nearer to the rim than this, in parts of the thickness, a slope's direction counts less.
AT_RIM = 0.1
# The farthest that a point is drawn, in parts of its thickness.
MOST = 2.4
FARTHEST = 1e6
# How far snow reaches out over its rim and by how much that varies along it, in parts of its thickness, and how many
# waves a metre that has.
REACH = 0.26
VARIATION = 0.25
WAVES = 6.0
# How far behind a point the full thickness of its snow is looked for, in depths of the open ground, and what that gains
# on a surface that falls towards its rim; and at which parts of this way.
INNER, INNER_EAVES = 0.7, 3.0
INNER_PARTS = (0.25, 0.5, 1.0)
# The profile of a front, in parts of that thickness: up to where it is upright, how wide its round top is, and how far
# its foot leans out on its way up.
BRIM, ROUND, FLARE = 0.35, 0.5, 0.5
# From which part of that thickness on a front passes into what lies behind it, and what that gains at eaves.
TOP, TOP_EAVES = 0.8, 0.3
# How thick snow is, at most, behind a crest that stays, and behind a slope that is drawn out, in parts of its own.
CREST = (0.6, 0.95)
# Lips: how much thicker snow may end on steep smooth surfaces, in parts of the open ground's depth and of how thick
# what carries it is; and the surface's cosine below which it begins to, and below which it does fully.
LIP, LIP_OF_SUPPORT = 0.2, 0.16
LIP_SLOPES = (0.96, 0.75)
# Cosines of walls, which hold no snow for lips, and from which on there are lips.
LIP_WALLS = (0.1, 0.3)
# Snow as deep as the first of these lips counts less, and from the second on it is as thick as its map says.
LIP_DEPTHS = (2.0, 7.0)
# Thinner than this it is frost and ends thinly (metres).
FROST = 0.005
# The least cosine between the snow's own normal and the surface's that slopes are taken from.
STEEPEST = 0.08


@dataclass(frozen=True)
class Inner:
    """What a point asks about the snow behind it, farther from its rim."""

    open_depth: object
    """Of the snow on open ground, metres."""
    thickness: Callable
    """How thick snow lies (metres) where a way in metres leads to from a point's place on the bare surface."""


def rims(builder, geometry, sharp):
    """The rims of a mesh as edges without faces: of its `sharp` edges (a field) the convex and the open ones. Smooth
    surfaces have none: snow thins out on them as the surface gets steeper."""
    neighbours = builder.node("GeometryNodeInputMeshEdgeNeighbors").outputs[0]
    angle = builder.node("GeometryNodeInputMeshEdgeAngle").outputs["Signed Angle"]
    falls_off = builder.math(
        "MAXIMUM",
        builder.math("GREATER_THAN", angle, RIM_ANGLE),
        builder.math("LESS_THAN", neighbours, 1.5),
    )
    node = builder.node("GeometryNodeSeparateGeometry", domain="EDGE")
    return builder.feed(node, Geometry=geometry, Selection=builder.multiply(falls_off, sharp)).outputs[
        "Selection"
    ]


def way_to(builder, rim_edges, position):
    """The way from a position to the nearest rim, in units of the scene; FARTHEST upwards where there are none."""
    node = builder.node("GeometryNodeProximity", target_element="EDGES")
    builder.feed(node, Target=rim_edges, Source_Position=position)
    way = builder.vector("SUBTRACT", node.outputs["Position"], position)
    size = builder.node("GeometryNodeAttributeDomainSize", component="MESH")
    builder.feed(size, Geometry=rim_edges)
    none = builder.math("LESS_THAN", size.outputs["Edge Count"], 0.5)
    return builder.vector("ADD", way, builder.combine(0.0, 0.0, builder.multiply(none, FARTHEST)))


def add_lips(builder, thickness, upright, support, open_depth, strength):
    """What the thickness is to be multiplied by, a socket: on a smooth steep surface snow thins out to nothing by its
    map, but what lies holds together and ends in a round lip, as a drop does: a thickness h is shown as
    sqrt(h^2 + 2 l h), which begins upright, with l the lip's.

    thickness, support (of what carries it), open_depth: metres, not negative. upright: cosine of the surface's
    steepness. strength: 1 is fresh snow.
    """
    most = builder.math(
        "MINIMUM", builder.multiply(open_depth, LIP), builder.multiply(support, LIP_OF_SUPPORT)
    )
    steep = builder.multiply(
        builder.smoothstep(upright, *LIP_SLOPES), builder.smoothstep(upright, *LIP_WALLS)
    )
    lip = builder.math("MAXIMUM", builder.multiply(builder.multiply(most, strength), steep), 1e-6)
    begun = builder.smoothstep(thickness, 0.0, FROST)
    parts = builder.divide(thickness, lip)
    ended = builder.smoothstep(parts, *LIP_DEPTHS, 1.0, 0.0)
    inverse = builder.divide(1.0, builder.math("MAXIMUM", parts, 1e-4))
    grown = builder.math("SQRT", builder.math("MULTIPLY_ADD", inverse, 2.0, 1.0))
    return builder.math("MULTIPLY_ADD", builder.subtract(grown, 1.0), builder.multiply(begun, ended), 1.0)


def near_rim(builder, to_rim, thickness):
    """Whether add_shoulders moves a point at all: 1 or 0."""
    reach = builder.multiply(builder.math("MAXIMUM", thickness, 1e-6), FARTHER)
    return builder.math("LESS_THAN", builder.vector("LENGTH", to_rim), reach)


def add_shoulders(builder, to_rim, thickness, inner, risen, normal, own_normal, place, strength):
    """The way by which a point of the snow's surface is drawn out over its rim, in metres; a vector.

    to_rim: the way to the nearest rim, metres. thickness: metres, not negative. inner: the Inner of the snow, or None,
    with which fronts have sharp brims. risen: the way from the bare surface, metres. normal, own_normal: of what the
    snow lies on, and of the snow's surface. place: metres, fixed to the object. strength: 1 draws slopes upright.
    """
    distance = builder.vector("LENGTH", to_rim)
    along = builder.dot(own_normal, normal)
    tangent = builder.vector("SUBTRACT", own_normal, builder.scale(normal, along))
    sine = builder.vector("LENGTH", tangent)
    outwards = builder.scale(tangent, builder.divide(1.0, builder.math("MAXIMUM", sine, 1e-6)))
    slope = builder.divide(sine, builder.math("MAXIMUM", along, STEEPEST))
    apart = builder.divide(distance, builder.math("MAXIMUM", thickness, 1e-6))
    level_outwards = builder.vector("MULTIPLY", outwards, (1.0, 1.0, 0.0))
    falls = builder.math("MAXIMUM", builder.dot(normal, level_outwards), 0.0)
    falls = builder.multiply(falls, builder.smoothstep(builder.components(normal)[2], *ROOFS))
    # A bank may fall along the rim: what counts is how it falls towards the rim, at the rim itself in any direction.
    near = builder.multiply(thickness, AT_RIM)
    towards = builder.divide(
        builder.add(builder.dot(to_rim, outwards), near),
        builder.math("MAXIMUM", builder.add(distance, near), 1e-6),
    )
    slope = builder.multiply(slope, builder.math("MAXIMUM", towards, 0.0))
    steepness = builder.multiply(slope, builder.math("MULTIPLY_ADD", falls, EAVES, 1.0))
    begun = builder.multiply(builder.smoothstep(slope, *SLOPES), FOOT)
    share = builder.multiply(
        builder.smoothstep(builder.add(builder.multiply(steepness, apart), begun), BEGINS, COMPLETE),
        builder.smoothstep(
            builder.divide(apart, builder.math("MULTIPLY_ADD", falls, EAVES, 1.0)), FAR, FARTHER, 1.0, 0.0
        ),
    )
    share = builder.multiply(share, builder.smoothstep(towards, *TOWARDS))
    # Where deep snow folds over itself in a hollow its normals mean nothing.
    share = builder.multiply(share, builder.smoothstep(along, *UNFOLDED))
    # What fills a hollow is steep beside the surface, but level.
    share = builder.multiply(share, builder.smoothstep(builder.dot(own_normal, level_outwards), *FALLS))
    # The wall of a hollow rises towards its rim, and holds what leans on it.
    share = builder.multiply(share, builder.smoothstep(builder.dot(normal, level_outwards), *RISES))
    noise = builder.node("ShaderNodeTexNoise")
    builder.feed(noise, Vector=place, Scale=WAVES, Detail=1.0)
    wave = builder.math("MULTIPLY_ADD", compat_nodes.noise_value(noise), 2.0 * VARIATION, -VARIATION)
    front = builder.multiply(builder.add(wave, REACH), thickness)
    if inner is not None:
        depth = builder.multiply(inner.open_depth, builder.math("MULTIPLY_ADD", falls, INNER_EAVES, INNER))
        behind = [
            inner.thickness(builder.scale(outwards, builder.multiply(depth, -part))) for part in INNER_PARTS
        ]
        top = builder.math("MULTIPLY_ADD", falls, TOP_EAVES, TOP)
        front, below_top = _rounded(builder, wave, thickness, behind, top)
        share = builder.multiply(share, below_top)
    already = builder.dot(risen, level_outwards)
    far = builder.subtract(builder.add(distance, front), builder.math("MAXIMUM", already, 0.0))
    most = builder.multiply(thickness, MOST)
    far = builder.math("MAXIMUM", builder.math("MINIMUM", far, most), 0.0)
    return builder.scale(outwards, builder.multiply(builder.multiply(share, far), strength))


def _rounded(builder, wave, thickness, behind, top):
    """(how far out over its rim a point belongs in metres, what its share is to be multiplied by).

    behind: thicknesses of the snow at INNER_PARTS of the way inwards. With H the largest of them and of the point's
    own, a front leans out at its foot, is upright up to BRIM H, and from there on a quarter of an ellipse that is
    ROUND H wide. Higher than top H it passes into what lies behind it. Where snow is thinner behind a point than at
    it, the point is on the crest of a bank, both of whose sides fall off, and stays.
    """
    thickness = builder.math("MAXIMUM", thickness, 1e-6)
    behind = functools.reduce(lambda one, other: builder.math("MAXIMUM", one, other), behind)
    full = builder.math("MAXIMUM", thickness, behind)
    height = builder.divide(thickness, full)
    foot = builder.math("MINIMUM", REACH, builder.multiply(height, FLARE))
    begun = builder.math("MULTIPLY", height, 1.0 / BRIM, clamp=True)
    foot = builder.math("MULTIPLY_ADD", wave, begun, foot)
    above = builder.math("MULTIPLY", builder.subtract(height, BRIM), 1.0 / (1.0 - BRIM), clamp=True)
    level = builder.math("SQRT", builder.math("MULTIPLY_ADD", builder.multiply(above, above), -1.0, 1.0))
    out = builder.add(foot, builder.math("MULTIPLY_ADD", level, ROUND, -ROUND))
    crest = builder.smoothstep(builder.divide(behind, thickness), *CREST)
    below_top = builder.smoothstep(height, top, 1.0, 1.0, 0.0)
    return builder.multiply(out, full), builder.multiply(crest, below_top)
