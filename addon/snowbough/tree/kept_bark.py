# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of an imported tree's bark for its images, stored on the armature's data (``armature.snowbough_bark``) beside
the skeleton: their coordinates on the four-sided base that the real-time renderer draws, and the material of each quad.
"""

from typing import NamedTuple

import bpy
import numpy as np

from .objects import used_indices
from .skeleton_text import packed, unpacked

FORMAT = b"bark 1\n"


class KeptBark(NamedTuple):
    uv: np.ndarray
    """(Q, 4, 2) float32: texture coordinates of the export."""
    slots: np.ndarray
    """(Q,) int32: material slots of the finest bark object."""


def keep(armature, base, finest):
    """Stores a native_tree.BaseBark on a new armature. finest: the BarkMesh whose object has the slots. Stores nothing
    if the export has no coordinates: base is None then."""
    if base is None:
        return
    count = 1 + max(int(made.face_material.max(initial=-1)) for made in (base, finest))
    # As in objects.create_bark: slots for the used materials in order, faces without a material last.
    used = used_indices(finest.face_material % (count + 1))
    slots = np.searchsorted(used, base.face_material % (count + 1)).clip(max=len(used) - 1)
    data = slots.astype("<i4").tobytes() + np.ascontiguousarray(base.original_uv, "<f4").tobytes()
    armature.snowbough_bark = packed(FORMAT + data)


def kept(armature):
    """The KeptBark of an armature; None if it has none that can be read."""
    if not armature.snowbough_bark:
        return None
    try:
        data = unpacked(armature.snowbough_bark)
    except ValueError:
        return None
    data = data[len(FORMAT) :] if data.startswith(FORMAT) else b""
    quads, rest = divmod(len(data), 4 + 32)
    if not quads or rest:
        return None
    slots = np.frombuffer(data, "<i4", quads).astype(np.int32)
    uv = np.frombuffer(data, "<f4", offset=4 * quads).astype(np.float32)
    return KeptBark(uv.reshape(quads, 4, 2), slots)


def register():
    bpy.types.Armature.snowbough_bark = bpy.props.StringProperty(
        name="Bark",
        description="Coordinates of the bark's images on the base of the tree",
        options={"HIDDEN"},
    )


def unregister():
    del bpy.types.Armature.snowbough_bark
