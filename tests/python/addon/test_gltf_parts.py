# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes into a glTF file (snowbough.gltf): heights, textures, the skeleton as a text, fewer branches and leaves."""

import base64
import zlib
from types import SimpleNamespace

import glb
import numpy as np
import pytest
from gltf_trees import TOWER, leaves_surface
from snowbough.gltf import (
    impostor,
    snow_maps,
    texels,
    thinning,
)
from snowbough.tree import skeleton_text

# -- heights --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("low, high", [(0.0, 1.0), (-0.2, 0.3), (-1.0, 0.0), (0.0, 1e-7), (-1e-6, 1.0)])
def test_heights_come_back_within_half_a_step_and_bare_ground_stays_bare(low, high):
    heights = np.linspace(low, high, 101).astype(np.float32)
    samples, scale, offset = snow_maps.quantised(heights)
    metres = offset + scale * samples.astype(float) / 65535
    assert np.abs(metres - heights).max() <= 0.51 * scale / 65535
    assert metres[np.argmin(np.abs(heights))] == pytest.approx(0.0, abs=1e-12)


def test_an_atlas_begins_at_the_top_left_and_runs_to_the_right():
    tiles = [np.full((2, 2), float(k), np.float32) for k in range(3)]
    whole = snow_maps.atlas(tiles)
    assert snow_maps.tile_layout(3) == (2, 2)
    # Row 0 is the bottom one.
    assert whole.tolist() == [[2, 2, 0, 0], [2, 2, 0, 0], [0, 0, 1, 1], [0, 0, 1, 1]]


def test_tiles_are_means_of_whole_blocks():
    assert snow_maps.shrunk(np.array([[0.0, 1.0], [2.0, 5.0]], np.float32), 1).tolist() == [[2.0]]
    with pytest.raises(ValueError, match="does not divide"):
        snow_maps.shrunk(np.zeros((64, 64), np.float32), 48)


def test_a_leafs_colour_fills_what_its_mask_hides():
    color = np.ones((8, 8, 3), np.float32)  # white around
    color[2:5, 2:5] = (0.1, 0.5, 0.0)
    alpha = np.zeros((8, 8), np.float32)
    alpha[2:5, 2:5] = 1.0
    made = texels.masked(color, alpha)
    assert np.abs(made[..., :3].astype(int) - (26, 128, 0)).max() <= 1
    assert np.array_equal(made[..., 3] == 255, alpha == 1.0)


def test_a_mask_of_another_size_is_brought_to_the_larger_one():
    made = texels.masked(np.full((2, 2, 3), 0.5, np.float32), np.ones((4, 8), np.float32))
    assert made.shape == (4, 8, 4)


def test_images_are_reduced_to_the_size_of_textures():
    image = np.zeros((600, 300, 3), np.float32)
    image[:300] = 1.0
    small = texels.limited(image, 256)
    assert small.shape == (256, 128, 3)
    assert small[:120].min() == 1.0 and small[136:].max() == 0.0
    assert texels.limited(image, 600) is image and texels.limited(image, 0) is image


def test_a_cutoff_keeps_the_area_of_thin_twigs():
    alpha = np.full((64, 64), 0.2, np.float32)
    alpha[:, :8] = 1.0
    kept = impostor.with_kept_area(alpha * np.linspace(0.9, 1.1, 64, dtype=np.float32)[:, None])
    assert (kept >= 0.5).mean() == pytest.approx(0.3, abs=0.02)


# -- a skeleton as a text -------------------------------------------------------------------------------


def branch(name, level, parent, points, attach):
    points = np.array(points, np.float32)
    ones = np.ones(len(points), np.float32)
    return SimpleNamespace(
        name=name,
        level=level,
        parent=parent,
        points=points,
        radii=ones * 0.1,
        areas=ones / 3,
        attach_point=np.array(attach, np.float32),
    )


def test_a_skeleton_comes_back_bit_for_bit():
    given = [
        branch("Stamm ä", 0, -1, [(0, 0, 0), (0, 0.1, 1 / 3)], (0, 0, 0)),
        branch("twig", 1, 0, [(0, 0, 0.2)], (0, 0.05, 0.2)),
    ]
    text = skeleton_text.to_text(given, {"width": "ORIGINAL"})
    assert text.isascii()
    found, built = skeleton_text.from_text(text)
    assert built == {"width": "ORIGINAL"}
    for before, after in zip(given, found, strict=True):
        assert (before.name, before.level, before.parent) == (after.name, after.level, after.parent)
        for name in ("points", "radii", "areas", "attach_point"):
            assert np.array_equal(getattr(before, name), getattr(after, name)), name


def test_a_skeleton_that_an_older_version_stored_comes_back():
    data = skeleton_text.unpacked(
        skeleton_text.to_text([branch("a", 0, -1, [(0, 0, 1)], (0, 0, 0))], {"old": 1})
    )
    found, built = skeleton_text.from_text(base64.b85encode(zlib.compress(data, 6)).decode())
    assert [one.name for one in found] == ["a"] and built == {"old": 1}


@pytest.mark.parametrize("text", ["", "nonsense", "c$" * 40, "64:", "64:ä", "64:eJwB"])
def test_what_is_no_skeleton_is_refused(text):
    with pytest.raises(ValueError, match="import the tree again"):
        skeleton_text.from_text(text)


# -- fewer branches, fewer leaves -----------------------------------------------------------------------


# The parts of TOWER, each a branch.
TOWER_BRANCH = np.array([0] * 5 + [1] * 4 + [2] * 5)
TOWER_BRANCHES = [
    branch("cube", 0, -1, [(0, 0, 0), (0, 0, 1)], (0, 0, 0)),
    branch("tower", 1, 0, [(0, 0, 1), (0, 0, 1.5)], (0, 0, 1)),
    branch("spire", 2, 1, [(0, 0, 1.5), (0, 0, 4)], (0, 0, 1.5)),
]


def tower_uvs():
    """U and V of each corner: the vertex's number, and the branch."""
    return np.stack([TOWER, np.repeat(TOWER_BRANCH[:, None], 4, axis=1)], axis=2).astype(np.float32)


def as_triangles(quads):
    return quads[:, (0, 1, 2, 0, 2, 3)].reshape(-1, 3).astype(np.int64)


def test_no_branch_goes_before_what_grows_from_it():
    # The spire is the longest, so it keeps the tower that it stands on.
    assert thinning.branch_sizes(TOWER_BRANCHES).tolist() == [2.5, 2.5, 2.5]
    faces = np.bincount(TOWER_BRANCH)
    kept = thinning.kept_branches(TOWER_BRANCHES, faces, 9)
    assert kept.tolist() == [True, True, False]
    assert thinning.kept_branches(TOWER_BRANCHES, faces, 1).tolist() == [True, False, False]


@pytest.mark.parametrize("kept, quads", [((1, 1, 1), 14), ((1, 1, 0), 10), ((1, 0, 0), 6)])
def test_a_tree_without_some_branches_is_closed(kept, quads):
    kept = np.array(kept, bool)
    left, (uv,), faces = thinning.without_branches(TOWER, [tower_uvs()], TOWER_BRANCH, TOWER_BRANCHES, kept)
    assert len(left) == len(uv) == len(faces) == quads
    assert glb.is_closed(as_triangles(left))
    # The quad on the hole has the UVs of the branch that it was cut off, at the same vertices.
    assert np.array_equal(uv[..., 0], left)
    assert kept[uv[..., 1].astype(int)].all() and kept[TOWER_BRANCH[faces]].all()


def test_an_open_mesh_loses_no_branches():
    with pytest.raises(ValueError, match="not closed"):
        thinning.without_branches(
            TOWER[:-1], [tower_uvs()[:-1]], TOWER_BRANCH[:-1], TOWER_BRANCHES, np.array([True, True, False])
        )


def area(one):
    place = one.points[one.corner_point[one.triangles]].astype(float)
    return np.linalg.norm(np.cross(place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]), axis=1).sum() / 2


@pytest.mark.parametrize("share", [0.5, 0.25, 0.1])
def test_fewer_leaves_cover_as_much(share):
    thinned = thinning.thinned_leaves(leaves_surface(100), share)
    assert len(thinned.triangles) == round(200 * share)
    assert area(thinned) == pytest.approx(100.0, rel=1e-5)


def test_leaves_of_a_coarser_level_are_among_those_of_the_finer():
    many = thinning.thinned_leaves(leaves_surface(64), 0.5)
    few = thinning.thinned_leaves(leaves_surface(64), 0.25)
    assert {tuple(t) for t in few.triangles.tolist()} < {tuple(t) for t in many.triangles.tolist()}


def test_a_leaf_grows_from_its_stem():
    given = leaves_surface(4)
    stems = given.points * (1, 0, 0) + (0, -1, 0)  # below the edge y = 0, and nearest to its points
    thinned = thinning.thinned_leaves(given, 0.25, stems)
    used = thinned.points[thinned.corner_point[thinned.triangles]].reshape(-1, 3)
    assert used[:, 1].min() == 0.0 and used[:, 1].max() == pytest.approx(2.0)


def test_points_of_a_cell_become_one():
    side = np.arange(21) / 20
    x, y = (grid.reshape(-1) for grid in np.meshgrid(side, side))
    points = np.stack([x, y, 0.001 * x], axis=1).astype(np.float32)
    first = (np.arange(20)[:, None] * 21 + np.arange(20)).reshape(-1)
    quads = first[:, None] + (0, 1, 22, 21)
    merged, found = thinning.clustered(points, as_triangles(quads), 0.2)
    assert len(merged) <= 36 and len(found) < 72
    corner = merged[found].astype(float)
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert (across[:, 2] > 0).all()  # none is flipped
    assert across[:, 2].sum() / 2 == pytest.approx(0.8, abs=0.25)
    assert len({tuple(sorted(t)) for t in found.tolist()}) == len(found)
    assert thinning.clustered(points, quads, 0.0) == (points, quads)
