# SPDX-License-Identifier: GPL-3.0-or-later
"""The log of a bake: times and the engine, in a separate file, so that equal bakes give equal bytes. No ``bpy``."""

import contextlib
import datetime
import os
import socket

from ..base.names import safe_name
from ..cache.errors import CacheError, failed
from ..cache.files import LOGS, make_folder


def _open_own(path, flags):
    """Follows no link, and does not wait for a pipe."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0), 0o666)


@contextlib.contextmanager
def open_log(root):
    """Yields a function that writes a line with the time to <root>/logs/<time>-<host>-<process>.log."""
    folder = root / LOGS
    if folder.is_symlink():
        raise CacheError(f"{folder} is a link, and a bake writes only into its own folders: remove it")
    make_folder(folder)
    stamp = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%S")
    path = folder / f"{stamp}-{safe_name(socket.gethostname())}-{os.getpid()}.log"
    with contextlib.ExitStack() as stack:
        try:
            stream = stack.enter_context(open(path, "a", encoding="utf-8", opener=_open_own))
        except OSError as error:
            raise failed(path, "written", error) from error

        def log(line):
            with contextlib.suppress(OSError):  # the writer of the maps reports a full disk
                stream.write(f"{datetime.datetime.now(datetime.timezone.utc).isoformat()} {line}\n")
                stream.flush()

        yield log
