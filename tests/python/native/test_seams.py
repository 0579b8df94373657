# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow maps over UV seams: the texel table and the output map of snowbough_native."""

from pathlib import Path

import numpy as np
import pytest
from snow_rays import texel_points

snowbough_native = pytest.importorskip("snowbough_native")

SHARED = Path(__file__).resolve().parents[3].parent / "shared" / "data"


def triangles_of(mesh):
    """A rebuilt tree's quads as triangles, with their snow UVs."""
    quads = np.asarray(mesh.quads)
    uv = np.asarray(mesh.uv_snow)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return triangles, np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]])


def seam_points(triangles, uv, texels):
    """Both sides' coordinates at points along every seam, about three a texel."""
    edges = {}
    for t, corners in enumerate(triangles.tolist()):
        for k in range(3):
            a, b = corners[k], corners[(k + 1) % 3]
            ends = (uv[t, k], uv[t, (k + 1) % 3])
            edges.setdefault((min(a, b), max(a, b)), []).append(ends if a < b else ends[::-1])
    first, second = [], []
    for sides in edges.values():
        if len(sides) != 2 or np.abs(np.subtract(sides[0], sides[1])).max() < 1e-6:
            continue
        length = max(np.linalg.norm(side[1] - side[0]) for side in sides)
        count = max(1, int(3 * length * texels))
        part = ((np.arange(count) + 0.5) / count)[:, None]
        first.append(sides[0][0] * (1 - part) + sides[0][1] * part)
        second.append(sides[1][0] * (1 - part) + sides[1][1] * part)
    return np.concatenate(first), np.concatenate(second)


def read_map(height, uv):
    size = height.shape[0]
    at = uv * size - 0.5
    low = np.floor(at).astype(int)
    part = at - low
    x0, y0 = np.clip(low, 0, size - 1).T
    x1, y1 = np.clip(low + 1, 0, size - 1).T
    lower = height[y0, x0] * (1 - part[:, 0]) + height[y0, x1] * part[:, 0]
    upper = height[y1, x0] * (1 - part[:, 0]) + height[y1, x1] * part[:, 0]
    return lower * (1 - part[:, 1]) + upper * part[:, 1]


def test_a_layout_outside_the_unit_square_is_a_value_error():
    triangles = np.array([[0, 1, 2]], np.int32)
    uv = np.array([[[0, 0], [1.5, 0], [0, 1]]], np.float32)
    with pytest.raises(ValueError, match="1 of 3 texture coordinates"):
        snowbough_native.texel_table(triangles, uv, 128)


def test_snow_on_a_rebuilt_tree_is_even_across_its_seams():
    path = SHARED / "trees" / "squares" / "AL06a_squares.obj"
    if not path.is_file():
        pytest.skip("shared/data/trees/squares/AL06a_squares.obj is not there")
    if not hasattr(snowbough_native, "build_tree_mesh"):
        pytest.skip("this module was built without build_tree_mesh")
    resolution = 1024
    mesh = snowbough_native.build_tree_mesh(snowbough_native.read_tree(str(path)), snow_resolution=resolution)
    triangles, uv = triangles_of(mesh)
    positions = np.asarray(mesh.vertices)
    points, normals, _, table = texel_points(snowbough_native, positions, triangles, uv, resolution)
    sides = positions[triangles[:, 1:]] - positions[triangles[:, :1]]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    texel = np.sqrt(area.sum() / 2 / table["coverage"].sum())
    # Snow on faces that face up, with grain and with shadows some 15 texels apart.
    lit = np.sin(points / (15 * texel)).sum(axis=1) > -0.5
    grain = np.random.default_rng(7).uniform(0.7, 1.3, len(points))
    stored = np.zeros((resolution, resolution), np.float32)
    stored.ravel()[table["texel"]] = (0.02 + 0.08 * lit * np.clip(normals[:, 2], 0, 1)) * grain
    testing = pytest.importorskip("snowbough_testing")
    height, normal = testing.output_map(triangles, uv, positions, stored, blur_radius=3 * texel)
    assert np.linalg.norm(normal, axis=2) == pytest.approx(1, abs=1e-4)
    first, second = (read_map(height, side) for side in seam_points(triangles, uv, resolution))
    gap = np.abs(first - second) / np.maximum(0.5 * (first + second), 1e-4)
    p99 = np.percentile(gap, 99)
    print(f"{len(gap)} points, median {np.median(gap):.5f}, p99 {p99:.5f}, max {gap.max():.4f}")
    assert p99 < 0.01
