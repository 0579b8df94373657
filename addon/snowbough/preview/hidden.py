# SPDX-License-Identifier: GPL-3.0-or-later
"""Hides baked snow while the preview runs, and restores it in every case.

The objects themselves store how they were. So an undo to a step with a running preview, or an auto-saved file, brings
that record with it, and show_again() can restore the objects.
"""

import json

import bpy

from ..base.names import OWN_MODIFIERS
from ..result import snow_surface


def hide(scene):
    """Hides the snow surfaces of the scene's receivers, and their displacement modifiers, in the viewport."""
    for entry in scene.snowbough.receivers:
        for shell in snow_surface.find(entry):
            _hide(shell, shell.hide_viewport, {})
            shell.hide_viewport = True
    for obj in scene.objects:
        own = [modifier for modifier in obj.modifiers if modifier.name in OWN_MODIFIERS]
        if own and obj.library is None and not obj.snowbough.is_shell:
            _hide(obj, None, {modifier.name: modifier.show_viewport for modifier in own})
            for modifier in own:
                modifier.show_viewport = False


def _hide(obj, was_hidden, modifiers):
    if not obj.snowbough.hidden_by_preview:
        obj.snowbough.hidden_by_preview = json.dumps({"hidden": was_hidden, "modifiers": modifiers})


def show_again():
    """Reverts hide() in all scenes."""
    for obj in bpy.data.objects:
        note = obj.snowbough.hidden_by_preview
        if not note or obj.library is not None:
            continue
        before = json.loads(note)
        if before["hidden"] is not None:
            obj.hide_viewport = before["hidden"]
        for name, shown in before["modifiers"].items():
            if name in obj.modifiers:
                obj.modifiers[name].show_viewport = shown
        obj.snowbough.hidden_by_preview = ""
