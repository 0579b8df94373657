# SPDX-License-Identifier: GPL-3.0-or-later
"""One receiver's folder: its frames and checkpoints, and clearing it away. No ``bpy``."""

import contextlib
import os
import re
from pathlib import Path

from .errors import CacheError, NoCheckpoint
from .files import (
    FRAME_PATTERN,
    LOCK,
    MANIFEST,
    PROBE,
    REMOVED_MANIFEST,
    STATE_PATTERN,
    TEXTURE_CACHE,
    finished_name,
    is_bake_file,
    is_regular,
    state_file,
    texture_source,
)
from .manifest import FRAMES, POSES, listing, read_any_manifest
from .sealed import FORMAT, read_sealed, text, write_sealed


def checkpoints(folder):
    """Frames of the whole checkpoints in a folder, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (STATE_PATTERN.match(name) for name in os.listdir(folder))
    frames = sorted(int(match.group(1)) for match in matches if match)
    return [frame for frame in frames if (Path(folder) / f"{state_file(frame)}.json").is_file()]


def read_sidecar(folder, frame):
    """What write_sidecar wrote. Raises NoCheckpoint where it is not there, CacheError where it is damaged."""
    shape = {"covered": text, "driver": text, "frames": FRAMES, "inputs": POSES}
    remedy = "Remove it to resume from the checkpoint before it, or free the bake and bake again"
    shapes = {0: shape, FORMAT: shape}
    sidecar = read_sealed(Path(folder) / f"{state_file(frame)}.json", remedy, shapes.get)
    if sidecar is None:
        raise NoCheckpoint(f"{Path(folder) / state_file(frame)} has no {state_file(frame)}.json beside it")
    return sidecar


def write_sidecar(folder, frame, sidecar):
    """Writes state_NNNN.json; to be followed by state_NNNN itself, which makes the checkpoint whole."""
    write_sealed(Path(folder) / f"{state_file(frame)}.json", sidecar)


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


def is_foreign(folder):
    """Whether something is there that no bake has made: a link, or files without a manifest."""
    folder = Path(folder)
    if not os.path.lexists(folder):
        return False
    if folder.is_symlink() or not folder.is_dir():
        return True
    names = set(os.listdir(folder))
    return not names & {MANIFEST, REMOVED_MANIFEST} and any(
        finished_name(name) not in (LOCK, MANIFEST) and not name.startswith(PROBE) for name in names
    )


def listed_files(folder):
    """Paths of the files in a receiver's folder that its manifest lists, the manifest last: with what a killed bake
    left half written of them, and what Cycles made of them. Links are none of them. Empty without a manifest."""
    folder = Path(folder)
    manifest = read_any_manifest(folder)
    if manifest is None:
        return []
    listed = listing(manifest)
    names = sorted(os.listdir(folder), key=lambda name: (name in (MANIFEST, REMOVED_MANIFEST), name))
    own = [folder / name for name in names if finished_name(name) in listed or name == REMOVED_MANIFEST]
    textures = folder / TEXTURE_CACHE
    if textures.is_dir() and not textures.is_symlink():
        own = [
            textures / name for name in sorted(os.listdir(textures)) if texture_source(name) in listed
        ] + own
    return [path for path in own if is_regular(path)]


def clear(folder):
    """Removes listed_files(), and the folder when that leaves it empty. Returns the number of files removed."""
    folder = Path(folder)
    listed = listed_files(folder)
    try:
        # What is left of an interrupted removal is no bake any more, and still has its list.
        if (folder / MANIFEST) in listed:
            os.replace(folder / MANIFEST, folder / REMOVED_MANIFEST)
        for path in listed:
            path = folder / REMOVED_MANIFEST if path == folder / MANIFEST else path
            path.unlink(missing_ok=True)
    except OSError as error:
        raise CacheError(f"{error.filename} could not be removed: {error.strerror}") from error
    for emptied in (folder / TEXTURE_CACHE, folder):
        with contextlib.suppress(OSError):
            emptied.rmdir()
    return len(listed)


def remove_stray_files(folder):
    """Removes what a killed bake left half written: temporary files, sidecars without a state."""
    folder = Path(folder)
    whole = set(checkpoints(folder))
    for name in os.listdir(folder):
        match = STATE_PATTERN.match(name.removesuffix(".json"))
        half = finished_name(name) != name and is_bake_file(finished_name(name))
        if half or (match and int(match.group(1)) not in whole):
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
