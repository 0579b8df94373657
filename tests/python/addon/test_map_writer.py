# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps made beside each other are written in order (snowbough.bake.map_writer), without Blender."""

import threading

import pytest
from snowbough.bake import map_writer
from snowbough.cache.errors import LockLost

WAIT = 20.0


def test_two_maps_are_made_at_a_time_and_written_in_order():
    written, second_made = [], threading.Event()

    def first():
        assert second_made.wait(WAIT), "the second map waits for the first"
        return "first"

    def second():
        second_made.set()
        return "second"

    with map_writer.MapWriter() as writer:
        writer.call(written.append, first)
        writer.call(written.append, second)
        writer.call(lambda: written.append("checkpoint"))
        writer.flush()
        assert written == ["first", "second", "checkpoint"]


def test_a_map_that_cannot_be_made_stops_what_follows():
    written = []

    def fail():
        raise MemoryError("no room")

    with pytest.raises(MemoryError, match="no room"), map_writer.MapWriter() as writer:
        writer.call(written.append, fail)
        writer.call(lambda: written.append("later"))
        writer.flush()
    assert written == []


@pytest.mark.parametrize(
    "error, text",
    [
        (
            OSError("map.exr: No space left on device"),
            r"map\.exr: No space .* free disk space, then resume",
        ),
        (
            RuntimeError("cannot write '/c/height_0001.exr': No such file or directory"),
            "No such file.*The folder is gone: restore it and resume",
        ),
    ],
)
def test_a_full_disk_and_a_deleted_cache_say_what_to_do(error, text):
    def write():
        raise error

    with pytest.raises(map_writer.WriteFailed, match=text), map_writer.MapWriter() as writer:
        writer.call(write)
        writer.flush()


def test_a_lost_lock_stays_that():
    def write():
        raise LockLost("lock was removed")

    with pytest.raises(LockLost, match="^lock was removed$"), map_writer.MapWriter() as writer:
        writer.call(write)
        writer.flush()


def test_leaving_waits_for_all_and_tells_what_failed():
    written = []
    with map_writer.MapWriter() as writer:
        writer.call(written.append, lambda: 1)
    assert written == [1]
    with pytest.raises(map_writer.WriteFailed), map_writer.MapWriter() as writer:
        writer.call(lambda: (_ for _ in ()).throw(OSError("gone")))


def test_all_maps_of_a_frame_may_wait():
    go_on = threading.Event()

    def write():
        assert go_on.wait(WAIT), "the bake waits for the disk"

    with map_writer.MapWriter(maps=40) as writer:
        for _ in range(40):
            writer.call(write)
        go_on.set()


@pytest.mark.parametrize("size, most", [(1, map_writer.MAX_WAITING + 1), (map_writer.MAX_WAITING_BYTES, 1)])
def test_a_slow_disk_lets_the_bake_wait_with_few_maps_in_memory(size, most):
    writing, go_on, queued = threading.Event(), threading.Event(), []

    def write(*_):
        writing.set()
        assert go_on.wait(WAIT)

    def fill(writer):
        for number in range(map_writer.MAX_WAITING + 3):
            writer.call(write, lambda: None, size)
            queued.append(number)

    with map_writer.MapWriter() as writer:
        bake = threading.Thread(target=fill, args=(writer,))
        bake.start()
        assert writing.wait(WAIT)
        bake.join(0.3)
        assert bake.is_alive() and len(queued) == most
        go_on.set()
        bake.join(WAIT)
        assert len(queued) == map_writer.MAX_WAITING + 3
