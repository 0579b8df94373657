# SPDX-License-Identifier: GPL-3.0-or-later
"""Many receivers, and steps of any length."""

import os

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import STAYS, grid, rotated, wind


def test_a_thousand_receivers_in_one_scene():
    positions, triangles, uv = grid(0.1, 0.1)
    placed = {
        f"{i:04}": positions + np.float32((0.15 * (i % 40), 0.15 * (i // 40), 0.0)) for i in range(1000)
    }
    with native.SnowSimulation(repose=STAYS, pixel_size=0.02, max_depth=1e6) as sim:
        for name in placed:
            sim.add_object(name, triangles, uv, resolution=128)
        estimate = sim.memory_estimate()
        assert estimate["maps"] == 1000 * 128**2 * 4
        sim.step(placed, 0.02)
        sim.step({}, 0.02)
        objects = sim.statistics()["objects"]
    volumes = np.array([objects[name]["total"]["deposited_volume"] for name in placed])
    assert volumes.mean() == pytest.approx(0.04 * 0.01, rel=0.01)
    assert volumes.min() > 0.6 * 0.04 * 0.01


@pytest.mark.parametrize("engine", ["CPU", "GL"])
def test_copies_of_a_mesh_gather_the_same_snow_as_meshes_of_their_own(engine):
    positions, triangles, uv = grid(cells=4)
    placed = {"a": rotated(positions, "x", 25.0), "b": positions + np.float32((0.4, 0.2, 1.0))}
    # A mesh whose coordinates differ in the last bit shares nothing with a copy.
    nearly = uv.copy()
    nearly[0, 0, 0] = np.nextafter(nearly[0, 0, 0], np.float32(1.0))

    def heights(unlike):
        # What lands on the other mesh depends on its UVs.
        with native.SnowSimulation(repose=0.6, pixel_size=0.02, engine=engine, landing=False) as sim:
            for name in placed:
                sim.add_object(name, triangles, nearly if name == unlike else uv, resolution=64)
            for _ in range(3):
                sim.step(placed, 0.05, wind(20.0), 1.0 / 24.0)
            return {name: sim.height(name) for name in placed if name != unlike}

    copies = heights(None)
    for unlike in placed:
        for name, own in heights(unlike).items():
            assert own.max() > 0.01
            np.testing.assert_array_equal(copies[name], own)


@pytest.mark.parametrize("tilt", [0.0, 40.0])
def test_one_frame_in_ten_parts_ends_where_one_in_a_piece_does(tilt):
    positions, triangles, uv = grid()
    held = []
    for parts in (1, 10):
        with native.SnowSimulation(repose=STAYS, pixel_size=0.01, max_depth=0.05, slide_half_life=0.3) as sim:
            sim.add_object("it", triangles, uv, resolution=64)
            for step in range(8 * parts):
                sim.step(
                    {"it": rotated(positions, "x", tilt)} if step == 0 else {},
                    0.01 / parts,
                    wind(10.0),
                    1.0 / 24.0 / parts,
                )
            held.append(sim.statistics()["held_volume"])
    assert held[1] == pytest.approx(held[0], rel=0.01)
    assert held[0] < 0.08  # some slid


@pytest.mark.skipif(not hasattr(os, "sysconf"), reason="this Python does not report the memory")
def test_a_scene_that_does_not_fit_is_refused_with_the_figure_and_a_hint():
    positions, triangles, uv = grid()
    machine = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    free = machine // 2**20
    with native.SnowSimulation(repose=STAYS, pixel_size=0.01) as sim:
        # One map owned, and as many more as the machine's memory cannot hold.
        sim.add_object("0", triangles, (uv * 0.01).astype(np.float32), resolution=8192)
        each = sim.memory_estimate()["maps"] // 2**20
        assert each == 8192**2 * 4 // 2**20
        count = free // each + 2
        if count > 240:
            pytest.skip(f"{free} MiB are too many to ask for more")
        for i in range(1, count):
            sim.add_object(f"{i}", triangles, (uv * 0.01).astype(np.float32), resolution=8192)
        with pytest.raises(RuntimeError, match="MiB.*free.*lower the resolution"):
            sim.step({f"{i}": positions for i in range(count)}, 0.01)
