# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow that leaves a map lands on what lies below, and none is lost."""

import math
from itertools import pairwise

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from snow_fall import DOWN, FRAME, fall, sheet, snow_over
from snow_meshes import cylinder, grid, rotated, smooth, unfolded
from snow_pieces import pieces, slab, slats

GRAVITY = 9.81

both_engines = pytest.mark.parametrize("engine", ["CPU", "GL"])


def wait(sim, steps=40):
    for _ in range(steps):
        sim.step({}, 0.0, DOWN, FRAME)


def assert_nothing_is_lost(sim):
    """Deposited snow is held, in the air, on objects without a map, or out of the scene."""
    now = sim.statistics()
    total = now["total"]
    kept = total["held_volume"] - total["stretched_volume"]
    away = now["air_volume"] + now["floor_volume"] + now["left_volume"]
    assert kept + away == pytest.approx(total["deposited_volume"], rel=1e-6)
    assert min(now["floor_volume"], now["left_volume"], now["air_volume"]) > -1e-6 * total["deposited_volume"]
    return now


def shelf_over_ground(height=1.0):
    return {"ground": sheet(3.0), "shelf": pieces(slats([0.0], width=0.3, length=0.6, top=height))}


@both_engines
def test_what_falls_off_a_shelf_lies_below_its_edge(engine):
    meshes = shelf_over_ground()
    sim = snow_over(meshes, engine=engine, throw_speed=0.0)
    fall(sim, meshes, 0.2, 32)
    wait(sim)
    now = assert_nothing_is_lost(sim)
    objects = now["objects"]
    assert objects["shelf"]["total"]["slid_volume"] > 0.01
    # What falls off the ground's own edges leaves the scene.
    assert now["left_volume"] == pytest.approx(objects["ground"]["total"]["slid_volume"], rel=1e-3)
    assert now["air_volume"] == 0.0
    landed = objects["ground"]["total"]["landed_volume"]
    assert landed == pytest.approx(objects["shelf"]["total"]["slid_volume"], rel=1e-3)
    heights = sim.height("ground")
    row = heights[128]
    assert row[:50].max() < 0.2001 and row.max() > 0.21


@pytest.mark.parametrize("pitch", [20.0, 50.0])
def test_a_sheet_drops_what_lies_on_its_back_under_its_lower_edge(pitch):
    """As the snow on its positive side."""
    positions, triangles, uv = grid(cells=8)
    positions = rotated(positions, "x", pitch) + np.float32([0.0, 0.0, 1.5])
    landed = []
    for faces, corners in ((triangles, uv), (triangles[:, ::-1], uv[:, ::-1])):
        meshes = {"ground": sheet(4.0), "sheet": (positions, faces.copy(), corners.copy(), 128)}
        sim = snow_over(meshes, max_depth=0.02, slide_half_life=0.05, throw_speed=0.0)
        fall(sim, meshes, 0.1, 32)
        wait(sim)
        assert_nothing_is_lost(sim)
        assert sim.statistics()["objects"]["sheet"]["total"]["slid_volume"] > 0.03
        landed.append(sim.height("ground"))
    positive, back = landed
    assert positive.max() > 0.3
    assert np.abs(positive - back).max() < 1e-4


@both_engines
@pytest.mark.parametrize("before", [0.0, 0.02])
def test_what_lands_on_a_ground_that_faces_down_lies_on_its_back(engine, before):
    """The ground is bare, because the shelf shelters all of it, or has snow already. Heights on a back are negative."""
    ground = sheet(0.5, resolution=64)
    shelf = sheet(0.6, 1.0, 64)
    meshes = {"ground": (ground[0], ground[1][:, ::-1], *ground[2:]), "shelf": shelf}
    sim = snow_over(meshes, engine=engine, throw_speed=0.0, slide_half_life=0.05, flutter=0.0)
    away = np.float32([5.0, 0.0, 0.0])
    if before:
        sim.step({"ground": ground[0], "shelf": shelf[0] + away}, before, DOWN, FRAME)
    sim.step({"ground": ground[0], "shelf": shelf[0]}, 0.05, DOWN, FRAME)
    level = sim.height("ground")
    assert level[32, 32] == pytest.approx(-before, abs=1e-6)
    turned = rotated(shelf[0] - np.float32([0, 0, 1]), "x", 80.0) + np.float32([0, 0, 1])
    sim.step({"shelf": turned}, 0.0, DOWN, FRAME)
    wait(sim)
    assert_nothing_is_lost(sim)
    heights = sim.height("ground")
    assert sim.statistics()["objects"]["ground"]["total"]["landed_volume"] > 1e-3
    assert heights.max() <= 0.0 and heights.min() < -before - 0.01


def test_snow_takes_its_time_to_fall():
    """After the snowfall a board tips over."""
    meshes = shelf_over_ground(2.0)
    sim = snow_over(meshes)
    fall(sim, meshes, 0.05, 4)
    wait(sim, 2)
    before = sim.statistics()["objects"]["ground"]["total"]["landed_volume"]
    tipped = rotated(meshes["shelf"][0] - np.float32([0, 0, 2]), "y", 80.0) + np.float32([0, 0, 2.3])
    sim.step({"shelf": tipped.astype(np.float32)}, 0.0, DOWN, FRAME)
    # From 2 m it takes 0.64 s, 15.3 steps.
    wait(sim, 14)
    assert sim.statistics()["objects"]["ground"]["total"]["landed_volume"] == pytest.approx(before, abs=1e-6)
    assert sim.statistics()["air_volume"] > 0.002
    wait(sim, 4)
    assert sim.statistics()["objects"]["ground"]["total"]["landed_volume"] > before + 0.002


def test_while_it_snows_a_fall_takes_no_longer_than_a_centimetre_of_snow():
    meshes = shelf_over_ground(2.0)
    sim = snow_over(meshes)
    positions = {name: mesh[0] for name, mesh in meshes.items()}
    sim.step(positions, 0.02, DOWN, FRAME)
    wait(sim, 1)
    assert sim.statistics()["air_volume"] == 0.0
    # In steps of 1 mm it takes ten; the slats let go in the first ones.
    slow = snow_over(meshes, max_depth=0.0005)
    for _ in range(10):
        slow.step(positions, 0.001, DOWN, FRAME)
    assert slow.statistics()["objects"]["ground"]["total"]["landed_volume"] == 0.0
    for _ in range(10):
        slow.step(positions, 0.001, DOWN, FRAME)
    assert slow.statistics()["objects"]["ground"]["total"]["landed_volume"] > 0.0


def test_without_fall_time_snow_lands_in_the_next_step():
    meshes = shelf_over_ground(2.0)
    at_once = snow_over(meshes, fall_time=False)
    at_once.step({name: mesh[0] for name, mesh in meshes.items()}, 0.2, DOWN, FRAME)
    at_once.step({}, 0.0, DOWN, FRAME)
    assert at_once.statistics()["objects"]["ground"]["total"]["landed_volume"] > 0.0


@pytest.mark.parametrize("speed", [0.3, 1.5])
def test_a_roof_that_sheds_makes_a_berm_outside_its_eave(speed):
    eave = 2.5
    positions, triangles, uv, resolution = pieces(slab(count=10, width=1.5, pitch=40.0))
    roof = positions + np.float32([0.0, 1.0, eave]), triangles, uv, resolution
    meshes = {"roof": roof, "yard": sheet(6.0, resolution=512)}
    sim = snow_over(meshes, max_depth=0.12, slide_half_life=0.5, pixel_size=0.02, throw_speed=speed)
    fall(sim, meshes, 0.3, 48)
    wait(sim)
    assert_nothing_is_lost(sim)
    # The lower edge of the roof's top is at y = 1.
    middle = sim.height("yard")[:, 246:266].mean(axis=1)
    y = (np.arange(512) + 0.5) / 512
    y = ((y - 0.02) / 0.96 - 0.5) * 6.0
    berm = np.where(np.abs(y) < 2.0, np.maximum(middle - 0.301, 0.0), 0.0)
    outside = speed * math.sqrt(2.0 * eave / GRAVITY)
    assert 1.0 - (berm * y).sum() / berm.sum() == pytest.approx(outside, abs=0.15)
    if speed == 0.3:
        assert 0.4 < berm.max() < 0.6
        assert 1.0 - y[berm.argmax()] == pytest.approx(outside, abs=0.15)
    else:
        assert berm.max() > 0.03


def below_a_tilted_roof(height=4.0, **settings):
    """The height map of the yard below a sheet that sheds all it gets, 8 m wide, and the states of what was in the
    air."""
    roof = sheet(1.0, resolution=64)
    meshes = {"yard": sheet(8.0, -height, 256), "roof": (rotated(roof[0], "x", 50.0), *roof[1:])}
    sim = snow_over(meshes, max_depth=0.02, slide_half_life=0.05, throw_speed=0.3, **settings)
    fall(sim, meshes, 0.05, 8)
    air = native.simulation_state(sim)["landing"]["air"]
    wait(sim)
    assert_nothing_is_lost(sim)
    return sim.height("yard"), air


def test_spread_widens_the_heap():
    def width(spread):
        heap = np.maximum(below_a_tilted_roof(spread=spread)[0] - 0.0501, 0.0)[10:-10, 10:-10].sum(axis=1)
        row = np.arange(len(heap)) * 8.0 / 256
        middle = (heap * row).sum() / heap.sum()
        return math.sqrt((heap * (row - middle) ** 2).sum() / heap.sum())

    assert width(0.3) > 2.0 * width(0.0)


def test_a_smaller_heap_grain_makes_more_heaps():
    few, many = (len(below_a_tilted_roof(heap_grain=grain)[1]) for grain in (0.3, 0.03))
    assert many > 4 * few > 0


def test_steps_without_duration_land_nothing():
    meshes = shelf_over_ground(2.0)
    sim = snow_over(meshes)
    sim.step({name: mesh[0] for name, mesh in meshes.items()}, 0.2, DOWN, FRAME)
    for _ in range(100):
        sim.step({}, 0.0, DOWN, 0.0)
    assert sim.statistics()["objects"]["ground"]["total"]["landed_volume"] == 0.0
    sim.step({}, 0.0, DOWN, 1.0)
    assert sim.statistics()["objects"]["ground"]["total"]["landed_volume"] > 0.0
    assert_nothing_is_lost(sim)


def test_falling_snow_is_counted_in_whole_units():
    """From 8 m each heap falls along six rays, which share its units."""
    roof = sheet(1.0, resolution=64)
    meshes = {"ground": sheet(6.0, -8.0, 128), "roof": (rotated(roof[0], "x", 50.0), *roof[1:])}
    sim = snow_over(meshes, max_depth=0.02, slide_half_life=0.5)
    fall(sim, meshes, 0.02, 1)
    state = native.simulation_state(sim)["landing"]
    in_air = sum(snow[4] for snow in state["air"])
    slid = sim.statistics()["total"]["slid_volume"] * 2.0**44
    assert in_air > 1e9 and in_air + state["on_floors"] + state["left"] == slid


def test_snow_that_is_thrown_against_a_wall_falls_to_its_foot():
    """The wall stands 5 cm beside the shelf and carries no snow."""
    corners = np.float32([(0.2, -0.5, 0.0), (0.2, 0.5, 0.0), (0.2, 0.5, 2.0), (0.2, -0.5, 2.0)])
    uv = np.full((2, 3, 2), 0.5, np.float32)
    wall = corners, np.int32([(0, 1, 2), (0, 2, 3)]), uv, 16
    meshes = {**shelf_over_ground(2.0), "wall": wall}
    sim = snow_over(meshes, shade=["wall"], throw_speed=2.0)
    fall(sim, meshes, 0.2, 16)
    wait(sim)
    now = assert_nothing_is_lost(sim)
    assert now["objects"]["ground"]["total"]["landed_volume"] > 1e-3
    assert now["floor_volume"] == 0.0


def folded(profile, width, resolution):
    """A sheet along a profile of (x, z), in one chart: u along its width, v along its length."""
    profile = np.asarray(profile, float)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    positions, triangles, uv = grid(width, 1.0, cells=len(profile) - 1)
    across, along = (
        np.tile(np.linspace(-0.5, 0.5, len(profile)), len(profile)),
        np.repeat(np.arange(len(profile)), len(profile)),
    )
    positions = np.column_stack([profile[along, 0], across * width, profile[along, 1]])
    corner = np.column_stack([across + 0.5, way[along] / way[-1]]) * 0.96 + 0.02
    return (
        positions.astype(np.float32),
        triangles[:, ::-1],
        corner[triangles[:, ::-1]].astype(np.float32),
        resolution,
    )


def test_snow_lands_beside_a_wall_and_not_on_it():
    """A trough in one chart, 0.5 m wide with walls of 0.5 m, below a shelf. What lay on a wall would fall again."""
    trough = folded([(-0.25, 1.0), (-0.25, 0.5), (0.25, 0.5), (0.25, 1.0)], 2.0, 128)
    shelf = pieces([((0.0, 0.0, 0.9), (0.38, 1.0, 0.04), 0.0)])
    meshes = {"shelf": shelf, "trough": trough}
    sim = snow_over(meshes, throw_speed=0.0)
    fall(sim, meshes, 0.1, 8)
    wait(sim)
    objects = assert_nothing_is_lost(sim)["objects"]
    assert objects["shelf"]["total"]["slid_volume"] > 5e-3
    assert objects["trough"]["total"]["landed_volume"] == pytest.approx(
        objects["shelf"]["total"]["slid_volume"], rel=1e-3
    )


def test_what_lands_on_the_treads_of_a_wall_falls_on():
    """Treads of 3 mm between risers of 4 cm: texels of 5 cm are all wall."""
    steps = [(0.003 * (k // 2), 0.04 * ((k + 1) // 2)) for k in range(161)]
    wall = folded([(x - 0.1, z) for x, z in steps], 3.0, 64)
    shelf = pieces([((0.1, 0.0, 4.0), (0.3, 0.6, 0.04), 0.0)])
    meshes = {"ground": sheet(3.0, resolution=128), "shelf": shelf, "wall": wall}
    sim = snow_over(meshes, throw_speed=0.0)
    fall(sim, meshes, 0.2, 16)
    wait(sim)
    now = assert_nothing_is_lost(sim)
    assert now["objects"]["wall"]["total"]["landed_volume"] > 1e-4


def test_snow_that_has_nowhere_to_slide_to_stays():
    """At the bottom of an inverted pyramid. As if it had slid, its volume would count as stretched."""
    positions, triangles, uv = grid(1.0, 1.0, cells=16)
    positions[:, 2] = np.maximum(np.abs(positions[:, 0]), np.abs(positions[:, 1]))
    meshes = {"pit": (positions, triangles, uv, 65)}
    sim = snow_over(meshes, max_depth=0.02, slide_half_life=0.01)
    fall(sim, meshes, 0.1, 4)
    assert_nothing_is_lost(sim)
    assert abs(sim.statistics()["total"]["stretched_volume"]) < 1e-6


def test_objects_without_a_map_keep_what_falls_on_them():
    meshes = shelf_over_ground()
    sim = snow_over(meshes, shade=["ground"])
    fall(sim, meshes, 0.2, 16)
    now = assert_nothing_is_lost(sim)
    assert now["floor_volume"] > 0.01
    assert now["left_volume"] < 1e-6


def test_a_leaf_that_turns_over_drops_its_snow():
    leaf = sheet(0.4, 0.5, 64)
    meshes = {"ground": sheet(2.0), "leaf": leaf}
    sim = snow_over(meshes, slide_half_life=0.05)
    fall(sim, meshes, 0.05, 8)
    before = sim.statistics()["objects"]["ground"]["held_volume"]
    held = sim.statistics()["objects"]["leaf"]["held_volume"]
    turned = rotated(leaf[0] - np.float32([0, 0, 0.5]), "x", 80.0) + np.float32([0, 0, 0.5])
    sim.step({"leaf": turned}, 0.0, DOWN, FRAME)
    wait(sim, 60)
    now = assert_nothing_is_lost(sim)
    assert now["objects"]["leaf"]["held_volume"] < 0.2 * held
    gained = now["objects"]["ground"]["held_volume"] - before
    # Some falls off the ground's own edges before it is at rest.
    assert gained > 0.7 * (held - now["objects"]["leaf"]["held_volume"])


def test_a_stopped_simulation_goes_on_to_the_same_bytes(tmp_path):
    meshes = shelf_over_ground(2.0)
    whole = snow_over(meshes)
    fall(whole, meshes, 0.2, 32)
    first = snow_over(meshes)
    fall(first, meshes, 0.1, 16)
    assert first.statistics()["air_volume"] > 0.0
    save(first, tmp_path / "state")
    second = snow_over(meshes)
    restore(second, tmp_path / "state")
    second.step({name: mesh[0] for name, mesh in meshes.items()}, 0.1 / 16, DOWN, FRAME)
    fall(second, meshes, 0.1 / 16 * 15, 15, begin=17)
    for name in meshes:
        assert np.array_equal(second.height(name), whole.height(name)), name
    assert second.statistics() == whole.statistics()


def test_what_moves_goes_on_to_the_same_bytes():
    """A flag that waves and a cart that drives; half of the steps have no duration."""
    waving = grid(1.0, 0.6, cells=12)
    meshes = {
        "cart": pieces([((0.0, 0.0, 0.15), (0.5, 0.4, 0.3), 0.0)]),
        "flag": (*waving, 128),
        "ground": sheet(3.0),
    }

    def start():
        sim = native.SnowSimulation(pixel_size=0.01, max_depth=1.0, engine="CPU")
        for name, (rest, triangles, uv, resolution) in meshes.items():
            sim.add_object(name, triangles, uv, resolution=resolution, rest=rest)
        return sim

    def pose(step):
        flag = waving[0] + np.float32([0.0, 0.0, 0.8])
        flag[:, 2] += 0.1 * np.sin(5.0 * flag[:, 0] + 0.7 * step)
        cart = meshes["cart"][0] + np.float32([-1.0 + 0.08 * step, 0.3, 0.0])
        return {"flag": flag, "cart": cart}

    def snow(sim, begin, end):
        for step in range(begin, end):
            moved = pose(step - step % 3) if step % 3 == 0 or step == begin else {}
            if step == begin:
                moved["ground"] = meshes["ground"][0]
            sim.step(moved, 0.01, DOWN, FRAME if step % 2 else 0.0)

    whole = start()
    snow(whole, 0, 30)
    assert_nothing_is_lost(whole)
    for cut in (7, 16, 21):
        first, second = start(), start()
        snow(first, 0, cut)
        native.set_simulation_state(second, native.simulation_state(first))
        snow(second, cut, 30)
        for name in meshes:
            assert np.array_equal(second.height(name), whole.height(name)), (cut, name)
        assert second.statistics() == whole.statistics()


def test_snow_in_the_air_outside_of_a_map_is_refused():
    meshes = shelf_over_ground()
    sim = snow_over(meshes)
    fall(sim, meshes, 0.1, 2)
    state = native.simulation_state(sim)
    state["landing"]["air"] = [(5, "ground", 256 * 256, False, 1)]
    with pytest.raises(ValueError, match="'ground' has a place outside of its map"):
        native.set_simulation_state(sim, state)


def test_a_receiver_that_no_snow_reaches_stays_bare():
    meshes = {"cellar": sheet(0.5, -1.0, 64), "ground": sheet(2.0)}
    sim = snow_over(meshes)
    fall(sim, meshes, 0.1, 4)
    assert sim.height("cellar").max() == 0.0
    assert_nothing_is_lost(sim)


def test_nothing_towers_on_the_butts_of_tiles_on_which_snow_lands():
    """Eight courses of tiles in one open mesh: texels at the butts, 3 cm high, are partly wall, some only slivers."""
    turn = math.radians(40.0)
    faces = []
    for course in range(8):
        ends = [(0.22 * course, 0.0), (0.22 * (course + 1), 0.03), (0.22 * (course + 1), 0.0)]
        line = [
            (a * math.cos(turn) + b * math.sin(turn), b * math.cos(turn) - a * math.sin(turn))
            for a, b in ends
        ]
        for (x, z), (to_x, to_z) in pairwise(line):
            faces.append(np.array([(x, -0.6, z), (to_x, -0.6, to_z), (to_x, 0.6, to_z), (x, 0.6, z)]))
    roof = unfolded(faces, 0.01)
    with snow_over({"roof": roof}, cohesion=0.005, flutter=math.radians(10.0)) as sim:
        for step in range(4):
            sim.step({"roof": roof[0]} if step == 0 else {}, 0.0125, DOWN, FRAME)
            assert np.abs(sim.height("roof")).max() < 0.1
        assert_nothing_is_lost(sim)


def test_a_limb_keeps_no_more_than_without_landing():
    """Nothing that falls off its sides may come back to its top."""
    limb = cylinder(0.04, 1.0, axis="x")
    meshes = {"limb": (limb[0] + np.float32([0.0, 0.0, 1.0]), *limb[1:], 256)}
    shading = smooth(limb[0], limb[1])

    def kept(landing):
        with native.SnowSimulation(pixel_size=0.005, engine="CPU", landing=landing) as sim:
            sim.add_object("limb", limb[1], limb[2], resolution=256, shading=shading)
            fall(sim, meshes, 0.12, 8)
            return sim.statistics()["total"]["held_volume"]

    assert kept(True) == pytest.approx(kept(False), rel=0.01)


def test_without_landing_it_is_gone():
    meshes = shelf_over_ground()
    sim = snow_over(meshes, landing=False)
    fall(sim, meshes, 0.2, 16)
    now = sim.statistics()
    assert now["total"]["landed_volume"] == 0.0
    assert now["air_volume"] == now["left_volume"] == now["floor_volume"] == 0.0
