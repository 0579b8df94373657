# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets deforming objects store the undeformed positions of their points, so that grains and relief stay in place.

This uses Blender's own option (Object properties). The receiver's record stores whether we enabled it.
"""

import bpy

from ..base.names import OWN_MODIFIERS

_RECORD = "rest_position"


def keep(obj, record):
    """Enables it for a local mesh object that deforms. Returns whether the object stores the positions."""
    if obj.library or obj.override_library or not hasattr(obj, "add_rest_position_attribute"):
        return False
    if not obj.data.shape_keys and all(modifier.name in OWN_MODIFIERS for modifier in obj.modifiers):
        return obj.add_rest_position_attribute
    if not obj.add_rest_position_attribute:
        obj.add_rest_position_attribute = True
        record.setdefault(_RECORD, []).append(obj.name)
    return True


def release(record):
    """Disables it for the objects for which keep() enabled it."""
    for name in record.pop(_RECORD, ()):
        if name in bpy.data.objects:
            bpy.data.objects[name].add_rest_position_attribute = False
