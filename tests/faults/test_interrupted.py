# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes whose scene or engine fails in the middle keep finished frames, and a resumed bake ends with the same bytes."""

from types import SimpleNamespace

import pytest
import shot
from snowbough.cache import folder

NATIVE = shot.native_loader.load()
# Steps of a frame: each pose has one direction.
SUBSTEPS = 2


@pytest.fixture(scope="module")
def whole(memory_folder):
    """The bytes of a bake that was never disturbed."""
    cache = memory_folder / "whole" / "cache"
    shot.bake(cache, substeps=SUBSTEPS)
    return shot.files_of(cache)


def failing_at(number, error):
    """The native module, whose step of that number, counted from 1, raises an error."""

    class Simulation(NATIVE.SnowSimulation):
        steps = 0

        def step(self, *arguments, **settings):
            Simulation.steps += 1
            if Simulation.steps == number:
                raise error
            super().step(*arguments, **settings)

    return SimpleNamespace(**{**vars(NATIVE), "SnowSimulation": Simulation})


def baked_frames(cache):
    (ground,) = cache.rglob("Ground-*")
    return folder.baked_frames(ground)


def test_a_scene_that_cannot_be_read_any_more_leaves_a_checkpoint(tmp_path, whole):
    def evaluate(frame, subframe):
        if frame >= 6:
            raise AttributeError("'Scene' object has no attribute 'snowbough'")
        return shot.pose(frame, subframe)

    cache = tmp_path / "cache"
    with pytest.raises(AttributeError):
        shot.bake(cache, evaluate, substeps=SUBSTEPS)
    # The interval alone would have left that of frame 3.
    assert max(folder.checkpoints(next(cache.rglob("Ground-*")))) == 5
    shot.bake(cache, substeps=SUBSTEPS, resume=True)
    assert shot.files_of(cache) == whole


def test_nothing_is_baked_after_a_frame_that_broke_off(tmp_path, whole):
    """The engine works again at the next step, but the failed step's snow is missing."""
    cache = tmp_path / "cache"
    broken = failing_at(5 * SUBSTEPS + 1, RuntimeError("the driver went away for a moment"))
    with pytest.raises(RuntimeError, match="went away for a moment"):
        shot.bake(cache, substeps=SUBSTEPS, native=broken)
    assert baked_frames(cache) == [1, 2, 3, 4, 5]
    shot.bake(cache, substeps=SUBSTEPS, resume=True)
    assert shot.files_of(cache) == whole


def test_a_failure_in_the_middle_of_a_frame_spoils_no_checkpoint(tmp_path, whole):
    cache = tmp_path / "cache"
    broken = failing_at(4 * SUBSTEPS + 2, ValueError("no room"))  # in the middle of frame 5
    with pytest.raises(ValueError, match="no room"):
        shot.bake(cache, substeps=SUBSTEPS, native=broken)
    assert baked_frames(cache) == [1, 2, 3, 4]
    shot.bake(cache, substeps=SUBSTEPS, resume=True)
    assert shot.files_of(cache) == whole
