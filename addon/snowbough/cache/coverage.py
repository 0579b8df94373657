# SPDX-License-Identifier: GPL-3.0-or-later
"""A mask of where snow lay in any frame of a bake, for compositing and for custom materials. No ``bpy``."""

import base64
import zlib

import numpy as np


class Coverage:
    """A mask of resolution x resolution texels, row 0 = v 0."""

    def __init__(self, resolution, mask=None):
        self.mask = np.zeros((resolution, resolution), dtype=bool) if mask is None else mask
        # Reused for every map: allocating so much memory takes longer than filling it.
        self._shows = np.empty_like(self.mask)

    def add(self, height):
        """Marks the texels where a height map (H, W) in metres, negative on the back, shows snow."""
        np.not_equal(height, 0, out=self._shows)
        np.logical_or(self.mask, self._shows, out=self.mask)

    def pack(self):
        """The mask as text for a checkpoint; unpack reads it."""
        return base64.b64encode(zlib.compress(np.packbits(self.mask).tobytes(), 1)).decode()

    @classmethod
    def unpack(cls, resolution, text):
        """Reads the text of pack() for a map of that resolution. Raises ValueError for other texts, and never unpacks
        more than such a map takes."""
        size = (resolution * resolution + 7) // 8
        unpacker = zlib.decompressobj()
        try:
            packed = unpacker.decompress(base64.b64decode(text, validate=True), size + 1)
        except (ValueError, zlib.error) as error:
            raise ValueError(f"the coverage mask is damaged: {error}") from error
        if len(packed) != size or not unpacker.eof:
            raise ValueError(f"the coverage mask does not have {resolution} x {resolution} texels")
        mask = np.unpackbits(np.frombuffer(packed, dtype=np.uint8), count=resolution * resolution).astype(
            bool
        )
        return cls(resolution, mask.reshape(resolution, resolution))

    def write(self, native, path):
        """Writes ever_covered.exr: 1 where snow lay, else 0."""
        native.write_exr(str(path), self.mask.astype(np.float32))
