# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver that is hidden for some steps keeps its snow, gains none and blocks none."""

import math

import numpy as np
import pytest
from snow_fall import new_simulation
from snow_meshes import grid


@pytest.mark.parametrize("engine", ["CPU", "GL"])
def test_a_hidden_receiver_keeps_its_snow_and_lets_snow_fall_through(engine):
    """At 65 degrees of repose its snow would slide over the rims if its surface took part in the step."""
    roof, ground = grid(cells=4), grid(cells=1)
    below = ground[0] - np.float32([0, 0, 1])
    with new_simulation(engine=engine, pixel_size=0.02, repose=math.radians(65)) as sim:
        for name, mesh in (("roof", roof), ("ground", ground)):
            sim.add_object(name, mesh[1], mesh[2], resolution=64, rest=mesh[0])
        sim.step({"roof": roof[0], "ground": below}, 0.05)
        heights, output = sim.height("roof"), sim.output("roof")["height"]
        held = sim.statistics()["objects"]["roof"]["total"]["held_volume"]
        assert sim.height("ground")[16:48, 16:48].max() == 0.0
        for _ in range(3):
            sim.step({}, 0.05, dt=1.0, hidden={"roof"})
        assert np.array_equal(sim.height("roof"), heights)
        assert np.array_equal(sim.output("roof")["height"], output)
        assert sim.height("ground")[16:48, 16:48].mean() == pytest.approx(0.15, rel=0.01)
        sim.step({}, 0.0, dt=0.0)
        balance = sim.statistics()["objects"]["roof"]["total"]
        assert balance["held_volume"] == pytest.approx(held, rel=1e-6)
        assert balance["stretched_volume"] == pytest.approx(0.0, abs=1e-6 * held)


def test_a_hidden_object_must_be_known():
    mesh = grid(cells=1)
    with new_simulation() as sim:
        sim.add_object("roof", mesh[1], mesh[2], receive=False)
        with pytest.raises(ValueError, match="no object named 'rof' to hide"):
            sim.step({"roof": mesh[0]}, 0.01, hidden={"rof"})
