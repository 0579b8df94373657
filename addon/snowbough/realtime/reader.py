# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts Blender's evaluated scene to a records.Scene.

The result contains all visible objects of the depsgraph: meshes, and the meshes that Blender makes of curves, texts and
metaballs. Instances of one object share one mesh. Bark and leaves of an imported tree become one records.Tree per
instance if only the armature deforms them. They become ordinary meshes otherwise, and also if snow lies on the leaves
or if the bark's snow map uses another UV map than that of the import.

Data stays in memory until `forget` reports a change, so unchanged geometry is read only once.
"""

import bpy
import numpy as np
from mathutils import Vector

from ..scene.libraries import library_name
from ..scene.pose import outliers
from . import materials, meshes, trees
from .lights import Lamp, light_of
from .records import Mesh, Scene, Shape
from .snow import NO_INDEX, SceneSnow, receiver_of

SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_Z = Vector((0.0, 0.0, 1.0))
# A change of such a data-block clears all looks. Blender also reports the materials of a changed node group.
LOOK_TYPES = (bpy.types.Material, bpy.types.Image)


class Reader:
    """Reads a scene repeatedly. native: the module; shows_live: whether to show the snow of a running live preview."""

    def __init__(self, native, shows_live=False):
        self._snow = SceneSnow(native, shows_live)
        self._revision = None
        self._bases = trees.Bases()
        self._looks = {}
        self._shapes = {}
        self._leaves = {}
        self._bark_images = {}
        self._snow_uvs = {}
        self.left_out = set()
        """Names of objects that are omitted in whole or in part: too far away, or with non-finite coordinates."""

    def forget(self, depsgraph):
        """Drops the data that has changed according to the depsgraph."""
        for update in depsgraph.updates:
            block = update.id
            if isinstance(block, LOOK_TYPES):
                self._looks.clear()
                self._shapes.clear()
                self._leaves.clear()
                self._bark_images.clear()
            elif isinstance(block, bpy.types.Mesh):  # edited; for a pose Blender reports only the object
                _drop(self._leaves, block)
                _drop(self._bark_images, block)
                _drop(self._snow_uvs, block)
            elif isinstance(block, bpy.types.Object):
                if update.is_updated_geometry or update.is_updated_shading:
                    _drop(self._shapes, block)

    def is_outdated(self, depsgraph):
        """Whether the live simulation's snow has changed since `read`."""
        return self._snow.revision(depsgraph.scene_eval) != self._revision

    def read(self, depsgraph, is_shown=None):
        """The records.Scene of a depsgraph. is_shown(original object) -> bool: an additional test for each object."""
        self._snow.begin(depsgraph.scene_eval)
        self._revision = self._snow.revision(depsgraph.scene_eval)
        self._meshes, self._trees, self._poses, lamps = {}, {}, {}, []
        for instance in depsgraph.object_instances:
            obj = instance.object
            if not (instance.is_instance or instance.show_self):
                continue
            shown = (instance.parent if instance.is_instance and instance.parent else obj).original
            if is_shown is not None and not is_shown(shown):
                continue
            if obj.type == "LIGHT":
                lamps.append(_lamp(obj, instance.matrix_world))
            elif obj.type in SURFACE_TYPES and not self._is_shell_of_ours(obj.original):
                self._add(instance, obj, depsgraph)
        grown = self._join_leaves()
        world = world_color(depsgraph.scene_eval.world)
        made = [Mesh(key, *parts) for key, parts in sorted(self._meshes.items())]
        for mesh in made:
            mesh.matrices = np.array(mesh.matrices, np.float32)
        light = light_of(lamps, world, _centre(made))
        return Scene(made, grown, light)

    def _is_shell_of_ours(self, original):
        return original.snowbough.is_shell and self._snow.is_drawn_otherwise(original)

    # -- trees ------------------------------------------------------------------------------------------

    def _add(self, instance, obj, depsgraph):
        original = obj.original
        receiver = receiver_of(instance, original)
        if not self._snow.is_on(receiver):
            receiver = None
        rig = trees.rig_of(original, depsgraph.mode)
        if rig is not None and self._add_to_tree(instance, obj, rig, receiver, depsgraph):
            return
        surface = None if receiver is None else self._snow.surface_of(receiver)
        if surface is not None:
            self._meshes[f"snow on {receiver.key}"] = (*surface, None)
            receiver = None
        self._add_shape(obj, np.array(instance.matrix_world), receiver)

    def _add_to_tree(self, instance, obj, rig, receiver, depsgraph):
        """Adds bark or leaves to a tree. Returns whether that is possible. receiver: its ReceiverId if it has
        snow, else None."""
        original = obj.original
        is_leaves = trees.is_leaves(original)
        if not is_leaves and not trees.is_unedited_bark(original):
            return False
        arrays, print_ = self._bases.of(rig)
        if arrays is None or (is_leaves and receiver is not None):
            return False
        snow = self._snow_on_bark(original, arrays, print_, receiver)
        if receiver is not None and snow is None:
            return False
        slot = self._trees.setdefault(_instance_name(instance, rig), {"rig": rig})
        matrix = np.array(instance.matrix_world)
        if is_leaves:
            slot["leaves"] = (obj, matrix)
            return True
        named = (original.name, library_name(original), rig.name, library_name(rig))
        if named not in self._poses:
            self._poses[named] = trees.pose_of(obj, rig.evaluated_get(depsgraph))
        pose = self._poses[named]
        if len(pose) != arrays["bone_count"]:
            return False
        looks = meshes.looks_of(obj, original.data, self._look, materials.PLAIN)
        images, images_print = self._bark_images_of(original, rig, arrays, print_, looks)
        slot["tree"] = trees.tree_of("", arrays, print_ + images_print, looks[0], pose, matrix, images, snow)
        return True

    def _snow_on_bark(self, original, arrays, print_, receiver):
        """The LyingSnow on a tree's base; None if there is none, or if its map does not fit the base."""
        if receiver is None:
            return None
        key = (original.data.name, library_name(original.data), print_)
        if key not in self._snow_uvs:
            self._snow_uvs[key] = trees.SnowUvs(original.data, arrays)
        return self._snow.of(receiver, self._snow_uvs[key])

    def _join_leaves(self):
        """The records.Tree of all instances with their leaves. Leaves without bark become meshes."""
        grown = []
        for key, slot in self._trees.items():
            tree, leaves = slot.get("tree"), slot.get("leaves")
            if tree is None:
                if leaves is not None:
                    self._add_shape(*leaves, None)
                continue
            if leaves is not None:
                tree.leaves, tree.leaves_print = self._leaves_of(leaves[0])
            rig = slot["rig"]
            grown.append((f"{rig.name} {library_name(rig)}", key, tree))
        return trees.joined(grown)

    def _bark_images_of(self, original, rig, arrays, print_, looks):
        """(BarkImages or None, its print) of a tree's bark. looks: the Look of each material."""
        key = (original.data.name, library_name(original.data), print_)
        if key not in self._bark_images:
            images = trees.bark_images_of(original, rig, arrays, looks)
            self._bark_images[key] = (images, "" if images is None else images.print)
        return self._bark_images[key]

    def _leaves_of(self, obj):
        original = obj.original
        key = (original.data.name, library_name(original.data))
        if key not in self._leaves:
            looks = meshes.looks_of(obj, original.data, self._look, materials.PLAIN)
            leaves = trees.leaves_of(original, looks)
            self._leaves[key] = (leaves, leaves.print)
        return self._leaves[key]

    # -- meshes -----------------------------------------------------------------------------------------

    def _add_shape(self, obj, matrix, receiver):
        """Adds an evaluated object with its matrix in the world. receiver: the ReceiverId of its snow, or None."""
        original = obj.original
        if outliers(matrix[:3]) is not None:
            self.left_out.add(original.name)
            return
        data = original.data.name if original.data is not None else ""
        # Mesh instances of geometry nodes share their object but not their mesh.
        key = (
            original.name,
            library_name(original),
            data,
            obj.data.as_pointer() if obj.type == "MESH" else 0,
        )
        known = self._shapes.get(key)
        if known is None or (known[2] is None and receiver is not None):
            known = self._shapes[key] = self._read_shape(obj, receiver is not None)
        shape, print_, snow_arrays = known
        if not len(shape.triangles):
            return
        name = f"mesh {' '.join(map(str, key[:3]))} {print_}"
        snow = None if receiver is None else self._snow.of(receiver, snow_arrays)
        if snow is not None and receiver.instancer:
            # An instance with its own map cannot share a mesh with others.
            name += f" of {receiver.key}"
        if name not in self._meshes:
            self._meshes[name] = (shape, print_, [], snow)
        self._meshes[name][2].append(matrix)

    def _read_shape(self, obj, carries):
        """(Shape, its print, _KeptUvs) of an evaluated object. The last is None unless it `carries` snow."""
        temporary = obj.type != "MESH"
        mesh = obj.to_mesh() if temporary else obj.data
        try:
            if mesh is None or not len(mesh.polygons):
                nothing = np.empty(0, np.float32)
                return Shape(nothing, nothing, nothing, nothing, nothing, ()), "", None
            if obj.original.snowbough.is_shell:
                looks = [materials.SNOW]
            else:
                looks = meshes.looks_of(obj, mesh, self._look, materials.PLAIN)
            read = meshes.MeshArrays(mesh)
            if read.has_outliers:
                self.left_out.add(obj.original.name)
            shape = meshes.shape_of(read, looks)
            shape.is_snow = obj.original.snowbough.is_shell
            return shape, shape.print, _KeptUvs(read, mesh) if carries else None
        finally:
            if temporary:
                obj.to_mesh_clear()

    def _look(self, material):
        key = (material.name, library_name(material)) if material is not None else None
        if key not in self._looks:
            self._looks[key] = materials.look_of(material)
        return self._looks[key]


def _drop(kept, block):
    """Removes the entries of a data-block, by its name and library."""
    name = (block.name, library_name(block))
    for key in [key for key in kept if key[:2] == name]:
        del kept[key]


class _KeptUvs:
    """Copies of the UV maps of a mesh, which may be freed."""

    def __init__(self, arrays, mesh):
        self._uvs = {layer.name: arrays.uv(layer.name) for layer in mesh.uv_layers}

    def uv(self, name):
        return self._uvs.get(name)


def _instance_name(instance, obj):
    """A name of an object's instance that is the same in every frame."""
    name = f"{obj.name} {library_name(obj)}"
    if not instance.is_instance:
        return name
    parent = instance.parent.original.name if instance.parent else ""
    # The first index identifies the object in the collection. It differs between bark and leaves of a tree, so skip it.
    order = [index for index in instance.persistent_id if index != NO_INDEX][1:]
    return f"{name} in {parent} {order}"


def _lamp(obj, matrix):
    lamp = obj.data
    direction = -(matrix.to_3x3() @ _Z).normalized()
    color = tuple(lamp.color)
    return Lamp(lamp.type, tuple(matrix.translation), tuple(direction), color, lamp.energy)


def _centre(made):
    """Mean position of the meshes."""
    middles = [mesh.matrices[:, :3, 3] for mesh in made]
    return tuple(np.concatenate(middles).mean(axis=0).tolist()) if middles else (0.0, 0.0, 0.0)


def world_color(world):
    """Linear colour of a world; a mean if it has an image or a sky texture."""
    if world is None:
        return (0.0, 0.0, 0.0)
    output = world.node_tree.get_output_node("ALL") if world.use_nodes and world.node_tree else None
    if output is None:
        return tuple(world.color)
    return materials.background_color(output) or tuple(world.color)
