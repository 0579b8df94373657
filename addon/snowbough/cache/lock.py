# SPDX-License-Identifier: GPL-3.0-or-later
"""The lock that prevents two bakes from writing to the same receiver's folder. No ``bpy``."""

import contextlib
import os
import socket
import stat
import uuid
from pathlib import Path

from .errors import CacheBusy, CacheError, LockLost, failed
from .files import LOCK, make_folder

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


class FolderLock:
    """The lock that a bake holds on a receiver's folder."""

    def __init__(self, path, descriptor):
        self._path = path
        self._descriptor = descriptor
        self._text = f"process {os.getpid()} on {socket.gethostname()}\n{uuid.uuid4()}\n".encode()
        os.ftruncate(descriptor, 0)
        os.write(descriptor, self._text)

    def check(self):
        """Raises LockLost if the lock file was removed, or replaced by another bake, which has cleared the folder. Must
        be called before each file is written."""
        if not self._is_held():
            raise LockLost(
                f"{self._path} was removed or replaced during this bake, so another bake may write there. This bake "
                "has stopped: make sure that no other bake runs, then resume or bake again"
            )

    def _is_held(self):
        try:
            if not os.path.samestat(os.fstat(self._descriptor), os.stat(self._path)):
                return False
            return self._path.read_bytes() == self._text
        except FileNotFoundError:
            return False

    def release(self):
        held = self._is_held()
        if (
            not fcntl
        ):  # Windows cannot remove open files, so close it first. If the next bake has opened it, it stays
            os.close(self._descriptor)
        if held:
            with contextlib.suppress(OSError):
                self._path.unlink()
        if fcntl:
            os.close(self._descriptor)


@contextlib.contextmanager
def lock_folder(folder):
    """Creates a receiver's folder if needed and locks it for one bake. Yields the FolderLock. The system releases the
    lock with the process, so a killed bake does not block others. Raises CacheBusy with the holder's host and
    process."""
    for place in (Path(folder), Path(folder).parent):
        if place.is_symlink():
            raise CacheError(f"{place} is a link, and a bake writes only into its own folders: remove it")
    make_folder(folder)
    path = Path(folder) / LOCK
    while True:
        try:
            descriptor = os.open(path, _FLAGS, 0o666)
        except OSError as error:
            if path.is_symlink():
                raise CacheError(f"{path} is a link, not the lock of a bake: remove it") from error
            raise failed(path, "opened", error) from error
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            os.close(descriptor)
            raise CacheError(f"{path} is not the lock of a bake: remove it")
        if not _try_lock(descriptor):
            text = os.read(descriptor, 200).decode(errors="replace")
            os.close(descriptor)
            holder = text.partition("\n")[0].strip() or "another process"
            raise CacheBusy(
                f"{Path(folder).name} is being baked by {holder}: wait for it, or stop it ({path})"
            )
        # The former holder may have removed the file between open and lock; then other bakes see another file.
        try:
            same = os.path.samestat(os.fstat(descriptor), os.stat(path))
        except FileNotFoundError:
            same = False
        if same:
            break
        os.close(descriptor)
    try:
        lock = FolderLock(path, descriptor)
    except OSError as error:
        os.close(descriptor)
        raise failed(path, "written", error) from error
    try:
        yield lock
    finally:
        lock.release()


def drop_dead_lock(folder):
    """Removes the lock file of a bake that was killed after it finished this receiver. A lock that is held, or that
    cannot be removed, stays."""
    if (Path(folder) / LOCK).exists():
        with contextlib.suppress(CacheError), lock_folder(folder):
            pass
