# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowfall from an artist's numbers (snowbough.bake.plan), without Blender."""

import math
import random

import pytest
from snowbough.bake import plan


def test_an_even_rate_lays_the_same_depth_on_every_frame():
    snowfall = plan.plan_snowfall(1, 4, 0.0, 0.4, [1, 1, 1, 1])
    assert snowfall.depths == pytest.approx((0.1, 0.1, 0.1, 0.1))
    assert snowfall.totals == pytest.approx((0.1, 0.2, 0.3, 0.4))


def test_the_rate_shapes_the_fall():
    snowfall = plan.plan_snowfall(10, 12, 0.0, 0.4, [1, 0, 3])
    assert snowfall.depths == pytest.approx((0.1, 0.0, 0.3))


def test_the_last_total_is_the_end_depth_itself_for_any_rates():
    seed = random.randrange(1 << 30)
    print("seed", seed)
    numbers = random.Random(seed)
    for _ in range(50):
        rates = [numbers.random() for _ in range(numbers.randrange(1, 300))]
        start, end = sorted((numbers.random(), numbers.random()))
        snowfall = plan.plan_snowfall(1, len(rates), start, end, rates)
        assert snowfall.totals[-1] == end
        assert math.fsum(snowfall.depths) + start == pytest.approx(end, rel=1e-12)
        assert min(snowfall.depths) >= 0


def test_start_depth_is_laid_before_the_first_frame_and_then_rests():
    snowfall = plan.plan_snowfall(5, 6, 0.32, 0.5, [1, 1])
    steps = plan.preroll_steps(snowfall, fps=24, slide_half_life=2.0)
    assert len(steps) == 33
    assert {(step.frame, step.subframe) for step in steps} == {(5, 0.0)}
    assert [step.depth for step in steps[:32]] == pytest.approx([0.01] * 32)
    assert steps[-1].depth == 0 and steps[-1].dt == 128.0


def test_no_start_depth_means_no_preroll():
    snowfall = plan.plan_snowfall(1, 2, 0.0, 0.1, [1, 1])
    assert plan.preroll_steps(snowfall, 24, 2.0) == []


def test_substeps_end_on_the_frame_itself_and_share_its_depth():
    snowfall = plan.plan_snowfall(1, 2, 0.0, 0.8, [1, 1])
    steps = plan.frame_steps(snowfall, 2, fps=25, substeps=4)
    assert [(s.frame, s.subframe) for s in steps] == [(1, 0.25), (1, 0.5), (1, 0.75), (2, 0.0)]
    assert [s.depth for s in steps] == pytest.approx([0.1] * 4)
    assert [s.dt for s in steps] == pytest.approx([0.01] * 4)


def test_the_first_frame_needs_no_pose_from_before_the_shot():
    snowfall = plan.plan_snowfall(1, 2, 0.0, 0.8, [1, 1])
    steps = plan.frame_steps(snowfall, 1, fps=25, substeps=4)
    assert [(s.frame, s.subframe) for s in steps] == [(1, 0.0)] * 4
    assert sum(s.depth for s in steps) == pytest.approx(0.4)


def steps_of(count, directions, substeps=1, rates=None):
    snowfall = plan.plan_snowfall(1, count, 0.0, 0.12, rates or [1] * count)
    return [plan.frame_steps(snowfall, frame, 24, substeps, directions) for frame in range(1, count + 1)]


@pytest.mark.parametrize(
    "count, on_frames",
    [
        (1, [64]),
        (12, [5] * 8 + [6] * 4),
        (24, [2] * 8 + [3] * 16),
        (48, [1] * 32 + [2] * 16),
        (63, [1] * 62 + [2]),
        (64, [1] * 64),
        (250, [1] * 250),
    ],
)
def test_few_frames_fall_from_as_many_directions_as_many(count, on_frames):
    frames = steps_of(count, 64)
    assert [len(steps) for steps in frames] == on_frames
    assert math.fsum(step.depth for steps in frames for step in steps) == pytest.approx(0.12, rel=1e-12)
    for steps in frames:
        assert math.fsum(step.dt for step in steps) == pytest.approx(1 / 24)
        assert len({step.depth for step in steps}) == 1


@pytest.mark.parametrize("count, timed", [(1, 1), (6, 1), (7, 2), (16, 3), (64, 11)])
def test_every_sixth_step_of_a_pose_and_the_last_share_its_time(count, timed):
    steps = steps_of(1, count)[0]
    assert len(steps) == count
    assert sum(step.dt > 0 for step in steps) == timed
    assert steps[-1].dt == pytest.approx(1 / 24 / timed)
    untimed = "".join(" " if step.dt > 0 else "x" for step in steps)
    assert max(map(len, untimed.split(" "))) <= 5


def test_a_gust_has_the_directions_and_the_calm_frames_none():
    assert [len(steps) for steps in steps_of(4, 64, rates=[0, 3, 1, 0])] == [1, 48, 16, 1]


def test_no_frame_has_more_directions_than_its_share_rounded_up():
    counts = [len(steps) for steps in steps_of(6, 64, rates=[1, 2, 30, 2, 1, 0])]
    assert counts == [1, 3, 53, 4, 2, 1]  # shares: 1.8, 3.6, 53.3, 3.6, 1.8 and 0


def test_directions_are_shared_among_the_poses_of_substeps():
    steps = steps_of(4, 64, substeps=3)[1]  # 16 directions on 3 poses
    assert [(step.frame, round(step.subframe, 3)) for step in steps] == (
        [(1, 0.333)] * 6 + [(1, 0.667)] * 6 + [(2, 0.0)] * 6
    )


def test_the_start_depth_falls_from_all_directions_too():
    snowfall = plan.plan_snowfall(5, 6, 0.32, 0.5, [1, 1])
    steps = plan.preroll_steps(snowfall, 24, 2.0, directions=64)
    assert [step.depth for step in steps[:-1]] == pytest.approx([0.005] * 64)
    assert steps[-1].depth == 0


def test_nothing_that_falls_needs_no_directions():
    snowfall = plan.plan_snowfall(1, 2, 0.1, 0.1, [0, 0])
    assert len(plan.frame_steps(snowfall, 2, 24, 1, 64)) == 1


def test_a_shot_of_one_frame_gets_the_end_depth():
    assert plan.plan_snowfall(7, 7, 0.1, 0.3, [1]).totals == (0.3,)


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((5, 4, 0, 1, []), "before the first"),
        ((-1, 4, 0, 1, [1] * 6), "frame 0 or later"),
        ((1, 2, 0.5, -0.1, [1, 1]), "must be at least 0"),
        ((1, 2, 0, 1, [1]), "2 frames need 2 rates"),
        ((1, 2, 0, 1, [1, -1]), "rate at frame 2"),
        ((1, 2, 0, 1, [0, 0]), "rate is 0 on every frame"),
    ],
)
def test_bad_input_says_what_is_wrong(arguments, message):
    with pytest.raises(ValueError, match=message):
        plan.plan_snowfall(*arguments)


@pytest.mark.parametrize(
    "angle, bearing, direction",
    [
        (0, 0, (0, 0, -1)),
        (45, 0, (0, math.sqrt(0.5), -math.sqrt(0.5))),
        (45, 90, (math.sqrt(0.5), 0, -math.sqrt(0.5))),
        (30, 180, (0, -0.5, -math.sqrt(0.75))),
    ],
)
def test_the_bearing_turns_clockwise_from_north(angle, bearing, direction):
    assert plan.fall_direction(math.radians(angle), math.radians(bearing)) == pytest.approx(
        direction, abs=1e-12
    )


def test_a_horizontal_fall_is_refused():
    with pytest.raises(ValueError, match="89.5"):
        plan.fall_direction(math.radians(90), 0)


def test_the_automatic_resolution_reaches_the_texel_size():
    # 10 m x 10 m over the whole map: 1000 texels of 1 cm, so 1024.
    assert plan.automatic_resolution(100.0, 1.0, 0.01) == 1024
    # The same surface on a quarter of the map needs twice as many.
    assert plan.automatic_resolution(100.0, 0.25, 0.01) == 2048
    assert plan.automatic_resolution(1.0, 1.0, 0.01) == 256
    assert plan.automatic_resolution(1e6, 1.0, 0.01) == 4096


def test_the_automatic_pixel_is_the_finest_texel_until_the_scene_is_too_large():
    assert plan.automatic_pixel_size([0.02, 0.01], (0, 0, 0), (10, 10, 1)) == 0.01
    coarse = plan.automatic_pixel_size([0.01], (0, 0, 0), (1000, 1000, 0))
    assert coarse == pytest.approx(math.sqrt(2) * 1000 / 4096)


def test_frames_of_the_command_line_lie_inside_the_shot():
    assert plan.parse_frames("3-20", 1, 48) == (3, 20)
    assert plan.parse_frames("7", 1, 48) == (7, 7)
    assert plan.parse_frames("-3-2", -10, 48) == (-3, 2)
    assert plan.parse_frames("-9--4", -10, 48) == (-9, -4)
    for text in ("0-5", "5-3", "40-49", "a-b", "", "-"):
        with pytest.raises(ValueError):
            plan.parse_frames(text, 1, 48)


def test_a_list_of_names_names_something():
    assert plan.parse_names("Ground, Bench,") == ["Ground", "Bench"]
    assert plan.parse_names(None) == []
    for text in (",,,", "", " "):
        with pytest.raises(ValueError, match="names no receiver"):
            plan.parse_names(text)


def test_frames_that_are_added_to_a_shot_leave_the_depths_and_steps_of_the_others():
    """8 frames with 64 directions on 0.2 m, then 4 frames with 0.05 m more: a quarter of the directions."""
    shot = plan.plan_snowfall(1, 8, 0.0, 0.2, [1, 2, 3, 4, 1, 2, 3, 4])
    longer = plan.plan_snowfall(1, 12, 0.0, 0.25, [1, 2, 3, 4, 1, 2, 3, 4, 1, 1, 1, 1], ((8, 0.2),))
    assert longer.totals[:8] == shot.totals and longer.depths[:8] == shot.depths
    assert longer.totals[8:] == pytest.approx([0.2125, 0.225, 0.2375, 0.25])
    counts = [plan.frame_directions(longer, frame, 64) for frame in range(1, 13)]
    assert counts[:8] == [plan.frame_directions(shot, frame, 64) for frame in range(1, 9)]
    assert counts[8:] == [4, 4, 4, 4]
    longest = plan.plan_snowfall(1, 13, 0.0, 0.25, [1, 2, 3, 4] * 2 + [1] * 5, ((8, 0.2), (12, 0.25)))
    assert longest.totals[:12] == longer.totals and longest.depths[12] == 0.0
    assert [plan.frame_directions(longest, frame, 64) for frame in range(1, 14)] == [*counts, 1]


@pytest.mark.parametrize(
    "last, end_depth, reason",
    [(12, 0.1, "0.2 m of snow lie at frame 8"), (6, 0.2, "Frames 1-8 are baked")],
)
def test_a_shot_that_cannot_be_continued_is_refused_with_a_reason(last, end_depth, reason):
    with pytest.raises(ValueError, match=reason):
        plan.plan_snowfall(1, last, 0.0, end_depth, [1] * last, ((8, 0.2),))


def test_an_end_depth_below_the_start_depth_thaws():
    snowfall = plan.plan_snowfall(1, 4, 0.3, 0.1, [1, 0, 2, 1])
    assert snowfall.depths == pytest.approx((-0.05, 0.0, -0.1, -0.05)) and snowfall.totals[-1] == 0.1
    steps = [step for frame in range(1, 5) for step in plan.frame_steps(snowfall, frame, 24, 1, 64)]
    assert [step.depth for step in steps] == pytest.approx([-0.05, 0.0, -0.1, -0.05])
    assert plan.preroll_steps(snowfall, 24, 2.0, 64)[0].depth > 0.0
