# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding overlaps in UV layouts (snowbough.scene.uv_overlap), without Blender."""

import time

import numpy as np
import pytest
from snowbough.scene import uv_overlap


def square(x, y, size):
    a, b, c, d = (x, y), (x + size, y), (x + size, y + size), (x, y + size)
    return [[a, b, c], [a, c, d]]


def test_neighbouring_triangles_share_no_cell():
    numbers = np.random.default_rng(7)
    edge = 17
    points = np.stack(np.meshgrid(np.linspace(0, 1, edge), np.linspace(0, 1, edge)), axis=-1)
    points[1:-1, 1:-1] += numbers.uniform(-0.02, 0.02, points[1:-1, 1:-1].shape)
    a, b, c, d = (points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1])
    triangles = np.concatenate(
        [np.stack([a, b, c], -2).reshape(-1, 3, 2), np.stack([c, d, a], -2).reshape(-1, 3, 2)]
    )
    assert uv_overlap.overlap_share(triangles) == 0.0
    assert uv_overlap._count_cells(triangles * 64, 64) == (64 * 64, 0)


def test_half_overlapping_squares_are_found():
    triangles = square(0.0, 0.0, 0.5) + square(0.25, 0.0, 0.5)
    # 0.5 x 0.25 of the covered 0.5 x 0.75 overlap.
    assert uv_overlap.overlap_share(triangles) == pytest.approx(1 / 3, abs=1e-3)


def test_a_mirrored_copy_on_the_same_place_is_found():
    first = np.array(square(0.1, 0.1, 0.8))
    assert uv_overlap.overlap_share(np.concatenate([first, first[:, ::-1]])) == 1.0


def test_charts_side_by_side_are_clean():
    assert (
        uv_overlap.overlap_share(square(0.0, 0.0, 0.5) + square(0.5, 0.0, 0.5) + square(0.0, 0.5, 0.5)) == 0.0
    )


def test_an_empty_or_flat_layout_has_no_overlap():
    assert uv_overlap.overlap_share(np.empty((0, 3, 2))) == 0.0
    assert uv_overlap.overlap_share(np.zeros((5, 3, 2))) == 0.0


def test_corners_outside_the_map_are_counted():
    assert uv_overlap.outside_share(square(0.0, 0.0, 1.0)) == 0.0
    assert uv_overlap.outside_share(square(0.5, 0.0, 1.0)) == pytest.approx(0.5)
    assert uv_overlap.outside_share(np.full((1, 3, 2), 1 + 5e-5)) == 0.0


def test_thousands_of_cards_on_one_place_are_found_in_no_time():
    """6,283 cards cover the whole map: drawn one by one, they would take 12.9 million rows."""
    cards = np.array(square(0.0, 0.0, 1.0) * 6283)
    begun = time.process_time()
    assert uv_overlap.overlap_share(cards, enough=uv_overlap.TOLERANCE) > uv_overlap.TOLERANCE
    assert time.process_time() - begun < 2.0


def test_batches_of_triangles_count_the_same_cells(monkeypatch):
    numbers = np.random.default_rng(3)
    points = numbers.uniform(-4.0, 68.0, (200, 3, 2))
    whole = uv_overlap._count_cells(points, 64)
    monkeypatch.setattr(uv_overlap, "MAX_SPANS", 100)
    assert len(uv_overlap._batches(points, 64)) > 20
    assert uv_overlap._count_cells(points, 64) == whole
