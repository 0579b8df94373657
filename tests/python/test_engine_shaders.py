# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaders of the guide for engines (docs/engines) compile, in GLSL and in HLSL, and agree with the exporter."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from engine_hlsl import ENTRIES

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "engines"
STAGES = ("vert", "tesc", "tese", "frag")
needs_glslang = pytest.mark.skipif(
    not shutil.which("glslangValidator"), reason="glslangValidator is not installed (package glslang-tools)"
)


def compiled(*arguments):
    done = subprocess.run(["glslangValidator", *arguments], cwd=FOLDER, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@needs_glslang
def test_the_glsl_stages_compile_and_link():
    # glslangValidator follows #include only when it links.
    code, said = compiled("-l", "-I.", *(f"tree.{stage}.glsl" for stage in STAGES))
    assert code == 0, said


@needs_glslang
@pytest.mark.parametrize("stage", STAGES)
def test_the_hlsl_stages_compile(stage, tmp_path):
    code, said = compiled(
        "-D", "-V", "-S", stage, "-e", ENTRIES[stage], "-o", str(tmp_path / "out.spv"), "tree.hlsl"
    )
    assert code == 0, said


@needs_glslang
def test_a_mistake_is_an_error(tmp_path):
    (tmp_path / "tree.tesc.glsl").write_text(
        (FOLDER / "tree.tesc.glsl").read_text().replace("edge_level(1, 2)", "nothing(1)")
    )
    assert compiled("-l", str(tmp_path / "tree.tesc.glsl"))[0] != 0


def test_the_look_of_snow_is_that_of_the_renderer():
    sys.path.insert(0, str(FOLDER.parents[1] / "tools"))
    import engine_rule

    for language in ("glsl", "hlsl"):
        written = (FOLDER / f"snow_rule.{language}").read_text()
        shading = (FOLDER / f"snow_shading.{language}").read_text()
        assert written == engine_rule.rule(language), "run tools/engine_rule.py"
        assert shading == engine_rule.shading(language), "run tools/engine_rule.py"
        for name in ("snow_edge", "thin_snow", "surface_relief", "sagging", "point_noise"):
            assert f" {name}(" in written
        for name in ("with_relief", "snow_cover", "lit_snow"):
            assert f" {name}(" in shading


def test_both_languages_have_the_same_inputs():
    glsl = "".join(
        (FOLDER / name).read_text()
        for name in ("snow_atlas.glsl", "view.glsl", "tree.tesc.glsl", "tree.frag.glsl")
    )
    hlsl = (FOLDER / "tree.hlsl").read_text()
    for block in ("SnowAtlas", "Tessellation", "View", "Light"):
        names = [
            re.findall(
                r"^\s+\w+ (\w+);",
                re.search(rf"(?:uniform|cbuffer) {block}[^{{]*{{(.*?)}}", text, re.DOTALL).group(1),
                re.MULTILINE,
            )
            for text in (glsl, hlsl)
        ]
        assert names[0] == names[1] != [], block


def test_the_formula_is_the_exporters():
    from snowbough.gltf.tree_file import FORMULA

    for text in ("engines.md", "engines/tree.tesc.glsl", "engines/tree.hlsl"):
        assert FORMULA in (FOLDER.parent / text).read_text(), text
