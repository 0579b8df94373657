# SPDX-License-Identifier: GPL-3.0-or-later
"""Cushions: snow that bridges the gaps between needles.

Snow on foliage lies across many needles, while the maps know each of them alone. These nodes close and open the snow
of a shell, in the words of morphology (J. Serra, Image Analysis and Mathematical Morphology, 1982): grown by a
radius, it joins what is nearer than twice that; shrunk by a little more, it loses what is thin, as a lone needle's;
grown again, what is left is round. Sets are balls around points, meshed from a volume, and depths in them distances
from that mesh, so a cushion's shape follows the snow without steps, while its topology changes over the shot.
"""

import numpy as np

from .. import compat_nodes

# The slider of shells: 0 leaves every needle its own snow.
CUSHIONS_INPUT = "Cushions"

# Radius by which snow is grown, in parts of the depth on open ground, and its bounds in metres.
RADIUS_OF_DEPTH = 0.35
LEAST_RADIUS, MOST_RADIUS = 0.001, 0.02
# By how much of that it is shrunk, and grown again at last.
SHRUNK, PUFFED = 1.15, 0.37
# How far a second layer of the snow lies above the first, in parts of the radius: it tells a bough's flat spray, which
# gets as thick as a body, from a lone needle, which stays thin across. What is left of a flat spray is thicker than
# two points lie apart (RAISED - 2 (SHRUNK - 1) against 1 / FINE), wherever a Blender begins to lay them.
RAISED = 0.75
# Voxels and points a radius: more are finer and dearer.
COARSE, FINE = 2.5, 3.0
# The least thickness of the snow that is bridged, in parts of the depth on open ground.
THINNEST = 0.02
# Thickness by which cushions are shaded, at least (metres).
DEPTH_SHOWN = 0.02
# Shells of more points in renders are refused: balls around them would take minutes a frame.
MOST_POINTS = 1_500_000

# What counts as needles: so many pieces, mostly so much longer than wide and so thin beside the snow.
LEAST_PIECES = 50
MOSTLY = 0.6
LENGTH_TO_WIDTH = 4.0
WIDTH_OF_DEPTH = 0.5


def pieces_of(edges, points):
    """(P,) int: for each of `points` vertices the number of the connected piece it is in. edges: (E, 2) int."""
    label = np.arange(points)
    while True:
        least = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        lower = label.copy()
        np.minimum.at(lower, label[edges[:, 0]], least)
        np.minimum.at(lower, label[edges[:, 1]], least)
        lower = lower[lower]
        if np.array_equal(lower, label):
            return np.unique(label, return_inverse=True)[1]
        label = lower


def are_needles(positions, edges, depth):
    """Whether a mesh is mostly of many thin pieces. positions: (N, 3), edges: (E, 2), depth of the snow: metres."""
    piece = pieces_of(edges, len(positions)) if len(edges) else np.zeros(0, dtype=int)
    count = int(piece.max()) + 1 if len(piece) else 0
    if count < LEAST_PIECES:
        return False
    sizes = np.bincount(piece, minlength=count)[:, None]
    centre = np.stack([np.bincount(piece, axis, count) for axis in positions.T], axis=1) / sizes
    away = positions - centre[piece]
    spread = np.zeros((count, 3, 3))
    np.add.at(spread, piece, away[:, :, None] * away[:, None, :])
    # Points of a box's corners deviate from its middle by half its sides.
    sides = 2.0 * np.sqrt(np.maximum(np.linalg.eigvalsh(spread / sizes[:, :, None]), 0.0))
    width, length = sides[:, 1], sides[:, 2]
    thin = (length > LENGTH_TO_WIDTH * width) & (width < WIDTH_OF_DEPTH * depth)
    return bool(thin.mean() > MOSTLY)


def _joined(builder, *parts):
    node = builder.node("GeometryNodeJoinGeometry")
    for part in parts:
        builder.tree.links.new(part, node.inputs[0])
    return node.outputs[0]


def _balls(builder, points, radius, voxel):
    """The union of balls around points, as a mesh: their radius may be a field."""
    volume = builder.node("GeometryNodePointsToVolume")
    compat_nodes.set_choice(volume, "resolution_mode", "VOXEL_SIZE")
    builder.feed(volume, Points=points, Voxel_Size=voxel, Radius=radius)
    mesh = builder.node("GeometryNodeVolumeToMesh")
    compat_nodes.set_choice(mesh, "resolution_mode", "GRID")
    return volume.outputs[0], builder.feed(mesh, Volume=volume.outputs[0]).outputs["Mesh"]


def _body(builder, geometry, thickness, depth, radius):
    """The cushions as a mesh: the snow's points grown, shrunk by more than that, and grown again."""
    points = builder.node("GeometryNodeMeshToPoints", mode="VERTICES")
    carries = builder.math("GREATER_THAN", thickness, builder.multiply(depth, THINNEST))
    builder.feed(points, Mesh=geometry, Selection=carries)
    higher = builder.node("GeometryNodeSetPosition")
    up = builder.combine(0.0, 0.0, builder.multiply(radius, RAISED))
    builder.feed(higher, Geometry=points.outputs[0], Offset=up)
    layers = _joined(builder, points.outputs[0], higher.outputs[0])
    grown, surface = _balls(builder, layers, radius, builder.divide(radius, COARSE))

    spacing = builder.divide(radius, FINE)
    inside = builder.node("GeometryNodeDistributePointsInVolume")
    compat_nodes.set_choice(inside, "mode", "DENSITY_GRID")
    builder.feed(inside, Volume=grown, Spacing=builder.combine(spacing, spacing, spacing))
    at = builder.node("GeometryNodeInputPosition").outputs[0]
    near = builder.node("GeometryNodeProximity", target_element="FACES")
    builder.feed(near, Target=surface, Source_Position=at)
    deeper = builder.subtract(near.outputs["Distance"], builder.multiply(radius, SHRUNK))
    core = builder.node("GeometryNodeSeparateGeometry", domain="POINT")
    builder.feed(core, Geometry=inside.outputs[0], Selection=builder.math("GREATER_THAN", deeper, 0.0))
    full = builder.add(deeper, builder.multiply(radius, PUFFED))
    return _balls(builder, core.outputs["Selection"], full, builder.multiply(spacing, 0.75))[1]


def _nearest(builder, geometry, value):
    """The vector `value` of the shell's nearest point, wherever it is asked for."""
    index = builder.node("GeometryNodeSampleNearest", domain="POINT")
    builder.feed(index, Geometry=geometry)
    sample = builder.node("GeometryNodeSampleIndex", data_type="FLOAT_VECTOR", domain="POINT")
    builder.feed(sample, Geometry=geometry, Value=value, Index=index.outputs[0])
    return builder.output(sample)


def add_cushions(builder, geometry, amount, depth, names, metres_per_unit):
    """A shell with cushions over it, a geometry.

    amount: the slider. depth: metres on open ground in the frame. names: of the attributes of a point's thickness and
    of its place, both in metres.
    """
    height_name, place_name = names
    thickness, place = builder.attribute(height_name), builder.attribute(place_name, "FLOAT_VECTOR")
    metres = builder.multiply(builder.multiply(depth, RADIUS_OF_DEPTH), amount)
    metres = builder.math("MINIMUM", builder.math("MAXIMUM", metres, LEAST_RADIUS), MOST_RADIUS)
    mesh = _body(builder, geometry, thickness, depth, builder.divide(metres, metres_per_unit))
    at = builder.node("GeometryNodeInputPosition").outputs[0]
    away = builder.vector("SUBTRACT", at, _nearest(builder, geometry, at))
    grown = builder.vector("ADD", _nearest(builder, geometry, place), builder.scale(away, metres_per_unit))
    mesh = builder.store(mesh, place_name, grown, "POINT", "FLOAT_VECTOR")
    mesh = builder.store(mesh, height_name, builder.math("MAXIMUM", metres, DEPTH_SHOWN), "POINT")

    wanted = builder.math("GREATER_THAN", builder.multiply(amount, depth), 0.0)
    return builder.switch(wanted, geometry, _joined(builder, geometry, mesh), "GEOMETRY")
