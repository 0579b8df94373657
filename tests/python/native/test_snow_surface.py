# SPDX-License-Identifier: GPL-3.0-or-later
"""snowbough_native.SnowSurface and its relatives: shapes of arrays, and errors for invalid input."""

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import box, grid, rotated, smooth
from snow_pieces import pieces, tile_courses

DEPTH = 0.1


def level(height=DEPTH, resolution=64):
    return np.full((resolution, resolution), height, np.float32)


def make(mesh=None, last=None, highest=None, depth=DEPTH, **settings):
    """The surface of a box of a metre, or of another mesh, under 10 cm."""
    positions, triangles, uv = mesh or box()
    last = level() if last is None else last
    highest = last if highest is None else highest
    return native.SnowSurface(triangles, uv, positions, last, highest, depth, **settings)


def test_faces_have_three_or_four_corners_with_texture_coordinates():
    surface = make()
    begin, corner, uv = surface.faces()
    assert (begin.dtype, corner.dtype, uv.dtype) == (np.int32, np.int32, np.float32)
    assert begin[0] == 0 and begin[-1] == len(corner) == len(uv)
    assert set(np.diff(begin)) == {3, 4}
    assert sorted(set(corner)) == list(range(surface.point_count))
    assert uv.shape == (len(corner), 2) and uv.min() >= 0.0 and uv.max() <= 1.0


def test_points_are_rows_of_three():
    surface = make()
    points = surface.points(level(), DEPTH)
    assert points.shape == (surface.point_count, 3) and points.dtype == np.float32
    assert 1.0 + 0.5 * DEPTH < points[:, 2].max() < 1.0 + 1.5 * DEPTH


def test_a_receiver_without_snow_has_no_faces():
    surface = make(last=level(0.0))
    assert surface.point_count == 0
    assert surface.points(level(0.0), 0.0).shape == (0, 3)


def test_to_result_is_a_matrix_of_rows():
    surface = make()
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, 3] = (1.0, 2.0, 3.0)
    moved = surface.points(level(), DEPTH, to_result=matrix)
    assert moved == pytest.approx(surface.points(level(), DEPTH) + (1.0, 2.0, 3.0), abs=1e-5)


def test_up_says_how_the_receiver_is_tilted():
    mesh = grid(2.0, 2.0)
    surface = make(mesh, shading=smooth(*mesh[:2]))
    turn = rotated(np.eye(3), "x", 40.0)  # of rows: where the axes go
    tilted = surface.points(level(), DEPTH, positions=rotated(mesh[0], "x", 40.0))
    expected = surface.points(level(), DEPTH, up=tuple(turn @ (0.0, 0.0, 1.0)))
    assert tilted == pytest.approx(expected @ turn, abs=1e-5)


def test_a_style_without_overhang_keeps_snow_on_the_box():
    top = level(0.0)
    top[32:, 43:] = DEPTH  # its chart
    surface = make(last=top)
    usual = surface.points(top, DEPTH)
    surface.set_style(overhang=0.0, relief=0.0)
    assert abs(usual[:, 0]).max() > 0.51 > abs(surface.points(top, DEPTH)[:, 0]).max()


def test_a_style_names_its_sliders():
    surface = make()
    with pytest.raises(TypeError, match="there is no such slider"):
        surface.set_style(overhang=1.0, hang=1.0)
    with pytest.raises(TypeError):
        surface.set_style(1.0)


def test_a_larger_scale_has_fewer_points_and_most_points_is_a_limit():
    assert make(scale=1.7).point_count < make().point_count
    few = make(most_points=500)
    assert few.point_count <= 500
    assert few.coarsened > 1.0 == make().coarsened


@pytest.mark.parametrize("most", [1500, 3000, 5000, 8000])
def test_too_few_points_are_used(most):
    """Rows of points at rims are left out one after the other, not all at once."""
    positions, triangles, uv, resolution = pieces(tile_courses(6))
    surface = make((positions, triangles, uv), level(DEPTH, resolution), most_points=most)
    assert surface.coarsened > 1.0
    assert 0.5 * most < surface.point_count <= most


def needles(count=400):
    """Level cards of 20 x 2 cm, a few centimetres from each other."""
    card, faces, uv = grid(0.2, 0.02)
    shift = np.random.default_rng(1).uniform(-0.5, 0.5, (count, 1, 3)).astype(np.float32)
    number = np.arange(count)[:, None, None]
    place = (np.stack([number % 20, number // 20], axis=-1) + uv[None]) / 20
    return (
        (card[None] + shift).reshape(-1, 3),
        (faces[None] + 4 * number).reshape(-1, 3).astype(np.int32),
        place.reshape(-1, 3, 2).astype(np.float32),
    )


def test_many_needles_and_their_cushions_keep_within_their_points():
    for most in (8000, 20000):
        surface = make(needles(), most_points=most)
        assert 0.2 * most < surface.point_count <= most
        assert surface.coarsened > 1.0


def test_needles_want_points_for_their_cushions():
    mesh = needles()
    hems, _ = native.wanted_surface_points(mesh[1], mesh[0], DEPTH)
    # 176 m of edges, and a point of a cushion for each 7 mm of them.
    assert hems > 176.0 / (0.07 * DEPTH)


def test_receivers_of_other_seeds_have_other_hems():
    assert not np.array_equal(make(seed=1).points(level(), DEPTH), make(seed=2).points(level(), DEPTH))


def test_the_same_input_gives_the_same_bytes():
    assert make().points(level(), DEPTH).tobytes() == make().points(level(), DEPTH).tobytes()


@pytest.mark.parametrize(
    "given, message",
    [
        ({"last": np.zeros((64, 32), np.float32)}, r"last must have shape \(resolution, resolution\)"),
        ({"highest": np.zeros(64, np.float32)}, r"highest must have shape"),
        ({"highest": level(resolution=32)}, "resolution x resolution texels, at least 2 x 2"),
        ({"depth": 0.0}, "depth must be a number over 0"),
        ({"depth": float("nan")}, "depth must be"),
        ({"scale": -1.0}, "scale must be a number over 0"),
        ({"most_points": 0}, "most_points must be a number over 0"),
        ({"shading": np.zeros((1, 3), np.int32)}, r"shading must have shape \(T, 3\)"),
    ],
)
def test_settings_that_do_not_fit_are_refused(given, message):
    with pytest.raises(ValueError, match=message):
        make(**given)


@pytest.mark.parametrize(
    "place, value, message",
    [
        (0, np.zeros((3, 3), np.float32), "triangles must name rows of positions"),
        (0, np.full((8, 3), np.nan, np.float32), "positions: row 0 holds nan"),
        (1, np.full((12, 3), -1, np.int32), "vertex index -1"),
        (1, np.zeros((12, 4), np.int32), r"triangles must have shape \(T, 3\)"),
        (2, np.full((12, 3, 2), np.nan, np.float32), "uv: row 0 holds nan"),
        (2, np.zeros((2, 3, 2), np.float32), r"uv must have shape \(T, 3, 2\)"),
    ],
)
def test_meshes_that_do_not_fit_are_refused(place, value, message):
    mesh = list(box())
    mesh[place] = value
    with pytest.raises(ValueError, match=message):
        make(tuple(mesh))


@pytest.mark.parametrize("matrix", [np.eye(3), np.ones((3, 4)), np.ones(16)])
def test_a_matrix_of_another_shape_is_refused(matrix):
    with pytest.raises(ValueError, match=r"to_result must have shape \(4, 4\)"):
        make().points(level(), DEPTH, to_result=matrix)


def test_wanted_points_grow_with_the_surface_and_shrink_with_the_depth():
    def wanted(mesh, depth=DEPTH, **given):
        hems, level = native.wanted_surface_points(mesh[1], mesh[0], depth, **given)
        return hems + level

    small, large = grid(0.2, 0.2), grid(5.0, 5.0)
    assert wanted(large) > 10 * wanted(small) > 0
    assert wanted(large, 0.02) > wanted(large, 0.1)
    assert wanted(box(), shading=smooth(*box()[:2])) > 0


def test_level_ground_wants_no_more_points_under_dust_than_under_a_little_snow():
    mesh = grid(8.0, 8.0)
    dust, thin, deep = (
        native.wanted_surface_points(mesh[1], mesh[0], depth)[1] for depth in (0.003, 0.05, 0.1)
    )
    assert dust <= thin > deep > 0


@pytest.mark.parametrize(
    "triangles, depth, shading, message",
    [
        ([[0, 1, 9]], DEPTH, None, "triangles must name rows of positions"),
        ([[0, 1, -1]], DEPTH, None, "vertex index -1"),
        ([[0, 1, 2, 3]], DEPTH, None, r"triangles must have shape \(T, 3\)"),
        ([[0, 1, 2]], 0.0, None, "depth must be a number over 0"),
        ([[0, 1, 2]], DEPTH, [[0, 1]], r"shading must have shape \(T, 3\)"),
    ],
)
def test_wanted_points_refuse_what_does_not_fit(triangles, depth, shading, message):
    with pytest.raises(ValueError, match=message):
        native.wanted_surface_points(triangles, grid()[0], depth, shading)


def test_point_normals_are_unit_vectors_of_the_faces():
    positions, triangles, _ = grid()
    assert native.point_normals(positions, triangles) == pytest.approx(np.tile((0.0, 0.0, 1.0), (4, 1)))


@pytest.mark.parametrize(
    "points, triangles, message",
    [
        (np.zeros((3, 3)), [[0, 1, 3]], "each index in triangles must be a row of points"),
        (np.zeros((3, 2)), [[0, 1, 2]], r"points must have shape \(N, 3\)"),
        (np.zeros((3, 3)), [0, 1, 2], r"triangles must have shape \(N, 3\)"),
    ],
)
def test_point_normals_refuse_what_does_not_fit(points, triangles, message):
    with pytest.raises(ValueError, match=message):
        native.point_normals(points, triangles)


@pytest.mark.parametrize("resolution", [2, 63, 999])
def test_a_map_of_another_resolution_is_refused(resolution):
    with pytest.raises(ValueError, match=r"height must have shape \(64, 64\)"):
        make().points(level(resolution=resolution), DEPTH)


@pytest.mark.parametrize("count", [0, 1, 7, 9])
def test_positions_of_another_mesh_are_refused(count):
    with pytest.raises(ValueError, match="positions must have 8 rows"):
        make().points(level(), DEPTH, positions=np.zeros((count, 3), np.float32))
