# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake's files on disk: where they lie, which are whole, who may write them. No ``bpy``.

::

    <cache>/<scene>/v001/<safe object name>-<id>/height_0001.exr   metres
                                                 normal_0001.exr   only with normals
                                                 ever_covered.exr  1 where snow lay on any frame
                                                 inputs.json       fingerprints of what it was baked from
                                                 object.json       the manifest (read_manifest)
                                                 state_0010        checkpoint: the simulation's own file
                                                 state_0010.json   what belongs to it: inputs, coverage
                                                 lock              while a bake writes here
    <cache>/<scene>/logs/                                          times and the GPU, one file a bake

A version is a folder per receiver, so several machines fill one version together without a shared
file. A finished receiver is never written again: the next bake takes the next version. Every file is
written under a temporary name and renamed, and a checkpoint counts only when ``state_NNNN`` itself is
there, which is written last. The manifest holds no times, so equal bakes are equal bytes.

On resume a checkpoint that a stop left between the regular ones goes as soon as the bake has passed
it, so that the folder ends as if the bake had never stopped.
"""

import contextlib
import hashlib
import json
import os
import re
import shutil
import socket
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt

FORMAT = 1
MANIFEST = "object.json"
LOCK = "lock"
EVER_COVERED = "ever_covered.exr"
INPUTS = "inputs.json"
TEMPORARY_SUFFIX = ".tmp"

_VERSION = re.compile(r"v(\d{3,})$")
_STATE = re.compile(r"state_(\d{4,})$")
_FRAME = re.compile(r"(?:height|normal)_(\d{4,})\.exr$")


class CacheError(RuntimeError):
    """The cache cannot be written or read; says where and why."""


class CacheBusy(CacheError):
    """Another bake holds the lock."""


class CacheFinished(CacheError):
    """The receiver is finished in this version; nothing may write there."""


class NoCheckpoint(CacheError):
    """A bake was to start in the middle, and the checkpoint before it is not there."""


class InputsChanged(CacheError):
    """The bake's settings or scene are not those that the cache was baked from; says what changed."""


# ------------------------------------------------------------------------------------------------------
# Names


def safe_name(name):
    """A file name that every system takes: ASCII letters, digits, ``.``, ``_``, ``-``; at most 64."""
    cleaned = re.sub(r"[^A-Za-z0-9._-]", "_", name)[:64].lstrip(".-")
    return cleaned or "_"


def receiver_key(name, identity):
    """Folder name of a receiver: its safe name and eight digits that tell apart local and linked objects
    of one name and instances. identity: tuple of what is unique about it (library, instancer, index)."""
    text = "\0".join(str(part) for part in (name, *identity))
    return f"{safe_name(name)}-{hashlib.blake2b(text.encode(), digest_size=4).hexdigest()}"


def frame_file(kind, frame):
    return f"{kind}_{frame:04d}.exr"


def state_file(frame):
    return f"state_{frame:04d}"


# ------------------------------------------------------------------------------------------------------
# Small files, atomically


def write_bytes(path, data):
    """Writes all of data or nothing. Raises CacheError with path and reason."""
    temporary = Path(f"{path}{TEMPORARY_SUFFIX}")
    try:
        with open(temporary, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise CacheError(f"{path} could not be written: {error.strerror or error}") from error


def to_json(value):
    """The one spelling of value: equal values are equal bytes."""
    return json.dumps(value, sort_keys=True, indent=1, ensure_ascii=False).encode() + b"\n"


def digest(value):
    """16 bytes in hex of plain data (dicts, lists, numbers, texts)."""
    return hashlib.blake2b(to_json(value), digest_size=16).hexdigest()


def make_folder(path):
    """Makes a folder that can be written to. Raises CacheError with what to do."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
        probe = Path(path) / f".probe-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise CacheError(
            f"The cache folder {path} cannot be written: {error.strerror or error}. "
            "Choose another one in the Snowbough panel, or with --cache"
        ) from error


# ------------------------------------------------------------------------------------------------------
# One receiver's folder


def _read_json(path):
    try:
        return json.loads(Path(path).read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CacheError(f"{path} cannot be read ({error}). Free the bake, then bake again") from error


def read_manifest(folder):
    """object.json of a receiver's folder as a dict, or None where it is not there yet.

    Keys: ``format``, ``object``, ``library``, ``complete`` (all frames of the shot are there), ``hash``
    (of settings), ``settings`` (dict), ``frames`` (list of dicts with ``frame`` and its statistics).
    """
    manifest = _read_json(Path(folder) / MANIFEST)
    if manifest is not None and manifest.get("format") != FORMAT:
        raise CacheError(
            f"{folder} was written by another version of Snowbough (format {manifest.get('format')}, "
            f"this one writes {FORMAT}). Free the bake, then bake again"
        )
    return manifest


def write_manifest(folder, manifest):
    write_bytes(Path(folder) / MANIFEST, to_json({"format": FORMAT, **manifest}))


def write_inputs(folder, poses):
    """Fingerprints of all poses of a finished bake (scene_inputs), to tell later what has changed."""
    write_bytes(Path(folder) / INPUTS, to_json(poses))


def read_inputs(folder):
    """What write_inputs wrote, or None."""
    return _read_json(Path(folder) / INPUTS)


def checkpoints(folder):
    """Frames of the whole checkpoints in a folder, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (_STATE.match(name) for name in os.listdir(folder))
    frames = sorted(int(match.group(1)) for match in matches if match)
    return [frame for frame in frames if (Path(folder) / f"{state_file(frame)}.json").is_file()]


def read_sidecar(folder, frame):
    """What write_sidecar wrote. Raises NoCheckpoint where it is not there."""
    sidecar = _read_json(Path(folder) / f"{state_file(frame)}.json")
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
        or bool(_FRAME.match(name))
        or bool(_STATE.match(name.removesuffix(".json")))
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
        match = _STATE.match(name.removesuffix(".json"))
        if ".tmp" in name or (match and int(match.group(1)) not in whole):
            with contextlib.suppress(FileNotFoundError):
                (folder / name).unlink()


def remove_frames_after(folder, frame):
    """Removes frames that were written after a checkpoint: the resumed bake writes them again, and a
    folder never shows frames of two different scenes."""
    for name in os.listdir(folder):
        match = _FRAME.match(name)
        if match and int(match.group(1)) > frame:
            (Path(folder) / name).unlink()


# ------------------------------------------------------------------------------------------------------
# Versions


def scene_folder(cache, scene_name):
    return Path(cache) / safe_name(scene_name)


def versions(root):
    """Version numbers in a scene's folder, ascending."""
    if not Path(root).is_dir():
        return []
    matches = (_VERSION.match(name) for name in os.listdir(root))
    return sorted(int(match.group(1)) for match in matches if match)


def version_folder(root, number):
    return Path(root) / f"v{number:03d}"


def _manifests(folder):
    if not folder.is_dir():
        return {}
    found = {
        name: read_manifest(folder / name) for name in sorted(os.listdir(folder)) if (folder / name).is_dir()
    }
    return {name: manifest for name, manifest in found.items() if manifest is not None}


def choose_version(root, keys, shot_hash):
    """The version that a new bake of the receivers ``keys`` writes to.

    It is the newest one as long as none of them is finished there and all receivers that are there come
    from the same shot (``shot_hash``: all settings but the receiver's own), so that machines that share
    a shot fill one version; else the next one.
    """
    existing = versions(root)
    if not existing:
        return 1
    newest = existing[-1]
    manifests = _manifests(version_folder(root, newest))
    for name, manifest in manifests.items():
        if name in keys and manifest["complete"]:
            return newest + 1
        if name not in keys and manifest["settings"].get("shot") != shot_hash:
            return newest + 1
    return newest


def resumable_version(root, keys):
    """The newest version that holds or may hold an unfinished bake of any of ``keys``: (number, keys
    that are finished there). A version without any trace of them is not one; (None, []) without any."""
    for number in reversed(versions(root)):
        folder = version_folder(root, number)
        present = [key for key in keys if (folder / key).is_dir()]
        if present:
            finished = [key for key in present if (read_manifest(folder / key) or {}).get("complete")]
            return number, finished
    return None, []


def newest_finished(root, key):
    """Folder and manifest of the newest finished bake of a receiver, or (None, None)."""
    for number in reversed(versions(root)):
        folder = version_folder(root, number) / key
        manifest = read_manifest(folder)
        if manifest is not None and manifest["complete"]:
            return folder, manifest
    return None, None


def newest_with_frames(root, key):
    """Folder, manifest and sorted frames of the newest bake of a receiver that has any frame there;
    (None, None, []) where nothing was baked."""
    for number in reversed(versions(root)):
        folder = version_folder(root, number) / key
        manifest = read_manifest(folder)
        frames = baked_frames(folder)
        if manifest is not None and frames:
            return folder, manifest, frames
    return None, None, []


def baked_frames(folder):
    """Frames whose height map is there, ascending."""
    if not Path(folder).is_dir():
        return []
    matches = (re.match(r"height_(\d{4,})\.exr$", name) for name in os.listdir(folder))
    return sorted(int(match.group(1)) for match in matches if match)


def remove_empty_folders(root):
    """Removes empty receivers' and versions' folders, and the scene's where nothing is left."""
    root = Path(root)
    for number in versions(root):
        folder = version_folder(root, number)
        for child in [folder / name for name in os.listdir(folder)] + [folder]:
            with contextlib.suppress(OSError):
                child.rmdir()
    with contextlib.suppress(OSError):
        root.rmdir()


def free(root, keys=None):
    """Removes the bakes of receivers ``keys`` (None: all) in all versions of a scene's folder, and every
    folder that this leaves empty. Returns the number of files. Raises CacheBusy when one is baking."""
    root = Path(root)
    folders = [
        version_folder(root, number) / name
        for number in versions(root)
        for name in sorted(os.listdir(version_folder(root, number)))
        if (keys is None or name in keys) and (version_folder(root, number) / name).is_dir()
    ]
    removed = 0
    for folder in folders:
        with lock_folder(folder):
            removed += clear(folder, keep_lock=True)
    if keys is None:
        shutil.rmtree(root / "logs", ignore_errors=True)
    remove_empty_folders(root)
    return removed


# ------------------------------------------------------------------------------------------------------
# What changed


def describe_changes(before, after, prefix=""):
    """Differences between two dicts of settings as texts: ``end_depth: 0.1 -> 0.2``. Nested dicts are
    walked; long values are not printed."""
    changes = []
    for name in sorted(set(before) | set(after)):
        old, new = before.get(name), after.get(name)
        if old == new:
            continue
        label = f"{prefix}{name}"
        if isinstance(old, dict) and isinstance(new, dict):
            changes += describe_changes(old, new, f"{label}: ")
        elif old is None:
            changes.append(f"{label}: added")
        elif new is None:
            changes.append(f"{label}: removed")
        elif isinstance(old, list) or len(str(old)) + len(str(new)) > 80:
            changes.append(f"{label}: changed")
        else:
            changes.append(f"{label}: {old} -> {new}")
    return changes


# ------------------------------------------------------------------------------------------------------
# The lock


def _try_lock(descriptor):
    try:
        if fcntl:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    except OSError:
        return False
    return True


@contextlib.contextmanager
def lock_folder(folder):
    """Holds a receiver's folder (made if need be) for one bake. The system drops the lock with the
    process, so a killed bake blocks nobody. Raises CacheBusy with the holder's host and process."""
    make_folder(folder)
    path = Path(folder) / LOCK
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise CacheError(f"{path} could not be opened: {error.strerror}") from error
        if not _try_lock(descriptor):
            holder = os.read(descriptor, 200).decode(errors="replace").strip() or "another process"
            os.close(descriptor)
            raise CacheBusy(
                f"{Path(folder).name} is being baked by {holder}: wait for it, or stop it ({path})"
            )
        # Between open and lock the former holder may have removed the file: then ours is not the one
        # that others see.
        try:
            same = os.path.samestat(os.fstat(descriptor), os.stat(path))
        except FileNotFoundError:
            same = False
        if same:
            break
        os.close(descriptor)
    try:
        os.ftruncate(descriptor, 0)
        os.write(descriptor, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        yield path
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
        os.close(descriptor)


def drop_dead_lock(folder):
    """Removes the lock file that a bake left which was killed between finishing this receiver and its end.
    A lock that is held, or that cannot be removed, stays."""
    if (Path(folder) / LOCK).exists():
        with contextlib.suppress(CacheError), lock_folder(folder):
            pass
