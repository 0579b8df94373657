# SPDX-License-Identifier: GPL-3.0-or-later
"""One receiver's folder: its frames and checkpoints, and clearing it away. No ``bpy``."""

import contextlib
import os
import re
from pathlib import Path

from .errors import CacheError, NoCheckpoint
from .files import (
    EVER_COVERED,
    FRAME_PATTERN,
    INPUTS,
    LOCK,
    MANIFEST,
    STATE_PATTERN,
    TEMPORARY_SUFFIX,
    read_json,
    state_file,
    to_json,
    write_bytes,
)


def checkpoints(folder):
    """Frames of the whole checkpoints in a folder, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (STATE_PATTERN.match(name) for name in os.listdir(folder))
    frames = sorted(int(match.group(1)) for match in matches if match)
    return [frame for frame in frames if (Path(folder) / f"{state_file(frame)}.json").is_file()]


def read_sidecar(folder, frame):
    """What write_sidecar wrote. Raises NoCheckpoint where it is not there."""
    sidecar = read_json(Path(folder) / f"{state_file(frame)}.json")
    if sidecar is None:
        raise NoCheckpoint(f"{Path(folder) / state_file(frame)} has no {state_file(frame)}.json beside it")
    return sidecar


def write_sidecar(folder, frame, sidecar):
    """Writes state_NNNN.json; to be followed by state_NNNN itself, which makes the checkpoint whole."""
    write_bytes(Path(folder) / f"{state_file(frame)}.json", to_json(sidecar))


def remove_checkpoint(folder, frame):
    """Removes a checkpoint, state first, so that what a crash leaves is not taken for a whole one."""
    for name in (state_file(frame), f"{state_file(frame)}.json"):
        with contextlib.suppress(FileNotFoundError):
            (Path(folder) / name).unlink()


def remove_irregular_checkpoints(folder, frame_start, interval, before):
    """Removes checkpoints older than frame ``before`` that are not at a multiple of the interval."""
    for frame in checkpoints(folder):
        if frame < before and (frame - frame_start + 1) % interval:
            remove_checkpoint(folder, frame)


def _is_ours(name):
    return (
        name in (MANIFEST, LOCK, EVER_COVERED, INPUTS)
        or bool(FRAME_PATTERN.match(name))
        or bool(STATE_PATTERN.match(name.removesuffix(".json")))
        or (name.endswith(TEMPORARY_SUFFIX) or ".tmp" in name)
    )


def clear(folder, keep_lock=False):
    """Removes exactly what bakes write in a receiver's folder, and the folder when that leaves it
    empty. Returns the number of files removed."""
    folder = Path(folder)
    if not folder.is_dir():
        return 0
    removed = 0
    # The manifest goes first: what is left of an interrupted removal is no bake any more.
    for name in sorted(os.listdir(folder), key=lambda name: (name != MANIFEST, name)):
        if _is_ours(name) and not (keep_lock and name == LOCK):
            try:
                (folder / name).unlink()
            except OSError as error:
                raise CacheError(f"{folder / name} could not be removed: {error.strerror}") from error
            removed += 1
    with contextlib.suppress(OSError):
        folder.rmdir()
    return removed


def remove_stray_files(folder):
    """Removes what a killed bake left half written: temporary files, sidecars without a state."""
    folder = Path(folder)
    whole = set(checkpoints(folder))
    for name in os.listdir(folder):
        match = STATE_PATTERN.match(name.removesuffix(".json"))
        if ".tmp" in name or (match and int(match.group(1)) not in whole):
            with contextlib.suppress(FileNotFoundError):
                (folder / name).unlink()


def remove_frames_after(folder, frame):
    """Removes frames that were written after a checkpoint: the resumed bake writes them again, and a
    folder never shows frames of two different scenes."""
    for name in os.listdir(folder):
        match = FRAME_PATTERN.match(name)
        if match and int(match.group(1)) > frame:
            (Path(folder) / name).unlink()


def baked_frames(folder):
    """Frames whose height map is there, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (re.match(r"height_(\d{4,})\.exr$", name) for name in os.listdir(folder))
    return sorted(int(match.group(1)) for match in matches if match)
