# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files in memory, of 8 and 16 bits. No ``bpy``.

Source: W3C, Portable Network Graphics (PNG) Specification, third edition.
"""

import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
# Colour type by the number of channels: grey, grey and alpha, RGB, RGBA.
COLOR_TYPE = {1: 0, 2: 4, 3: 2, 4: 6}
# Each line is stored as its difference to the one above, which smooth images are short in.
FILTER_UP = 2


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def encode(samples):
    """The PNG file of samples (H, W) or (H, W, 1 to 4), uint8 or uint16; row 0 is the bottom one, as in all our
    images. Equal samples give equal bytes. Raises ValueError for anything else."""
    samples = np.asarray(samples)
    if samples.ndim == 2:
        samples = samples[..., None]
    if samples.ndim != 3 or samples.shape[2] not in COLOR_TYPE or samples.dtype not in (np.uint8, np.uint16):
        raise ValueError(
            f"a PNG is made of uint8 or uint16 (H, W, 1 to 4), not {samples.dtype} {samples.shape}"
        )
    height, width, channels = samples.shape
    lines = np.ascontiguousarray(samples[::-1], dtype=samples.dtype.newbyteorder(">"))
    lines = lines.reshape(height, -1).view(np.uint8)
    filtered = np.empty((height, 1 + lines.shape[1]), dtype=np.uint8)
    filtered[:, 0] = FILTER_UP
    filtered[:, 1:] = lines
    filtered[1:, 1:] -= lines[:-1]
    header = struct.pack(">IIBBBBB", width, height, 8 * samples.dtype.itemsize, COLOR_TYPE[channels], 0, 0, 0)
    packed = zlib.compress(filtered.tobytes(), 6)
    return SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", packed) + _chunk(b"IEND", b"")


def kind_of(data):
    """ "image/png" or "image/jpeg", as the first bytes say; None for what glTF does not take."""
    if data.startswith(SIGNATURE):
        return "image/png"
    return "image/jpeg" if data.startswith(b"\xff\xd8\xff") else None
