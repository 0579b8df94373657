# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a stopped bake still computes its surfaces."""

from snowbough.surface.side_by_side import takes_longer_than


def clock_of(*times):
    remaining = iter(times)
    return lambda: next(remaining)


def test_work_that_will_end_in_time_goes_on():
    is_too_long = takes_longer_than(4.0, clock_of(0.0, 1.0, 2.0, 2.5, 3.0))
    assert [is_too_long(share) for share in (0.0, 0.1, 0.4, 0.7)] == [False] * 4


def test_work_whose_pace_is_too_slow_is_given_up_before_its_time_has_passed():
    is_too_long = takes_longer_than(4.0, clock_of(0.0, 1.0, 1.5, 2.0))
    assert [is_too_long(share) for share in (0.0, 0.01, 0.02)] == [False, False, True]


def test_preparations_that_take_too_long_are_given_up():
    is_too_long = takes_longer_than(4.0, clock_of(0.0, 3.0, 5.0))
    assert [is_too_long(share) for share in (0.0, 0.0)] == [False, True]
