# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of leaves: colour and mask in one image, without coloured fringes. No ``bpy``."""

import numpy as np


def resized(image, height, width):
    """image (H, W, channels) resized, with bilinear interpolation between texel centres."""

    def places(size, wanted):
        at = np.clip((np.arange(wanted) + 0.5) * size / wanted - 0.5, 0, size - 1)
        low = np.floor(at).astype(int)
        return low, np.minimum(low + 1, size - 1), (at - low).astype(np.float32)

    low, high, share = places(image.shape[0], height)
    image = image[low] * (1 - share)[:, None, None] + image[high] * share[:, None, None]
    low, high, share = places(image.shape[1], width)
    return image[:, low] * (1 - share)[:, None] + image[:, high] * share[:, None]


def limited(image, size):
    """image (H, W, channels) reduced to a maximum side of `size`, by means of whole blocks and then bilinearly.
    Unchanged if it is smaller or size is 0."""
    most = max(image.shape[:2])
    if not size or most <= size:
        return image
    step = most // size
    rows, columns = (side // step for side in image.shape[:2])
    if min(rows, columns) > 0:
        blocks = image[: rows * step, : columns * step].reshape(rows, step, columns, step, -1)
        image = blocks.mean(axis=(1, 3), dtype=np.float32)
    most = max(image.shape[:2])
    return (
        resized(image, *(max(1, round(side * size / most)) for side in image.shape[:2]))
        if most > size
        else image
    )


def _halved(image):
    """Sums of blocks of 2 x 2. The last row or column of an odd size is padded with 0."""
    padded = np.pad(image, ((0, image.shape[0] % 2), (0, image.shape[1] % 2), (0, 0)))
    return padded[::2, ::2] + padded[1::2, ::2] + padded[::2, 1::2] + padded[1::2, 1::2]


def filled(color, alpha):
    """color (H, W, 3) with hidden texels (alpha up to 0.5) filled from their surroundings. Mipmaps mix hidden and
    visible texels, so a white background would appear as a fringe around each leaf.

    Source: S. J. Gortler and others, The Lumigraph, SIGGRAPH 1996, section 3.4 (pull and push).
    """
    weight = (alpha > 0.5).astype(np.float32)[..., None]
    levels = [(color * weight, weight)]
    while max(levels[-1][0].shape[:2]) > 1:
        levels.append(tuple(_halved(part) for part in levels[-1]))
    whole = levels[-1][0] / np.maximum(levels[-1][1], 1e-6)
    for part, weight in levels[-2::-1]:
        larger = np.repeat(np.repeat(whole, 2, axis=0), 2, axis=1)[: part.shape[0], : part.shape[1]]
        whole = np.where(weight > 0, part / np.maximum(weight, 1e-6), larger)
    return whole


def masked(color, alpha):
    """uint8 (H, W, 4) from color (h, w, 3) and alpha (h', w'), 0 to 1. The size is the larger of both."""
    height, width = (max(sizes) for sizes in zip(color.shape[:2], alpha.shape))
    alpha = resized(alpha[..., None], height, width)[..., 0]
    color = filled(resized(color, height, width), alpha)
    both = np.concatenate([color, alpha[..., None]], axis=2)
    return np.rint(np.clip(both, 0.0, 1.0) * 255.0).astype(np.uint8)
