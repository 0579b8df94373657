# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts broken into lines that fit where Blender does not wrap them. No ``bpy``."""


def wrapped(text, fits):
    """The lines of a text that panels and pop-ups show, which do not wrap by themselves.

    fits(line) says whether a line has room; a word that has none even by itself is broken, as paths have to be.
    """
    line = ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if line and not fits(longer):
            yield line
            longer = word
        while not fits(longer):
            length = next((length for length in range(len(longer) - 1, 1, -1) if fits(longer[:length])), 1)
            yield longer[:length]
            longer = longer[length:]
        line = longer
    yield line
