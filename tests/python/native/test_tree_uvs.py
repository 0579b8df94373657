"""The `snow` UV maps of wood and leaves: unique, with gutters, even, and on real trees well filled."""

from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

TREES = Path(__file__).resolve().parents[4] / "shared" / "data" / "trees"
AL06A = TREES / "tubes" / "AL06a.obj"
BL02A = TREES / "tubes" / "BL02A_Betula_lenta.obj"
ASPEN = TREES / "levels" / "quaking_aspen.obj"

TIP_CAP, WALL = 2, 0


def needs(path):
    return pytest.mark.skipif(not path.exists(), reason=f"../shared/data/trees/{path.name} is absent")


REAL_TREES = [
    pytest.param(AL06A, 0.60, id="AL06a", marks=needs(AL06A)),
    pytest.param(BL02A, 0.45, id="BL02A", marks=needs(BL02A)),
]


def measure_uv_layout(*arguments):
    """Of the tests' own module, which is built in a checkout."""
    return pytest.importorskip("snowbough_testing").measure_uv_layout(*arguments)


def measure(mesh, resolution):
    return measure_uv_layout(mesh.uv_snow, mesh.vertices, mesh.quads, resolution)


def find_charts(quads, uv):
    """Chart of every face: faces that share a vertex and its coordinates hang together."""
    corners = np.concatenate([quads.reshape(-1, 1), uv.reshape(-1, 2).view(np.int32)], axis=1)
    _, joint = np.unique(corners, axis=0, return_inverse=True)
    joint = joint.reshape(quads.shape)
    label = np.arange(len(quads))
    while True:
        lowest = np.full(joint.max() + 1, len(quads))
        np.minimum.at(lowest, joint.ravel(), np.repeat(label, quads.shape[1]))
        after = lowest[joint].min(axis=1)
        after = after[after]
        if np.array_equal(after, label):
            return label
        label = after


def sample_owners(uv, charts, resolution):
    """Charts found in each texel by sampling: (texel, chart) pairs, each once."""
    steps = (np.arange(24) + 0.5) / 24
    u, v = (a.ravel()[:, None, None] for a in np.meshgrid(steps, steps))
    edge = np.linspace(0.01, 0.99, 60)[:, None, None]
    inside = 0.001
    uv = uv.astype(np.float64)
    pairs = set()
    for begin in range(0, len(uv), 2000):
        a, b, c, d = (uv[begin : begin + 2000, i] for i in range(4))
        points = [(1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d]
        centre = (a + b + c + d) / 4
        for p, q in ((a, b), (b, c), (c, d), (d, a)):
            on_edge = (1 - edge) * p + edge * q
            points.append(on_edge + inside * (centre - on_edge))
        texel = (np.concatenate(points) * resolution).astype(np.int64)
        owner = np.broadcast_to(charts[begin : begin + 2000], texel.shape[:2])
        key = (texel[..., 1] * resolution + texel[..., 0]) * len(uv) + owner
        pairs.update(np.unique(key).tolist())
    keys = np.array(sorted(pairs))
    return keys // len(uv), keys % len(uv)


def closest_charts(texel, owner, resolution, distance):
    """Number of pairs of texels of different charts no further apart than distance."""
    grid = np.full((resolution, resolution), -1, np.int64)
    grid.reshape(-1)[texel] = owner
    count = 0
    for dy in range(distance + 1):
        for dx in range(-distance, distance + 1):
            a = grid[dy:, max(dx, 0) : resolution + min(dx, 0)]
            b = grid[: resolution - dy, max(-dx, 0) : resolution + min(-dx, 0)]
            count += np.count_nonzero((a >= 0) & (b >= 0) & (a != b))
    return count


@pytest.mark.parametrize("resolution", [1024, 2048])
@pytest.mark.parametrize("path, least_fill", REAL_TREES)
def test_real_tree_is_unwrapped_evenly_without_overlap(path, least_fill, resolution):
    mesh = native.build_tree_mesh(native.read_tree(str(path)), snow_resolution=resolution)
    result = measure(mesh, resolution)
    print(path.name, resolution, result)
    assert result["overlap_texels"] == 0
    assert result["narrow_gutter_texels"] == 0
    assert result["narrow_wide_gutter_texels"] == 0
    assert result["outside_faces"] == 0
    assert result["min_face_area"] > 0
    assert result["min_chart_extent"] > 1.999
    assert result["density_p95"] < 2 * result["density_p5"]
    assert result["fill"] >= least_fill


@pytest.mark.parametrize("detail", ["DRAFT", "DEFAULT", "FILM"])
@pytest.mark.parametrize("path, _least_fill", REAL_TREES)
def test_a_real_trees_texels_are_even_at_every_detail(path, _least_fill, detail):
    result = measure(native.build_tree_mesh(native.read_tree(str(path)), detail=detail), 1024)
    assert result["density_p95"] < 2 * result["density_p5"]


@needs(BL02A)
def test_texels_are_even_with_48_of_them_for_each_branch():
    mesh = native.build_tree_mesh(native.read_tree(str(BL02A)), snow_resolution=256)
    result = measure(mesh, 256)
    assert result["density_p95"] < 2 * result["density_p5"]
    assert result["overlap_texels"] == result["narrow_gutter_texels"] == 0


@pytest.mark.parametrize("path, least_fill", REAL_TREES)
def test_real_tree_by_sampling(path, least_fill):
    """The same by an independent method."""
    mesh = native.build_tree_mesh(native.read_tree(str(path)), snow_resolution=1024)
    charts = find_charts(mesh.quads, mesh.uv_snow)
    texel, owner = sample_owners(mesh.uv_snow, charts, 1024)
    assert len(np.unique(texel)) == len(texel)
    assert closest_charts(texel, owner, 1024, 1) == 0
    extent = np.zeros((charts.max() + 1, 2))
    for axis in range(2):
        low = np.full(len(extent), np.inf)
        high = np.full(len(extent), -np.inf)
        values = mesh.uv_snow[..., axis].reshape(-1) * 1024.0
        np.minimum.at(low, np.repeat(charts, 4), values)
        np.maximum.at(high, np.repeat(charts, 4), values)
        extent[:, axis] = high - low
    wide = extent.min(axis=1) > 4.001
    for_wide_only = wide[owner]
    assert closest_charts(texel[for_wide_only], owner[for_wide_only], 1024, 2) == 0


@pytest.mark.parametrize("path, least_fill", REAL_TREES)
def test_every_wall_row_is_at_least_two_texels_wide(path, least_fill):
    mesh = native.build_tree_mesh(native.read_tree(str(path)), snow_resolution=1024)
    wall = mesh.face_part == WALL
    uv = mesh.uv_snow[wall].astype(np.float64) * 1024
    # Width across each side's lower edge, summed over the rows that have all four sides.
    width = np.abs(uv[:, 1, 0] - uv[:, 0, 0])
    key = mesh.face_branch[wall].astype(np.int64) * 100000 + mesh.face_row[wall]
    _, row, sides = np.unique(key, return_inverse=True, return_counts=True)
    total = np.bincount(row, width)
    assert total[sides == 4].min() > 1.999


@needs(AL06A)
def test_seams_run_along_the_underside():
    mesh = native.build_tree_mesh(native.read_tree(str(AL06A)), snow_resolution=1024)
    walls = {
        (b, r, s): f
        for f, (b, r, s, part) in enumerate(
            zip(mesh.face_branch, mesh.face_row, mesh.face_side, mesh.face_part)
        )
        if part == WALL
    }
    offset, weight = [], []
    for (branch, row, side), face in walls.items():
        after = walls.get((branch, row, (side + 1) % 4))
        ring = [walls.get((branch, row, k)) for k in range(4)]
        if after is None or None in ring:
            continue
        if np.array_equal(mesh.uv_snow[face, 1], mesh.uv_snow[after, 0]):
            continue
        corners = mesh.vertices[[mesh.quads[f, 0] for f in ring]]
        radius = np.linalg.norm(corners - corners.mean(axis=0), axis=1).mean()
        offset.append((mesh.vertices[mesh.quads[face, 1], 2] - corners[:, 2].mean()) / radius)
        weight.append(radius)
    assert np.average(offset, weights=weight) < -0.3
    assert np.average(np.array(offset) < 0.05, weights=weight) > 0.9


def chain(points, radius, parent, level):
    points = np.asarray(points, np.float32)
    return {
        "name": f"b{level}",
        "level": level,
        "parent": parent,
        "attach_point": points[0],
        "points": points,
        "radii": np.full(len(points), radius, np.float32),
        "areas": np.full(len(points), np.pi * radius**2, np.float32),
    }


def test_a_continuing_child_lies_on_its_parents_chart():
    skeleton = native.Skeleton.from_branches(
        [
            chain([(0, 0, 0), (0, 0, 1), (0, 0, 2)], 0.4, -1, 0),
            chain([(0, 0, 2), (0.1, 0, 3)], 0.38, 0, 1),
            chain([(0, 0, 1), (2, 0, 1.5)], 0.1, 0, 1),
        ]
    )
    mesh = native.build_tree_mesh(skeleton, snow_resolution=256)
    assert mesh.continues_parent.tolist() == [0, 1, 0]
    charts = find_charts(mesh.quads, mesh.uv_snow)
    # At the ring that both share, every side of the child meets the parent's or is cut from it where
    # the whole strip is: never is a joint in a thick short limb a seam.
    first_row = (mesh.face_branch == 1) & (mesh.face_row == 0)
    last_row = (mesh.face_branch == 0) & (mesh.face_row == mesh.branch_rows[0] - 1)
    assert set(charts[first_row]) == set(charts[last_row])
    assert set(charts[mesh.face_branch == 2]).isdisjoint(charts[mesh.face_branch == 0])


def test_a_map_too_small_is_reported_with_the_size_it_takes():
    branches = [chain([(0, 0, 0), (0, 0, 10)], 0.3, -1, 0)]
    for i in range(700):
        z = 0.5 + 9 * i / 700
        branches.append(chain([(0, 0, z), (np.cos(i), np.sin(i), z + 0.3)], 0.01, 0, 1))
    mesh = native.build_tree_mesh(native.Skeleton.from_branches(branches), snow_resolution=64)
    assert [w for w in mesh.warnings if "laid out for 128" in w]
    assert measure(mesh, 128)["overlap_texels"] == 0


@needs(BL02A)
def test_the_same_tree_gets_the_same_bits():
    first, second = (
        native.build_tree_mesh(native.read_tree(str(BL02A)), snow_resolution=1024).uv_snow.tobytes()
        for _ in range(2)
    )
    assert first == second


@needs(ASPEN)
def test_every_leaf_of_a_real_tree_has_texels_of_its_own():
    skeleton = native.read_tree(str(ASPEN))
    foliage = skeleton.foliage
    corners = np.diff(foliage.face_begin)
    assert len(corners) > 1000
    layout = native.layout_leaf_uvs(skeleton, 2048)
    assert layout["resolution"] == 2048
    # Its leaves are all of one kind of polygon.
    assert corners.min() == corners.max() and corners[0] in (3, 4)
    faces = foliage.corner_vertex.reshape(-1, corners[0])
    result = measure_uv_layout(layout["uv"].reshape(*faces.shape, 2), foliage.vertices, faces, 2048)
    print(result)
    assert result["overlap_texels"] == 0
    assert result["narrow_gutter_texels"] == 0
    assert result["outside_faces"] == 0
    assert result["min_face_area"] > 0
    assert native.layout_leaf_uvs(skeleton, 64)["resolution"] > 64


def test_a_tree_without_leaves_has_no_leaf_uvs():
    skeleton = native.Skeleton.from_branches([chain([(0, 0, 0), (0, 0, 1)], 0.1, -1, 0)])
    assert native.layout_leaf_uvs(skeleton, 64)["uv"].shape == (0, 2)


def test_the_measure_refuses_arrays_that_do_not_fit_together():
    with pytest.raises(ValueError, match="uv must have shape"):
        measure_uv_layout(np.zeros((2, 3, 2)), np.zeros((3, 3)), np.zeros((1, 3), int), 64)
    with pytest.raises(ValueError, match="out of range"):
        measure_uv_layout(np.zeros((1, 3, 2)), np.zeros((2, 3)), np.array([[0, 1, 2]]), 64)
