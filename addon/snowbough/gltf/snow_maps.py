# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked snow as textures: one frame, or an atlas of several. Heights have 16 bits with scale and offset. No ``bpy``.

Reasons for 16-bit PNG: every engine imports it with all bits, while images inside glTF are read with eight bits; and
one of 65,535 steps in a metre of snow is 15 micrometres, which is not visible. OpenEXR is for engines and tools that
read it: its values are metres.
"""

import math

import numpy as np

STEPS = 65535
# Straight up in tangent space, as baked normal maps encode it.
FLAT = 0.5


def tile_layout(count):
    """(columns, rows) of an atlas of `count` frames: nearly square, with at most as many rows as columns."""
    columns = math.ceil(math.sqrt(count))
    return columns, math.ceil(count / columns)


def shrunk(image, size):
    """Reduces image (S, S) or (S, S, channels) to `size` by averaging blocks. Unchanged if S <= size or size is 0.

    Raises ValueError if `size` does not divide S.
    """
    whole = len(image)
    if not size or size >= whole:
        return image
    if whole % size:
        raise ValueError(
            f"the tile of {size} texels does not divide the map of {whole} texels: choose a power of two"
        )
    step = whole // size
    blocks = image.reshape(size, step, size, step, *image.shape[2:])
    return blocks.mean(axis=(1, 3), dtype=np.float64).astype(np.float32)


def atlas(images, empty=0.0):
    """Combines images of equal size: the first is at the top left, the next to its right. Row 0 is at the bottom in all
    images. Unused tiles have the value `empty`."""
    columns, rows = tile_layout(len(images))
    height, width = images[0].shape[:2]
    whole = np.full((rows * height, columns * width, *images[0].shape[2:]), empty, dtype=np.float32)
    for index, image in enumerate(images):
        if image.shape != images[0].shape:
            raise ValueError(
                f"frames of {len(images[0])} and {len(image)} texels do not fit into one atlas: bake again"
            )
        top = rows - 1 - index // columns
        left = index % columns
        whole[top * height : (top + 1) * height, left * width : (left + 1) * width] = image
    return whole


def quantised(heights):
    """(samples uint16, scale, offset): height = offset + scale * sample / 65535, in metres.

    0 is exactly a step, so that bare ground stays bare. Heights on the back of faces are negative and stay negative.
    """
    low, high = min(float(heights.min()), 0.0), max(float(heights.max()), 0.0)
    if high == low:
        return np.zeros(heights.shape, dtype=np.uint16), 1.0, 0.0
    below = math.ceil(-low / (high - low) * STEPS)
    # The smallest step for which both ends fit, with a whole number of steps below 0.
    step = max(high / max(STEPS - below, 1), -low / below if below else 0.0)
    samples = np.clip(np.rint(heights.astype(np.float64) / step) + below, 0, STEPS)
    return samples.astype(np.uint16), step * STEPS, 0.0 - step * below


def eight_bits(encoded):
    """uint8 of normals encoded as 0.5 + 0.5 n, after normalising them."""
    normal = encoded.astype(np.float64) * 2.0 - 1.0
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.where(length > 1e-6, normal / np.maximum(length, 1e-6), (0.0, 0.0, 1.0))
    return np.rint((0.5 + 0.5 * normal) * 255.0).astype(np.uint8)
