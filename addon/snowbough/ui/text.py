# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts for people: amounts, and lines that fit where Blender does not wrap them. No ``bpy``."""


def counted(number, noun):
    """``1 file``, ``1,204 files``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def sized(count):
    """Bytes as people read them: ``640 KiB``, ``3.2 GiB``."""
    for unit, size in (("GiB", 2**30), ("MiB", 2**20)):
        if count >= size:
            return f"{count / size:.1f} {unit}"
    return f"{-(-count // 1024)} KiB"


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
