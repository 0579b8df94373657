# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of the drawn snow: as the map's, and made up for near the rims alone; and the shape of its edges."""

import numpy as np
import pytest
from shown_snow import faces_of, highest, map_of, shown_over
from snow_meshes import rotated
from snow_pieces import pieces
from snow_rays import first_hits

# Metres.
DEPTH, HALF, STEP = 0.2, 0.7, 0.02


def plate(pitch):
    """A plate of 1.4 m and its map, lower towards the rims, as repose leaves it."""
    *mesh, resolution = pieces([((0.0, 0.0, -0.02), (2 * HALF, 2 * HALF, 0.04), pitch)])
    along = np.cos(np.radians(pitch))

    def height(points, up):
        inside = HALF - np.maximum(abs(points[:, 0]), abs(points[:, 1]) / along)
        return np.where(up > 0.3, np.minimum(DEPTH, 0.03 + 2.0 * np.maximum(inside, 0.0)) * up, 0.0)

    return mesh, map_of(mesh, resolution, height)


def places(half, pitch=0.0):
    along = np.arange(-half, half, STEP) + 0.5 * STEP
    x, y = np.meshgrid(along, along)
    return np.stack([x.ravel(), np.cos(np.radians(pitch)) * y.ravel()], axis=1)


@pytest.mark.parametrize("pitch", [0.0, 35.0])
def test_far_from_rims_snow_is_drawn_as_high_as_its_map_says(pitch):
    mesh, snow = plate(pitch)
    middle = places(HALF - 2.0 * DEPTH, pitch)
    top, _ = shown_over(mesh, snow, DEPTH, middle, style={"relief": 0.0})
    thickness = top - highest(mesh[0][mesh[1]], middle)
    assert thickness.mean() == pytest.approx(DEPTH, rel=0.01)
    assert np.abs(thickness - DEPTH).max() < 0.02 * DEPTH


@pytest.mark.parametrize("pitch, close", [(0.0, 0.02), (35.0, 0.035)])
def test_what_fronts_add_is_taken_from_the_snow_behind_them(pitch, close):
    mesh, snow = plate(pitch)
    over = places(HALF + DEPTH, pitch)
    top, surface = shown_over(mesh, snow, DEPTH, over, style={"relief": 0.0})
    bottom = highest(mesh[0][mesh[1]], over)
    # Beside the plate snow hangs over.
    downwards = surface.points(snow, DEPTH)[faces_of(surface)] * np.float32([1.0, 1.0, -1.0])
    hanging = np.isfinite(top) & ~np.isfinite(bottom)
    bottom[hanging] = -highest(downwards[:, ::-1], over[hanging])
    drawn = (top - bottom)[np.isfinite(top)].sum() * STEP**2 * np.cos(np.radians(pitch))
    table = np.linspace(-HALF, HALF, 1401)
    inside = HALF - np.maximum(*np.abs(np.meshgrid(table, table)))
    held = np.minimum(DEPTH, 0.03 + 2.0 * inside).mean() * (2 * HALF) ** 2 * np.cos(np.radians(pitch))
    assert drawn == pytest.approx(held, rel=close)


def edge(pitch, axis):
    """How far the snow stands out beyond the verge (axis 0) or the eave (1) of a tilted plate, at heights of 0, 0.05,
    ... depths over the plate, in depths."""
    mesh, snow = plate(pitch)
    _, surface = shown_over(mesh, snow, DEPTH, places(0.1), style={"relief": 0.0, "hem_variation": 0.0})
    right, upslope, normal = rotated(np.eye(3), "x", pitch)
    drawn = surface.points(snow, DEPTH)[faces_of(surface)] @ np.stack([right, -upslope, normal], axis=1)
    behind, inwards = np.zeros((14, 3)), np.zeros(3)
    behind[:, axis], behind[:, 1 - axis], behind[:, 2] = -9.0, 0.05, np.arange(14) * 0.05 * DEPTH
    inwards[axis] = -1.0
    return (-9.0 - first_hits(behind, drawn, inwards) - HALF) / DEPTH


@pytest.mark.parametrize("pitch", [20.0, 35.0])
@pytest.mark.parametrize("axis", [0, 1], ids=["verge", "eave"])
def test_verges_and_eaves_have_a_full_rounded_edge(axis, pitch):
    profile = edge(pitch, axis)
    assert 0.05 < profile.max() < 0.15  # hangs over
    assert profile[8] > -0.15 and profile[13] < -0.1  # is full up to 0.4 depths, and recedes above
    assert np.diff(profile, 2).max() < 0.02  # turns in one round


@pytest.mark.parametrize("pitch", [20.0, 35.0])
def test_a_verge_bulges_above_its_rim(pitch):
    profile = edge(pitch, 0)
    assert profile.argmax() >= 3 and profile.max() > profile[0] + 0.02


@pytest.mark.parametrize("size", [0.3, 0.4])
def test_the_middle_of_a_narrow_top_does_not_stand_out(size):
    """The zones of four rims meet there."""
    *mesh, resolution = pieces([((0.0, 0.0, 0.5 * size), (size, size, size), 0.0)])
    snow = map_of(mesh, resolution, lambda places, up: np.where(up > 0.3, DEPTH, 0.0))
    along = np.arange(0.0, 0.09, 0.01)
    top, _ = shown_over(
        mesh,
        snow,
        DEPTH,
        np.stack([along, np.full(9, 0.001)], axis=1),
        style={"relief": 0.0, "hem_variation": 0.0},
    )
    assert np.abs(np.diff(top)).max() < 0.004
