# SPDX-License-Identifier: GPL-3.0-or-later
"""The receivers that stand near another one in the cache: its snow meets theirs. No ``bpy``."""

import os
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..cache.files import MANIFEST, POSITIONS, RECEIVER, frame_file
from ..cache.manifest import read_manifest
from .mesh_file import read_mesh
from .point_cache import read_point_cache

# Distances at which receivers are near, in depths of snow: beside, and below.
BESIDE, BELOW = 0.5, 1.6
# Receivers whose shapes and maps stay in memory.
MAX_KEPT = 4


@lru_cache(maxsize=2048)
def _standing(folder, stamp):
    """((first, last, deepest frame, its depth), (lowest, highest corner), to_world) of a receiver that never moves, or
    None. Metres, in world space. stamp: see _stamp."""
    folder = Path(folder)
    manifest = read_manifest(folder)
    frames = [] if manifest is None else [entry for entry in manifest["frames"] if "to_world" in entry]
    if not frames or any(
        entry.get("hidden") or entry["to_world"] != frames[0]["to_world"] for entry in frames
    ):
        return None
    local = read_point_cache(folder / POSITIONS)
    if len(local) != 1 or not len(local[0]):
        return None
    matrix = np.array(frames[-1]["to_world"], np.float64).reshape(4, 4)
    positions = (local[0] @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    fullest = max(frames, key=lambda entry: (entry["depth"], entry["frame"]))
    return (
        (frames[0]["frame"], frames[-1]["frame"], fullest["frame"], fullest["depth"]),
        (positions.min(axis=0), positions.max(axis=0)),
        np.array(matrix, np.float32),
    )


@lru_cache(maxsize=MAX_KEPT)
def _loaded(native, folder, stamp):
    """(triangles, uv, positions, map of its deepest frame) of a receiver."""
    shot, _, matrix = _standing(folder, stamp)
    folder = Path(folder)
    mesh, local = read_mesh(folder / RECEIVER), read_point_cache(folder / POSITIONS)[0]
    positions = (local @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    height = native.read_exr(str(folder / frame_file("height", shot[2])))[0]
    return mesh.triangles, mesh.triangle_uv, positions, height


def _stamp(folder):
    """When the files of a folder were written. Without Path, since each receiver asks for all others."""
    return tuple(os.stat(f"{folder}/{name}").st_mtime_ns for name in (MANIFEST, RECEIVER, POSITIONS))


def near(native, folder):
    """[(triangles, uv, positions, height)] of the faces near the receiver in `folder`, in world space, of the
    receivers of its bake. Neither it nor they may move during the shot: else there are none. A neighbour whose files
    are missing or damaged is left out."""
    folder, found = os.path.abspath(folder), []
    try:
        own = _standing(folder, _stamp(folder))
    except (OSError, RuntimeError, ValueError):
        return []
    if own is None:
        return []
    shot, (low, high), _ = own
    low = low - np.float32([BESIDE, BESIDE, BELOW]) * shot[3]
    high = high + np.float32([BESIDE, BESIDE, 0.0]) * shot[3]
    parent, own_name = os.path.split(folder)
    for name in sorted(os.listdir(parent)):
        if name == own_name:
            continue
        other = f"{parent}/{name}"
        try:
            stamp = _stamp(other)
            known = _standing(other, stamp)
            if known is None or known[0] != shot or (known[1][0] > high).any() or (known[1][1] < low).any():
                continue
            triangles, uv, positions, height = _loaded(native, other, stamp)
        except (OSError, RuntimeError, ValueError):
            continue
        corners = positions[triangles]
        is_near = ~((corners.min(axis=1) > high) | (corners.max(axis=1) < low)).any(axis=1)
        if is_near.any():
            found.append((triangles[is_near], uv[is_near], positions, height))
    return found
