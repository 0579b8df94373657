# SPDX-License-Identifier: GPL-3.0-or-later
"""The two engines of a simulation: their choice, their agreement, and the one that needs no driver."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from snow_meshes import STAYS, box, grid, rotated, sphere, wind

STEPS, STEP_DEPTH = 6, 0.01


def baked(engine, density=1.0, repose=STAYS, max_depth=0.02):
    """In tiles, on two maps, with snow that slides and an object that moves."""
    ball, ground = sphere(), grid(4.0, 4.0)
    below = ground[0] - np.float32([2.0, 2.0, 1.2])
    with native.SnowSimulation(
        landing=False,
        repose=repose,
        pixel_size=0.02,
        max_depth=max_depth,
        noise_density=density,
        tile_size=64,
        flutter=np.radians(2.0),
        engine=engine,
    ) as sim:
        sim.add_object("ball", *ball[1:], resolution=128)
        sim.add_object("ground", *ground[1:], resolution=256)
        for step in range(STEPS):
            turned = rotated(ball[0], "x", 20 * step)
            sim.step({"ball": turned, "ground": below}, STEP_DEPTH, (0.3, 0.1, -1.0), 1.0)
        outputs = sim.output("ball"), sim.output("ground")
        return sim.height("ball"), sim.height("ground"), outputs, sim.statistics()["total"]


@pytest.mark.parametrize("density", [1.0, 0.3])
def test_engines_agree(density):
    cpu, gl = baked("CPU", density), baked("GL", density)
    for one, other in zip(cpu[:2], gl[:2]):
        assert one.max() > 0.015
        visible = (one > 0.0) | (other > 0.0)
        assert ((one > 0.0) & (other > 0.0)).sum() >= 0.9999 * visible.sum()
        # Away from shadows' edges: a ten-thousandth of each step's depth.
        assert (abs(one - other) > STEPS * 1e-4 * STEP_DEPTH).sum() <= 1e-4 * visible.sum()
    for one, other in zip(cpu[2], gl[2]):
        assert abs(one["height"] - other["height"]).max() < 1e-4
        assert abs(one["normal"] - other["normal"]).max() < 0.01
    for name, value in cpu[3].items():
        # What shares a sign, as stretched and squeezed volumes, counts beside what fell.
        assert value == pytest.approx(gl[3][name], rel=1e-5, abs=1e-5 * cpu[3]["deposited_volume"]), name


@pytest.mark.parametrize("repose", [40.0, 65.0])
def test_engines_agree_closely_where_snow_moves(repose):
    """The same code moves lying snow, on a ball that turns by 20 degrees per step."""
    cpu, gl = (baked(engine, repose=math.radians(repose), max_depth=1.0) for engine in ("CPU", "GL"))
    for one, other in zip(cpu[:2], gl[:2]):
        assert abs(one - other).max() < 1e-4 * STEP_DEPTH
    assert cpu[3]["slid_volume"] > 0.0
    assert cpu[3]["held_volume"] == pytest.approx(gl[3]["held_volume"], rel=1e-4)


def test_engines_agree_on_a_ball_that_stands():
    """The map is 100 times as deep as the largest difference."""
    ball = sphere(0.5, 24, 12)
    maps = []
    for engine in ("CPU", "GL"):
        with native.SnowSimulation(pixel_size=0.01, max_depth=100.0, landing=False, engine=engine) as sim:
            sim.add_object("ball", *ball[1:], resolution=128)
            for step in range(6):
                sim.step({"ball": ball[0]} if step == 0 else {}, 0.01, (0.0, 0.0, -1.0), 1.0 / 24.0)
            maps.append(sim.height("ball"))
            sums = sim.statistics()["total"]
            assert sums["slid_volume"] > 0.1 * sums["deposited_volume"]
    assert abs(maps[0] - maps[1]).max() < 0.01 * maps[0].max()
    assert abs(maps[0] - maps[1]).mean() < 1e-3 * maps[0].mean()


def test_engines_agree_on_what_slides_off_and_lands():
    """A ball sheds onto the ground below. The maps are 10,000 times as deep as the largest difference."""
    ball, ground = sphere(0.5, 24, 12), grid(3.0, 3.0)
    meshes = {"ball": ball[0], "ground": ground[0] - np.float32([0.0, 0.0, 0.8])}
    maps, sums = [], []
    for engine in ("CPU", "GL"):
        with native.SnowSimulation(pixel_size=0.01, max_depth=1.0, engine=engine) as sim:
            sim.add_object("ball", *ball[1:], resolution=128)
            sim.add_object("ground", *ground[1:], resolution=128)
            for step in range(24):
                sim.step(meshes if step == 0 else {}, 0.02 if step < 8 else 0.0, (0.0, 0.0, -1.0), 1.0 / 24.0)
            maps.append((sim.height("ball"), sim.height("ground")))
            sums.append(sim.statistics())
    for cpu, gl in zip(*maps):
        assert abs(cpu - gl).max() < 1e-4 * cpu.max()
    assert sums[0]["total"]["landed_volume"] > 0.01
    for name in ("slid_volume", "landed_volume", "held_volume"):
        assert sums[0]["total"][name] == pytest.approx(sums[1]["total"][name], rel=1e-5), name
    for name in ("left_volume", "floor_volume", "air_volume"):
        assert sums[0][name] == pytest.approx(sums[1][name], rel=1e-5, abs=1e-9), name


def test_engines_agree_on_drifts():
    """A wall in the wind. The drift is 10,000 times as deep as the largest difference."""
    ground = grid(6.0, 6.0)
    wall = box()
    wall = wall[0] * np.float32([0.1, 5.0, 0.6]), *wall[1:]
    maps, sums = [], []
    for engine in ("CPU", "GL"):
        with native.SnowSimulation(
            pixel_size=0.02, repose=math.radians(65.0), drift=0.4, flutter=0.0, engine=engine
        ) as sim:
            sim.add_object("ground", *ground[1:], resolution=128)
            sim.add_object("wall", *wall[1:], receive=False)
            for step in range(16):
                poses = {"ground": ground[0], "wall": wall[0]} if step == 0 else {}
                sim.step(poses, 0.02 if step < 5 else 0.0, dt=1.0 / 24.0, wind=(1.0, 0.0))
            maps.append(sim.height("ground"))
            sums.append(sim.statistics()["total"])
    cpu, gl = maps
    assert cpu[64, 70:].max() > 1.2 * cpu[64, 8:32].mean() > 0.09
    assert abs(cpu - gl).max() < 1e-4 * cpu.max()
    assert sums[0]["drifted_volume"] == pytest.approx(sums[1]["drifted_volume"], rel=1e-4)


def test_the_engine_tells_its_name_driver_and_reason():
    with native.SnowSimulation(repose=STAYS, engine="CPU") as sim:
        assert sim.engine["name"] == "CPU" and sim.engine["driver"].startswith("processor")
        assert sim.engine["reason"] == "requested"
    with native.SnowSimulation(repose=STAYS, engine="GL") as sim:
        assert sim.engine["name"] == "GL" and "4." in sim.engine["driver"]
    with native.Engine("AUTO") as engine:
        software = "llvmpipe" in native.Engine("GL").info["driver"]
        assert engine.info["name"] == ("CPU" if software else "GL")
        assert engine.info["reason"] != ""


def test_bad_wishes_say_what_to_do():
    with pytest.raises(ValueError, match="AUTO, GL or CPU, not VULKAN"):
        native.SnowSimulation(repose=STAYS, engine="VULKAN")
    with pytest.raises(ValueError, match="GEOMETRY needs OpenGL: use engine GL"):
        native.SnowSimulation(repose=STAYS, engine="CPU", mapping="GEOMETRY")


def test_a_checkpoint_of_one_engine_can_be_continued_by_the_other(tmp_path):
    positions, triangles, uv = grid()
    path = str(tmp_path / "state")
    with native.SnowSimulation(repose=STAYS, engine="CPU") as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        sim.step({"it": positions}, 0.01)
        save(sim, path)
    with native.SnowSimulation(repose=STAYS, engine="GL") as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        restore(sim, path)
        sim.step({"it": positions}, 0.01)
        assert sim.height("it")[32, 32] == pytest.approx(0.02)


WITHOUT_EGL = """
import numpy as np, snowbough_native as native
from snow_meshes import grid
try:
    native.Engine("GL").info
except RuntimeError as error:
    assert "libEGL.so.1, which cannot be loaded" in str(error), error
else:
    raise SystemExit("EGL is there")
positions, triangles, uv = grid()
with native.SnowSimulation() as sim:
    assert sim.engine["name"] == "CPU" and "libEGL" in sim.engine["reason"], sim.engine
    sim.add_object("it", triangles, uv, resolution=64)
    sim.step({"it": positions}, 0.01, (0, 0, -1), 1 / 24)
    assert abs(sim.output("it")["height"][32, 32] - 0.01) < 1e-6
print("snowed")
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no EGL")
def test_snow_falls_where_there_is_no_egl(tmp_path):
    for library in ("libEGL.so.1", "libOpenGL.so.0", "libGL.so.1"):
        (tmp_path / library).write_bytes(b"no library")
    here = Path(__file__).resolve().parent
    path = os.pathsep.join([str(Path(native.__file__).parent), str(here)])
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT_EGL],
        env={**os.environ, "LD_LIBRARY_PATH": str(tmp_path), "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.strip() == "snowed"


def test_two_threads_of_simulations_do_not_disturb_each_other():
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(3) as pool:
        results = list(pool.map(lambda _: baked("CPU")[0], range(6)))
    assert all(np.array_equal(results[0], other) for other in results)


def test_the_wind_reaches_a_wall_on_both_engines():
    positions, triangles, uv = grid()
    wall = rotated(positions, "x", 90.0)
    for engine in ("CPU", "GL"):
        with native.SnowSimulation(repose=STAYS, pixel_size=0.01, max_depth=1e6, engine=engine) as sim:
            sim.add_object("wall", triangles, uv, resolution=64)
            sim.step({"wall": wall}, 0.01, wind(45.0), 0.0)
            height = sim.height("wall")
        assert height[32, 32] == pytest.approx(0.01, rel=1e-4)


def stepped(sim, steps=2):
    positions, triangles, uv = grid()
    sim.add_object("it", triangles, uv, resolution=64)
    sim.measure_passes(True)
    for _ in range(steps):
        sim.step({"it": positions}, 0.01)


@pytest.mark.parametrize("mapping", ["COMPUTE", "GEOMETRY"])
def test_the_gpus_passes_are_measured_where_that_is_asked_for(mapping):
    with native.SnowSimulation(pixel_size=0.1, engine="GL", mapping=mapping) as sim:
        stepped(sim)
        costs = sim.pass_costs()
        assert {"triangles", "occlusion", "deposit", "stability", "statistics"} <= set(costs)
        assert costs["triangles"]["calls"] == 2
        assert all(cost["gpu_seconds"] > 0 for cost in costs.values())
        assert sim.pass_costs() == {}, "reported once"
        sim.measure_passes(False)
        sim.step({}, 0.01)
        assert sim.pass_costs() == {}


@pytest.mark.parametrize("repose", [STAYS, math.radians(65.0)])
def test_heights_leave_the_card_only_if_lying_snow_moves(repose):
    with native.SnowSimulation(pixel_size=0.1, repose=repose, engine="GL") as sim:
        stepped(sim)
        assert ("movement" in sim.pass_costs()) == (repose < STAYS)


def test_the_processors_passes_have_no_gpu_time():
    with native.SnowSimulation(pixel_size=0.1, engine="CPU") as sim:
        stepped(sim)
        assert sim.pass_costs() == {}
