# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference compiler accepts the live preview's shader with the declarations that Blender adds."""

import shutil
import subprocess

import pytest
from snowbough.preview import interface

GLSL = {"FLOAT": "float", "VEC2": "vec2", "VEC3": "vec3", "VEC4": "vec4", "MAT4": "mat4"}
GLSL.update({"IVEC2": "ivec2", "IVEC3": "ivec3"})
BYTES = {"FLOAT": 4, "VEC4": 16, "MAT4": 64}


def declarations(stage):
    """The text that Blender inserts before a stage's source."""
    yield "#version 450 core"
    for name, value in interface.INPUTS["defines"]:
        yield f"#define {name} {value}"
    for kind, name in interface.INPUTS["constants"]:
        yield f"uniform {GLSL[kind]} {name};"
    for location, (kind, name) in enumerate([interface.INPUTS["varying"]]):
        yield f"layout(location = {location}) {'out' if stage == 'vert' else 'in'} {GLSL[kind]} {name};"
    if stage == "vert":
        for location, (name, kind) in enumerate(interface.INPUTS["attributes"].items()):
            yield f"layout(location = {location}) in {GLSL[kind]} {name};"
    else:
        yield "layout(location = 0) out vec4 color;"


@pytest.mark.skipif(not shutil.which("glslangValidator"), reason="glslangValidator is not installed")
def test_both_stages_compile_and_fit_together(tmp_path):
    files = []
    for stage in ("vert", "frag"):
        files.append(tmp_path / f"snow.{stage}")
        files[-1].write_text("\n".join(declarations(stage)) + "\n" + interface.source(stage))
    done = subprocess.run(["glslangValidator", "-l", *files], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_constants_fit_into_what_every_driver_takes():
    assert sum(BYTES[kind] for kind, _ in interface.INPUTS["constants"]) <= 128
