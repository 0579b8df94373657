# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's own settings: ``scene.snowbough_realtime``."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty


class SnowboughRealtimeSettings(bpy.types.PropertyGroup):
    samples: IntProperty(
        name="Samples",
        description="Pictures that a rendered one is the mean of: more make edges and leaves smoother (no unit)",
        default=16,
        min=1,
        soft_max=64,
        max=4096,
    )
    target_pixels: FloatProperty(
        name="Detail",
        description="How long the edges of bark are that trees are subdivided into (pixels)",
        default=4.0,
        min=0.5,
        soft_max=32.0,
    )
    shadow_resolution: EnumProperty(
        name="Shadows",
        description="Texels a side of the sun's shadow map",
        items=(
            ("0", "None", "Nothing casts shadows"),
            ("512", "512 px", "Soft and coarse, for slow machines"),
            ("1024", "1024 px", "Enough for single trees"),
            ("2048", "2048 px", "Fine twigs cast shadows from near"),
            ("4096", "4096 px", "For whole gardens"),
        ),
        default="2048",
    )

    show_flakes: BoolProperty(
        name="Falling Snow",
        description="Show flakes in the air. They fall in the direction and flutter of the scene's snow",
        default=False,
    )
    flake_rate: FloatProperty(
        name="Snowfall",
        description="What the flakes in the air would lay in an hour, times the scene's Rate: how many there are "
        "(metres an hour)",
        default=0.015,
        min=0.0,
        soft_max=0.2,
        precision=3,
    )
    flake_speed: FloatProperty(
        name="Speed",
        description="How fast flakes fall (metres a second)",
        default=1.2,
        min=0.05,
        soft_max=10.0,
        max=90.0,
    )
    flake_size: FloatProperty(
        name="Size",
        description="Radius of a flake: the same snowfall in larger ones is fewer of them (metres)",
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
