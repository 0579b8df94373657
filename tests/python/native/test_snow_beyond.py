# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface where a face ends soon: short boards, bowls, and the snow of another receiver beyond a rim."""

import numpy as np
import pytest
from shown_snow import highest, map_of, shown_over
from snow_meshes import grid, lathe, smooth, unfolded
from snow_pieces import pieces, tile_courses

# Metres.
DEPTH = 0.3


def test_the_front_of_a_course_ignores_snow_beyond_the_end_of_its_face():
    count, length, slope = 8, 0.22, np.radians(40.0)

    def height(points, up):
        upper_end = (count + 0.25) * length - points[:, 1] * np.cos(slope) - points[:, 2] * np.sin(slope)
        return np.where(up > 0.7, np.clip(1.5 * upper_end, 0.0, 0.24), 0.0)

    *mesh, resolution = pieces(tile_courses(count))
    along = (count - 1.5) * length * np.cos(slope) + np.linspace(-0.05, 0.05, 7)
    places = np.stack(np.meshgrid(np.linspace(-0.15, 0.15, 11), along), axis=2).reshape(-1, 2)
    bare = highest(mesh[0][mesh[1]], places)
    top, _ = shown_over(mesh, map_of(mesh, resolution, height), DEPTH, places)
    assert (top - bare).mean() > 0.16


FLOOR, RIM, LEDGE, DEEP = 0.22, 0.26, 0.29, 0.09


def bowl():
    """A square bowl: walls of 70 degrees around a floor, a ledge of 3 cm around it, and outer walls."""

    def ring(half, z):
        return np.array([(x * half, y * half, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])

    rings = [ring(FLOOR, 0.0), ring(RIM, DEEP), ring(LEDGE, DEEP), ring(LEDGE, -0.2)]
    faces = [rings[0]]
    for inner, outer in zip(rings, rings[1:]):
        faces += [np.array([inner[k - 1], outer[k - 1], outer[k], inner[k]]) for k in range(4)]
    return unfolded(faces, 0.01)


def dome(points):
    """Top of the snow, as repose leaves it."""
    return 0.32 - 0.8 * np.maximum(np.abs(points[:, :2]).max(axis=1) - 0.1, 0.0)


def test_a_bowl_holds_one_heap_without_a_moat():
    *mesh, resolution = bowl()
    snow = map_of(
        mesh,
        resolution,
        lambda points, up: np.maximum(dome(points) - points[:, 2], 0.0) * np.maximum(up, 0.0),
    )
    along = np.linspace(-0.24, 0.24, 49)
    places = np.concatenate(
        [np.stack([along, 0.03 + 0 * along], axis=1), np.stack([0.05 + 0 * along, along], axis=1)]
    )
    top, _ = shown_over(mesh, snow, DEPTH, places)
    assert np.abs(top - dome(places)).max() < 0.08
    assert np.abs(top - dome(places)).mean() < 0.03


@pytest.mark.parametrize("shading", [None, smooth])
def test_an_urn_full_of_snow_has_a_level_top(shading):
    """Around its level bottom the slope grows in four steps: 13, 56, 73 and 63 degrees; then a flat lip and the
    outside. The map's snow is level at a height of 0.5 m."""
    profile = [(0.02, 0.18), (0.1, 0.2), (0.18, 0.32), (0.21, 0.42), (0.235, 0.47), (0.27, 0.47), (0.27, 0.1)]
    faces = [face[::-1] for face in lathe(profile, 32)]
    bottom = np.array([face[3] for face in faces[:32]])
    *mesh, resolution = unfolded([*faces, bottom], 0.01)
    snow = map_of(
        mesh, resolution, lambda points, up: np.maximum(0.5 - points[:, 2], 0.0) * np.maximum(up, 0.0)
    )
    around, out = np.meshgrid(np.linspace(0.1, 6.3, 24), np.linspace(0.04, 0.2, 9))
    places = np.stack([out * np.cos(around), out * np.sin(around)], axis=2).reshape(-1, 2)
    given = {"shading": shading(*mesh[:2])} if shading else {}
    top, _ = shown_over(mesh, snow, DEPTH, places, style={"relief": 0.0}, **given)
    assert np.abs(top - 0.5).max() < 0.09
    assert np.abs(top - 0.5).mean() < 0.055


@pytest.mark.parametrize("shading", [None, smooth])
@pytest.mark.parametrize("has_fan", [False, True])
def test_snow_on_the_earth_of_a_pot_is_a_dome(shading, has_fan):
    """The earth lies 8 cm below the lip, as one face or as a fan of 28 around a small one; the map's snow falls by 65
    degrees towards the lip."""
    profile = [(0.23, 0.34), (0.26, 0.42), (0.29, 0.42), (0.27, 0.38), (0.2, 0.06)]
    faces = [face[::-1] for face in lathe([(0.01, 0.33), *profile] if has_fan else profile, 28)]
    bottom = np.array([face[3] for face in faces[:28]])
    *mesh, resolution = unfolded([*faces, bottom], 0.01)

    def dome(points):
        return np.clip(0.42 + 2.14 * (0.27 - np.linalg.norm(points[:, :2], axis=1)), 0.0, 0.72)

    snow = map_of(
        mesh,
        resolution,
        lambda points, up: np.maximum(dome(points) - points[:, 2], 0.0) * np.maximum(up, 0.0),
    )
    around, out = np.meshgrid(np.linspace(0.1, 6.3, 24), np.linspace(0.04, 0.16, 7))
    places = np.stack([out * np.cos(around), out * np.sin(around)], axis=2).reshape(-1, 2)
    given = {"shading": shading(*mesh[:2])} if shading else {}
    top, _ = shown_over(mesh, snow, 0.3, places, style={"relief": 0.0}, **given)
    assert np.abs(top - dome(places)).max() < 0.13
    assert np.abs(top - dome(places)).mean() < 0.1


@pytest.mark.parametrize("below, is_covered", [(0.05, True), (0.5, False)])
def test_snow_goes_on_over_the_snow_of_another_receiver(below, is_covered):
    *slab, resolution = pieces([((0.0, 0.0, -0.05), (1.0, 1.0, 0.1), 0.0)])
    snow = map_of(slab, resolution, lambda points, up: np.where(up > 0.7, 0.2, 0.0))
    positions, triangles, uv = grid(3.0, 3.0)
    ground = (triangles, uv, positions - np.float32([0.0, 0.0, below]), np.full((64, 64), 0.2, np.float32))
    beside = np.stack([np.full(41, 0.51), np.linspace(-0.3, 0.3, 41)], axis=1)
    alone, _ = shown_over(slab, snow, 0.2, beside)
    top, _ = shown_over(slab, snow, 0.2, beside, neighbours=[ground])
    level = 0.2 - below - 0.01
    assert np.array_equal(alone, top) != is_covered
    if is_covered:
        assert (top > level).mean() > 0.95


def test_snow_on_a_sill_reaches_the_wall_that_holds_it():
    """The sill's back edge lies within the wall, which is another object."""
    *sill, resolution = pieces([((0.0, 0.0, -0.05), (1.0, 0.3, 0.05), 0.0)])
    snow = map_of(sill, resolution, lambda points, up: np.where((up > 0.7) & (points[:, 1] < 0.05), 0.2, 0.0))
    *wall, size = pieces([((0.0, 0.25, -1.0), (1.6, 0.4, 3.0), 0.0)])
    positions, triangles, uv = wall
    neighbour = (triangles, uv, positions, np.zeros((size, size), np.float32))
    before_it = np.stack([np.linspace(-0.3, 0.3, 31), np.full(31, 0.04)], axis=1)
    top, _ = shown_over(sill, snow, 0.2, before_it, neighbours=[neighbour])
    assert top.min() > 0.12
