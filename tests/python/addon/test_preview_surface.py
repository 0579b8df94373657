# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that the live preview raises (snowbough.preview.surface_mesh) and its normals, without Blender."""

import numpy as np
import pytest
from snowbough.preview import surface_mesh
from snowbough.preview.normals import NormalTable
from snowbough.scene.pose import Topology

SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], dtype=np.float32)
SQUARE_TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)
# Two squares that meet at a right angle along x = 1, each with half of the map.
FOLD = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, -1), (1, 1, -1)], dtype=np.float32)
FOLD_TRIANGLES = np.array([(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)], dtype=np.int32)
LEFT, RIGHT = ((0, 0), (0.4, 0), (0.4, 1), (0, 1)), ((0.6, 0), (1, 0), (1, 1), (0.6, 1))
FOLD_UV = np.array(
    [half[:3] if first else (half[0], *half[2:]) for half in (LEFT, RIGHT) for first in (1, 0)]
)


def topology(triangles, uv, vertices, shading=None):
    return Topology(triangles, np.asarray(uv, dtype=np.float32), vertices, "", shading=shading)


def square():
    return topology(SQUARE_TRIANGLES, SQUARE[SQUARE_TRIANGLES][..., :2], 4)


def fold(shading=None):
    return topology(FOLD_TRIANGLES, FOLD_UV, 6, shading)


def build(topology_, positions, edge=8.0, resolution=64, most=10**6):
    corners = NormalTable(topology_).corners
    return surface_mesh.build(topology_, positions, corners, edge, resolution, most)


def places(mesh, positions):
    """Where the points of a mesh are."""
    b, c = mesh.first.weights.astype(np.float64).T
    corner = positions[mesh.first.corners].astype(np.float64)
    weights = np.stack([1.0 - b - c, b, c], axis=1)
    return (corner * weights[..., None]).sum(axis=1)


def area(mesh, positions):
    corner = places(mesh, positions)[mesh.triangles]
    return (
        0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum()
    )


def edge_faces(mesh):
    """{edge: number of its triangles}."""
    sides = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    _, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return count


def test_a_square_is_cut_into_squares_as_long_as_asked_for():
    mesh = build(square(), SQUARE)
    assert len(mesh.triangles) == 2 * 8 * 8
    assert len(mesh.inside) == 9 * 9
    assert area(mesh, SQUARE) == pytest.approx(1.0)


def test_the_places_on_the_map_follow_the_surface_inside():
    mesh = build(square(), SQUARE)
    inside = mesh.inside > 0
    assert mesh.first.uv[inside] == pytest.approx(places(mesh, SQUARE)[inside, :2], abs=1e-6)


def test_snow_ends_on_the_rim_and_only_there():
    mesh = build(square(), SQUARE)
    x, y = places(mesh, SQUARE)[:, :2].T
    assert ((mesh.inside == 0) == ((x == 0) | (x == 1) | (y == 0) | (y == 1))).all()


def test_entries_at_the_rim_keep_off_it_by_a_texel():
    mesh = build(square(), SQUARE)
    assert mesh.first.uv.min() == pytest.approx(1 / 64)
    assert mesh.first.uv.max() == pytest.approx(1 - 1 / 64)


def test_neighbours_cut_their_common_edge_alike_whatever_room_the_map_gives_them():
    """The left square has half of the map's height only, so it would want coarser edges than the right one."""
    uv = FOLD_UV.copy()
    uv[:2, :, 1] *= 0.25
    mesh = build(topology(FOLD_TRIANGLES, uv, 6), FOLD)
    count = edge_faces(mesh)
    assert set(count) == {1, 2}
    rim = mesh.inside == 0
    # A rim of six edges has as many points as sides; a gap would have added sides.
    assert (count == 1).sum() == rim.sum()
    assert area(mesh, FOLD) == pytest.approx(2.0)


def test_random_meshes_have_no_gaps():
    seed = np.random.SeedSequence().entropy % (1 << 32)
    print("seed", seed)
    numbers = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0)), axis=-1).reshape(-1, 2)
    positions = np.concatenate([grid, numbers.random((25, 1))], axis=1).astype(np.float32)
    quads = [(5 * y + x, 5 * y + x + 1, 5 * y + x + 6, 5 * y + x + 5) for y in range(4) for x in range(4)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    uv = numbers.random((len(triangles), 3, 2))
    mesh = build(topology(triangles, uv, 25), positions)
    count = edge_faces(mesh)
    assert set(count) == {1, 2}
    assert (count == 1).sum() == (mesh.inside == 0).sum()
    assert len(mesh.triangles) > 500


def test_points_of_a_seam_have_an_entry_on_either_side():
    mesh = build(fold(), FOLD)
    on_fold = np.abs(places(mesh, FOLD)[:, 0] - 1) + np.abs(places(mesh, FOLD)[:, 2]) < 1e-6
    assert on_fold.sum() == 9
    assert (mesh.more_range[on_fold, 1] == 1).all()
    assert (mesh.more_range[~on_fold, 1] == 0).all()
    further = mesh.more_range[on_fold, 0]
    either = np.stack([mesh.first.uv[on_fold, 0], mesh.more.uv[further, 0]], axis=1)
    assert np.sort(either, axis=1) == pytest.approx(np.tile([0.4 - 1 / 64, 0.6 + 1 / 64], (9, 1)), abs=1e-6)


def test_flat_neighbours_in_a_plane_need_one_entry_only():
    positions = FOLD.copy()
    positions[4:, 0], positions[4:, 2] = 2, 0
    uv = positions[FOLD_TRIANGLES][..., :2] / 2
    assert len(build(topology(FOLD_TRIANGLES, uv, 6), positions).more) == 0


def test_vertices_at_one_place_are_one_point():
    split = np.concatenate([FOLD, FOLD[1:3]])
    triangles = np.array([(0, 1, 2), (0, 2, 3), (6, 4, 5), (6, 5, 7)], dtype=np.int32)
    mesh = build(topology(triangles, FOLD_UV, 8), split)
    assert len(mesh.inside) == len(build(fold(), FOLD).inside)


def test_no_more_triangles_than_allowed():
    mesh = build(square(), SQUARE, edge=1.0, resolution=1024, most=5000)
    assert 1000 < len(mesh.triangles) <= 5000


def test_a_mesh_finer_than_the_map_stays_as_it_is():
    mesh = build(square(), SQUARE, edge=2.0, resolution=1)
    assert len(mesh.triangles) == 2


def test_tangents_give_the_surfaces_ways_along_the_map():
    """The square's map is turned by 90 degrees: u runs along Y, v against X."""
    uv = np.stack([SQUARE[:, 1], 1.0 - SQUARE[:, 0]], axis=1)[SQUARE_TRIANGLES]
    entries = build(topology(SQUARE_TRIANGLES, uv, 4), SQUARE * 3).first
    corner = (SQUARE * 3)[entries.corners]
    edge1, edge2, t = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0], entries.tangents
    assert t[:, :1] * edge1 + t[:, 1:2] * edge2 == pytest.approx(np.tile([0, 3, 0], (len(t), 1)), abs=1e-5)
    assert t[:, 2:3] * edge1 + t[:, 3:] * edge2 == pytest.approx(np.tile([-3, 0, 0], (len(t), 1)), abs=1e-5)


def test_triangles_without_a_place_on_the_map_have_no_tangents():
    assert (build(topology(SQUARE_TRIANGLES, np.zeros((2, 3, 2)), 4), SQUARE).first.tangents == 0).all()


# -- normals -------------------------------------------------------------------------------------------


def test_flat_triangles_have_normals_of_their_own():
    normals = NormalTable(fold())
    table = normals.compute(FOLD)
    assert table[normals.corners[0]] == pytest.approx(np.tile([0, 0, 1], (3, 1)))
    assert table[normals.corners[3]] == pytest.approx(np.tile([1, 0, 0], (3, 1)))


def test_smooth_corners_of_one_number_share_a_normal_weighted_by_angles():
    """At vertex 1 the square below has one corner of 90 degrees, the wall two that sum to 90."""
    shading = np.where(np.isin(FOLD_TRIANGLES, (1, 2)), FOLD_TRIANGLES, -1).astype(np.int32)
    normals = NormalTable(fold(shading))
    table = normals.compute(FOLD)
    half = np.sqrt(0.5)
    assert table[normals.corners[0, 1]] == pytest.approx([half, 0, half], abs=1e-6)
    assert normals.corners[0, 1] == normals.corners[3, 0]
    assert table[normals.corners[0, 0]] == pytest.approx([0, 0, 1])


def test_normals_follow_a_mesh_that_bends():
    normals = NormalTable(square())
    assert normals.compute(SQUARE[:, [0, 2, 1]])[0] == pytest.approx([0, -1, 0])
