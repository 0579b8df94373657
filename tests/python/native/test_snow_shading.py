# SPDX-License-Identifier: GPL-3.0-or-later
"""Thickness on surfaces that are shaded smooth: it follows their interpolated normals, and volumes stay."""

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import DOWN, new_simulation, volume
from snow_meshes import STAYS, box, chart_of_box, grid, rotated, smooth, sphere, wind


def snow_on(
    mesh, shading=None, direction=DOWN, resolution=256, dt=0.0, flutter=0.0, steps=1, max_depth=100.0
):
    """Height for a depth of 1, texel area and statistics."""
    positions, triangles, uv = mesh
    with new_simulation(pixel_size=0.008, max_depth=max_depth, flutter=flutter, repose=STAYS) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution, shading=shading)
        for _ in range(steps):
            sim.step({"it": positions}, 0.05 / steps, direction, dt)
        return sim.height("it") / 0.05, sim.texel_area("it"), sim.statistics()


def latitudes(resolution=256):
    """Of a sphere's rows of texels, from straight down to straight up."""
    return (((np.arange(resolution) + 0.5) / resolution - 0.02) / 0.96 - 0.5) * np.pi


@pytest.mark.parametrize("flutter, steps", [(0.0, 1), (np.radians(3.0), 16)])
def test_snow_on_a_smooth_ball_follows_the_cosine_without_terraces(flutter, steps):
    mesh = sphere(0.5, 32, 16)
    height, area, _ = snow_on(mesh, smooth(*mesh[:2]), flutter=flutter, steps=steps)
    rise = latitudes()
    upper = (rise > 0.0) & (rise < 0.5 * np.pi)
    off = (height - np.sin(rise)[:, None])[upper]
    assert abs(off[area[upper] > 0.0]).max() < 0.02
    # The map's rows at the pole are not covered as wholes; below it goes from row to row as the cosine does.
    assert abs(np.diff(off[:-20, 8:-8], axis=0)).max() < 0.004
    assert volume(height, area) == pytest.approx(np.pi * 0.25, rel=0.01)
    flat, _, _ = snow_on(mesh)
    assert abs((flat - np.sin(rise)[:, None])[upper][:-20, 8:-8]).max() > 0.05


@pytest.mark.parametrize("direction", [DOWN, wind(30.0, 40.0), wind(70.0)])
def test_a_smooth_surface_holds_what_its_flat_triangles_would(direction):
    for mesh in (sphere(0.5, 32, 16), sphere(0.5, 8, 4), box()):
        flat = volume(*snow_on(mesh, direction=direction)[:2])
        assert flat > 0.1
        smoothed = volume(*snow_on(mesh, smooth(*mesh[:2]), direction)[:2])
        assert smoothed == pytest.approx(flat, rel=2e-3 if direction == DOWN else 0.02)


def test_a_box_shaded_smooth_keeps_its_level_top_and_bare_walls():
    mesh = box()
    height, _, _ = snow_on(mesh, smooth(*mesh[:2]))
    assert abs(chart_of_box(height, 5) - 1.0).max() < 1e-5
    for wall in (0, 1, 2, 3, 4):
        assert chart_of_box(height, wall).max() == 0.0


def test_an_open_plane_shaded_smooth_is_covered_evenly():
    positions, triangles, uv = grid(cells=3)
    for tilt in (0, 30, 60):
        mesh = rotated(positions, "x", tilt), triangles, uv
        height, _, _ = snow_on(mesh, smooth(positions, triangles))
        lain = height[height > 0.0]
        assert abs(lain - np.cos(np.radians(tilt))).max() < 1e-5


def test_numbers_that_are_all_negative_are_none_to_the_bit():
    mesh = sphere(0.5, 16, 8)
    flat, _, _ = snow_on(mesh)
    numbers = np.full((len(mesh[1]), 3), -1, np.int32)
    assert (snow_on(mesh, numbers)[0] == flat).all()


def test_a_sharp_edge_between_smooth_faces_stays_sharp():
    # A roof of two slopes, each of which is smooth in itself: as flat as without any numbers.
    positions = np.array(
        [(-1, -1, 0), (0, -1, 1), (0, 1, 1), (-1, 1, 0), (1, -1, 0.2), (1, 1, 0.2)], np.float32
    )
    triangles = np.array([(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)], np.int32)
    corners = positions[:, :2] * 0.48 + 0.5
    mesh = positions, triangles, corners[triangles].astype(np.float32)
    numbers = triangles + np.array([0, 0, 10, 10])[:, None]
    height, _, _ = snow_on(mesh, numbers.astype(np.int32))
    assert abs(height - snow_on(mesh)[0]).max() < 1e-5
    joined, _, _ = snow_on(mesh, triangles)
    assert abs(height - joined).max() > 0.02


def test_smooth_normals_follow_the_pose():
    positions, triangles, uv = sphere(0.5, 32, 16)
    turned = rotated(positions, "y", 90.0)
    height, _, _ = snow_on((turned, triangles, uv), smooth(positions, triangles))
    table = native.texel_table(triangles, uv, 256)
    corners = turned[triangles][table["triangle"]].astype(np.float64)
    weights = table["barycentric"]
    at = corners[:, 0] + sum(weights[:, i, None] * (corners[:, i + 1] - corners[:, 0]) for i in (0, 1))
    up = at[:, 2] / np.linalg.norm(at, axis=1)
    found = height.ravel()[table["texel"]]
    inner = (table["coverage"] == 1.0) & (abs(up) < 0.98) & (abs(at[:, 0]) < 0.45)
    assert abs(found - up.clip(0.0))[inner].max() < 0.03


def test_what_a_smooth_ball_holds_is_not_terraced_either():
    mesh = sphere(0.5, 32, 16)
    # 0.05 m fall, level ground holds 0.02: all of the upper half is at rest at its capacity.
    height, area, _ = snow_on(mesh, smooth(*mesh[:2]), dt=1e6, max_depth=0.02)
    rise = latitudes()
    at_rest = (area > 0.0) & (rise > 0.1)[:, None]
    assert abs(height - 0.4 * np.sin(rise)[:, None])[at_rest].max() < 0.4 * 0.02


def test_shading_of_another_shape_is_refused():
    positions, triangles, uv = grid()
    with new_simulation() as sim, pytest.raises(ValueError, match=r"'it'.*shading.*\(T, 3\), T = 2"):
        sim.add_object("it", triangles, uv, shading=np.zeros((1, 3), np.int32))
