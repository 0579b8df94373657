# SPDX-License-Identifier: GPL-3.0-or-later
"""The locks that prevent two bakes from writing to the same receiver's folder. No ``bpy``.

Several bakes may fill one version, each its own receivers. A bake holds one file for all of them, ``lock-<digits>`` in
the version's folder, with its process and the names of the receivers' folders. The file ``lock`` is held only while a
bake compares its receivers with those of the other bakes. The system releases both with the process, so a killed bake
blocks nobody, and the next one removes its file.
"""

import contextlib
import os
import socket
import stat
import time
import uuid
from pathlib import Path

from .errors import CacheBusy, CacheError, LockLost, failed
from .files import LOCK, LOCK_PATTERN, make_folder

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt

# Windows forbids reading bytes that another process has locked, so lock a byte far behind the text.
_LOCKED_BYTE = 1 << 30
# A link is not followed, and a pipe does not wait.
_FLAGS = os.O_RDWR | os.O_CREAT
for _name in ("O_BINARY", "O_NOFOLLOW", "O_NONBLOCK"):
    _FLAGS |= getattr(os, _name, 0)
# Comparing thousands of receivers takes less than a second.
GATE_SECONDS = 30.0
# Longer than the names of all receivers' folders of a scene.
_MAX_TEXT = 1 << 26


def _try_lock(descriptor):
    try:
        if fcntl:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            os.lseek(descriptor, _LOCKED_BYTE, os.SEEK_SET)
            try:
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            finally:
                os.lseek(descriptor, 0, os.SEEK_SET)
    except OSError:
        return False
    return True


def _open(path, flags=_FLAGS):
    """The descriptor of a lock file. Raises CacheError if something else has its name."""
    try:
        descriptor = os.open(path, flags, 0o666)
    except FileNotFoundError:
        raise
    except OSError as error:
        if path.is_symlink():
            raise CacheError(f"{path} is a link, not the lock of a bake: remove it") from error
        raise failed(path, "opened", error) from error
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise CacheError(f"{path} is not the lock of a bake: remove it")
    return descriptor


def _is_at(path, descriptor):
    try:
        return os.path.samestat(os.fstat(descriptor), os.lstat(path))
    except FileNotFoundError:
        return False


def _remove(path, descriptor):
    """Closes a locked file and removes it, unless another one has taken its place."""
    own = _is_at(path, descriptor)
    if not fcntl:  # Windows cannot remove open files. If another bake has opened it, it stays
        os.close(descriptor)
    if own:
        with contextlib.suppress(OSError):
            path.unlink()
    if fcntl:
        os.close(descriptor)


def _text(descriptor):
    os.lseek(descriptor, 0, os.SEEK_SET)
    pieces, left = [], _MAX_TEXT
    while left and (piece := os.read(descriptor, min(left, 1 << 20))):
        pieces.append(piece)
        left -= len(piece)
    return b"".join(pieces).decode(errors="replace")


@contextlib.contextmanager
def _gate(version):
    """Holds the version's ``lock``. Raises CacheBusy if another bake holds it for long."""
    path = Path(version) / LOCK
    until = time.monotonic() + GATE_SECONDS
    while True:
        make_folder(version)
        try:
            descriptor = _open(path)
        except FileNotFoundError:  # another bake has just removed the empty folder
            if time.monotonic() > until:
                raise
            continue
        # The former holder may have removed the file between open and lock; then other bakes see another file.
        if _try_lock(descriptor) and _is_at(path, descriptor):
            break
        os.close(descriptor)
        if time.monotonic() > until:
            raise CacheBusy(f"{path} is held by another bake: wait for it, or stop it")
        time.sleep(0.005)
    try:
        yield
    finally:
        _remove(path, descriptor)


def _locks(version):
    """Paths of the lock files of the bakes in a version."""
    try:
        return [Path(version) / name for name in sorted(os.listdir(version)) if LOCK_PATTERN.match(name)]
    except (FileNotFoundError, NotADirectoryError):
        return []


def _compare(version, keys):
    """Raises CacheBusy if another bake writes one of the receivers; removes the files of killed bakes."""
    for path in _locks(version):
        try:
            descriptor = _open(path, _FLAGS & ~os.O_CREAT)
        except FileNotFoundError:
            continue
        if _try_lock(descriptor):
            _remove(path, descriptor)
            continue
        try:
            holder, *lines = _text(descriptor).splitlines() or [""]
        finally:
            os.close(descriptor)
        taken = sorted(keys & set(lines))
        if taken:
            raise CacheBusy(
                f"{taken[0]} is being baked by {holder or 'another process'}: wait for it, or stop it ({path})"
            )


class BakeLock:
    """The lock that a bake holds on receivers' folders of a version."""

    def __init__(self, version, keys):
        self._path = Path(version) / f"{LOCK}-{uuid.uuid4().hex[:8]}"
        self._descriptor = _open(self._path, _FLAGS | os.O_EXCL)
        self._head = f"process {os.getpid()} on {socket.gethostname()}\n{uuid.uuid4()}\n".encode()
        try:
            if not _try_lock(self._descriptor):
                raise CacheError(f"{self._path} cannot be locked: choose a cache folder on another disk")
            text = memoryview(self._head + "".join(f"{key}\n" for key in sorted(keys)).encode())
            while text:
                text = text[os.write(self._descriptor, text) :]
        except BaseException as error:
            _remove(self._path, self._descriptor)
            if isinstance(error, OSError):
                raise failed(self._path, "written", error) from error
            raise

    def check(self):
        """Raises LockLost if the lock file was removed or replaced, so that another bake may have cleared the folders.
        Must be called before each file is written."""
        if not self._is_held():
            raise LockLost(
                f"{self._path} was removed or replaced during this bake, so another bake may write there. This bake "
                "has stopped: make sure that no other bake runs, then resume or bake again"
            )

    def _is_held(self):
        try:
            # By its path: several threads check, and would move the place in one descriptor.
            with open(self._path, "rb") as stream:
                return _is_at(self._path, self._descriptor) and stream.read(len(self._head)) == self._head
        except FileNotFoundError:
            return False

    def release(self):
        if self._is_held():
            _remove(self._path, self._descriptor)
        else:
            os.close(self._descriptor)


@contextlib.contextmanager
def lock_receivers(version, keys):
    """Creates the folders `keys` of a version if needed and locks them for one bake. Yields the BakeLock. Raises
    CacheBusy with the holder's host and process."""
    folders = [Path(version) / key for key in keys]
    for place in (Path(version), *folders):
        if place.is_symlink():
            raise CacheError(f"{place} is a link, and a bake writes only into its own folders: remove it")
    with _gate(version):
        _compare(version, set(keys))
        lock = BakeLock(version, keys)
    try:
        for folder in folders:
            make_folder(folder)
        yield lock
    finally:
        lock.release()


def drop_dead_locks(version):
    """Removes the lock files of killed bakes. Those that are held, or cannot be removed, stay."""
    if _locks(version) or (Path(version) / LOCK).exists():
        with contextlib.suppress(CacheError, OSError), _gate(version):
            _compare(version, set())
