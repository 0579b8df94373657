# SPDX-License-Identifier: GPL-3.0-or-later
"""The mask of a receiver."""

import bpy
from bpy.props import BoolProperty, EnumProperty, PointerProperty, StringProperty

KINDS = (
    ("NONE", "None", "The whole surface takes snow"),
    ("GROUP", "Vertex Group", "The weights of a vertex group, painted in Weight Paint mode"),
    ("IMAGE", "Image", "The brightness of an image or an image sequence on a UV map"),
)


class MaskProperties:
    mask: EnumProperty(
        name="Mask",
        description="Scales the snow that falls and lies on this receiver: 0 keeps a place bare, 1 takes all snow. "
        "It may change over time: snow shrinks where the mask decreases",
        items=KINDS,
        default="NONE",
    )
    mask_group: StringProperty(name="Vertex Group", description="Vertex group whose weights are the mask")
    mask_image: PointerProperty(
        name="Image",
        description="Image whose brightness is the mask. Of a sequence, each frame of the scene shows the file with "
        "its number",
        type=bpy.types.Image,
    )
    mask_uv_map: StringProperty(
        name="UV Map",
        description="UV map on which the image lies, repeated beyond 0 to 1. If empty, the UV map that stores the snow",
    )
    mask_inverted: BoolProperty(
        name="Invert",
        description="Take snow where the mask is 0, and none where it is 1",
        default=False,
    )
