# SPDX-License-Identifier: GPL-3.0-or-later
"""The log of a bake: times and the engine, in a separate file, so that equal bakes give equal bytes. No ``bpy``."""

import contextlib
import datetime
import os
import socket

from ..base.names import safe_name
from ..cache.errors import failed
from ..cache.files import LOGS, make_folder


@contextlib.contextmanager
def open_log(root):
    """Yields a function that writes a line with the time to <root>/logs/<time>-<host>-<process>.log."""
    folder = root / LOGS
    make_folder(folder)
    stamp = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%S")
    path = folder / f"{stamp}-{safe_name(socket.gethostname())}-{os.getpid()}.log"
    with contextlib.ExitStack() as stack:
        try:
            stream = stack.enter_context(open(path, "a", encoding="utf-8"))
        except OSError as error:
            raise failed(path, "written", error) from error

        def log(line):
            with contextlib.suppress(OSError):  # the writer of the maps reports a full disk
                stream.write(f"{datetime.datetime.now(datetime.timezone.utc).isoformat()} {line}\n")
                stream.flush()

        yield log
