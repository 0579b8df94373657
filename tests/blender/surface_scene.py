# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked snow surfaces, and their points in the current frame."""

import math

import bpy
import numpy as np
import snow_scene as s


def bake_surfaces(folder, *objects, frames=(1, 4), resolution=64, **settings):
    """Bakes snow 0.1 m deep on the objects and shows it as surfaces, which are returned in the order of the objects."""
    s.receive(*objects, resolution=resolution)
    s.settings(folder, frames, **settings)
    bpy.context.view_layer.update()
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    return [surface_of(obj) for obj in objects]


def surface_of(obj):
    return bpy.data.objects[f"{obj.name} Snow"]


def points_of(surface):
    """The points of an object in the current frame, in the world, (V, 3) float64."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    local = np.empty(3 * len(evaluated.data.vertices), np.float32)
    evaluated.data.vertices.foreach_get("co", local)
    matrix = np.array(evaluated.matrix_world)
    return local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def points_at(surface, frame, subframe=0.0):
    """points_of() in another frame."""
    bpy.context.scene.frame_set(frame, subframe=subframe)
    return points_of(surface)


def inner(points, share=0.6):
    """The points within that fraction of the middle in x and y: level snow away from rims."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    return points[(np.abs(points[:, :2] - (low + high) / 2) < share * (high - low) / 2).all(axis=1)]


def level(points):
    """Median height of level snow away from rims: points are denser towards rims, where snow is lower."""
    return float(np.median(inner(points)[:, 2]))


def box(name, size=1.0, z=0.0):
    """A cube that stands at height z, with each face in a separate cell of the map."""
    h = size / 2
    corners = [(x, y, z + h + k) for k in (-h, h) for x, y in ((-h, -h), (h, -h), (h, h), (-h, h))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    cells, side = range(len(faces)), math.ceil(math.sqrt(len(faces)))
    uv = [
        ((cell % side + 0.1 + 0.8 * u) / side, (cell // side + 0.1 + 0.8 * v) / side)
        for cell in cells
        for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return s.mesh_object(name, corners, faces, uv)
