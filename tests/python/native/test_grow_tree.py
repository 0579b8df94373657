"""The sample trees: form 1 of the export, reproducible, and grown by the rules they claim."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import snowbough_native

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def grow_tree():
    spec = importlib.util.spec_from_file_location("grow_tree", ROOT / "blend_samples" / "grow_tree.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module", params=["maple", "spruce"])
def tree(request, grow_tree):
    species = grow_tree.SPECIES[request.param]
    return species, grow_tree.grow_tree(species, seed=1, height=6.0)


def groups(path):
    """The file's groups in order: name -> list of (4, 3) squares, Y up."""
    vertices, found = [], {}
    for line in path.read_text().splitlines():
        if line.startswith("g "):
            squares = found.setdefault(line[2:], [])
        elif line.startswith("v "):
            vertices.append([float(word) for word in line.split()[1:]])
        elif line.startswith("f "):
            squares.append(np.array([vertices[int(word.split("/")[0]) - 1] for word in line.split()[1:]]))
    return found


def test_every_group_is_a_row_of_separate_squares(grow_tree, tree, tmp_path):
    _, trunk = tree
    branches, leaves = grow_tree.write_squares(trunk, tmp_path / "tree.obj")
    found = groups(tmp_path / "tree.obj")
    assert leaves == 0 and len(found) == branches
    assert list(found)[0] == "trunk1"
    for squares in found.values():
        assert len(squares) >= 3
        for square in squares:
            edges = np.linalg.norm(np.roll(square, -1, axis=0) - square, axis=1)
            assert edges.max() - edges.min() < 1e-5


def test_same_seed_gives_the_same_bytes_and_another_seed_does_not(grow_tree, tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        grow_tree.main(["--seed", str(seed), "--leaves", str(tmp_path / f"{name}.obj")])
    texts = [(tmp_path / f"{name}.obj").read_text().replace(f"{name}.mtl", "") for name in "abc"]
    assert texts[0] == texts[1]
    assert texts[0] != texts[2]


def test_children_stand_on_their_parents_centreline(grow_tree, tree):
    _, trunk = tree
    for shoot in grow_tree.each_shoot(trunk):
        heads, tails = shoot.points[:-1], shoot.points[1:]
        for _, child in shoot.children:
            along = np.clip(
                ((child.points[0] - heads) * (tails - heads)).sum(1) / ((tails - heads) ** 2).sum(1), 0, 1
            )
            nearest = np.linalg.norm(heads + along[:, None] * (tails - heads) - child.points[0], axis=1)
            assert nearest.min() < 1e-6


def test_a_limb_holds_at_least_the_wood_of_its_children(grow_tree, tree):
    species, trunk = tree
    for shoot in grow_tree.each_shoot(trunk):
        children = sum(child.radii[0] ** species.exponent for _, child in shoot.children)
        assert shoot.radii[0] ** species.exponent >= children


def test_the_tree_is_as_high_as_asked(grow_tree, tree):
    _, trunk = tree
    top = max(shoot.points[:, 2].max() for shoot in grow_tree.each_shoot(trunk))
    assert top == pytest.approx(6.0)


def test_the_demos_trees_are_of_a_size_that_stays_quick(grow_tree, tree):
    _, trunk = tree
    assert 150 <= len(list(grow_tree.each_shoot(trunk))) <= 400


def test_leaves_come_last_in_a_group_with_texture_coordinates(grow_tree, tmp_path):
    grow_tree.main(["--leaves", str(tmp_path / "tree.obj")])
    text = (tmp_path / "tree.obj").read_text()
    leaves = text[text.index("g leaves") :]
    faces = [line for line in leaves.splitlines() if line.startswith("f ")]
    assert len(faces) > 500
    assert all(word.count("/") == 1 for word in faces[0].split()[1:])
    assert "g " not in leaves[2:]
    assert "newmtl leaf" in (tmp_path / "tree.mtl").read_text()


def test_the_reader_takes_every_leaf_for_foliage_and_no_wood(grow_tree, tmp_path, tree):
    species, trunk = tree
    leaves = list(grow_tree.leaf_shapes(trunk, species, 6.0, np.random.default_rng(2)))
    branches, count = grow_tree.write_squares(trunk, tmp_path / "tree.obj", leaves)
    skeleton = snowbough_native.read_tree(str(tmp_path / "tree.obj"))
    assert len(skeleton.branches) == branches
    assert skeleton.report["foliage_parts"] == count


def test_the_small_tree_in_the_repository_is_what_the_script_grows(grow_tree, tmp_path):
    grow_tree.main(["--seed", "5", "--height", "3", "--levels", "2", str(tmp_path / "small_maple.obj")])
    grown, kept = (
        (folder / "small_maple.obj").read_text().split() for folder in (tmp_path, ROOT / "tests" / "data")
    )
    # Another system's sines and cosines differ in their last bits, so that 0 may be -0.
    assert [word.replace("-0.000000", "0.000000") for word in grown] == [
        word.replace("-0.000000", "0.000000") for word in kept
    ]
