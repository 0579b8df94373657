"""read_tree and Skeleton in Python, on small files and, where available, on real trees."""

import json
import os
import pathlib
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import snowbough_native as native
import tube_tree

TREES = pathlib.Path(__file__).resolve().parents[3] / ".." / "shared" / "data" / "trees"
needs_trees = pytest.mark.skipif(not TREES.is_dir(), reason="../shared/data/trees is not there")


def ring(x, y, z, radius):
    return [(x + radius, y, z), (x, y + radius, z), (x - radius, y, z), (x, y - radius, z)]


def tube(points, radius, first, flat=False):
    """OBJ text of a four-sided tube along z, or of squares across it."""
    lines = []
    for point in points:
        lines += ["v %g %g %g" % corner for corner in ring(*point, radius)]
    for i in range(len(points)):
        a = first + 4 * i
        if flat:
            lines.append(f"f {a} {a + 1} {a + 2} {a + 3}")
        elif i + 1 < len(points):
            for c in range(4):
                d = (c + 1) % 4
                lines.append(f"f {a + c} {a + d} {a + 4 + d} {a + 4 + c}")
    return "\n".join(lines) + "\n"


def small_tree(flat=False):
    trunk = [(0, 0, z) for z in range(6)]
    limb = [(0.3 * i, 0, 3 + 0.5 * i) for i in range(4)]
    return (
        "g trunk1\n"
        + tube(trunk, 0.4, 1, flat)
        + "g branch1\n"
        + tube(limb, 0.1, 25, flat)
        + "g leaves\nv 1 0.2 4.5\nv 1.1 0.4 4.5\nv 1 0.6 4.5\nvt 0.25 0.75\nf 41/1 42/1 43/1\n"
    )


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small tree ä.obj"
    path.write_text(small_tree())
    return path


def one_branch(**changes):
    branch = {
        "name": "trunk",
        "level": 0,
        "parent": -1,
        "attach_point": (0, 0, 0),
        "points": [(0, 0, 0), (0, 0, 2)],
        "radii": [0.2, 0.1],
        "areas": [0.1, 0.02],
    }
    branch.update(changes)
    return branch


def test_branches_are_arrays(small):
    skeleton = native.read_tree(small)
    trunk, branch = skeleton.branches
    assert (trunk.name, trunk.level, trunk.parent) == ("trunk1", 0, -1)
    assert (branch.name, branch.level, branch.parent) == ("branch1", 1, 0)
    assert trunk.points.shape == (6, 3) and trunk.points.dtype == np.float32
    np.testing.assert_allclose(trunk.radii, 0.4, rtol=1e-6)
    np.testing.assert_allclose(trunk.areas, 0.32, rtol=1e-5)
    np.testing.assert_allclose(branch.attach_point, (0, 0, 3), atol=1e-6)
    assert skeleton.height == pytest.approx(5)


def test_arrays_are_read_only_and_outlive_the_skeleton(small):
    points = native.read_tree(small).branches[0].points
    assert not points.flags.writeable
    np.testing.assert_array_equal(points[:, 2], range(6))


def test_report(small):
    report = native.read_tree(small).report
    assert report == {
        "form": "TUBES_PER_GROUP",
        "up_axis": "Z",
        "branches_per_level": [1, 1],
        "skipped_parts": [],
        "extra_roots": [],
        "foliage_parts": 1,
        "wood_name": "trunk1",
        "coverage": 1.0,
        "warnings": [],
    }


def test_foliage(small):
    foliage = native.read_tree(small).foliage
    assert foliage.vertices.shape == (3, 3)
    assert foliage.face_begin.tolist() == [0, 3]
    assert foliage.corner_vertex.tolist() == [0, 1, 2]
    assert foliage.corner_uv.tolist() == [[0.25, 0.75]] * 3
    assert foliage.face_material.tolist() == [-1]
    assert foliage.face_leaf.tolist() == [0]
    assert foliage.leaf_branch.tolist() == [1]
    assert foliage.leaf_attach_point.shape == (1, 3)
    assert foliage.materials == []


def test_simplify(small):
    assert len(native.read_tree(small, simplify="THESIS").branches[0].points) == 2
    assert len(native.read_tree(small, simplify="TOLERANCE").branches[0].points) == 3


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"up_axis": "X"}, "up_axis"),
        ({"simplify": "ALL"}, "simplify"),
        ({"tolerance": -1}, "tolerance"),
        ({"levels": "stem"}, "'trunk1'"),
    ],
)
def test_bad_options(small, arguments, message):
    with pytest.raises(ValueError, match=message):
        native.read_tree(small, **arguments)


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "not a Wavefront OBJ"),
        ("Dear reader,\nhello\n", "not a Wavefront OBJ"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 x\n", r"bad\.obj:3: malformed number 'x'"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", r"bad\.obj:4: vertex index 7 is out of range"),
        ("v 0 0 0\nv nan 0 0\n", r"bad\.obj:2: .*not finite"),
        ("g leaves\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "has no branches, only 1 leaves"),
    ],
)
def test_bad_files(tmp_path, text, message):
    path = tmp_path / "bad.obj"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        native.read_tree(path)


def test_names_in_latin_1_are_text(tmp_path):
    path = tmp_path / "latin.obj"
    text = small_tree().replace("g trunk1", "g trunk\xe9").replace("g leaves", "g leaves\nusemtl bl\xe4tter")
    path.write_bytes(text.encode("latin-1"))
    (tmp_path / "latin.mtl").write_bytes("newmtl bl\xe4tter\nmap_Kd \xe9t\xe9.png\n".encode("latin-1"))
    (tmp_path / "\xe9t\xe9.png").touch()
    skeleton = native.read_tree(path)
    assert skeleton.branches[0].name == "trunk\xe9"
    (leaf,) = skeleton.foliage.materials
    assert (leaf.name, leaf.defined) == ("bl\xe4tter", True)
    assert pathlib.Path(leaf.diffuse_texture.path) == tmp_path / "\xe9t\xe9.png"
    path.write_bytes(b"v 0 0 \xe9\n")
    with pytest.raises(ValueError, match="malformed number '\xe9'"):
        native.read_tree(path)


def test_missing_file(tmp_path):
    with pytest.raises(ValueError, match="cannot be opened"):
        native.read_tree(tmp_path / "nothing.obj")
    with pytest.raises(ValueError, match="directory"):
        native.read_tree(tmp_path)


def test_progress_runs_from_0_to_1(small):
    shares = []
    native.read_tree(small, progress=shares.append)
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == 1


INTERRUPTED_READ = """
import signal, sys, threading, time
import snowbough_native

# A job in the background ignores it, and so do its children.
signal.signal(signal.SIGINT, signal.default_int_handler)
sent = []

def press():
    time.sleep(0.05)
    sent.append(time.perf_counter())
    signal.raise_signal(signal.SIGINT)

threading.Thread(target=press).start()
try:
    snowbough_native.read_tree(sys.argv[1])
    print("finished")
except KeyboardInterrupt:
    print("interrupted", time.perf_counter() - sent[0])
"""


def test_ctrl_c_ends_a_long_read(tmp_path):
    # Relative indices make equal blocks a file of many tubes: some 40 MB, far more than 50 ms of reading.
    block = "".join("v %g %g %g\n" % corner for z in range(20) for corner in ring(0, 0, z, 0.1))
    block += "".join(f"f {a} {a + 1} {a + 5} {a + 4}\n" for a in range(-80, -5))
    path = tmp_path / "many.obj"
    path.write_text(block * (40_000_000 // len(block)))
    environment = dict(os.environ, PYTHONPATH=os.path.dirname(native.__file__))
    run = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_READ, str(path)],
        env=environment,
        text=True,
        capture_output=True,
        timeout=60,
    )
    path.unlink()
    assert run.returncode == 0, run.stderr
    word, *seconds = run.stdout.split()
    assert word == "interrupted"
    assert float(seconds[0]) < 2


def test_progress_cancels(small):
    with pytest.raises(KeyboardInterrupt):
        native.read_tree(small, progress=lambda share: False)


def welded_lines():
    """OBJ lines of a trunk and two limbs in one closed surface."""
    limbs = [
        ("trunk", -1, (0, 0, 0), (0, 0, 8), 0.4),
        ("left", 0, (0, 0, 3), (-4, 0.5, 6), 0.2),
        ("right", 0, (0, 0, 4.5), (3, -1, 7.5), 0.15),
    ]
    grown = native.Skeleton.from_branches(
        [
            {"name": name, "level": 0 if parent < 0 else 1, "parent": parent, "attach_point": begin,
             "points": np.linspace(begin, end, 9), "radii": np.linspace(radius, radius / 4, 9),
             "areas": np.pi * np.linspace(radius, radius / 4, 9) ** 2}
            for name, parent, begin, end, radius in limbs
        ]
    )  # fmt: skip
    mesh = native.build_tree_mesh(grown, detail="GAME")
    lines = ["v %.6f %.6f %.6f" % tuple(p) for p in mesh.vertices]
    return lines + ["f " + " ".join(str(v + 1) for v in quad) for quad in mesh.quads]


def test_a_welded_tree_can_be_cancelled_while_it_is_traced(tmp_path):
    path = tmp_path / "welded.obj"
    path.write_text("\n".join(welded_lines()) + "\n")
    shares = []
    assert native.read_tree(path, up_axis="Z", progress=shares.append).report["form"] == "WELDED"
    assert shares == sorted(shares)
    traced = sorted({share for share in shares if 0.7 < share < 0.8})
    assert len(traced) >= 6
    with pytest.raises(KeyboardInterrupt):
        native.read_tree(path, up_axis="Z", progress=lambda share: share < traced[3])


def test_what_progress_raises_comes_through(small):
    def stop(share):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        native.read_tree(small, progress=stop)


def test_from_branches():
    child = one_branch(name="twig", level=1, parent=0, attach_point=(0, 0, 1))
    skeleton = native.Skeleton.from_branches([one_branch(), child])
    assert [branch.name for branch in skeleton.branches] == ["trunk", "twig"]
    assert skeleton.branches[1].attach_point.tolist() == [0, 0, 1]
    assert skeleton.report["branches_per_level"] == [1, 1]
    assert skeleton.height == 2


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"points": np.zeros((0, 3))}, "no points"),
        ({"points": [1, 2, 3]}, "shape"),
        ({"radii": [0.1]}, "as many radii"),
        ({"areas": [0.1, -1]}, "area"),
        ({"points": [(0, 0, 0), (0, 0, float("nan"))]}, "not finite"),
        ({"parent": 0}, "after its parent"),
        ({"level": -1}, "level"),
        ({"name": 3}, "string"),
        ({"attach_point": (0, 0)}, "attach_point"),
        ({"points": "no"}, "points"),
    ],
)
def test_from_branches_checks(changes, message):
    with pytest.raises(ValueError, match=message):
        native.Skeleton.from_branches([one_branch(**changes)])


def test_from_branches_names_the_missing_field():
    branch = one_branch()
    del branch["areas"]
    with pytest.raises(ValueError, match="branch 0 lacks 'areas'"):
        native.Skeleton.from_branches([branch])
    with pytest.raises(ValueError, match="at least one"):
        native.Skeleton.from_branches([])


def z_up(points):
    points = np.asarray(points, np.float32)
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


@needs_trees
@pytest.mark.parametrize("name", ["AL06a_squares", "BL02A_squares_tris"])
def test_squares_are_exact(name):
    skeleton = native.read_tree(TREES / "squares" / f"{name}.obj")
    truth = json.loads((TREES / "squares" / f"{name}.json").read_text())["branches"]
    found = {branch.name: branch for branch in skeleton.branches}
    assert skeleton.report["form"] == "SQUARES_PER_GROUP" and skeleton.report["up_axis"] == "Y"
    assert sorted(found) == sorted(branch["name"] for branch in truth)
    right = 0
    for branch in truth:
        mine = found[branch["name"]]
        np.testing.assert_allclose(mine.points, z_up(branch["points"]), atol=1e-5 * skeleton.height)
        parent = skeleton.branches[mine.parent].name if mine.parent >= 0 else None
        right += parent == branch["parent"]
        assert mine.level == branch["level"]
    assert right >= 0.99 * len(truth)


def segment_distances(points, polylines):
    begin = np.concatenate([line[:-1] for line in polylines]).astype(float)
    along = np.concatenate([line[1:] - line[:-1] for line in polylines]).astype(float)
    squared = np.maximum((along**2).sum(1), 1e-30)
    distances = []
    for point in points:
        t = np.clip(((point - begin) * along).sum(1) / squared, 0, 1)
        distances.append(np.linalg.norm(point - begin - t[:, None] * along, axis=1).min())
    return np.array(distances)


@needs_trees
def test_al06a_lies_on_the_skeleton_that_others_made():
    skeleton = native.read_tree(TREES / "tubes" / "AL06a.obj")
    assert skeleton.report["branches_per_level"][0] == 1 and len(skeleton.branches) == 199
    lines = (TREES / "tubes" / "AL06a.txtskl").read_text().splitlines()
    theirs = np.array([line.split()[:3] for line in lines if len(line.split()) == 4], float)
    # Their z is negated against the OBJ's, which is Y up.
    theirs = theirs[:, [0, 2, 1]]
    distances = segment_distances(theirs, [branch.points for branch in skeleton.branches])
    assert np.median(distances) < 1e-4 * skeleton.height


@needs_trees
@pytest.mark.parametrize(
    "name, form, up_axis, branches, foliage",
    [
        ("tubes/BL02A_Betula_lenta", "MERGED_TUBES", "Y", 1348, 0),
        ("levels/Acer_saccharum_y1", "TUBES_PER_LEVEL", "Y", 27, 0),
        ("levels/quaking_aspen", "TUBES_PER_LEVEL", "Y", 1222, 21988),
        ("levels/test_small", "TUBES_PER_LEVEL", "Y", 3, 3),
        ("levels/sapling_tree1", "MERGED_TUBES", "Z", 46, 0),
    ],
)
def test_real_trees_need_no_options(name, form, up_axis, branches, foliage):
    skeleton = native.read_tree(TREES / f"{name}.obj")
    report = skeleton.report
    assert (report["form"], report["up_axis"], len(skeleton.branches), report["foliage_parts"]) == (
        form,
        up_axis,
        branches,
        foliage,
    )
    assert report["extra_roots"] == [] and report["skipped_parts"] == []
    assert report["branches_per_level"][0] == 1
    assert skeleton.branches[0].points[0, 2] < 0.05 * skeleton.height


@needs_trees
def test_aspen_leaves_hang_twig_by_twig():
    """Arbaro writes leaves in the order of the twigs, so their twigs' numbers must not decrease."""
    skeleton = native.read_tree(TREES / "levels" / "quaking_aspen.obj")
    branches, leaf_branch = skeleton.branches, skeleton.foliage.leaf_branch
    twigs = [int(branches[b].name.removeprefix("stems_2_")) for b in leaf_branch if branches[b].level == 2]
    assert len(twigs) > 0.999 * len(leaf_branch)
    assert np.count_nonzero(np.diff(twigs) < 0) < 0.001 * len(twigs)


@needs_trees
def test_the_gil_is_free_while_reading():
    reader = threading.Thread(target=native.read_tree, args=(TREES / "levels" / "quaking_aspen.obj",))
    ticks = 0
    reader.start()
    while reader.is_alive():
        ticks += 1
        time.sleep(0.001)
    assert ticks > 5


def test_foliage_takes_a_bool_a_word_or_names(tmp_path):
    ring = [(0.1, 0), (0, 0.1), (-0.1, 0), (0, -0.1)]
    lines = ["g trunk1"] + [f"v {x} {y} {z}" for z in range(3) for x, y in ring]
    for low in (1, 5):
        lines += [f"f {low + k} {low + (k + 1) % 4} {low + 4 + (k + 1) % 4} {low + 4 + k}" for k in range(4)]
    lines += ["v 0 0 2", "v 0.3 0 2.1", "v 0.3 0.1 2.3", "g tags", "f 13 14 15"]
    path = tmp_path / "tree.obj"
    path.write_text("\n".join(lines) + "\n")
    corners = [
        len(native.read_tree(path, foliage=value).foliage.corner_vertex)
        for value in (True, "AUTO", "", "tags", False, "NONE")
    ]
    assert corners == [3, 3, 3, 3, 0, 0]
    with pytest.raises(ValueError, match="starts with 'petals'"):
        native.read_tree(path, foliage="petals")
    with pytest.raises(ValueError, match="foliage must be"):
        native.read_tree(path, foliage=3)


def curved_leaves(count):
    """OBJ lines of leaves: curved grids of 3 by 4 corners, folded along the middle, at random places."""
    rng = np.random.default_rng(3)
    lines = []
    for _ in range(count):
        at = rng.normal(size=3) * (1, 1, 0.5) + (0, 0, 4)
        bearing, rise = rng.uniform(0, 2 * np.pi), rng.uniform(-0.5, 0.5)
        along = np.array((np.cos(bearing), np.sin(bearing), rise))
        across = np.array((-np.sin(bearing), np.cos(bearing), 0))
        for row in range(4):
            for column in range(3):
                wide = 0.03 * (column - 1) * (2 if row in (1, 2) else 1)
                up = (0, 0, 0.01 * (column != 1) + 0.008 * row * row)
                lines.append("v %.5f %.5f %.5f" % tuple(at + 0.04 * row * along + wide * across + up))
        for row in range(3):
            for column in range(2):
                a = -12 + 3 * row + column
                lines.append(f"f {a} {a + 1} {a + 4} {a + 3}")
    return lines


def test_curved_leaves_without_names_are_no_limbs(tmp_path):
    groups = tube_tree.obj_text().split("g ")
    text = "".join(part.partition("\n")[2] if k else part for k, part in enumerate(groups))
    path = tmp_path / "nameless.obj"
    path.write_text("\n".join([text.replace("usemtl bark", ""), *curved_leaves(300), ""]))
    skeleton = native.read_tree(path)
    assert len(skeleton.branches) == 4 and len(skeleton.foliage.leaf_branch) == 300


@pytest.mark.parametrize("leaves", [20, 3000])
def test_the_largest_piece_at_the_ground_is_never_foliage(tmp_path, leaves):
    # A forking surface without names, below few and below many leaves.
    wood, path = welded_lines(), tmp_path / "nameless.obj"
    path.write_text("\n".join([*wood, *curved_leaves(leaves), ""]))
    skeleton = native.read_tree(path, up_axis="Z")
    assert len(skeleton.branches) == 3
    assert len(skeleton.foliage.vertices) == 12 * leaves
    assert len(skeleton.foliage.leaf_branch) == leaves


def tubes_without_shared_vertices():
    """Two five-sided tubes, the second on the first; each triangle has its own vertices, and each tip a line."""
    triangles = []
    for begin, step, radius in (((0, 0, 0), (0, 0, 1), 0.3), ((0, 0, 2), (0.6, 0, 0.2), 0.1)):
        rings = []
        for i in range(5):
            centre = np.array(begin) + i * np.array(step)
            across = (0, 1, 0), ((0, 0, 1) if step[0] else (1, 0, 0))
            size = radius * (1 - i / 4)
            angles = 2 * np.pi * np.arange(5) / 5
            rings.append(
                [
                    centre + size * (np.cos(t) * np.array(across[0]) + np.sin(t) * np.array(across[1]))
                    for t in angles
                ]
            )
        for low, high in zip(rings, rings[1:]):
            for c in range(5):
                triangles += [
                    (low[c], low[(c + 1) % 5], high[c]),
                    (low[(c + 1) % 5], high[(c + 1) % 5], high[c]),
                ]
    return np.array(triangles).reshape(-1, 3)


def read_mesh(vertices, names=("oak",), face_names=None, **settings):
    faces = len(vertices) // 3
    face_names = np.tile([0, -1], (faces, 1)) if face_names is None else face_names
    corners = np.arange(len(vertices))
    return native.read_tree_mesh(
        "oak", vertices, np.arange(faces + 1) * 3, corners, None, face_names, list(names), [], **settings
    )


def test_a_mesh_whose_faces_share_no_vertices_has_its_limbs():
    skeleton = read_mesh(tubes_without_shared_vertices())
    assert [branch.parent for branch in skeleton.branches] == [-1, 0]
    assert np.allclose(skeleton.branches[0].points, [(0, 0, z) for z in range(5)], atol=1e-6)
    assert skeleton.report["skipped_parts"] == [{"name": "oak (10 parts)", "reason": "without area"}]


def test_a_mesh_far_away_has_its_own_origin():
    skeleton = read_mesh(tubes_without_shared_vertices() + (1e6, 0, 0))
    assert len(skeleton.branches) == 2
    root = skeleton.origin + skeleton.branches[0].points[0]
    assert np.allclose(root, (1e6, 0, 0), atol=1e-3)


def test_a_mesh_with_indices_out_of_range_is_refused():
    vertices = tubes_without_shared_vertices()
    with pytest.raises(ValueError, match="face_names: row 0 is out of range"):
        read_mesh(vertices, face_names=np.tile([1, -1], (len(vertices) // 3, 1)))
    with pytest.raises(ValueError, match="corner_vertex holds 3, out of range"):
        native.read_tree_mesh("oak", vertices[:3], [0, 3], [0, 1, 3], None, [[0, -1]], ["oak"], [])
    with pytest.raises(ValueError, match="face_begin must rise"):
        native.read_tree_mesh("oak", vertices[:3], [0, 2], [0, 1, 2], None, [[0, -1]], ["oak"], [])
