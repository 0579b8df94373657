# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree's four-sided base as text, which an armature keeps for the real-time renderer.

The renderer subdivides the base itself, on the GPU and as finely as each picture needs; from the mesh that Blender
has it could not be told any more what is a limb's wall, and how round the limb is. The text is base85 of a zip of
numpy arrays: those of the native tree_arrays.
"""

import base64
import binascii
import io
import zipfile

import numpy as np


def pack(arrays):
    """Text of a dict of numpy arrays and numbers."""
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return base64.b85encode(stream.getvalue()).decode("ascii")


def unpack(text):
    """What pack was given; None where the text is empty or damaged."""
    if not text:
        return None
    try:
        with np.load(io.BytesIO(base64.b85decode(text)), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, OSError, zipfile.BadZipFile, binascii.Error, EOFError):
        return None
    arrays["bone_count"] = int(arrays.get("bone_count", 0))
    return arrays
