# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface in the scene: a mesh object, child of its receiver (for an instance: of the instancer). A Mesh Cache
modifier reads its points from the bake's files, so nothing is computed when the frame changes.

The mesh data has the points without snow, so that nothing shows if the file is lost. An attribute has the points of the
last frame, which are coordinates of the material: they are fixed to the snow while it grows. On rigid receivers another
has the points without snow, from which the material sees how high the snow stands. A third says where the snow of two
pieces meets: their surfaces go on within each other, and light that entered there would leave a dark seam.

Scenes that share a receiver have a surface each, in a collection that no other scene shows. A copy of a baked scene
shares the surface until it bakes.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..base import compat, native
from ..base.names import (
    SNOW_UV,
    SURFACE_BARE_ATTRIBUTE,
    SURFACE_JOINT_ATTRIBUTE,
    SURFACE_MODIFIER,
    SURFACE_POSITION_ATTRIBUTE,
)
from ..cache.errors import CacheError
from ..cache.files import SURFACE_FACES, SURFACE_POINTS
from ..scene.libraries import library_name
from ..surface.compute import read_summary
from ..surface.mesh_file import read_mesh
from ..surface.point_cache import collapsed, read_point_cache
from . import baked_images, original_state, surface_material
from .snowfall import read_snowfall

# Distance in metres from a joint up to which less light enters the snow: about three times as far as it comes.
JOINT_REACH = 0.05


@dataclass
class _Member:
    """A mesh with snow: the receiver itself, or an object of the collection that it instances."""

    obj: bpy.types.Object
    folder: Path
    parent: bpy.types.Object


def _is_in(scene, collection):
    return collection == scene.collection or collection in scene.collection.children_recursive


def _collection_of(scene, obj):
    """The collection for an object's surface: one of its own, unless other scenes show it, too."""
    for collection in obj.users_collection:
        is_own = collection.library is None and collection.override_library is None
        if is_own and [s for s in bpy.data.scenes if _is_in(s, collection)] == [scene]:
            return collection
    return scene.collection


def _members(receiver):
    """The _Members of a receiver that have baked files."""
    obj = receiver.object
    if not receiver.folder:
        return []
    if obj.type == "MESH":
        return [_Member(obj, Path(bpy.path.abspath(receiver.folder)), obj)]
    found = []
    for (name, library), folder in baked_images.folders_of_members(receiver.folder, obj.name).items():
        for member in obj.instance_collection.all_objects if obj.instance_collection else ():
            if (member.name, library_name(member)) == (name, library):
                found.append(_Member(member, Path(folder), obj))
    return found


def _fill_mesh(mesh, file, bare):
    """Fills an empty mesh with the data of a surface.mesh_file.FileMesh, and with the points (V, 3) without snow."""
    corners, sides = file.corners, file.sides
    mesh.vertices.add(len(bare))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(bare, np.float32).ravel())
    mesh.loops.add(len(corners))
    compat.set_indices(mesh.loops, "vertex_index", corners)
    mesh.polygons.add(len(sides))
    starts = np.concatenate([[0], np.cumsum(sides)[:-1]]) if len(sides) else sides
    compat.set_polygons(mesh, starts, sides)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(sides), bool))
    mesh.update(calc_edges=True)
    layer = mesh.uv_layers.new(name=SNOW_UV, do_init=False)
    layer.data.foreach_set("uv", np.ascontiguousarray(file.corner_uv, np.float32).ravel())
    _store_points(mesh, SURFACE_POSITION_ATTRIBUTE, file.positions)


def _store_points(mesh, name, points):
    attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.ascontiguousarray(points, np.float32).ravel())


def _store_joints(mesh, file, scale):
    """scale: metres per unit of the points, for each axis."""
    triangles = np.concatenate([file.quads[:, (0, 1, 2)], file.quads[:, (0, 2, 3)], file.triangles])
    near = native.load().nearness_to_joints(file.positions * np.float32(scale), triangles, JOINT_REACH)
    mesh.attributes.new(SURFACE_JOINT_ATTRIBUTE, "FLOAT", "POINT").data.foreach_set("value", near)


def blend_path(path):
    """A path relative to the saved .blend file, so that both can be moved together; absolute if that is impossible."""
    if bpy.data.filepath:
        try:
            return bpy.path.relpath(str(path))
        except ValueError:  # another drive on Windows
            pass
    return str(path)


def show_points(scene, obj, path, first):
    """Sets the point cache of a surface's modifier. Its second sample belongs to frame `first` of the scene."""
    modifier = obj.modifiers[SURFACE_MODIFIER]
    modifier.filepath = blend_path(path)
    modifier.frame_start = first - 1
    modifier.frame_scale = 1.0 / compat.frame_length(scene)
    obj.update_tag()


def jump_where_hidden(obj, modifier, points):
    """Lets a Mesh Cache modifier show the nearer of two samples of its points (samples, V, 3) if the receiver is hidden
    in only one of them, where all points are in one place: between frames, in motion blur, snow would shrink."""
    changes = np.flatnonzero(np.diff(collapsed(points))).tolist()
    if not changes:
        return
    _, new_curve = compat.action_curves(obj, obj.name)
    curve = new_curve(f'modifiers["{modifier.name}"].interpolation', 0, "Snow")
    linear, nearest = 1, 0
    keys = {0: linear, **{sample + 1: linear for sample in changes}, **dict.fromkeys(changes, nearest)}
    for sample, value in sorted(keys.items()):
        key = curve.keyframe_points.insert((modifier.frame_start + sample) / modifier.frame_scale, value)
        key.interpolation = "CONSTANT"


def stretch(obj, length):
    """Lets a surface follow another length of frames."""
    modifier = obj.modifiers[SURFACE_MODIFIER]
    for curve in compat.curves_of(obj):
        if curve.data_path == f'modifiers["{SURFACE_MODIFIER}"].interpolation':
            for key in curve.keyframe_points:
                key.co.x *= length * modifier.frame_scale
            curve.update()
            obj.animation_data.action.update_tag()
    modifier.frame_scale = 1.0 / length


def _make_one(scene, member):
    """Makes the surface object of one member. Returns None if no surface was computed."""
    summary = read_summary(member.folder)
    if summary is None:
        return None
    file = read_mesh(member.folder / SURFACE_FACES)
    name = f"{member.obj.name} Snow"
    mesh = bpy.data.meshes.new(name)
    points = read_point_cache(member.folder / SURFACE_POINTS)
    if points.shape[1] != len(file.positions):
        raise CacheError(f"{member.folder / SURFACE_POINTS} does not match its faces: use Update Surface")
    _fill_mesh(mesh, file, points[0])
    sequence, wet = (baked_images.load_sequence(str(member.folder), kind) for kind in ("height", "wet"))
    snowfall = read_snowfall(member.folder)
    _store_joints(mesh, file, snowfall.scale)
    if snowfall.is_rigid:
        _store_points(mesh, SURFACE_BARE_ATTRIBUTE, points[0])
    mesh.materials.append(surface_material.make_material(scene, name, sequence, SNOW_UV, snowfall, wet))
    obj = bpy.data.objects.new(name, mesh)
    obj.snowbough.is_shell = True
    obj.snowbough.is_coarsened = summary.get("coarsened", False)
    obj.snowbough.occlude = False
    obj.parent = member.parent
    obj.lock_location = obj.lock_rotation = obj.lock_scale = (True,) * 3
    modifier = obj.modifiers.new(SURFACE_MODIFIER, "MESH_CACHE")
    modifier.cache_format = "PC2"
    modifier.interpolation = "LINEAR"
    show_points(scene, obj, member.folder / SURFACE_POINTS, summary["first"])
    jump_where_hidden(obj, modifier, points)
    _collection_of(scene, member.parent).objects.link(obj)
    return obj


def make(scene, receiver, materials=None):
    """Makes the receiver's surfaces from its baked files. materials: result of touched_materials() for the
    earlier surfaces. Returns the new objects, an empty list before the first bake. Raises CacheError for damaged files.
    """
    surfaces = [_make_one(scene, member) for member in _members(receiver)]
    surfaces = [surface for surface in surfaces if surface is not None]
    for surface in surfaces:
        surface_material.put_back(surface.data.materials[0], (materials or {}).get(surface.name, {}))
    record = original_state.read(receiver)
    record["shells"] = [surface.name for surface in surfaces]
    original_state.write(receiver, record)
    return surfaces


def _listed(receiver):
    """The names of the surfaces that a receiver lists."""
    record = original_state.read(receiver)
    return [*record.get("shells", ()), *([record["shell"]] if "shell" in record else [])]


def _other_scenes(receiver, surface):
    """The other scenes with the same object whose lists name a surface."""
    own = receiver.id_data.original
    return [
        scene
        for scene in bpy.data.scenes
        if scene != own
        and any(
            entry.object == receiver.object and surface.name in _listed(entry)
            for entry in scene.snowbough.receivers
        )
    ]


def find(receiver):
    """The receiver's existing surfaces in its scene."""
    scene, obj = receiver.id_data.original, receiver.object
    listed = [bpy.data.objects[name] for name in _listed(receiver) if name in bpy.data.objects]
    # A copy of the scene lists the surfaces of the objects that it copied.
    own = [surface for surface in listed if obj is None or surface.parent in (None, obj)]
    # Surfaces that were renamed by the artist, or restored by undo. If all are there, another one is a duplicate, which
    # the artist has made and keeps.
    is_whole = own and len(own) == len(_listed(receiver))
    others = [
        child
        for child in (obj.children if obj is not None and not is_whole else ())
        if child not in own and child.library is None and not _other_scenes(receiver, child)
    ]
    return [
        surface
        for surface in dict.fromkeys(own + others)
        if surface.snowbough.is_shell and (surface.name in scene.objects or not surface.users_scene)
    ]


def touched_materials(receiver):
    """{name of a surface: {slider of its material that the artist has changed: value}}."""
    return {
        surface.name: surface_material.touched(surface.data.materials[0])
        for surface in find(receiver)
        if surface.type == "MESH" and len(surface.data.materials) and surface.data.materials[0]
    }


def delete_object(surface):
    """Deletes a surface with its mesh, material and action."""
    mesh, action = surface.data, surface.animation_data and surface.animation_data.action
    materials = [slot.material for slot in surface.material_slots]
    bpy.data.objects.remove(surface)
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)
    for material in materials:
        if material is not None and material.users == 0:
            bpy.data.materials.remove(material)


def remove(receiver):
    """Deletes the receiver's surfaces, or leaves them to the other scenes that show them."""
    surfaces = find(receiver)
    record = original_state.read(receiver)
    for key in ("shell", "shells"):
        record.pop(key, None)
    original_state.write(receiver, record)
    for surface in surfaces:
        others = _other_scenes(receiver, surface)
        if others:
            _leave_to(others, receiver.id_data.original, surface)
        else:
            delete_object(surface)


def _leave_to(others, scene, surface):
    """Takes a surface out of a scene and keeps it in others."""
    for collection in surface.users_collection:
        if _is_in(scene, collection):
            collection.objects.unlink(surface)
    for other in others:
        if surface.name not in other.objects:
            other.collection.objects.link(surface)


def coarsened(scene):
    """Names of the receivers whose surfaces had too few points for their hems."""
    return [
        receiver.object.name
        for receiver in scene.snowbough.receivers
        if receiver.object is not None and any(obj.snowbough.is_coarsened for obj in find(receiver))
    ]


def folders(scene):
    """Yields (receiver, surface object or None, folder) for all baked meshes of a scene's receivers."""
    for receiver in scene.snowbough.receivers:
        if receiver.object is None:
            continue
        # Several scenes may have a surface of one receiver: "Ground Snow", "Ground Snow.001".
        objects = {re.sub(r" Snow(\.\d+)?$", "", obj.name): obj for obj in find(receiver)}
        for member in _members(receiver):
            yield receiver, objects.get(member.obj.name), member.folder
