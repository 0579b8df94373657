# SPDX-License-Identifier: GPL-3.0-or-later
"""The wind carries lying snow into the shelter of what stands in it."""

import math

import numpy as np
import pytest
from checkpoints import restore, save
from child import in_child
from snow_fall import new_simulation, volume
from snow_meshes import box, grid, rotated

DT = 1.0 / 24.0
# Snow that passes each metre in a step, in m3.
PASSES = 0.02
LENGTH, WIDTH, FENCE = 32.0, 8.0, 1.0
SIDE = 256


def simulation(**settings):
    return new_simulation(
        **{"pixel_size": 0.1, "repose": math.pi / 2, "drift": PASSES / DT, "flutter": 0.0, **settings}
    )


def fence(x=0.0, length=40.0):
    positions, triangles, uv = box()
    return positions * np.float32([0.1, length, FENCE]) + np.float32([x, 0.0, 0.0]), triangles, uv


def field(sim, obstacle=None, length=LENGTH, turn=0.0, **options):
    """A field of snow 0.2 m deep; its poses. The obstacle stands in it."""
    positions, triangles, uv = grid(length, WIDTH)
    sim.add_object("field", triangles, uv, resolution=SIDE)
    poses = {"field": rotated(positions, "z", turn)}
    if obstacle is not None:
        sim.add_object("fence", obstacle[1], obstacle[2], receive=False)
        poses["fence"] = rotated(obstacle[0], "z", turn)
        if options:
            sim.set_presser("fence", "NONE", **options)
    # Before the obstacle is there, so that its shadow does not count.
    sim.step(
        {"field": poses["field"], **{key: own - 50.0 for key, own in poses.items() if key != "field"}}, 0.2
    )
    return poses


def blown(steps=60, obstacle=None, wind=(1.0, 0.0), turn=0.0, **settings):
    """The field's map, its area and its balance after a storm."""
    with simulation(**settings) as sim:
        poses = field(sim, obstacle, turn=turn)
        for step in range(steps):
            sim.step(poses if step == 0 else {}, 0.0, dt=DT, wind=wind)
        return sim.height("field"), sim.texel_area("field"), sim.statistics()["total"]


def profile(height, length=LENGTH):
    """Depth in metres along the middle of the field, and places in metres from its centre."""
    row = height[SIDE // 2]
    places = (np.arange(SIDE) + 0.5) / SIDE
    return ((places - 0.02) / 0.96 - 0.5) * length, row


def near(places, depth, low, high):
    return depth[(places > low) & (places < high)]


@pytest.fixture(scope="module")
def behind_fence():
    return blown(obstacle=fence())


def test_open_ground_stays_as_it_is():
    for turn in (0.0, 29.0):
        still = blown(steps=0, turn=turn)[0]
        height, _, total = blown(steps=20, turn=turn)
        assert (height == still).all()
        assert total["drifted_volume"] == 0.0


def test_the_wind_digs_before_a_fence_and_a_drift_grows_behind_it(behind_fence):
    places, depth = profile(behind_fence[0])
    assert near(places, depth, -1.5, -0.2).min() < 0.17
    drift = near(places, depth, 0.2, 6.0)
    assert drift.max() > 0.4
    assert near(places, depth, -12.0, -3.0) == pytest.approx(0.2, abs=1e-6)


def test_no_hollow_forms_where_the_shelter_ends(behind_fence):
    """Before fetch was longer than settling, 13 m behind the fence lay less than half of the snow."""
    places, depth = profile(behind_fence[0])
    assert near(places, depth, 0.2, 15.5).min() > 0.185


def test_the_balance_knows_what_the_wind_has_carried_away(behind_fence):
    height, area, total = behind_fence
    assert volume(height, area) == pytest.approx(total["held_volume"], rel=1e-6)
    gone = total["held_volume"] + total["removed_volume"]
    assert gone == pytest.approx(total["deposited_volume"], rel=1e-6)
    assert total["removed_volume"] == total["drifted_volume"] != 0.0


def test_a_closed_field_only_moves_its_snow():
    """Between a calm before one wall and a calm behind the other, nothing comes and nothing leaves."""
    wall = 3.0
    with simulation() as sim:
        positions, triangles, uv = grid(12.0, WIDTH)
        sim.add_object("field", triangles, uv, resolution=SIDE)
        sim.step({"field": positions}, 0.2)
        before = sim.statistics()["total"]["held_volume"]
        for name, x in (("first", -5.9), ("second", 5.9)):
            own = box()
            sim.add_object(name, own[1], own[2], receive=False)
            place = own[0] * np.float32([0.2, 40.0, wall]) + np.float32([x, 0.0, 0.0])
            sim.step({name: place}, 0.0, dt=0.0)
        for _ in range(20):
            sim.step({}, 0.0, dt=DT, wind=(1.0, 0.0))
        total = sim.statistics()["total"]
        comes = 20 * PASSES * WIDTH
        # All that comes over the first wall settles in its shelter, or leaves over the second one.
        assert total["held_volume"] - before == pytest.approx(-total["drifted_volume"], rel=1e-5)
        assert 0.9 * comes < -total["drifted_volume"] < 1.01 * comes


def test_wind_from_the_other_side_mirrors_the_drift(behind_fence):
    other = blown(obstacle=fence(), wind=(-1.0, 0.0))[0]
    height = behind_fence[0]
    assert np.abs(other[:, ::-1] - height).max() < 1e-5
    assert np.abs(other - height).max() > 0.2


def test_a_turned_scene_has_the_same_drift(behind_fence):
    turn = 29.0
    wind = (math.cos(math.radians(turn)), math.sin(math.radians(turn)))
    height = blown(obstacle=fence(), wind=wind, turn=turn)[0]
    difference = np.abs(height - behind_fence[0])
    assert np.median(difference) < 0.002 and np.quantile(difference, 0.99) < 0.05


@pytest.mark.parametrize("calm", [{"wind": (0.0, 0.0)}, {"dt": 0.0}])
def test_without_wind_or_time_nothing_drifts(calm):
    with simulation() as sim:
        poses = field(sim, fence())
        before = sim.height("field")
        sim.step(poses, 0.0, direction=(0.2, 0.0, -1.0), **{"dt": DT, "wind": (1.0, 0.0), **calm})
        assert (sim.height("field") == before).all()


def test_the_wind_passes_what_does_not_block_it():
    with simulation() as sim:
        poses = field(sim, fence(), blocks_wind=False)
        before = sim.height("field")
        for step in range(5):
            sim.step(poses if step == 0 else {}, 0.0, dt=DT, wind=(1.0, 0.0))
        assert (sim.height("field") == before).all()


def test_walls_and_ground_below_a_roof_take_no_drifted_snow():
    with simulation() as sim:
        ground, house = grid(20.0, 6.0), box(2.0, 2.0)
        sim.add_object("ground", ground[1], ground[2], resolution=SIDE)
        sim.add_object("house", house[1], house[2], resolution=128)
        sim.step({"ground": ground[0], "house": house[0]}, 0.1)
        bare = sim.height("ground") == 0.0
        walls = sim.height("house")[:64]
        for _ in range(30):
            sim.step({}, 0.0, dt=DT, wind=(1.0, 0.0))
        assert bare.sum() > 100
        assert (sim.height("ground")[bare] == 0.0).mean() > 0.97
        assert (sim.height("house")[:64] == walls).all()


def test_packed_snow_stays():
    """A roller packs 0.2 m to 0.05 m before a fence. So much fresh snow the wind would take down to the ground."""
    depth = {}
    for packs in (False, True):
        with simulation() as sim:
            positions, triangles, uv = grid(LENGTH, WIDTH)
            sim.add_object("field", triangles, uv, resolution=SIDE)
            sim.step({"field": positions}, 0.2 if packs else 0.05)
            roller = box()
            sim.add_object("roller", roller[1], roller[2], receive=False, occlude=False)
            sim.set_presser("roller", "PRESS" if packs else "NONE", pushed_aside=0.0)
            lies = roller[0] * np.float32([12.0, 10.0, 1.0]) + np.float32([-6.1, 0.0, 0.0])
            for height in (5.0, 0.0, 5.0):
                sim.step({"roller": lies + np.float32([0.0, 0.0, height])}, 0.0, dt=DT)
            own = fence()
            sim.add_object("fence", own[1], own[2], receive=False)
            sim.step({"fence": own[0]}, 0.0, dt=0.0)
            for _ in range(120):
                sim.step({}, 0.0, dt=DT, wind=(1.0, 0.0))
            depth[packs] = near(*profile(sim.height("field")), -1.2, -0.2).min()
    assert depth[False] < 0.01
    assert depth[True] == pytest.approx(0.05, abs=1e-4)


def test_a_storm_goes_on_from_a_checkpoint_to_the_bit(tmp_path):
    def storm(sim, poses, steps):
        for step in range(steps):
            sim.step(poses if step == 0 else {}, 0.002, dt=DT, wind=(1.0, 0.0))

    with simulation(repose=math.radians(60.0)) as whole:
        poses = field(whole, fence())
        storm(whole, poses, 4)
        save(whole, tmp_path / "state")
        storm(whole, {}, 4)
        with simulation(repose=math.radians(60.0)) as later:
            field(later, fence())
            restore(later, tmp_path / "state")
            storm(later, poses, 4)
            assert (whole.height("field") == later.height("field")).all()
            assert whole.statistics()["total"] == later.statistics()["total"]


def test_the_number_of_threads_changes_no_byte():
    program = """
import os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import hashlib
from test_snow_drift import blown, fence
print(hashlib.sha256(blown(steps=5, obstacle=fence())[0].tobytes()).hexdigest())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))


def test_wrong_wind_is_refused():
    with simulation() as sim:
        field(sim)
        with pytest.raises(ValueError, match="wind must be two finite numbers"):
            sim.step({}, 0.0, wind=(math.nan, 0.0))
