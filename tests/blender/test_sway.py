# SPDX-License-Identifier: GPL-3.0-or-later
"""The sway operator: loops that close, physics that order limbs, small files, quick."""

import math
import os

import bpy
import numpy as np
import pytest
from exported_tree import import_tree
from synthetic_tree import build_synthetic, evaluated_vertices, synthetic_bones


def _activate(obj):
    bpy.context.view_layer.objects.active = obj


def _positions(bark, frame, subframe=0.0):
    bpy.context.scene.frame_set(frame, subframe=subframe)
    return evaluated_vertices(bark)


@pytest.fixture
def swaying(addon):
    rig, bark = build_synthetic(addon)
    _activate(rig)
    assert bpy.ops.snowbough.add_sway(loop_frames=96, seed=3) == {"FINISHED"}
    return rig, bark


def test_the_loop_closes_exactly(swaying):
    _rig, bark = swaying
    first = _positions(bark, 1)
    assert np.abs(_positions(bark, 97) - first).max() < 1e-6
    assert np.abs(_positions(bark, 1 + 96 * 5) - first).max() < 1e-6
    assert np.abs(_positions(bark, 49) - first).max() > 1e-3


def test_the_motion_runs_through_the_loops_seam_without_a_kink(swaying):
    _rig, bark = swaying
    step = 0.25
    before = (_positions(bark, 97) - _positions(bark, 96, 1 - step)) / step
    after = (_positions(bark, 97, step) - _positions(bark, 97)) / step
    everywhere = max(
        np.abs(_positions(bark, f, step) - _positions(bark, f)).max() / step for f in range(1, 97, 5)
    )
    assert np.abs(after - before).max() < 0.15 * everywhere


def test_channels_have_about_sixteen_keys_and_a_cycles_modifier(swaying, addon):
    rig, _bark = swaying
    curves = addon("base.compat").curves_of(rig)
    assert len(curves) == 2 * len(rig.data.bones)
    for curve in curves:
        assert len(curve.keyframe_points) == 17
        assert [modifier.type for modifier in curve.modifiers] == ["CYCLES"]
        assert curve.keyframe_points[0].co[1] == curve.keyframe_points[16].co[1]
        assert curve.keyframe_points[0].interpolation == "BEZIER"


def test_equal_settings_give_equal_keys_and_another_seed_others(addon):
    rig, _bark = build_synthetic(addon)
    _activate(rig)

    def keys(**settings):
        bpy.ops.snowbough.add_sway(**settings)
        return [tuple(p.co) for curve in addon("base.compat").curves_of(rig) for p in curve.keyframe_points]

    assert keys(seed=1) == keys(seed=1)
    assert keys(seed=1) != keys(seed=2)


def test_a_second_sway_replaces_the_first_and_leaves_no_orphan(addon):
    rig, _bark = build_synthetic(addon)
    _activate(rig)
    bpy.ops.snowbough.add_sway()
    bpy.ops.snowbough.add_sway(strength=2.0)
    assert len(bpy.data.actions) == 1


def test_an_action_made_by_hand_is_kept(addon):
    rig, _bark = build_synthetic(addon)
    rig.keyframe_insert("location", frame=1)
    by_hand = rig.animation_data.action.name
    _activate(rig)
    bpy.ops.snowbough.add_sway()
    assert by_hand in bpy.data.actions


def test_strength_zero_stands_still(addon):
    rig, bark = build_synthetic(addon)
    rest = evaluated_vertices(bark)
    _activate(rig)
    bpy.ops.snowbough.add_sway(strength=0.0)
    assert np.abs(_positions(bark, 30) - rest).max() < 1e-6


@pytest.mark.parametrize(
    "bearing, turn, axis, sign",
    [(0.0, 0.0, 1, 1), (math.pi / 2, 0.0, 0, 1), (math.pi, 0.0, 1, -1), (0.0, math.pi / 2, 1, 1)],
)
def test_the_tree_leans_to_where_the_wind_blows_also_if_its_armature_is_turned(
    addon, bearing, turn, axis, sign
):
    rig, bark = build_synthetic(addon, synthetic_bones(branches=4, twigs=0))
    rig.rotation_euler = (0, 0, turn)
    rest = evaluated_vertices(bark)
    _activate(rig)
    bpy.ops.snowbough.add_sway(bearing=bearing, gusts=0.0, strength=3.0)
    top = np.argsort(rest[:, 2])[-4:]
    mean = np.mean([(_positions(bark, f)[top] - rest[top]).mean(axis=0) for f in range(1, 97, 6)], axis=0)
    assert sign * mean[axis] > 0
    assert abs(mean[1 - axis]) < 0.5 * abs(mean[axis])


def test_long_thin_limbs_swing_slower_and_wider(addon):
    wind = addon("tree.wind")
    length, radius = np.array([0.5, 1.0, 2.0, 2.0]), np.array([0.02, 0.02, 0.02, 0.04])
    frequency = wind.natural_frequencies(length, radius)
    assert frequency[0] > frequency[1] > frequency[2] and frequency[3] > frequency[2]
    angle = wind.tip_angles(length, radius, 5.0)
    assert angle[0] < angle[1] < angle[2] and angle[3] < angle[2]
    # First mode of a uniform cantilever by hand: 0.5596 * r / (2 L^2) * 2788.9 m/s for r = 2 cm, L = 1 m.
    assert math.isclose(frequency[1], 15.606, rel_tol=1e-3)


def _upright_limbs(wind, limbs_a_level, levels=3):
    """Chains of single upright bones, `limbs_a_level` on each level, and their sway in a wind along X.

    Returns (chains, sway) with sway(**settings) -> (downwind, crosswind), each (limbs, keys): upright bones
    turn about Y where the wind pushes them along X, and about X where they swing across it.
    """
    count = limbs_a_level * levels
    parents = [bone - limbs_a_level if bone >= limbs_a_level else -1 for bone in range(count)]
    lengths, radii = np.full(count, 1.0), np.full(count, 0.02)
    chains = wind.find_chains(parents, [False] * count, lengths, radii)
    shares = wind.bone_shares(chains, lengths, radii)
    up = np.tile((0.0, 0.0, 1.0), (count, 1))

    def sway(roots=None, strength=1.0, gusts=0.0, keys=16, seconds=4.0):
        roots = np.zeros((count, 3)) if roots is None else roots
        along = np.array((1.0, 0.0, 0.0))
        vectors = wind.sway_vectors(
            chains, shares, lengths, up, roots, along, strength, gusts, 5, keys, seconds
        )
        return vectors[:, :, 1], vectors[:, :, 0]

    return chains, sway


def test_each_level_swings_a_third_of_a_cycle_after_the_one_before(addon):
    chains, sway = _upright_limbs(addon("tree.wind"), limbs_a_level=400)
    downwind, _crosswind = sway()
    spectrum = np.fft.rfft(downwind, axis=1)
    cycle = 1 + np.abs(spectrum[:, 1:]).argmax(axis=1)
    assert len(set(cycle)) == 1, "limbs that are alike swing alike"
    swing = spectrum[:, cycle[0]] / np.abs(spectrum[:, cycle[0]])
    phase = [np.angle(swing[chains.limb_level == level].mean()) / (2 * np.pi) for level in range(3)]
    for before, after in ((0, 1), (1, 2)):
        assert abs((phase[before] - phase[after]) % 1.0 - 1 / 3) < 0.03


def test_without_gusts_each_limb_swings_evenly_and_gusts_change_how_far(addon):
    _chains, sway = _upright_limbs(addon("tree.wind"), limbs_a_level=4)

    def waves(gusts):
        downwind, _crosswind = sway(gusts=gusts)
        spectrum = np.abs(np.fft.rfft(downwind, axis=1))
        return (spectrum > 1e-6 * spectrum.max(axis=1, keepdims=True)).sum(axis=1)

    assert set(waves(0.0)) == {2}, "a steady lean and one wave"
    assert waves(0.5).min() > 2


def test_gusts_reach_what_stands_downwind_later(addon):
    wind = addon("tree.wind")
    _chains, sway = _upright_limbs(wind, limbs_a_level=2, levels=1)
    # A quarter of the loop's four seconds further down the wind.
    roots = np.array([(0.0, 0.0, 0.0), (wind.WIND_SPEED, 0.0, 0.0)])
    steady, gusty = sway(roots)[0], sway(roots, gusts=0.6)[0]
    here, there = gusty / steady
    assert np.ptp(here) > 0.3
    assert np.allclose(there, np.roll(here, 4))


def test_more_wind_bends_further(addon):
    rig, bark = build_synthetic(addon)
    rest = evaluated_vertices(bark)
    _activate(rig)
    furthest = []
    for strength in (0.5, 1.0, 2.0):
        bpy.ops.snowbough.add_sway(strength=strength)
        furthest.append(max(np.abs(_positions(bark, frame) - rest).max() for frame in range(1, 97, 6)))
    assert furthest[0] < furthest[1] < furthest[2]


@pytest.mark.parametrize("bones", [1, 4, 60])
@pytest.mark.parametrize("radius", [0.002, 0.1])
def test_a_tip_swings_by_the_same_share_of_its_limb_whatever_the_bones(addon, bones, radius):
    wind = addon("tree.wind")
    lengths = np.full(bones, 6.0 / bones)
    radii = radius * np.linspace(1.0, 0.2, bones)
    chains = wind.find_chains([k - 1 for k in range(bones)], [k > 0 for k in range(bones)], lengths, radii)
    shares = wind.bone_shares(chains, lengths, radii)
    turned = np.cumsum(wind.swing_angles(chains, shares, lengths, 1.0) * shares)
    assert (np.sin(turned) * lengths).sum() / 6.0 == pytest.approx(0.05, rel=0.01)


def test_stubs_swing_less(addon):
    wind = addon("tree.wind")
    lengths, radii = np.array([8.0, 2.0, 0.2]), np.array([0.4, 0.02, 0.02])
    chains = wind.find_chains([-1, 0, 0], [False] * 3, lengths, radii)
    shares = wind.bone_shares(chains, lengths, radii)
    assert wind.swing_angles(chains, shares, lengths, 2.0) == pytest.approx([0.1, 0.1, 0.05])


def test_presets_are_stronger_in_their_order_and_own_values_overrule_them(addon):
    rig, bark = build_synthetic(addon)
    rest = evaluated_vertices(bark)
    _activate(rig)

    def furthest(**settings):
        bpy.ops.snowbough.add_sway(**settings)
        return max(np.abs(_positions(bark, frame) - rest).max() for frame in range(1, 97, 6))

    breeze, usual, wind, storm = (
        furthest(force="BREEZE"),
        furthest(),
        furthest(force="WIND"),
        furthest(force="STORM"),
    )
    assert breeze < wind < storm and usual == wind
    assert furthest(strength=0.0) == 0.0 and furthest(force="OWN", strength=0.0) == 0.0
    assert furthest(force="STORM", strength=0.0) == storm


def test_a_real_tree_moves_as_far_with_few_bones_as_with_many(addon):
    crowns = []
    for bones in (0, 12):
        rig, bark = import_tree(max_bones=bones)
        rest = evaluated_vertices(bark)
        top = rest[:, 2] > 0.9 * rest[:, 2].max()
        bpy.ops.snowbough.add_sway(gusts=0.0, strength=1.0)
        moved = [np.linalg.norm(_positions(bark, f)[top] - rest[top], axis=1).mean() for f in range(1, 97, 6)]
        crowns.append(max(moved) / rest[:, 2].max())
        bpy.ops.wm.read_homefile(use_empty=True)
    assert crowns[1] == pytest.approx(crowns[0], rel=0.35)
    assert 0.02 < min(crowns) and max(crowns) < 0.12


def test_cycles_are_whole_and_keep_their_order(addon):
    cycles = addon("tree.wind").loop_cycles(np.array([0.3, 1.0, 5.0, 40.0]), 4.0, 16)
    assert cycles.tolist() == sorted(cycles.tolist())
    assert cycles[0] == 1 and cycles[-1] == 4


def test_a_limbs_bend_is_shared_out_among_its_bones(addon):
    wind = addon("tree.wind")
    lengths, radii = np.full(4, 0.25), np.array([0.02, 0.02, 0.02, 0.02])
    chains = wind.find_chains([-1, 0, 1, 2], [False, True, True, True], lengths, radii)
    shares = wind.bone_shares(chains, lengths, radii)
    assert math.isclose(shares.sum(), 1.0, abs_tol=1e-12)
    assert shares[0] > shares[1] > shares[2] > shares[3]


def test_the_operator_works_from_the_bark_and_refuses_other_objects(addon):
    rig, bark = build_synthetic(addon)
    _activate(bark)
    assert bpy.ops.snowbough.add_sway() == {"FINISHED"}
    assert rig.animation_data.action is not None
    _activate(None)
    assert not bpy.ops.snowbough.add_sway.poll()


def test_a_thousand_bones_take_little_room(addon, tmp_path):
    rig, _bark = build_synthetic(addon, synthetic_bones(branches=53, twigs=5))
    assert len(rig.data.bones) >= 1000
    _activate(rig)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "before.blend"), copy=True, compress=False)
    bpy.ops.snowbough.add_sway()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "after.blend"), copy=True, compress=False)
    grown = os.path.getsize(tmp_path / "after.blend") - os.path.getsize(tmp_path / "before.blend")
    assert grown < 10e6
