# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow thaws in the air and in the sun, and its water wets what lies below."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from child import in_child
from snow_fall import new_simulation
from snow_meshes import box, grid, rotated, turned_over
from snow_rays import texel_points

DT = 1.0 / 24.0
SUN = (0.5, 0.0, -1.0)


def simulation(**settings):
    return new_simulation(**{"pixel_size": 0.02, "repose": math.pi / 2, "unevenness": 0.0, **settings})


def ground(sim, size=2.0, resolution=128, depth=0.2, **step):
    positions, triangles, uv = grid(size, size, 4)
    sim.add_object("ground", triangles, uv, resolution=resolution)
    sim.step({"ground": positions}, depth, **step)
    return texel_points(native, positions, triangles, uv, resolution)


def total(sim):
    return sim.statistics()["total"]


def balanced(sim):
    now = total(sim)
    gone = now["held_volume"] + now["slid_volume"] - now["landed_volume"] + now["removed_volume"]
    return gone == pytest.approx(now["deposited_volume"], rel=1e-6)


@pytest.mark.parametrize("sun", [(0, 0, 0), (0, 0, -1), SUN])
def test_open_ground_loses_the_thaw(sun):
    with simulation() as sim:
        ground(sim)
        for _ in range(10):
            sim.step({}, -0.01, dt=DT, sun=sun)
        now = total(sim)
        assert now["melted_volume"] == pytest.approx(0.5 * now["deposited_volume"], rel=1e-6)
        assert balanced(sim)
        assert np.median(sim.height("ground")[10:-10, 10:-10]) == pytest.approx(0.1, rel=1e-5)


def test_snow_melts_no_more_than_there_is():
    with simulation() as sim:
        ground(sim, depth=0.02)
        sim.step({}, -0.05, dt=DT)
        now = total(sim)
        assert now["held_volume"] == 0.0
        assert now["melted_volume"] == pytest.approx(now["deposited_volume"], rel=1e-6)


def test_shade_melts_as_the_air_alone():
    """A roof beside the ground's left half keeps the sun off it."""
    share = 0.7
    with simulation(sun_share=share, flutter=0.0) as sim:
        points, _, places, _ = ground(sim)
        positions, triangles, uv = grid(1.0, 2.0)
        sim.add_object("roof", triangles, uv, receive=False)
        # Its shadow covers x from -0.5 to 0.5.
        sim.step({"roof": positions + np.float32([-0.5, 0.0, 1.0])}, -0.1, dt=DT, sun=SUN)
        lost = 0.2 - sim.height("ground").ravel()[places]
    shade, open_ground = lost[np.abs(points[:, 0]) < 0.4], lost[points[:, 0] > 0.6]
    assert np.median(open_ground) == pytest.approx(0.1, rel=1e-3)
    assert np.median(shade) / np.median(open_ground) == pytest.approx(1.0 - share, rel=2e-3)


def test_slopes_that_face_the_sun_melt_faster():
    with simulation(sun_share=1.0) as sim:
        positions, triangles, uv = box()
        sim.add_object("box", triangles, uv, resolution=128)
        sim.step({"box": positions}, 0.1, direction=(0.0, 0.0, -1.0))
        sim.step({}, -0.05, dt=DT, sun=(0.0, 0.0, -1.0))
        assert sim.height("box").max() == pytest.approx(0.05, rel=1e-3)


def test_uneven_thaw_leaves_patches():
    covered = {}
    for unevenness in (0.0, 0.25):
        with simulation(unevenness=unevenness) as sim:
            ground(sim, depth=0.05)
            for _ in range(9):
                sim.step({}, -0.005, dt=DT)
            covered[unevenness] = np.mean(sim.height("ground")[10:-10, 10:-10] > 0.001)
            assert balanced(sim)
    assert covered[0.0] == 1.0
    assert 0.2 < covered[0.25] < 0.8


def test_snow_beside_bare_ground_melts_faster():
    """A roof keeps half of the ground bare. Unevenness is the same near and far, on average over many texels."""
    with simulation(unevenness=0.1, flutter=0.0) as sim:
        positions, triangles, uv = grid(1.0, 2.0)
        sim.add_object("roof", triangles, uv, receive=False)
        ground_positions, ground_triangles, ground_uv = grid(2.0, 2.0, 4)
        sim.add_object("ground", ground_triangles, ground_uv, resolution=128)
        sim.step({"roof": positions + np.float32([-0.5, 0.0, 1.0]), "ground": ground_positions}, 0.2)
        points, _, places, _ = texel_points(native, ground_positions, ground_triangles, ground_uv, 128)
        before = sim.height("ground").ravel()[places]
        sim.step({}, -0.05, dt=DT)
        lost = before - sim.height("ground").ravel()[places]
    near, far = (points[:, 0] > 0.02) & (points[:, 0] < 0.06), points[:, 0] > 0.3
    assert before[near].min() > 0.15
    assert np.mean(lost[near]) > 1.1 * np.mean(lost[far])
    assert np.mean(lost[far]) == pytest.approx(0.05, rel=0.1)


def test_snow_on_the_back_melts_there():
    with simulation() as sim:
        positions, triangles, uv = turned_over(grid(2.0, 2.0, 4))
        sim.add_object("ground", triangles, uv, resolution=128)
        sim.step({"ground": positions}, 0.2)
        sim.step({}, -0.05, dt=DT)
        assert np.median(sim.height("ground")[10:-10, 10:-10]) == pytest.approx(-0.15, rel=1e-4)
        assert balanced(sim)


def test_water_crosses_a_seam_and_none_is_lost():
    """The ground's map has two charts, side by side; rain falls on one of them only."""
    positions, triangles, _ = grid(2.0, 2.0, 2)
    middle = positions[triangles].mean(axis=1)
    uv = np.float32([0.5, 0.5]) + 0.2 * positions[triangles][:, :, :2]
    uv[:, :, 0] += np.where(middle[:, 0] < 0.0, -0.02, 0.02)[:, None]
    with simulation(wet=True, drying=1e9, wet_spread=0.3, rain=0.001 / DT, flutter=0.0) as sim:
        sim.add_object("ground", triangles, uv.astype(np.float32), resolution=256)
        roof, roof_triangles, roof_uv = grid(1.2, 2.4)
        sim.add_object("roof", roof_triangles, roof_uv, receive=False)
        sim.step({"ground": positions, "roof": roof + np.float32([-0.6, 0.0, 1.0])}, 0.0, dt=DT)
        sim.change_settings(rain=0.0)
        area = sim.texel_area("ground")

        def volumes():
            water = native.simulation_state(sim)["objects"]["ground"]["planes"]["water"].astype(float) * area
            return water[:, :128].sum(), water[:, 128:].sum()

        before = volumes()
        for _ in range(24):
            sim.step({}, 0.0, dt=DT)
        after = volumes()
    assert sum(before) > 1e-3 and after[0] > before[0] + 1e-5
    # Water thinner than 0.1 micrometres counts as dry.
    assert sum(after) == pytest.approx(sum(before), rel=2e-4)


def test_the_sun_moves_no_snow_and_without_thaw_nothing_changes():
    heights = []
    for sun in ((0, 0, 0), SUN):
        with simulation(repose=math.radians(50.0)) as sim:
            ground(sim)
            for _ in range(5):
                sim.step({}, 0.01, dt=DT, sun=sun)
            heights.append(sim.height("ground"))
    assert (heights[0] == heights[1]).all()


def test_a_thaw_goes_on_from_a_checkpoint_to_the_bit(tmp_path):
    def scene():
        sim = simulation(unevenness=0.3, wet=True, density=300.0, repose=math.radians(60.0))
        positions, triangles, uv = box(0.6, 0.4)
        sim.add_object("box", triangles, uv, resolution=128)
        floor = grid(2.0, 2.0, 4)
        sim.add_object("ground", floor[1], floor[2], resolution=128)
        return sim, {"box": positions, "ground": floor[0]}

    def thaw(sim, first, poses=None):
        for step in range(first, 8):
            sim.step(poses if poses and step == first else {}, -0.004, dt=DT, sun=SUN)

    whole, poses = scene()
    whole.step(poses, 0.05)
    thaw(whole, 0)
    part, poses = scene()
    part.step(poses, 0.05)
    for _ in range(3):
        part.step({}, -0.004, dt=DT, sun=SUN)
    save(part, tmp_path / "state")
    later, poses = scene()
    restore(later, tmp_path / "state")
    thaw(later, 3, poses)
    for name in poses:
        assert (whole.height(name) == later.height(name)).all()
        assert (whole.output(name)["wet"] == later.output(name)["wet"]).all()
    assert whole.statistics()["total"] == later.statistics()["total"]
    assert total(whole)["melted_volume"] > 0.0


# -- water ------------------------------------------------------------------------------------------------------------


def water(sim, name, soak=0.002):
    return sim.output(name)["wet"] * soak


def test_rain_wets_open_ground_and_keeps_off_what_is_sheltered():
    with simulation(wet=True, drying=1e6, wet_spread=0.0, rain=0.0004 / DT) as sim:
        points, _, places, _ = ground(sim, depth=0.0, dt=0.0)
        positions, triangles, uv = grid(1.0, 1.0)
        sim.add_object("roof", triangles, uv, receive=False)
        for step in range(4):
            sim.step({"roof": positions + np.float32([0, 0, 1])} if step == 0 else {}, 0.0, dt=DT)
        wet = water(sim, "ground").ravel()[places]
        assert total(sim)["deposited_volume"] == 0.0
    distance = np.abs(points[:, :2]).max(axis=1)
    assert np.median(wet[distance > 0.6]) == pytest.approx(0.0016, rel=1e-3)
    assert wet[distance < 0.45].max() == 0.0


def test_melted_snow_wets_by_its_density():
    with simulation(wet=True, drying=1e6, wet_spread=0.0, density=100.0) as sim:
        ground(sim, depth=0.1)
        sim.step({}, -0.01, dt=DT)
        assert np.median(water(sim, "ground")[20:-20, 20:-20]) == pytest.approx(0.001, rel=1e-3)


def test_water_spreads_sideways_and_dries():
    with simulation(wet=True, drying=1.0, wet_spread=0.1, rain=0.001 / DT) as sim:
        points, _, places, _ = ground(sim, depth=0.0, dt=0.0)
        positions, triangles, uv = grid(1.0, 2.0)
        sim.add_object("roof", triangles, uv, receive=False)
        sim.step({"roof": positions + np.float32([-0.5, 0, 1])}, 0.0, dt=DT)
        sim.change_settings(rain=0.0)
        before = water(sim, "ground").ravel()[places]
        for _ in range(24):
            sim.step({}, 0.0, dt=DT)
        after = water(sim, "ground").ravel()[places]
    beside = (points[:, 0] < -0.02) & (points[:, 0] > -0.08)
    assert after[beside].mean() > 0.0 and before[beside].mean() < after[beside].mean()
    assert after.sum() < 0.9 * before.sum()


def test_water_does_not_spread_to_a_piece_that_is_beside_it_on_the_map_only():
    open_piece, _, _ = grid(1.0, 1.0, 1)
    _, triangles, uv = grid(1.0, 1.0, 1)
    positions = np.concatenate([open_piece, open_piece + np.float32([4.0, 0.0, 0.0])])
    halves = np.concatenate([uv * [0.5, 1.0], uv * [0.5, 1.0] + [0.5, 0.0]]).astype(np.float32)
    with simulation(wet=True, drying=1e6, wet_spread=0.1, rain=0.001 / DT) as sim:
        sim.add_object(
            "pieces", np.concatenate([triangles, triangles + len(open_piece)]), halves, resolution=64
        )
        sim.add_object("roof", triangles, uv, receive=False)
        roof = 1.5 * open_piece + np.float32([4.0, 0.0, 1.0])
        for step in range(4):
            sim.step({"pieces": positions, "roof": roof.astype(np.float32)} if step == 0 else {}, 0.0, dt=DT)
        wet = water(sim, "pieces")
    assert wet[:, :30].min() > 0.0
    assert wet[:, 32:].max() == 0.0


def test_water_runs_off_a_roof_and_drips_onto_the_ground():
    """A steep board over the ground: the strip below its lower edge gets wetter than open ground."""
    with simulation(
        wet=True, drying=1e6, wet_spread=0.0, repose=math.radians(60.0), soak=0.0005, rain=0.0002 / DT
    ) as sim:
        points, _, places, _ = ground(sim, depth=0.0, dt=0.0)
        positions, triangles, uv = grid(1.0, 1.0)
        tilt = math.radians(40.0)
        turned = positions @ np.float32(
            [[math.cos(tilt), 0, -math.sin(tilt)], [0, 1, 0], [math.sin(tilt), 0, math.cos(tilt)]]
        )
        sim.add_object("board", triangles, uv, resolution=128)
        poses = {"board": (turned + np.float32([0, 0, 0.8])).astype(np.float32)}
        for step in range(6):
            sim.step(poses if step == 0 else {}, 0.0, dt=DT)
        board = water(sim, "board", 0.0005)
        state = native.simulation_state(sim)["objects"]["ground"]["planes"]["water"].ravel()[places]
    assert board.max() == pytest.approx(0.0005, rel=1e-3)
    edge = 0.5 * math.cos(tilt)
    below = (np.abs(np.abs(points[:, 0]) - edge) < 0.05) & (np.abs(points[:, 1]) < 0.4)
    away = np.abs(points[:, 0]) > 0.8
    assert state[below].max() > 3.0 * np.median(state[away])


def test_dry_simulations_have_no_wet_map():
    with simulation() as sim:
        ground(sim)
        assert "wet" not in sim.output("ground")


def test_weather_that_is_none_is_refused():
    with simulation() as sim:
        ground(sim)
        with pytest.raises(ValueError, match="sun must be three finite"):
            sim.step({}, 0.0, sun=(math.nan, 0.0, 0.0))


def test_no_water_is_lost_on_its_way_down():
    """What runs off a tilted board and drips is what the board would hold if it soaked up all of it."""

    def volume(soak):
        settings = {"wet": True, "drying": 1e9, "wet_spread": 0.05, "rain": 0.002 / DT, "soak": soak}
        with simulation(repose=math.radians(60.0), **settings) as sim:
            ground(sim, size=3.0, depth=0.0, dt=0.0)
            positions, triangles, uv = grid(1.0, 1.0)
            tilted = rotated(positions, "y", 35.0) + [0.0, 0.0, 0.8]
            sim.add_object("board", triangles, uv, resolution=128)
            for step in range(4):
                sim.step({"board": tilted.astype(np.float32)} if step == 0 else {}, 0.0, dt=DT)
            planes = native.simulation_state(sim)["objects"]
            return {
                name: float((own["planes"]["water"].astype(float) * sim.texel_area(name)).sum())
                for name, own in planes.items()
            }

    dry, soaked = volume(0.0005), volume(1.0)
    assert dry["board"] < 0.2 * soaked["board"]
    assert sum(dry.values()) == pytest.approx(sum(soaked.values()), rel=1e-6)


def test_the_number_of_threads_changes_no_byte():
    program = """
import hashlib, os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import test_snow_melt as t
sim = t.simulation(unevenness=0.4, wet=True, repose=1.0, engine="CPU")
t.ground(sim, depth=0.03)
for _ in range(6):
    sim.step({{}}, -0.006, dt=t.DT, sun=t.SUN)
out = sim.output("ground")
print(hashlib.sha256(sim.height("ground").tobytes() + out["wet"].tobytes()).hexdigest())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))
