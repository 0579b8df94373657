# SPDX-License-Identifier: GPL-3.0-or-later
"""``scene.snowbough``: one snowfall over one shot. :mod:`..bake.plan` turns these settings into snowfall."""

import math

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..base import compat
from ..base.map_kinds import ON_REQUEST
from ..base.names import MAX_FALL_ANGLE, SNOW_KINDS
from .objects import SnowboughReceiver
from .simulation import SnowProperties
from .surface import SURFACE_DETAILS, SurfaceProperties


def _range_getter(name):
    def get(self):
        return getattr(self.id_data, name) if self.use_scene_range else getattr(self, f"own_{name}")

    return get


def _range_setter(name):
    other = {"frame_start": "frame_end", "frame_end": "frame_start"}[name]

    def set_(self, value):
        if self.use_scene_range:
            setattr(self, f"own_{other}", getattr(self.id_data, other))
            self.use_scene_range = False
        setattr(self, f"own_{name}", value)

    return set_


def _own_frame(which, default):
    return IntProperty(
        name=f"Own {which} Frame",
        description=f"{which} frame if Scene Range is off (frames)",
        default=default,
        options={"HIDDEN"},
    )


def _depth(name, frame, default):
    return FloatProperty(
        name=name,
        description=f"Depth of the snow on open, level ground at the {frame} frame (metres)",
        default=default,
        min=0.0,
        soft_max=1.0,
        step=1,
        precision=3,
    )


class MapSwitches:
    """The switches of the maps on request."""

    __annotations__ = {
        kind.setting: BoolProperty(name=kind.label, description=kind.description) for kind in ON_REQUEST
    }


class SnowboughSceneSettings(SnowProperties, SurfaceProperties, MapSwitches, bpy.types.PropertyGroup):
    """``scene.snowbough``."""

    surface_detail: EnumProperty(
        name="Detail",
        description="Number of points of all snow surfaces in the scene together. More points show finer edges",
        items=SURFACE_DETAILS,
        default="DEFAULT",
    )

    cache_directory: StringProperty(
        name="Cache",
        description="Folder of the baked maps. // is the folder of the .blend",
        subtype="DIR_PATH",
        default="//snowbough_cache",
        options={"ANIMATABLE"} | compat.BLEND_RELATIVE,
    )
    cache_identity: StringProperty(
        name="Identity of the Cache",
        description="Separates the caches of .blend files that share a folder; set when the file is saved",
        options={"HIDDEN"},
    )
    cache_scene: StringProperty(
        name="Scene of the Cache",
        description="Name of the scene at its first bake; a renamed scene keeps its bakes",
        options={"HIDDEN"},
    )
    cache_used: StringProperty(
        name="Cache of the Last Bake",
        description="Absolute folder of the last bake; finds the bake after Save As",
        options={"HIDDEN"},
    )

    use_scene_range: BoolProperty(
        name="Scene Range",
        description="Let snow fall over the scene's frame range",
        default=True,
    )
    own_frame_start: _own_frame("First", default=1)
    own_frame_end: _own_frame("Last", default=250)
    frame_start: IntProperty(
        name="First Frame",
        description="First frame of the shot, from 0 on. Start Depth is the depth before its own snow falls (frames)",
        get=_range_getter("frame_start"),
        set=_range_setter("frame_start"),
    )
    frame_end: IntProperty(
        name="Last Frame",
        description="Last frame of the shot, where the snow reaches End Depth (frames)",
        get=_range_getter("frame_end"),
        set=_range_setter("frame_end"),
    )

    kind: EnumProperty(
        name="Kind of Snow",
        description="Look of the snow on objects that are added. Use Set Kind of Snow to change existing snow",
        items=SNOW_KINDS,
        default="FRESH",
    )
    start_depth: _depth("Start Depth", "first", default=0.0)
    end_depth: _depth("End Depth", "last", default=0.10)
    rate: FloatProperty(
        name="Rate",
        description="Strength of the snowfall over time, relative to other frames. Keyframe it to move snow between "
        "frames; the end depth stays the same",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    fall_angle: FloatProperty(
        name="Fall Angle",
        description="Angle between the falling snow and the vertical. Higher values give more slanted snow (degrees)",
        subtype="ANGLE",
        default=0.0,
        min=0.0,
        max=MAX_FALL_ANGLE,
    )
    bearing: FloatProperty(
        name="Bearing",
        description="Direction that the wind blows to, clockwise from +Y seen from above (degrees)",
        subtype="ANGLE",
        default=0.0,
        soft_min=-2 * math.pi,
        soft_max=2 * math.pi,
    )
    show_direction: BoolProperty(
        name="Show Direction",
        description="Show dials for the direction of the snow in the 3D view",
        default=True,
    )

    sun: PointerProperty(
        name="Sun",
        description="Sun lamp whose light thaws snow and dries water. It may move during the shot. Without one, all "
        "the thaw comes from the air",
        type=bpy.types.Object,
        poll=lambda self, lamp: lamp.type == "LIGHT" and lamp.data.type == "SUN",
    )

    texel_size: FloatProperty(
        name="Texel Size",
        description="Texel size of receivers with automatic resolution. Smaller values give larger maps (metres)",
        default=0.01,
        min=1e-5,
        soft_max=1.0,
        step=1,
        precision=4,
    )
    pixel_size: FloatProperty(
        name="Pixel Size",
        description="Pixel size of the grid that finds sheltered places. Smaller values give sharper shadows and "
        "slower bakes. 0 is automatic: the smallest texel size, coarser in large scenes (metres)",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        step=1,
        precision=4,
    )
    blur_radius: FloatProperty(
        name="Blur Radius",
        description="Smoothing of the baked maps, as a standard deviation. Higher values give rounder snow (texels)",
        default=2.0,
        min=0.0,
        soft_max=16.0,
    )
    substeps: IntProperty(
        name="Substeps",
        description="Number of poses of moving objects per frame. Higher values suit fast objects (poses per frame)",
        default=1,
        min=1,
        max=16,
    )
    directions: IntProperty(
        name="Directions",
        description="Minimum number of fall directions, within Flutter, over the whole shot. Higher values give "
        "smoother shadows in short shots and stills, and slower bakes (directions per shot)",
        default=64,
        min=1,
        soft_max=256,
    )
    checkpoint_interval: IntProperty(
        name="Checkpoint Every",
        description="Interval of checkpoints. A stopped bake resumes from the last checkpoint (frames)",
        default=10,
        min=1,
        soft_max=100,
    )

    receivers: CollectionProperty(
        name="Receivers",
        description="Objects that receive snow. All other rendered meshes only block it",
        type=SnowboughReceiver,
    )
    active_receiver: IntProperty(
        name="Active Receiver",
        description="Index of the selected receiver",
        options={"HIDDEN"},
    )


def register():
    bpy.utils.register_class(SnowboughSceneSettings)
    bpy.types.Scene.snowbough = PointerProperty(type=SnowboughSceneSettings)


def unregister():
    del bpy.types.Scene.snowbough
    bpy.utils.unregister_class(SnowboughSceneSettings)
