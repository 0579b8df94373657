# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of the engine: ``scene.snowbough_realtime``."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty


class SnowboughRealtimeSettings(bpy.types.PropertyGroup):
    samples: IntProperty(
        name="Samples",
        description="Number of images averaged for a render. Higher values give smoother edges and slower renders",
        default=16,
        min=1,
        soft_max=64,
        max=4096,
    )
    target_pixels: FloatProperty(
        name="Detail",
        description="Target edge length of tessellated bark. Higher values give coarser bark and are faster (pixels)",
        default=4.0,
        min=0.5,
        soft_max=32.0,
    )
    shadow_resolution: EnumProperty(
        name="Shadows",
        description="Side of the sun's shadow map. Larger maps give sharper shadows and slower images (texels)",
        items=(
            ("0", "None", "No shadows"),
            ("512", "512 px", "Soft and coarse, for slow computers"),
            ("1024", "1024 px", "Enough for single trees"),
            ("2048", "2048 px", "Shows shadows of fine twigs in close views"),
            ("4096", "4096 px", "For whole gardens"),
        ),
        default="2048",
    )

    show_flakes: BoolProperty(
        name="Falling Snow",
        description="Show flakes in the air, with the direction and flutter of the scene's snow",
        default=False,
    )
    flake_rate: FloatProperty(
        name="Snowfall",
        description="Snowfall that the flakes represent, multiplied by the scene's Rate. Higher values show more "
        "flakes (metres per hour)",
        default=0.015,
        min=0.0,
        soft_max=0.2,
        precision=3,
    )
    flake_speed: FloatProperty(
        name="Speed",
        description="Speed of the falling flakes (metres per second)",
        default=1.2,
        min=0.05,
        soft_max=10.0,
        max=90.0,
    )
    flake_size: FloatProperty(
        name="Size",
        description="Radius of a flake. Higher values give larger and fewer flakes for the same snowfall (metres)",
        default=0.004,
        min=0.0005,
        soft_max=0.02,
        max=0.09,
        precision=4,
    )

    def as_render_settings(self):
        """Fields of the native RenderSettings."""
        return {"target_pixels": self.target_pixels, "shadow_resolution": int(self.shadow_resolution)}


def register():
    bpy.utils.register_class(SnowboughRealtimeSettings)
    bpy.types.Scene.snowbough_realtime = PointerProperty(type=SnowboughRealtimeSettings)


def unregister():
    del bpy.types.Scene.snowbough_realtime
    bpy.utils.unregister_class(SnowboughRealtimeSettings)
