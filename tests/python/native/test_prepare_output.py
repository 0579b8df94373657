# SPDX-License-Identifier: GPL-3.0-or-later
"""Output is prepared in the background during the first steps; this never changes a result."""

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import grid, sphere

BALL, COARSE_BALL = sphere(around=24, rings=12), sphere(around=12, rings=6)


def simulation():
    return native.SnowSimulation(pixel_size=0.05, blur_radius=0.05)


def add(sim, name, mesh, rest=True):
    positions, triangles, uv = mesh
    sim.add_object(name, triangles, uv, resolution=128, rest=positions if rest else None)


def outputs(prepare, names):
    with simulation() as sim:
        for name in names:
            add(sim, name, BALL)
            if prepare:
                sim.prepare_output(name)
        sim.step({name: BALL[0] + np.float32(i) for i, name in enumerate(names)}, 0.01)
        return {name: sim.output(name) for name in names}


def test_prepared_outputs_are_the_same_to_the_last_bit():
    names = [f"ball {i}" for i in range(6)]
    plain, prepared = outputs(False, names), outputs(True, names)
    for name in names:
        assert plain[name]["height"].max() > 0
        assert np.array_equal(plain[name]["height"], prepared[name]["height"])
        assert np.array_equal(plain[name]["normal"], prepared[name]["normal"])


def test_the_rest_pose_may_be_that_of_the_first_step():
    with simulation() as sim:
        add(sim, "ball", BALL, rest=False)
        with pytest.raises(ValueError, match="'ball' has no rest pose"):
            sim.prepare_output("ball")
        sim.step({"ball": BALL[0]}, 0.01)
        sim.prepare_output("ball")
        assert np.array_equal(sim.output("ball")["height"], outputs(False, ["ball"])["ball"]["height"])


def test_a_mesh_replaced_meanwhile_gets_tables_of_its_own():
    def replaced(prepare):
        with simulation() as sim:
            add(sim, "ball", BALL)
            if prepare:
                sim.prepare_output("ball")
            positions, triangles, uv = COARSE_BALL
            sim.replace_object("ball", triangles, uv, resolution=128, rest=positions)
            sim.step({"ball": positions}, 0.01)
            return sim.output("ball")["height"]

    assert np.array_equal(replaced(True), replaced(False))


def test_what_does_not_receive_has_no_output_to_prepare():
    positions, triangles, uv = grid()
    with simulation() as sim:
        sim.add_object("roof", triangles, uv, receive=False, rest=positions)
        with pytest.raises(ValueError, match="'roof' does not receive"):
            sim.prepare_output("roof")


def test_a_simulation_may_be_closed_before_all_is_built():
    with simulation() as sim:
        for i in range(20):
            add(sim, f"ball {i}", BALL)
            sim.prepare_output(f"ball {i}")
    with pytest.raises(RuntimeError, match="closed"):
        sim.prepare_output("ball 0")
