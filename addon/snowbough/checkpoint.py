# SPDX-License-Identifier: GPL-3.0-or-later
"""One receiver's part of a simulation's state as a file: ``state_NNNN``. No ``bpy``.

A file a receiver, so that a bake that was split over several machines, or stopped, can go on with any
part of its receivers. Layout: the line ``SNOWBOUGH STATE 1``, a line of JSON (``resolution``,
``step_number``), 16 doubles of balance, then zlib-packed float32 heights, row 0 = v 0; little endian. No
times and no names, so equal bakes are equal bytes.
"""

import json
import zlib

import numpy as np

from . import cache

MAGIC = b"SNOWBOUGH STATE 1\n"
SUMS = 16


def write(path, step_number, own):
    """Writes a receiver's state, own: {"height": (H, H) float32, "sums": (16,) float64}.
    Raises cache.CacheError."""
    header = json.dumps({"resolution": len(own["height"]), "step_number": step_number}, sort_keys=True)
    sums = np.ascontiguousarray(own["sums"], dtype="<f8")
    heights = np.ascontiguousarray(own["height"], dtype="<f4")
    cache.write_bytes(path, MAGIC + header.encode() + b"\n" + sums.tobytes() + zlib.compress(heights, 1))


def read(path):
    """(step number, own) of write. Raises cache.CacheError for a file that is missing or damaged."""
    try:
        with open(path, "rb") as stream:
            if stream.readline() != MAGIC:
                raise ValueError("it is no checkpoint of this version")
            header = json.loads(stream.readline())
            sums = np.frombuffer(stream.read(SUMS * 8), dtype="<f8")
            heights = np.frombuffer(zlib.decompress(stream.read()), dtype="<f4")
        edge = header["resolution"]
        return header["step_number"], {"height": heights.reshape(edge, edge), "sums": sums}
    except (OSError, ValueError, KeyError, zlib.error) as error:
        raise cache.CacheError(f"{path} cannot be read ({error}): free the bake, then bake again") from error
