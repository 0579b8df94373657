# SPDX-License-Identifier: GPL-3.0-or-later
"""The balance of all snow (snowbough.cache.ledger), from the entries of receivers, without Blender."""

import pytest
from snowbough.cache import ledger

ROOF = {"frame": 3, "depth": 0.1, "fallen": 2.0, "volume": 0.5, "stretched": 0.0, "slid": 1.5}
YARD = {"frame": 3, "depth": 0.1, "fallen": 4.0, "volume": 4.25, "stretched": 0.25, "slid": 0.0}


def test_without_landing_all_that_slides_off_has_left():
    assert ledger._row([ROOF, YARD]) == {
        "frame": 3, "depth": 0.1, "fallen": 6.0, "held": 4.75, "stretched": 0.25, "floor": 0.0, "left": 1.5, "air": 0.0,
    }  # fmt: skip


def test_with_landing_each_receiver_knows_where_the_snow_of_the_scene_is():
    common = {"floor": 0.75, "left": 0.25, "air": 0.5}
    row = ledger._row([{**ROOF, **common}, {**YARD, **common}])
    assert (row["floor"], row["left"], row["air"], row["held"]) == (0.75, 0.25, 0.5, 4.75)


def test_what_objects_take_away_is_counted_where_there_is_any():
    row = ledger._row([ROOF, {**YARD, "volume": 4.0, "pressed": 0.125, "cleared": 0.125}])
    assert (row["pressed"], row["cleared"], "masked" in row) == (0.125, 0.125, False)


@pytest.mark.parametrize(
    "floor, left, air, text",
    [
        (0.12, 0.0, 0.0, "Of all snow, 12% fell on objects that are no receivers"),
        (
            0.3,
            0.05,
            0.0,
            "Of all snow, 30% fell on objects that are no receivers and 5% fell out of the scene",
        ),
        (0.01, 0.01, 0.01, ""),
        (
            0.0,
            0.0,
            0.03,
            "Of all snow, 3% is still falling on the last frame: a longer shot, or Fall Time off, lets it land",
        ),
    ],
)
def test_only_shares_that_matter_are_named(floor, left, air, text):
    row = {"fallen": 2.0, "floor": 2.0 * floor, "left": 2.0 * left, "air": 2.0 * air}
    assert ledger.lost_text([row]) == text
    assert ledger.lost_text([]) == ""
