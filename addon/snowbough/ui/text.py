# SPDX-License-Identifier: GPL-3.0-or-later
"""Line wrapping of texts for panels and pop-ups. No ``bpy``."""


def wrapped(text, fits):
    """Splits a text into lines for panels and pop-ups, which do not wrap. fits(line) says whether a line fits; a word
    that does not fit, such as a path, is broken."""
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
