# SPDX-License-Identifier: GPL-3.0-or-later
"""The node tree of a snow shell: receiver -> collars -> normals -> subdivide -> heights -> cut -> raise
-> fair -> material.

- **Normals** are those of the mesh before it is subdivided, interpolated over its faces (as Phong tessellation has
  them); afterwards every small face would have the normal of the large one that it lies in, and snow would lie in
  terraces. Faces that are shaded flat keep their own: edges beside them, and sharp ones, are split for the moment in
  which the normals are taken.
- **Curvature**: under snow a surface that is shaded smooth is drawn towards what its normals say (T. Boubekeur,
  M. Alexa, Phong Tessellation, SIGGRAPH Asia 2008), by the half that is exact on a sphere.
- **Heights** are sampled where UVs are unambiguous: on corners of the receiver's faces. A point takes the mean of its
  corners' offsets, weighted by their heights and by how level they are: where two charts meet at an edge no gap opens
  and nothing flares. Corners that lie within one of the receiver's faces agree, so all that is sampled or reckoned for
  a corner is done on *pieces*, a copy of the mesh whose faces are split apart before it is subdivided: they have a
  point where the mesh has up to four corners, and their corners are in the mesh's order.
- **The border**: where no snow lies, and along the rim of an open mesh, the shell dips just below the surface, so it
  ends on it. Faces beyond the second ring of bare ones are cut where snow never lies, the same in every frame, so
  that motion blur and caches work.
"""

from dataclasses import dataclass

import bpy

from .. import compat_nodes
from ..node_builder import NodeBuilder
from .cushion_nodes import CUSHIONS_INPUT, add_cushions
from .fairing_nodes import add_fairing
from .ragged_nodes import RAGGED_INPUT, add_ragged_edges, support
from .relief_nodes import RELIEF_INPUT, add_relief, octaves_for
from .shell_pieces import (
    NORMAL,
    PIECE,
    PLACE,
    POSITION_ATTRIBUTE,
    UV,
    Pieces,
    apart,
    capture,
    collared,
    corner_normals,
    off_border,
    outside_out,
    phong,
    receiver,
    sharp_edges,
    subdivided,
    welded,
)
from .shoulder_nodes import SHOULDERS_INPUT, Inner, add_lips, add_shoulders, near_rim, rims, way_to

HEIGHT_ATTRIBUTE = "snow_height"

# Inputs of a shell's nodes besides the geometry: name, tooltip, default, most.
SLIDERS = (
    (RELIEF_INPUT, "Bumps of the surface; fresh snow has 0.6", 1.0, 10.0),
    (
        SHOULDERS_INPUT,
        "How upright snow stands at rims and ends on steep surfaces; 0 leaves it as its map has it",
        1.0,
        2.0,
    ),
    (RAGGED_INPUT, "How uneven snow ends where shelter thins it out; 0 ends it where the map does", 1.0, 3.0),
    (CUSHIONS_INPUT, "Snow bridges the gaps between needles; 0 leaves every needle its own", 0.0, 4.0),
)

# Depth of the shell below bare surfaces, and height of the thinnest snow above them (metres).
SINK = 0.0004
SKIN = 0.0004
# Snow is there from this thickness on (metres).
BARE = 1e-5
THIN = 0.001
# Deeper snow (metres) stands as high as its map says.
DEEP = 0.02
# What Phong tessellation adds at most, as a share of the thickness.
MOST_CURVATURE = 0.5
# Metres from a rim from which on steepness begins to mean anything, and means it fully.
OFF_RIM = (0.005, 0.03)
# Which way snow grows in the space of grains and relief: any that is no axis.
GROWTH = (0.27, 0.21, 0.94)
# What a wall's height counts at an edge, beside 1 for level ground.
WALL_SHARE = 0.05
# Walls and overhangs, of such cosines, show no thin snow (metres): what has just slid over a rim, or what comes through
# a map's narrow gutter from the chart beside it.
OVERHANGS = (0.0, 0.1)
FROST = (0.003, 0.012)
# Snow on slopes leans upwards: so much, at most, for a slope of 45 degrees.
LEAN = 0.5


@dataclass(frozen=True)
class ShellSource:
    """What a shell is made of."""

    obj: bpy.types.Object
    uv_map: str
    image: bpy.types.Image
    """Heights in metres, negative on the back of two-sided surfaces."""
    material: bpy.types.Material
    frames: object = None
    """The image's BakedSequence, None for a still image."""
    texel: float = 0.0
    """Of the image, in parts of the map's side."""
    covered: bpy.types.Image = None
    """Where snow ever lies; None: bare faces are cut as the frame has them."""
    instancer: bpy.types.Object = None
    """The empty that instances the collection which obj is in."""
    levels: tuple = (0, 0)
    """Subdivisions in the viewport and in renders."""
    face_size: float = 0.01
    """Of a face in renders (metres): waves of the relief that it cannot carry are left out."""
    metres_per_unit: float = 1.0
    sharp_angle: float = 4.0
    """Edges with a larger angle between their faces are sharp (radians; over pi: none)."""
    weld: bool = False
    """Points that lie on one another are one."""
    depths: tuple = ()
    """Depth of the snow on open ground, (frame, metres) of some frames. Without them there are no cushions and no
    ragged edges."""
    rest: bool = False
    """The receiver carries where its points are undeformed, as `rest_position`."""


def build_tree(name, source):
    """A geometry node group that makes the shell of a ShellSource, for an object that stands at the world's
    origin. Its inputs besides the geometry are sliders: relief, shoulders and, with `depths`, ragged edges and
    cushions."""
    tree = NodeBuilder(bpy.data.node_groups.new(name, "GeometryNodeTree"))
    compat_nodes.add_group_socket(tree.tree, "INPUT", "NodeSocketGeometry", "Geometry")
    for name, description, default, most in SLIDERS:
        if name not in (CUSHIONS_INPUT, RAGGED_INPUT) or source.depths:
            compat_nodes.add_group_socket(
                tree.tree, "INPUT", "NodeSocketFloat", name, description, default, 0.0, most
            )
    compat_nodes.add_group_socket(tree.tree, "OUTPUT", "NodeSocketGeometry", "Geometry")
    sliders = tree.node("NodeGroupInput").outputs

    geometry = collared(tree, outside_out(tree, receiver(tree, source), source))
    pieces = corner_normals(tree, geometry, source.sharp_angle)
    if source.weld:
        geometry, pieces = welded(tree, geometry, source), welded(tree, pieces, source)
    ragged = None
    if source.depths:
        open_depth = tree.keyed(source.depths)
        normal_of_points = tree.node("GeometryNodeInputNormal").outputs[0]
        carried_by = support(tree, geometry, normal_of_points, source.metres_per_unit)
        geometry, carried_by = capture(tree, geometry, carried_by, "POINT", "FLOAT")
        ragged = (carried_by, open_depth, sliders[RAGGED_INPUT], sliders[SHOULDERS_INPUT])
    carrier, rim_edges = geometry, rims(tree, geometry, sharp_edges(tree, source.sharp_angle))
    geometry = compat_nodes.remove_attribute(tree.tree, geometry, UV)
    pieces, curvature = phong(tree, apart(tree, pieces, source))
    pieces, geometry = (subdivided(tree, mesh, source.levels) for mesh in (pieces, geometry))
    geometry, snow = _heights(
        tree, geometry, Pieces(tree, pieces, source), curvature, carrier, rim_edges, ragged
    )
    geometry = _raised(tree, geometry, source, snow, sliders)
    if source.depths:
        geometry = add_cushions(tree, geometry, sliders[CUSHIONS_INPUT], open_depth,
                                (HEIGHT_ATTRIBUTE, POSITION_ATTRIBUTE), source.metres_per_unit)  # fmt: skip
    smooth = tree.node("GeometryNodeSetShadeSmooth")
    tree.set(smooth.inputs[0], geometry)  # Geometry, from 5.0 on Mesh
    painted = tree.node("GeometryNodeSetMaterial")
    tree.feed(painted, Geometry=smooth.outputs[0], Material=source.material)
    output = tree.node("NodeGroupOutput")
    tree.set(output.inputs["Geometry"], painted.outputs["Geometry"])
    return tree.tree


@dataclass(frozen=True)
class _Snow:
    """Sockets with what a point of the mesh knows of its snow."""

    offset: object
    """The way from the bare surface to the snow's (metres)."""
    normal: object
    """Of the bare surface, as long as 1."""
    curvature: object
    """See phong; units of the scene."""
    to_rim: object
    """The way along the bare surface to the nearest rim (metres)."""
    inner: Inner
    """The snow farther in; None where nobody knows how deep it is on open ground."""


def _sampled(tree, image, interpolation, frame=None, uv=None):
    node = tree.node("GeometryNodeImageTexture", interpolation=interpolation, extension="EXTEND")
    uv = uv or tree.attribute(PLACE, "FLOAT_VECTOR")
    tree.feed(node, Image=image, Vector=uv, **({} if frame is None else {"Frame": frame}))
    return node.outputs["Color"]


def _inner(tree, source, carrier, bare, frame, open_depth):
    """What the map says of the snow behind a point. carrier: the mesh before it is subdivided; bare: a position on
    it."""

    def thickness(way):
        place = tree.vector("ADD", bare, tree.scale(way, 1.0 / source.metres_per_unit))
        node = tree.node("GeometryNodeSampleNearestSurface", data_type="FLOAT_VECTOR")
        tree.feed(node, Mesh=carrier, Value=tree.attribute(UV, "FLOAT_VECTOR"), Sample_Position=place)
        return tree.absolute(_sampled(tree, source.image, "Linear", frame, tree.output(node)))

    return Inner(open_depth, thickness)


def _heights(tree, geometry, pieces, curvature, carrier, rim_edges, ragged):
    """(geometry without bare faces, with HEIGHT_ATTRIBUTE and the place in the snow of every point; its _Snow).

    The place of a point in the snow gets the height that lies there in the end on top, so that grains and relief are
    not drawn out where snow is steep, and do not boil while it grows.
    """
    source = pieces.source
    frames, frame = source.frames, None
    if frames is not None:  # held before the first file and after the last one
        now = tree.node("GeometryNodeInputSceneTime").outputs["Frame"]
        frame = tree.math("MINIMUM", tree.math("MAXIMUM", now, float(frames.first)), float(frames.last))
    height = _sampled(tree, source.image, "Cubic", frame)
    if frames is not None:
        height = tree.multiply(height, tree.math("GREATER_THAN", now, frames.first - 0.5))
    height = pieces.capture(height, "FLOAT")
    final = tree.absolute(_sampled(tree, source.image, "Cubic", None if frames is None else frames.last))
    thickness = tree.absolute(height)
    normal = tree.attribute(NORMAL, "FLOAT_VECTOR")
    outside = tree.scale(tree.vector("NORMALIZE", normal), tree.math("SIGN", height))
    up = tree.components(outside)[2]
    # At an edge the side that faces the sky says where snow goes.
    weight = tree.multiply(thickness, tree.math("MAXIMUM", up, WALL_SHARE))
    lasting = tree.math("MAXIMUM", tree.smoothstep(up, *OVERHANGS), tree.smoothstep(thickness, *FROST))
    lasting = tree.multiply(thickness, lasting)
    values = (
        tree.scale(_leaning(tree, outside), tree.multiply(weight, lasting)),
        tree.combine(weight, final, tree.multiply(final, final)),
        normal,
        curvature,
    )
    captured = [pieces.capture(value, "FLOAT_VECTOR") for value in values]
    ever = source.covered and pieces.capture(_sampled(tree, source.covered, "Linear"), "FLOAT")

    offset, numbers, normal, curvature = (pieces.mean(value, "FLOAT_VECTOR") for value in captured)
    weight, mean, square = tree.components(numbers)
    geometry, inside = capture(tree, pieces.number(geometry), off_border(tree), "POINT", "FLOAT")
    offset = tree.scale(offset, tree.divide(inside, tree.math("MAXIMUM", weight, BARE * WALL_SHARE)))
    if ever is None:
        ever = tree.math("GREATER_THAN", tree.vector("LENGTH", offset), 10.0 * BARE)
    else:
        ever = pieces.mean(ever, "FLOAT")
    geometry = _cut(tree, geometry, ever)
    bare = tree.node("GeometryNodeInputPosition").outputs[0]
    to_rim = tree.scale(way_to(tree, rim_edges, bare), source.metres_per_unit)
    geometry, to_rim = capture(tree, geometry, to_rim, "POINT", "FLOAT_VECTOR")
    # As high as a point will lie, which at an edge is nearer to its higher corners than their mean.
    grown = tree.scale(GROWTH, tree.divide(square, tree.math("MAXIMUM", mean, BARE)))
    place = tree.vector("ADD", tree.attribute(POSITION_ATTRIBUTE, "FLOAT_VECTOR"), grown)
    geometry = tree.store(geometry, POSITION_ATTRIBUTE, place, "POINT", "FLOAT_VECTOR")
    inner = None
    if ragged is not None:
        carried_by, open_depth, strength, shoulders = ragged
        geometry, bare = capture(tree, geometry, bare, "POINT", "FLOAT_VECTOR")
        inner = _inner(tree, source, carrier, bare, frame, open_depth)
        geometry, offset = capture(tree, geometry, offset, "POINT", "FLOAT_VECTOR")
        place = tree.attribute(POSITION_ATTRIBUTE, "FLOAT_VECTOR")
        thickness = tree.vector("LENGTH", offset)
        distance = tree.vector("LENGTH", to_rim)
        room = tree.math("MINIMUM", carried_by, distance)
        # At a rim the normal is the mean of faces that have nothing in common.
        steep = tree.subtract(1.0, tree.absolute(tree.components(tree.vector("NORMALIZE", normal))[2]))
        upright = tree.subtract(1.0, tree.multiply(steep, tree.smoothstep(distance, *OFF_RIM)))
        share = add_ragged_edges(tree, thickness, room, upright, place, open_depth, strength)
        lips = add_lips(tree, thickness, upright, carried_by, open_depth, shoulders)
        offset = tree.scale(offset, tree.multiply(share, lips))
    normal = tree.vector("NORMALIZE", normal)
    snow = []
    for value in (offset, normal, curvature):
        geometry, known = capture(tree, geometry, value, "POINT", "FLOAT_VECTOR")
        snow.append(known)
    geometry = tree.store(geometry, HEIGHT_ATTRIBUTE, tree.vector("LENGTH", snow[0]), "POINT")
    return compat_nodes.remove_attribute(tree.tree, geometry, PIECE), _Snow(*snow, to_rim, inner)


def _raised(tree, geometry, source, snow, sliders):
    """The snow's surface: points moved by their offset, then drawn out to shoulders at the rims, and given relief
    along the normals of what has come of that."""
    direction = tree.vector("ADD", snow.offset, tree.scale(snow.normal, 1e-9))
    direction = tree.vector("NORMALIZE", tree.on_domain(direction, "POINT", "FLOAT_VECTOR"))
    height = tree.attribute(HEIGHT_ATTRIBUTE)
    units = 1.0 / source.metres_per_unit
    skin = tree.smoothstep(height, 0.0, THIN, -SINK, SKIN)
    extra = tree.multiply(skin, tree.smoothstep(height, THIN, DEEP, 1.0, 0.0))
    way = tree.vector(
        "ADD", tree.scale(snow.offset, units), tree.scale(direction, tree.multiply(extra, units))
    )
    bent = tree.math("MAXIMUM", tree.vector("LENGTH", snow.curvature), 1e-9)
    most = tree.divide(tree.multiply(height, MOST_CURVATURE * units), bent)
    way = tree.vector("ADD", way, tree.scale(snow.curvature, tree.math("MINIMUM", most, 1.0)))
    geometry = tree.feed(tree.node("GeometryNodeSetPosition"), Geometry=geometry, Offset=way).outputs[
        "Geometry"
    ]

    # On the back of a sheet both normals point into the snow.
    side = tree.math("SIGN", tree.dot(snow.normal, direction))
    own = tree.scale(
        tree.on_domain(tree.node("GeometryNodeInputNormal").outputs[0], "POINT", "FLOAT_VECTOR"), side
    )
    geometry, own = capture(tree, geometry, own, "POINT", "FLOAT_VECTOR")
    outside = tree.scale(snow.normal, side)
    place = tree.attribute(POSITION_ATTRIBUTE, "FLOAT_VECTOR")
    way = add_shoulders(
        tree, snow.to_rim, height, snow.inner, snow.offset, outside, own, place, sliders[SHOULDERS_INPUT]
    )
    drawn = tree.node("GeometryNodeSetPosition")
    tree.feed(
        drawn, Geometry=geometry, Selection=near_rim(tree, snow.to_rim, height), Offset=tree.scale(way, units)
    )
    normal = tree.on_domain(tree.node("GeometryNodeInputNormal").outputs[0], "POINT", "FLOAT_VECTOR")
    normals, to_rim = (normal, snow.normal), tree.vector("LENGTH", snow.to_rim)
    viewport, render = source.levels
    sizes = (source.face_size * 2.0 ** (render - viewport), source.face_size)
    geometry = drawn.outputs["Geometry"]
    geometry = add_fairing(tree, geometry, HEIGHT_ATTRIBUTE, normals, to_rim, sizes, sliders[SHOULDERS_INPUT])
    relief = add_relief(tree, place, height, sliders[RELIEF_INPUT], octaves_for(source.face_size))
    if relief is None:
        return geometry
    moved = tree.node("GeometryNodeSetPosition")
    way = tree.scale(own, tree.multiply(relief, units))
    return tree.feed(moved, Geometry=geometry, Offset=way).outputs["Geometry"]


def _leaning(tree, outside):
    """The direction in which snow grows: the normal on level ground, leaning up on slopes, the normal on walls."""
    z = tree.math("MAXIMUM", tree.components(outside)[2], 0.0)
    lean = tree.multiply(tree.multiply(z, tree.subtract(1.0, z)), LEAN * 4.0)
    up = tree.combine(0.0, 0.0, lean)
    return tree.vector("NORMALIZE", tree.vector("ADD", outside, up))


def _cut(tree, geometry, ever):
    """Without the faces that never carry snow (over 0: `ever`), but for two rings around those that do: one that
    fairing may move, and one that stays."""
    on_face = tree.on_domain(tree.on_domain(ever, "POINT"), "FACE")
    on_face = tree.on_domain(tree.on_domain(on_face, "POINT"), "FACE")
    node = tree.node("GeometryNodeDeleteGeometry", domain="FACE")
    tree.feed(node, Geometry=geometry, Selection=tree.math("LESS_THAN", on_face, 1e-6))
    return node.outputs["Geometry"]
