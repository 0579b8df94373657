# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes, packs and writes maps and checkpoints beside the simulation, in a thread of its own. No ``bpy``."""

import queue
import threading
import time

# So many maps may wait; more would only fill memory when the disk is the slowest.
MAX_WAITING = 8


class WriteFailed(RuntimeError):
    """A map could not be written: full disk, folder gone. Names the file and the reason."""


class MapWriter:
    """``with MapWriter() as writer: writer.call(work)``.

    call() and flush() raise what went wrong with earlier work: that a file could not be written (disk full,
    folder gone) as WriteFailed; after that nothing more is done. Leaving the block waits for all work.
    """

    def __init__(self):
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

    def call(self, work):
        """Queues work(), which makes and writes files; what was queued before is on disk by then."""
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

    def _work(self):
        while True:
            work = self._queue.get()
            try:
                if work is None:
                    return
                if self._error is None:
                    begun = time.perf_counter()
                    work()
                    self._busy += time.perf_counter() - begun
            except (OSError, RuntimeError) as error:  # both are handed to the thread that bakes
                self._error = WriteFailed(f"{error}. What is done is kept: make room, then resume")
            except Exception as error:
                self._error = error
            finally:
                del work  # and the map with it: the next one may be long in coming
                self._queue.task_done()
