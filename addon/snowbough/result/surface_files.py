# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps snow surfaces and their files together: names lost files, and lets point caches follow Time Stretching.

Blender shows a surface without its file as its bare mesh, that is without snow, and says so only in the modifier. So
opening a file reports lost files in the panel, and a render without them fails: with an error of Snowbough Realtime,
and in the background, where no engine can be stopped, by ending Blender with exit code 1.
"""

from pathlib import Path

import bpy

from ..base import compat, session
from ..base.names import REALTIME_ENGINE, SURFACE_MODIFIER
from ..cache.errors import CacheError
from ..surface.point_cache import read_point_cache
from . import snow_surface

# Surfaces in one message.
MAX_NAMED = 3


def _modifiers(scene):
    """(surface, its modifier) of all snow surfaces of a scene."""
    for obj in scene.objects:
        modifier = obj.modifiers.get(SURFACE_MODIFIER) if obj.snowbough.is_shell else None
        if modifier is not None:
            yield obj, modifier


def points_of(surface):
    """(samples, V, 3) of a surface's point cache, the first without snow. Raises CacheError with what to do."""
    modifier = surface.modifiers[SURFACE_MODIFIER]
    path = bpy.path.abspath(modifier.filepath, library=surface.library)
    try:
        points = read_point_cache(Path(path))
    except CacheError as error:
        raise CacheError(f"'{surface.name}' shows no snow: {error}") from error
    if points.shape[1] != len(surface.data.vertices):
        raise CacheError(
            f"'{surface.name}' shows no snow: {path} has {points.shape[1]} points, and the surface "
            f"{len(surface.data.vertices)}: bake again, or use Update Surface"
        )
    return points


def problems(scene):
    """Texts about the surfaces of a scene, shown in renders, whose files are missing or do not fit."""
    found = []
    for obj, modifier in _modifiers(scene):
        if obj.hide_render or not modifier.show_render:
            continue
        try:
            points_of(obj)
        except CacheError as error:
            found.append(str(error))
    return found


def require_files(scene):
    """Raises CacheError with the problems of a scene."""
    found = problems(scene)
    if found:
        more = f"; and {len(found) - MAX_NAMED} more" if len(found) > MAX_NAMED else ""
        raise CacheError("; ".join(found[:MAX_NAMED]) + more)


def _rendered_scenes(scene):
    """A scene, and those that its render shows in strips of the sequencer or as background."""
    found, waiting = [], [scene]
    while waiting:
        one = waiting.pop()
        if one is None or one in found:
            continue
        found.append(one)
        waiting.append(one.background_set)
        waiting += [
            strip.scene for strip in compat.strips_of(one) if strip.type == "SCENE" and not strip.mute
        ]
    return found


@bpy.app.handlers.persistent
def _before_render(scene, *_):
    if session.bake is not None:
        return
    try:
        for one in _rendered_scenes(scene):
            require_files(one)
    except CacheError as error:
        session.last_outcome = ("ERROR", str(error))
        print(f"Error: {error}")
        ends_itself = scene.render.engine == REALTIME_ENGINE
        if bpy.app.background and bpy.app.binary_path and not ends_itself:
            raise SystemExit(f"Snowbough ends this render: {error}") from None


@bpy.app.handlers.persistent
def _after_load(*_):
    session.frame_lengths.clear()
    _follow_stretching()
    for scene in bpy.data.scenes:
        try:
            require_files(scene)
        except CacheError as error:
            session.last_outcome = ("ERROR", str(error))
            print(f"Error: {error}")


@bpy.app.handlers.persistent
def _follow_stretching(*_):
    """Lets the point caches follow frames if Time Stretching was changed."""
    for scene in bpy.data.scenes:
        length = compat.frame_length(scene)
        if session.frame_lengths.get(scene.name) == length:
            continue
        session.frame_lengths[scene.name] = length
        for obj, _ in _modifiers(scene):
            if obj.library is None:
                snow_surface.stretch(obj, length)


HANDLERS = (
    ("render_init", _before_render),
    ("load_post", _after_load),
    ("save_pre", _follow_stretching),
    ("frame_change_pre", _follow_stretching),
)


def register():
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
