# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's list of receivers: operators that put objects on it and take them off.

Snow needs a UV map that stores every place once. add_receivers takes the map ``snow`` or the active one
where it does not overlap; otherwise it makes a map ``snow``, by Smart UV Project, or by Lightmap Pack where
that does not come out clean. The object's active map stays the active one. It also dresses the objects
with snow material and displacement, which show nothing until there are baked files; a bake refreshes them.
"""

import bpy
import numpy as np

from . import bake_lock, compat, displacement, uv_overlap

SNOW_UV = "snow"
MAX_UV_MAPS = 8
MAKES_SURFACE = {"MESH"}


def find(scene, obj):
    """The list's line for an object, or None."""
    return next((entry for entry in scene.snowbough.receivers if entry.object == obj), None)


def chosen(context):
    """The receivers that an operator without further words means: those that are selected, else all."""
    entries = [entry for entry in context.scene.snowbough.receivers if entry.object is not None]
    selected = [entry for entry in entries if entry.object.select_get(view_layer=context.view_layer)]
    return selected or entries


def corner_uv(mesh, name):
    """(T, 3, 2) of a mesh's UV map, one row a triangle."""
    compat.ensure_triangles(mesh)
    corners = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    uv = compat.read_uv(mesh.uv_layers[name], len(mesh.loops))
    return uv[corners].reshape(-1, 3, 2)


def is_clean(mesh, name):
    """True where the UV map stores every place once, inside the map, and has an area at all."""
    uv = corner_uv(mesh, name)
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    if not len(uv) or np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() <= 0:
        return False
    return uv_overlap.outside_share(uv) == 0 and uv_overlap.overlap_share(uv) <= uv_overlap.TOLERANCE


def clean_uv_map(mesh):
    """Name of a UV map that snow can use as it is, or None: ``snow``, the active one, any other."""
    active = mesh.uv_layers.active
    names = [layer.name for layer in mesh.uv_layers]
    order = sorted(names, key=lambda name: (name != SNOW_UV, active is None or name != active.name))
    return next((name for name in order if is_clean(mesh, name)), None)


def make_uv_map(context, obj):
    """Unwraps obj without overlaps into a UV map ``snow`` and returns the map's name.
    Raises ValueError where the mesh cannot be changed."""
    mesh = obj.data
    if mesh.library is not None or obj.library is not None:
        raise ValueError(
            f"'{obj.name}' is linked from another file and has no UV map without overlaps: unwrap it there"
        )
    layer = mesh.uv_layers.get(SNOW_UV)
    if layer is None:
        if len(mesh.uv_layers) >= MAX_UV_MAPS:
            raise ValueError(f"'{obj.name}' has {MAX_UV_MAPS} UV maps already: remove one")
        first = not mesh.uv_layers
        active = None if first else mesh.uv_layers.active.name
        layer = mesh.uv_layers.new(name=SNOW_UV, do_init=False)
    else:
        active = mesh.uv_layers.active.name
    name = layer.name
    _unwrap(context, obj, name)
    mesh = obj.data
    if active is not None:
        mesh.uv_layers.active = mesh.uv_layers[active]
    return name


def _unwrap(context, obj, name):
    """Smart UV Project, then Lightmap Pack if need be, on this object only. Selection is put back."""
    layer = context.view_layer
    selected, active = list(context.selected_objects), layer.objects.active
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    layer.objects.active = obj
    try:
        for unwrap in (
            lambda: bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=0.004),
            lambda: bpy.ops.uv.lightmap_pack(PREF_CONTEXT="ALL_FACES", PREF_MARGIN_DIV=0.2),
        ):
            obj.data.uv_layers.active = obj.data.uv_layers[name]
            bpy.ops.object.mode_set(mode="EDIT")
            try:
                bpy.ops.mesh.reveal(select=False)
                bpy.ops.mesh.select_all(action="SELECT")
                unwrap()
            finally:
                bpy.ops.object.mode_set(mode="OBJECT")
            if is_clean(obj.data, name):
                break
    finally:
        obj.select_set(False)
        for other in selected:
            other.select_set(True)
        layer.objects.active = active


def add(context, obj):
    """Puts obj on the list (once) with a UV map that snow can use. Returns its line.
    Raises ValueError for what cannot gather snow."""
    scene = context.scene
    uv_map = ""
    if obj.type == "MESH":
        if not len(obj.data.polygons):
            raise ValueError(f"'{obj.name}' has no faces")
        existing = find(scene, obj)
        if existing is not None and existing.uv_map in obj.data.uv_layers:
            return existing
        uv_map = clean_uv_map(obj.data) or make_uv_map(context, obj)
    elif not (obj.type == "EMPTY" and obj.instance_type == "COLLECTION"):
        raise ValueError(f"'{obj.name}' is no mesh and instances no collection: convert it to a mesh first")
    entry = find(scene, obj)
    if entry is None:
        entry = scene.snowbough.receivers.add()
        entry.object = obj
        entry.name = obj.name
    entry.uv_map = uv_map
    scene.snowbough.active_receiver = len(scene.snowbough.receivers) - 1
    return entry


class SNOWBOUGH_OT_add_receivers(bake_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.add_receivers"
    bl_label = "Add Snow to Selected"
    bl_description = (
        "Let snow lie on the selected objects: gives them a UV map without overlaps where needed, snow material "
        "and displacement. They show snow once it is baked"
    )
    bl_options = {"REGISTER", "UNDO"}

    setup_result: bpy.props.BoolProperty(
        name="Set Up Material and Displacement",
        description="Also dress the objects for snow, as suits each; Remove Snow takes it off again",
        default=True,
    )

    @classmethod
    def ready(cls, context):
        if not context.selected_objects:
            cls.poll_message_set("Select meshes, or empties that instance a collection")
            return False
        return True

    def execute(self, context):
        added, refused = 0, []
        for obj in list(context.selected_objects):
            try:
                entry = add(context, obj)
                added += 1
                if self.setup_result and displacement.mode_of(entry) is None:
                    displacement.apply(context.scene, entry, displacement.default_mode(obj))
            except ValueError as error:
                refused.append(str(error))
        for text in refused:
            self.report({"WARNING"} if added else {"ERROR"}, text)
        return {"FINISHED"} if added else {"CANCELLED"}


class SNOWBOUGH_OT_remove_receiver(bake_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.remove_receiver"
    bl_label = "Take off the List"
    bl_description = "Take the active line off the list; the object and baked files stay as they are"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def ready(cls, context):
        if not len(context.scene.snowbough.receivers):
            cls.poll_message_set("The list is empty")
            return False
        return True

    def execute(self, context):
        settings = context.scene.snowbough
        settings.receivers.remove(settings.active_receiver)
        settings.active_receiver = max(0, min(settings.active_receiver, len(settings.receivers) - 1))
        return {"FINISHED"}


CLASSES = (SNOWBOUGH_OT_add_receivers, SNOWBOUGH_OT_remove_receiver)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
