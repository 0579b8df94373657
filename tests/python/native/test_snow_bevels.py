# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface over bevels and rounded edges: as over sharp edges."""

import functools

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import bevelled_box, box, smooth, unfolded
from snow_rays import first_hits

# Metres.
DEPTH = 0.2
HALF = 0.5


def heights(mesh, resolution):
    """A map with snow on whatever faces up, lower towards the sides of the box, as repose leaves it."""
    positions, triangles, uv = mesh
    table = native.texel_table(triangles, uv, resolution)
    corners = positions[triangles[table["triangle"]]]
    b, c = table["barycentric"].T
    points = (np.stack([1 - b - c, b, c], axis=1)[:, :, None] * corners).sum(axis=1)
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = up[:, 2] / np.linalg.norm(up, axis=1)
    inside = HALF - abs(points[:, :2]).max(axis=1)
    snow = np.zeros(resolution * resolution, np.float32)
    snow[table["texel"]] = np.where(up > 0.2, np.minimum(DEPTH, 0.1 + 0.9 * inside) * up, 0.0)
    return snow.reshape(resolution, resolution)


def highest(triangles, points):
    """Height of the highest of `triangles` (T, 3, 3) at each of `points` (N, 2)."""
    below = np.column_stack([points, np.full(len(points), -10.0)])
    return -10.0 - first_hits(below, triangles, (0.0, 0.0, -1.0))


def shown(mesh, resolution, **settings):
    """Mean vertical thickness of the shown snow over the box in metres, and the number of points."""
    positions, triangles, uv = mesh
    snow = heights(mesh, resolution)
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, DEPTH, **settings)
    begin, corners, _ = surface.faces()
    fans = [
        (corners[b], corners[k], corners[k + 1])
        for b, e in zip(begin, begin[1:])
        for k in range(b + 1, e - 1)
    ]
    places = np.stack(np.meshgrid(*[np.linspace(-HALF, HALF, 122)[1:-1]] * 2), axis=2).reshape(-1, 2)
    ground = positions[triangles]
    base = highest(ground, places)
    places, base = places[np.isfinite(base)], base[np.isfinite(base)]
    drawn = np.concatenate([ground, surface.points(snow, DEPTH)[np.array(fans)]])
    return float((highest(drawn, places) - base).mean()), surface.point_count


@functools.cache
def sharp():
    positions, triangles, _ = box()
    faces = [positions[triangles[k][[0, 1, 2]]] for k in range(0, 12, 2)]
    faces = [np.array([*face, positions[triangles[2 * k + 1][2]]]) for k, face in enumerate(faces)]
    *mesh, resolution = unfolded(faces, 0.01)
    return shown(mesh, resolution)


@pytest.mark.parametrize("bevel, segments", [(0.02, 1), (0.02, 2), (0.02, 3), (0.04, 1), (0.04, 8)])
@pytest.mark.parametrize("shading", [None, smooth])
def test_bevels_and_rounded_edges_show_as_much_snow_as_sharp_edges(bevel, segments, shading):
    *mesh, resolution = bevelled_box(bevel, segments)
    given = {"shading": shading(*mesh[:2])} if shading else {}
    thickness, points = shown(mesh, resolution, **given)
    assert thickness == pytest.approx(sharp()[0], rel=0.05)
    # Each edge along a rounded edge is a row of points more.
    assert points > 0.85 * sharp()[1]


def test_a_bevel_costs_no_points():
    *mesh, resolution = bevelled_box(0.02, 2)
    assert shown(mesh, resolution)[1] == pytest.approx(sharp()[1], rel=0.05)
