# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the snow in the air: an object whose vertices are the points of the current frame, for geometry nodes and
particles. Its attributes are ``velocity`` (m/s), ``volume`` (cubic metres), ``seconds`` until it lands and ``radius``
of a ball of that volume, in Blender units. A modifier draws balls; it may be replaced.
"""

import math
from pathlib import Path

import bpy
import numpy as np

from ..base import compat, compat_nodes
from ..base.map_kinds import BY_NAME
from ..base.node_builder import NodeBuilder
from ..cache.errors import CacheError
from ..cache.files import frame_file
from ..cache.flying import read_points
from ..cache.folder import baked_frames
from ..scene.pose import metres_per_unit
from . import look

NAME = "Flying Snow"
# Marks the object: the name of the scene whose bakes it shows.
MARK = "snowbough_flying"
_ATTRIBUTES = (("velocity", "FLOAT_VECTOR"), ("volume", "FLOAT"), ("seconds", "FLOAT"), ("radius", "FLOAT"))


def _folders(scene):
    for entry in scene.snowbough.receivers:
        if entry.object is not None and entry.folder:
            yield Path(bpy.path.abspath(entry.folder))


def find(scene):
    """The scene's object, or None."""
    return next((obj for obj in scene.objects if obj.get(MARK) == scene.name and obj.type == "MESH"), None)


def _points(scene, frame):
    found = []
    for folder in _folders(scene):
        try:
            found.append(read_points(folder / frame_file(BY_NAME["points"].name, frame)))
        except CacheError as error:
            print(f"Snowbough: {error}")
    return np.concatenate(found) if found else np.zeros((0, 8), np.float32)


def update(scene):
    """Sets the points of the current frame."""
    obj = find(scene)
    if obj is None or obj.library is not None:
        return
    points, unit = _points(scene, scene.frame_current), metres_per_unit(scene)
    mesh = obj.data
    mesh.clear_geometry()
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", (points[:, :3] / unit).ravel())
    radius = np.cbrt(points[:, 6] * (3.0 / (4.0 * math.pi))) / unit
    for (name, kind), values in zip(_ATTRIBUTES, (points[:, 3:6], points[:, 6], points[:, 7], radius)):
        attribute = mesh.attributes.new(name, kind, "POINT")
        attribute.data.foreach_set("vector" if kind == "FLOAT_VECTOR" else "value", values.ravel())
    mesh.update()


def _material(scene):
    material = bpy.data.materials.new(NAME)
    compat.use_material_nodes(material)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*look.of(scene).color, 1.0)
    shader.inputs["Roughness"].default_value = 0.8
    return material


def _ball_nodes(scene):
    """Geometry nodes that draw each point as a ball."""
    tree = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    compat_nodes.add_group_socket(tree, "INPUT", "NodeSocketGeometry", "Geometry")
    compat_nodes.add_group_socket(tree, "OUTPUT", "NodeSocketGeometry", "Geometry")
    builder = NodeBuilder(tree)
    source = builder.node("NodeGroupInput")
    radius = builder.node("GeometryNodeInputNamedAttribute", data_type="FLOAT")
    radius.inputs["Name"].default_value = "radius"
    balls = builder.node("GeometryNodeMeshToPoints")
    builder.set(balls.inputs["Mesh"], source.outputs[0])
    builder.set(balls.inputs["Radius"], builder.output(radius))
    painted = builder.node("GeometryNodeSetMaterial")
    painted.inputs["Material"].default_value = _material(scene)
    builder.set(painted.inputs["Geometry"], balls.outputs[0])
    builder.set(builder.node("NodeGroupOutput").inputs[0], painted.outputs[0])
    return tree


def show(scene):
    """Makes the object, or updates it. Raises ValueError if no bake has points."""
    if not any(baked_frames(folder, "points") for folder in _folders(scene)):
        raise ValueError("No bake has flying snow: switch Flying Snow on in Maps and Cache, then bake")
    obj = find(scene)
    if obj is None:
        obj = bpy.data.objects.new(NAME, bpy.data.meshes.new(NAME))
        obj[MARK] = scene.name
        # Bakes ignore it.
        obj.snowbough.is_shell = True
        obj.snowbough.occlude = False
        scene.collection.objects.link(obj)
        obj.modifiers.new(NAME, "NODES").node_group = _ball_nodes(scene)
    update(scene)
    return obj


@bpy.app.handlers.persistent
def _on_frame(scene, _depsgraph=None):
    update(scene)


def register():
    bpy.app.handlers.frame_change_post.append(_on_frame)


def unregister():
    bpy.app.handlers.frame_change_post.remove(_on_frame)
