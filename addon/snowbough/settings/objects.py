# SPDX-License-Identifier: GPL-3.0-or-later
"""What belongs to one object: its line in the scene's list of receivers, ``object.snowbough`` and ``mesh.snowbough``.

The list of receivers belongs to the scene, because settings on linked or overridden objects get lost.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty

from .. import compat
from ..names import MAX_RESOLUTION
from .surface import SurfaceProperties

SIDES = (
    (
        "AUTO",
        "Automatic",
        "Both sides of parts that have no inside, such as leaves, cards, flags and bowls; the outside of all else",
    ),
    ("FRONT", "Front", "Only the front of faces, where their normals point to"),
    ("BOTH", "Both", "Whichever side faces the sky"),
)


class SnowboughReceiver(SurfaceProperties, bpy.types.PropertyGroup):
    """One entry of the scene's list: an object that snow accumulates on."""

    object: PointerProperty(
        name="Object",
        description="Mesh, or empty that instances a collection, that snow accumulates on",
        type=bpy.types.Object,
    )
    enabled: BoolProperty(
        name="Bake",
        description="Bake this receiver. Switched off it still shelters what is below it",
        default=True,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Width and height of the accumulation map (texels). "
        "0 chooses a power of two from 256 to 4096 from the surface area and the texel size",
        default=0,
        min=0,
        max=MAX_RESOLUTION,
    )
    uv_map: StringProperty(
        name="UV Map",
        description="UV map without overlaps that snow is stored in. "
        "Empty takes the map named 'snow', else the object's active one",
    )
    sides: EnumProperty(
        name="Sides",
        description="Which sides of its faces take snow",
        items=SIDES,
        default="AUTO",
    )
    own_surface: BoolProperty(
        name="Own Surface Sliders",
        description="Shape this receiver's snow by its own sliders and not by those of the scene",
        default=False,
    )
    folder: StringProperty(
        name="Baked Files",
        description="Folder of the newest finished bake of this receiver",
        subtype="DIR_PATH",
        options={"HIDDEN"} | compat.BLEND_RELATIVE,
    )
    baked_as: StringProperty(
        name="Baked As",
        description="Name that the object had when it was first baked: a renamed one keeps its bake by it",
        options={"HIDDEN"},
    )
    restore: StringProperty(
        name="Restore",
        description="What the object was like before Snowbough changed it, as JSON",
        options={"HIDDEN"},
    )


class SnowboughObjectSettings(bpy.types.PropertyGroup):
    """``object.snowbough``."""

    occlude: BoolProperty(
        name="Blocks Snow",
        description="This object keeps snow from what is below it",
        default=True,
    )
    is_shell: BoolProperty(
        name="Is Snow",
        description="A snow surface that Snowbough made; bakes leave it out",
        options={"HIDDEN"},
    )
    hidden_by_preview: StringProperty(
        name="Hidden by the Preview",
        description="What the live preview keeps out of sight while it runs, and how it was before, as JSON",
        options={"HIDDEN"},
    )


class SnowboughMeshData(bpy.types.PropertyGroup):
    """``mesh.snowbough``, of an imported tree's bark."""

    bark_vertices: IntProperty(
        name="Vertices of the Bark",
        description="As many as the import made: with others it has been edited (no unit)",
        options={"HIDDEN"},
    )


CLASSES = (SnowboughReceiver, SnowboughObjectSettings, SnowboughMeshData)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.snowbough = PointerProperty(type=SnowboughObjectSettings)
    bpy.types.Mesh.snowbough = PointerProperty(type=SnowboughMeshData)


def unregister():
    del bpy.types.Mesh.snowbough
    del bpy.types.Object.snowbough
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
