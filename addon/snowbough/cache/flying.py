# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of snow in the air: one file a frame, and how they fly from frame to frame. No ``bpy``.

``points_<frame>.ply`` is a binary PLY with the columns of COLUMNS, in metres, seconds and cubic metres, in the world.
"""

import numpy as np

from .errors import CacheError
from .files import write_bytes

COLUMNS = ("x", "y", "z", "vx", "vy", "vz", "volume", "seconds")
GRAVITY = 9.81

_NONE = np.zeros((0, len(COLUMNS)), np.float32)


def _head(count):
    columns = "".join(f"property float {name}\n" for name in COLUMNS)
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{columns}end_header\n".encode()


def moved(points, seconds):
    """The points (N, 8) after that time; those that have landed are gone."""
    points = points[points[:, 7] > seconds]
    falls = np.float32(GRAVITY * seconds)
    after = points.copy()
    after[:, :3] += np.float32(seconds) * points[:, 3:6]
    after[:, 2] -= np.float32(0.5 * seconds) * falls
    after[:, 5] -= falls
    after[:, 7] -= np.float32(seconds)
    return after


def joined(points, more):
    """Both; `more` may be None."""
    return points if more is None else np.concatenate([points, more])


def write_points(path, points):
    write_bytes(path, _head(len(points)) + points.astype("<f4").tobytes())


def read_points(path):
    """The points (N, 8) of a file; none if it is missing. Raises CacheError for another file."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return _NONE
    head, _, body = data.partition(b"end_header\n")
    count = len(body) // _NONE.itemsize // len(COLUMNS)
    if _head(count) != head + b"end_header\n" or count * len(COLUMNS) * _NONE.itemsize != len(body):
        raise CacheError(f"{path} is not a point cloud of flying snow: bake again")
    return np.frombuffer(body, "<f4").reshape(-1, len(COLUMNS)).astype(np.float32)
