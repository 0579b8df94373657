# SPDX-License-Identifier: GPL-3.0-or-later
"""Waiting for a window counts looks at it, whatever the clock says."""

import window


def test_a_pause_of_the_machine_ends_no_wait(monkeypatch):
    clock, looks = [0.0], []

    def sleep(seconds):
        clock[0] += seconds + (3600.0 if len(looks) == 2 else 0.0)

    def is_there():
        looks.append(clock[0])
        return len(looks) == 40

    monkeypatch.setattr(window.time, "sleep", sleep)
    monkeypatch.setattr(window.time, "monotonic", lambda: clock[0])
    window.wait_for(is_there, "the fortieth look", timeout=1.0)
    assert clock[0] > 3600.0


def test_what_never_comes_ends_a_wait(monkeypatch):
    slept = []
    monkeypatch.setattr(window.time, "sleep", slept.append)
    assert not window.true_within(1.0, lambda: False, every=0.02)
    assert len(slept) == 50
