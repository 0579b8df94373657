# SPDX-License-Identifier: GPL-3.0-or-later
"""Boughs under snow (snowbough.bending): beams against closed forms, loads against literal maps, without Blender."""

import numpy as np
import pytest
from snowbough.bending import load, small_bake
from snowbough.bending.cantilevers import GRAVITY, Cantilevers

DOWN = (0.0, 0.0, -1.0)
WOOD = 4e9
UNBREAKABLE = 1e15
RADIUS = 0.01
SECOND_MOMENT = np.pi * RADIUS**4 / 4.0


def beam(bones, radius=RADIUS, length=1.0, along=(1.0, 0.0, 0.0)):
    """A cantilever of one limb that begins at the origin."""
    points = np.linspace(0.0, length, bones + 1)[:, None] * np.array(along)
    radii = np.full(bones, radius)
    return Cantilevers(points[:-1], points[1:], np.arange(bones) - 1, radii, radii, np.zeros(bones, int))


def middles(chain):
    return (chain.heads + chain.tails) / 2.0


def tip(chain, bent):
    return chain.bent_tails(bent.vectors[-1])[-1]


@pytest.mark.parametrize(("bones", "above"), [(4, 0.0627), (8, 0.0157), (16, 0.0040), (32, 0.0010)])
def test_an_even_small_load_sags_as_in_the_tables(bones, above):
    chain, mass = beam(bones), 0.05
    bent = chain.bend(np.full(bones, mass / bones), middles(chain), DOWN, WOOD, UNBREAKABLE)
    exact = mass * GRAVITY / (8.0 * WOOD * SECOND_MOMENT)
    assert -tip(chain, bent)[2] / exact - 1.0 == pytest.approx(above, abs=4e-4)


@pytest.mark.parametrize(
    ("load_number", "sag", "shortening"),
    [(1, 0.30172, 0.05643), (2, 0.49346, 0.16064), (5, 0.71379, 0.38763), (10, 0.81061, 0.55500)],
)
def test_a_large_load_at_the_tip_gives_the_elastica(load_number, sag, shortening):
    chain = beam(24)
    masses = np.zeros(24)
    masses[-1] = load_number * WOOD * SECOND_MOMENT / GRAVITY
    bent = chain.bend(masses, chain.tails, DOWN, WOOD, UNBREAKABLE)
    assert bent.error < 1e-4
    x, _y, z = tip(chain, bent)
    assert -z == pytest.approx(sag, rel=1.5e-3)
    assert 1.0 - x == pytest.approx(shortening, rel=3e-3)


def test_a_taper_bends_as_its_mean_compliance():
    """One bone from 1 to 2 cm: half its length times the mean of 1 / r^4, which is 7 / 24 of that of the thin end."""
    chain = Cantilevers([(0, 0, 0)], [(1, 0, 0)], [-1], [0.02], [0.01], [0])
    bent = chain.bend(np.array([0.01]), chain.tails, DOWN, WOOD, UNBREAKABLE)
    assert bent.vectors[-1][0] == pytest.approx(
        (0.0, 0.01 * GRAVITY * 0.5 * (7.0 / 24.0) / (WOOD * SECOND_MOMENT), 0.0), rel=1e-3
    )


def test_limbs_to_both_sides_bend_alike_and_leave_the_trunk_upright():
    heads = [(0, 0, 0), (0, 0, 1), (0, 0, 1), (0.5, 0, 1), (-0.5, 0, 1)]
    tails = [(0, 0, 1), (0.5, 0, 1), (-0.5, 0, 1), (1, 0, 1), (-1, 0, 1)]
    radii = np.array([0.02, 0.005, 0.005, 0.005, 0.005])
    tree = Cantilevers(heads, tails, [-1, 0, 0, 1, 2], radii, radii, [0, 1, 2, 1, 2])
    bent = tree.bend(np.array([0.0, 0.1, 0.1, 0.1, 0.1]), middles(tree), DOWN, WOOD, UNBREAKABLE)
    _trunk, near_right, near_left, right, left = tree.bent_tails(bent.vectors[-1])
    assert right[2] < near_right[2] < 0.99
    for one, other in ((near_right, near_left), (right, left)):
        assert one * (-1.0, 1.0, 1.0) == pytest.approx(other, abs=1e-8)
    assert np.abs(bent.vectors[-1][0]).max() < 1e-12


def test_limbs_do_not_twist():
    """A weight at the end of a branch bends its limb down, and would turn it about its own axis."""
    heads, tails = [(0, 0, 0), (1, 0, 0)], [(1, 0, 0), (1, 0.5, 0)]
    tree = Cantilevers(heads, tails, [-1, 0], np.full(2, RADIUS), np.full(2, RADIUS), [0, 1])
    bent = tree.bend(np.array([0.0, 0.1]), tree.tails, DOWN, WOOD, UNBREAKABLE)
    twist, sag, _turn = bent.vectors[-1][0]
    assert sag > 1e-3
    assert abs(twist) < 0.01 * sag


def test_gravity_may_point_anywhere():
    upright = beam(8, along=(0.0, 0.0, 1.0))
    masses = np.full(8, 0.02)
    along_x = upright.bend(masses, middles(upright), (1.0, 0.0, 0.0), WOOD, UNBREAKABLE)
    level = beam(8)
    downwards = level.bend(masses, middles(level), DOWN, WOOD, UNBREAKABLE)
    assert tip(upright, along_x)[0] == pytest.approx(-tip(level, downwards)[2], abs=1e-12)


@pytest.mark.parametrize(("radius", "degrees"), [(0.002, 3.0), (0.001, 43.0), (0.0007, 79.0)])
def test_thin_twigs_hang_down_further(radius, degrees):
    """Twelve bones, 30 cm, 20 g along the twig."""
    twig = beam(12, radius, 0.3)
    bent = twig.bend(np.full(12, 0.02 / 12), middles(twig), DOWN, WOOD, 60e6)
    turns, _heads = twig.pose(bent.vectors[-1])
    assert np.degrees(np.arccos(turns[-1, 0, 0])) == pytest.approx(degrees, abs=1.0)


def test_a_joint_takes_no_more_moment_than_its_strength():
    """40 N m at the root of 1 cm; at 20 MPa it takes 15.7 N m and turns by that times half a bone's compliance."""
    chain = beam(4)
    masses = np.zeros(4)
    masses[-1] = 40.0 / GRAVITY
    bent = chain.bend(masses, chain.tails, DOWN, 400e9, 20e6)
    most = 20e6 * np.pi * RADIUS**3 / 4.0
    assert bent.vectors[-1][0, 1] == pytest.approx(most * 0.125 / (400e9 * SECOND_MOMENT), rel=1e-3)
    assert bent.stress == pytest.approx([2.546, 1.91, 1.273, 0.637], rel=0.01)


def test_an_overloaded_tree_of_hairs_converges():
    """A trunk of 20 bones that is far too thin, with limbs to both sides, heavier on one."""
    trunk = [((0, 0, 0.2 * k), (0, 0, 0.2 * k + 0.2)) for k in range(20)]
    limbs = [((0, 0, 0.2 * k), (s / 2, 0, 0.2 * k)) for k in range(20) for s in (1, -1)]
    tips = [((tail[0], 0, tail[2]), (2 * tail[0], 0, tail[2])) for _, tail in limbs]
    heads, tails = zip(*trunk, *limbs, *tips)
    parents = [*range(-1, 19), *(k // 2 for k in range(40)), *range(20, 60)]
    radii = np.array([0.004] * 20 + [0.002] * 40 + [0.001] * 40)
    tree = Cantilevers(heads, tails, parents, radii, radii, [0] * 20 + [*range(1, 41)] * 2)
    masses = np.where(tree.tails[:, 0] > 0.0, 0.10, 0.08)
    for strength, error in ((40e6, 1e-3), (UNBREAKABLE, 5e-3)):
        bent = tree.bend(masses, middles(tree), DOWN, WOOD, strength)
        assert bent.error < error
        assert tree.bent_tails(bent.vectors[-1])[19, 2] < -2.0, "the top of the trunk, 4 m long, hangs down"


def test_radii_of_exports_are_raised_to_what_a_limb_needs():
    """A limb of 3 m in two bones, and a twig of 0.1 m."""
    heads, tails = load.plausible_radii(
        np.array([0.05, 0.001, 1e-4]),
        np.array([0.001, 1e-4, 1e-4]),
        np.array([1.5, 1.5, 0.1]),
        np.array([0, 0, 1]),
    )
    assert heads == pytest.approx([0.05, 0.01, 0.001])
    assert tails == pytest.approx([0.01, 0.001, 0.001])


def test_a_part_of_the_load_bends_as_that_load_alone():
    chain = beam(12, 0.004)
    masses = np.full(12, 0.05)
    both = chain.bend(masses, middles(chain), DOWN, WOOD, UNBREAKABLE, shares=(0.4, 1.0))
    alone = chain.bend(0.4 * masses, middles(chain), DOWN, WOOD, UNBREAKABLE)
    assert both.vectors.shape == (2, 12, 3)
    assert both.vectors[0] == pytest.approx(alone.vectors[0], abs=2e-4 * np.abs(alone.vectors).max())
    assert tip(chain, both)[2] < tip(chain, alone)[2] < -0.05


def test_no_load_bends_nothing():
    chain = beam(4)
    bent = chain.bend(np.full(4, 0.1), middles(chain), DOWN, WOOD, UNBREAKABLE, shares=(0.0, 1.0))
    assert not bent.vectors[0].any() and bent.vectors[1].any()


def test_equal_loads_give_equal_bits_wherever_they_lie_in_memory():
    chain, masses, seen, kept = beam(29, 0.003), np.full(29, 0.01), set(), []
    for size in range(1, 200, 7):
        kept.append(np.empty(size, np.uint8))
        bent = chain.bend(masses.copy(), middles(chain), DOWN, WOOD, UNBREAKABLE)
        seen.add(bent.vectors.tobytes())
    assert len(seen) == 1


def test_local_rotations_of_a_chain_rebuild_its_pose():
    chain = beam(6, 0.003)
    bent = chain.bend(np.full(6, 0.05), middles(chain), DOWN, WOOD, UNBREAKABLE)
    # Bones along X whose own Y axis is along the bone, as in Blender.
    axes = np.tile(np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], float), (6, 1, 1))
    local = chain.local_rotations(bent.vectors[-1], axes)
    turn = np.eye(3)
    turns, _heads = chain.pose(bent.vectors[-1])
    for bone in range(6):
        turn = turn @ axes[bone] @ local[bone] @ axes[bone].T
        assert turn == pytest.approx(turns[bone], abs=1e-12)


def square_mesh(heights, bones, weights, size=2.0):
    """A square of two triangles over a map of 64 texels."""
    native = pytest.importorskip("snowbough_native")
    h = size / 2
    positions = np.array([(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], np.float32)
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)[triangles]
    table = native.texel_table(triangles, uv, 64)
    return load.SnowyMesh(heights, table, triangles, positions, np.array(bones), np.array(weights, float))


def test_a_bone_carries_the_snow_on_its_vertices():
    mesh = square_mesh(np.full((64, 64), 0.1, np.float32), [[0]] * 4, [[1.0]] * 4)
    volumes, centres = load.held_snow([mesh], 2)
    assert volumes == pytest.approx([0.4, 0.0], rel=1e-5)
    assert centres[0] == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_snow_on_the_back_weighs_as_much():
    mesh = square_mesh(np.full((64, 64), -0.1, np.float32), [[0]] * 4, [[1.0]] * 4)
    assert load.held_snow([mesh], 1)[0] == pytest.approx([0.4], rel=1e-5)


def test_snow_is_shared_by_weights_and_its_place():
    """Bone 0 has the left side, bone 1 the right side; snow lies on the right half only."""
    heights = np.zeros((64, 64), np.float32)
    heights[:, 32:] = 0.1
    mesh = square_mesh(heights, [[0, 1]] * 4, [[1, 0], [0, 1], [0, 1], [1, 0]])
    volumes, centres = load.held_snow([mesh], 2)
    assert volumes == pytest.approx([0.05, 0.15], rel=1e-4)
    # Densities (1 - x) / 2 and (1 + x) / 2 over x from 0 to 1.
    assert centres[:, 0] == pytest.approx([1 / 3, 5 / 9], rel=1e-3)


def test_vertices_without_weights_carry_nothing():
    mesh = square_mesh(np.full((64, 64), 0.1, np.float32), [[0]] * 4, [[0.0], [1.0], [1.0], [0.0]])
    assert load.held_snow([mesh], 1)[0] == pytest.approx([0.2], rel=1e-5)


def test_a_crown_counts_once_from_above_and_closes_small_gaps():
    def leaf(x, y, z, size):
        corners = [(x, y, z), (x + size, y, z), (x + size, y + size, z), (x, y + size, z)]
        return np.array([(0, 1, 2), (0, 2, 3)]), np.array(corners)

    assert load.crown_area([]) == 0.0
    assert load.crown_area([leaf(0, 0, 1, 1.0)]) == pytest.approx(1.0)
    assert load.crown_area([leaf(0, 0, 1, 1.0), leaf(0.5, 0, 2, 0.5)]) == pytest.approx(1.0)
    needles = [leaf(0.1 * i + 0.04, 0.1 * j + 0.04, 0.0, 0.01) for i in range(10) for j in range(10)]
    assert load.crown_area(needles) == pytest.approx(1.0)


def test_interception_grows_with_the_snow_up_to_what_a_crown_holds():
    assert load.intercepted(4.0, 0.10, 100.0) == pytest.approx(24.0)
    assert load.intercepted(4.0, 1.00, 200.0) == pytest.approx(60.0)


def test_only_what_stands_above_or_to_windward_shelters():
    low, high = np.array([0.0, 0.0, 0.0]), np.array([1.0, 1.0, 2.0])

    def shelters(x, z, angle):
        positions = np.array([(x, 0, z), (x + 0.1, 0, z), (x, 0.1, z)], float)
        return small_bake.shelters(np.array([[0, 1, 2]]), positions, low, high, angle).tolist() == [True]

    assert shelters(0.5, 3.0, 0.0) and not shelters(0.5, -0.1, 0.0)
    assert not shelters(1.5, 3.0, 0.0) and shelters(1.5, 3.0, np.radians(20.0))
    assert not shelters(5.0, 3.0, np.radians(20.0))


def keys(frame_start, totals):
    return np.array(load.load_keys(frame_start, totals))


def test_keys_follow_the_depth():
    even = keys(1, np.linspace(0.0, 0.2, 81))
    assert even == pytest.approx(np.array([(1 + 10 * k, k / 8) for k in range(9)]))


def test_no_key_lies_in_a_pause_of_the_snowfall():
    paused = keys(1, [0.0] * 50 + [0.05] * 40 + [0.1] * 10)
    assert paused == pytest.approx(
        np.array(
            [
                (50, 0),
                *((50 + k / 4, k / 8) for k in range(1, 5)),
                *((89 + k / 4, k / 8) for k in range(5, 9)),
            ]
        )
    )


def test_snow_before_the_shot_loads_its_first_frame():
    assert keys(10, [0.1, 0.15, 0.2])[0] == pytest.approx((10, 0.5))
    assert load.load_keys(7, [0.1]) == [(7, 1.0)]
    assert load.load_keys(7, [0.1, 0.1]) == [(8, 1.0)]
