# SPDX-License-Identifier: GPL-3.0-or-later
"""snowbough.surface.side_by_side: several jobs at once, with progress, a stop and errors."""

import threading

import pytest
from snowbough.surface.side_by_side import run_side_by_side


def test_all_jobs_run_and_progress_is_reported_on_the_calling_thread():
    done, threads, wait = [], set(), threading.Event()

    def progress(share):
        assert 0.0 <= share <= 1.0
        threads.add(threading.current_thread())
        wait.set()
        return True

    def job(own, name):
        own(0.5)
        assert wait.wait(30.0)
        done.append(name)
        return True

    assert run_side_by_side([lambda own, name=name: job(own, name) for name in "abc"], progress)
    assert sorted(done) == ["a", "b", "c"]
    assert threads == {threading.current_thread()}


def test_large_jobs_count_more():
    """One of two jobs is done, which is a tenth of the work."""
    seen, wait = [], threading.Event()

    def progress(share):
        seen.append(share)
        if share >= 0.1:
            wait.set()
        return True

    assert run_side_by_side([lambda own: True, lambda own: wait.wait(30.0)], progress, [1.0, 9.0])
    assert max(seen) == pytest.approx(0.1)


def test_a_stop_reaches_running_jobs_and_begins_no_other():
    begun = []

    def job(own):
        begun.append(True)
        while own(0.1):
            pass
        return False

    assert not run_side_by_side([job] * 50, lambda share: False)
    assert len(begun) < 50


def test_the_first_error_is_raised_and_stops_the_others():
    def fails(own):
        raise ValueError("no map")

    def waits(own):
        while own(0.0):
            pass
        return False

    with pytest.raises(ValueError, match="no map"):
        run_side_by_side([waits, fails], lambda share: True)


def test_no_jobs_are_done_at_once():
    assert run_side_by_side([], lambda share: True)
