# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the preview's shader and of its stages. No ``bpy``. The module drawing passes them to Blender, which
generates the declarations that are missing in the files snow.*.glsl."""

from pathlib import Path

# Offset of the drawn snow towards the viewer: a few steps of a depth buffer of 24 bits.
DEPTH_BIAS = 4e-7

# Arguments of base.view_drawing.make_shader.
INPUTS = {
    "attributes": {"place": "VEC3", "normal": "VEC3"},
    "varying": ("VEC3", "snow_normal"),
    "constants": (("MAT4", "view_projection"), ("VEC4", "light")),
    "defines": (("DEPTH_BIAS", f"{DEPTH_BIAS:.1e}"),),
}


def source(stage):
    """The source of a stage, vert or frag, without its declarations."""
    return (Path(__file__).parent / f"snow.{stage}.glsl").read_text(encoding="utf-8")
