#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/engines/snow_rule and snow_shading, .glsl and .hlsl: the shape of snow and its light, from the headers
that Snowbough compiles.

    python3 tools/engine_rule.py

Engines need self-contained files. Limbs of trees are round and have no rims, so the parts about rims are left out.
"""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEADERS = ("snow_noise.h", "snow_style.h", "snow_surface.h", "snow_point.h")
FOLDER = ROOT / "docs" / "engines"
# Parts about rims: the text at the start of each, and the text after its end.
RIMS = (
    ("/// Constants of a point near a rim.", "// Away from rims."),
    ("// At rims. Lengths", "/// Smooth step from 0"),
    ("/// A quarter of a superellipse", "#ifndef SNOWBOUGH_GLSL\n}"),
)
SHADING = ("relief.glsl", "snow_shading.glsl")
HEAD = """// SPDX-License-Identifier: GPL-3.0-or-later
// {}. tools/engine_rule.py writes this file from shaders/{}: change it there.
// Lengths are in metres; {}

"""
RULE_HEAD = HEAD.format(
    "The look of snow of a known thickness",
    "lib",
    "`up` is the upward component of a normal, whichever axis is up.",
)
SHADING_HEAD = (
    HEAD.format("The light of snow", "glsl", "z is up.")
    + """/// The camera and the light. The caller sets `view`.
struct SnowView {
  /// w: pixels that a metre covers at one metre's distance.
  vec4 eye;
  /// Unit vector towards the sun.
  vec3 sun_direction;
  /// Linear light of the sun, and from straight above and straight below.
  vec3 sun_color;
  vec3 sky_color;
  vec3 ground_color;
};
SnowView view;

/// Fraction of the sun's light that reaches a point: put your engine's shadows in its place.
float sunlit(vec3 position, vec3 normal, float reach) { return 1.0; }

"""
)
HLSL_WORDS = (
    (r"\bvec([234])\(([^(),]+)\)", r"((float\1)(\2))"),
    (r"\bvec([234])\b", r"float\1"),
    (r"\bivec3\b", "int3"),
    (r"\bmix\b", "lerp"),
    (r"\bdFd([xy])\b", r"dd\1"),
    (r"= float\[\w+\]\((.*)\);", r"= {\1};"),
    (r"^const (float|int)", r"static const \1"),
    (r"^SnowView view", "static SnowView view"),
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
    text = re.sub(r"SNOWBOUGH_SHARED_(FUNCTION|ROWS) ", "", text).replace("KERNEL_CONSTANT ", "const ")
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


def _written(head, text, language):
    text = head + text
    return text if language == "glsl" else "".join(map(_hlsl, text.splitlines(keepends=True)))


def rule(language):
    """The text of the rule, in GLSL or in HLSL."""
    texts = (_glsl((ROOT / "shaders" / "lib" / name).read_text()) for name in HEADERS)
    return _written(RULE_HEAD, "\n".join(texts), language)


def shading(language):
    """The text of the light on snow, in GLSL or in HLSL."""
    texts = (_glsl((ROOT / "shaders" / "glsl" / name).read_text()) for name in SHADING)
    return _written(SHADING_HEAD, "\n".join(texts), language)


if __name__ == "__main__":
    for language in ("glsl", "hlsl"):
        (FOLDER / f"snow_rule.{language}").write_text(rule(language))
        (FOLDER / f"snow_shading.{language}").write_text(shading(language))
