"""The rebuilt tree in Python: arrays, options, bones, and, where available, real exports."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

TREES = Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "trees"
REAL_TREES = [
    "tubes/AL06a.obj",
    "tubes/BL02A_Betula_lenta.obj",
    "squares/AL06a_squares.obj",
    "squares/BL02A_squares_tris.obj",
    "levels/Acer_saccharum_y1.obj",
    "levels/quaking_aspen.obj",
    "levels/sapling_tree1.obj",
    "levels/test_small.obj",
]


def branch(name, level, parent, points, radius):
    points = np.array(points, np.float32)
    radii = np.full(len(points), radius, np.float32)
    return {
        "name": name,
        "level": level,
        "parent": parent,
        "attach_point": points[0],
        "points": points,
        "radii": radii,
        "areas": np.float32(np.pi) * radii**2,
    }


def small_tree():
    return native.Skeleton.from_branches(
        [
            branch("trunk", 0, -1, [(0, 0, z) for z in range(6)], 0.2),
            branch("left", 1, 0, [(0, 0, 2.5), (-1, 0, 3), (-2, 0, 3.2)], 0.1),
            branch("right", 1, 0, [(0, 0, 3.5), (1, 0, 4), (2, 0, 4.2)], 0.05),
            branch("twig", 2, 2, [(1, 0, 4), (1.2, 0.5, 4.4)], 0.02),
        ]
    )


def real_tree(name):
    path = TREES / name
    if not path.is_file():
        pytest.skip(f"{name} is not in shared/data/trees")
    return native.read_tree(path)


def centreline_distance(branches, points, radii_of):
    """Distance from each point to the branch, less its radius there."""
    start, step = branches.points[:-1].astype(float), np.diff(branches.points.astype(float), axis=0)
    square = np.maximum((step**2).sum(1), 1e-30)
    t = np.clip(((points[:, None] - start) * step).sum(2) / square, 0, 1)
    distance = np.linalg.norm(points[:, None] - start - step * t[..., None], axis=2)
    nearest, each = distance.argmin(1), np.arange(len(points))
    along = t[each, nearest]
    radius = radii_of[nearest] * (1 - along) + radii_of[nearest + 1] * along
    return distance[each, nearest] - radius


def wood_outside_parents(skeleton, pieces=8):
    """Volume of the original tubes without the parts inside their parents."""
    branches = skeleton.branches
    t = (np.arange(pieces) + 0.5) / pieces
    total = 0.0
    for limb in branches:
        points, width = limb.points.astype(float), np.sqrt(limb.areas.astype(float))
        if len(points) < 2:
            continue
        middle = (points[:-1, None] * (1 - t)[:, None] + points[1:, None] * t[:, None]).reshape(-1, 3)
        area = (width[:-1, None] * (1 - t) + width[1:, None] * t).ravel() ** 2
        volume = np.repeat(np.linalg.norm(np.diff(points, axis=0), axis=1) / pieces, pieces) * area
        if limb.parent >= 0 and len(branches[limb.parent].points) > 1:
            parent = branches[limb.parent]
            radii = np.sqrt(parent.areas.astype(float) / np.pi)
            volume = volume[centreline_distance(parent, middle, radii) > 0]
        total += volume.sum()
    return total


def test_arrays_have_the_shapes_that_are_promised():
    mesh = native.build_tree_mesh(small_tree())
    vertices, faces, bones = len(mesh.vertices), len(mesh.quads), len(mesh.bone_names)
    assert bones == 5 + 2 + 2 + 1
    assert mesh.vertices.shape == (vertices, 3) and mesh.vertices.dtype == np.float32
    assert mesh.quads.shape == (faces, 4) and mesh.quads.dtype == np.int32
    assert mesh.uv_bark.shape == mesh.uv_snow.shape == (faces, 4, 2)
    assert mesh.branch_level.shape == (faces,) and set(mesh.branch_level) == {0, 1, 2}
    assert mesh.bone_indices.shape == mesh.bone_weights.shape == (vertices, 4)
    assert mesh.bone_heads.shape == mesh.bone_tails.shape == (bones, 3)
    assert mesh.bone_parents.shape == mesh.bone_levels.shape == mesh.bone_branches.shape == (bones,)
    assert mesh.bone_head_radii.shape == mesh.bone_tail_radii.shape == (bones,)
    assert mesh.bone_names[:2] == ["trunk.0", "trunk.1"]
    assert mesh.bone_map is None


def test_arrays_outlive_the_mesh():
    vertices = native.build_tree_mesh(small_tree()).vertices
    assert np.isfinite(vertices).all()


@pytest.mark.parametrize("detail", ["DRAFT", "GAME", "DEFAULT", "FILM"])
def test_a_level_of_detail_has_the_same_bones_and_arrays(detail):
    base, mesh = native.build_tree_mesh(small_tree()), native.build_tree_mesh(small_tree(), detail=detail)
    faces, vertices = len(mesh.quads), len(mesh.vertices)
    assert mesh.bone_names == base.bone_names and mesh.vertices.shape == (vertices, 3)
    assert mesh.uv_bark.shape == mesh.uv_snow.shape == (faces, 4, 2)
    assert mesh.branch_level.shape == mesh.face_branch.shape == (faces,)
    assert mesh.bone_indices.shape == mesh.bone_weights.shape == (vertices, 4)
    testing = pytest.importorskip("snowbough_testing")
    assert len(testing.crossing_quads(mesh.vertices, mesh.quads)) == 0


def test_of_three_stems_the_nearest_two_leave_each_other():
    def stem(name, around):
        way = 0.34 * np.array([np.cos(around), np.sin(around), 0.0]) + (0.0, 0.0, 0.94)
        points = [np.array([0.0, 0.0, 5.0]) + 0.5 * i * way for i in range(9)]
        return branch(name, 1, 0, points, 0.18)

    trunk = branch("trunk", 0, -1, [(0, 0, z) for z in range(11)], 0.2)
    stems = [stem("one", 0.0), stem("two", 0.7), stem("three", np.pi)]
    mesh = native.build_tree_mesh(native.Skeleton.from_branches([trunk, *stems]))
    assert mesh.branch_parents.tolist() == [-1, 0, 1, 0]
    assert mesh.report["components"] == 1 and mesh.report["euler"] == [2]


@pytest.mark.parametrize("around, parent", [(20, 1), (30, 1), (150, 0)])
def test_of_two_branches_that_leave_a_trunk_together_one_leaves_the_other(around, parent):
    def leaning(name, radius, turn):
        way = (np.sin(56 * degree) * np.cos(turn), np.sin(56 * degree) * np.sin(turn), np.cos(56 * degree))
        return branch(name, 1, 0, [np.array((0, 0, 5)) + 0.5 * i * np.array(way) for i in range(9)], radius)

    degree = np.pi / 180
    trunk = branch("trunk", 0, -1, [(0, 0, z) for z in range(11)], 0.2)
    limbs = [trunk, leaning("one", 0.18, 0.0), leaning("other", 0.17, around * degree)]
    mesh = native.build_tree_mesh(native.Skeleton.from_branches(limbs))
    assert list(mesh.branch_parents) == [-1, 0, parent]
    assert mesh.warnings == [] and mesh.report["closed"]


def test_weights_sum_to_one():
    mesh = native.build_tree_mesh(small_tree(), detail="GAME")
    assert np.abs(mesh.bone_weights.sum(1) - 1).max() < 1e-6


def test_max_influences_is_kept():
    mesh = native.build_tree_mesh(small_tree(), max_influences=1)
    assert (mesh.bone_weights > 0).sum(1).max() == 1


@pytest.mark.parametrize(
    "options, complaint",
    [
        ({"width": "WIDE"}, "ORIGINAL, INVERSE"),
        ({"species": "PALM"}, "BROADLEAF, EVERGREEN"),
        ({"detail": "FINE"}, "BASE, DRAFT, GAME, DEFAULT, FILM"),
        ({"max_influences": 5}, "max_influences must be from 1 to 4"),
    ],
)
def test_unknown_options_are_errors_that_list_the_choices(options, complaint):
    with pytest.raises(ValueError, match=complaint):
        native.build_tree_mesh(small_tree(), **options)


def test_check_mesh_says_what_is_wrong():
    mesh = native.build_tree_mesh(small_tree())
    whole = native.check_mesh(mesh.vertices, mesh.quads)
    assert whole["closed"] and whole["winding_ok"] and whole["euler"] == [2]
    torn = native.check_mesh(mesh.vertices, mesh.quads[1:])
    assert not torn["closed"] and torn["boundary_edges"] == 4
    with pytest.raises(ValueError, match="shape"):
        native.check_mesh(mesh.vertices, mesh.quads[:, :3])


def test_quad_edges_are_each_edge_once_and_the_quads_own():
    mesh = native.build_tree_mesh(small_tree())
    ends, of_quad = native.quad_edges(mesh.quads, len(mesh.vertices))
    sides = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=-1)
    assert np.array_equal(ends[of_quad], np.sort(sides, axis=-1))
    assert len(np.unique(ends, axis=0)) == len(ends) == 2 * len(mesh.quads)
    with pytest.raises(ValueError, match="refer to vertex 7, but there are 4"):
        native.quad_edges([[0, 1, 2, 7]], 4)


def descendants(parents, bone):
    found = np.zeros(len(parents), bool)
    found[bone] = True
    for child in range(bone + 1, len(parents)):
        found[child] = parents[child] >= 0 and found[parents[child]]
    return found


@pytest.mark.parametrize("bone", range(10))
def test_bending_a_bone_moves_only_what_hangs_on_it(bone):
    mesh = native.build_tree_mesh(small_tree())
    moved = descendants(mesh.bone_parents, bone)
    share = (mesh.bone_weights * moved[mesh.bone_indices]).sum(1)
    half = np.sqrt(0.5)
    turn = np.array([[1, 0, 0], [0, half, -half], [0, half, half]])
    bent = (mesh.vertices - mesh.bone_heads[bone]) @ turn.T + mesh.bone_heads[bone]
    posed = mesh.vertices * (1 - share[:, None]) + bent * share[:, None]
    still = share == 0
    assert still.any() or bone == 0
    assert np.array_equal(posed[still], mesh.vertices[still])
    assert np.abs(posed[~still] - mesh.vertices[~still]).max() > 1e-3
    assert native.check_mesh(posed, mesh.quads)["closed"]


def test_reduce_bones_hands_weights_to_ancestors():
    mesh = native.build_tree_mesh(small_tree())
    reduced = native.reduce_bones(mesh, max_bones=0, max_bone_level=0)
    assert reduced.bone_names == [f"trunk.{i}" for i in range(5)]
    assert list(reduced.bone_map) == [0, 1, 2, 3, 4, 2, 2, 3, 3, 3]
    assert np.abs(reduced.bone_weights.sum(1) - 1).max() < 1e-6
    assert len(mesh.bone_names) == 10
    assert len(native.reduce_bones(mesh, max_bones=6).bone_names) == 6


def test_leaf_bones_is_empty_without_leaves():
    skeleton = small_tree()
    assert native.leaf_bones(skeleton, native.build_tree_mesh(skeleton)).shape == (0,)


def test_leaves_hang_on_the_bone_nearest_to_them():
    skeleton = real_tree("levels/quaking_aspen.obj")
    mesh = native.build_tree_mesh(skeleton)
    foliage = skeleton.foliage
    bones = native.leaf_bones(skeleton, mesh)
    assert bones.shape == foliage.leaf_branch.shape
    if len(bones) == 0:
        pytest.skip("quaking_aspen.obj came in without leaves")
    assert np.array_equal(mesh.bone_branches[bones], foliage.leaf_branch)


@pytest.mark.parametrize("detail", ["DRAFT", "DEFAULT"])
@pytest.mark.parametrize("name", REAL_TREES)
def test_a_real_export_stays_closed_at_a_level_of_detail(name, detail):
    skeleton = real_tree(name)
    mesh = native.build_tree_mesh(skeleton, detail=detail)
    check = native.check_mesh(mesh.vertices, mesh.quads)
    roots = sum(limb.parent < 0 for limb in skeleton.branches)
    assert check["closed"] and check["winding_ok"] and check["euler"] == [2] * roots
    assert check["zero_area_faces"] == 0 and check["unused_vertices"] == 0
    assert np.abs(mesh.bone_weights.sum(1) - 1).max() < 1e-6
    testing = pytest.importorskip("snowbough_testing")
    layout = testing.measure_uv_layout(mesh.uv_snow, mesh.vertices, mesh.quads, 1024)
    assert layout["overlap_texels"] == 0 and layout["outside_faces"] == 0 and layout["min_face_area"] > 0


def test_the_default_detail_of_a_real_tree_has_a_round_trunk_within_its_budget():
    mesh = native.build_tree_mesh(real_tree("tubes/AL06a.obj"), detail="DEFAULT")
    assert len(mesh.quads) < 60000
    # The cap that closes the root of a limb of n sides has n / 4 faces along each of its edges.
    assert (mesh.face_part == 3).sum() == 16


@pytest.mark.parametrize("name", REAL_TREES)
def test_a_real_export_becomes_one_closed_surface_a_root(name):
    skeleton = real_tree(name)
    mesh = native.build_tree_mesh(skeleton)
    report = mesh.report
    roots = sum(limb.parent < 0 for limb in skeleton.branches)
    assert report["components"] == roots
    assert report["euler"] == [2] * roots
    assert report["closed"] and report["winding_ok"]
    assert report["zero_area_faces"] == 0 and report["unused_vertices"] == 0
    assert report["crossing_junctions"] <= 0.02 * report["junctions"]
    assert np.abs(mesh.bone_weights.sum(1) - 1).max() < 1e-6
    assert set(mesh.bone_branches) == set(range(len(skeleton.branches)))
    assert abs(report["volume"] / wood_outside_parents(skeleton) - 1) < 0.10


def test_progress_of_the_mesh_runs_from_0_to_1():
    shares = []
    native.build_tree_mesh(small_tree(), progress=shares.append)
    assert len(shares) > 5
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == 1


@pytest.mark.parametrize("until", [0.1, 0.4, 0.6, 0.8])
def test_progress_cancels_the_surface_and_the_charts(until):
    shares = []

    def go_on(share):
        shares.append(share)
        return share < until

    with pytest.raises(KeyboardInterrupt):
        native.build_tree_mesh(small_tree(), progress=go_on)
    assert [share >= until for share in shares].count(True) == 1  # it asks no more after the answer


def test_what_progress_raises_comes_through_the_mesh():
    def stop(share):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        native.build_tree_mesh(small_tree(), progress=stop)


INTERRUPTED_BUILD = """
import signal, sys
import snowbough_native

# A job in the background ignores it, and so do its children.
signal.signal(signal.SIGINT, signal.default_int_handler)
skeleton = snowbough_native.read_tree(sys.argv[1])
# Ctrl-C is pressed while the surface is under way.
asked = []
def press(share):
    asked.append(share)
    if len(asked) == 3:
        signal.raise_signal(signal.SIGINT)
try:
    snowbough_native.build_tree_mesh(skeleton, progress=press)
    print("finished")
except KeyboardInterrupt:
    print("interrupted", len(asked))
"""


def test_ctrl_c_ends_a_build():
    maple = Path(__file__).resolve().parents[2] / "data" / "small_maple.obj"
    environment = dict(os.environ, PYTHONPATH=os.path.dirname(native.__file__))
    run = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_BUILD, str(maple)],
        env=environment,
        text=True,
        capture_output=True,
        timeout=60,
    )
    assert run.returncode == 0, run.stderr
    word, calls = run.stdout.split()
    assert word == "interrupted" and int(calls) < 6


def test_the_mesh_does_not_depend_on_threads():
    one, three = (native.build_tree_mesh(small_tree(), threads=threads) for threads in (1, 3))
    for name in ("vertices", "quads", "uv_bark", "uv_snow", "bone_indices", "bone_weights"):
        assert np.array_equal(getattr(one, name), getattr(three, name)), name
    with pytest.raises(ValueError, match="threads"):
        native.build_tree_mesh(small_tree(), threads=-1)


@pytest.mark.parametrize("far", [1e4, 1e6, 1e7, -3e8])
def test_a_tree_far_from_the_origin_is_the_same_tree_there(tmp_path, far):
    maple = Path(__file__).resolve().parents[2] / "data" / "small_maple.obj"
    lines = maple.read_text().splitlines()
    moved = [
        "v "
        + " ".join(f"{float(number) + by:.6f}" for number, by in zip(line.split()[1:], (far, 2 * far, -far)))
        if line.startswith("v ")
        else line
        for line in lines
    ]
    (tmp_path / "far.obj").write_text("\n".join(moved))
    here, there = native.read_tree(str(maple)), native.read_tree(str(tmp_path / "far.obj"))
    assert here.origin == (0.0, 0.0, 0.0)
    assert "far from the file's origin" in " ".join(there.report["warnings"])
    expected, mesh = native.build_tree_mesh(here), native.build_tree_mesh(there)
    assert len(mesh.quads) == len(expected.quads)
    assert mesh.report["zero_area_faces"] == 0 and mesh.report["closed"]
    # Of the Y up file: x, -z, y.
    to_there = np.array(there.origin) - np.array([far, far, 2 * far])
    assert np.abs(to_there).max() < 100.0
    middle, moved_middle = (np.mean(np.array(m.vertices, np.float64), axis=0) for m in (expected, mesh))
    assert moved_middle + to_there == pytest.approx(middle, abs=1e-3)
