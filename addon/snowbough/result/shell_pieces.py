# SPDX-License-Identifier: GPL-3.0-or-later
"""What a shell's nodes make of a receiver before snow lies on it: its mesh in the world, the normals of its corners,
and its *pieces*: the mesh with all faces split apart, subdivided as the mesh is, whose points answer for its corners.
"""

from .. import compat_nodes
from ..names import REST_ATTRIBUTE

POSITION_ATTRIBUTE = "snow_position"

NORMAL = "snow_normal"
UV = "snow_uv"
PLACE = "snow_map_place"
PIECE = "snow_piece"

# Texels by which corners keep off the rim of their chart on the map, since what lies beyond it may be another's; at
# most so far towards the face's middle.
INSET = 1.0
MOST_INSET = 0.5
# Faces of more corners than this get a collar, whose inner side is so large beside the outer.
MOST_CORNERS = 4
COLLAR = 0.5
# Texels by which two faces may differ in where their edge lies on the map.
TOGETHER = 0.01


def _object(tree, obj, space):
    node = tree.node("GeometryNodeObjectInfo", transform_space=space)
    node.inputs["Object"].default_value = obj
    return node


def _realized(tree, geometry):
    return tree.feed(tree.node("GeometryNodeRealizeInstances"), Geometry=geometry).outputs[0]


def capture(tree, geometry, value, domain, data_type):
    """(geometry, value): the value as it is on this geometry, for what is made of it."""
    return compat_nodes.capture_attribute(tree.tree, geometry, value, domain, data_type)


def receiver(tree, source):
    """The receiver's mesh in the world, with the place of every point in its own space in metres."""
    info = _object(tree, source.obj, "RELATIVE")
    geometry = _realized(tree, info.outputs["Geometry"])
    if source.rest:
        local = tree.attribute(REST_ATTRIBUTE, "FLOAT_VECTOR")
    else:
        own = _realized(tree, _object(tree, source.obj, "ORIGINAL").outputs["Geometry"])
        sample = tree.node("GeometryNodeSampleIndex", data_type="FLOAT_VECTOR", domain="POINT")
        tree.feed(sample, Geometry=own, Value=tree.node("GeometryNodeInputPosition").outputs[0],
                  Index=tree.node("GeometryNodeInputIndex").outputs[0])  # fmt: skip
        local = tree.output(sample)
    metres = tree.scale(tree.vector("MULTIPLY", local, info.outputs["Scale"]), source.metres_per_unit)
    geometry = tree.store(geometry, POSITION_ATTRIBUTE, metres, "POINT", "FLOAT_VECTOR")
    uv = tree.attribute(source.uv_map, "FLOAT_VECTOR")
    geometry = tree.store(geometry, UV, uv, "CORNER", "FLOAT_VECTOR")
    if source.instancer is None:
        return geometry
    offset = source.instancer.instance_collection.instance_offset
    moved = tree.node("GeometryNodeTransform")
    tree.feed(moved, Geometry=geometry, Translation=tuple(-value for value in offset))
    placed = tree.node("GeometryNodeTransform")
    place = _object(tree, source.instancer, "RELATIVE").outputs
    return tree.feed(placed, Geometry=moved.outputs[0], Translation=place["Location"],
                     Rotation=place["Rotation"], Scale=place["Scale"]).outputs[0]  # fmt: skip


def off_border(tree):
    """1 on points, a field, through which no edge of a single face goes; else 0."""
    faces = tree.node("GeometryNodeInputMeshEdgeNeighbors").outputs[0]
    border = tree.on_domain(tree.on_domain(tree.math("LESS_THAN", faces, 1.5), "EDGE"), "POINT")
    return tree.math("LESS_THAN", border, 1e-3)


def outside_out(tree, geometry, source):
    """The geometry with its faces turned where a negative scale has turned it inside out: nodes leave the corners in
    their order, with which normals change sides."""
    mirrored = source.obj.matrix_world.determinant() < 0.0
    if source.instancer is not None:
        mirrored ^= source.instancer.matrix_world.determinant() < 0.0
    if not mirrored:
        return geometry
    return tree.feed(tree.node("GeometryNodeFlipFaces"), Mesh=geometry).outputs["Mesh"]


def collared(tree, geometry):
    """The geometry with its UVs as UV, and faces of many corners with a collar of quads along their rim. Subdivision
    cuts such a face into kites that meet in its middle, fine at the corners and coarse between them, so that snow's
    slope at the rim would lie in flutes."""
    position = tree.node("GeometryNodeInputPosition").outputs[0]
    values = {
        UV: (tree.attribute(UV, "FLOAT_VECTOR"), "CORNER"),
        POSITION_ATTRIBUTE: (tree.attribute(POSITION_ATTRIBUTE, "FLOAT_VECTOR"), "POINT"),
        None: (position, "POINT"),
    }
    middles = {}
    for name, (value, domain) in values.items():
        on_face = tree.on_domain(tree.on_domain(value, domain, "FLOAT_VECTOR"), "FACE", "FLOAT_VECTOR")
        geometry, middles[name] = capture(tree, geometry, on_face, "FACE", "FLOAT_VECTOR")
    extruded = tree.node("GeometryNodeExtrudeMesh", mode="FACES")
    corners = tree.node("GeometryNodeInputMeshFaceNeighbors").outputs["Vertex Count"]
    many = tree.math("GREATER_THAN", corners, MOST_CORNERS + 0.5)
    tree.feed(extruded, Mesh=geometry, Selection=many, Offset_Scale=0.0, Individual=True)
    geometry = extruded.outputs["Mesh"]
    top = tree.on_domain(extruded.outputs["Top"], "FACE")
    geometry, inner = capture(
        tree, geometry, tree.math("GREATER_THAN", tree.on_domain(top, "POINT"), 0.0), "POINT", "FLOAT"
    )
    ways = {}
    for name, (value, domain) in values.items():
        way = tree.scale(tree.vector("SUBTRACT", middles[name], value), tree.multiply(inner, 1.0 - COLLAR))
        geometry, ways[name] = capture(tree, geometry, way, domain, "FLOAT_VECTOR")
    for name in (UV, POSITION_ATTRIBUTE):
        value, domain = values[name]
        geometry = tree.store(geometry, name, tree.vector("ADD", value, ways[name]), domain, "FLOAT_VECTOR")
    moved = tree.node("GeometryNodeSetPosition")
    return tree.feed(moved, Geometry=geometry, Offset=ways[None]).outputs["Geometry"]


def sharp_edges(tree, sharp_angle):
    """1 on edges across which the mesh is not shaded smooth, else 0."""
    flat = tree.math("SUBTRACT", 1.0, tree.node("GeometryNodeInputShadeSmooth").outputs[0])
    beside_flat = tree.on_domain(tree.on_domain(flat, "FACE"), "EDGE")
    angle = tree.node("GeometryNodeInputMeshEdgeAngle").outputs["Unsigned Angle"]
    marked = tree.add(tree.attribute("sharp_edge", "BOOLEAN"), tree.attribute("sharp_face", "BOOLEAN"))
    any_of_them = tree.add(
        tree.add(beside_flat, tree.math("GREATER_THAN", angle, sharp_angle)), tree.on_domain(marked, "EDGE")
    )
    return tree.math("GREATER_THAN", any_of_them, 1e-3)


def corner_normals(tree, geometry, sharp_angle):
    """The geometry with the normal of every corner, smooth across smooth edges only, as NORMAL."""
    split = tree.node("GeometryNodeSplitEdges")
    tree.feed(split, Mesh=geometry, Selection=sharp_edges(tree, sharp_angle))
    normal = tree.on_domain(tree.node("GeometryNodeInputNormal").outputs["Normal"], "POINT", "FLOAT_VECTOR")
    return tree.store(
        geometry, NORMAL, _of_corner(tree, split.outputs["Mesh"], normal), "CORNER", "FLOAT_VECTOR"
    )


def _of_corner(tree, other, value, data_type="FLOAT_VECTOR"):
    """The value that a corner's counterpart has in another mesh, of the same corners in the same order."""
    sample = tree.node("GeometryNodeSampleIndex", data_type=data_type, domain="CORNER")
    tree.feed(sample, Geometry=other, Value=value, Index=tree.node("GeometryNodeInputIndex").outputs[0])
    return tree.output(sample)


def welded(tree, geometry, source):
    merge = tree.node("GeometryNodeMergeByDistance")
    return tree.feed(merge, Geometry=geometry, Distance=2e-5 / source.metres_per_unit).outputs[0]


def _insets(tree, geometry, uv, texel):
    """The way on the map (a vector on corners) by which a corner keeps off those of its two edges at which its chart
    ends; along other edges nothing may move, or snow would step there."""
    index = tree.node("GeometryNodeInputIndex").outputs[0]

    def beside(value, offset):
        other = tree.node("GeometryNodeOffsetCornerInFace")
        tree.feed(other, Corner_Index=index, Offset=offset)
        sample = tree.node("GeometryNodeSampleIndex", data_type="FLOAT_VECTOR", domain="CORNER")
        tree.feed(sample, Geometry=geometry, Value=value, Index=other.outputs[0])
        return tree.output(sample)

    def of_edge(value, data_type):
        total = tree.node("GeometryNodeAccumulateField", data_type=data_type, domain="CORNER")
        edge = tree.node("GeometryNodeEdgesOfCorner").outputs[0]
        tree.feed(total, Value=value, Group_Index=edge)
        return tree.output(total, "Total")

    # Of the edge to the next corner: where its middle lies, by this face and by all.
    side = tree.vector("SUBTRACT", beside(uv, 1), uv)
    own = tree.vector("ADD", uv, tree.scale(side, 0.5))
    faces = of_edge(1.0, "FLOAT")
    mean = tree.scale(of_edge(own, "FLOAT_VECTOR"), tree.divide(1.0, faces))
    off = tree.vector("LENGTH", tree.vector("SUBTRACT", own, mean))
    ends = tree.math(
        "MAXIMUM", tree.math("GREATER_THAN", off, TOGETHER * texel), tree.math("LESS_THAN", faces, 1.5)
    )
    middle = tree.on_domain(tree.on_domain(uv, "CORNER", "FLOAT_VECTOR"), "FACE", "FLOAT_VECTOR")
    inwards = tree.vector("SUBTRACT", middle, uv)
    along = tree.divide(tree.dot(inwards, side), tree.math("MAXIMUM", tree.dot(side, side), 1e-20))
    inwards = tree.vector("SUBTRACT", inwards, tree.scale(side, along))
    reach = tree.math("MAXIMUM", tree.vector("LENGTH", inwards), 1e-10)
    part = tree.math("MINIMUM", tree.divide(INSET * texel, reach), MOST_INSET)
    way = tree.scale(inwards, tree.multiply(part, ends))
    return tree.vector("ADD", way, beside(way, -1))


def apart(tree, geometry, source):
    """The mesh's faces split apart, whose points carry what their one corner has: the normal, and as PLACE where on
    the map it is looked up: on its UVs, where a chart ends a little towards the middle of its face, which may be
    narrow."""
    uv = tree.attribute(UV, "FLOAT_VECTOR")
    place = tree.vector("ADD", uv, _insets(tree, geometry, uv, source.texel))
    geometry = tree.store(geometry, PLACE, place, "CORNER", "FLOAT_VECTOR")
    split = tree.node("GeometryNodeSplitEdges")
    geometry = tree.feed(split, Mesh=geometry).outputs["Mesh"]
    for name in (PLACE, NORMAL):
        geometry = tree.store(geometry, name, tree.attribute(name, "FLOAT_VECTOR"), "POINT", "FLOAT_VECTOR")
    for name in (UV, source.uv_map, POSITION_ATTRIBUTE):  # nobody asks for them here, and each is subdivided
        geometry = compat_nodes.remove_attribute(tree.tree, geometry, name)
    return geometry


def phong(tree, geometry):
    """(geometry, the way from a point of a face to its place on the curved surface), of faces that are apart.

    With p_i and n_i of a face's corners and b_i a point's weights in it, Phong tessellation puts p at
    sum b_i (p - ((p - p_i) . n_i) n_i) = p - M p + c, where M = sum b_i n_i n_i^T and c = sum b_i (p_i . n_i) n_i are
    attributes that the subdivision interpolates. Where all faces are shaded flat it is 0, and nothing is reckoned.
    """
    place = tree.node("GeometryNodeInputPosition").outputs[0]
    normal = tree.attribute(NORMAL, "FLOAT_VECTOR")
    curved, offset = capture(
        tree, geometry, tree.scale(normal, tree.dot(place, normal)), "POINT", "FLOAT_VECTOR"
    )
    rows = []
    for component in tree.components(normal):
        curved, row = capture(tree, curved, tree.scale(normal, component), "POINT", "FLOAT_VECTOR")
        rows.append(row)
    product = tree.combine(*(tree.dot(row, place) for row in rows))
    curvature = tree.scale(tree.vector("SUBTRACT", offset, product), 0.5)
    smooth = tree.node("GeometryNodeAttributeStatistic", domain="FACE")
    tree.feed(smooth, Geometry=geometry, Attribute=tree.node("GeometryNodeInputShadeSmooth").outputs[0])
    any_smooth = tree.math("GREATER_THAN", tree.output(smooth, "Max"), 0.5)
    return tree.switch(any_smooth, geometry, curved, "GEOMETRY"), tree.switch(
        any_smooth, (0.0, 0.0, 0.0), curvature, "VECTOR"
    )


def subdivided(tree, geometry, levels):
    viewport, render = levels
    level = tree.switch(tree.node("GeometryNodeIsViewport").outputs[0], render, viewport, "INT")
    node = tree.node("GeometryNodeSubdivideMesh")
    return tree.feed(node, Mesh=geometry, Level=level).outputs["Mesh"]


class Pieces:
    """Subdivided pieces, and what their points say of the mesh's."""

    def __init__(self, tree, geometry, source):
        self.tree, self.geometry, self.source = tree, geometry, source

    def capture(self, value, data_type):
        """Works a value out, once a point."""
        self.geometry, captured = capture(self.tree, self.geometry, value, "POINT", data_type)
        return captured

    def number(self, geometry):
        """The mesh with each corner's point in the pieces, as PIECE."""
        point = self.tree.node("GeometryNodeVertexOfCorner").outputs[0]
        corner = _of_corner(self.tree, self.geometry, point, "INT")
        return self.tree.store(geometry, PIECE, corner, "CORNER", "INT")

    def mean(self, captured, data_type):
        """For points of the mesh: the mean over their corners."""
        tree = self.tree
        sample = tree.node("GeometryNodeSampleIndex", data_type=data_type, domain="POINT")
        tree.feed(sample, Geometry=self.geometry, Value=captured, Index=tree.attribute(PIECE, "INT"))
        return tree.on_domain(tree.on_domain(tree.output(sample), "CORNER", data_type), "POINT", data_type)
