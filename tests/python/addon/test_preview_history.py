# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that the live preview stores (snowbough.preview.history), without Blender."""

from dataclasses import dataclass, field

import numpy as np
from snowbough.preview.history import History, Moment

MAP = 16 * 16 * 4


@dataclass
class Pose:
    """A scene.pose.ScenePose with the attributes that count memory."""

    objects: dict = field(default_factory=dict)


@dataclass
class Object:
    positions: np.ndarray


def moment(frame, pose=None):
    state = {"step_number": frame, "objects": {"ground": {"height": np.zeros((16, 16), dtype=np.float32)}}}
    return Moment(frame, pose or Pose(), 0.1 * frame, state)


def filled(budget, frames):
    history = History(budget)
    for frame in frames:
        history.put(moment(frame))
    return history


def test_a_frame_gives_its_own_moment_or_the_one_before():
    history = filled(100 * MAP, (3, 5, 9))
    assert history.at(5).frame == 5
    assert history.at(6) is None
    assert history.before(6).frame == 5
    assert history.before(9).frame == 9
    assert history.before(2) is None


def test_frames_are_in_order_however_they_come():
    assert filled(100 * MAP, (5, 1, 3)).frames == (1, 3, 5)


def test_a_frame_played_again_takes_the_place_of_the_first_time():
    history = filled(100 * MAP, (1, 2))
    again = moment(2)
    history.put(again)
    assert history.frames == (1, 2)
    assert history.at(2) is again


def test_what_is_kept_stays_within_the_budget_and_spread_over_the_frames():
    history = filled(5 * MAP, range(1, 33))
    assert history.bytes <= 5 * MAP
    assert len(history) == 5
    assert (history.frames[0], history.frames[-1]) == (1, 32)
    gaps = np.diff(history.frames)
    assert gaps.max() <= 16


def test_the_first_and_the_newest_stay_whatever_the_budget():
    assert filled(1, range(1, 10)).frames == (1, 9)


def test_positions_that_moments_share_count_once():
    positions = np.zeros((100, 3), dtype=np.float32)
    still = Pose({"ground": Object(positions)})
    history = History(1 << 30)
    history.put(moment(1, still))
    history.put(moment(2, still))
    assert history.bytes == 2 * MAP + positions.nbytes
    history.put(moment(3, Pose({"ground": Object(positions.copy())})))
    assert history.bytes == 3 * MAP + 2 * positions.nbytes


def test_what_comes_after_a_frame_can_be_forgotten():
    history = filled(100 * MAP, range(1, 6))
    history.drop_after(3)
    assert history.frames == (1, 2, 3)


def test_poses_stay_where_the_snow_is_forgotten():
    history = filled(100 * MAP, range(1, 4))
    history.forget_snow()
    assert history.bytes == 0
    assert history.at(2) is None and history.before(3) is None
    assert [frame for frame, _ in history.poses()] == [1, 2, 3]
    history.put(moment(1))
    assert history.before(3).frame == 1
