# SPDX-License-Identifier: GPL-3.0-or-later
"""A snow shell: an object of its own whose geometry nodes lay the baked height over a receiver.

The height is sampled on face corners, where UVs are unambiguous (on points 6 % of the vertices, those
on seams, would read the wrong place), and the mesh is cut by `ever_covered`, so that its topology is
the same in every frame of the shot and motion blur and caches work.
"""

import math

import bpy

from .. import compat
from ..scene.pose import metres_per_unit
from . import baked_images, original_state, snow_material, snow_nodes

TREE_PREFIX = "Snowbough Shell"
MODIFIER_NAME = "Snowbough Shell"
HEIGHT_ATTRIBUTE = "snow_height"
COVERED_ATTRIBUTE = "snow_covered"
TEXELS_PER_FACE = 4.0
MAX_FACES = 500_000
# Where no snow lies the shell dips below the surface, so that it does not flicker through it (metres).
SINK = 0.002
BARE = 1e-5


class _Tree:
    """A geometry node tree with shorthand for nodes and links, laid out from left to right."""

    def __init__(self, name):
        self.tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        self._column = 0

    def node(self, kind, **properties):
        node = self.tree.nodes.new(kind)
        node.location = (190 * self._column, -180 * (self._column % 2))
        self._column += 1
        for name, value in properties.items():
            setattr(node, name, value)
        return node

    def link(self, output, socket):
        self.tree.links.new(output, socket)

    def feed(self, node, **inputs):
        """Links outputs to, or sets values of, the enabled input sockets of those names."""
        for name, value in inputs.items():
            socket = next(s for s in node.inputs if s.enabled and s.name == name.replace("_", " "))
            if isinstance(value, bpy.types.NodeSocket):
                self.link(value, socket)
            else:
                socket.default_value = value

    def math(self, operation, a, b):
        node = self.node("ShaderNodeMath", operation=operation)
        for socket, value in zip(node.inputs, (a, b)):
            if isinstance(value, bpy.types.NodeSocket):
                self.link(value, socket)
            else:
                socket.default_value = value
        return node.outputs[0]

    def attribute(self, name, data_type, kind):
        node = self.node("GeometryNodeInputNamedAttribute", data_type=data_type)
        node.inputs["Name"].default_value = name
        return next(s for s in node.outputs if s.enabled and s.type == kind)


def _frame(tree, now, sequence):
    """The file of the scene frame `now`, held before the first and after the last one."""
    return tree.math("MINIMUM", tree.math("MAXIMUM", now, float(sequence.first)), float(sequence.last))


def _store(tree, geometry, name, image, uv, frame=None, factor=None):
    """Samples an image on the corners and keeps it, times `factor`, as an attribute of that name."""
    sample = tree.node("GeometryNodeImageTexture", interpolation="Linear", extension="EXTEND")
    tree.feed(sample, Image=image, Vector=uv)
    if frame is not None:
        tree.feed(sample, Frame=frame)
    store = tree.node("GeometryNodeStoreNamedAttribute", data_type="FLOAT", domain="CORNER")
    value = sample.outputs["Color"]
    if factor is not None:
        value = tree.math("MULTIPLY", value, factor)
    tree.feed(store, Geometry=geometry, Name=name, Value=value)
    return store.outputs["Geometry"]


def _outside_out(tree, geometry, obj):
    """The geometry with its faces turned where the object's negative scale has turned it inside out: nodes leave the
    corners in their order, with which normals change sides."""
    if obj.matrix_world.determinant() >= 0.0:
        return geometry
    flip = tree.node("GeometryNodeFlipFaces")
    tree.feed(flip, Mesh=geometry)
    return flip.outputs["Mesh"]


def build_tree(name, obj, uv_map, image, frames, covered, levels, units_per_metre, material):
    """The node tree: receiver -> subdivide -> sample -> raise along the normal -> cut -> material.

    image: heights in metres; frames: its BakedSequence, or None for a still image. covered: image of where
    snow ever lies, or None. Returns the new node group.
    """
    tree = _Tree(name)
    compat.add_group_socket(tree.tree, "OUTPUT", "NodeSocketGeometry", "Geometry")
    receiver = tree.node("GeometryNodeObjectInfo", transform_space="RELATIVE")
    receiver.inputs["Object"].default_value = obj
    realized = tree.node("GeometryNodeRealizeInstances")
    tree.link(receiver.outputs["Geometry"], realized.inputs["Geometry"])
    subdivided = tree.node("GeometryNodeSubdivideMesh")
    outside = _outside_out(tree, realized.outputs["Geometry"], obj)
    tree.feed(subdivided, Mesh=outside, Level=levels)
    geometry = subdivided.outputs["Mesh"]

    uv = tree.attribute(uv_map, "FLOAT_VECTOR", "VECTOR")
    frame = begun = None
    if frames is not None:
        now = tree.node("GeometryNodeInputSceneTime").outputs["Frame"]
        begun = tree.math("GREATER_THAN", now, frames.first - 0.5)
        frame = _frame(tree, now, frames)
    geometry = _store(tree, geometry, HEIGHT_ATTRIBUTE, image, uv, frame, begun)
    if covered is not None:
        geometry = _store(tree, geometry, COVERED_ATTRIBUTE, covered, uv)

    depth = tree.attribute(HEIGHT_ATTRIBUTE, "FLOAT", "VALUE")
    bare = tree.math("LESS_THAN", tree.math("ABSOLUTE", depth, 0.0), BARE)
    raised = tree.math("SUBTRACT", depth, tree.math("MULTIPLY", bare, SINK))
    offset = tree.node("ShaderNodeVectorMath", operation="SCALE")
    tree.link(tree.node("GeometryNodeInputNormal").outputs["Normal"], offset.inputs[0])
    tree.link(tree.math("MULTIPLY", raised, units_per_metre), offset.inputs["Scale"])
    moved = tree.node("GeometryNodeSetPosition")
    tree.feed(moved, Geometry=geometry, Offset=offset.outputs[0])
    geometry = moved.outputs["Geometry"]

    if covered is not None:
        cut = tree.node("GeometryNodeDeleteGeometry", domain="FACE")
        ever = tree.attribute(COVERED_ATTRIBUTE, "FLOAT", "VALUE")
        tree.feed(cut, Geometry=geometry, Selection=tree.math("LESS_THAN", ever, 1e-6))
        geometry = cut.outputs["Geometry"]
    smooth = tree.node("GeometryNodeSetShadeSmooth")
    tree.link(geometry, smooth.inputs["Geometry"])
    painted = tree.node("GeometryNodeSetMaterial")
    tree.feed(painted, Geometry=smooth.outputs["Geometry"], Material=material)
    output = tree.node("NodeGroupOutput")
    tree.link(painted.outputs["Geometry"], output.inputs["Geometry"])
    return tree.tree


def make_material(name):
    """Snow that fades to nothing at its rim: its depth comes with the shell as an attribute."""
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    group = nodes.new("ShaderNodeGroup")
    group.node_tree = snow_nodes.ensure_group()
    depth = nodes.new("ShaderNodeAttribute")
    depth.attribute_name = HEIGHT_ATTRIBUTE
    links.new(depth.outputs["Fac"], group.inputs["Height"])
    links.new(nodes.new("ShaderNodeBsdfTransparent").outputs[0], group.inputs["Shader"])
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Normal"], group.inputs["Normal"])
    links.new(group.outputs["Shader"], output.inputs["Surface"])
    for column, node in enumerate(nodes):
        node.location = (-260 * column, 0)
    compat.set_alpha_clipping(material)
    return material


def _face_count(obj):
    """Faces of the receiver, or of all meshes in the collection that it instances."""
    if obj.type == "MESH":
        return len(obj.data.polygons)
    members = obj.instance_collection.all_objects if obj.instance_collection else ()
    return sum(len(member.data.polygons) for member in members if member.type == "MESH")


def subdivision_levels(obj, size):
    """Simple subdivisions that bring the object to about a face per four texels of a map `size` wide."""
    wanted = max(min(size * size / TEXELS_PER_FACE, MAX_FACES) / max(_face_count(obj), 1), 1.0)
    return min(11, math.floor(math.log(wanted, 4.0) + 0.5))


def make_object(scene, obj, name, tree, material):
    """An object with that node tree as its modifier, linked beside `obj`; bakes leave it out."""
    shell = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    shell.snowbough.is_shell = True
    shell.snowbough.occlude = False
    shell.data.materials.append(material)
    shell.modifiers.new(MODIFIER_NAME, "NODES").node_group = tree
    homes = [collection for collection in obj.users_collection if collection.library is None]
    (homes[0] if homes else scene.collection).objects.link(shell)
    return shell


def delete_object(shell):
    """Deletes a shell with its mesh, nodes and material."""
    mesh = shell.data
    trees = [modifier.node_group for modifier in shell.modifiers if modifier.type == "NODES"]
    materials = [slot.material for slot in shell.material_slots]
    bpy.data.objects.remove(shell)
    bpy.data.meshes.remove(mesh)
    for tree in trees:
        if tree is not None:
            bpy.data.node_groups.remove(tree)
    for material in materials:
        if material is not None and material.users == 0:
            bpy.data.materials.remove(material)


def make(scene, receiver):
    """Makes the receiver's shell from its baked files and links it beside the receiver.

    Returns the shell, or None where nothing is baked yet. Raises ValueError without a UV map.
    """
    obj = receiver.object
    height = baked_images.load_sequence(receiver.folder, "height")
    if height is None:
        return None
    uv_map = snow_material.uv_map_name(receiver)
    if not uv_map:
        raise ValueError(f"{obj.name} has no UV map: add one, or use Add Snow to Selected, which makes it")
    covered = baked_images.load_ever_covered(receiver.folder)
    name = f"{obj.name} snow"
    material = make_material(name)
    units_per_metre = 1.0 / metres_per_unit(scene)
    tree = build_tree(
        f"{TREE_PREFIX} {obj.name}",
        obj,
        uv_map,
        height.image,
        height,
        covered,
        subdivision_levels(obj, height.size),
        units_per_metre,
        material,
    )
    shell = make_object(scene, obj, name, tree, material)
    record = original_state.read(receiver)
    record["shell"] = shell.name
    original_state.write(receiver, record)
    return shell


def find(receiver):
    """The receiver's shell, or None."""
    return bpy.data.objects.get(original_state.read(receiver).get("shell", ""))


def remove(receiver):
    """Deletes the receiver's shell with its mesh, nodes and material."""
    record = original_state.read(receiver)
    shell = bpy.data.objects.get(record.pop("shell", ""))
    original_state.write(receiver, record)
    if shell is not None:
        delete_object(shell)


def freeze(scene, receiver, depsgraph):
    """The snow of the receiver as it is in the evaluated frame, as a plain mesh object of its own.

    Works from whatever displacement the receiver has; a receiver without a shell gets one for the
    moment. Returns the new object, linked beside the receiver; None where nothing is baked.
    """
    shell = find(receiver)
    temporary = shell is None
    shell = shell or make(scene, receiver)
    if shell is None:
        return None
    depsgraph.update()
    evaluated = shell.evaluated_get(depsgraph)
    name = f"{receiver.object.name} snow {scene.frame_current:04d}"
    mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)
    mesh.name = name
    frozen = bpy.data.objects.new(name, mesh)
    frozen.matrix_world = shell.matrix_world
    for collection in shell.users_collection:
        collection.objects.link(frozen)
    if temporary:
        remove(receiver)
    return frozen
