# SPDX-License-Identifier: GPL-3.0-or-later
"""UV layouts of meshes of cards (snowbough.scene.card_layout), without Blender."""

import time

import numpy as np
import pytest
from snowbough.scene import card_layout, uv_overlap


def cards(count, bend=0.3):
    """(positions, corners, begin) of cards of two quads, 0.2 m wide and 0.1 m high, turned at random."""
    numbers = np.random.default_rng(5)
    axes = np.linalg.qr(numbers.normal(size=(count, 3, 3)))[0]
    flat = np.array([(-1, -1, 0), (0, -1, bend), (1, -1, 0), (-1, 1, 0), (0, 1, bend), (1, 1, 0)]) * (
        0.1,
        0.05,
        0.1,
    )
    positions = (flat @ axes + numbers.uniform(-3.0, 3.0, (count, 1, 3))).reshape(-1, 3)
    faces = np.array([(0, 1, 4, 3), (1, 2, 5, 4)])
    corners = (faces[None] + 6 * np.arange(count)[:, None, None]).reshape(-1)
    return positions, corners, np.arange(0, len(corners), 4)


def triangles(uv):
    quads = uv.reshape(-1, 4, 2)
    return np.concatenate([quads[:, (0, 1, 2)], quads[:, (0, 2, 3)]])


def areas(points):
    a, b = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def test_cards_get_equal_places_without_overlaps():
    uv = card_layout.card_layout(*cards(400))
    assert uv.min() >= 0.0 and uv.max() <= 1.0
    of_faces = areas(triangles(uv))
    assert of_faces == pytest.approx(np.full(len(of_faces), of_faces[0]), rel=1e-6)
    assert uv_overlap.overlap_share(triangles(uv)) == 0.0
    assert of_faces.sum() > 0.6  # the map is used
    quads = uv.reshape(-1, 4, 2)
    assert quads[::2, 1] == pytest.approx(quads[1::2, 0])  # the two faces of a card stay joined


def test_folded_cards_are_cut_into_their_faces():
    """The halves of a card are turned by 84 degrees to its mean plane."""
    uv = card_layout.card_layout(*cards(400, bend=10.0))
    of_faces = areas(triangles(uv))
    assert of_faces.min() > 0.9 * of_faces.max()
    assert uv_overlap.overlap_share(triangles(uv)) == 0.0


def test_meshes_of_few_or_large_pieces_are_left_to_blender():
    assert card_layout.card_layout(*cards(200)) is None
    edge = 101
    grid = np.stack(np.meshgrid(np.arange(edge), np.arange(edge), [0.0]), axis=-1).reshape(-1, 3)
    corner = (np.arange(edge - 1)[:, None] * edge + np.arange(edge - 1)).reshape(-1, 1)
    corners = (corner + [0, 1, edge + 1, edge]).reshape(-1)
    assert card_layout.card_layout(grid, corners, np.arange(0, len(corners), 4)) is None


def test_thousands_of_cards_take_no_time():
    """Smart UV Project takes half a minute for them."""
    begun = time.process_time()
    assert card_layout.card_layout(*cards(6283)) is not None
    assert time.process_time() - begun < 3.0
