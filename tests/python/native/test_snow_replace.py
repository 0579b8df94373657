# SPDX-License-Identifier: GPL-3.0-or-later
"""An object gets another mesh while snow falls: its map continues where the new mesh has a surface."""

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import new_simulation
from snow_meshes import STAYS, grid


def simulation(**settings):
    return new_simulation(repose=STAYS, pixel_size=0.01, max_depth=100.0, **settings)


def mean(heights):
    """Mean: single texels hold a whole number of pixels, more or fewer."""
    return float(heights.mean(dtype=np.float64))


def without_right_half(mesh):
    positions, triangles, uv = mesh
    left = (uv[..., 0] <= 0.5001).all(axis=1)
    return positions, triangles[left], uv[left]


@pytest.mark.parametrize("mapping", ["COMPUTE", "GEOMETRY"])
def test_a_receiver_keeps_its_snow_under_a_finer_mesh(mapping):
    coarse, fine = grid(cells=1), grid(cells=8)
    with simulation(mapping=mapping) as sim:
        sim.add_object("it", coarse[1], coarse[2], resolution=64)
        sim.step({"it": coarse[0]}, 0.01)
        before = sim.height("it")
        sim.replace_object("it", fine[1], fine[2], resolution=64)
        assert np.array_equal(sim.height("it"), before)
        sim.step({"it": fine[0]}, 0.0, dt=0.0)
        assert np.array_equal(sim.height("it"), before)
        assert abs(sim.statistics()["total"]["stretched_volume"]) < 1e-5 * before.sum()
        sim.step({}, 0.01)
        assert mean(sim.height("it")[8:56, 8:56]) == pytest.approx(0.02, rel=0.01)


def test_what_lay_on_faces_that_go_goes_with_them():
    whole = grid(cells=2)
    half = without_right_half(whole)
    with simulation() as sim:
        sim.add_object("it", whole[1], whole[2], resolution=64)
        sim.step({"it": whole[0]}, 0.01)
        held = sim.statistics()["total"]["held_volume"]
        sim.replace_object("it", half[1], half[2], resolution=64)
        sim.step({"it": half[0]}, 0.0, dt=0.0)
        assert sim.height("it")[:, 34:].max() == 0 and sim.height("it")[8:56, 8:24].min() > 0
        total = sim.statistics()["total"]
        assert total["held_volume"] == pytest.approx(0.5 * held, rel=0.01)
        assert total["stretched_volume"] == pytest.approx(-0.5 * held, rel=0.01)
        sim.replace_object("it", whole[1], whole[2], resolution=64)
        sim.step({"it": whole[0]}, 0.01)
        heights = sim.height("it")
        assert mean(heights[8:56, 40:56]) == pytest.approx(0.01, rel=0.01)
        assert mean(heights[8:56, 8:24]) == pytest.approx(0.02, rel=0.01)


def test_output_is_measured_on_the_new_mesh():
    coarse, fine = grid(cells=1), grid(cells=8)
    with simulation() as sim:
        sim.add_object("it", coarse[1], coarse[2], resolution=64)
        sim.step({"it": coarse[0]}, 0.01)
        sim.output("it")
        sim.replace_object("it", fine[1], fine[2], resolution=64)
        with pytest.raises(ValueError, match="no positions yet"):
            sim.output("it")
        sim.step({"it": fine[0]}, 0.01)
        assert mean(sim.output("it")["height"][8:56, 8:56]) == pytest.approx(0.02, rel=0.01)


def test_an_occluder_may_be_replaced_as_well():
    ground, small, large = grid(2.0, 2.0), grid(0.5, 0.5), grid(1.5, 1.5, cells=2)
    with simulation() as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=64)
        sim.add_object("roof", small[1], small[2], receive=False)
        up = np.array([0, 0, 1], np.float32)
        sim.step({"ground": ground[0], "roof": small[0] + up}, 0.01)
        sim.replace_object("roof", large[1], large[2], receive=False)
        sim.step({"roof": large[0] + up}, 0.01)
        heights = sim.height("ground")
        assert heights[32, 32] == 0
        assert mean(heights[24:40, 12:20]) == pytest.approx(0.01, rel=0.02)
        assert mean(heights[24:40, 3:6]) == pytest.approx(0.02, rel=0.05)


def test_going_on_from_a_state_after_a_replacement_ends_with_the_same_bits():
    coarse, half = grid(cells=2), without_right_half(grid(cells=2))

    def steps(sim, count):
        for _ in range(count):
            sim.step({}, 0.01)

    with simulation() as sim:
        sim.add_object("it", coarse[1], coarse[2], resolution=64)
        sim.step({"it": coarse[0]}, 0.01)
        sim.replace_object("it", half[1], half[2], resolution=64, rest=half[0])
        sim.step({"it": half[0]}, 0.01)
        state = native.simulation_state(sim)
        steps(sim, 3)
        whole, balance = sim.output("it")["height"], sim.statistics()["total"]
    with simulation() as sim:
        sim.add_object("it", half[1], half[2], resolution=64, rest=half[0])
        native.set_simulation_state(sim, state)
        sim.step({"it": half[0]}, 0.01)
        steps(sim, 2)
        assert np.array_equal(sim.output("it")["height"], whole)
        assert sim.statistics()["total"] == balance


def test_what_cannot_be_replaced_is_named_and_stays():
    mesh = grid()
    with simulation() as sim:
        with pytest.raises(ValueError, match="no object named 'it' to replace"):
            sim.replace_object("it", mesh[1], mesh[2])
        sim.add_object("it", mesh[1], mesh[2], resolution=64)
        sim.step({"it": mesh[0]}, 0.01)
        before = sim.height("it")
        with pytest.raises(ValueError, match="'it' must stay a receiver"):
            sim.replace_object("it", mesh[1], mesh[2], resolution=64, receive=False)
        with pytest.raises(ValueError, match="'it' must keep its map of 64"):
            sim.replace_object("it", mesh[1], mesh[2], resolution=128)
        with pytest.raises(ValueError, match="object 'it': .*outside"):
            sim.replace_object("it", mesh[1], mesh[2] + 2.0, resolution=64)
        assert np.array_equal(sim.height("it"), before)
        sim.step({}, 0.01)
