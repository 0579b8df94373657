# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes into the preview's shader and between its stages. No ``bpy``: drawing hands it to Blender, which writes the
declarations that the files snow.*.glsl lack."""

from pathlib import Path

# Texels in a row of the textures that hold tables; a multiple of the four texels of an entry.
ROW = 2048
# By how much snow is drawn in front of its place: a few steps of a depth buffer of 24 bits.
DEPTH_BIAS = 4e-7

DEFINES = {"ROW": str(ROW), "DEPTH_BIAS": f"{DEPTH_BIAS:.1e}"}
# (name, type in the shader, type and number of what is stored).
ATTRIBUTES = (
    ("corners", "IVEC3", "I32", 3),
    ("corner_normals", "IVEC3", "I32", 3),
    ("weights", "VEC3", "F32", 3),
    ("uv", "VEC2", "F32", 2),
    ("tangents", "VEC4", "F32", 4),
    ("more", "IVEC2", "I32", 2),
)
# Textures that are fetched from: heights of one float a texel, the others tables of four.
TABLES = ("heights", "positions", "normals", "further")
# Together at most 128 bytes.
CONSTANTS = (("MAT4", "view_projection"), ("VEC4", "light"), ("FLOAT", "map_size"))
VARYINGS = (
    ("VEC3", "snow_place"),
    ("VEC3", "snow_normal"),
    ("FLOAT", "snow_thickness"),
    ("FLOAT", "snow_inside"),
)


def source(stage):
    """The text of a stage, vert or frag, without its declarations."""
    return (Path(__file__).parent / f"snow.{stage}.glsl").read_text(encoding="utf-8")
