# SPDX-License-Identifier: GPL-3.0-or-later
"""Checkpoints of a whole simulation in one file."""

import snowbough_native as native


def save(sim, path):
    native.write_checkpoint(str(path), native.simulation_state(sim))


def restore(sim, path):
    native.set_simulation_state(sim, native.read_checkpoint(str(path)))


def assert_resumes(new, run, stop, end, path, names=("ground",)):
    """Checks that a simulation that stops before step `stop` and goes on from a checkpoint ends as a whole one.
    new() makes one, or an object with one as `sim`; run(it, begin, end) makes steps. Returns the whole one."""
    made = whole, first, second = new(), new(), new()
    run(whole, 0, end)
    run(first, 0, stop)
    sims = [getattr(one, "sim", one) for one in made]
    save(sims[1], path)
    restore(sims[2], path)
    run(second, stop, end)
    for name in names:
        assert sims[2].height(name).tobytes() == sims[0].height(name).tobytes()
    assert sims[2].statistics() == sims[0].statistics()
    return whole
