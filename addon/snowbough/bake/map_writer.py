# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes, packs and writes maps and checkpoints in threads of its own, beside the simulation. No ``bpy``."""

import queue
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from ..cache.errors import InputsChanged, LockLost, with_remedy

# Limits of the queue, in tasks and in bytes of maps; a longer one would only fill memory if the disk is slow. All maps
# of one frame may wait, so that the next frame is simulated while they are written.
MAX_WAITING = 8
MAX_WAITING_BYTES = 256 << 20
# Maps made in parallel: the parts of one map that use a single thread overlap with the next map.
MAKERS = 2


def max_waiting(maps):
    """Maximum number of tasks in the queue of a bake that writes this many maps per frame."""
    return max(MAX_WAITING, maps)


class WriteFailed(RuntimeError):
    """A map could not be written, e.g. disk full or folder deleted. The message names file and reason."""


class MapWriter:
    """``with MapWriter() as writer: writer.call(write, make)``. maps: number of maps of a frame.

    call() and flush() raise the error of earlier work: WriteFailed if a file could not be written (disk full, folder
    deleted). After an error no more work is done. Leaving the block waits for all work.
    """

    def __init__(self, maps=1):
        self._queue = queue.Queue(max_waiting(maps))
        self._waiting_bytes = 0
        self._less_waits = threading.Condition()
        self._error = None
        self._busy = 0.0
        self._busy_before = 0.0
        self._makers = ThreadPoolExecutor(MAKERS, "snowbough-maps")
        self._thread = threading.Thread(target=self._work, name="snowbough-files", daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, kind, error, trace):
        self._queue.put(None)
        self._thread.join()
        self._makers.shutdown()
        if error is None:
            self._raise()

    def call(self, write, make=None, size=0):
        """Queues write(), which writes files after those queued before it. make() computes its argument, of `size`
        bytes, in parallel to other maps."""
        self._raise()
        with self._less_waits:
            self._less_waits.wait_for(
                lambda: not self._waiting_bytes or self._waiting_bytes + size <= MAX_WAITING_BYTES
            )
            self._waiting_bytes += size
        self._queue.put((write, self._makers.submit(make) if make else None, size))

    def busy_since_last_call(self):
        """Seconds of work of the writing thread since the last call."""
        busy = self._busy
        before, self._busy_before = self._busy_before, busy
        return busy - before

    def flush(self):
        """Waits until all queued files are on disk."""
        self._queue.join()
        self._raise()

    def _raise(self):
        if self._error is not None:
            raise self._error

    def _work(self):
        while (task := self._queue.get()) is not None:
            write, made, size = task
            try:
                if self._error is None:
                    given = () if made is None else (made.result(),)
                    begun = time.perf_counter()
                    write(*given)
                    self._busy += time.perf_counter() - begun
                elif made is not None:
                    made.cancel()
            except (LockLost, InputsChanged) as error:
                self._error = error
            except (OSError, RuntimeError) as error:  # reported by call() and flush() in the baking thread
                self._error = WriteFailed(with_remedy(error))
            except Exception as error:
                self._error = error
            finally:
                task = write = made = given = None  # release the map; the next one may take long
                with self._less_waits:
                    self._waiting_bytes -= size
                    self._less_waits.notify()
                self._queue.task_done()
