# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews the sliders of snow surfaces in the current frame. The operator Update Surface computes all frames.

For the preview, the surface's modifier reads a file in Blender's temporary folder. The next frame change restores the
bake's file.
"""

import hashlib
from dataclasses import replace
from pathlib import Path

import bpy

from ..base import native, session
from ..cache.errors import CacheError
from ..cache.files import SURFACE_POINTS
from ..scene.receivers import surface_style
from ..settings import surface as sliders
from ..surface import compute
from ..surface.point_cache import PointCacheWriter
from . import displacement, snow_surface

# Maximum number of surfaces in memory. They are kept so that a slider's movement does not plan them again.
MAX_KEPT = 256


def _kept(folder, style):
    """The compute.Surface of a folder with a style, from memory if possible."""
    stamp = (folder / SURFACE_POINTS).stat().st_mtime_ns
    known = session.surfaces.get(folder)
    if known is None or known[0] != (stamp, style.detail):
        while len(session.surfaces) >= MAX_KEPT:
            session.surfaces.pop(next(iter(session.surfaces)))
        known = session.surfaces[folder] = (
            (stamp, style.detail),
            compute.Surface(native.load(), folder, style),
        )
    surface = known[1]
    surface.set_style(style)
    return surface


def _show_now(scene, obj, folder, style):
    summary = compute.read_summary(folder)
    # The faces change only with Update Surface, so keep their detail.
    surface = _kept(folder, replace(style, detail=summary["style"]["detail"]))
    index = min(max(scene.frame_current - summary["first"], 0), summary["frames"] - 1)
    name = hashlib.blake2b(str(folder).encode(), digest_size=8).hexdigest()
    path = Path(bpy.app.tempdir) / f"snowbough_{name}.pc2"
    points = surface.points(index)
    with PointCacheWriter(path, len(points)) as cache:
        cache.add(points)
        cache.publish()
    snow_surface.show_points(scene, obj, path, summary["first"])
    session.shown_surfaces[obj.name] = str(folder)


def show_sliders(context):
    """Shows the current frame with the current sliders. Surfaces that cannot be computed stay unchanged."""
    if session.bake is not None:
        return
    scene = context.scene
    for receiver, obj, folder in snow_surface.folders(scene):
        style = surface_style(scene, receiver)
        if obj is None or style is None:
            continue
        try:
            _show_now(scene, obj, folder, style)
        except (ValueError, CacheError, OSError, native.NativeModuleMissing):
            continue  # Update Surface reports the error


@bpy.app.handlers.persistent
def _put_back(*_):
    """Restores the bake's files, before a frame change and before saving."""
    for name, folder in list(session.shown_surfaces.items()):
        del session.shown_surfaces[name]
        obj = bpy.data.objects.get(name)
        summary = compute.read_summary(folder) if obj is not None else None
        if summary is not None:
            scene = (*obj.users_scene, bpy.context.scene)[0]
            snow_surface.show_points(scene, obj, Path(folder) / SURFACE_POINTS, summary["first"])


def tasks(scene, objects=()):
    """[(receiver, folder, SurfaceStyle)] of the surfaces that Update Surface computes. objects: names of receivers; all
    if empty."""
    found = []
    for receiver, _, folder in snow_surface.folders(scene):
        style = surface_style(scene, receiver)
        if style is not None and (not objects or receiver.object.name in objects):
            found.append((receiver, folder, style))
    return found


def refresh(scene, receivers):
    """Shows the new surface files of receivers."""
    session.surfaces.clear()
    session.shown_surfaces.clear()
    for receiver in receivers:
        displacement.refresh(scene, receiver)


def register():
    sliders.changed.append(show_sliders)
    bpy.app.handlers.frame_change_pre.append(_put_back)
    bpy.app.handlers.save_pre.append(_put_back)


def unregister():
    sliders.changed.remove(show_sliders)
    bpy.app.handlers.frame_change_pre.remove(_put_back)
    bpy.app.handlers.save_pre.remove(_put_back)
