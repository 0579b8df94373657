# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts bytes and skeletons to text for storage in a .blend, and back. No ``bpy``.

A skeleton is a line of JSON (names, levels, parents, points per branch, build options) and the numbers as float32,
which are restored exactly.
"""

import base64
import json
import zlib
from types import SimpleNamespace

import numpy as np

FORMAT = 1
# Of bytes in base 64; older versions wrote base 85, which has no colon.
PREFIX = "64:"


def packed(data):
    """Bytes as text, compressed. Base 85 takes Python 200 times as long."""
    return PREFIX + base64.b64encode(zlib.compress(data, 1)).decode("ascii")


def unpacked(text):
    """The bytes of packed(), also of older versions. Raises ValueError for other texts."""
    try:
        is_new = text.startswith(PREFIX)
        return zlib.decompress(base64.b64decode(text[len(PREFIX) :]) if is_new else base64.b85decode(text))
    except zlib.error as error:
        raise ValueError(str(error)) from error


def to_text(branches, built):
    """branches: of the native module's Skeleton; built: plain data to store with them."""
    points = [np.asarray(branch.points, dtype=np.float32) for branch in branches]
    header = {
        "format": FORMAT,
        "names": [branch.name for branch in branches],
        "levels": [int(branch.level) for branch in branches],
        "parents": [int(branch.parent) for branch in branches],
        "counts": [len(rows) for rows in points],
        "built": built,
    }
    numbers = [np.concatenate(points).reshape(-1)]
    numbers += [
        np.concatenate([np.asarray(getattr(branch, name)) for branch in branches])
        for name in ("radii", "areas")
    ]
    numbers.append(np.array([branch.attach_point for branch in branches]).reshape(-1))
    data = json.dumps(header).encode() + b"\n" + np.concatenate(numbers).astype("<f4").tobytes()
    return packed(data)


def from_text(text):
    """The (branches, built) of to_text, with branches as namespaces. Raises ValueError for other texts."""
    try:
        line, _, rest = unpacked(text).partition(b"\n")
        header = json.loads(line)
        if header["format"] != FORMAT:
            raise ValueError(f"format {header['format']}")
        counts = header["counts"]
        total, branches = sum(counts), len(counts)
        numbers = np.frombuffer(rest, "<f4", 5 * total + 3 * branches)
    except (ValueError, KeyError) as error:
        raise ValueError(
            f"the stored skeleton of the tree cannot be read ({error}): import the tree again with this version"
        ) from error
    points, radii, areas, attach = np.split(numbers, np.cumsum([3 * total, total, total]))
    ends = np.cumsum(counts)[:-1]
    rows = zip(
        header["names"],
        header["levels"],
        header["parents"],
        np.split(points.reshape(-1, 3), ends),
        np.split(radii, ends),
        np.split(areas, ends),
        attach.reshape(-1, 3),
    )
    keys = ("name", "level", "parent", "points", "radii", "areas", "attach_point")
    return [SimpleNamespace(**dict(zip(keys, row))) for row in rows], header["built"]
