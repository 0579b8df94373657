# SPDX-License-Identifier: GPL-3.0-or-later
"""Sand from a point source makes a round cone at the angle of repose, whatever the layout of the map."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from child import in_child
from snow_meshes import grid
from snow_rays import texel_points

SIZE, RESOLUTION, ANGLE = 1.6, 192, 34.0
DIRECTIONS = np.arange(32) * math.pi / 16


def straight():
    return grid(SIZE, SIZE, 8)


def turned():
    positions, triangles, uv = grid(SIZE, SIZE, 8)
    c, s = 0.72 * math.cos(0.5), 0.72 * math.sin(0.5)
    return positions, triangles, ((uv - 0.5) @ np.array([[c, s], [-s, c]]) + 0.5).astype(np.float32)


def stretched():
    positions, triangles, uv = grid(SIZE, SIZE, 8)
    return positions, triangles, ((uv - 0.5) * [1.0, 0.5] + 0.5).astype(np.float32)


def four_charts():
    """Charts that meet in the middle, on distant places of the map."""
    parts = [grid(SIZE / 2, SIZE / 2, 4, margin=0.04) for _ in range(4)]
    positions, triangles, uv = [], [], []
    for i, (points, faces, corners) in enumerate(parts):
        column, row = i % 2, i // 2
        triangles.append(faces + sum(len(p) for p in positions))
        positions.append(points + np.float32([(column - 0.5) * SIZE / 2, (row - 0.5) * SIZE / 2, 0]))
        uv.append((corners + [1 - column, 1 - row]) / 2)
    return (
        np.concatenate(positions),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(uv).astype(np.float32),
    )


def funnel(radius=0.05, sides=24):
    """A roof over the ground with a round hole in its middle."""
    turn = np.arange(sides) * 2 * math.pi / sides
    rings = [np.stack([r * np.cos(turn), r * np.sin(turn), np.full(sides, 1.0)], 1) for r in (radius, 2.0)]
    a, b = np.arange(sides), (np.arange(sides) + 1) % sides
    faces = np.concatenate([np.stack([a, a + sides, b + sides], 1), np.stack([a, b + sides, b], 1)])
    return np.concatenate(rings).astype(np.float32), faces.astype(np.int32)


def poured(layout, granular, resolution=RESOLUTION, steps=40, rest=8):
    """(distances, directions, heights) of the texels under a heap, and the simulation."""
    positions, triangles, uv = layout()
    hole, faces = funnel()
    sim = native.SnowSimulation(
        pixel_size=0.01, repose=math.radians(ANGLE), max_depth=10.0, granular=granular
    )
    sim.add_object("ground", triangles, uv, resolution=resolution)
    sim.add_object("funnel", faces, np.zeros((len(faces), 3, 2), np.float32), receive=False)
    for step in range(steps):
        sim.step({"ground": positions, "funnel": hole} if step == 0 else {}, 0.06)
    for _ in range(rest):
        sim.step({}, 0.0, dt=0.5)
    return sim


def cone(sim, layout, resolution=RESOLUTION):
    """(slopes in degrees by direction, radii at half of the height), about the heap's middle."""
    positions, triangles, uv = layout()
    points, _, places, _ = texel_points(native, positions, triangles, uv, resolution)
    height = sim.height("ground").ravel()[places]
    middle = np.average(points[:, :2], axis=0, weights=height * (height > 0.2 * height.max()))
    assert np.abs(middle).max() < 0.01
    x, y = (points[:, :2] - middle).T
    distance, azimuth = np.hypot(x, y), np.arctan2(y, x)
    slopes, radii = [], []
    for direction in DIRECTIONS:
        beside = np.abs((azimuth - direction + math.pi) % (2 * math.pi) - math.pi)
        flank = (beside < 0.08) & (height > 0.2 * height.max()) & (height < 0.8 * height.max())
        slope, top = np.polyfit(distance[flank], height[flank], 1)
        slopes.append(math.degrees(math.atan(-slope)))
        radii.append((0.5 * height.max() - top) / slope)
    return np.array(slopes), np.array(radii)


CASES = [(layout, RESOLUTION) for layout in (straight, turned, stretched, four_charts)]
CASES += [(layout, 512) for layout in (straight, turned, four_charts)] + [(stretched, 768)]


@pytest.mark.parametrize("layout, resolution", CASES)
def test_sand_makes_a_round_cone_at_its_angle_of_repose(layout, resolution):
    with poured(layout, True, resolution) as sim:
        slopes, radii = cone(sim, layout, resolution)
        total = sim.statistics()["total"]
    assert np.abs(slopes - ANGLE).max() < 1.0
    assert radii.max() / radii.min() < 1.03
    assert total["held_volume"] == pytest.approx(total["deposited_volume"], rel=1e-6)


def test_a_heap_of_sand_goes_on_from_a_checkpoint_to_the_bit(tmp_path):
    with poured(straight, True, 128, steps=6, rest=0) as whole:
        save(whole, tmp_path / "state")
        with poured(straight, True, 128, steps=1, rest=0) as later:
            restore(later, tmp_path / "state")
            for sim in (whole, later):
                for _ in range(4):
                    sim.step({}, 0.06)
            assert later.height("ground").tobytes() == whole.height("ground").tobytes()
            assert later.statistics()["total"] == whole.statistics()["total"]


def test_the_number_of_threads_changes_no_byte():
    program = """
import hashlib, os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
from test_snow_granular import poured, straight
with poured(straight, True, 512, steps=6, rest=0) as sim:
    print(hashlib.sha256(sim.height("ground").tobytes()).hexdigest())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))


def test_links_in_eight_directions_alone_make_a_pyramid():
    with poured(straight, False) as sim:
        _, radii = cone(sim, straight)
    assert radii.max() / radii.min() > 1.05
