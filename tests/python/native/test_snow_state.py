# SPDX-License-Identifier: GPL-3.0-or-later
"""Truncated, foreign or damaged checkpoints are refused and leave the snow unchanged."""

import numpy as np
import pytest
from checkpoints import restore, save
from snow_fall import new_simulation
from snow_meshes import sphere


@pytest.fixture
def saved(tmp_path):
    positions, triangles, uv = sphere(around=16, rings=8)

    def start(resolution=64, name="it"):
        sim = new_simulation(pixel_size=0.02, noise_density=0.5)
        sim.add_object(name, triangles, uv, resolution=resolution)
        return sim

    with start() as sim:
        sim.step({"it": positions}, 0.05)
        save(sim, tmp_path / "state")
    return start, tmp_path, positions


def test_a_checkpoint_of_other_objects_says_what_differs(saved):
    start, folder, _ = saved
    messages = ("has 64 texels per side, the object has 128", "there is no object named 'it'")
    for other, message in zip(({"resolution": 128}, {"name": "that"}), messages):
        with start(**other) as sim, pytest.raises(ValueError, match=message):
            restore(sim, folder / "state")


def test_a_refused_checkpoint_leaves_the_snow_as_it_was(saved):
    start, folder, positions = saved
    (folder / "cut").write_bytes((folder / "state").read_bytes()[:-40])
    with start() as sim:
        sim.step({"it": positions}, 0.02)
        before = sim.height("it")
        with pytest.raises(RuntimeError, match="cut"):
            restore(sim, folder / "cut")
        assert np.array_equal(sim.height("it"), before)


def test_the_same_state_is_saved_as_the_same_bytes(saved):
    start, folder, _ = saved
    with start() as sim:
        restore(sim, folder / "state")
        save(sim, folder / "again")
    assert (folder / "again").read_bytes() == (folder / "state").read_bytes()
