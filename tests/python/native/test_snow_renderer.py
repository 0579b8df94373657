"""Snow in the real-time renderer: surfaces of snow, snow on trees, flakes."""

from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import fallen
from snow_meshes import box, grid, smooth, sphere
from test_renderer import closed

WHOLE = {"min_pixels": 0, "shadow_resolution": 0}
DEPTH = 0.1
#: Sun from the left and from behind the camera at first.
LIGHT = {"sun_direction": (-0.6, -0.6, 0.5), "sun_color": (1, 1, 1), "sky_color": (0.1, 0.1, 0.1)}
LIGHT["ground_color"] = (0.05, 0.05, 0.05)


def lumps(size=128, depth=0.1):
    """Heights that ignore the layout, so that the two sides of every seam differ."""
    random = np.random.default_rng(7).random((size, size))
    wide = sum(np.roll(random, (i, j), (0, 1)) for i in range(5) for j in range(5)) / 25
    return (wide * depth).astype(np.float32)


@pytest.fixture
def renderer():
    with native.Renderer() as made:
        yield made


def surface_of(mesh, heights, depth=DEPTH, **settings):
    """(points, triangles) of the snow on a mesh."""
    positions, triangles, uv = mesh
    made = native.SnowSurface(triangles, uv, positions, heights, heights, depth, **settings)
    begin, corners, _ = made.faces()
    sides = np.diff(begin)
    fans = [corners[begin[:-1][:, None] + (0, 1, 2)], corners[begin[:-1][sides == 4][:, None] + (0, 2, 3)]]
    return made.points(heights, depth), np.concatenate(fans).astype(np.int32)


@pytest.fixture(scope="module", params=["box", "ball"])
def heap(request):
    mesh = box() if request.param == "box" else sphere(0.5)
    shading = None if request.param == "box" else smooth(*mesh[:2])
    return surface_of(mesh, fallen(mesh, DEPTH, repose=np.pi / 2), shading=shading)


@pytest.mark.parametrize("seen", ["positive side", "back"])
def test_snow_whose_normal_turns_away_from_the_eye_is_no_dark_speck(renderer, seen):
    """At outlines, triangles with vertex normals that point away from the eye are as bright as their neighbours."""
    # So large that grains and glints are finer than pixels.
    triangle = np.float32([(-200, -200, 0), (200, -200, 0), (0, 200, 0)])
    faces = np.int32([(0, 1, 2) if seen == "positive side" else (0, 2, 1)])
    camera = native.Camera(
        eye=(0, 0, 300), target=(0, 0, 0), up=(0, 1, 0), width=9, height=9, field_of_view=0.3
    )
    light = {
        "sun_direction": (1, 0, 0),
        "sun_color": (1, 1, 1),
        "sky_color": (0, 0, 0),
        "shadow_resolution": 0,
    }
    shades = []
    for away in (0.0, -0.3):
        normal = np.float32((1, 0, away)) / np.hypot(1, away)
        renderer.add_snow_mesh("snow", triangle, faces, np.tile(normal, (1, 3, 1)))
        shades.append(renderer.render(camera, native.RenderSettings(**light))[..., :3].mean())
        renderer.remove("snow")
    assert shades[0] > 150 and shades[1] == pytest.approx(shades[0], rel=0.05)


def test_a_mirrored_place_is_lit_from_the_same_side(renderer, heap):
    points, triangles = heap
    camera = native.Camera(eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0), width=80, height=80)
    pictures = []
    for mirror in (1, -1):
        renderer.add_snow_mesh("snow", points * np.float32((mirror, 1, 1)), triangles[:, ::mirror].copy())
        renderer.set_instances("snow", np.diag((mirror, 1, 1, 1))[None].astype(np.float32))
        pictures.append(renderer.render(camera, native.RenderSettings(**WHOLE, **LIGHT)).astype(int))
        renderer.remove("snow")
    assert (abs(pictures[0] - pictures[1]).max(axis=2) > 16).mean() < 0.01


def test_the_look_is_fixed_to_the_object(renderer, heap):
    camera = {"field_of_view": 0.3, "width": 160, "height": 160, "near": 0.1, "far": 10}
    renderer.add_snow_mesh("snow", *heap)
    pictures = []
    for shift in (0.0, 0.3137):
        place = np.eye(4, dtype=np.float32)
        place[:3, 3] = by = shift * np.array((1, -0.5, 0.25))
        renderer.set_instances("snow", place[None])
        at = native.Camera(eye=by + (0.1, -0.9, 1.2), target=by + (0, 0, 0.5), **camera)
        settings = native.RenderSettings(**LIGHT, shadow_resolution=0)
        pictures += [renderer.render(at, settings)[..., :3].astype(int) for _ in range(2)]
    assert np.array_equal(pictures[0], pictures[1]), "nothing changes with time"
    assert pictures[0].std() > 3
    apart = abs(pictures[2] - pictures[0]).max(axis=2)
    assert (apart > 12).mean() < 0.01, "crystals and grains move with it"


def test_depths_are_those_of_the_points(renderer):
    points, triangles = surface_of(grid(2.0, 2.0, 8), np.full((64, 64), DEPTH, np.float32))
    renderer.add_snow_mesh("snow", points, triangles)
    camera = native.Camera(eye=(0, 0, 3), target=(0, 0, 0), up=(0, 1, 0), width=9, height=9, near=1, far=9)
    depth = renderer.render_depth(camera, native.RenderSettings())
    assert depth.shape == (9, 9)
    away = 9.0 / (9.0 - depth[4, 4] * 8.0)
    middle = points[np.hypot(points[:, 0], points[:, 1]) < 0.15]
    assert middle[:, 2].min() - 1e-3 < 3.0 - away < middle[:, 2].max() + 1e-3


def air(renderer, eye=(0, 0, 0), **fall):
    camera = native.Camera(
        eye=eye, target=np.add(eye, (0, 1, 0)), width=240, height=160, near=0.05, far=50, field_of_view=1.0
    )
    snowfall = native.Snowfall(**{"rate": 2e-5, **fall})
    settings = native.RenderSettings(snowfall=snowfall, sky_color=(0.05, 0.06, 0.08))
    return renderer.render(camera, settings)[..., :3].astype(int)


def test_flakes_are_the_same_for_the_same_seed_and_time(renderer):
    first = air(renderer, time=3.0)
    assert np.array_equal(first, air(renderer, time=3.0))
    assert (first != air(renderer, time=3.2)).any()
    assert (first != air(renderer, time=3.0, seed=1)).any()


def test_more_snow_a_second_is_more_flakes(renderer):
    none = air(renderer, rate=0.0)
    shares = [(air(renderer, rate=rate) != none).any(axis=2).mean() for rate in (1e-6, 4e-6, 1.6e-5)]
    assert 0.002 < shares[0] < 0.5 * shares[1] and shares[1] < 0.5 * shares[2]


def test_flakes_fall_along_their_direction(renderer):
    wind = np.array((0.6, 0.2, -1))
    fall = {"direction": wind, "speed": 2.0, "flutter": 0.0, "shutter": 0.0}
    by = wind / np.linalg.norm(wind) * 2.0 * 0.7
    first = air(renderer, time=0.0, **fall)
    apart = abs(first - air(renderer, eye=by, time=0.7, **fall)).max(axis=2)
    assert (apart > 8).mean() < 0.003, "who falls with them sees them stand still"
    assert (abs(first - air(renderer, time=0.7, **fall)).max(axis=2) > 8).mean() > 0.01


def test_flutter_takes_flakes_aside(renderer):
    fall = {"speed": 2.0, "shutter": 0.0, "flutter": np.radians(20.0)}
    first = air(renderer, **fall)
    apart = abs(first - air(renderer, eye=(0, 0, -1.4), time=0.7, **fall)).max(axis=2)
    assert (apart > 8).mean() > 0.01


MAPLE = Path(__file__).resolve().parents[2] / "data" / "small_maple.obj"


@pytest.fixture(scope="module")
def maple():
    return native.build_tree_mesh(native.read_tree(MAPLE), snow_resolution=256)


def test_snow_of_a_simulation_on_the_gpu_lies_on_trees_without_reading_it_back(renderer, maple):
    camera = native.Camera(eye=(1.0, -2.2, 2.6), target=(0, 0, 1.2), width=160, height=120)
    renderer.add_tree("tree", maple)
    bare = renderer.render(camera)[..., :3].astype(int)
    quads, uv = np.asarray(maple.quads), np.asarray(maple.uv_snow)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    places = np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]]).astype(np.float32)
    with native.SnowSimulation(pixel_size=0.02, repose=np.pi / 2, engine="GL") as sim:
        sim.add_object("tree", triangles, places, resolution=256, shading=triangles)
        sim.step({"tree": maple.vertices.astype(np.float32)}, 0.05)
        assert renderer.take_snow("tree", sim, 0.05) is True
        live = renderer.render(camera)[..., :3].astype(int)
        # Limbs are thin: the output's heights allow for their curvature, which those on the GPU do not.
        renderer.set_snow("tree", sim.height("tree"), 0.05)
    baked = renderer.render(camera)[..., :3].astype(int)
    changed = abs(baked - bare).max(axis=2) > 20
    assert changed.mean() > 0.01
    assert (abs(live - baked).max(axis=2) > 20).mean() < 0.1 * changed.mean()


def test_a_tree_with_snow_is_closed_to_the_bit(renderer, maple):
    renderer.add_tree("tree", maple)
    view = {"eye": (1.5, -2.5, 1.5), "target": (0, 0, 1.5), "field_of_view": 2.4}
    camera, large = native.Camera(**view, height=600), native.Camera(**view, width=8192, height=7680)
    mixed = native.RenderSettings(target_pixels=6, **WHOLE)
    # All edges at one level, which snow that makes limbs thicker does not change.
    even = native.RenderSettings(target_pixels=0.25, max_level=3, **WHOLE)
    bare = renderer.triangles("tree", large, even)
    assert closed(bare) and closed(renderer.triangles("tree", camera, mixed))
    renderer.set_snow("tree", lumps(256, 0.04), 0.04)
    assert closed(renderer.triangles("tree", camera, mixed))
    found = renderer.triangles("tree", large, even)
    assert found.shape == bare.shape and closed(found)
    risen = np.linalg.norm(found - bare, axis=2)
    # Half of the lumps' 40 mm, less on thin limbs, around which a layer needs less height for its volume.
    assert 0.01 < np.median(risen) < 0.02 and risen.max() < 0.04


def test_the_sliders_shape_a_trees_snow(renderer, maple):
    # All edges at one level, which snow that makes limbs thicker does not change.
    view = {"eye": (1.5, -2.5, 1.5), "target": (0, 0, 1.5), "field_of_view": 2.4}
    camera = native.Camera(**view, width=8192, height=7680)
    even = native.RenderSettings(target_pixels=0.25, max_level=2, **WHOLE)
    renderer.add_tree("tree", maple)

    def points(**sliders):
        renderer.set_snow("tree", lumps(256, 0.04), 0.04, **sliders)
        return renderer.triangles("tree", camera, even)

    usual = points()
    assert np.array_equal(points(overhang=1.0, hem_variation=1.0, relief=1.0), usual)
    for slider in ("overhang", "hem_variation", "relief"):
        none, more = (points(**{slider: value}) for value in (0.0, 2.0))
        moved = np.linalg.norm(none - usual, axis=2)
        # Each acts in proportion: twice the slider moves a point as far to the other side.
        assert 1e-4 < moved.max() < 0.04, slider
        if slider != "hem_variation":  # its sum with the usual sag is limited
            assert np.linalg.norm(none + more - 2 * usual, axis=2).max() < 0.3 * moved.max(), slider
    with pytest.raises(TypeError, match="there is no such slider"):
        points(hang=1.0)


def test_a_trees_arrays_say_where_its_snow_lies(renderer, maple):
    camera = native.Camera(eye=(1.0, -2.2, 2.6), target=(0, 0, 1.2), width=160, height=120)
    renderer.add_tree("tree", maple)
    bare = renderer.render(camera)
    renderer.set_snow("tree", lumps(256, 0.04), 0.04)
    snowed = renderer.render(camera)
    assert not np.array_equal(snowed, bare)
    renderer.set_snow("tree", np.zeros((1, 1), np.float32), 0.0, last_depth=0.04)
    assert np.array_equal(renderer.render(camera), bare)
    renderer.remove("tree")

    arrays = native.tree_arrays(maple)
    renderer.add_tree("tree", arrays)
    renderer.set_snow("tree", lumps(256, 0.04), 0.04)
    assert np.array_equal(renderer.render(camera), snowed)
    renderer.remove("tree")

    del arrays["snow_uv"]
    renderer.add_tree("tree", arrays)
    assert np.array_equal(renderer.render(camera), bare)
    with pytest.raises(ValueError, match="no snow map coordinates"):
        renderer.set_snow("tree", lumps(256, 0.04), 0.04)


def test_snow_on_a_tree_looks_as_on_a_mesh(renderer, maple):
    renderer.add_tree("tree", maple)
    camera = native.Camera(eye=(0.3, -0.9, 0.8), target=(0, 0, 0.6), field_of_view=0.3, width=200, height=200)
    bare = renderer.render(camera, native.RenderSettings(**WHOLE))
    renderer.set_snow("tree", np.full((256, 256), 0.03, np.float32), 0.03)
    snowed = renderer.render(camera, native.RenderSettings(**WHOLE)).astype(int)
    on_tree = bare[..., 3] == 255
    assert on_tree.mean() > 0.1
    assert snowed[on_tree][:, :3].mean() > bare[on_tree][:, :3].mean() + 60
    spread = snowed[on_tree][:, :3].max(axis=1) - snowed[on_tree][:, :3].min(axis=1)
    assert np.quantile(spread, 0.9) < 60, "white, not bark"


@pytest.mark.parametrize(
    "wrong, complaint",
    [
        (lambda r: r.add_snow_mesh("a", np.zeros((3, 3)), np.array([(0, 1, 3)])), "vertex index 3"),
        (lambda r: r.add_snow_mesh("a", np.full((3, 3), np.nan), np.array([(0, 1, 2)])), "vertices"),
        (lambda r: r.set_snow("a", np.zeros((4, 4)), 0.1), "no tree 'a'"),
        (lambda r: r.set_snow("tree", np.zeros(4), 0.1), r"shape \(N, N\)"),
        (lambda r: r.set_snow("tree", np.zeros((0, 4)), 0.1), "height x width"),
        (lambda r: r.set_snow("tree", np.zeros((4, 4)), -0.1), "open_depth"),
        (lambda r: r.set_snow("tree", np.zeros((4, 4)), 0.1, last_depth=0.0), "last_depth"),
        (lambda r: air(r, direction=(0, 0, 1)), "downwards"),
        (lambda r: air(r, rate=-1), "rate"),
    ],
)
def test_bad_input_is_named(renderer, maple, wrong, complaint):
    renderer.add_tree("tree", maple)
    with pytest.raises(ValueError, match=complaint):
        wrong(renderer)
