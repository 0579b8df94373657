# SPDX-License-Identifier: GPL-3.0-or-later
"""Which checkpoint a bake resumes from, and whether it fits the current scene. No ``bpy``."""

from ..cache.errors import InputsChanged, NoCheckpoint
from ..cache.folder import checkpoints
from ..scene.inputs import SceneInputs
from .snow_engine import other_engine


def checkpoint_frame(request, receivers, version):
    """The frame of the checkpoint that the receivers of a BakeRequest resume from, None for a fresh start.

    Raises NoCheckpoint, naming the existing ones, if the requested frames need another checkpoint."""
    common = set.intersection(*(set(checkpoints(receiver.folder)) for receiver in receivers))
    if request.resume:
        usable = [frame for frame in common if request.first - 1 <= frame <= request.last]
        if usable:
            return max(usable)
    elif request.first - 1 in common and request.first > request.frame_start:
        return request.first - 1
    if request.first > request.frame_start:
        there = f"there are: {sorted(common)}" if common else "there is none"
        raise NoCheckpoint(
            f"Frame {request.first} needs the checkpoint of frame {request.first - 1} in {version} "
            f"({there}). Bake from frame {request.frame_start}, or start after a checkpoint"
        )
    return None


def read_checkpoints(native, receivers, frame, driver):
    """Reads each BakedReceiver's checkpoint of ``frame``: (state for set_simulation_state, {receiver's label: the poses
    that it was baked from, as in scene.inputs}). driver: the required engine and driver, None for any.

    Raises InputsChanged if another driver made them, or if they are from different bakes."""
    numbers, states, inputs = set(), {}, {}
    for receiver in receivers:
        number, states[receiver.key], made_with, poses = receiver.read_checkpoint(native, frame)
        numbers.add(number)
        # Thousands of receivers may have equal lists: keep one of them.
        inputs[receiver.shown] = next((known for known in inputs.values() if known == poses), poses)
        if driver is not None and made_with != driver:
            raise other_engine(made_with, driver)
    if len(numbers) > 1:
        raise InputsChanged(
            f"The receivers' checkpoints of frame {frame} do not belong together (steps "
            f"{', '.join(map(str, sorted(numbers)))}): bake again from the start"
        )
    return {"step_number": numbers.pop(), "objects": states}, inputs


def compare_scenes(recorded, inputs, what, remedy):
    """Raises InputsChanged, naming the first difference, if SceneInputs differ from the poses that any receiver was
    baked from. recorded: {receiver's label: poses}."""
    compared = []
    for label, poses in sorted(recorded.items()):
        if any(poses is known for known in compared):
            continue
        compared.append(poses)
        difference = SceneInputs(poses).first_difference(inputs)
        if difference:
            raise InputsChanged(f"The scene is not the one that {label} {what} ({difference}): {remedy}")
