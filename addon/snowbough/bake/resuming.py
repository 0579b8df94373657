# SPDX-License-Identifier: GPL-3.0-or-later
"""Which checkpoint a bake resumes from, and whether it fits the current scene. No ``bpy``."""

from concurrent.futures import ThreadPoolExecutor

from ..cache.errors import CacheError, InputsChanged, NoCheckpoint
from ..cache.manifest import read_inputs
from ..cache.versions import is_finished
from ..scene.inputs import SceneInputs
from .simulation import other_engine


def find_damage(receivers):
    """{key: (frame, path)} of the BakedReceivers with a missing or damaged file: the first one, and the frame before
    which the bake must go on."""
    with ThreadPoolExecutor() as pool:
        found = pool.map(lambda receiver: receiver.first_damage(), receivers)
        return {receiver.key: place for receiver, place in zip(receivers, found) if place}


def checkpoint_frame(request, receivers, beside, version, damage):
    """The frame of the checkpoint that the receivers of a BakeRequest resume from, None for a fresh start. beside: the
    BakedReceivers that are simulated but not written. Their state is needed, too: it is in their own checkpoints, or in
    those that a stopped bake has written out of turn.

    damage: from find_damage. Raises NoCheckpoint, naming the existing ones, if the requested frames need another
    checkpoint, and CacheError if the damage cannot be repaired."""
    common = set.intersection(*(set(receiver.checkpoints()) for receiver in receivers))
    theirs = {receiver.key: set(receiver.checkpoints()) for receiver in beside}

    def is_whole(frame):
        missing = {key for key, frames in theirs.items() if frame not in frames}
        if missing and not request.is_checkpoint(frame):
            missing -= {key for receiver in receivers for key in receiver.beside(frame)}
        return not missing

    common = {frame for frame in common if is_whole(frame)}
    at, path = min(damage.values(), default=(request.last + 1, None))
    if request.resume:
        usable = [frame for frame in common if request.first - 1 <= frame < at and frame <= request.last]
        if usable:
            return max(usable)
    elif request.first - 1 in common and request.first > request.frame_start:
        if at < request.first:
            raise CacheError(
                f"{path} is missing or damaged: resume the bake, which repairs it, then bake this part"
            )
        return request.first - 1
    if damage and any(is_finished(receiver.folder) for receiver in receivers):
        # A finished receiver is only written again if the scene was compared with one of its checkpoints.
        raise CacheError(
            f"{path} is missing or damaged, and there is no checkpoint before it. Bake again, which makes a new version"
        )
    if request.first > request.frame_start:
        there = f"there are: {sorted(common)}" if common else "there is none"
        raise NoCheckpoint(
            f"Frame {request.first} needs the checkpoint of frame {request.first - 1} in {version} "
            f"({there}). Bake from frame {request.frame_start}, or start after a checkpoint"
        )
    return None


def read_checkpoints(native, receivers, beside, frame, driver):
    """Reads each BakedReceiver's checkpoint of ``frame``: (state for set_simulation_state, {receiver's label: the poses
    that it was baked from, as in scene.inputs}). beside: as in checkpoint_frame; their bakes stay as they are. driver:
    the required engine and driver, None for any.

    Raises InputsChanged if another driver made them, or if they are from different bakes."""
    numbers, states, inputs, scene = set(), {}, {}, {}
    sizes = {receiver.key: receiver.resolution for receiver in [*receivers, *beside]}
    for receiver in [*receivers, *beside]:
        is_beside = receiver in beside
        if is_beside and receiver.key in states:
            continue
        read = receiver.peek_checkpoint if is_beside else receiver.read_checkpoint
        state, made_with, poses = read(native, frame, sizes)
        numbers.add(state["step_number"])
        states.update(state["objects"])
        # All hold the same.
        scene = {part: state[part] for part in ("landing", "pressers") if part in state}
        # Thousands of receivers may have equal lists: keep one of them.
        inputs[receiver.shown] = next((known for known in inputs.values() if known == poses), poses)
        if driver is not None and made_with != driver:
            raise other_engine(made_with, driver)
    if len(numbers) > 1:
        raise InputsChanged(
            f"The receivers' checkpoints of frame {frame} do not belong together (steps "
            f"{', '.join(map(str, sorted(numbers)))}): bake again from the start"
        )
    return {"step_number": numbers.pop(), "objects": states, **scene}, inputs


def finished_inputs(receivers, writing):
    """{label: recorded poses} of the BakedReceivers that were finished before, all but those in `writing`."""
    keys = {receiver.key for receiver in writing}
    found = {own.shown: read_inputs(own.folder) for own in receivers if own.key not in keys}
    return {label: poses for label, poses in found.items() if poses is not None}


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
