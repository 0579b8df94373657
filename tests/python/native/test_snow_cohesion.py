# SPDX-License-Identifier: GPL-3.0-or-later
"""Cohesion: snow on thin parts is steeper."""

import math

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import DOWN, fall
from snow_meshes import box
from test_snow_repose import assert_balanced, come_to_rest, tube

FRESH = math.radians(65.0)


def lying(mesh, depth, resolution, cohesion, shading=None, engine="CPU"):
    """The map of a mesh alone under that depth of snow, at rest."""
    with native.SnowSimulation(
        landing=False, repose=FRESH, cohesion=cohesion, engine=engine, pixel_size=0.002, max_depth=100.0
    ) as sim:
        sim.add_object("it", mesh[1], mesh[2], resolution=resolution, shading=shading)
        fall(sim, {"it": mesh}, depth, 24)
        come_to_rest(sim)
        assert_balanced(sim)
        return sim.height("it")


def smooth(radius=0.01, around=24):
    """Numbers of the corners of `tube` that share a normal: those of a line along it."""
    turn = np.arange(2 * (around + 1)).reshape(2, around + 1) % (around + 1) % around
    return turn.reshape(-1)[tube(radius, around=around)[1]].astype(np.int32)


def test_a_twig_carries_a_taller_cap():
    caps = [lying(tube(0.01), 0.05, 64, cohesion, smooth())[32].max() for cohesion in (0.0, 0.005)]
    # The angle of repose alone: 1.36 radii; with half a radius more than 1.5 times the slope.
    assert 0.008 < caps[0] < 0.015
    assert 1.5 * caps[0] < caps[1] < 3.0 * caps[0]


def test_a_thick_limb_hardly_does():
    caps = [lying(tube(0.2), 0.05, 64, cohesion, smooth()) for cohesion in (0.0, 0.005)]
    assert np.sum(caps[1]) == pytest.approx(np.sum(caps[0]), rel=0.1)


def test_a_needle_hardly_does():
    """A twentieth of a millimetre thick: a front of 5 mm falls off it."""
    caps = [lying(tube(5e-5), 0.0005, 64, cohesion, smooth(5e-5)) for cohesion in (0.0, 0.005)]
    assert np.sum(caps[1]) == pytest.approx(np.sum(caps[0]), rel=0.1)


def test_flat_faces_and_rims_are_as_without():
    maps = [lying(box(0.5, 0.5), 0.1, 128, cohesion) for cohesion in (0.0, 0.02)]
    assert np.array_equal(*maps)


def test_a_bank_on_smooth_faces_shows_none_of_their_edges():
    """With face normals, 24 of them would have steps of 8 mm between them."""
    row = lying(tube(0.13), 0.1, 256, 0.0, smooth(0.13))[128]
    flank = (row[2:] > 0.025) & (row[2:] < 0.07)
    assert flank.sum() > 20
    assert np.abs(np.diff(row, 2))[flank].max() < 0.002


def test_both_engines_hold_the_same():
    cpu, gl = (lying(tube(0.01), 0.05, 64, 0.005, smooth(), engine) for engine in ("CPU", "GL"))
    assert np.abs(cpu - gl).max() < 2e-4


def test_it_can_be_changed_while_it_snows():
    mesh = tube(0.01)
    with native.SnowSimulation(
        landing=False, repose=FRESH, cohesion=0.005, engine="CPU", pixel_size=0.002, max_depth=100.0
    ) as sim:
        sim.add_object("it", mesh[1], mesh[2], resolution=64, shading=smooth())
        fall(sim, {"it": mesh}, 0.05, 24)
        held = sim.statistics()["total"]["held_volume"]
        sim.change_settings(cohesion=0.0)
        come_to_rest(sim)
        assert sim.statistics()["total"]["held_volume"] < 0.7 * held
        lost = sim.height("it")
    assert lost.max() == pytest.approx(lying(mesh, 0.05, 64, 0.0, smooth()).max(), rel=0.1)


@pytest.mark.parametrize("bad", [-0.001, math.nan, math.inf])
def test_what_is_no_height_is_refused(bad):
    with pytest.raises(ValueError, match="cohesion must be 0 metres or more"):
        native.SnowSimulation(cohesion=bad, engine="CPU")


def test_without_repose_it_means_nothing():
    mesh = tube(0.01)
    maps = []
    for cohesion in (0.0, 0.02):
        with native.SnowSimulation(
            landing=False, repose=math.pi / 2, cohesion=cohesion, engine="CPU", pixel_size=0.002
        ) as sim:
            sim.add_object("it", mesh[1], mesh[2], resolution=64)
            sim.step({"it": mesh[0]}, 0.02, DOWN)
            maps.append(sim.height("it"))
    assert np.array_equal(*maps)


def test_limits_that_change_while_nothing_lies_count_where_it_snows_again():
    """In the last pose the box lies on its side, and its former top has lost all snow."""
    mesh = box(0.5, 0.5)
    turned = np.ascontiguousarray(mesh[0][:, [2, 1, 0]] * np.float32((1, 1, -1)))
    maps = []
    for repose in (FRESH, math.radians(30.0)):
        with native.SnowSimulation(
            repose=repose, engine="CPU", pixel_size=0.01, max_depth=100.0, landing=False
        ) as sim:
            sim.add_object("it", mesh[1], mesh[2], resolution=64)
            fall(sim, {"it": mesh}, 0.1, 4)
            for _ in range(4):
                sim.step({"it": turned}, 0.0, DOWN, 100.0)
            assert not sim.height("it").any()
            sim.change_settings(repose=math.radians(30.0))
            sim.step({"it": turned}, 0.0, DOWN, 1.0)
            fall(sim, {"it": (turned, *mesh[1:])}, 0.1, 4)
            come_to_rest(sim)
            maps.append(sim.height("it"))
    assert maps[0].any()
    assert np.array_equal(*maps)
