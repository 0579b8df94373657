# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks scale what falls and what may lie; what they refuse is counted."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import assert_resumes
from child import in_child
from snow_meshes import STAYS, grid, turned_over

FRAME = 1.0 / 24.0
DOWN = (0.0, 0.0, -1.0)

both_engines = pytest.mark.parametrize("engine", ["CPU", "GL"])


def sheet(size=1.0, cells=1):
    return grid(size, size, cells)


def simulation(mesh, engine="CPU", resolution=64, **settings):
    sim = native.SnowSimulation(pixel_size=0.02, engine=engine, **{"repose": STAYS, **settings})
    sim.add_object("ground", mesh[1], mesh[2], resolution=resolution)
    return sim


def corners(mesh, weight):
    """A mask (T, 3) that has the same weight everywhere."""
    return np.full((len(mesh[1]), 3), weight, np.float32)


def halves(mesh, left, right):
    """A mask (T, 3) of a sheet with two columns of cells or more."""
    middle = mesh[0][mesh[1]].mean(axis=1)[:, 0]
    return np.repeat(np.where(middle < 0.0, left, right)[:, None], 3, axis=1).astype(np.float32)


def fall(sim, mesh, steps=8, depth=0.08):
    for _ in range(steps):
        sim.step(
            {"ground": mesh[0]} if sim.statistics()["step_number"] == 0 else {}, depth / steps, DOWN, FRAME
        )


def assert_nothing_is_lost(sim):
    now = sim.statistics()
    total = now["total"]
    kept = total["held_volume"] - total["stretched_volume"] + total["removed_volume"]
    away = now["air_volume"] + now["floor_volume"] + now["left_volume"]
    assert kept + away == pytest.approx(total["deposited_volume"], rel=1e-6)
    # The engines' own sums are of single precision.
    assert abs(total["stretched_volume"]) < 2e-6 * total["deposited_volume"]
    return total


@both_engines
@pytest.mark.parametrize("weight", [0.0, 0.5, 1.0])
def test_a_mask_takes_its_part_of_the_snow(engine, weight):
    mesh = sheet()
    sim = simulation(mesh, engine)
    sim.set_mask("ground", corners(mesh, weight))
    fall(sim, mesh)
    total = assert_nothing_is_lost(sim)
    assert total["deposited_volume"] == pytest.approx(0.08, rel=1e-4)
    volume = (sim.height("ground").astype(float) * sim.texel_area("ground")).sum()
    assert volume + total["masked_volume"] == pytest.approx(0.08, rel=1e-6)
    assert total["held_volume"] == pytest.approx(0.08 * weight, rel=1e-4, abs=2e-8)
    assert total["masked_volume"] == pytest.approx(0.08 * (1.0 - weight), rel=1e-4, abs=2e-8)


def test_a_mask_of_one_changes_no_byte():
    mesh = sheet()
    plain, masked = simulation(mesh, repose=1.0), simulation(mesh, repose=1.0)
    masked.set_mask("ground", corners(mesh, 1.0))
    for sim in (plain, masked):
        fall(sim, mesh)
    assert plain.height("ground").tobytes() == masked.height("ground").tobytes()


def test_a_removed_mask_leaves_no_state():
    mesh = sheet()
    sim = simulation(mesh)
    sim.set_mask("ground", corners(mesh, 0.5))
    fall(sim, mesh, 1)
    assert "planes" in native.simulation_state(sim)["objects"]["ground"]
    sim.set_mask("ground")
    fall(sim, mesh, 1)
    assert "planes" not in native.simulation_state(sim)["objects"]["ground"]


def test_an_image_masks_by_its_own_uv_map_and_repeats():
    mesh = sheet()
    sim = simulation(mesh)
    # Two tiles of an image whose upper half is 1: stripes of snow.
    sim.set_mask("ground", np.float32([[0.0], [0.0], [1.0], [1.0]]), mesh[2] * np.float32([1.0, 2.0]))
    fall(sim, mesh)
    assert_nothing_is_lost(sim)
    middle = sim.height("ground")[:, 32]
    v = (np.arange(64) + 0.5) / 64 * 2.0 % 1.0
    inside = (np.arange(64) > 2) & (np.arange(64) < 61)
    assert (middle[inside & (v > 0.15) & (v < 0.35)] == 0.0).all()
    assert middle[inside & (v > 0.65) & (v < 0.85)] == pytest.approx(0.08, rel=1e-4)


def test_snow_shrinks_with_a_mask_that_decreases():
    mesh = sheet()
    sim = simulation(mesh)
    fall(sim, mesh)
    for weight in (0.75, 0.5, 0.25):
        sim.set_mask("ground", corners(mesh, weight))
        fall(sim, mesh, 1, depth=0.0)
        assert sim.statistics()["held_volume"] == pytest.approx(0.08 * weight, rel=1e-4)
    # It does not come back.
    sim.set_mask("ground", corners(mesh, 1.0))
    fall(sim, mesh, 1, depth=0.0)
    assert sim.statistics()["held_volume"] == pytest.approx(0.02, rel=1e-4)
    assert_nothing_is_lost(sim)


def test_snow_on_the_back_shrinks_with_a_mask_and_stays_there():
    mesh = turned_over(sheet())
    sim = simulation(mesh)
    fall(sim, mesh)
    before = sim.height("ground")
    assert before.min() < -0.07
    sim.set_mask("ground", corners(mesh, 0.25))
    sim.step({}, 0.0, DOWN, FRAME)
    assert sim.height("ground") == pytest.approx(0.25 * before, abs=1e-6)


@both_engines
def test_snow_that_moves_onto_a_masked_place_does_not_stay(engine):
    mesh = sheet(1.0, 32)
    sim = simulation(mesh, engine, repose=math.radians(45.0), resolution=128)
    sim.set_mask("ground", halves(mesh, 0.0, 1.0))
    fall(sim, mesh, 16, depth=0.16)
    total = assert_nothing_is_lost(sim)
    heights = sim.height("ground")
    assert not heights[:, :60].any()
    # The bank beside the bare place is as steep as repose lets it be.
    across = heights[64, 66:90]
    assert across.max() > 0.12 and across.max() < 0.1601
    assert np.diff(across).max() < 1.3 * (1.0 / 0.96 / 128) * math.tan(math.radians(45.0))
    assert total["masked_volume"] > 0.08


def test_what_falls_onto_a_masked_place_does_not_stay():
    ground, shelf = sheet(2.0), sheet(0.4)
    shelf = shelf[0] + np.float32([0.0, 0.0, 1.0]), shelf[1], shelf[2]
    sim = native.SnowSimulation(pixel_size=0.02, engine="CPU", repose=math.radians(50.0))
    sim.add_object("ground", ground[1], ground[2], resolution=64)
    sim.add_object("shelf", shelf[1], shelf[2], resolution=64)
    sim.set_mask("ground", corners(ground, 0.0))
    for step in range(60):
        sim.step({"ground": ground[0], "shelf": shelf[0]} if step == 0 else {}, 0.02 if step < 20 else 0.0)
    assert_nothing_is_lost(sim)
    objects = sim.statistics()["objects"]
    assert objects["ground"]["total"]["landed_volume"] > 0.01
    assert not sim.height("ground").any()


@both_engines
def test_a_masked_simulation_resumes_byte_for_byte(tmp_path, engine):
    mesh = sheet(1.0, 32)

    def run(sim, begin, end):
        for step in range(begin, end):
            sim.set_mask("ground", halves(mesh, 1.0 - step / 12.0, 0.9))
            sim.step({"ground": mesh[0]} if step == begin else {}, 0.01, DOWN, FRAME)

    assert_resumes(lambda: simulation(mesh, engine, repose=1.0), run, 5, 12, tmp_path / "state")


def test_masks_that_do_not_fit_are_refused_with_a_reason():
    mesh = sheet()
    sim = simulation(mesh)
    with pytest.raises(ValueError, match="3 corners, the object has 6"):
        sim.set_mask("ground", np.ones((1, 3), np.float32))
    with pytest.raises(ValueError, match="from 0 to 1"):
        sim.set_mask("ground", corners(mesh, 1.5))
    with pytest.raises(ValueError, match=r"\(T, 3\) without uv"):
        sim.set_mask("ground", np.ones((4, 4), np.float32))
    with pytest.raises(ValueError, match="other"):
        sim.set_mask("other", corners(mesh, 1.0))


def test_the_number_of_threads_changes_no_byte():
    program = """
import hashlib, os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import numpy as np
import test_snow_masks as t
mesh = t.sheet(cells=8)
sim = t.simulation(mesh, resolution=256, repose=1.0)
weights = np.random.default_rng(5).random((len(mesh[1]), 3)).astype(np.float32)
for part in (1.0, 0.7):
    sim.set_mask("ground", part * weights)
    t.fall(sim, mesh)
assert sim.statistics()["total"]["masked_volume"] > 0.0
print(hashlib.sha256(sim.height("ground").tobytes()).hexdigest(), sim.statistics())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))
