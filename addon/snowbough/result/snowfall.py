# SPDX-License-Identifier: GPL-3.0-or-later
"""What a snow material knows of its bake: how deep open ground lies under snow, the wind, the receiver's scale."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..base.names import MIN_DEPTH
from ..cache.files import POSITIONS
from ..cache.manifest import read_manifest
from ..surface.point_cache import read_point_cache

# Strength of ripples without wind, and per sine of the angle of fall; the direction without wind.
CALM, PER_SINE = 0.35, 1.8
CALM_WIND = (0.8, 0.6, 0.0)
# Ripples need a receiver that is wider than the first number of depths; one of the second has all of them.
NARROW, WIDE = 8.0, 24.0


@dataclass(frozen=True)
class Snowfall:
    """depth: of open ground in the deepest frame, in metres. wind: level direction in the receiver's space, as long as
    the strength of ripples (0 to 1). scale: metres per unit of that space, for each axis. is_rigid: whether the
    receiver keeps its shape during the shot."""

    depth: float = 0.1
    wind: tuple = (0.0, 0.0, 0.0)
    scale: tuple = (1.0, 1.0, 1.0)
    is_rigid: bool = False


def _width(points):
    """Smaller horizontal width of points (N, 3), roughly."""
    spread = np.linalg.eigvalsh(np.cov(points[:, :2].T)) if len(points) > 1 else np.zeros(2)
    return 2.0 * float(np.sqrt(max(spread[0], 0.0)))


def read_snowfall(folder):
    """The Snowfall of a baked receiver's folder; the defaults before a bake and without the inputs of a surface. Raises
    CacheError for damaged files."""
    manifest = read_manifest(Path(folder)) if folder else None
    frames = [entry for entry in manifest["frames"] if "to_world" in entry] if manifest else []
    if not frames or not (Path(folder) / POSITIONS).is_file():
        return Snowfall()
    local = read_point_cache(Path(folder) / POSITIONS)
    matrix = np.array(frames[-1]["to_world"], np.float64).reshape(4, 4)[:3, :3]
    scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-9)
    depth = max(max(entry["depth"] for entry in frames), MIN_DEPTH)

    blown = np.mean([entry["direction"] for entry in frames], axis=0) * (1.0, 1.0, 0.0)
    sine = float(np.linalg.norm(blown))
    way = blown / sine if sine > 1e-3 else np.array(CALM_WIND)
    room = (_width(local[-1] @ matrix.T) / depth - NARROW) / (WIDE - NARROW)
    strength = min(CALM + PER_SINE * sine, 1.0) * min(max(room, 0.0), 1.0)
    wind = (matrix / scale).T @ way * strength
    return Snowfall(depth, tuple(map(float, wind)), tuple(map(float, scale)), len(local) == 1)
