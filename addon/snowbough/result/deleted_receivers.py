# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes the snow surfaces of deleted receivers."""

import bpy

from ..base import session
from . import snow_surface


def _deleted(scene):
    """Receivers whose object was deleted or is in no scene, but whose surface is in one."""
    return [
        entry
        for entry in scene.snowbough.receivers
        if (entry.object is None or not entry.object.users_scene)
        and any(surface.users_scene for surface in snow_surface.find(entry))
    ]


def _remove():
    if session.bake is None and session.preview is None:
        for scene in bpy.data.scenes:
            for entry in _deleted(scene):
                snow_surface.remove(entry)


@bpy.app.handlers.persistent
def _schedule_removal(scene, *_):
    # Objects must not be removed during an update of the scene, so use a timer.
    if _deleted(scene) and not bpy.app.timers.is_registered(_remove):
        bpy.app.timers.register(_remove, first_interval=0.0)


def register():
    bpy.app.handlers.depsgraph_update_post.append(_schedule_removal)


def unregister():
    bpy.app.handlers.depsgraph_update_post.remove(_schedule_removal)
