"""A flight from 80 m to 2 m: the part of a frame's change that the level of detail causes stays under a bound."""

import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "benchmarks" / "realtime"))
import flight  # noqa: E402
import scenes  # noqa: E402

#: Compared pairs of neighbouring frames of the flight.
PAIRS = np.linspace(0, flight.FRAMES - 2, 7).astype(int)
SIZE = (160, 120)
#: Parts of edges are as long, pixels; and where levels stay what they are.
TARGET, FIXED = 6.0, 2.0
#: Of 255, over blocks of 8 x 8 pixels: most that the level of detail may add to a block in a frame, and on average.
MOST = 4.0
MAX_MEAN = 0.12


@pytest.fixture(scope="module")
def renderer():
    things, trees = flight.scene(resolution=256)
    depth = 0.06
    heights = scenes.fallen(things, depth, steps=2, pixel_size=0.04, engine="CPU")
    with native.Renderer() as made:
        flight.put(made, heights, depth, things, trees)
        yield made


def picture(renderer, number, target_pixels, **options):
    return flight.smooth_picture(
        renderer, number, SIZE, target_pixels=target_pixels, shadow_resolution=0, **options
    )


def added_changes(renderer, target_of, pairs=PAIRS):
    """By pair and block: the change of a block minus its change at a constant level."""
    found = []
    for number in pairs:
        own = [picture(renderer, number + k, target_of(number + k)) for k in (0, 1)]
        fixed = [picture(renderer, number + k, FIXED, min_pixels=0) for k in (0, 1)]
        found.append(flight.block_change(*own) - flight.block_change(*fixed))
    return abs(np.array(found))


def test_nothing_pops_on_a_flight_from_far_to_near(renderer):
    added = added_changes(renderer, lambda number: TARGET)
    assert added.max() < MOST
    assert added.mean() < MAX_MEAN


def test_a_level_that_jumps_is_over_the_bound(renderer):
    added = added_changes(renderer, lambda number: 4.0 if number % 2 else 60.0, PAIRS[-2:])
    assert added.max() > MOST
    assert added.mean() > MAX_MEAN


def test_the_flight_goes_from_80_m_to_2_m_through_all_levels(renderer):
    counts = []
    for number in (0, flight.FRAMES - 1):
        renderer.render(
            flight.camera(number, SIZE), flight.settings(target_pixels=TARGET, shadow_resolution=0)
        )
        counts.append(renderer.statistics())
    assert [flight.distance(number) for number in (0, flight.FRAMES - 1)] == pytest.approx([80, 2])
    assert (
        counts[0]["tessellated"] < 0.5 * counts[0]["plain"] and counts[1]["plain"] < counts[1]["tessellated"]
    )
    of_tree = [one["triangles"] - one["passes"]["meshes"]["primitives"] for one in counts]
    assert of_tree[1] > 3 * of_tree[0]
