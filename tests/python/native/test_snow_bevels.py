# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface over bevels and rounded edges: as over sharp edges."""

import functools

import numpy as np
import pytest
import snowbough_native as native
from shown_snow import faces_of, highest, map_of, shown_over
from snow_meshes import bevelled_box, box, smooth, unfolded

# Metres.
DEPTH = 0.2
HALF = 0.5


def height(points, up):
    """Snow on whatever faces up, lower towards the sides of the box, as repose leaves it."""
    inside = HALF - abs(points[:, :2]).max(axis=1)
    return np.where(up > 0.2, np.minimum(DEPTH, 0.1 + 0.9 * inside) * up, 0.0)


def shown(mesh, resolution, **settings):
    """Mean vertical thickness of the shown snow over the box in metres, and the number of points."""
    places = np.stack(np.meshgrid(*[np.linspace(-HALF, HALF, 122)[1:-1]] * 2), axis=2).reshape(-1, 2)
    base = highest(mesh[0][mesh[1]], places)
    places, base = places[np.isfinite(base)], base[np.isfinite(base)]
    top, surface = shown_over(mesh, map_of(mesh, resolution, height), DEPTH, places, **settings)
    return float((top - base).mean()), surface.point_count


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


@pytest.mark.parametrize("segments", [1, 2, 3])
def test_a_bevel_costs_no_points(segments):
    *mesh, resolution = bevelled_box(0.02, segments)
    assert shown(mesh, resolution)[1] == pytest.approx(sharp()[1], rel=0.05)


@pytest.mark.parametrize("is_smooth", [False, True])
def test_no_coarse_triangle_cuts_off_the_corner_of_a_rounded_box(is_smooth):
    """The snow within it would be as flat as it."""
    *mesh, resolution = bevelled_box(0.06, 8, size=0.8, height=0.5)
    positions, triangles, uv = mesh
    snow = map_of(mesh, resolution, lambda points, up: np.where(up > 0.3, 0.25 * up, 0.0))
    shading = {"shading": smooth(positions, triangles)} if is_smooth else {}
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, 0.3, **shading)
    a, b, c = surface.points(0.0 * snow, 1e-4)[faces_of(surface)].transpose(1, 0, 2)
    middle = (a + b + c) / 3.0
    in_corner = (np.abs(middle[:, :2]).min(axis=1) > 0.2) & (middle[:, 2] > 0.49)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    assert area[in_corner].max() < 0.055 * 0.3**2
