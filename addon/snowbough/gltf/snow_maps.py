# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked snow as textures: one frame or an atlas of several, heights as 16 bits with scale and offset. No ``bpy``.

Why PNG of 16 bits: every engine imports it, keeps all bits (glTF's own images are read with eight), and 65,535 steps
of a metre of snow are 15 micrometres each, far less than a shader can show. OpenEXR is there for engines and tools
that read it: then the numbers are metres as they are.
"""

import math

import numpy as np

STEPS = 65535
# Straight up in tangent space, as baked normal maps encode it.
FLAT = 0.5


def tile_layout(count):
    """(columns, rows) of an atlas of `count` frames: as square as it goes, rows no more than columns."""
    columns = math.ceil(math.sqrt(count))
    return columns, math.ceil(count / columns)


def shrunk(image, size):
    """image (S, S) or (S, S, channels) as means of blocks, `size` a side; as it is where it is not larger.

    Raises ValueError where `size` does not divide S: tiles would not lie on whole texels.
    """
    whole = len(image)
    if not size or size >= whole:
        return image
    if whole % size:
        raise ValueError(f"a tile of {size} texels does not divide a map of {whole}: choose a power of two")
    step = whole // size
    blocks = image.reshape(size, step, size, step, *image.shape[2:])
    return blocks.mean(axis=(1, 3), dtype=np.float64).astype(np.float32)


def atlas(images, empty=0.0):
    """One image of equal ones: the first is at the top left, the next to its right; row 0 is the bottom one, as in
    each of them. Tiles that are left over hold `empty`."""
    columns, rows = tile_layout(len(images))
    height, width = images[0].shape[:2]
    whole = np.full((rows * height, columns * width, *images[0].shape[2:]), empty, dtype=np.float32)
    for index, image in enumerate(images):
        if image.shape != images[0].shape:
            raise ValueError(f"frames of {len(images[0])} and {len(image)} texels do not go into one atlas")
        top = rows - 1 - index // columns
        left = index % columns
        whole[top * height : (top + 1) * height, left * width : (left + 1) * width] = image
    return whole


def quantised(heights):
    """(samples uint16, scale, offset): height = offset + scale * sample / 65535, in metres.

    0 is one of the steps, so that bare ground stays bare; heights on the back are negative and stay so.
    """
    low, high = min(float(heights.min()), 0.0), max(float(heights.max()), 0.0)
    if high == low:
        return np.zeros(heights.shape, dtype=np.uint16), 1.0, 0.0
    below = math.ceil(-low / (high - low) * STEPS)
    # The step that keeps both ends inside with a whole number of steps below 0.
    step = max(high / max(STEPS - below, 1), -low / below if below else 0.0)
    samples = np.clip(np.rint(heights.astype(np.float64) / step) + below, 0, STEPS)
    return samples.astype(np.uint16), step * STEPS, 0.0 - step * below


def eight_bits(encoded):
    """uint8 of normals that are encoded as 0.5 + 0.5 n, each made of unit length again first."""
    normal = encoded.astype(np.float64) * 2.0 - 1.0
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.where(length > 1e-6, normal / np.maximum(length, 1e-6), (0.0, 0.0, 1.0))
    return np.rint((0.5 + 0.5 * normal) * 255.0).astype(np.uint8)
