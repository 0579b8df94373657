# SPDX-License-Identifier: GPL-3.0-or-later
"""Image files in memory, read and written by Blender. Arrays have row 0 at the bottom, as Blender's images."""

import tempfile
from pathlib import Path

import bpy
import numpy as np

from ..base import native

JPEG, PNG = "image/jpeg", "image/png"
# First bytes of the image files that glTF allows.
SIGNATURES = {b"\x89PNG\r\n\x1a\n": PNG, b"\xff\xd8\xff": JPEG}


def kind_of(data):
    """The MIME type of an image file; None for types that glTF does not allow."""
    return next((kind for start, kind in SIGNATURES.items() if data.startswith(start)), None)


def pixels_of(image):
    """float32 (H, W, 4) of an image, without colour conversion; None if the image is missing."""
    width, height = image.size
    if not width or not height:
        return None
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    given = flat.reshape(height, width, image.channels)
    whole = np.ones((height, width, 4), dtype=np.float32)
    whole[..., :3] = given[..., :3] if image.channels >= 3 else given[..., :1]
    if image.channels == 4:
        whole[..., 3] = given[..., 3]
    return whole


def decoded(data):
    """uint8 (H, W, 4) of an image file's bytes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image"
        path.write_bytes(data)
        image = bpy.data.images.load(str(path))
        image.alpha_mode = "CHANNEL_PACKED"
        pixels = np.rint(pixels_of(image) * 255.0).astype(np.uint8)
        bpy.data.images.remove(image)
    return pixels


def encoded(pixels):
    """(bytes, MIME type) of pixels (H, W, 3 or 4), 0 to 1, encoded: a JPEG file, or PNG with alpha."""
    pixels = np.clip(pixels, 0.0, 1.0)
    if pixels.shape[2] == 4:
        return native.load().encode_png(np.rint(pixels * 255.0).astype(np.uint8)), PNG
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("snowbough", width, height)
    whole = np.ones((height, width, 4), dtype=np.float32)
    whole[..., :3] = pixels
    image.pixels.foreach_set(whole.reshape(-1))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.jpg"
        image.file_format, image.filepath_raw = "JPEG", str(path)
        image.save()
        data = path.read_bytes()
    bpy.data.images.remove(image)
    return data, JPEG
