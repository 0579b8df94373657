# SPDX-License-Identifier: GPL-3.0-or-later
"""Does a UV layout store every place of a surface once? No ``bpy``.

The layout is drawn into a grid, triangle by triangle, row by row, and counted per cell. Spans are closed
on the left and open on the right, and every edge is worked out from its lower to its upper end, so that
neighbouring triangles share no cell.
"""

import numpy as np

GRID = 1024

# Shares below this come from cells on the borders of charts that touch.
TOLERANCE = 0.005


def overlap_share(corner_uv, grid=GRID):
    """Share (0 to 1) of the drawn cells that more than one triangle claims.

    corner_uv: (T, 3, 2) in 0..1; what lies outside is left out. Triangles much smaller than a cell seldom
    hold a cell's centre, so a share only says something on layouts that fill at least a few cells.
    """
    counts = _cover_counts(np.asarray(corner_uv, dtype=np.float64) * grid, grid)
    drawn = int(np.count_nonzero(counts))
    return float(np.count_nonzero(counts > 1)) / drawn if drawn else 0.0


def outside_share(corner_uv):
    """Share of the corners that lie outside the map by more than 1e-4."""
    uv = np.asarray(corner_uv)
    if not uv.size:
        return 0.0
    outside = ((uv < -1e-4) | (uv > 1 + 1e-4)).any(axis=-1)
    return float(outside.mean())


def _cover_counts(points, grid):
    """How many triangles hold the centre of each cell, (grid, grid) int32."""
    low = np.clip(np.ceil(points[:, :, 1].min(axis=1) - 0.5), 0, grid).astype(np.int64)
    high = np.clip(np.ceil(points[:, :, 1].max(axis=1) - 0.5), 0, grid).astype(np.int64)
    rows_of = np.maximum(high - low, 0)
    triangle = np.repeat(np.arange(len(points)), rows_of)
    first = np.cumsum(rows_of) - rows_of
    row = low[triangle] + np.arange(len(triangle)) - first[triangle]
    left, right = _spans(points[triangle], row + 0.5)
    begin = np.clip(np.ceil(left - 0.5), 0, grid).astype(np.int64)
    end = np.clip(np.ceil(right - 0.5), 0, grid).astype(np.int64)
    steps = np.zeros(grid * (grid + 1), dtype=np.int32)
    width = grid + 1
    valid = end > begin
    steps += np.bincount(row[valid] * width + begin[valid], minlength=len(steps)).astype(np.int32)
    steps -= np.bincount(row[valid] * width + end[valid], minlength=len(steps)).astype(np.int32)
    return np.cumsum(steps.reshape(grid, width), axis=1)[:, :grid]


def _spans(corners, y):
    """Where triangles (N, 3, 2) cross the lines at heights y (N,): left and right, inf where they do not."""
    left = np.full(len(y), np.inf)
    right = np.full(len(y), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        swap = corners[:, a, 1] > corners[:, b, 1]
        lower = np.where(swap[:, None], corners[:, b], corners[:, a])
        upper = np.where(swap[:, None], corners[:, a], corners[:, b])
        crosses = (lower[:, 1] <= y) & (y < upper[:, 1])
        rise = np.where(crosses, upper[:, 1] - lower[:, 1], 1.0)
        x = lower[:, 0] + (upper[:, 0] - lower[:, 0]) * ((y - lower[:, 1]) / rise)
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    empty = left > right
    return np.where(empty, 0.0, left), np.where(empty, 0.0, right)
