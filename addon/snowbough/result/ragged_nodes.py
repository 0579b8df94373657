# SPDX-License-Identifier: GPL-3.0-or-later
"""The ragged edge of a snow cover: where shelter thins the snow out, it lies in patches before it is gone.

A map of a sheltered place ends on the outline of what shelters it, as if it were cut from paper. Lying snow ends in
bays, tongues and islands, since ground and wind are uneven. These nodes leave snow out where it is thinner than a
share of the snow on open ground that varies from place to place. On open ground, deep or thin, no snow is ever left
out, and none is shown where the map has none. Twigs and needles carry little because they are thin, and slats and
pickets because they are narrow, not because they are sheltered: no open ground counts as deeper than what carries the
snow is thick, nor than the nearest rim is away.
"""

from .. import compat_nodes

# The slider of shells; 0 leaves edges as the map has them.
RAGGED_INPUT = "Ragged Edges"

# The largest share of the open ground's depth below which snow is left out.
SHARE = 0.22
# Bays and tongues: waves a metre of the largest, how many halvings they have, and what each counts beside the last.
WAVES, DETAIL, ROUGHNESS = 4.0, 1.6, 0.4
# Gradient noise keeps to the middle of 0 to 1: what of it is drawn out to all of that.
LEAST, MOST = 0.32, 0.68
# Snow begins at the first of these parts of the threshold and lies in full from the second on.
SOFT = (0.2, 2.6)
THINNEST = 1e-6
# Between what is left of the snow and where the map ends lies a dusting: its thickness in metres next to the snow, and
# from which part of the threshold on.
DUST = 0.0016
DUSTED = 0.9
# Narrower things than the first of these (metres) have none.
DUSTED_ROOM = (0.01, 0.05)
# The surface's cosine up to which snow is thin because it is steep, and from which on because it is sheltered; and what
# the threshold is of steep places.
LEVEL = (0.75, 0.97)
STEEP_SHARE = 0.25
# Walls below the first of these hold only frost, which is left out as in shelter.
WALL = (0.1, 0.35)
# Rays into the mesh begin so far below its surface and look so far, in metres.
BELOW, FARTHEST = 1e-5, 1e3


def support(builder, geometry, normal, metres_per_unit):
    """How thick the mesh is below its points in metres, a field on them; FARTHEST where it is a sheet."""
    inwards = builder.scale(normal, -1.0)
    position = builder.node("GeometryNodeInputPosition").outputs[0]
    begin = builder.vector("ADD", position, builder.scale(inwards, BELOW / metres_per_unit))
    ray = builder.node("GeometryNodeRaycast")
    builder.feed(ray, Target_Geometry=geometry, Source_Position=begin, Ray_Direction=inwards,
                 Ray_Length=FARTHEST / metres_per_unit)  # fmt: skip
    missed = builder.subtract(1.0, ray.outputs["Is Hit"])
    hit = builder.multiply(ray.outputs["Hit Distance"], metres_per_unit)
    return builder.math("MULTIPLY_ADD", missed, FARTHEST, hit)


def add_ragged_edges(builder, thickness, room, upright, place, open_depth, strength):
    """The share of the thickness to show, 0 to 1; a socket.

    thickness: metres, not negative. room: the lesser of how thick what carries it is and how far the nearest rim is
    away, metres. upright: cosine of the surface's steepness. place: metres, fixed to the object. open_depth: of the
    snow on open ground, metres. strength: 1 is fresh snow.
    """
    noise = builder.node("ShaderNodeTexNoise")
    builder.feed(noise, Vector=place, Scale=WAVES, Detail=DETAIL, Roughness=ROUGHNESS)
    uneven = builder.smoothstep(compat_nodes.noise_value(noise), LEAST, MOST)
    most = builder.math("MINIMUM", open_depth, room)
    sheltered = builder.math(
        "MAXIMUM",
        builder.smoothstep(upright, *LEVEL, STEEP_SHARE, 1.0),
        builder.smoothstep(upright, *WALL, 1.0, 0.0),
    )
    most = builder.multiply(most, sheltered)
    threshold = builder.multiply(builder.multiply(uneven, strength), builder.multiply(most, SHARE))
    threshold = builder.math("MAXIMUM", threshold, THINNEST)
    part = builder.divide(thickness, threshold)
    dust = builder.multiply(builder.smoothstep(part, 0.0, DUSTED), DUST)
    dust = builder.multiply(dust, builder.smoothstep(room, *DUSTED_ROOM))
    dusting = builder.math("MINIMUM", builder.divide(dust, builder.math("MAXIMUM", thickness, THINNEST)), 1.0)
    return builder.math("MAXIMUM", builder.smoothstep(part, *SOFT), dusting)
