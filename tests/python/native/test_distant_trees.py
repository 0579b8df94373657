# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees far away: fewer triangles, but as much of the picture covered."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[3]
LEVELS = ROOT / ".." / "shared" / "data" / "trees" / "levels"
SIZE = (1280, 720)
LIGHT = {"shadow_resolution": 0, "background": (4.0, 4.0, 4.0)}
#: All patches, tessellated so finely that limbs are round.
FINE = {"min_pixels": 0, "target_pixels": 1.0, "max_level": 64}


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    path = tmp_path_factory.mktemp("tree") / "grown.obj"
    grow = ROOT / "blend_samples" / "grow_tree.py"
    subprocess.run([sys.executable, grow, "--species", "maple", "--seed", "1", path], check=True)
    return native.build_tree_mesh(native.read_tree(path), snow_resolution=256)


@pytest.fixture
def renderer(mesh):
    with native.Renderer() as made:
        made.add_tree("tree", mesh)
        yield made


def camera(mesh, away, turned=False):
    middle = (mesh.vertices.min(0) + mesh.vertices.max(0)) / 2
    eye = middle + (0, -away, 0)
    target = 2 * eye - middle if turned else middle
    return native.Camera(eye=eye, target=target, width=SIZE[0], height=SIZE[1], field_of_view=0.8)


def darkness(renderer, mesh, away, **settings):
    picture = renderer.render_light(camera(mesh, away), native.RenderSettings(**LIGHT, **settings), 4)
    return float((4.0 - picture[..., :3]).sum())


def mean_share(renderer, mesh, away):
    """Darkness of a tree as it is drawn, relative to all its patches, over views from all around. A view of a tree of
    ten pixels shows a dozen patches: by itself it is no measure."""
    low, high = mesh.vertices.min(0), mesh.vertices.max(0)
    middle = (low + high) / 2
    # As many pixels per metre as the pictures above, but only around the tree.
    size = int(0.7 * np.linalg.norm(high - low) * SIZE[1] / np.tan(0.4) / away) + 4
    narrow = 2 * np.arctan(size / SIZE[1] * np.tan(0.4))

    def seen(eye, finer, samples, **settings):
        camera = native.Camera(
            eye=eye, target=middle, width=finer * size, height=finer * size, field_of_view=narrow
        )
        picture = renderer.render_light(camera, native.RenderSettings(**LIGHT, **settings), samples)
        return float((4.0 - picture[..., :3]).sum()) / finer**2

    turns = np.arange(24) * (2 * np.pi / 24)
    eyes = [middle + away * np.array([np.sin(t), -np.cos(t), 0.1 * np.sin(3 * t)]) for t in turns]
    # Thin triangles between samples are counted by finer ones.
    return sum(seen(eye, 1, 16) for eye in eyes) / sum(seen(eye, 4, 4, **FINE) for eye in eyes)


@pytest.mark.parametrize("away", [80, 160])
@pytest.mark.parametrize("name", ["Acer_saccharum_y1", "sapling_tree1"])
def test_a_small_tree_far_away_covers_as_much_in_the_mean_over_views(name, away):
    path = LEVELS / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"{path.name} is not in shared/data/trees")
    mesh = native.build_tree_mesh(native.read_tree(path))
    with native.Renderer() as made:
        made.add_tree("tree", mesh)
        assert mean_share(made, mesh, away) == pytest.approx(1.0, abs=0.1)


def triangles(renderer, mesh, away, **options):
    renderer.render(camera(mesh, away, **options), native.RenderSettings(**LIGHT))
    return renderer.statistics()["triangles"]


@pytest.mark.parametrize("away", [5, 20, 60, 200])
def test_a_bare_tree_covers_as_much_at_every_distance(renderer, mesh, away):
    share = darkness(renderer, mesh, away) / darkness(renderer, mesh, away, **FINE)
    assert 0.9 < share < 1.1


def test_triangles_fall_with_the_distance(renderer, mesh):
    near, middle, far = (triangles(renderer, mesh, away) for away in (10, 40, 160))
    assert middle < near / 3 and far < middle / 4 and far > 0


def test_thin_snow_hardly_adds_triangles(renderer, mesh):
    bare = triangles(renderer, mesh, 60)
    renderer.set_snow("tree", np.full((256, 256), 0.002, np.float32), open_depth=0.002, last_depth=0.002)
    assert triangles(renderer, mesh, 60) < 1.5 * bare


def add_leaves(renderer, mesh, count):
    """Square leaves of 8 cm on random vertices of the crown; without bark images they are plain green."""
    seed = 5
    print(f"seed {seed}")
    random = np.random.default_rng(seed)
    crown = np.flatnonzero(mesh.vertices[:, 2] > 2.0)
    at = random.choice(crown, count)
    middle = mesh.vertices[at] + random.normal(0, 0.15, (count, 3))
    a = random.normal(size=(count, 3))
    b = np.cross(a, random.normal(size=(count, 3)))
    a, b = (0.04 * v / np.linalg.norm(v, axis=1)[:, None] for v in (a, b))
    corner = [middle - a - b, middle + a - b, middle + a + b, middle - a + b]
    cards = np.stack([corner[k] for k in (0, 1, 2, 0, 2, 3)], axis=1).reshape(-1, 3, 3)
    bones = np.repeat(mesh.bone_indices[at, 0], 2).astype(np.int32)
    renderer.set_leaves("tree", cards.astype(np.float32), bones)


@pytest.mark.parametrize("away", [20, 60, 150])
def test_leaves_cover_as_much_at_every_distance(renderer, mesh, away):
    add_leaves(renderer, mesh, 3000)
    share = darkness(renderer, mesh, away) / darkness(renderer, mesh, away, **FINE)
    assert 0.9 < share < 1.1


def test_distant_leaves_are_fewer(renderer, mesh):
    bare = [triangles(renderer, mesh, away) for away in (20, 300)]
    add_leaves(renderer, mesh, 3000)
    near, far = (triangles(renderer, mesh, away) - wood for away, wood in zip((20, 300), bare, strict=True))
    assert near == 6000
    assert 0 < far < 6000 / 4


def test_leaves_outside_the_picture_are_not_drawn(renderer, mesh):
    add_leaves(renderer, mesh, 100)
    assert triangles(renderer, mesh, 20, turned=True) == 0
