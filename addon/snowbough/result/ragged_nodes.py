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
WAVES, DETAIL, ROUGHNESS = 5.0, 3.0, 0.5
# Gradient noise keeps to the middle of 0 to 1: what of it is drawn out to all of that.
LEAST, MOST = 0.32, 0.68
# Snow begins at the first of these parts of the threshold and lies in full from the second on.
SOFT = (0.2, 2.6)
THINNEST = 1e-6
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


def add_ragged_edges(builder, thickness, room, place, open_depth, strength):
    """The share of the thickness to show, 0 to 1; a socket.

    thickness: metres, not negative. room: the lesser of how thick what carries it is and how far the nearest rim is
    away, metres. place: metres, fixed to the object. open_depth: of the snow on open ground, metres. strength: 1 is
    fresh snow.
    """
    noise = builder.node("ShaderNodeTexNoise")
    builder.feed(noise, Vector=place, Scale=WAVES, Detail=DETAIL, Roughness=ROUGHNESS)
    uneven = builder.smoothstep(compat_nodes.noise_value(noise), LEAST, MOST)
    most = builder.math("MINIMUM", open_depth, room)
    threshold = builder.multiply(builder.multiply(uneven, strength), builder.multiply(most, SHARE))
    threshold = builder.math("MAXIMUM", threshold, THINNEST)
    return builder.smoothstep(builder.divide(thickness, threshold), *SOFT)
