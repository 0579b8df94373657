# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes into the preview's shader and between its stages. No ``bpy``: drawing hands it to Blender, which writes the
declarations that the files snow.*.glsl lack."""

from pathlib import Path

# By how much snow is drawn in front of its place: a few steps of a depth buffer of 24 bits.
DEPTH_BIAS = 4e-7

DEFINES = {"DEPTH_BIAS": f"{DEPTH_BIAS:.1e}"}
# (name, type in the shader, type and number of what is stored).
ATTRIBUTES = (("place", "VEC3", "F32", 3), ("normal", "VEC3", "F32", 3))
# Together at most 128 bytes.
CONSTANTS = (("MAT4", "view_projection"), ("VEC4", "light"))
VARYINGS = (("VEC3", "snow_normal"),)


def source(stage):
    """The text of a stage, vert or frag, without its declarations."""
    return (Path(__file__).parent / f"snow.{stage}.glsl").read_text(encoding="utf-8")
