# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaders of docs/engines draw exported files: the effects of branch levels, heights and joints are counted and
measured in the picture (tests/support/engine_view.py)."""

from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snowbough.gltf import snow_maps, tree_data, tree_file, triangle_mesh

pytest.importorskip("moderngl", reason="moderngl draws the files (package python3-moderngl)")
pytest.importorskip("PIL.Image", reason="Pillow reads the images (package python3-pil)")
import glb  # noqa: E402
from engine_view import EngineView  # noqa: E402

MAPLE = Path(__file__).resolve().parents[1] / "data" / "small_maple.obj"
SIZE = 128
# Side of the picture in metres at a distance of one, with the field of view below.
FIELD_OF_VIEW = 2 * np.arctan(0.5)


@pytest.fixture(scope="module")
def view():
    return EngineView(SIZE)


def write(tmp_path, one, levels=1, extras=None, joints=None):
    joints = joints or [tree_data.Joint("root", -1, np.eye(4))]
    bark = tree_data.Material("bark", color=(0.5, 0.5, 0.5), double_sided=True)
    part = tree_data.Part("bark", [one], [bark])
    path = tmp_path / "tree.glb"
    tree_file.build(tree_data.Tree("tree", joints, [part], levels, extras or {})).write_glb(path)
    assert glb.errors(path) == []
    read = glb.Gltf(path)
    return read, read.node("bark_LOD0")


def card(side=1.0, level=0, points=((-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1))):
    """A square standing in Blender's XZ plane that faces -Y, which is +Z in the file; snow's UVs fill the map."""
    points = np.array(points, np.float32) * side / 2
    uv = np.array([[(0, 0), (1, 0), (1, 1), (0, 1)]], np.float32)
    joints, weights = triangle_mesh.strongest(np.zeros((4, 1), int), np.ones((4, 1)))
    return triangle_mesh.from_quads(
        points, np.array([[0, 1, 2, 3]]), [uv, uv], joints, weights, [0], np.full(4, level)
    )


def look_at_card(view, away=2.0, **how):
    view.clear()
    view.look((0.0, 0.0, away), (0.0, 0.0, 0.0), field_of_view=FIELD_OF_VIEW, **how)


def odd_triangles(parts):
    """Triangles of a tessellated triangle whose levels are all the odd number `parts`: rings of 6 k around one."""
    rings = (parts - 1) // 2
    return 1 + 6 * rings * (rings + 1)


@pytest.mark.parametrize("level, parts", [(0, 15), (1, 10), (2, 5)])
def test_tessellation_falls_with_the_branch_level(view, tmp_path, level, parts):
    read, node = write(tmp_path, card(level=level), levels=3)
    view.snow()
    # An edge of 1 m, seen over SIZE pixels a metre at 1 m: far more than 15 parts, so `highest` is T_p for level 0.
    look_at_card(view, target_pixels=SIZE / 2 / 15, levels=3, highest=64.0)
    view.draw(read, node)
    # The diagonal is longer; the shortest and the longest edge give bounds.
    least, most = odd_triangles(2 * (parts // 2) + 1), odd_triangles(2 * int(np.ceil(parts * 2**0.5 / 2)) + 1)
    assert 2 * 0.8 * least <= view.primitives <= 2 * most


def test_the_share_is_that_of_the_formula(view, tmp_path):
    """T = T_p * (1 - level / levels): level 1 of 2 has the tessellation of level 0 at half of T_p."""
    counts = []
    for level, target in ((0, 8.0), (1, 4.0)):
        read, node = write(tmp_path, card(level=level), levels=2)
        view.snow()
        look_at_card(view, target_pixels=target, levels=2, highest=64.0)
        view.draw(read, node)
        counts.append(view.primitives)
    assert counts[0] == counts[1] > 2


def extent(picture):
    """(left, right, top, bottom) of the drawn pixels."""
    drawn = picture[..., 3] > 0
    columns, rows = np.flatnonzero(drawn.any(axis=0)), np.flatnonzero(drawn.any(axis=1))
    return columns[0], columns[-1] + 1, rows[0], rows[-1] + 1


def snow_file(tmp_path, frames):
    """The exporter's data of an atlas of frames (S, S) in metres, and its image."""
    samples, scale, offset = snow_maps.quantised(snow_maps.atlas(frames))
    native.write_png(str(tmp_path / "heights.png"), samples)
    columns, rows = snow_maps.tile_layout(len(frames))
    height = {"uri": "heights.png", "scale": scale, "offset": offset}
    depths = [float(frame.max()) for frame in frames]
    said = {"frames": list(range(len(frames))), "columns": columns, "rows": rows, "tile": 8, "height": height}
    return {**said, "openDepths": depths, "lastDepth": max(depths)}


@pytest.mark.parametrize("frame, metres", [(0, 0.0), (1, 0.5), (2, 1.0), (0.5, 0.25)])
def test_snow_moves_the_surface_by_the_frames_height(view, tmp_path, frame, metres):
    said = snow_file(tmp_path, [np.full((8, 8), h, np.float32) for h in (0.0, 0.5, 1.0)])
    read, node = write(tmp_path, card(points=((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))))
    view.snow(said, tmp_path, frame)
    view.clear()
    view.look((0.0, 2.0, 0.001), (0.0, 0.0, 0.0), field_of_view=FIELD_OF_VIEW)
    view.draw(read, node)
    left, right, _, _ = extent(view.picture())
    # The level card of 1 m comes nearer by the snow: from 2 m away it covers half of the picture. Relief is up to 11 %.
    assert SIZE / (2.0 - 0.88 * metres) - 1.5 < right - left < SIZE / (2.0 - 1.12 * metres) + 1.5


def test_the_sliders_of_a_file_shape_its_snow(view, tmp_path):
    said = snow_file(tmp_path, [np.full((8, 8), 0.5, np.float32)])
    read, node = write(tmp_path, card(points=((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))))
    waves = []
    for relief in (0.0, 1.0, 2.0):
        view.snow({**said, "style": {"relief": relief}}, tmp_path)
        view.clear()
        view.look((0.0, 2.0, 0.001), (0.0, 0.0, 0.0), field_of_view=FIELD_OF_VIEW)
        view.draw(read, node)
        waves.append(float(np.ptp(view.depth()[view.picture()[..., 3] > 0])))
    # The level card lies at one distance but for its relief.
    assert waves[0] < 0.05 * waves[1] and waves[2] == pytest.approx(2 * waves[1], rel=0.2)


def test_a_wall_shows_no_snow_that_is_thin_beside_the_open_depth(view, tmp_path):
    """By the rule of all snow; the map's 8 mm would hide the card."""
    read, node = write(tmp_path, card())
    said = snow_file(tmp_path, [np.full((8, 8), 0.008, np.float32)])
    shares = []
    for open_depth in (0.008, 0.3):
        view.snow({**said, "openDepths": [open_depth], "lastDepth": 0.3}, tmp_path)
        look_at_card(view)
        view.draw(read, node)
        picture = view.picture()
        white = (picture[..., :3] > 240).all(axis=2)
        shares.append(white[picture[..., 3] > 0].mean())
    assert shares[0] > 0.9 and shares[1] < 0.1


def test_the_map_lies_upright(view, tmp_path):
    """Snow at the map's top left lies at the card's top left: u to the right, v upwards."""
    height = np.zeros((8, 8), np.float32)
    height[4:, :4] = 0.3  # row 0 is v 0
    read, node = write(tmp_path, card())
    view.snow(snow_file(tmp_path, [height]), tmp_path)
    look_at_card(view, target_pixels=2.0)
    view.draw(read, node)
    picture = view.picture()
    white = (picture[..., :3] > 240).all(axis=2) & (picture[..., 3] > 0)  # the card is grey
    q = SIZE // 2
    shares = [
        white[rows, columns].mean()
        for rows in (slice(q - 28, q - 4), slice(q + 4, q + 28))
        for columns in (slice(q - 28, q - 4), slice(q + 4, q + 28))
    ]
    assert shares[0] > 0.9 and max(shares[1:]) < 0.1


def test_joints_move_what_follows_them(view, tmp_path):
    read, node = write(tmp_path, card())
    view.snow()
    look_at_card(view)
    moved = np.eye(4)[None].copy()
    moved[0, 0, 3] = 0.25
    view.draw(read, node, palette=moved)
    left, right, _, _ = extent(view.picture())
    assert (left + right) / 2 == pytest.approx(SIZE / 2 + 0.25 * SIZE / 2, abs=1.0)


@pytest.mark.parametrize("metres", [0.0, 0.03])
def test_no_crack_opens_in_a_tessellated_tree(tmp_path, metres):
    """From inside the trunk no background is visible, although levels differ between edges. Snow of one height lies on
    all of it."""
    mesh = native.build_tree_mesh(native.read_tree(str(MAPLE)))
    count = len(mesh.vertices)
    influences = triangle_mesh.strongest(np.zeros((count, 1), int), np.ones((count, 1)))
    uvs = [np.asarray(mesh.uv_bark), np.asarray(mesh.uv_snow)]
    quads = np.asarray(mesh.quads)
    one = triangle_mesh.from_quads(
        mesh.vertices, quads, uvs, *influences, np.zeros(len(quads)), np.zeros(count, int)
    )
    read, node = write(tmp_path, one)
    view = EngineView(512)
    view.snow(snow_file(tmp_path, [np.full((8, 8), metres, np.float32)]), tmp_path)
    trunk = np.asarray(mesh.vertices)[np.unique(quads[np.asarray(mesh.face_branch) == 0])]
    ring = trunk[np.abs(trunk[:, 2] - 0.5) < 0.12]
    eye = np.array((ring[:, 0].mean(), 0.5, -ring[:, 1].mean()))
    view.clear()
    view.look(eye, eye + (0.02, 0.05, 0.01), field_of_view=1.9, target_pixels=30.0)
    view.draw(read, node)
    # Some edges are at the highest level, others below it.
    assert 2 * len(quads) * 2 < view.primitives < 2 * len(quads) * odd_triangles(17)
    assert (view.picture()[..., 3] == 255).all()
