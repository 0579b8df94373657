# SPDX-License-Identifier: GPL-3.0-or-later
"""One receiver's part of a simulation's state as a file: ``state_NNNN``. No ``bpy``.

A file a receiver, so that a bake that was split over several machines, or stopped, can go on with any
part of its receivers. Layout: the line ``SNOWBOUGH STATE 2``, a line of JSON (``resolution``,
``step_number``, ``mask_bytes``, and ``crc32`` of all that follows), 16 doubles of balance, then
``mask_bytes`` of a zlib-packed mask with a bit a texel, 1 where there is snow (row 0 = v 0, the first
texel is the highest bit), then the float32 heights of these texels; little endian. Heights hardly pack
any smaller: zlib would take twenty times as long for a tenth. No times and no names, so equal bakes are
equal bytes.
"""

import json
import zlib

import numpy as np

from .errors import CacheError
from .files import write_bytes

MAGIC = b"SNOWBOUGH STATE 2\n"
SUMS = 16


def write(path, step_number, own):
    """Writes a receiver's state, own: {"height": (H, H) float32, "sums": (16,) float64}.
    Raises CacheError."""
    sums = np.ascontiguousarray(own["sums"], dtype="<f8")
    heights = np.ascontiguousarray(own["height"], dtype="<f4").ravel()
    there = heights.view("<u4") != 0
    mask = zlib.compress(np.packbits(there), 1)
    content = sums.tobytes() + mask + heights[there].tobytes()
    header = {
        "resolution": len(own["height"]),
        "step_number": step_number,
        "mask_bytes": len(mask),
        "crc32": zlib.crc32(content),
    }
    write_bytes(path, MAGIC + json.dumps(header, sort_keys=True).encode() + b"\n" + content)


def read(path):
    """(step number, own) of write. Raises CacheError for a file that is missing or damaged."""
    try:
        with open(path, "rb") as stream:
            if stream.readline() != MAGIC:
                raise ValueError("it is no checkpoint of this version")
            header = json.loads(stream.readline())
            content = stream.read()
        if zlib.crc32(content) != header["crc32"]:
            raise ValueError("it is damaged")
        sums = np.frombuffer(content[: SUMS * 8], dtype="<f8")
        heights_at = SUMS * 8 + header["mask_bytes"]
        edge = header["resolution"]
        bits = np.frombuffer(zlib.decompress(content[SUMS * 8 : heights_at]), dtype=np.uint8)
        heights = np.zeros(edge * edge, dtype="<f4")
        heights[np.unpackbits(bits, count=edge * edge).astype(bool)] = np.frombuffer(
            content[heights_at:], dtype="<f4"
        )
        return header["step_number"], {"height": heights.reshape(edge, edge), "sums": sums}
    except (OSError, ValueError, KeyError, zlib.error) as error:
        raise CacheError(f"{path} cannot be read ({error}): free the bake, then bake again") from error
