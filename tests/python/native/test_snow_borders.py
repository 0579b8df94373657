# SPDX-License-Identifier: GPL-3.0-or-later
"""Where snow ends on smooth steep places: a clean line, a round edge, and no scraps on walls."""

import functools

import numpy as np
import pytest
import snowbough_native as native
from shown_snow import map_of
from snow_meshes import box, grid, smooth, sphere
from snow_rays import first_hits

DEPTH = 0.2
RADIUS = 0.5
PIXEL = 0.02 * DEPTH
SIDEWAYS = (0.0, 1.0, 0.0)


def lying(points, up):
    """Snow down to a slope of 65 degrees, where it ends at once, as stability leaves it."""
    return np.where(up > 0.35, 0.7 * DEPTH * up, 0.0)


def faces_of(surface, snow):
    begin, corners, _ = surface.faces()
    fans = [
        (corners[b], corners[k], corners[k + 1])
        for b, e in zip(begin, begin[1:])
        for k in range(b + 1, e - 1)
    ]
    return surface.points(snow, DEPTH)[np.array(fans)]


@functools.cache
def side_view():
    """Thickness of the snow on the middle of a ball, seen from the side, at pixels (rows upwards)."""
    x, z = np.meshgrid(
        np.arange(-0.6, 0.6, PIXEL / RADIUS) * RADIUS, np.arange(0.0, 0.7, PIXEL / RADIUS) * RADIUS
    )
    mesh = positions, triangles, uv = sphere(RADIUS)
    snow = map_of(mesh, 512, lying)
    surface = native.SnowSurface(
        triangles, uv, positions, snow, snow, DEPTH, shading=smooth(positions, triangles)
    )
    before = np.stack([x, np.full_like(x, 10.0), z], axis=2).reshape(-1, 3)
    ball, shown = (
        first_hits(before, each, SIDEWAYS) for each in (positions[triangles], faces_of(surface, snow))
    )
    return (ball - np.minimum(shown, ball)).reshape(x.shape)


def blurred(picture, sigma):
    reach = int(4 * sigma) + 1
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    for axis in (0, 1):
        wide = np.pad(picture, [(reach, reach) if k == axis else (0, 0) for k in (0, 1)], "edge")
        picture = np.apply_along_axis(np.convolve, axis, wide, weight / weight.sum(), "valid")
    return picture


def raggedness(shown):
    """Mean distance between the border of a mask and the same border without details of 0.15 depths, in depths."""
    line = blurred(shown.astype(float), 0.15 * DEPTH / PIXEL) > 0.5
    length = (line[1:, :-1] != line[:-1, :-1]) | (line[:-1, 1:] != line[:-1, :-1])
    return (line != shown).sum() / length.sum() * PIXEL / DEPTH


def test_the_measure_is_low_for_a_circle_and_high_for_a_comb():
    x, y = np.meshgrid(*[np.arange(-RADIUS, RADIUS, PIXEL)] * 2)
    radius, turn = np.hypot(x, y), np.arctan2(y, x)
    assert raggedness(radius < 0.4) < 0.005
    assert raggedness(radius < 0.4 + 0.1 * DEPTH * np.sign(np.sin(turn * 40.0))) > 0.04


def test_snow_on_a_ball_ends_in_a_smooth_line():
    shown = side_view() > 0.0
    assert 0.3 < shown.mean() < 0.8
    assert raggedness(shown) < 0.006


def test_snow_on_a_ball_has_a_round_edge():
    """It rises over some tenths of a depth, not at once."""
    thickness = side_view()
    border = (thickness > 0.0).argmax(axis=0)
    near, far = (
        thickness[border + round(way * DEPTH / PIXEL), np.arange(len(border))].mean() for way in (0.05, 0.4)
    )
    assert near < 0.5 * far


@pytest.mark.parametrize("size, stays", [(0.6, False), (1.5, True)])
def test_small_scraps_on_walls_are_left_to_the_dusting(size, stays):
    def scrap(points, up):
        away = np.hypot(points[:, 1], points[:, 2] - 0.5)
        return np.where((points[:, 0] > 0.499) & (away < 0.5 * size * DEPTH), 0.25 * DEPTH, 0.0)

    positions, triangles, uv = box()
    snow = map_of((positions, triangles, uv), 256, scrap)
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, DEPTH)
    points = surface.points(snow, DEPTH)
    assert bool(len(points) and points[:, 0].max() > 0.51) == stays


def test_the_foot_of_a_heap_of_sand_shows():
    """Heaps at 34 degrees under three holes, half-way through the shot: their feet are thin beside their tops."""

    def heaps(part):
        def height(points, _up):
            of_one = [
                part * top
                - np.maximum(np.hypot(points[:, 0] - x, points[:, 1] - y) - 0.02, 0.0)
                * np.tan(np.radians(34))
                for x, y, top in ((-0.5, 0.0, 0.22), (0.36, -0.25, 0.16), (0.1, 0.62, 0.13))
            ]
            return np.maximum(np.max(of_one, axis=0), 0.0)

        return height

    ground = grid(2.6, 2.6, cells=64)
    last, now = (map_of(ground, 384, heaps(part)) for part in (1.0, 0.7))
    positions, triangles, uv = ground
    surface = native.SnowSurface(triangles, uv, positions, last, last, 0.25)
    carrier = surface.points(0.0 * last, 1e-4)
    shown = surface.points(now, 0.16)[:, 2] - carrier[:, 2]
    in_map = heaps(0.7)(carrier, None)
    assert (in_map > 0.03).sum() > 100
    assert (shown[in_map > 0.03] > 0.005).all()
    assert (shown[in_map <= 0.0] < 0.004).all()


def test_where_snow_has_melted_the_surface_lies_below_the_receiver():
    """In the receiver's own plane its faces would black out the ground."""
    ground = positions, triangles, uv = grid(2.0, 2.0, cells=32)

    def patch(points, _up):
        return np.where(np.hypot(points[:, 0], points[:, 1]) < 0.3, 0.02, 0.0)

    before, now = (
        map_of(ground, 256, lambda points, _up: np.full(len(points), 0.1)),
        map_of(ground, 256, patch),
    )
    surface = native.SnowSurface(triangles, uv, positions, before, before, 0.1)
    points = surface.points(now, 0.015)
    bare = np.hypot(points[:, 0], points[:, 1]) > 0.35
    assert bare.sum() > 500
    assert points[bare, 2].max() < -2e-4
