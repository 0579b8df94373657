# SPDX-License-Identifier: GPL-3.0-or-later
"""A snapshot gives the output of its moment, even if the simulation continues before the output is computed."""

import threading

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import sphere

BALL, COARSE_BALL = sphere(around=24, rings=12), sphere(around=12, rings=6)


@pytest.fixture
def sim():
    with native.SnowSimulation(pixel_size=0.05, blur_radius=0.05) as simulation:
        simulation.add_object("ball", BALL[1], BALL[2], resolution=128)
        simulation.step({"ball": BALL[0]}, 0.01)
        yield simulation


def assert_same(one, other):
    assert one["height"].max() > 0
    assert np.array_equal(one["height"], other["height"])
    assert np.array_equal(one["normal"], other["normal"])


def test_steps_after_a_snapshot_leave_it_alone(sim):
    now, snapshot = sim.output("ball"), sim.snapshot("ball")
    sim.step({"ball": BALL[0] * np.float32(1.5)}, 0.05)
    assert_same(snapshot.output(), now)


def test_another_mesh_leaves_a_snapshot_alone(sim):
    now, snapshot = sim.output("ball"), sim.snapshot("ball")
    sim.replace_object("ball", COARSE_BALL[1], COARSE_BALL[2], resolution=128)
    sim.step({"ball": COARSE_BALL[0]}, 0.05)
    assert_same(snapshot.output(), now)


def test_a_snapshot_outlives_its_simulation(sim):
    now, snapshot = sim.output("ball"), sim.snapshot("ball")
    sim.close()
    assert_same(snapshot.output(), now)


def test_snapshots_are_worked_out_beside_steps(sim):
    expected, given = [], []

    def work(snapshots):
        given.extend(snapshot.output() for snapshot in snapshots)

    threads = []
    for _ in range(10):
        expected.append(sim.output("ball"))
        threads.append(threading.Thread(target=work, args=([sim.snapshot("ball")],)))
        threads[-1].start()
        sim.step({}, 0.01)
    for thread in threads:
        thread.join()
    assert {one["height"].tobytes() for one in given} == {one["height"].tobytes() for one in expected}


def test_normals_are_left_out_on_request(sim):
    assert set(sim.snapshot("ball", normal=False).output()) == {"height"}


def test_a_snapshot_needs_a_step_before(sim):
    sim.add_object("new", BALL[1], BALL[2], resolution=128)
    with pytest.raises(ValueError, match="'new' has no positions yet"):
        sim.snapshot("new")
