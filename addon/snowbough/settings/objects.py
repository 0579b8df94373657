# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of one object: its entry in the scene's list of receivers, ``object.snowbough`` and ``mesh.snowbough``.

The scene holds the list, because settings on linked or overridden objects get lost.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..base import compat
from ..base.names import MAX_RESOLUTION
from .bending import SnowboughBending
from .masks import MaskProperties
from .pressing import PressProperties
from .surface import SurfaceProperties

SIDES = (
    (
        "AUTO",
        "Automatic",
        "Both sides of open parts, such as leaves, cards, flags and bowls; the outside of closed parts",
    ),
    ("POSITIVE", "Positive", "Only the side that the face normals point to"),
    ("BOTH", "Both", "The side that faces the sky, whichever it is"),
)


class SnowboughReceiver(SurfaceProperties, MaskProperties, bpy.types.PropertyGroup):
    """An entry of the scene's list: an object that receives snow."""

    object: PointerProperty(
        name="Object",
        description="Object that receives snow: a mesh, or an empty that instances a collection",
        type=bpy.types.Object,
    )
    enabled: BoolProperty(
        name="Bake",
        description="Bake snow on this receiver. If off, it still blocks snow from objects below it",
        default=True,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Width and height of the height map (texels). Higher values show finer detail and take more "
        "memory. 0 chooses a power of two from 256 to 4096, from the surface area and Texel Size",
        default=0,
        min=0,
        max=MAX_RESOLUTION,
    )
    uv_map: StringProperty(
        name="UV Map",
        description="UV map without overlaps that stores the snow. If empty, the map named 'snow', or else the "
        "active map",
    )
    sides: EnumProperty(
        name="Sides",
        description="Sides of the faces that receive snow",
        items=SIDES,
        default="AUTO",
    )
    shed_half_life: FloatProperty(
        name="Sheds in",
        description="Time of the shot in which half of the snow on leaves and boughs lets go and falls. 0 keeps it "
        "(seconds)",
        default=0.0,
        min=0.0,
        soft_max=60.0,
    )
    own_surface: BoolProperty(
        name="Own Surface Sliders",
        description="Shape the snow of this receiver with its own sliders instead of the scene's",
        default=False,
    )
    folder: StringProperty(
        name="Baked Files",
        description="Folder of the newest bake of this receiver",
        subtype="DIR_PATH",
        options={"HIDDEN"} | compat.BLEND_RELATIVE,
    )
    baked_as: StringProperty(
        name="Baked As",
        description="Name of the object at its first bake. A renamed object keeps its bake",
        options={"HIDDEN"},
    )
    restore: StringProperty(
        name="Restore",
        description="State of the object before Snowbough changed it, as JSON",
        options={"HIDDEN"},
    )


class SnowboughObjectSettings(PressProperties, bpy.types.PropertyGroup):
    """``object.snowbough``."""

    occlude: BoolProperty(
        name="Blocks Snow",
        description="Let this object block snow from objects below it",
        default=True,
    )
    bending: PointerProperty(
        name="Bend under Snow",
        description="Settings of an armature for Bend under Snow",
        type=SnowboughBending,
    )
    is_coarsened: BoolProperty(
        name="Coarsened Surface",
        description="This snow surface had too few points for its hems",
        options={"HIDDEN"},
    )
    is_shell: BoolProperty(
        name="Is Snow",
        description="This object is a snow surface made by Snowbough. Bakes ignore it",
        options={"HIDDEN"},
    )
    hidden_by_preview: StringProperty(
        name="Hidden by the Preview",
        description="Visibility of this object before the live preview hid it, as JSON",
        options={"HIDDEN"},
    )


class SnowboughMeshData(bpy.types.PropertyGroup):
    """``mesh.snowbough``, of an imported tree's bark."""

    bark_vertices: IntProperty(
        name="Vertices of the Bark",
        description="Number of vertices after the import. A different number means that the mesh was edited",
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
