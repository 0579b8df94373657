# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests of faults."""

import os
import sys
import tempfile
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import shot  # noqa: E402


@pytest.fixture(scope="module")
def memory_folder():
    """A folder in main memory if there is one: a bake waits for the disk at each file."""
    place = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="snowbough-faults-", dir=place) as folder:
        yield Path(folder)


@pytest.fixture(scope="module")
def whole(memory_folder):
    """The bytes of a bake that was never disturbed."""
    shot.bake(memory_folder / "whole" / "cache")
    return shot.files_of(memory_folder / "whole" / "cache")
