# SPDX-License-Identifier: GPL-3.0-or-later
"""The thesis's sharing over UV rectangles, which only the benchmarks have, on cases worked out by hand."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "benchmarks" / "snow"))
from thesis_mapping import lay_on_rectangles, uv_rectangles, visible_triangles  # noqa: E402

# A corner at the origin, others 4 m along x and 2 m along y; u grows by 0.2 a metre of y, v by 0.1 of x.
FLAT = np.array([[(0.0, 0.0), (4.0, 0.0), (0.0, 2.0)]])
UV = np.array([[(0.1, 0.2), (0.1, 0.6), (0.5, 0.2)]])


def lay(centre, extent, by_area=False):
    return lay_on_rectangles(
        np.array([centre]), np.array([extent]), np.array([12.0]), np.array([2.0]), 8, by_area
    )


def test_a_rectangle_is_centred_at_the_pixels_uv_and_as_wide_as_uv_runs_across_it():
    centre, extent = uv_rectangles(FLAT, UV, np.array([(1.0, 0.5)]), np.array([0]), 0.5)
    assert centre[0] == pytest.approx([0.1 + 0.5 * 0.2, 0.2 + 1.0 * 0.1])
    assert extent[0] == pytest.approx([0.5 * 0.2, 0.5 * 0.1])


def test_a_turned_chart_adds_what_uv_runs_along_both_edges_of_the_pixel():
    turned = np.array([[(0.0, 0.0), (0.4, 0.4), (-0.2, 0.2)]])  # 0.1 a metre along x, -0.1 and 0.1 along y
    _, extent = uv_rectangles(FLAT, turned, np.array([(1.0, 0.5)]), np.array([0]), 0.5)
    assert extent[0] == pytest.approx([0.1, 0.1])


def test_the_texels_whose_centres_lie_in_the_rectangle_share_its_snow():
    # On 8 x 8 texels: u from 2.4 to 4.6 holds the centres 2.5, 3.5, 4.5; v from 0.8 to 2.2 holds 1.5.
    height, written = lay((3.5 / 8, 1.5 / 8), (2.2 / 8, 1.4 / 8))
    expected = np.zeros((8, 8))
    expected[1, 2:5] = 12.0 / (3 * 2.0)
    assert height == pytest.approx(expected)
    assert written.tolist() == [3]


def test_a_rectangle_between_the_centres_loses_its_snow():
    height, written = lay((3.0 / 8, 3.0 / 8), (0.8 / 8, 0.8 / 8))
    assert not height.any()
    assert written.tolist() == [0]


def test_what_lies_beyond_the_map_is_lost():
    height, written = lay((0.0, 1.5 / 8), (4.0 / 8, 1.0 / 8))  # u from -2 to 2 texels
    assert height[1, :2] == pytest.approx(12.0 / (4 * 2.0))
    assert written.tolist() == [2]
    assert np.count_nonzero(height) == 2


def test_a_rectangle_with_one_texel_centre_gets_thicker_snow_by_its_area():
    height, _ = lay((3.5 / 8, 3.5 / 8), (0.5 / 8, 0.5 / 8), by_area=True)
    assert height[3, 3] == pytest.approx(12.0 / (0.25 * 2.0))
    assert np.count_nonzero(height) == 1


def test_rectangles_add_up():
    height, _ = lay_on_rectangles(
        np.full((2, 2), 3.5 / 8), np.full((2, 2), 1.0 / 8), np.array([2.0, 4.0]), np.array([2.0, 2.0]), 8
    )
    assert height[3, 3] == pytest.approx(3.0)


def test_a_pixel_shows_the_triangle_that_snow_meets_first():
    flat = np.array([[(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)], [(0.0, 0.0), (1.5, 0.0), (0.0, 1.5)]])
    depth = np.array([[2.0, 2.0, 2.0], [1.0, 1.0, 1.0]])
    centres, triangle = visible_triangles(flat, depth, 1.0, np.array([0.5, 0.5]))
    shown = {tuple(at): int(t) for at, t in zip(centres, triangle)}
    assert shown[(0.5, 0.5)] == 1
    assert shown[(1.5, 0.5)] == 0
    assert len(shown) == 10  # i + j <= 3 of the pixels' centres, the slanted edge included
