#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/engines/snow_rule.glsl and .hlsl: the shape of snow, from the headers that Snowbough itself compiles.

    python3 tools/engine_rule.py

Engines need self-contained files. Limbs of trees are round and have no rims, so the code for rims is removed.
"""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEADERS = ("snow_noise.h", "snow_surface.h", "snow_point.h")
FOLDER = ROOT / "docs" / "engines"
# Code for rims: the text at which each part begins, and the text that follows it.
RIMS = (
    ("/// Constants of a point near a rim.", "// Away from rims."),
    ("// At rims; lengths", "/// 0 at `from`"),
    ("/// A quarter of a superellipse", "#ifndef SNOWBOUGH_GLSL\n}"),
)
HEAD = """// SPDX-License-Identifier: GPL-3.0-or-later
// How snow of a known thickness looks. Written by tools/engine_rule.py from shaders/lib: change it there. Metres;
// `up` is the upward part of a normal, whichever axis is up.
"""
HLSL_WORDS = (
    (r"\bvec([234])\(([^(),]+)\)", r"((float\1)(\2))"),
    (r"\bvec([234])\b", r"float\1"),
    (r"\bmix\b", "lerp"),
    (r"^const float", "static const float"),
    # A reserved word of HLSL.
    (r"\bpoint\b", "place_of"),
    (r"return (SnowEdge)\((.*?)\);", r"const \1 made = {\2};\n  return made;"),
)


def _without_rims(text):
    for begin, end in RIMS:
        if begin in text:
            text = text[: text.index(begin)] + text[text.index(end, text.index(begin)) :]
    return text


def _glsl(text):
    text = _without_rims(text)
    text = re.sub(r"^#ifndef SNOWBOUGH_GLSL\n.*?^#endif\n", "", text, flags=re.M | re.S)
    text = re.sub(r"^#(pragma once|include .*)\n", "", text, flags=re.M)
    text = text.replace("SNOWBOUGH_SHARED_FUNCTION ", "").replace("KERNEL_CONSTANT ", "const ")
    text = re.sub(r"KERNEL_CONST_REF\((\w+)\)", r"const \1", text)
    text = re.sub(r"KERNEL_MAKE\d\((\w+), ", r"\1(", text)
    assert "KERNEL" not in text and "SNOWBOUGH" not in text
    return re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"


def _hlsl(line):
    if line.lstrip().startswith("//"):
        return line
    for word, other in HLSL_WORDS:
        line = re.sub(word, other, line)
    return line


def rule(language):
    """The text of the rule, in GLSL or in HLSL."""
    text = "\n".join(_glsl((ROOT / "shaders" / "lib" / name).read_text()) for name in HEADERS)
    if language == "hlsl":
        text = "".join(map(_hlsl, text.splitlines(keepends=True)))
    return HEAD + "\n" + text


if __name__ == "__main__":
    for language in ("glsl", "hlsl"):
        (FOLDER / f"snow_rule.{language}").write_text(rule(language))
