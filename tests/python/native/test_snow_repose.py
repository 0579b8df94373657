# SPDX-License-Identifier: GPL-3.0-or-later
"""Repose: the shape of snow whose surface would be too steep, and the places to which it moves."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from snow_fall import DOWN, FRAME, fall
from snow_meshes import STAYS, box, chart_of_box, grid, rotated, sphere

FRESH = math.radians(65.0)


def simulation(meshes, repose=FRESH, resolution=128, engine="CPU", only_shade=(), **settings):
    settings = {"pixel_size": 0.01, "max_depth": 100.0, "landing": False, **settings}
    sim = native.SnowSimulation(repose=repose, engine=engine, **settings)
    for name, (_, triangles, uv) in meshes.items():
        sim.add_object(name, triangles, uv, resolution=resolution, receive=name not in only_shade)
    return sim


both_engines = pytest.mark.parametrize("engine", ["CPU", "GL"])


def come_to_rest(sim, steps=4, seconds=4.0):
    for _ in range(steps):
        sim.step({}, 0.0, DOWN, seconds)


def moved(mesh, offset):
    return (mesh[0] + np.float32(offset), *mesh[1:])


def assert_balanced(sim):
    """Deposited snow lies or has slid; the rounding of heights counts as stretching."""
    sums = sim.statistics()["total"]
    assert abs(sums["stretched_volume"]) <= 2e-6 * sums["deposited_volume"]
    assert sums["held_volume"] == pytest.approx(
        sums["deposited_volume"] - sums["slid_volume"] + sums["stretched_volume"], rel=1e-12
    )
    return sums


def steepest(heights, texel):
    """Degrees, along rows and columns."""
    steps = [np.abs(np.diff(heights, axis=axis)).max() for axis in (0, 1)]
    return math.degrees(math.atan(max(steps) / texel))


def plate_below_a_hole():
    """A plate of 1.2 m, and lids above it that leave a hole of 12 cm."""
    sheets = [grid(0.94, 2.0), grid(0.94, 2.0), grid(0.12, 0.94), grid(0.12, 0.94)]
    places = [(-0.53, 0, 2), (0.53, 0, 2), (0, -0.53, 2), (0, 0.53, 2)]
    meshes = {"plate": grid(1.2, 1.2)}
    return meshes | {f"lid {i}": moved(mesh, at) for i, (mesh, at) in enumerate(zip(sheets, places))}


def heap(repose, resolution=128, engine="CPU"):
    """A plate of 1.2 m on which snow fell through a hole of 12 cm, at rest; and its texel's size."""
    meshes = plate_below_a_hole()
    lids = [name for name in meshes if name != "plate"]
    sim = simulation(meshes, repose, resolution, engine, only_shade=lids)
    fall(sim, meshes, 0.5, 24)
    come_to_rest(sim)
    return sim, 1.2 / 0.96 / resolution


@both_engines
@pytest.mark.parametrize("degrees", [40.0, 65.0])
def test_a_heap_becomes_a_cone_of_that_angle(degrees, engine):
    sim, texel = heap(math.radians(degrees), engine=engine)
    with sim:
        height = sim.height("plate")
        assert_balanced(sim)
    rise = np.hypot(*np.gradient(height, texel))
    flank = (height > 0.2 * height.max()) & (height < 0.75 * height.max())
    assert np.degrees(np.arctan(rise[flank])).mean() == pytest.approx(degrees, abs=2.0)
    y, x = np.nonzero(flank)
    assert abs(x.mean() - y.mean()) < 1.0  # as far along one axis as along the other
    assert abs(np.std(x) - np.std(y)) < 1.0


@both_engines
def test_a_heap_keeps_its_volume_to_a_millionth(engine):
    sim, _ = heap(FRESH, engine=engine)
    with sim:
        sums = assert_balanced(sim)
        volume = float((sim.height("plate").astype(float) * sim.texel_area("plate")).sum())
    assert sums["slid_volume"] == 0.0
    assert volume == pytest.approx(sums["deposited_volume"], rel=2e-6)


def keep_texels(sim, name, mesh):
    """With a mask, here one that takes all, snow comes to rest on the map's own texels."""
    sim.set_mask(name, np.ones((len(mesh[1]), 3), np.float32))


def joined(heights, side):
    """Means of squares of side x side texels."""
    size = len(heights) // side
    return heights.reshape(size, side, size, side).mean(axis=(1, 3), dtype=np.float64)


@pytest.mark.parametrize("side", [1, 2])
def test_a_heap_over_many_blocks_rests_in_the_step_that_brings_its_snow(side):
    """Through a hole, 30 mm at a time: a flank of 70 texels is no steeper at the blocks' borders. Nor is one of squares
    of texels, on which so much snow comes to rest without a mask."""
    meshes = plate_below_a_hole()
    angle = math.radians(40.0)
    with simulation(meshes, angle, 384, only_shade=meshes.keys() - {"plate"}, pixel_size=0.004) as sim:
        if side == 1:
            keep_texels(sim, "plate", meshes["plate"])
        fall(sim, meshes, 1.2, 40)
        heights = joined(sim.height("plate"), side)[8 // side : -8 // side, 8 // side : -8 // side]
    slopes = np.hypot(*np.gradient(heights, side * 1.2 / (0.96 * 384)))
    assert math.degrees(math.atan(np.percentile(slopes, 99.9))) < 42.0


def test_on_joined_texels_snow_is_shaped_as_on_the_maps_own():
    """16 cm of snow on a box, with texels of 1.7 mm: on average to 1 mm, and to 8 mm on 99 % of them."""
    mesh = box(0.5, 0.5)
    heights = []
    for keeps in (True, False):
        with simulation({"box": mesh}, resolution=1024) as sim:
            if keeps:
                keep_texels(sim, "box", mesh)
            fall(sim, {"box": mesh}, 0.16, 16)
            come_to_rest(sim)
            assert_balanced(sim)
            heights.append(sim.height("box"))
    apart = np.abs(heights[0] - heights[1])[heights[0] > 0.0]
    assert 0.0 < apart.mean() < 0.001
    assert np.percentile(apart, 99) < 0.008


def test_on_joined_texels_a_stopped_simulation_goes_on_to_the_same_bytes(tmp_path):
    """The texels become squares after the checkpoint, when the snow is deep enough."""
    mesh = box(0.5, 0.5)

    def steps(sim, count):
        for _ in range(count):
            sim.step({"box": mesh[0]}, 0.02, (0.1, 0.0, -1.0), FRAME)

    maps = []
    for stop in (None, 3, 6):
        with simulation({"box": mesh}, resolution=512, landing=True) as sim:
            steps(sim, stop or 8)
            if stop is not None:
                save(sim, tmp_path / f"{stop}.state")
            maps.append(sim.height("box"))
        if stop is not None:
            with simulation({"box": mesh}, resolution=512, landing=True) as sim:
                restore(sim, tmp_path / f"{stop}.state")
                steps(sim, 8 - stop)
                maps[-1] = sim.height("box")
    assert maps[0].tobytes() == maps[1].tobytes() == maps[2].tobytes()


def test_the_edge_of_a_sheltered_spot_becomes_a_bank():
    meshes = {"ground": grid(1.6, 1.6), "roof": moved(grid(0.7, 0.7), (0, 0, 0.5))}
    with simulation(meshes, resolution=256, only_shade=["roof"]) as sim:
        fall(sim, meshes, 0.12, 24)
        come_to_rest(sim)
        height = sim.height("ground")[60:-60, 60:-60]
        assert_balanced(sim)
    assert height.min() == 0.0 and height.max() == pytest.approx(0.12, rel=1e-3)
    assert steepest(height, 1.6 / 0.96 / 256) <= 65.5


@both_engines
def test_a_box_gets_round_shoulders_and_bare_walls(engine):
    mesh = box(0.5, 0.5)
    with simulation({"box": mesh}, resolution=256, engine=engine) as sim:
        fall(sim, {"box": mesh}, 0.15, 24)
        come_to_rest(sim)
        height = sim.height("box")
        sums = assert_balanced(sim)
    across = height[192, 171:][height[192, 171:] > 0.0]
    texel = 0.5 / ((1 / 3 - 0.04) * 256)
    assert max(across[0], across[-1]) < 0.05  # at the rim
    assert np.sum(across < 0.147) * texel / 2 >= 0.03  # from there to full depth
    assert across.max() == pytest.approx(0.15, rel=1e-3)
    assert sums["slid_volume"] > 0.0
    for wall in range(4):
        assert chart_of_box(height, wall).max() == 0.0


def test_a_post_wears_a_cap_that_its_top_supports():
    mesh = box(0.1, 1.0)
    with simulation({"post": mesh}, resolution=128, pixel_size=0.004) as sim:
        fall(sim, {"post": mesh}, 0.15, 24)
        come_to_rest(sim)
        top = chart_of_box(sim.height("post"), 5)
    assert 0.05 < top.max() < 0.12  # a pyramid of 65 degrees is 0.107 m high
    assert top[0].max() < 0.4 * top.max()


def tube(radius, length=0.3, around=24):
    """A twig along y, its seam on one side."""
    turn = np.linspace(0.0, 2.0 * np.pi, around + 1)
    rim = radius * np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=1)
    positions = np.concatenate([rim - (0, length / 2, 0), rim + (0, length / 2, 0)]).astype(np.float32)
    uv = np.stack([np.tile(np.arange(around + 1) / around, 2), np.repeat([0.0, 1.0], around + 1)], axis=1)
    triangles = []
    for i in range(around):
        a, b = i, i + around + 1
        triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    triangles = np.array(triangles, np.int32)
    return positions, triangles, (uv[triangles] * 0.96 + 0.02).astype(np.float32)


def test_a_twig_wears_no_sausage():
    radius, mesh = 0.01, tube(0.01)
    with simulation({"twig": mesh}, resolution=64, pixel_size=0.002) as sim:
        fall(sim, {"twig": mesh}, 0.05, 48)
        come_to_rest(sim)
        row = sim.height("twig")[32]
        assert_balanced(sim)
    angle = 2.0 * np.pi * ((np.arange(64) + 0.5) / 64 - 0.02) / 0.96
    x, z = (radius + row) * np.cos(angle), (radius + row) * np.sin(angle)
    assert np.ptp(x) <= 1.5 * 2 * radius
    assert 0.2 * radius < z.max() - radius <= 2.5 * 2 * radius


@both_engines
def test_a_wall_is_bare_a_second_after_the_wind(engine):
    mesh = box(0.5, 0.5)
    with simulation({"box": mesh}, max_depth=1.0, engine=engine) as sim:
        fall(sim, {"box": mesh}, 0.2, 12, direction=(1.0, 0.0, -1.0))
        assert chart_of_box(sim.height("box"), 0).max() > 0.0
        for _ in range(24):
            sim.step({}, 0.0, DOWN, FRAME)
        assert chart_of_box(sim.height("box"), 0).max() == 0.0
        assert_balanced(sim)


@both_engines
def test_a_tilted_table_sheds_its_snow(engine):
    mesh = grid(1.0, 1.0, cells=4)
    with simulation({"table": mesh}, repose=math.radians(40.0), resolution=64, engine=engine) as sim:
        fall(sim, {"table": mesh}, 0.1, 12)
        before = sim.statistics()["total"]
        for degrees in (15.0, 30.0, 45.0, 60.0):
            sim.step({"table": rotated(mesh[0], "x", degrees)}, 0.0, DOWN, FRAME)
        come_to_rest(sim, 20)
        sums = sim.statistics()["total"]
    assert before["held_volume"] > 0.07
    assert sums["held_volume"] < 0.01 * before["held_volume"]
    assert sums["slid_volume"] == pytest.approx(sums["deposited_volume"] - sums["held_volume"], rel=1e-5)


@both_engines
def test_a_seam_stops_no_snow(engine):
    """A plate whose halves are charts of their own, and the same with vertices of their own at the seam."""
    positions, triangles, uv = grid(1.0, 1.0, cells=2)
    left = positions[triangles].mean(axis=1)[:, 0] < 0.0
    apart = np.where(left[:, None, None], uv * (0.9, 1.0), uv * (0.9, 1.0) + (0.08, 0.0)).astype(np.float32)
    split = positions[triangles].reshape(-1, 3), np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)
    roof = moved(grid(0.5, 2.0), (0.25, 0.0, 0.5))  # over the right half
    volumes = []
    for mesh in ((positions, triangles, apart), (*split, apart)):
        meshes = {"plate": mesh, "roof": roof}
        with simulation(meshes, engine=engine, only_shade=["roof"]) as sim:
            fall(sim, meshes, 0.1, 12)
            come_to_rest(sim)
            height, area = sim.height("plate"), sim.texel_area("plate")
            assert_balanced(sim)
        volumes.append(float((height * area)[30:-30, 64:80].sum()))
        assert height[64, 67:71].max() > 0.03  # beyond the seam
        assert height[64, :54].max() == pytest.approx(0.1, rel=1e-3)
    assert volumes[0] > 1e-4 and volumes[1] == pytest.approx(volumes[0], rel=0.05)


@both_engines
def test_a_card_that_lies_face_down_carries_the_same_heap_on_its_back(engine):
    card = grid(0.3, 0.3)
    heights = []
    for mesh in (card, (rotated(card[0], "x", 180.0), *card[1:])):
        with simulation({"card": mesh}, resolution=64, engine=engine) as sim:
            fall(sim, {"card": mesh}, 0.1, 12)
            come_to_rest(sim)
            heights.append(sim.height("card"))
            assert assert_balanced(sim)["slid_volume"] > 0.0
    positive, back = heights
    assert positive.min() == 0.0 and back.max() == 0.0
    assert -back.sum() == pytest.approx(positive.sum(), rel=0.01)
    assert np.abs(positive + back[::-1]).max() < 0.01


def test_ninety_degrees_and_no_time_leave_snow_where_it_fell():
    mesh = box(0.5, 0.5)
    heights = []
    for repose, dt in ((STAYS, 0.0), (FRESH, 0.0)):
        with simulation({"box": mesh}, repose) as sim:
            sim.step({"box": mesh[0]}, 0.1, (0.5, 0.0, -1.0), dt)
            heights.append(sim.height("box"))
    assert np.array_equal(*heights)
    assert chart_of_box(heights[0], 0).max() > 0.0


@pytest.mark.parametrize("bad", [0.0, -1.0, 1.6, math.nan])
def test_an_angle_out_of_range_is_refused(bad):
    with pytest.raises(ValueError, match="repose must be over 0 and at most pi / 2 radians"):
        native.SnowSimulation(repose=bad, engine="CPU")


def test_the_frame_rate_makes_no_difference():
    mesh = box(0.5, 0.5)
    profiles = []
    for steps in (24, 96):
        with simulation({"box": mesh}) as sim:
            fall(sim, {"box": mesh}, 0.1, steps)
            come_to_rest(sim)
            profiles.append(chart_of_box(sim.height("box"), 5))
    assert np.abs(profiles[0] - profiles[1]).mean() < 0.002
    assert np.abs(profiles[0] - profiles[1]).max() < 0.012


@both_engines
def test_a_run_that_was_stopped_ends_with_the_same_bits(tmp_path, engine):
    meshes = {"ball": sphere(0.3), "ground": moved(grid(2.0, 2.0), (0, 0, -0.3))}
    with simulation(meshes, engine=engine) as sim:
        fall(sim, meshes, 0.1, 6)
        save(sim, tmp_path / "state")
        fall(sim, meshes, 0.1, 6)
        expected = [sim.height(name) for name in meshes]
    with simulation(meshes, engine=engine) as sim:
        restore(sim, tmp_path / "state")
        fall(sim, meshes, 0.1, 6)
        assert all(np.array_equal(sim.height(name), map_) for name, map_ in zip(meshes, expected))


@both_engines
def test_other_objects_and_tiles_make_no_difference(engine):
    meshes = {"box": box(0.5, 0.5), "far": moved(box(0.4, 0.3), (2.0, 0.0, 0.0))}
    alone = {"box": meshes["box"]}
    heights = []
    for receivers, tile_size in ((meshes, 2048), (meshes, 64), (alone, 2048)):
        shades = [name for name in meshes if name not in receivers]
        with simulation(meshes, engine=engine, only_shade=shades, tile_size=tile_size) as sim:
            fall(sim, meshes, 0.1, 6)
            heights.append(sim.height("box"))
    assert np.array_equal(heights[0], heights[1]) and np.array_equal(heights[0], heights[2])


def test_both_engines_move_the_same_snow():
    mesh = box(0.5, 0.5)
    maps = []
    for engine in ("CPU", "GL"):
        with simulation({"box": mesh}, engine=engine) as sim:
            fall(sim, {"box": mesh}, 0.1, 6)
            maps.append(chart_of_box(sim.height("box"), 5))
            assert_balanced(sim)
    assert np.abs(maps[0] - maps[1]).max() < 1e-4


def test_slopes_of_a_ball_do_not_become_combs():
    """Heights of neighbouring texels on a slope must not alternate."""
    mesh = sphere(0.4, 64, 32)
    with simulation({"ball": mesh}, resolution=256) as sim:
        fall(sim, {"ball": mesh}, 0.1, 24)
        come_to_rest(sim)
        height = sim.height("ball").astype(np.float64)
    # Rows run from pole to pole: the second difference along the slope, in parts of the thickness around.
    inner = height[140:250, 20:236]
    teeth = np.abs(inner[:-2] - 2.0 * inner[1:-1] + inner[2:])
    around = (inner[:-2] + inner[1:-1] + inner[2:]) / 3.0
    covered = around > 0.02
    assert covered.sum() > 10_000
    assert np.percentile(teeth[covered] / around[covered], 95) < 0.1


def test_the_memory_estimate_counts_repose():
    mesh = grid(1.0, 1.0)
    with (
        simulation({"ground": mesh}, resolution=512) as moves,
        simulation({"ground": mesh}, resolution=512, repose=STAYS) as stays,
    ):
        kept = moves.memory_estimate()["total"] - stays.memory_estimate()["total"]
    # Blocks take about 90 bytes per texel, the tables of landing 32.
    assert 512 * 512 * 100 < kept < 512 * 512 * 140


def faces_of(positions, triangles, uv):
    """(upward part of each triangle's normal, texel table)"""
    face = np.cross(*(positions[triangles[:, k]] - positions[triangles[:, 0]] for k in (1, 2)))
    up = face[:, 2] / np.linalg.norm(face, axis=1)
    return up, native.texel_table(triangles, uv, 128)


def test_walls_that_are_shaded_smooth_are_bare_too():
    """A coarse ball's faces at its equator are walls, where their smooth normals still face up a little."""
    positions, triangles, uv = mesh = sphere(0.4, 16, 16)
    up, table = faces_of(positions, triangles, uv)
    owner = np.full(128 * 128, -1)
    owner[table["texel"]] = table["triangle"]
    walls = ((owner >= 0) & (np.abs(up[owner]) < 0.0999)).reshape(128, 128)
    assert walls.sum() > 500
    sim = native.SnowSimulation(pixel_size=0.004, repose=FRESH, engine="CPU", max_depth=10.0, landing=False)
    with sim:
        sim.add_object("ball", triangles, uv, resolution=128, shading=triangles.astype(np.int32))
        for _ in range(4):
            fall(sim, {"ball": mesh}, 0.02, 1, direction=(math.sin(1.0), 0.0, -math.cos(1.0)))
        come_to_rest(sim)
        assert np.abs(sim.height("ball")[walls]).max() < 1e-6
        assert_balanced(sim)


@pytest.mark.parametrize("smooth", [False, True])
def test_walls_shed_their_snow_once_however_they_are_shaded(smooth):
    """Half of it in a hundredth of a second, on faces that are walls by their own normals."""
    positions, triangles, uv = sphere(0.4, 16, 16)
    up, table = faces_of(positions, triangles, uv)
    walls = np.zeros(128 * 128, bool)
    walls[table["texel"]] = (up[table["triangle"]] > 0.0) & (up[table["triangle"]] < 0.0999)
    with native.SnowSimulation(
        pixel_size=0.004, repose=FRESH, engine="CPU", max_depth=10.0, landing=False
    ) as sim:
        shading = triangles.astype(np.int32) if smooth else None
        sim.add_object("ball", triangles, uv, resolution=128, shading=shading)
        sim.step({"ball": positions}, 0.2, (1.0, 0.0, -1.0), 0.0)
        before = sim.height("ball").ravel()[walls]
        sim.step({}, 0.0, DOWN, 0.01)
        after = sim.height("ball").ravel()[walls]
    lies = before > 0.02
    assert lies.sum() > 100
    # Texels shared with other faces are not walls and are bare.
    assert np.median(after[lies] / before[lies]) == pytest.approx(0.5, rel=1e-3)
