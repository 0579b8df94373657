# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's list of receivers: finding, adding and reading its entries, and the bounds of its objects."""

import json
from dataclasses import replace

from mathutils import Vector

from ..base.names import MAX_RESOLUTION, SNOW_RESOLUTION_PROPERTY, SNOW_UV, counted
from ..surface.style import SLIDERS, SurfaceStyle
from . import uv_maps
from .libraries import library_name
from .masks import mask_spec
from .pose import ReceiverSpec


def find(scene, obj):
    """The entry of an object, or None."""
    return next((entry for entry in scene.snowbough.receivers if entry.object == obj), None)


def scattered_by(context, obj):
    """{name: number of instances} of the objects that obj scatters by geometry nodes or instancing, sorted by name."""
    counts = {}
    for instance in context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance and instance.parent is not None and instance.parent.original == obj:
            name = instance.object.original.name
            counts[name] = counts.get(name, 0) + 1
    return dict(sorted(counts.items()))


def scattered_text(counts):
    """The result of scattered_by as text: 3 instances ('Leaf' 1, 'Stone' 2)."""
    named = ", ".join(f"'{name}' {count}" for name, count in counts.items())
    return f"{counted(sum(counts.values()), 'instance')} ({named})"


def _check_geometry_nodes(context, obj, uv_map):
    """Raises ValueError if geometry nodes leave an object without faces, or make faces without a place on the UV
    map."""
    if not any(modifier.type == "NODES" and modifier.show_render for modifier in obj.modifiers):
        return
    mesh = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    if not len(mesh.polygons):
        raise ValueError(f"'{obj.name}' has no faces: {_without_faces(context, obj, mesh)}")
    if uv_map and not uv_maps.is_complete(mesh, uv_map):
        raise ValueError(
            f"The geometry nodes of '{obj.name}' make faces that have no place on the UV map '{uv_map}': "
            "apply the nodes (Object > Apply > Visual Geometry to Mesh), then add snow again"
        )


def _without_faces(context, obj, mesh):
    """Why an object has no faces, and what to do."""
    counts = scattered_by(context, obj)
    if counts:
        return (
            f"its geometry nodes scatter {scattered_text(counts)}. End them with Realize Instances, apply them "
            "(Object > Apply > Visual Geometry to Mesh), then add snow again"
        )
    if len(mesh.vertices):
        return "it consists of points only. Put meshes on the points (Instance on Points, Realize Instances)"
    return "its geometry nodes make no surface"


def _bare_mesh(obj):
    """Why an object whose own mesh has no faces cannot carry snow, and what to do."""
    if any(modifier.type == "NODES" for modifier in obj.modifiers):
        return (
            f"'{obj.name}' has only faces made by its geometry nodes, which have no UV map: apply the nodes "
            "(Object > Apply > Visual Geometry to Mesh), then add snow again"
        )
    points = "consists of points only" if len(obj.data.vertices) else "is empty"
    return f"'{obj.name}' has no faces: it {points}, and snow lies on faces only"


def add(context, obj):
    """Adds obj to the list, once, with a UV map that snow can use. Returns its entry. Raises ValueError if it cannot
    carry snow."""
    scene = context.scene
    uv_map = ""
    if obj.type == "MESH":
        _check_geometry_nodes(context, obj, "")
        if not len(obj.data.polygons):
            raise ValueError(_bare_mesh(obj))
        existing = find(scene, obj)
        if existing is not None and existing.uv_map in obj.data.uv_layers:
            return existing
        uv_map = uv_maps.clean_uv_map(obj.data)
        made = uv_map is None
        uv_map = uv_map or uv_maps.make_uv_map(context, obj)
        try:
            _check_geometry_nodes(context, obj, uv_map)
        except ValueError:
            if made:
                obj.data.uv_layers.remove(obj.data.uv_layers[uv_map])
            raise
    elif not (obj.type == "EMPTY" and obj.instance_type == "COLLECTION"):
        raise ValueError(
            f"'{obj.name}' is not a mesh and instances no collection: convert it to a mesh first"
        )
    entry = find(scene, obj)
    if entry is None:
        entry = scene.snowbough.receivers.add()
        entry.object = obj
        entry.name = obj.name
    entry.uv_map = uv_map
    scene.snowbough.active_receiver = len(scene.snowbough.receivers) - 1
    return entry


def members(obj):
    """The meshes of the collection that an object instances, also by nested instancers."""
    return sorted({own for own, _ in _all_members(obj)}, key=lambda own: own.name)


def members_without_map(obj):
    """Names of the meshes of the collection that an object instances, also by nested instancers, that have no UV map
    and can only be unwrapped themselves. They carry no snow."""
    return sorted(
        {own.name for own, _ in _all_members(obj) if len(own.data.polygons) and not own.data.uv_layers}
    )


def hidden_members(obj):
    """Names of the meshes of the collection that an object instances that are hidden in renders, without a key."""
    return sorted({own.name for own, is_hidden in _all_members(obj) if is_hidden})


def _all_members(obj, is_hidden=False, outer=()):
    """(mesh object, whether it or its instancer is hidden in renders for good) of a collection instancer."""
    collection = obj.instance_collection if obj.type == "EMPTY" else None
    if collection is None or collection in outer:
        return
    for member in collection.all_objects:
        hidden = is_hidden or (member.hide_render and member.animation_data is None)
        if member.type == "MESH" and member.snowbough.occlude:
            yield member, hidden
        yield from _all_members(member, hidden, (*outer, collection))


def receiver_resolution(entry):
    """The resolution of an entry. If it is 0, the one that the map ``snow`` of an imported tree was packed for (the
    width of its gutters depends on it), or else 0, automatic."""
    laid_out = entry.object.get(SNOW_RESOLUTION_PROPERTY, 0) if entry.uv_map in ("", SNOW_UV) else 0
    return entry.resolution or min(int(laid_out), MAX_RESOLUTION)


def surface_style(scene, entry):
    """The SurfaceStyle of an entry; None if its snow is not shown as a surface."""
    is_shown = json.loads(entry.restore or "{}").get("displacement") == "SHELL"
    return snow_style(scene, entry) if is_shown else None


def snow_style(scene, entry):
    """The SurfaceStyle of an entry, however its snow is shown."""
    settings = scene.snowbough
    source = entry if entry.own_surface else settings
    sliders = {name: getattr(source, f"surface_{name}") for name in SLIDERS}
    return SurfaceStyle(settings.surface_detail, **sliders)


def receiver_specs(scene, as_baked=False):
    """The scene's list as ReceiverSpec, without empty and repeated entries. as_baked: with members; receivers keep the
    names of their first bake, and no other receiver gets one of these."""
    entries = {}
    for entry in scene.snowbough.receivers:
        if entry.object is not None:
            entries.setdefault((entry.object.name, library_name(entry.object)), entry)
    taken = {(entry.baked_as, library) for (_, library), entry in entries.items() if entry.baked_as}
    specs = []
    for (name, library), entry in entries.items():
        spec = ReceiverSpec(
            name,
            library,
            entry.uv_map,
            receiver_resolution(entry),
            entry.enabled,
            entry.sides,
            surface_style(scene, entry),
            mask=mask_spec(entry),
            shed_half_life=entry.shed_half_life,
        )
        if as_baked:
            known_as = entry.baked_as or _free_name(scene, name, library, taken)
            spec = replace(spec, baked_as=known_as, members=tuple(_members(entry.object)))
        specs.append(spec)
    return specs


def _members(obj):
    """(name, library) of the meshes of the collection that an object instances, except those that are always hidden."""
    for member in (
        obj.instance_collection.all_objects if obj.type == "EMPTY" and obj.instance_collection else ()
    ):
        is_always_hidden = member.hide_render and member.animation_data is None
        if member.type == "MESH" and member.snowbough.occlude and not is_always_hidden:
            yield member.name, library_name(member)


def _free_name(scene, name, library, taken):
    """A name for a receiver that was never baked: its own, or another one if a renamed receiver was baked under it."""
    number, free = 1, name
    while (free, library) in taken or (free != name and free in scene.objects):
        number += 1
        free = f"{name} ({number})"
    taken.add((free, library))
    return free


def note_baked_names(scene, specs):
    """Stores the names under which the receivers of a new bake are known from now on."""
    names = {(spec.name, spec.library): spec.known_as for spec in specs}
    for entry in scene.snowbough.receivers:
        if entry.object is not None and not entry.baked_as:
            entry.baked_as = names.get((entry.object.name, library_name(entry.object)), "")


def bounds(scene):
    """(centre, radius) of the receivers' bounding boxes in Blender units; ((0, 0, 0), 1) without any."""
    corners = [
        receiver.object.matrix_world @ Vector(corner)
        for receiver in scene.snowbough.receivers
        if receiver.object is not None
        for corner in receiver.object.bound_box
    ]
    if not corners:
        return Vector(), 1.0
    low = Vector(map(min, zip(*corners)))
    high = Vector(map(max, zip(*corners)))
    return (low + high) / 2.0, max((high - low).length / 2.0, 1e-6)
