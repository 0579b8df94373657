# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes and bounds of all that is read from the cache. No ``bpy``.

A checksum shows that a file is whole, not that Snowbough wrote it. Each value is compared with a shape before it is
used, so that no number can fill the memory and no content ends in an error without a message.
"""

import re

from ..base.map_kinds import MAP_KINDS, ON_REQUEST
from ..base.names import MAX_RESOLUTION
from .files import ONCE, frame_file

# Blender's last frame.
MAX_FRAME = 1_048_574
# Larger than any length, area or volume of a scene.
MAX_NUMBER = 1e12
MAX_TEXT = 1 << 16

_DIGEST = re.compile(r"[0-9a-f]{32}")


class Maybe:
    """A shape of an entry that may be missing."""

    def __init__(self, shape):
        self.shape = shape


def text(value):
    return isinstance(value, str) and len(value) <= MAX_TEXT and "\0" not in value and _is_unicode(value)


def _is_unicode(value):
    return value.isascii() or not re.search("[\ud800-\udfff]", value)


def long_text(value):
    return isinstance(value, str) and value.isascii()


def flag(value):
    return isinstance(value, bool)


def whole_to(most, least=0):
    return lambda value: isinstance(value, int) and not isinstance(value, bool) and least <= value <= most


def number_to(most, least=None):
    least = -most if least is None else least
    return lambda value: (
        isinstance(value, (int, float)) and not isinstance(value, bool) and least <= value <= most
    )


whole = whole_to((1 << 31) - 1)
frame = whole_to(MAX_FRAME)
number = number_to(MAX_NUMBER)
size = whole_to(1 << 53)


def either(*shapes):
    return lambda value: any(fits(value, shape) for shape in shapes)


def dict_of(shape, names=text):
    return lambda value: (
        isinstance(value, dict) and all(names(name) and fits(own, shape) for name, own in value.items())
    )


def list_of(shape, least, most):
    return lambda value: fits(value, [shape]) and least <= len(value) <= most


def one_of(*values):
    return lambda value: isinstance(value, str) and value in values


def nothing(value):
    return value is None


def digest(value):
    """A file's checksum."""
    return isinstance(value, str) and bool(_DIGEST.fullmatch(value))


def fits(value, shape):
    """Whether a value has a shape: a test; {key: shape} of keys, which are required unless the shape is a Maybe;
    [shape of all entries]; or (shapes of the entries, in order)."""
    if isinstance(shape, dict):
        return isinstance(value, dict) and all(
            key in value and fits(value[key], own)
            if not isinstance(own, Maybe)
            else key not in value or fits(value[key], own.shape)
            for key, own in shape.items()
        )
    if isinstance(shape, list):
        return isinstance(value, list) and all(fits(entry, shape[0]) for entry in value)
    if isinstance(shape, tuple):
        return isinstance(value, list) and len(value) == len(shape) and all(map(fits, value, shape))
    return shape(value)


def checksums(*names):
    """Of files with these names."""
    return dict_of(either(digest, one_of("")), one_of(*names))


# Fingerprints of poses as scene.inputs has them: [[pose, {label: prints or None}], ...].
POSES = [(text, dict_of(either(list_of(text, 3, 6), nothing)))]

_cosine = number_to(1.001)
_positive = number_to(MAX_NUMBER, 1e-12)

_FRAME = {
    "frame": frame,
    "depth": number,
    "volume": Maybe(number),
    "slid": Maybe(number),
    "landed": Maybe(number),
    **dict.fromkeys(("masked", "pressed", "cleared", "melted", "drifted"), Maybe(number)),
    **dict.fromkeys(("fallen", "stretched", "floor", "left", "air"), Maybe(number)),
    "highest": Maybe(number),
    "direction": Maybe((_cosine,) * 3),
    "to_world": Maybe((number,) * 16),
    "hidden": Maybe(flag),
    "checksums": Maybe(dict_of(either(digest, one_of("")))),
}


def FRAME(value):
    """A frame's entry of a manifest: the checksums are of its own maps, and its space has a volume."""
    return (
        fits(value, _FRAME)
        and value.get("checksums", {}).keys() <= {frame_file(kind.name, value["frame"]) for kind in MAP_KINDS}
        and ("to_world" in value) == ("direction" in value)
        and (bool(value.get("hidden")) or "to_world" not in value or _volume(value["to_world"]) > 0)
    )


def _volume(matrix):
    """Of the unit cube in the space of a (4, 4) matrix; 0 if its last row is not 0, 0, 0, 1."""
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = (matrix[k : k + 4] for k in (0, 4, 8))
    return abs(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) * (
        matrix[12:] == [0, 0, 0, 1]
    )


_PLAIN = either(flag, number, text, nothing, [number], [(frame, number)])

_SETTINGS = {
    "shot": text,
    "snowfall": {
        "frame_start": frame,
        "frame_end": frame,
        "flutter": number,
        "pixel_size": _positive,
        "totals": [number],
        **{kind.setting: Maybe(flag) for kind in ON_REQUEST},
    },
    "receiver": {"resolution": whole_to(MAX_RESOLUTION, 1), "uv_map": text},
}


def SETTINGS(value):
    """The settings of a bake. Others than those that are read again are plain values."""
    if not fits(value, _SETTINGS) or not all(
        dict_of(_PLAIN)(value[name]) for name in ("snowfall", "receiver")
    ):
        return False
    shot = value["snowfall"]
    return len(shot["totals"]) == shot["frame_end"] - shot["frame_start"] + 1 and all(
        fits(own, text) for name, own in value.items() if name not in ("snowfall", "receiver")
    )


# What a manifest has from its first moment on.
DESCRIPTION = {
    "object": text,
    "label": text,
    "library": text,
    "hash": text,
    "settings": SETTINGS,
    "wanted": Maybe((number_to(MAX_NUMBER, 0),) * 4),
    "cache": Maybe(text),
}

# The end of a line of the journal.
LINE_END = {"bytes": size, "checksum": digest}

MANIFEST = {
    **DESCRIPTION,
    "complete": flag,
    "checksums": Maybe(checksums(*ONCE)),
    "cache": text,
    "files": [text],
    "end": Maybe(LINE_END),
}
SIDECAR = {"covered": long_text, "driver": text, "beside": [text], "end": LINE_END}
