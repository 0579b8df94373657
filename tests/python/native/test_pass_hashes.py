"""Hashes of the passes of a step, and the tool that names the first difference."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

TOOL = Path(__file__).parents[3] / "tools" / "compare_hashes.py"
QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
UV = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
GROUND = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
ROOF = GROUND * 0.5 + [0, 0, 1]


def hashes(path, first=0, last=4, state=None, **changes):
    """Runs steps on a ground that tilts under a roof, and writes the hashes. Returns the state after them.

    changes: settings, or {step: number} as `lower_roof` for a roof that is lower in that step."""
    lower_roof = changes.pop("lower_roof", None)
    settings = {"pixel_size": 0.05, "engine": "CPU", "max_depth": 0.02, "repose": 0.6, "slide_half_life": 0.1}
    with native.SnowSimulation(**{**settings, **changes}) as sim, open(path, "w") as file:
        sim.add_object("ground", QUAD, UV, resolution=64)
        sim.add_object("roof", QUAD, UV, receive=False)
        if state is not None:
            native.set_simulation_state(sim, state)
        sim.hash_passes(True)
        for step in range(first, last):
            tilted = (GROUND + GROUND[:, :1] * [0, 0, 0.3 * step]).astype(np.float32)
            roof = (ROOF - [0, 0, 0.1 * (step == lower_roof)]).astype(np.float32)
            sim.step({"ground": tilted, "roof": roof}, depth=0.01, dt=0.04)
            for row in sim.pass_hashes():
                print(step, *row, sep="\t", file=file)
        return native.simulation_state(sim)


def compare(a, b):
    done = subprocess.run([sys.executable, TOOL, a, b], capture_output=True, text=True)
    return done.returncode, done.stdout.splitlines()[0]


def test_a_step_has_a_hash_for_each_pass_and_object(tmp_path):
    hashes(tmp_path / "a", last=1)
    rows = [line.split("\t") for line in (tmp_path / "a").read_text().splitlines()]
    assert [(row[2], row[3]) for row in rows] == [
        ("positions", "ground"), ("positions", "roof"), ("projection", "all"), ("triangles", "ground"),
        ("triangles", "roof"), ("occlusion", rows[5][3]), ("deposit", "ground"), ("stability", "ground"),
        ("repose", "ground"), ("statistics", "ground"),
    ]  # fmt: skip
    assert rows[5][3].startswith("tile ")


def test_the_same_steps_have_the_same_hashes(tmp_path):
    hashes(tmp_path / "a")
    hashes(tmp_path / "b")
    assert compare(tmp_path / "a", tmp_path / "b") == (0, "40 hashes are equal")


@pytest.mark.parametrize(
    "change, message",
    [
        ({"lower_roof": 2}, "frame 2, step 2: the pass positions differs on roof"),
        ({"seed": 1}, "frame 0, step 0: the pass projection differs on all"),
        ({"max_depth": 0.019}, "frame 1, step 1: the pass stability differs on ground"),
        ({"repose": 0.61}, "frame 1, step 1: the pass repose differs on ground"),
    ],
)
def test_the_first_pass_that_differs_is_named(tmp_path, change, message):
    hashes(tmp_path / "a")
    hashes(tmp_path / "b", **change)
    assert compare(tmp_path / "a", tmp_path / "b") == (1, message)


def test_a_resumed_run_has_the_hashes_of_the_whole_one(tmp_path):
    hashes(tmp_path / "whole")
    state = hashes(tmp_path / "begin", last=2)
    hashes(tmp_path / "end", first=2, state=state)
    assert compare(tmp_path / "whole", tmp_path / "end") == (0, "20 hashes are equal")


def test_files_without_a_common_step_are_refused(tmp_path):
    hashes(tmp_path / "a", last=1)
    (tmp_path / "b").write_text("")
    assert compare(tmp_path / "a", tmp_path / "b") == (2, "no step is in both files")
