# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow that stays on moving objects: bending meshes, extreme wind behind a post, the balance of sliding."""

import numpy as np
import pytest
from snow_fall import new_simulation
from snow_meshes import STAYS, box, chart_of_box, grid, rotated, sphere, wind
from snow_rays import outline_area

DOWN = (0.0, 0.0, -1.0)


def bent(positions, degrees):
    """Turned upwards about y = 0 by an angle that grows with y."""
    turn = np.radians(degrees) * np.clip(positions[:, 1], 0.0, 1.0)
    limb = positions.copy()
    limb[:, 1] = np.where(positions[:, 1] > 0.0, positions[:, 1] * np.cos(turn), positions[:, 1])
    limb[:, 2] = np.where(positions[:, 1] > 0.0, positions[:, 1] * np.sin(turn), 0.0)
    return limb


def test_a_bending_limb_keeps_its_snow_and_gathers_by_its_new_outline():
    positions, triangles, uv = grid(0.4, 2.0, 16)
    with new_simulation(repose=STAYS, pixel_size=0.005, max_depth=1e6) as sim:
        sim.add_object("limb", triangles, uv, resolution=64)
        sim.step({"limb": positions}, 0.05, DOWN, 0.0)
        before = sim.height("limb")
        for degrees in (6.0, 14.0, 22.0):
            sim.step({"limb": bent(positions, degrees)}, 0.0)
        assert np.array_equal(sim.height("limb"), before)
        sim.step({}, 0.05, DOWN, 0.0)
        gained = ((sim.height("limb") - before) * sim.texel_area("limb").astype(np.float64)).sum()
    assert gained == pytest.approx(0.05 * outline_area(bent(positions, 22.0)[triangles], DOWN, 400), rel=0.01)


def test_a_ball_that_turns_over_sheds_and_the_books_balance():
    positions, triangles, uv = sphere()
    with new_simulation(repose=STAYS, pixel_size=0.01, max_depth=0.3, slide_half_life=0.5) as sim:
        sim.add_object("ball", triangles, uv, resolution=128)
        for _ in range(12):
            sim.step({"ball": positions}, 0.01)
        loaded = sim.statistics()["held_volume"]
        held = []
        for frame in range(1, 25):
            sim.step({"ball": rotated(positions, "x", 7.5 * frame)}, 0.0)
            held.append(sim.statistics()["held_volume"])
        for _ in range(10):
            sim.step({}, 0.0, DOWN, 0.5)
        total = sim.statistics()["total"]
    assert held[11] > 0.5 * loaded  # on its side
    assert all(b <= a * (1.0 + 1e-6) for a, b in zip(held, held[1:]))
    assert total["held_volume"] < 0.01 * loaded
    assert total["held_volume"] + total["slid_volume"] == pytest.approx(total["deposited_volume"], rel=1e-5)


@pytest.mark.parametrize("angle, pixel_size, top", [(80, 0.006, 0.2), (89, 0.0015, 0.02)])
def test_extreme_wind_packs_the_windward_wall_and_leaves_a_clean_shadow(angle, pixel_size, top):
    ground, post = grid(2.0, 3.0), box(0.2, top)
    standing = post[0] + np.float32((0.0, -1.0, 0.0))
    resolution = 256
    with new_simulation(repose=STAYS, pixel_size=pixel_size, max_depth=1e6) as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=resolution)
        sim.add_object("post", post[1], post[2], resolution=128)
        for step in range(8):
            sim.step({"ground": ground[0], "post": standing} if step == 0 else {}, 0.01, wind(angle), 0.0)
        height, walls = sim.height("ground"), sim.height("post")
    tangent = np.tan(np.radians(angle))
    places = ((np.arange(resolution) + 0.5) / resolution - 0.02) / 0.96 - 0.5
    x, y = np.meshgrid(2.0 * places, 3.0 * places)
    texel = 3.0 / 0.96 / resolution
    # How deep inside the shadow, in footprints of a pixel on the ground.
    across = (0.1 - abs(x) - 0.5 * texel) / pixel_size
    along = (np.minimum(y + 1.1, -0.9 + top * tangent - y) - 0.5 * texel) / (
        pixel_size / np.cos(np.radians(angle))
    )
    assert np.minimum(across, along).max() > 3.0
    assert np.minimum(across, along)[height > 0.0].max() <= 0.5
    beside = (abs(x) > 0.2) & (abs(x) < 0.8) & (abs(y) < 1.2)
    assert height[beside].mean() == pytest.approx(0.08, rel=0.02)
    assert chart_of_box(walls, 2).mean() == pytest.approx(0.08 * tangent, rel=0.05)
    assert chart_of_box(walls, 3).max() == 0.0
