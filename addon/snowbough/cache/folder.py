# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of one receiver: its frames and checkpoints, and removing them. No ``bpy``."""

import contextlib
import os
import re
from pathlib import Path

from .errors import CacheError, NoCheckpoint, failed
from .files import (
    FRAME_PATTERN,
    FRAMES,
    LOCK,
    MANIFEST,
    PROBE,
    REMOVED_MANIFEST,
    STATE_PATTERN,
    SURFACE,
    TEXTURE_CACHE,
    bake_files,
    finished_name,
    is_bake_file,
    is_regular,
    state_file,
    texture_source,
)
from .journal import LineEnd, read_lines
from .manifest import listing, read_any_head, read_head, write_manifest
from .sealed import read_sealed, write_sealed
from .shapes import SIDECAR


def checkpoints(folder):
    """Frames of the complete checkpoints in a folder, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (STATE_PATTERN.match(name) for name in os.listdir(folder))
    frames = sorted(int(match.group(1)) for match in matches if match)
    return [frame for frame in frames if (Path(folder) / f"{state_file(frame)}.json").is_file()]


def read_sidecar(folder, frame):
    """Reads the file of write_sidecar. Raises NoCheckpoint if it is missing, CacheError if it is damaged."""
    remedy = "Delete it to resume from the checkpoint before it, or free the bake and bake again"
    sidecar = read_sealed(Path(folder) / f"{state_file(frame)}.json", remedy, SIDECAR)
    if sidecar is None:
        raise NoCheckpoint(f"{Path(folder) / state_file(frame)} has no {state_file(frame)}.json beside it")
    return sidecar


def write_sidecar(folder, frame, sidecar):
    """Writes state_NNNN.json. state_NNNN must be written after it, which completes the checkpoint."""
    write_sealed(Path(folder) / f"{state_file(frame)}.json", sidecar)


def lines_until(folder, frame, sidecar):
    """The journal's Lines, with their poses, up to the checkpoint of a frame. Raises CacheError if they are damaged."""
    end = LineEnd(**sidecar["end"])
    lines = read_lines(folder, with_poses=True, until=end)
    if not lines.ends or lines.ends[-1] != end or lines.next_frame != frame + 1:
        raise CacheError(
            f"{Path(folder) / FRAMES} is missing or damaged before the checkpoint of frame {frame}: delete "
            f"{Path(folder) / state_file(frame)} to resume from the one before it, or free the bake and bake again"
        )
    return lines


def restore_manifest(folder):
    """Replaces a damaged manifest by the description in the journal, of an unfinished bake, if there is a checkpoint to
    resume from. Returns whether it was damaged. Raises CacheError otherwise."""
    try:
        read_head(folder)
        return False
    except CacheError:
        for frame in reversed(checkpoints(folder)):
            with contextlib.suppress(CacheError):
                header = lines_until(folder, frame, read_sidecar(folder, frame)).header
                shot = header["settings"]["snowfall"]
                listed = bake_files(shot["frame_start"], shot["frame_end"])
                write_manifest(folder, {**header, "files": listed, "complete": False})
                return True
        raise


def remove_checkpoint(folder, frame):
    """Removes a checkpoint, the state first, so that a crash does not leave one that looks complete."""
    for name in (state_file(frame), f"{state_file(frame)}.json"):
        with contextlib.suppress(FileNotFoundError):
            (Path(folder) / name).unlink()


def remove_irregular_checkpoints(folder, frame_start, interval, before):
    """Removes the checkpoints before frame ``before`` that are not at a multiple of the interval."""
    for frame in checkpoints(folder):
        if frame < before and (frame - frame_start + 1) % interval:
            remove_checkpoint(folder, frame)


def is_foreign(folder):
    """Whether the folder is not from a bake: a link, or files without a manifest."""
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
    """Paths of the files in a receiver's folder that its manifest lists, the manifest last, including temporary files
    of a killed bake and Cycles' copies of images, but no links. Empty without a manifest."""
    folder = Path(folder)
    manifest = read_any_head(folder)
    if manifest is None:
        return []
    is_listed = listing(manifest)
    manifests = (MANIFEST, REMOVED_MANIFEST)
    # Those that know the others last.
    names = sorted(os.listdir(folder), key=lambda name: (name in manifests, name in (FRAMES, SURFACE), name))
    own = [folder / name for name in names if is_listed(finished_name(name)) or name == REMOVED_MANIFEST]
    textures = folder / TEXTURE_CACHE
    if textures.is_dir() and not textures.is_symlink():
        names = sorted(os.listdir(textures))
        own = [textures / name for name in names if is_listed(texture_source(name) or "")] + own
    return [path for path in own if is_regular(path)]


def clear(folder, kept=()):
    """Removes listed_files() but those with the names `kept`. Returns their number."""
    folder = Path(folder)
    listed = [path for path in listed_files(folder) if path.name not in kept]
    try:
        # After an interrupted removal the folder is not a bake any more, but still has the list.
        if (folder / MANIFEST) in listed:
            os.replace(folder / MANIFEST, folder / REMOVED_MANIFEST)
        for path in listed:
            path = folder / REMOVED_MANIFEST if path == folder / MANIFEST else path
            path.unlink(missing_ok=True)
    except OSError as error:
        raise failed(error.filename, "removed", error) from error
    with contextlib.suppress(OSError):
        (folder / TEXTURE_CACHE).rmdir()
    return len(listed)


def remove_stray_files(folder):
    """Removes incomplete files of a killed bake: temporary files, and sidecars without a state."""
    folder = Path(folder)
    whole = set(checkpoints(folder))
    for name in os.listdir(folder):
        match = STATE_PATTERN.match(name.removesuffix(".json"))
        half = finished_name(name) != name and is_bake_file(finished_name(name))
        if half or (match and int(match.group(1)) not in whole):
            with contextlib.suppress(FileNotFoundError):
                (folder / name).unlink()


def remove_frames_after(folder, frame):
    """Removes the frames after a checkpoint: the resumed bake writes them again, and a folder never has frames of two
    scenes."""
    for name in os.listdir(folder):
        match = FRAME_PATTERN.match(name)
        if match and int(match.group(1)) > frame:
            (Path(folder) / name).unlink()


def baked_frames(folder, kind="height"):
    """Frames that have a map of a kind, ascending."""
    try:
        with os.scandir(folder) as entries:
            names = [entry.name for entry in entries if entry.is_file()]
    except OSError:
        return []
    matches = (re.match(rf"{kind}_(\d{{4,7}})\.(?:exr|ply)$", name) for name in names)
    return sorted(int(match.group(1)) for match in matches if match)
