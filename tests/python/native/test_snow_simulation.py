# SPDX-License-Identifier: GPL-3.0-or-later
"""A simulation as an object: determinism, state, receivers, end of life, and errors."""

import gc
import math

import numpy as np
import pytest
from checkpoints import restore, save
from snow_fall import new_simulation, simulation, snow_on, volume
from snow_meshes import grid, sphere, wind

# Determinism and formulations


def scene_heights(order, receivers, tile_size=2048, mapping="COMPUTE", seed=3):
    objects = {"ball": sphere(), "ground": grid(3.0, 3.0, 2), "plate": grid(0.5, 0.5)}
    placed = {
        "ball": objects["ball"][0] + np.float32((0.0, 0.0, 1.0)),
        "ground": objects["ground"][0],
        "plate": objects["plate"][0] + np.float32((0.8, 0.0, 0.4)),
    }
    with simulation(
        pixel_size=0.01,
        noise_density=0.5,
        flutter=np.radians(2.0),
        seed=seed,
        tile_size=tile_size,
        mapping=mapping,
    ) as sim:
        for name in order:
            sim.add_object(
                name, objects[name][1], objects[name][2], resolution=128, receive=name in receivers
            )
        for frame in range(3):
            sim.step(placed, 0.01, wind(20.0 + frame))
        return {name: sim.height(name) for name in receivers}


def test_order_tiles_and_the_choice_of_receivers_change_no_bit():
    every = ("ball", "ground", "plate")
    first = scene_heights(every, every)
    assert first["ground"].max() > 0.0
    for other in (
        scene_heights(every[::-1], every),
        scene_heights(every, every, tile_size=64),
        scene_heights(every, every),
        scene_heights(every, ("ground",)),
        scene_heights(every, ("ball", "plate")),
    ):
        for name, height in other.items():
            assert np.array_equal(height, first[name]), name
    assert not np.array_equal(scene_heights(every, every, seed=4)["ground"], first["ground"])


@pytest.mark.parametrize("pixel_size", [0.004, 0.02, 0.05])
def test_geometry_lays_as_much_as_compute_over_many_steps(pixel_size):
    maps = {}
    for mapping in ("COMPUTE", "GEOMETRY"):
        maps[mapping] = snow_on(
            sphere(),
            steps=24,
            resolution=128,
            pixel_size=pixel_size,
            direction=wind(30.0),
            mapping=mapping,
            engine="GL",
        )
    (one, area, a), (two, _, b) = maps["COMPUTE"], maps["GEOMETRY"]
    assert volume(two, area) == pytest.approx(volume(one, area), rel=0.005)
    assert b["visible_area"] == pytest.approx(a["visible_area"], rel=0.005)


# State, errors, life time


def test_a_checkpoint_continues_bit_for_bit(tmp_path):
    positions, triangles, uv = sphere()

    def start():
        sim = simulation(pixel_size=0.01, noise_density=0.5, flutter=np.radians(3.0))
        sim.add_object("it", triangles, uv, resolution=64)
        return sim

    with start() as sim:
        for _ in range(3):
            sim.step({"it": positions}, 0.01)
        save(sim, tmp_path / "state")
        for _ in range(3):
            sim.step({}, 0.01)
        expected, books = sim.height("it"), sim.statistics()
    with start() as sim:
        restore(sim, tmp_path / "state")
        for _ in range(3):
            sim.step({"it": positions}, 0.01)
        assert np.array_equal(sim.height("it"), expected)
        assert sim.statistics()["total"] == books["total"]
    with start() as sim:
        data = (tmp_path / "state").read_bytes()
        (tmp_path / "cut").write_bytes(data[: len(data) // 2])
        with pytest.raises(RuntimeError, match="cut"):
            restore(sim, tmp_path / "cut")


def test_objects_can_join_later_and_maps_keep_their_snow():
    positions, triangles, uv = grid()
    with simulation() as sim:
        sim.add_object("b", triangles, uv, resolution=64)
        sim.step({"b": positions}, 0.1)
        before = sim.height("b")
        sim.add_object("a", triangles, uv, resolution=128)
        assert np.array_equal(sim.height("b"), before)
        sim.step({"a": positions + np.float32((3.0, 0.0, 0.0))}, 0.0)
        assert np.array_equal(sim.height("b"), before)
        assert sim.statistics()["total"]["deposited_volume"] == pytest.approx(0.1, rel=0.01)


def test_many_receivers_of_different_sizes():
    positions, triangles, uv = grid(0.1, 0.1)
    with simulation(pixel_size=0.01, tile_size=1024) as sim:
        moved = {}
        for i in range(200):
            sim.add_object(f"{i:03}", triangles, uv, resolution=128 if i % 10 else 256)
            moved[f"{i:03}"] = positions + np.float32((0.2 * (i % 20), 0.2 * (i // 20), 0.0))
        estimate = sim.memory_estimate()
        assert estimate["maps"] == (180 * 128**2 + 20 * 256**2) * 4
        assert "MiB" in estimate["text"]
        for _ in range(8):
            sim.step(moved, 0.01)
        objects = sim.statistics()["objects"]
        volumes = [objects[name]["total"]["deposited_volume"] for name in moved]
    assert np.mean(volumes) == pytest.approx(0.08 * 0.01, rel=0.01)
    assert min(volumes) > 0.8 * 0.08 * 0.01


def test_two_simulations_at_once():
    positions, triangles, uv = grid()
    with simulation() as one, simulation() as two:
        for sim in (one, two):
            sim.add_object("it", triangles, uv, resolution=64)
        one.step({"it": positions}, 0.1)
        two.step({"it": positions}, 0.2)
        one.step({}, 0.1)
        assert one.statistics()["held_volume"] == pytest.approx(0.2, rel=0.01)
        assert two.statistics()["held_volume"] == pytest.approx(0.2, rel=0.01)


def test_closing_and_collecting_release():
    positions, triangles, uv = grid()
    for _ in range(3):
        sim = simulation()
        sim.add_object("it", triangles, uv, resolution=64)
        sim.step({"it": positions}, 0.1)
        del sim
        gc.collect()
    sim = simulation()
    sim.close()
    sim.close()
    with pytest.raises(RuntimeError, match="closed"):
        sim.step({}, 0.1)


def test_bad_input_is_refused_by_name():
    positions, triangles, uv = grid()
    with simulation() as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        with pytest.raises(ValueError, match="it"):
            sim.add_object("it", triangles, uv, resolution=64)
        with pytest.raises(ValueError, match="odd"):
            sim.add_object("odd", triangles, uv[:1], resolution=64)
        with pytest.raises(ValueError, match="it"):
            sim.step({}, 0.1)
        with pytest.raises(ValueError, match="other"):
            sim.step({"it": positions, "other": positions}, 0.1)
        sim.step({"it": positions}, 0.1)
        with pytest.raises(ValueError, match="vertices"):
            sim.step({"it": positions[:-1]}, 0.1)
        with pytest.raises(ValueError, match="downwards"):
            sim.step({}, 0.1, (0.0, 0.0, 1.0))
        with pytest.raises(ValueError, match="finite"):
            sim.step({"it": np.full_like(positions, np.nan)}, 0.1)
        with pytest.raises(ValueError, match="depth"):
            sim.step({}, math.nan)
        with pytest.raises(ValueError, match="missing"):
            sim.height("missing")
        assert sim.statistics()["held_volume"] == pytest.approx(0.1, rel=0.01)
    with pytest.raises(ValueError, match="pixel_size"):
        new_simulation(pixel_size=0.0)
    with pytest.raises(ValueError, match="mapping"):
        new_simulation(mapping="MAGIC")


def test_a_scene_that_spans_too_many_pixels_is_refused():
    positions, triangles, uv = grid()
    with simulation(pixel_size=1e-5) as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        with pytest.raises(ValueError, match="larger pixel_size"):
            sim.step({"it": positions}, 0.1)


def test_output_is_smooth_where_the_map_is_sharp():
    positions, triangles, uv = grid()
    with simulation(blur_radius=0.05, noise_density=0.1, pixel_size=0.01) as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        # So many that almost no texel is bare; snow would not flow onto a bare one.
        for step in range(60):
            sim.step({"it": positions} if step == 0 else {}, 0.1 / 60)
        stored, output = sim.height("it"), sim.output("it")
    assert output["height"].shape == (64, 64) and output["normal"].shape == (64, 64, 3)
    inner = np.s_[8:-8, 8:-8]
    assert output["height"][inner].std() < 0.5 * stored[inner].std()
    assert output["height"][inner].mean() == pytest.approx(stored[inner].mean(), rel=0.1)
