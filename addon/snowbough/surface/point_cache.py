# SPDX-License-Identifier: GPL-3.0-or-later
"""PC2 files: the positions of a mesh's points in each frame, the format of Blender's Mesh Cache modifier. No ``bpy``.

Layout: 12 bytes ``POINTCACHE2\\0``, int32 version 1, int32 points, float32 first sample, float32 samples per frame,
int32 samples, then float32 x, y, z of all points of all samples; all little-endian.
"""

import contextlib
import os
import struct
import uuid
from pathlib import Path

import numpy as np

from ..cache.errors import CacheError, failed
from ..cache.files import TEMPORARY_SUFFIX, open_regular, replace

_HEADER = struct.Struct("<12siiffi")
_MAGIC = b"POINTCACHE2\0"


class PointCacheWriter:
    """Writes a PC2 file atomically: ``with PointCacheWriter(path, points) as cache: ...; cache.publish()``.

    Raises CacheError with path and reason if the file cannot be written.
    """

    def __init__(self, path, points):
        self._path = Path(path)
        self._temporary = Path(f"{path}.{uuid.uuid4().hex[:8]}{TEMPORARY_SUFFIX}")
        self._points = points
        self.samples = 0
        self._write(_HEADER.pack(_MAGIC, 1, points, 0.0, 1.0, 0), "xb")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def add(self, positions):
        """Appends a sample, (points, 3)."""
        if positions.shape != (self._points, 3):
            raise ValueError(f"{self._path.name} has {self._points} points, not {positions.shape[0]}")
        self._write(np.ascontiguousarray(positions, dtype="<f4").data)
        self.samples += 1

    def publish(self):
        """Completes the file and moves it to its path."""
        with self._naming_errors():
            with open(self._temporary, "r+b") as stream:
                stream.write(_HEADER.pack(_MAGIC, 1, self._points, 0.0, 1.0, self.samples))
                stream.flush()
                os.fsync(stream.fileno())
            replace(self._temporary, self._path)

    def close(self):
        """Removes the file if it was not published. Does not raise OSError: it also runs after errors."""
        with contextlib.suppress(OSError):
            self._temporary.unlink()

    def _write(self, data, mode="ab"):
        # The file is open only here, since a bake writes those of thousands of receivers together.
        with self._naming_errors(), open(self._temporary, mode) as stream:
            stream.write(data)

    def _naming_errors(self):
        return _Naming(self)


class _Naming:
    """A context that converts an OSError to a CacheError with the path, and removes the temporary file."""

    def __init__(self, writer):
        self._writer = writer

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if isinstance(error, OSError):
            self._writer.close()
            raise failed(self._writer._path, "written", error) from error


def read_point_cache(path):
    """(samples, points, 3) float32 of a PC2 file, memory-mapped. Raises CacheError for a missing or damaged file."""
    path = Path(path)
    try:
        with open_regular(path) as stream:
            magic, version, points, _, _, samples = _HEADER.unpack(stream.read(_HEADER.size))
        wanted = _HEADER.size + 12 * points * samples
        if magic != _MAGIC or version != 1 or points < 0 or samples < 1 or path.stat().st_size != wanted:
            raise ValueError("it is not a PC2 file, or it is truncated")
        if not points:
            return np.zeros((samples, 0, 3), np.float32)
        return np.memmap(path, "<f4", "r", _HEADER.size, (samples, points, 3))
    except (OSError, ValueError, struct.error) as error:
        raise CacheError(f"{path} cannot be read ({error}): free the bake, then bake again") from error


def collapsed(points):
    """Whether all points are in one place, for each sample of points (samples, V, 3): compares sixteen of them."""
    if not points.shape[1]:
        return np.zeros(len(points), bool)
    some = points[:, :: max(1, points.shape[1] // 16)]
    return np.array([bool((sample == sample[0]).all()) for sample in some])
