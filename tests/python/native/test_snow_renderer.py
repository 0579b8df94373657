"""Snow in the real-time renderer: no cracks at seams and rims, levels against NumPy, one look that stays put."""

import math
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import box, cylinder, grid, sphere
from test_renderer import closed

#: Everything is in the picture, nothing is too small for it, and nothing shades.
CAMERA = {"eye": (2.2, -2.6, 1.8), "target": (0, 0, 0.3), "field_of_view": 0.7, "width": 300, "height": 300}
WHOLE = {"min_pixels": 0, "shadow_resolution": 0}


def torus(radius=0.6, tube=0.25, around=24, across=12):
    """A closed ring whose map is one chart with two seams; a vertex on a seam has up to four places on it."""
    places, triangles, uv = [], [], []
    for i in range(around):
        for j in range(across):
            t, s = 2 * np.pi * i / around, 2 * np.pi * j / across
            out = radius + tube * np.cos(s)
            places.append((out * np.cos(t), out * np.sin(t), tube * np.sin(s)))
            q = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            v = [(a % around) * across + b % across for a, b in q]
            w = [(0.03 + 0.94 * a / around, 0.03 + 0.94 * b / across) for a, b in q]
            triangles += [(v[0], v[1], v[2]), (v[0], v[2], v[3])]
            uv += [(w[0], w[1], w[2]), (w[0], w[2], w[3])]
    return np.array(places, np.float32), np.array(triangles, np.int32), np.array(uv, np.float32)


def flat_normals(positions, triangles):
    corners = positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.repeat((across / np.linalg.norm(across, axis=1)[:, None])[:, None], 3, axis=1)


def lumps(size=128, depth=0.1, signed=False):
    """Heights that have nothing to do with the layout: what two sides of a seam show differs everywhere."""
    random = np.random.default_rng(7).random((size, size))
    wide = sum(np.roll(random, (i, j), (0, 1)) for i in range(5) for j in range(5)) / 25
    return ((wide - (0.5 if signed else 0.0)) * depth).astype(np.float32)


@pytest.fixture
def renderer():
    with native.Renderer() as made:
        yield made


def add(renderer, mesh, height=None, normals=None, **options):
    renderer.add_snow_mesh("it", *mesh, normals=normals, **options)
    if height is not None:
        renderer.set_snow("it", height)


CLOSED = {
    "ring": (torus(), False),
    "box": (box(), True),
    "smooth box": (box(), False),
    "cylinder": (cylinder(0.5, 1.2), True),
}


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("metric", ["SCREEN", "THESIS"])
@pytest.mark.parametrize("signed", [False, True])
def test_a_closed_receiver_is_closed_to_the_bit(renderer, name, metric, signed):
    mesh, is_flat = CLOSED[name]
    normals = flat_normals(*mesh[:2]) if is_flat else None
    add(renderer, mesh, lumps(signed=signed), normals, resolution=128)
    settings = native.RenderSettings(metric=metric, snow_factor=20000, target_pixels=3, **WHOLE)
    found = renderer.triangles("it", native.Camera(**CAMERA), settings)
    renderer.render(native.Camera(**CAMERA), settings)
    assert renderer.statistics()["tessellated"] > 10
    assert len(np.unique(renderer.snow_levels("it")["edge"])) > 1
    assert len(found) > 2000
    assert closed(found)
    assert not closed(np.delete(found, 100, axis=0))


def test_plain_and_tessellated_patches_meet_without_a_crack(renderer):
    height = lumps()
    height[:, 40:] = 0
    add(renderer, torus(), height)
    found = renderer.triangles("it", native.Camera(**CAMERA), native.RenderSettings(**WHOLE))
    renderer.render(native.Camera(**CAMERA), native.RenderSettings(**WHOLE))
    counts = renderer.statistics()
    assert counts["plain"] > 50 and counts["tessellated"] > 50 and counts["dropped"] == 0
    assert closed(found)


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (-1, 0.2, 0.5), (0.01, 0, 1), (0.01, 0, -1)])
def test_no_background_shows_from_inside_of_a_closed_receiver(renderer, name, direction):
    mesh, is_flat = CLOSED[name]
    add(renderer, mesh, lumps(), flat_normals(*mesh[:2]) if is_flat else None)
    eye = np.array((0.6, 0.02, 0.01) if name == "ring" else (0.02, 0.01, 0.5 if "box" in name else 0.02))
    camera = native.Camera(
        eye=eye,
        target=eye + direction,
        up=(0, 0, 1) if abs(direction[2]) < 0.9 else (0, 1, 0),
        field_of_view=1.6,
        width=200,
        height=200,
        near=1e-4,
        far=100,
    )
    picture = renderer.render(camera, native.RenderSettings(**WHOLE))
    assert renderer.statistics()["tessellated"] > 5
    assert (picture[..., 3] == 255).all()


#: A level square of 2 x 2 m seen from above, its border out of the picture.
ABOVE = {"eye": (0, -0.02, 3), "target": (0, 0, 0), "field_of_view": 0.5, "width": 160, "height": 160}
SQUARE = grid(2.0, 2.0, 8, margin=0.0)


def captured(renderer, **settings):
    return renderer.triangles("it", native.Camera(**CAMERA), native.RenderSettings(**WHOLE, **settings))


@pytest.mark.parametrize("depth", [0.1, -0.1])
def test_snow_stands_on_the_side_that_its_sign_says(renderer, depth):
    add(renderer, SQUARE, np.full((64, 64), depth, np.float32))
    found = captured(renderer).reshape(-1, 3)
    inside = (abs(found[:, :2]) < 0.85).all(axis=1)
    assert inside.sum() > 500
    assert np.allclose(found[inside, 2], depth, atol=1e-6)
    assert np.allclose(found[(abs(found[:, :2]) == 1).any(axis=1), 2], 0), "it ends on the surface"


def test_a_round_surface_grows_evenly_across_its_seams(renderer):
    mesh = torus(around=96, across=48)
    add(renderer, mesh, np.full((128, 128), 0.1, np.float32))
    found = captured(renderer).reshape(-1, 3)
    from_ring = np.hypot(np.hypot(found[:, 0], found[:, 1]) - 0.6, found[:, 2])
    # Facets of 48 sides stand back by a part in 470.
    assert np.allclose(from_ring, 0.35, atol=1.5e-3)


def base_patches(renderer):
    """Corners of the patches, (P, 3, 3), all of them plain."""
    found = renderer.triangles("it", native.Camera(**CAMERA), native.RenderSettings(max_level=1, **WHOLE))
    return found.astype(np.float64)


def level_of_edges(corners, level):
    """What each edge has as the largest over its patches, (P, 3); `level` by patch."""
    ids = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 3)
    highest = {}
    for row, own in zip(ids, level, strict=True):
        for k in range(3):
            key = tuple(sorted((row[k], row[(k + 1) % 3])))
            highest[key] = max(own, highest.get(key, 0))
    return np.array([[highest[tuple(sorted((row[k], row[(k + 1) % 3])))] for k in range(3)] for row in ids])


def test_screen_levels_are_projected_lengths(renderer):
    add(renderer, torus(), np.full((256, 256), 1e-7, np.float32))
    corners = base_patches(renderer)
    renderer.render(native.Camera(**CAMERA), native.RenderSettings(target_pixels=3, **WHOLE))
    ends = np.roll(corners, -1, axis=1)
    away = np.linalg.norm(0.5 * (ends + corners) - CAMERA["eye"], axis=2)
    pixels = CAMERA["height"] / (2 * math.tan(CAMERA["field_of_view"] / 2))
    expected = np.clip(np.linalg.norm(ends - corners, axis=2) * pixels / away / 3, 1, 32)
    found = renderer.snow_levels("it")["edge"]
    assert np.allclose(found, expected, rtol=1e-4)
    assert found.max() > 4


def test_thesis_levels_follow_supported_snow_and_projected_area(renderer):
    add(renderer, torus(), resolution=64)
    corners = base_patches(renderer)
    settings = native.RenderSettings(metric="THESIS", snow_factor=3000, max_level=20, **WHOLE)
    renderer.render(native.Camera(**CAMERA), settings)
    forward = np.subtract(CAMERA["target"], CAMERA["eye"])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    to = corners - CAMERA["eye"]
    scale = 1 / (math.tan(CAMERA["field_of_view"] / 2) * (to @ forward))
    x, y = to @ right * scale, to @ np.cross(right, forward) * scale
    area = 0.5 * abs((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0]))
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = across[:, 2] / np.linalg.norm(across, axis=1)
    level = np.clip(np.maximum(up, 0) * 3000 * area / 4, 1, 20)
    assert level.max() > 3 and (level == 1).mean() > 0.3
    assert np.allclose(renderer.snow_levels("it")["edge"], level_of_edges(corners, level), rtol=2e-3)


def test_deep_snow_on_a_coarse_smooth_mesh_shows_no_facets(renderer):
    """The band around the middle of a ball of 16 sides, under snow that rises and falls along its meridians, is as
    bright as that of a ball of 128. So large that relief, grains and crystals are finer than pixels."""
    swell = 12 + 6 * np.sin(np.linspace(0, 12 * np.pi, 256))
    height = np.repeat(swell.astype(np.float32)[:, None], 256, axis=1)
    camera = native.Camera(eye=(0, -400, 0), target=(0, 0, 0), width=240, height=240, field_of_view=0.5)
    light = {"sun_direction": (0.8, -0.5, 0.4), "sun_color": (1, 1, 1), "sky_color": (0.1, 0.1, 0.1)}
    bands = []
    for around in (16, 128):
        positions, triangles, uv = sphere(50.0, around, around // 2)
        add(renderer, (positions, triangles, uv), height, positions[triangles] / 50.0, resolution=256)
        picture = renderer.render(camera, native.RenderSettings(**WHOLE, **light))
        bands.append(picture[112:128, 90:150, :3].astype(int))
        renderer.remove("it")
    assert bands[1].min() > 100
    assert np.abs(bands[0] - bands[1]).max() <= 5


def test_deep_snow_on_a_coarse_smooth_ball_is_round(renderer):
    """Facets of 16 sides stand back by up to 19 mm; what lies on them by no more than half of its depth less."""
    positions, triangles, uv = sphere(0.5, 16, 8)
    back = {}
    for depth in (0.2, 0.01):
        add(
            renderer,
            (positions, triangles, uv),
            np.full((64, 64), depth, np.float32),
            positions[triangles] / 0.5,
        )
        found = captured(renderer).reshape(-1, 3)
        renderer.remove("it")
        # Away from the poles and from the seam, where this ball is open.
        found = found[(abs(found[:, 2]) < 0.35) & (found[:, 0] < -0.1)]
        assert len(found) > 1000
        away = np.linalg.norm(found, axis=1) - 0.5 - depth
        assert away.max() < 1e-6
        back[depth] = -away.min()
    assert back[0.2] < 0.0015
    assert 0.012 < back[0.01] < 0.019


def test_what_carries_no_snow_is_plain(renderer):
    height = np.zeros((256, 256), np.float32)
    height[:64, :64] = 0.05
    add(renderer, SQUARE, height, resolution=256)
    renderer.render(native.Camera(**CAMERA), native.RenderSettings(**WHOLE))
    levels = renderer.snow_levels("it")
    assert 0.05 < (levels["class"] == 2).mean() < 0.25
    assert (levels["class"] != 0).all()


def test_faces_of_many_texels_are_cut(renderer):
    for resolution in (64, 512):
        renderer.add_snow_mesh(f"of {resolution}", *grid(2.0, 2.0, 1, margin=0.0), resolution=resolution)
    renderer.render(native.Camera(**CAMERA))
    # Edges of 64 texels are cut once, those of 512 four times in half.
    assert len(renderer.snow_levels("of 64")["class"]) < 20
    assert 512 <= len(renderer.snow_levels("of 512")["class"]) <= 1024


def seen(renderer, height, **options):
    """Mean colour, 0 to 255, of the square's middle."""
    renderer.set_snow("it", height)
    picture = renderer.render(native.Camera(**ABOVE), native.RenderSettings(shadow_resolution=0, **options))
    return picture[20:-20, 20:-20, :3].astype(float)


def test_a_thin_dusting_shows_the_base_through(renderer):
    add(renderer, SQUARE, color=(0.2, 0.02, 0.02))
    red = []
    for depth in (0.0, 0.0008, 0.002, 0.03):
        mean = seen(renderer, np.full((64, 64), depth, np.float32)).mean(axis=(0, 1))
        red.append(mean[0] - mean[2])
    assert red[0] > 60 and red[-1] < 0, "bare is red, deep snow is bluish white"
    assert red[0] > red[1] > red[2] > red[3], red
    assert 0.2 < (red[1] - red[3]) / (red[0] - red[3]) < 0.95


def test_slopes_of_the_map_are_shaded(renderer):
    add(renderer, SQUARE)
    ramp = np.tile(np.linspace(0.1, 0.7, 64, dtype=np.float32), (64, 1))
    light = {"sun_direction": (-1, 0, 0.6), "sun_color": (0.8, 0.8, 0.8), "sky_color": (0.1, 0.1, 0.1)}
    level = seen(renderer, np.full((64, 64), 0.3, np.float32), **light).mean()
    assert seen(renderer, ramp, **light).mean() > level + 10, "it rises along u and faces -x"
    assert seen(renderer, ramp[:, ::-1].copy(), **light).mean() < level - 10


def test_the_look_is_fixed_to_the_object(renderer):
    height = lumps(depth=0.05)
    camera = {"field_of_view": 0.5, "width": 160, "height": 160}
    light = {
        "sun_direction": (0.8, 0.3, 0.3),
        "sun_color": (1, 1, 1),
        "sky_color": (0.2, 0.2, 0.2),
        "shadow_resolution": 0,
    }
    add(renderer, SQUARE, height)
    pictures = []
    for shift in (0.0, 0.3137):
        by = np.array((shift, -0.5 * shift, 0.25 * shift), np.float32)
        renderer.set_snow_pose("it", SQUARE[0] + by)
        at = native.Camera(eye=by + (0.1, -0.9, 0.7), target=by + (0, 0, 0), near=0.1, far=10, **camera)
        pictures += [
            renderer.render(at, native.RenderSettings(**light))[..., :3].astype(int) for _ in range(2)
        ]
    assert np.array_equal(pictures[0], pictures[1]), "nothing changes with time"
    assert pictures[0].std() > 3
    apart = abs(pictures[2] - pictures[0]).max(axis=2)
    assert (apart > 12).mean() < 0.01, "crystals and grains move with it"


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


def test_bare_patches_hide_what_is_behind_from_a_wireframe(renderer):
    add(renderer, SQUARE, np.full((64, 64), 0.05, np.float32))
    wire = renderer.render(native.Camera(**CAMERA), native.RenderSettings(wireframe=True, **WHOLE))
    assert 0.02 < (wire[..., 0] < 128).mean() < 0.7


def simulated(engine, steps=3):
    sim = native.SnowSimulation(pixel_size=0.02, blur_radius=0.02, repose=np.pi / 2, engine=engine)
    mesh = torus()
    sim.add_object("it", mesh[1], mesh[2], resolution=128)
    for step in range(steps):
        sim.step({"it": mesh[0]} if step == 0 else {}, 0.02, (0.2, 0, -1))
    return sim


def test_snow_of_a_simulation_on_the_gpu_is_drawn_without_reading_it_back(renderer):
    camera, settings = native.Camera(**CAMERA), native.RenderSettings(**WHOLE)
    add(renderer, torus(), resolution=128, color=(0.1, 0.05, 0.05))
    bare = renderer.render(camera, settings)[..., :3].astype(int)
    with simulated("GL") as sim:
        assert renderer.take_snow("it", sim) is True
        live = renderer.render(camera, settings)[..., :3].astype(int)
        renderer.set_snow("it", sim.output("it", normal=False)["height"])
        baked = renderer.render(camera, settings)[..., :3].astype(int)
        sim.step({}, 0.05, (0, 0, -1))
        assert renderer.take_snow("it", sim) is True
        later = renderer.render(camera, settings)[..., :3].astype(int)
    changed = abs(baked - bare).max(axis=2) > 20
    assert changed.mean() > 0.1
    assert (abs(live - baked).max(axis=2) > 20).mean() < 0.1 * changed.mean()
    assert (abs(later - live).max(axis=2) > 5).mean() > 0.02
    closed_when_gone = renderer.render(camera, settings)[..., :3]
    assert np.array_equal(closed_when_gone, later), "the texture outlives its simulation"


def test_snow_of_a_simulation_on_the_processor_is_handed_over(renderer):
    camera, settings = native.Camera(**CAMERA), native.RenderSettings(**WHOLE)
    add(renderer, torus(), resolution=128)
    with simulated("CPU") as sim:
        assert renderer.take_snow("it", sim) is False
        live = renderer.render(camera, settings)
        renderer.set_snow("it", sim.output("it", normal=False)["height"])
    assert np.array_equal(live, renderer.render(camera, settings))


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
        assert renderer.take_snow("tree", sim) is True
        live = renderer.render(camera)[..., :3].astype(int)
        # Limbs are thin: the output's heights allow for their curvature, which those on the GPU do not.
        renderer.set_snow("tree", sim.height("tree"))
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
    renderer.set_snow("tree", lumps(256, 0.04))
    assert closed(renderer.triangles("tree", camera, mixed))
    found = renderer.triangles("tree", large, even)
    assert found.shape == bare.shape and closed(found)
    risen = np.linalg.norm(found - bare, axis=2)
    assert 0.015 < np.median(risen) < 0.025 and risen.max() < 0.04


def test_a_trees_arrays_say_where_its_snow_lies(renderer, maple):
    camera = native.Camera(eye=(1.0, -2.2, 2.6), target=(0, 0, 1.2), width=160, height=120)
    renderer.add_tree("tree", maple)
    bare = renderer.render(camera)
    renderer.set_snow("tree", lumps(256, 0.04))
    snowed = renderer.render(camera)
    assert not np.array_equal(snowed, bare)
    renderer.set_snow("tree", np.zeros((1, 1), np.float32))
    assert np.array_equal(renderer.render(camera), bare)
    renderer.remove("tree")

    arrays = native.tree_arrays(maple)
    renderer.add_tree("tree", arrays)
    renderer.set_snow("tree", lumps(256, 0.04))
    assert np.array_equal(renderer.render(camera), snowed)
    renderer.remove("tree")

    del arrays["snow_uv"]
    renderer.add_tree("tree", arrays)
    assert np.array_equal(renderer.render(camera), bare)
    with pytest.raises(ValueError, match="no places on a map"):
        renderer.set_snow("tree", lumps(256, 0.04))


def test_snow_on_a_tree_looks_as_on_a_mesh(renderer, maple):
    renderer.add_tree("tree", maple)
    camera = native.Camera(eye=(0.3, -0.9, 0.8), target=(0, 0, 0.6), field_of_view=0.3, width=200, height=200)
    bare = renderer.render(camera, native.RenderSettings(**WHOLE))
    renderer.set_snow("tree", np.full((256, 256), 0.03, np.float32))
    snowed = renderer.render(camera, native.RenderSettings(**WHOLE)).astype(int)
    on_tree = bare[..., 3] == 255
    assert on_tree.mean() > 0.1
    assert snowed[on_tree][:, :3].mean() > bare[on_tree][:, :3].mean() + 60
    spread = snowed[on_tree][:, :3].max(axis=1) - snowed[on_tree][:, :3].min(axis=1)
    assert np.quantile(spread, 0.9) < 60, "white, not bark"


@pytest.mark.parametrize(
    "wrong, complaint",
    [
        (lambda r: add(r, SQUARE), "there already"),
        (lambda r: r.add_snow_mesh("a", SQUARE[0], SQUARE[1], SQUARE[2][:5]), r"shape \(128, 3, 2\)"),
        (lambda r: r.add_snow_mesh("a", SQUARE[0][:5], *SQUARE[1:]), "of 5"),
        (lambda r: r.add_snow_mesh("a", SQUARE[0], SQUARE[1], SQUARE[2] + 1), "outside of the map"),
        (lambda r: r.add_snow_mesh("a", SQUARE[0] * np.nan, *SQUARE[1:]), "not finite"),
        (lambda r: r.add_snow_mesh("a", *SQUARE, normals=np.zeros((3, 3, 3))), "one a corner"),
        (lambda r: r.set_snow("a", np.zeros((4, 4))), "no mesh with snow named 'a'"),
        (lambda r: r.set_snow("it", np.zeros(4)), r"shape \(N, N\)"),
        (lambda r: r.set_snow("it", np.zeros((0, 4))), "height x width"),
        (lambda r: r.set_snow_pose("it", SQUARE[0][:5]), "81 positions, not 5"),
        (lambda r: air(r, direction=(0, 0, 1)), "downwards"),
        (lambda r: air(r, rate=-1), "rate"),
    ],
)
def test_bad_input_is_named(renderer, wrong, complaint):
    add(renderer, SQUARE)
    with pytest.raises(ValueError, match=complaint):
        wrong(renderer)
