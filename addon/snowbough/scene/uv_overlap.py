# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a UV layout has overlaps. No ``bpy``.

The layout is drawn into a grid, triangle by triangle and row by row, as spans of cells. Spans include their left end
and exclude their right end, and every edge is computed from its lower to its upper end, so neighbouring triangles share
no cell. The grid stores where spans begin and end; their running sum is the number of spans on each cell.
"""

import numpy as np

from ..base.names import UV_TOLERANCE

GRID = 1024

# Rows of triangles that are drawn at once.
MAX_SPANS = 1 << 18

# Tiles in one message.
MAX_TILES = 6

# Smaller shares come from cells on the borders of charts that touch.
TOLERANCE = 0.005


def overlap_share(corner_uv, grid=GRID, enough=1.0):
    """Share (0 to 1) of the covered cells that more than one triangle covers.

    corner_uv: (T, 3, 2) in 0..1; triangles outside or not finite are left out. Triangles much smaller than a cell
    rarely cover its centre, so the share is meaningful only for layouts that fill at least a few cells. enough: if the
    share is larger than this, some share that is larger is returned: thousands of cards on one place take no time.
    """
    points = np.asarray(corner_uv, dtype=np.float64) * grid
    drawn, claimed_twice = _count_cells(points[np.isfinite(points).all(axis=(1, 2))], grid, enough)
    return claimed_twice / drawn if drawn else 0.0


def outside_share(corner_uv):
    """Share of the corners that lie outside the map by more than names.UV_TOLERANCE, or are not finite."""
    uv = np.asarray(corner_uv)
    if not uv.size:
        return 0.0
    inside = ((uv >= -UV_TOLERANCE) & (uv <= 1 + UV_TOLERANCE)).all(axis=-1)
    return 1.0 - float(inside.mean())


def tiles_text(corner_uv):
    """What to say about a UV map (T, 3, 2) whose faces lie in UDIM tiles: ``uses UDIM tiles (1001: 60% of the faces,
    1002: 40% of the faces), ...``. Empty if they do not."""
    uv = np.asarray(corner_uv, dtype=np.float64)
    if not np.isfinite(uv).all():
        return ""
    column, row = np.floor(uv.mean(axis=1)).astype(np.int64).T
    inside = (
        np.abs(uv - (np.stack([column, row], axis=1) + 0.5)[:, None]).max(axis=(1, 2)) <= 0.5 + UV_TOLERANCE
    )
    if not (inside & (column >= 0) & (column < 10) & (row >= 0)).all():
        return ""
    tiles, counts = np.unique(1001 + column + 10 * row, return_counts=True)
    shares = [f"{tile}: {count / len(uv):.0%} of the faces" for tile, count in zip(tiles, counts)]
    more = f" and {len(shares) - MAX_TILES} more" if len(shares) > MAX_TILES else ""
    return (
        f"uses UDIM tiles ({', '.join(shares[:MAX_TILES])}{more}), and a map of snow is one tile: add a UV map for "
        "the snow whose faces all lie in 0 to 1, and choose it in the receiver's settings"
    )


def _count_cells(points, grid, enough=1.0):
    """(number of cells whose centres triangles (T, 3, 2) cover, number of those that more than one covers). It may stop
    when this share of all cells is covered more than once."""
    change = np.zeros(grid * (grid + 1) + 1, dtype=np.int32)
    depth = np.empty_like(change)
    drawn = claimed_twice = 0
    for some in _batches(points, grid):
        row, left, right = _spans(some, grid)
        begin = np.clip(np.ceil(left - 0.5), 0, grid).astype(np.int64)
        end = np.clip(np.ceil(right - 0.5), 0, grid).astype(np.int64)
        valid = end > begin
        first_cell = row[valid] * (grid + 1)  # the end of a span is never in the next row
        for ends, by in ((begin, 1), (end, -1)):
            # np.bincount would make an array of the whole grid.
            cells, counts = np.unique(first_cell + ends[valid], return_counts=True)
            change[cells] += by * counts.astype(np.int32)
        np.cumsum(change, dtype=np.int32, out=depth)
        drawn, claimed_twice = int(np.count_nonzero(depth)), int(np.count_nonzero(depth > 1))
        if claimed_twice > enough * grid * grid:
            break
    return drawn, claimed_twice


def _batches(points, grid):
    """Triangles (T, 3, 2) in batches of about MAX_SPANS rows."""
    rows = np.ptp(points[:, :, 1].clip(0, grid), axis=1) + 1.0
    ends = np.searchsorted(np.cumsum(rows), np.arange(1, rows.sum() / MAX_SPANS) * MAX_SPANS)
    return np.split(points, np.unique(ends))


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
