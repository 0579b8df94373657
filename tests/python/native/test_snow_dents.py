# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow surfaces show prints that the last frame no longer has."""

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import grid

DEPTH = 0.1
SIDE = 256
SIZE = 2.0


def printed(deep=0.07):
    """Level snow with four soles of 0.12 x 0.3 m."""
    at = (np.arange(SIDE) + 0.5) / SIDE
    y, x = np.meshgrid(at, at, indexing="ij")
    height = np.full((SIDE, SIDE), DEPTH, np.float32)
    for u, v in ((0.3, 0.35), (0.42, 0.5), (0.3, 0.65), (0.7, 0.5)):
        height[(abs(x - u) < 0.03) & (abs(y - v) < 0.075)] -= deep
    return height


def surface(dents):
    positions, triangles, uv = grid(SIZE, SIZE)
    level = np.full((SIDE, SIDE), DEPTH, np.float32)
    made = native.SnowSurface(triangles, uv, positions, level, level, DEPTH, dents=dents)
    made.set_style(relief=0.0)
    return made


def error(made, height):
    """Root mean square of what the surface's faces are off around the soles, in metres, at random places."""
    points = made.points(height, DEPTH).astype(float)
    begin, corners, _ = made.faces()
    fours = np.diff(begin) == 4
    fans = [corners[begin[:-1][:, None] + (0, 1, 2)], corners[begin[:-1][fours][:, None] + (0, 2, 3)]]
    face = points[np.concatenate(fans)]
    area = abs(np.cross((face[:, 1] - face[:, 0])[:, :2], (face[:, 2] - face[:, 0])[:, :2]))
    random = np.random.default_rng(3)
    chosen = random.choice(len(face), 100000, p=area / area.sum())
    s, t = np.sort(random.uniform(size=(2, 100000)), axis=0)
    weights = np.stack([s, t - s, 1.0 - t], axis=1)
    place = (face[chosen] * weights[:, :, None]).sum(axis=1)
    u, v = ((place[:, i] / SIZE + 0.5) * 0.96 + 0.02 for i in (0, 1))
    column, row = (np.clip(c * SIDE - 0.5, 0, SIDE - 1.001) for c in (u, v))
    i, j, s, t = row.astype(int), column.astype(int), row % 1.0, column % 1.0
    known = (height[i, j] * (1 - s) + height[i + 1, j] * s) * (1 - t)
    known += (height[i, j + 1] * (1 - s) + height[i + 1, j + 1] * s) * t
    near = (abs(u - 0.5) < 0.28) & (abs(v - 0.5) < 0.28)
    return np.sqrt(np.mean((place[near, 2] - known[near]) ** 2))


def test_a_print_that_is_gone_in_the_last_frame_is_sharp():
    height = printed()
    plain, fine = surface(None), surface(DEPTH - height)
    assert error(fine, height) < 0.7 * error(plain, height)
    # Only at the walls of prints.
    assert fine.point_count < 2 * plain.point_count


def test_no_dents_change_no_byte():
    level = np.full((SIDE, SIDE), DEPTH, np.float32)
    plain, none = surface(None), surface(np.zeros((SIDE, SIDE), np.float32))
    assert plain.points(level, DEPTH).tobytes() == none.points(level, DEPTH).tobytes()


def test_dents_of_another_size_are_refused():
    with pytest.raises(ValueError, match="resolution x resolution"):
        surface(np.zeros((8, 8), np.float32))
