# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the receivers of a scene are, for things that are drawn beside them."""

from mathutils import Vector


def of_scene(scene):
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
