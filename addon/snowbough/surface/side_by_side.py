# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the surfaces of several receivers in parallel. No ``bpy``.

A small receiver uses only one core, because most of its work cannot be parallelised.
"""

import operator
import os
import time
from concurrent.futures import ThreadPoolExecutor, wait

# Maximum number of threads. Each has the maps of one receiver in memory.
MAX_WORKERS = 4
POLL_SECONDS = 0.05


def workers():
    """Number of threads that work on the surfaces of many receivers."""
    return min(MAX_WORKERS, max(2, os.cpu_count() or 1))


def for_each(items, work):
    """The results of work(item), in order. For work that waits for the disk, or that runs without Python's lock. Raises
    the error of the first item that failed; items that have not started are skipped."""
    with ThreadPoolExecutor(MAX_WORKERS) as pool:
        return list(pool.map(work, items))


def run_side_by_side(jobs, progress, weights=None):
    """Calls each job(own_progress) in a worker thread. A job returns False if its own_progress returned False.

    progress(share of all jobs, 0 to 1) is called on the calling thread and returns whether to continue. weights: of the
    jobs in that share; None for equal ones. Returns False if a job was stopped. If jobs fail, raises the error of the
    first one in the order of the list; jobs that have not started are skipped.
    """
    shares = [0.0] * len(jobs)
    weights = weights if weights is not None and sum(weights) > 0.0 else [1.0] * len(jobs)
    stopped = False

    def run(index):
        nonlocal stopped
        if stopped:
            return False

        def own_progress(share):
            shares[index] = share
            return not stopped

        try:
            finished = jobs[index](own_progress)
        except BaseException:
            stopped = True
            raise
        shares[index] = 1.0
        return finished

    with ThreadPoolExecutor(workers()) as pool:
        running = [pool.submit(run, index) for index in range(len(jobs))]
        try:
            while wait(running, POLL_SECONDS).not_done:
                if not progress(sum(map(operator.mul, weights, shares)) / sum(weights)):
                    stopped = True
        finally:
            stopped = True
    return all([future.result() for future in running])


def takes_longer_than(seconds, clock=time.monotonic):
    """A function of the share of some work, 0 to 1, that is done: whether the work has taken this long, or will by the
    pace since the first share was done. Preparations before it count, but not for the pace."""
    begun, first = clock(), None

    def is_too_long(share):
        nonlocal first
        now = clock()
        if share <= 0.0:
            return now - begun > seconds
        first = first or (now, share)
        pace = (now - first[0]) / (share - first[1]) if share > first[1] else 0.0
        return now - begun + pace * (1.0 - share) > seconds

    return is_too_long
