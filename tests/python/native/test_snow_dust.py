# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust from the whole sky: full on level ground, half on open walls, and on undersides what rises."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from child import in_child
from snow_fall import new_simulation
from snow_meshes import box, grid
from snow_rays import texel_points

STEPS, DEPTH = 64, 0.002


def mean_by_side(mesh, depth=DEPTH, **settings):
    """Mean thickness over `depth` on tops, walls and undersides of a mesh in the open, and the total balance."""
    positions, triangles, uv = mesh
    sim = new_simulation(
        pixel_size=0.02, repose=math.pi / 2, flutter=math.pi / 2, **{"max_depth": 1.0, **settings}
    )
    with sim:
        sim.add_object("thing", triangles, uv, resolution=128)
        for step in range(STEPS):
            sim.step({"thing": positions} if step == 0 else {}, depth / STEPS)
        thickness = np.abs(sim.height("thing")).ravel()
        area = sim.texel_area("thing").ravel()
        total = sim.statistics()["objects"]["thing"]["total"]
    _, normals, places, _ = texel_points(native, positions, triangles, uv, 128)
    up = normals[:, 2]
    means = []
    for side in (up > 0.9, np.abs(up) < 0.1, up < -0.9):
        at = places[side]
        means.append(np.average(thickness[at], weights=area[at]) / depth if side.any() else 0.0)
    return means, total


def test_open_level_ground_gets_the_whole_depth():
    (ground, _, _), _ = mean_by_side(grid(2.0, 2.0))
    assert ground == pytest.approx(1.0, abs=1e-3)


def test_open_walls_that_hold_dust_get_half_of_it():
    (top, walls, under), total = mean_by_side(box(), adhesion=1.0)
    assert top == pytest.approx(1.0, abs=5e-3)
    assert walls == pytest.approx(0.5, abs=0.02)
    assert under == 0.0
    assert total["held_volume"] == pytest.approx(total["deposited_volume"], rel=1e-6)


def test_walls_hold_no_more_than_their_part_of_the_maximum_depth():
    (top, walls, _), _ = mean_by_side(box(), adhesion=0.1, max_depth=DEPTH, slide_half_life=1e-3)
    assert top == pytest.approx(1.0, abs=0.01)
    assert walls == pytest.approx(0.1, abs=1e-3)


def test_without_adhesion_nothing_stays_on_walls():
    (_, walls, _), _ = mean_by_side(box(), slide_half_life=1e-3)
    assert walls < 1e-3


def test_undersides_get_what_rises():
    (top, walls, under), total = mean_by_side(box(), adhesion=1.0, rising=0.25)
    assert top == pytest.approx(1.0, abs=5e-3)
    assert under == pytest.approx(0.25, abs=5e-3)
    assert walls == pytest.approx(0.5 * 1.25, abs=0.02)
    assert total["held_volume"] == pytest.approx(total["deposited_volume"], rel=1e-6)


def test_nothing_rises_from_still_air():
    with pytest.raises(ValueError, match="^rising must be 0 to 1"):
        native.SnowSimulation(rising=1.5)


def test_dust_goes_on_from_a_checkpoint_to_the_bit(tmp_path):
    positions, triangles, uv = box()

    def dusty(steps):
        sim = new_simulation(
            pixel_size=0.02,
            repose=math.pi / 2,
            flutter=math.pi / 2,
            adhesion=0.3,
            rising=0.1,
            max_depth=0.004,
        )
        sim.add_object("thing", triangles, uv, resolution=128)
        for step in range(steps):
            sim.step({"thing": positions} if step == 0 else {}, 0.0005)
        return sim

    with dusty(6) as whole, dusty(1) as later:
        save(whole, tmp_path / "state")
        restore(later, tmp_path / "state")
        for sim in (whole, later):
            for _ in range(6):
                sim.step({}, 0.0005)
        assert whole.height("thing").max() > 0.003
        assert later.height("thing").tobytes() == whole.height("thing").tobytes()


def test_the_number_of_threads_changes_no_byte():
    program = """
import os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
from snow_meshes import box
from test_snow_dust import mean_by_side
print(mean_by_side(box(), adhesion=0.3, rising=0.1))
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))
