# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the preview's shader and of its stages. No ``bpy``. The module drawing passes them to Blender, which
generates the declarations that are missing in the files snow.*.glsl."""

from pathlib import Path

# Offset of the drawn snow towards the viewer: a few steps of a depth buffer of 24 bits.
DEPTH_BIAS = 4e-7

DEFINES = {"DEPTH_BIAS": f"{DEPTH_BIAS:.1e}"}
# (name, type in the shader, component type, number of components).
ATTRIBUTES = (("place", "VEC3", "F32", 3), ("normal", "VEC3", "F32", 3))
# At most 128 bytes together.
CONSTANTS = (("MAT4", "view_projection"), ("VEC4", "light"))
VARYINGS = (("VEC3", "snow_normal"),)


def source(stage):
    """The source of a stage, vert or frag, without its declarations."""
    return (Path(__file__).parent / f"snow.{stage}.glsl").read_text(encoding="utf-8")
