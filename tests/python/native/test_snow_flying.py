# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow in the air as points: where it starts, how fast it is, and when it lands."""

import numpy as np
import pytest
from snow_fall import FRAME, fall, snow_over
from snow_meshes import rotated
from test_snow_landing import shelf_over_ground, wait
from test_snow_pressing import DEPTH, block, plough, ploughed

GRAVITY = 9.81


def lands(points):
    """Where points come down: their places and heights when their time is over."""
    place, velocity, seconds = points[:, :3], points[:, 3:6], points[:, 7:]
    end = place + seconds * velocity
    end[:, 2] -= 0.5 * GRAVITY * seconds[:, 0] ** 2
    return end


def tipped(**settings):
    """A board 2 m over the ground loses its snow; the points of the step, and the volume that slid."""
    meshes = shelf_over_ground(2.0)
    sim = snow_over(meshes, **settings)
    fall(sim, meshes, 0.05, 4)
    wait(sim, 2)
    before = sim.statistics()["objects"]["shelf"]["total"]["slid_volume"]
    if settings.get("points"):
        sim.take_flying()
    over = rotated(meshes["shelf"][0] - np.float32([0, 0, 2]), "y", 80.0) + np.float32([0, 0, 2.3])
    sim.step({"shelf": over.astype(np.float32)}, 0.0, (0, 0, -1), FRAME)
    return sim, sim.statistics()["objects"]["shelf"]["total"]["slid_volume"] - before


def test_all_that_falls_flies_and_lands_below():
    sim, slid = tipped(points=True)
    flying = sim.take_flying()
    assert set(flying) == {"shelf"}
    points = flying["shelf"]
    assert len(points) > 20 and points.dtype == np.float32 and points.shape[1] == 8
    assert points[:, 6].sum() == pytest.approx(slid, rel=1e-3)
    end = lands(points)
    on_ground = points[np.abs(end[:, :2]).max(axis=1) < 1.4]
    assert np.abs(lands(on_ground)[:, 2]).max() < 2e-3
    assert (points[:, 7] > 0.3).all() and (points[:, 7] < 0.75).all()
    # At random times within the step.
    assert np.ptp(points[:, 5]) > 0.1
    assert sim.take_flying() == {}


def test_nothing_is_recorded_unless_wanted_and_it_changes_no_byte():
    quiet, slid = tipped()
    assert slid > 0.0 and quiet.take_flying() == {}
    recorded, _ = tipped(points=True)
    for sim in (quiet, recorded):
        wait(sim, 20)
    assert (quiet.height("ground") == recorded.height("ground")).all()


def test_a_fast_blade_throws_snow_ahead_and_up():
    world = plough()
    world.sim.change_settings(points=True)
    ploughed(world, 20)
    points = world.sim.take_flying()["ground"]
    # The others have slid off the ground's edge.
    thrown = points[np.linalg.norm(points[:, 3:5], axis=1) > 0.5]
    speed = np.linalg.norm(thrown[:, 3:5], axis=1)
    assert len(thrown) > 50 and (thrown[:, 6:] > 0.0).all()
    # The blade moves by 6 cm a frame along X.
    assert 1.2 < np.median(speed) < 2.0
    assert thrown[:, 3].mean() > 0.95 * speed.mean()
    assert lands(thrown)[:, 2] == pytest.approx(thrown[:, 2], abs=0.15)


def test_a_slow_blade_throws_nothing():
    world = plough()
    world.sim.change_settings(points=True)
    blade = rotated(block(1.0, 0.4)[0] * np.float32([0.03, 1.0, 1.0]), "z", 30.0)
    for i in range(20):
        pose = blade + np.float32([-0.6 + 0.02 * i, 0.0, 0.21])
        world.step({"tool": pose}, DEPTH if i == 0 else 0.0)
    flying = world.sim.take_flying().get("ground", np.zeros((0, 8), np.float32))
    assert np.linalg.norm(flying[:, 3:5], axis=1).max(initial=0.0) < 0.5
    assert world.balance()["pressed_volume"] < 1e-6


def test_a_flight_goes_on_from_frame_to_frame():
    from snowbough.cache import flying

    sim, _ = tipped(points=True)
    points = sim.take_flying()["shelf"]
    later = flying.moved(flying.moved(points, 0.1), 0.2)
    assert len(later) == len(points)
    assert np.abs(lands(later) - lands(points)).max() < 1e-4
    assert len(flying.moved(points, 1.0)) == 0
