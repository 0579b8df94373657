# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves and boughs let snow go with a half-life; it lands, and none is lost."""

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import restore, save
from child import in_child
from snow_meshes import grid

FRAME = 1.0 / 24.0
DOWN = (0.0, 0.0, -1.0)
CARDS = 20
CARD = 0.12


def canopy(slope=0.2):
    """400 cards of 12 cm at 2 to 4 m over the ground, none over another, each with its own chart."""
    random = np.random.default_rng(7)
    positions, triangles, uv = [], [], []
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) * CARD
    for i in range(CARDS * CARDS):
        column, row = i % CARDS, i // CARDS
        middle = np.array([(column + 0.5) * 0.15, (row + 0.5) * 0.15, random.uniform(2.0, 4.0)])
        lean = random.uniform(-slope, slope, 2)
        z = corners @ lean
        triangles += [(4 * i, 4 * i + 1, 4 * i + 2), (4 * i, 4 * i + 2, 4 * i + 3)]
        positions += [middle + (x, y, h) for (x, y), h in zip(corners, z)]
        place = (corners / CARD * 0.8 + 0.5 + (column, row)) / CARDS
        uv += [place[[0, 1, 2]], place[[0, 2, 3]]]
    return np.float32(positions), np.array(triangles, np.int32), np.float32(uv)


class Wood:
    """Cards under snow over a level ground, which is 5 m wide."""

    def __init__(self, half_life=2.0, slope=0.2, **settings):
        self.leaves, self.ground = canopy(slope), grid(5.0, 5.0)
        self.ground[0][:, :2] += 1.5
        self.sim = native.SnowSimulation(pixel_size=0.02, engine="CPU", **settings)
        self.sim.add_object("leaves", *self.leaves[1:], resolution=360)
        if half_life is not None:
            self.sim.set_shed_half_life("leaves", half_life)
        self.sim.add_object("ground", *self.ground[1:], resolution=256)
        self.steps = 0

    def run(self, steps, depth=0.05):
        for _ in range(steps):
            poses = {} if self.steps else {"leaves": self.leaves[0], "ground": self.ground[0]}
            self.sim.step(poses, 0.0 if self.steps else depth, DOWN, FRAME)
            self.steps += 1

    def volume(self, name):
        return float((abs(self.sim.height(name).astype(float)) * self.sim.texel_area(name)).sum())

    def balance(self):
        statistics = self.sim.statistics()
        total = statistics["total"]
        held = self.volume("leaves") + self.volume("ground")
        lost = total["deposited_volume"] + total["landed_volume"] - held - total["slid_volume"]
        assert abs(lost) < 1e-6 * total["deposited_volume"]
        elsewhere = sum(statistics[name] for name in ("air_volume", "floor_volume", "left_volume"))
        astray = total["slid_volume"] - total["landed_volume"] - elsewhere
        assert abs(astray) < 1e-6 * total["deposited_volume"]
        return total


@pytest.mark.parametrize("half_life", [0.25, 1.0])
def test_half_of_the_snow_lets_go_within_the_half_life(half_life):
    # Without landing none falls from card to card.
    wood = Wood(half_life, landing=False)
    wood.run(1)
    # Repose has trimmed the edges of the cards.
    start = wood.volume("leaves")
    wood.run(round(half_life / FRAME))
    # 400 cards in cubes that are mostly smaller: a standard deviation of less than 2.5 %.
    assert wood.volume("leaves") / start == pytest.approx(0.5, abs=0.05)
    wood.run(round(half_life / FRAME))
    assert wood.volume("leaves") / start == pytest.approx(0.25, abs=0.05)


def test_the_snow_lands_on_the_ground_below():
    wood = Wood(0.06)
    wood.run(1)
    before, fallen = wood.volume("leaves"), wood.volume("ground") + wood.sim.statistics()["air_volume"]
    wood.run(45)
    wood.balance()
    assert wood.volume("leaves") < 1e-3 * before
    assert wood.volume("ground") - fallen == pytest.approx(before, rel=0.02)


def test_level_leaves_shed_too():
    wood = Wood(0.06, slope=0.0)
    wood.run(1)
    before = wood.volume("leaves")
    wood.run(45)
    wood.balance()
    assert wood.volume("leaves") < 1e-3 * before


def test_a_lump_lets_go_as_a_whole():
    wood = Wood(2.0)
    wood.run(1)
    before = wood.sim.height("leaves")
    wood.run(1)
    after = wood.sim.height("leaves")
    gone = (before > 0.01) & (after == 0.0)
    assert gone.sum() > 50
    # Texels of 7 mm in cubes of 6 or 12 cm; alone, 1.4 % of the texels would let go.
    beside = gone[:, 1:-1] & (gone[:, 2:] | gone[:, :-2])
    assert beside.sum() > 0.8 * gone.sum()


def test_without_a_half_life_nothing_changes():
    plain, off = Wood(None), Wood(0.0)
    for wood in (plain, off):
        wood.run(6)
    assert plain.sim.height("leaves").tobytes() == off.sim.height("leaves").tobytes()
    assert plain.sim.statistics() == off.sim.statistics()


def test_shedding_resumes_byte_for_byte(tmp_path):
    whole, first, second = Wood(0.5), Wood(0.5), Wood(0.5)
    whole.run(14)
    first.run(6)
    save(first.sim, tmp_path / "state")
    restore(second.sim, tmp_path / "state")
    second.sim.step({"leaves": second.leaves[0], "ground": second.ground[0]}, 0.0, DOWN, FRAME)
    second.steps = 7
    second.run(7)
    for name in ("leaves", "ground"):
        assert second.sim.height(name).tobytes() == whole.sim.height(name).tobytes()
    assert second.sim.statistics() == whole.sim.statistics()


def test_the_number_of_threads_changes_no_byte():
    program = """
import hashlib, os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import test_snow_shedding as t
wood = t.Wood(0.5)
wood.run(16)
print(hashlib.sha256(wood.sim.height("leaves").tobytes() + wood.sim.height("ground").tobytes()).hexdigest())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))


def test_a_wrong_half_life_is_refused_with_a_reason():
    with pytest.raises(ValueError, match="shed_half_life must be 0 seconds or more"):
        Wood(-1.0)
