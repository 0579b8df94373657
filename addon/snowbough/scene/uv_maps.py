# SPDX-License-Identifier: GPL-3.0-or-later
"""The UV map that stores snow: choosing it, and making one without overlaps.

Each place of the surface needs its own place on the map. If an object has no such map, a map ``snow`` is made by Smart
UV Project, or by Lightmap Pack if that gives overlaps; for meshes of many cards, by card_layout. The active map stays
active.
"""

import bpy
import numpy as np

from ..base import compat
from ..base.names import SNOW_UV
from . import uv_overlap
from .card_layout import card_layout

MAX_UV_MAPS = 8


def choose_uv_map(wanted, names, active):
    """The UV map that a receiver uses: `wanted` if it is set, else ``snow``, else the active one, else None."""
    if wanted:
        return wanted if wanted in names else None
    if SNOW_UV in names:
        return SNOW_UV
    return active or (names[0] if names else None)


def corner_uv(mesh, name):
    """(T, 3, 2) of a mesh's UV map, one row per triangle."""
    compat.ensure_triangles(mesh)
    corners = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    uv = compat.read_uv(mesh.uv_layers[name], len(mesh.loops))
    return uv[corners].reshape(-1, 3, 2)


def is_clean(mesh, name):
    """True if the UV map has no overlaps, lies inside 0 to 1 and has an area."""
    uv = corner_uv(mesh, name)
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    if not len(uv) or np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() <= 0:
        return False
    limit = uv_overlap.TOLERANCE
    return uv_overlap.outside_share(uv) == 0 and uv_overlap.overlap_share(uv, enough=limit) <= limit


def is_complete(mesh, name):
    """True if the UV map exists and is clean, and every face with an area also has one on the map."""
    if name not in mesh.uv_layers or not is_clean(mesh, name):
        return False
    corners = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    places = compat.read_positions(mesh)[corners].reshape(-1, 3, 3).astype(np.float64)
    areas = np.linalg.norm(np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]), axis=1)
    uv = corner_uv(mesh, name)
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    is_lost = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) == 0.0
    return float(areas[is_lost].sum()) <= 1e-3 * float(areas.sum())


def clean_uv_map(mesh):
    """Name of a UV map that snow can use, or None: ``snow``, the active one, any other."""
    active = mesh.uv_layers.active
    names = [layer.name for layer in mesh.uv_layers]
    order = sorted(names, key=lambda name: (name != SNOW_UV, active is None or name != active.name))
    return next((name for name in order if is_clean(mesh, name)), None)


def make_uv_map(context, obj):
    """Unwraps obj without overlaps into a UV map ``snow`` and returns its name. Raises ValueError if the mesh cannot be
    changed."""
    mesh = obj.data
    if mesh.library is not None or obj.library is not None:
        raise ValueError(
            f"'{obj.name}' is linked from another file and has no UV map without overlaps: unwrap it there"
        )
    layer = mesh.uv_layers.get(SNOW_UV)
    if layer is None:
        if len(mesh.uv_layers) >= MAX_UV_MAPS:
            raise ValueError(f"'{obj.name}' already has {MAX_UV_MAPS} UV maps: remove one")
        first = not mesh.uv_layers
        active = None if first else mesh.uv_layers.active.name
        layer = mesh.uv_layers.new(name=SNOW_UV, do_init=False)
    else:
        active = mesh.uv_layers.active.name
    name = layer.name
    if not _lay_out_cards(context, mesh, name):
        _unwrap(context, obj, name)
    mesh = obj.data
    if active is not None:
        mesh.uv_layers.active = mesh.uv_layers[active]
    return name


def _lay_out_cards(context, mesh, name):
    """Unwraps a mesh of thousands of small pieces. Returns whether it is one."""
    if context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    begin = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", begin)
    uv = card_layout(compat.read_positions(mesh), compat.read_corner_vertices(mesh), begin)
    if uv is None:
        return False
    compat.set_uv(mesh.uv_layers[name], uv)
    return is_clean(mesh, name)


def _unwrap(context, obj, name):
    """Unwraps this object with Smart UV Project, or with Lightmap Pack if needed. Restores the selection."""
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
