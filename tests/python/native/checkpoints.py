# SPDX-License-Identifier: GPL-3.0-or-later
"""Checkpoints of a whole simulation in one file."""

import snowbough_native as native


def save(sim, path):
    native.write_checkpoint(str(path), native.simulation_state(sim))


def restore(sim, path):
    native.set_simulation_state(sim, native.read_checkpoint(str(path)))
