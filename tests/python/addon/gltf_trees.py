# SPDX-License-Identifier: GPL-3.0-or-later
"""Small trees for the tests of the export to glTF."""

import numpy as np
from snowbough.gltf import (
    tree_data,
    triangle_mesh,
)

# A grey PNG of one pixel.
PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
    "0000000a49444154789c636000000002000148afa4710000000049454e44ae426082"
)

# A cube with a tower on its top and a thinner one on that: 5 + 4 + 4 + 1 quads.
TOWER = np.array(
    [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [3, 2, 1, 0]]
    + [[4, 5, 9, 8], [5, 6, 10, 9], [6, 7, 11, 10], [7, 4, 8, 11]]
    + [[8, 9, 13, 12], [9, 10, 14, 13], [10, 11, 15, 14], [11, 8, 12, 15], [12, 13, 14, 15]],
)


def leaves_surface(count):
    """`count` separate unit squares in a row along X, each of two triangles."""
    corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
    points = (corner + np.arange(count)[:, None, None] * (3, 0, 0)).reshape(-1, 3).astype(np.float32)
    quads = np.arange(4 * count).reshape(-1, 4)
    uv = np.zeros((count, 4, 2), np.float32)
    joints, weights = triangle_mesh.strongest(np.zeros((4 * count, 1), int), np.ones((4 * count, 1)))
    return triangle_mesh.from_quads(points, quads, [uv, uv], joints, weights, np.zeros(count), None)


def cube(uv_seam=False):
    """A unit cube of smooth quads around the middle; with a seam, each face has UVs of its own."""
    corners = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], np.float32)
    quads = TOWER[:5].tolist() + [[4, 5, 6, 7]]
    uv = np.zeros((6, 4, 2), np.float32)
    if uv_seam:
        uv += np.arange(6, dtype=np.float32)[:, None, None] / 10
    joints, weights = triangle_mesh.strongest(np.array([[0, 1]] * 8), np.array([[0.5, 0.5]] * 8))
    level = np.array([0] * 4 + [1] * 4)
    return triangle_mesh.from_quads(
        corners - 0.5, np.array(quads), [uv, uv], joints, weights, np.zeros(6), level
    )


def some_tree(**material):
    """Two bones, the second one turned and above the first; the cube in two levels of detail."""
    turned = np.eye(4)
    turned[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    turned[:3, 3] = (0, 0, 0.5)
    joints = [tree_data.Joint("root", -1, np.eye(4)), tree_data.Joint("tip", 0, turned)]
    bark = tree_data.Part("cube", [cube(uv_seam=True), cube()], [tree_data.Material("bark", **material)])
    return tree_data.Tree("tree", joints, [bark], 3)
