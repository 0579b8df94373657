# SPDX-License-Identifier: GPL-3.0-or-later
"""The HLSL of docs/engines as GLSL, translated by glslangValidator and spirv-cross (packages glslang-tools and
spirv-cross), so that OpenGL can draw with it."""

import re
import subprocess
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "engines"
# Stage -> its function in tree.hlsl.
ENTRIES = {"vert": "vertex_main", "tesc": "hull_main", "tese": "domain_main", "frag": "pixel_main"}
# Registers of textures begin here as bindings, behind those of buffers.
TEXTURES = 10
# Direct3D has these in the hull shader.
PATCHES = ("layout(triangles) in", "layout(triangles, fractional_odd_spacing, ccw) in")
# Bindings of textures, and names of attributes, as in the GLSL.
BINDINGS = {1: 0, 2: 2}
ATTRIBUTES = {"level": "branch_level", "width": "limb_width"}


def as_glsl(stage, folder):
    """The text of a stage. folder: for temporary files."""
    binary = folder / f"{stage}.spv"
    options = ["--auto-map-bindings", "--auto-map-locations", "--shift-texture-binding", str(TEXTURES)]
    entry = ["-S", stage, "-e", ENTRIES[stage], "-o", str(binary)]
    subprocess.run(
        ["glslangValidator", "-D", "-V", *options, *entry, "tree.hlsl"],
        cwd=FOLDER,
        check=True,
        capture_output=True,
    )
    command = ["spirv-cross", str(binary), "--version", "450", "--stage", stage]
    text = subprocess.run(
        [*command, "--combined-samplers-inherit-bindings"], check=True, capture_output=True, text=True
    ).stdout
    for register, binding in BINDINGS.items():
        text = text.replace(f"binding = {TEXTURES + register})", f"binding = {binding})")
    text = re.sub(r"\bv_(\w+)\b", lambda named: ATTRIBUTES.get(named[1], named[1]), text)
    return text.replace(*PATCHES)
