"""Levels of detail keep a tree's outline: the pixels that each covers, seen along X and along Y."""

from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[3]
MAPLE = ROOT / "tests" / "data" / "small_maple.obj"
TUBES = ROOT / ".." / "shared" / "data" / "trees" / "tubes"
PIXELS = 2000
PAIRS = ((1, 2), (1, 3), (2, 3), (0, 3))


def covered(vertices, quads, axes, low, size):
    """bool (PIXELS, PIXELS): the pixels whose centres lie in some triangle, seen along the third axis.

    Each triangle is cut into rows of pixels; a row's span counts +1 where it begins and -1 behind its end.
    """
    points = (vertices[:, axes].astype(float) - low) * (PIXELS / size)
    corners = points[np.concatenate([quads[:, (0, 1, 2)], quads[:, (0, 2, 3)]])]
    first = np.ceil(corners[..., 1].min(axis=1) - 0.5).astype(int)
    last = np.floor(corners[..., 1].max(axis=1) - 0.5).astype(int)
    rows = np.maximum(last - first + 1, 0)
    of = np.repeat(np.arange(len(corners)), rows)
    row = np.arange(len(of)) - np.repeat(np.cumsum(rows) - rows, rows) + first[of]
    left, right = np.full(len(of), np.inf), np.full(len(of), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, along = corners[of, a], corners[of, b] - corners[of, a]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (row + 0.5 - start[:, 1]) / along[:, 1]
            x = np.where((share >= 0) & (share <= 1), start[:, 0] + share * along[:, 0], np.nan)
        left, right = np.fmin(left, x), np.fmax(right, x)
    begin, end = np.ceil(left - 0.5), np.floor(right - 0.5) + 1
    some = np.isfinite(begin) & np.isfinite(end) & (end > begin)
    spans = np.zeros((PIXELS, PIXELS + 1), np.int32)
    np.add.at(spans, (row[some], begin[some].astype(int)), 1)
    np.add.at(spans, (row[some], end[some].astype(int)), -1)
    return spans[:, :PIXELS].cumsum(axis=1) > 0


def test_a_square_covers_its_pixels():
    square = np.array([(0, 0, 0), (0, 0.5, 0), (0, 0.5, 0.25), (0, 0, 0.25)])
    seen = covered(square, np.array([(0, 1, 2, 3)]), (1, 2), np.zeros(2), 1.0)
    assert seen[: PIXELS // 4, : PIXELS // 2].all()
    assert seen.sum() == PIXELS * PIXELS // 8


def chain_seen(path):
    """For each of two directions: the pixels that each level of a chain covers, the coarsest first."""
    skeleton = native.read_tree(path, simplify="TOLERANCE")
    meshes = [
        native.build_tree_mesh(skeleton, detail=detail) for detail in ("BASE", "GAME", "DEFAULT", "FILM")
    ]
    low, high = meshes[0].vertices.min(axis=0) - 0.01, meshes[0].vertices.max(axis=0) + 0.01
    size = float((high - low).max())
    for axes in ((0, 2), (1, 2)):
        yield [covered(mesh.vertices, mesh.quads, axes, low[list(axes)], size) for mesh in meshes]


def test_levels_of_detail_have_the_same_outline():
    for seen in chain_seen(MAPLE):
        apart = {pair: (seen[pair[0]] ^ seen[pair[1]]).sum() / seen[3].sum() for pair in PAIRS}
        assert max(apart[1, 2], apart[1, 3], apart[2, 3]) < 0.03
        assert apart[0, 3] < 0.12


@pytest.mark.parametrize("name", ["AL06a.obj", "BL02A_Betula_lenta.obj"])
def test_levels_of_detail_cover_the_same_area(name):
    """Twigs of these trees are as thin as a pixel, so their outlines are not compared."""
    if not (TUBES / name).is_file():
        pytest.skip(f"{name} is not in shared/data/trees")
    for seen in chain_seen(TUBES / name):
        area = np.array([pixels.sum() for pixels in seen]) / seen[3].sum()
        assert np.abs(area - 1).max() < 0.06
