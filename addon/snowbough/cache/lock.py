# SPDX-License-Identifier: GPL-3.0-or-later
"""The lock that keeps two bakes out of one receiver's folder. No ``bpy``."""

import contextlib
import os
import socket
from pathlib import Path

from .errors import CacheBusy, CacheError
from .files import LOCK, make_folder

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt


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
