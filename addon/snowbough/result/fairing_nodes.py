# SPDX-License-Identifier: GPL-3.0-or-later
"""Fairing: the steep fronts of a shell, and the line in which snow ends, made as smooth as snow that settles.

A front stands on few faces, and where it ends is known at the mesh's points only, so it has teeth, folds and flutes as
wide as a face. Here points of fronts, and the thickness that they say to materials, are drawn to the mean of their
neighbours, a few times (the umbrella operator: G. Taubin, A Signal Processing Approach to Fair Surface Design,
SIGGRAPH 1995). Level and sloped snow stays where it is, and so does what is farther from a front than a few faces.
"""

from .shell_pieces import capture, off_border

# As far as this (metres) points are drawn together; and the most rounds for that, which is less far on fine faces.
RADIUS = 0.012
MOST_ROUNDS = 8
# Cosine between the snow's own normal and the surface's from which on snow is a front, and from which on fully so: on
# level ground steeper than any bank, on slopes, with cosines from the first of SLOPES on and fully from the second, by
# SOONER sooner.
FRONT = (0.45, 0.25)
SOONER, SLOPES = 0.48, (0.96, 0.75)
# Rings of points around a front that move as well, each less than the one before.
RINGS = 3
# Thinner snow than this is no front (metres).
BARE = 0.0005
# Beside a rim, nearer than the second of these (metres), what is bare moves less, and at the first of them it stays:
# beyond a rim is another surface.
OFF_RIM = (0.01, 0.04)
# Snow as thick as the second of these (metres) moves all the way but for what lies on the rim itself, within RIM.
FROST = (0.004, 0.012)
RIM = 0.001


def rounds_for(face_size):
    """How often points on faces of that size (metres) move: each round reaches half the square of a face farther."""
    return min(MOST_ROUNDS, round(2.0 * (RADIUS / face_size) ** 2))


def _mean(builder, value, data_type="FLOAT"):
    """The mean of a point's value and its neighbours' mean."""
    return builder.on_domain(builder.on_domain(value, "EDGE", data_type), "POINT", data_type)


def _shares(builder, geometry, thickness, normals, to_rim, strength):
    """(geometry, how far its points are to be drawn to their mean, 0 to 1)."""
    own, normal = normals
    upright = builder.absolute(builder.components(normal)[2])
    along = builder.subtract(builder.dot(own, normal), builder.smoothstep(upright, *SLOPES, 0.0, SOONER))
    front = builder.smoothstep(along, *FRONT)
    front = builder.multiply(front, builder.math("GREATER_THAN", thickness, BARE))
    for _ in range(RINGS):
        geometry, front = capture(builder, geometry, front, "POINT", "FLOAT")
        front = builder.math("MINIMUM", builder.multiply(_mean(builder, front), 2.0), 1.0)
    free = builder.math(
        "MAXIMUM",
        builder.multiply(builder.smoothstep(thickness, *FROST), builder.math("GREATER_THAN", to_rim, RIM)),
        builder.smoothstep(to_rim, *OFF_RIM),
    )
    strength = builder.math("MINIMUM", strength, 1.0)
    share = builder.multiply(builder.multiply(front, free), builder.multiply(off_border(builder), strength))
    return capture(builder, geometry, share, "POINT", "FLOAT")


def add_fairing(builder, geometry, name, normals, to_rim, face_sizes, strength):
    """The geometry with its fronts smoothed.

    name: of the attribute with a point's thickness in metres. normals: the snow's own and the bare surface's, as long
    as 1. to_rim: metres from the nearest rim. face_sizes: in the viewport and in renders, metres. strength: from 1 on
    points go all the way to their mean, at 0 they stay.
    """
    viewport, render = (rounds_for(size) for size in face_sizes)
    if not render:
        return geometry
    before = geometry
    thickness = builder.attribute(name)
    geometry, share = _shares(builder, geometry, thickness, normals, to_rim, strength)
    wanted = builder.math("GREATER_THAN", share, 0.0)
    position = builder.node("GeometryNodeInputPosition").outputs[0]
    way = builder.vector("SUBTRACT", _mean(builder, position, "FLOAT_VECTOR"), position)
    change = builder.subtract(_mean(builder, thickness), thickness)
    for number in range(render):
        if number == viewport:
            before = geometry
        moved = builder.node("GeometryNodeSetPosition")
        builder.feed(moved, Geometry=geometry, Selection=wanted, Offset=builder.scale(way, share))
        faired = builder.math("MULTIPLY_ADD", change, share, thickness)
        geometry = builder.store(moved.outputs["Geometry"], name, faired, "POINT")
    in_viewport = builder.node("GeometryNodeIsViewport").outputs[0]
    return geometry if viewport == render else builder.switch(in_viewport, geometry, before, "GEOMETRY")
