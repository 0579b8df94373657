# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs and writes maps and checkpoints beside the simulation, in a thread of its own. No ``bpy``."""

import queue
import threading
import time

# So many maps may wait; more would only fill memory when the disk is the slowest.
MAX_WAITING = 8


class WriteFailed(RuntimeError):
    """A map could not be written: full disk, folder gone. Names the file and the reason."""


class MapWriter:
    """``with MapWriter(native) as writer: writer.write(path, map)``.

    write() and flush() raise what went wrong with an earlier file (disk full, folder gone) as
    WriteFailed; after that nothing more is written. Leaving the block waits for the files.
    """

    def __init__(self, native):
        self._native = native
        self._queue = queue.Queue(MAX_WAITING)
        self._error = None
        self._busy = 0.0
        self._taken = 0.0
        self._thread = threading.Thread(target=self._work, name="snowbough-files", daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, kind, error, trace):
        self._queue.put(None)
        self._thread.join()
        if error is None:
            self._raise()

    def write(self, path, pixels):
        """Queues an EXR: (H, W) metres as float32, or (H, W, 3) normals -1..1 as half, encoded 0..1.
        The array must not be changed afterwards."""
        self._raise()
        self._queue.put((str(path), pixels))

    def call(self, work):
        """Queues work(), which writes files of its own; all maps queued before are on disk by then."""
        self._raise()
        self._queue.put(work)

    def take_seconds(self):
        """Seconds that the thread was busy since the last call."""
        busy = self._busy
        taken, self._taken = self._taken, busy
        return busy - taken

    def flush(self):
        """Waits until all queued files are on disk."""
        self._queue.join()
        self._raise()

    def _raise(self):
        if self._error is not None:
            raise self._error

    def _do(self, item):
        if callable(item):
            item()
            return
        path, pixels = item
        if pixels.ndim == 3:
            self._native.write_exr(path, pixels * 0.5 + 0.5, half=True)
        else:
            self._native.write_exr(path, pixels)

    def _work(self):
        while True:
            item = self._queue.get()
            try:
                if item is None:
                    return
                if self._error is None:
                    begun = time.perf_counter()
                    self._do(item)
                    self._busy += time.perf_counter() - begun
            except Exception as error:  # handed to the thread that bakes
                self._error = WriteFailed(f"{error}. What is done is kept: make room, then resume")
            finally:
                self._queue.task_done()
