# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares pictures of 128 pixels with those in tests/data/golden, so that a change of look fails a test.

SNOWBOUGH_GOLDEN=write replaces those pictures; look at them before they are committed.
"""

import os
from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).resolve().parents[1] / "data" / "golden"
SEEN = Path(__file__).resolve().parents[2] / "build" / "golden"

#: Between drivers, pixels at outlines and grains of snow differ a little.
MEAN = 1.0
"""Largest difference of a channel's mean over the object, of 255."""
PIXEL = 1.2
"""Largest mean difference of a pixel's channels over the object, of 255."""
OUTLINE = 0.995
"""Smallest share of the pixels of both objects that are in both."""


def difference(one, other):
    """(largest difference of a channel's mean, mean difference of pixels, IoU of outlines) of (H, W, 4) uint8."""
    drawn = [picture[..., 3] > 127 for picture in (one, other)]
    either = drawn[0] | drawn[1]
    apart = one[either][:, :3].astype(float) - other[either][:, :3]
    return abs(apart.mean(axis=0)).max(), abs(apart).mean(), (drawn[0] & drawn[1]).sum() / either.sum()


def assert_looks_like(name, picture):
    """picture: (128, 128, 4) uint8, row 0 at the top, alpha 255 in drawn pixels."""
    path = FOLDER / f"{name}.png"
    if os.environ.get("SNOWBOUGH_GOLDEN") == "write":
        FOLDER.mkdir(exist_ok=True)
        Image.fromarray(picture).save(path, optimize=True)
    SEEN.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(SEEN / path.name)
    mean, pixel, outline = difference(picture, np.asarray(Image.open(path)))
    assert mean <= MEAN and pixel <= PIXEL and outline >= OUTLINE, (
        f"{SEEN / path.name} does not look like {path}: means differ by {mean:.2f}, pixels by {pixel:.2f}, "
        f"outlines agree by {outline:.4f}"
    )
