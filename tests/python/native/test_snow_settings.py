# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that change while a simulation runs: the next step uses them, and lying snow stays."""

import math

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import grid


@pytest.fixture
def ground():
    """1 m of open ground with 0.2 m of snow that stays where it fell."""
    positions, triangles, uv = grid()
    sim = native.SnowSimulation(pixel_size=0.02, repose=math.pi / 2)
    sim.add_object("ground", triangles, uv, resolution=64)
    sim.step({"ground": positions}, 0.2)
    yield sim
    sim.close()


def test_another_repose_counts_from_the_next_step_on(ground):
    before = ground.height("ground")
    ground.change_settings(repose=math.radians(30.0))
    assert (ground.height("ground") == before).all()
    for _ in range(10):
        ground.step({}, 0.0, dt=0.1)
    rim, middle = ground.height("ground")[32, 3], ground.height("ground")[32, 32]
    assert rim < 0.1 < middle


def test_settings_that_are_not_named_stay(ground):
    ground.change_settings(max_depth=0.05, slide_half_life=1.0)
    ground.change_settings(seed=3)
    ground.step({}, 0.0, dt=1.0)
    # Half of what is over 0.05 m slides off in a half-life.
    assert ground.height("ground")[32, 32] == pytest.approx(0.125, rel=1e-3)


def test_settings_out_of_range_are_refused_and_change_nothing(ground):
    with pytest.raises(ValueError, match="repose must be over 0"):
        ground.change_settings(repose=-1.0, max_depth=0.01)
    ground.step({}, 0.0, dt=100.0)
    assert ground.height("ground")[32, 32] == pytest.approx(0.2, rel=1e-3)


def test_another_blur_counts_at_once_and_leaves_what_is_stored():
    positions, triangles, uv = grid()
    with native.SnowSimulation(pixel_size=0.02, repose=math.pi / 2) as sim:
        sim.add_object("ground", triangles, uv, resolution=64, blur_radius=0.0)
        sim.add_object("roof", triangles, uv, receive=False)
        # Thin snow under the roof, deep snow around it: to bare ground nothing is smoothed.
        sim.step({"ground": positions, "roof": positions * 0.3 - [0, 0, 1]}, 0.05)
        sim.step({"roof": positions * 0.3 + [0, 0, 1]}, 0.2)
        stored = sim.height("ground")

        def steepest():
            return np.abs(np.diff(sim.output("ground", normal=False)["height"], axis=1)).max()

        sharp = steepest()
        sim.set_blur_radius("ground", 0.1)
        assert steepest() < 0.5 * sharp
        assert (sim.height("ground") == stored).all()


def test_a_blur_that_is_none_and_a_name_that_is_none_are_refused(ground):
    with pytest.raises(ValueError, match="blur_radius must be 0 metres or more"):
        ground.set_blur_radius("ground", -0.1)
    with pytest.raises(ValueError, match="no object named 'sky'"):
        ground.set_blur_radius("sky", 0.1)


def test_a_closed_simulation_takes_no_settings(ground):
    ground.close()
    with pytest.raises(RuntimeError, match="closed"):
        ground.change_settings(seed=1)


# Each number with a value below the valid ones.
NUMBERS = {
    "pixel_size": 0.0,
    "noise_density": 0.0,
    "flutter": -0.1,
    "max_depth": -0.2,
    "slide_half_life": -0.3,
    "repose": 0.0,
    "cohesion": -0.4,
    "adhesion": -0.8,
    "rising": -0.9,
    "density": 0.0,
    "sun_share": -0.1,
    "unevenness": -0.2,
    "rain": -0.3,
    "soak": 0.0,
    "wet_spread": -0.4,
    "drying": 0.0,
    "drift": -0.1,
    "blur_radius": -0.5,
    "throw_speed": -0.6,
    "spread": -0.7,
    "heap_grain": 0.0,
}


@pytest.mark.parametrize("name", NUMBERS)
def test_every_number_arrives_under_its_own_name(name):
    with pytest.raises(ValueError, match=f"^{name} must be "):
        native.SnowSimulation(engine="CPU", **{name: NUMBERS[name]})


def test_the_docstring_names_every_number_with_default_and_valid_values():
    lines = native.SnowSimulation.__doc__.splitlines()
    assert [line.partition(" = ")[0] for line in lines if " = " in line] == list(NUMBERS)
    assert [line for line in lines if line.startswith("max_depth = 1: ") and "(0 metres or more)" in line]


def test_unknown_settings_and_wrong_types_are_type_errors(ground):
    with pytest.raises(TypeError, match="there is no setting 'pixelsize'"):
        native.SnowSimulation(pixelsize=0.1)
    with pytest.raises(TypeError, match="cohesion must be a number"):
        native.SnowSimulation(cohesion="1")
    with pytest.raises(TypeError, match="pixel_size cannot change: make a new SnowSimulation"):
        ground.change_settings(pixel_size=0.1)
    with pytest.raises(TypeError, match="there is no such map"):
        ground.output("ground", albedo=True)
