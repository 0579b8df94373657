# SPDX-License-Identifier: GPL-3.0-or-later
"""What a snow surface shows: its height by rays."""

import numpy as np
import snowbough_native as native
from snow_rays import first_hits


def map_of(mesh, resolution, height):
    """A map from height(points (N, 3), upward component of the normals (N,)) in metres."""
    positions, triangles, uv = mesh
    table = native.texel_table(triangles, uv, resolution)
    corners = positions[triangles[table["triangle"]]]
    b, c = table["barycentric"].T
    points = (np.stack([1 - b - c, b, c], axis=1)[:, :, None] * corners).sum(axis=1)
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    snow = np.zeros(resolution * resolution, np.float32)
    snow[table["texel"]] = height(points, up[:, 2] / np.linalg.norm(up, axis=1))
    return snow.reshape(resolution, resolution)


def highest(triangles, points):
    """Height of the highest of `triangles` (T, 3, 3) at each of `points` (N, 2); -inf where there is none."""
    below = np.column_stack([points, np.full(len(points), -10.0)])
    return -10.0 - first_hits(below, triangles, (0.0, 0.0, -1.0))


def faces_of(surface):
    """Triangles of a surface's faces, indices of its points (T, 3)."""
    begin, corners, _ = surface.faces()
    return np.array(
        [
            (corners[b], corners[k], corners[k + 1])
            for b, e in zip(begin, begin[1:])
            for k in range(b + 1, e - 1)
        ]
    )


def shown_over(mesh, snow, depth, points, style=None, **settings):
    """Height of the shown snow or the receiver, whichever is higher, at each of `points` (N, 2); and the surface.
    style: sliders by name."""
    positions, triangles, uv = mesh
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, depth, **settings)
    surface.set_style(**(style or {}))
    drawn = np.concatenate([positions[triangles], surface.points(snow, depth)[faces_of(surface)]])
    return highest(drawn, points), surface
