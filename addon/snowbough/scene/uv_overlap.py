# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a UV layout has overlaps. No ``bpy``.

The layout is drawn into a grid, triangle by triangle and row by row, as spans of cells. Spans include their left end
and exclude their right end, and every edge is computed from its lower to its upper end, so neighbouring triangles share
no cell. The grid itself is not stored: the sorted ends of the spans give the number of spans on each cell, which is
faster than allocating a grid.
"""

import numpy as np

from ..base.names import UV_TOLERANCE

GRID = 1024

# Smaller shares come from cells on the borders of charts that touch.
TOLERANCE = 0.005


def overlap_share(corner_uv, grid=GRID):
    """Share (0 to 1) of the covered cells that more than one triangle covers.

    corner_uv: (T, 3, 2) in 0..1; triangles outside or not finite are left out. Triangles much smaller than a cell
    rarely cover its centre, so the share is meaningful only for layouts that fill at least a few cells.
    """
    points = np.asarray(corner_uv, dtype=np.float64) * grid
    drawn, claimed_twice = _count_cells(points[np.isfinite(points).all(axis=(1, 2))], grid)
    return claimed_twice / drawn if drawn else 0.0


def outside_share(corner_uv):
    """Share of the corners that lie outside the map by more than names.UV_TOLERANCE, or are not finite."""
    uv = np.asarray(corner_uv)
    if not uv.size:
        return 0.0
    inside = ((uv >= -UV_TOLERANCE) & (uv <= 1 + UV_TOLERANCE)).all(axis=-1)
    return 1.0 - float(inside.mean())


def _count_cells(points, grid):
    """(number of cells whose centres triangles (T, 3, 2) cover, number of those that more than one covers)."""
    row, left, right = _spans(points, grid)
    begin = np.clip(np.ceil(left - 0.5), 0, grid).astype(np.int64)
    end = np.clip(np.ceil(right - 0.5), 0, grid).astype(np.int64)
    valid = end > begin
    # Rows in sequence; the end of a span is never in the next row.
    first_cell = row[valid] * (grid + 1)
    ends = np.concatenate([first_cell + begin[valid], first_cell + end[valid]])
    order = np.argsort(ends)
    depth = np.cumsum(np.where(order < len(first_cell), 1, -1))[:-1]
    lengths = np.diff(ends[order])
    return int(lengths[depth > 0].sum()), int(lengths[depth > 1].sum())


def _spans(points, grid):
    """The rows in which triangles cross the centres of cells, one entry per triangle and row: the row, and the left and
    right end of the triangle there."""
    low = np.clip(np.ceil(points[:, :, 1].min(axis=1) - 0.5), 0, grid).astype(np.int64)
    high = np.clip(np.ceil(points[:, :, 1].max(axis=1) - 0.5), 0, grid).astype(np.int64)
    rows_of = np.maximum(high - low, 0)
    triangle = np.repeat(np.arange(len(points)), rows_of)
    row = np.arange(len(triangle)) + (low + rows_of - np.cumsum(rows_of))[triangle]
    y = row + 0.5
    left = np.full(len(y), np.inf)
    right = np.full(len(y), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        swap = (points[:, a, 1] > points[:, b, 1])[:, None]
        lower = np.where(swap, points[:, b], points[:, a])
        upper = np.where(swap, points[:, a], points[:, b])
        across, rise = (upper - lower).T
        bottom = lower[:, 1][triangle]
        crosses = (bottom <= y) & (y < upper[:, 1][triangle])
        with np.errstate(divide="ignore", invalid="ignore"):  # level edges cross no row
            x = lower[:, 0][triangle] + across[triangle] * ((y - bottom) / rise[triangle])
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    empty = left > right
    return row, np.where(empty, 0.0, left), np.where(empty, 0.0, right)
