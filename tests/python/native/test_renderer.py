"""The real-time renderer: passes compared with NumPy, no cracks, limbs as round as their sections."""

import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from round_limbs import round_limbs
from test_tree_mesh import small_tree

MAPLE = Path(__file__).resolve().parents[2] / "data" / "small_maple.obj"
FIELD_OF_VIEW = 0.7
HEIGHT = 480
#: Everything is in the picture and nothing is too small for it.
FAR = {"eye": (9, -12, 3), "target": (0, 0, 2.5), "field_of_view": FIELD_OF_VIEW, "height": HEIGHT}
WHOLE = {"min_pixels": 0, "shadow_resolution": 0}


def pixels_at_one_metre(height=HEIGHT):
    return height / (2 * math.tan(FIELD_OF_VIEW / 2))


@pytest.fixture(scope="module")
def mesh():
    return native.build_tree_mesh(small_tree())


@pytest.fixture
def renderer(mesh):
    with native.Renderer() as made:
        made.add_tree("tree", mesh, bark_depth=0.0)
        yield made


def corners(renderer, **settings):
    """Positions of the quads' corners on the limbs' radius, (F, 4, 3): nothing is tessellated."""
    plain = renderer.triangles(
        "tree", native.Camera(**FAR), native.RenderSettings(max_level=1, **WHOLE, **settings)
    ).reshape(-1, 2, 3, 3)
    return np.concatenate([plain[:, 0], plain[:, 1, 2:]], axis=1)


def quad_areas(at):
    return 0.5 * np.linalg.norm(np.cross(at[:, 2] - at[:, 0], at[:, 3] - at[:, 1]), axis=1)


def edge_means(mesh, values):
    """Mean over the quads of each edge, by quad and corner."""
    sums, counts = Counter(), Counter()
    keys = [[tuple(sorted((q[k], q[(k + 1) % 4]))) for k in range(4)] for q in mesh.quads]
    for row, value in zip(keys, values, strict=True):
        for key in row:
            sums[key] += value
            counts[key] += 1
    return np.array([[sums[key] / counts[key] for key in row] for row in keys])


def round_edges(mesh):
    """Whether an edge runs round its limb, by quad and corner: the lower and upper one of a wall do."""
    walls = native.tree_arrays(mesh)["kind"] == 0
    keys = [[tuple(sorted((q[k], q[(k + 1) % 4]))) for k in range(4)] for q in mesh.quads]
    of_walls = {row[k] for row, is_wall in zip(keys, walls, strict=True) if is_wall for k in (0, 2)}
    return np.array([[key in of_walls for key in row] for row in keys])


def test_screen_levels_are_projected_lengths_and_keep_outlines_round(renderer, mesh):
    at = corners(renderer)
    renderer.render(native.Camera(**FAR), native.RenderSettings(target_pixels=3, **WHOLE))
    ends = np.roll(at, -1, axis=1)
    length = np.linalg.norm(ends - at, axis=2)
    away = np.linalg.norm(0.5 * (ends + at) - FAR["eye"], axis=2)
    pixels = length * pixels_at_one_metre() / away
    # A quarter circle's chord of that length, in parts that stray from it by a fortieth of the target.
    strays = np.minimum(3 / 40 / (pixels / math.sqrt(2)), 1)
    outline = np.where(round_edges(mesh), math.pi / 4 / np.arccos(1 - strays), 1)
    expected = np.clip(np.maximum(pixels / 3, outline), 1, 32)
    found = renderer.levels("tree")["edge"]
    assert np.allclose(found, expected, rtol=1e-3)
    assert (outline > pixels / 3).any() and (outline < pixels / 3).any()
    assert found.min() == 1 and found.max() > 4


def test_thesis_levels_follow_its_equation(renderer, mesh):
    at = corners(renderer)
    settings = native.RenderSettings(metric="THESIS", max_distance=30, max_level=20, **WHOLE)
    renderer.render(native.Camera(**FAR), settings)
    away = np.linalg.norm(0.5 * (np.roll(at, -1, axis=1) + at) - FAR["eye"], axis=2)
    areas = quad_areas(at)
    keys = [[tuple(sorted((q[k], q[(k + 1) % 4]))) for k in range(4)] for q in mesh.quads]
    lowest = {}
    for row, level in zip(keys, mesh.branch_level, strict=True):
        for key in row:
            lowest[key] = min(level, lowest.get(key, level))
    level = np.array([[lowest[key] for key in row] for row in keys])
    levels = mesh.branch_level.max() + 1
    expected = (1 - away / 30) * (edge_means(mesh, areas) / areas.max()) * 20 * (1 - level / levels)
    assert np.allclose(renderer.levels("tree")["edge"], np.clip(expected, 1, 20), rtol=1e-4)


def test_the_thesis_drops_branch_levels_beyond_their_distance(renderer, mesh):
    # Mtd * levels * (1 - level / levels): the twigs of level 2 go beyond 4 * 3 * (1 - 2 / 3) = 4 m.
    renderer.render(native.Camera(**FAR), native.RenderSettings(metric="THESIS", max_distance=4, **WHOLE))
    dropped = renderer.levels("tree")["class"] == 0
    assert np.array_equal(dropped, mesh.branch_level == 2)


@pytest.mark.parametrize("target", [2, 6, 20])
def test_patches_are_plain_where_all_edges_are(renderer, mesh, target):
    renderer.render(native.Camera(**FAR), native.RenderSettings(target_pixels=target, **WHOLE))
    levels = renderer.levels("tree")
    assert np.array_equal(levels["class"], np.where(levels["edge"].max(1) > 1, 2, 1))
    found = renderer.statistics()
    assert [found["dropped"], found["plain"], found["tessellated"]] == np.bincount(
        levels["class"], minlength=3
    ).tolist()


def test_only_what_is_outside_the_picture_or_too_small_is_dropped(renderer):
    camera = native.Camera(
        eye=(1.5, -2, 3), target=(1, 0, 3.5), field_of_view=FIELD_OF_VIEW, width=HEIGHT, height=HEIGHT
    )
    at = corners(renderer)
    renderer.render(camera, native.RenderSettings(**WHOLE))
    dropped = renderer.levels("tree")["class"] == 0
    assert 0.2 < dropped.mean() < 0.9
    # Forward, right and up of the camera: a corner inside of the picture's pyramid is seen.
    forward = np.subtract((1, 0, 3.5), (1.5, -2, 3))
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    to = at - np.array((1.5, -2, 3))
    depth, slope = to @ forward, math.tan(FIELD_OF_VIEW / 2)
    inside = (depth > 0) & (abs(to @ right) < depth * slope) & (abs(to @ up) < depth * slope)
    assert not (dropped & inside.any(axis=1)).any()
    # All corners on the outer side of a plane, by more than a limb's width.
    beyond = np.stack(
        [to @ right - depth * slope, -(to @ right) - depth * slope, to @ up - depth * slope, -depth], axis=2
    ).min(axis=1)
    assert dropped[(beyond > 0.5).any(axis=1)].all()


def closed(triangles):
    """Whether each edge, by the bits of its ends, is met once in either direction."""
    points = triangles.reshape(-1, 3)
    order = np.lexsort(points.T)
    ids = np.empty(len(points), np.int64)
    ids[order] = np.append(0, np.cumsum((np.diff(points[order], axis=0) != 0).any(axis=1)))
    begin = ids.reshape(-1, 3)
    end = np.roll(begin, -1, axis=1)
    _, edges = np.unique(np.minimum(begin, end) * len(ids) + np.maximum(begin, end), return_inverse=True)
    return not np.bincount(edges.ravel(), np.sign(end - begin).ravel()).any()


@pytest.mark.parametrize("metric", ["SCREEN", "THESIS"])
@pytest.mark.parametrize("target", [15, 40])
def test_the_tessellated_surface_is_closed_to_the_bit(mesh, metric, target):
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh, bark_depth=0.2)
        camera = native.Camera(eye=(1.5, -2.5, 2.5), target=(0, 0, 2.5), field_of_view=2.5, height=900)
        settings = native.RenderSettings(
            metric=metric, target_pixels=target, max_distance=20, max_area=0.2, **WHOLE
        )
        found = renderer.triangles("tree", camera, settings)
        renderer.render(camera, settings)
        levels = renderer.levels("tree")
    assert set(levels["class"]) == {1, 2}, "plain and tessellated patches meet"
    assert len(np.unique(levels["edge"])) > 20
    assert closed(found)
    assert not closed(np.delete(found, 100, axis=0))


def test_a_draw_of_more_vertices_than_16_bits_count_is_closed():
    tree = native.build_tree_mesh(native.read_tree(MAPLE))
    with native.Renderer() as renderer:
        renderer.add_tree("tree", tree)
        camera = native.Camera(eye=(3, -4, 1.5), target=(0, 0, 1.5), width=4096, height=4096)
        found = renderer.triangles("tree", camera, native.RenderSettings(target_pixels=4, **WHOLE))
    assert len(found) > 2 * 65536
    assert closed(found)


@pytest.mark.parametrize(
    "direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0.01, 0, 1), (0.01, 0, -1)]
)
def test_no_background_shows_from_inside_of_a_closed_tree(mesh, direction):
    eye = np.array((0.02, 0.01, 2.0))
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh, bark_depth=0.2)
        camera = native.Camera(
            eye=eye,
            target=eye + direction,
            up=(0, 0, 1) if direction[2] == 0 else (0, 1, 0),
            field_of_view=1.6,
            width=300,
            height=300,
            near=1e-4,
            far=100,
        )
        picture = renderer.render(camera, native.RenderSettings(cull_back_faces=False, **WHOLE))
        assert renderer.statistics()["tessellated"] > 5
    assert (picture[..., 3] == 255).all()


def test_limbs_are_as_round_as_their_sections(mesh):
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh, bark_depth=0.0)
        fine = renderer.triangles(
            "tree", native.Camera(**FAR), native.RenderSettings(target_pixels=0.5, **WHOLE)
        )
    across = np.cross(fine[:, 1] - fine[:, 0], fine[:, 2] - fine[:, 0])
    size = np.linalg.norm(across, axis=1)
    fine, normal = fine.mean(axis=1)[size > 0], (across / np.maximum(size, 1e-30)[:, None])[size > 0]
    vertices, _quads, _uvs, radius = round_limbs(mesh, 2)
    off = np.empty(len(vertices))
    for i, p in enumerate(vertices):
        nearest = np.argmin(((fine - p) ** 2).sum(1))
        off[i] = (p - fine[nearest]) @ normal[nearest]
    # Four-sided limbs stand a third of their radius out of the round ones.
    share = abs(off) / radius
    assert np.quantile(share, 0.5) < 0.002
    assert np.quantile(share, 0.9) < 0.01
    assert share.max() < 0.25, "rims, where limbs meet"


def test_bark_has_four_scales_each_half_as_high_that_come_with_the_samples(mesh):
    """Corners of the trunk, whose circumference is 1.25 m, seen from so far that their distances are equal."""
    rise, waves = 0.2 * 0.2, (8, 16, 32, 64)
    view = {"target": (0, 0, 2.5), "field_of_view": 0.01, "height": 4 * HEIGHT}
    camera = native.Camera(eye=(0, -1000, 2.5), **view)
    pixels = 2 * math.pi * 0.2 * 4 * HEIGHT / (2 * math.tan(0.005)) / 1000
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh, bark_depth=0.2)

        def radii(samples):
            settings = native.RenderSettings(max_level=1, target_pixels=pixels / samples, **WHOLE)
            found = renderer.triangles("tree", camera, settings).reshape(-1, 2, 3, 3)
            trunk = found[np.flatnonzero(mesh.branch_level == 0)].reshape(-1, 3)
            return np.hypot(trunk[:, 0], trunk[:, 1])

        heights = [radii(samples) for samples in (waves[0], *(4 * count for count in waves))]
    for scale, (coarser, finer) in enumerate(zip(heights, heights[1:], strict=False)):
        most = rise / 2 ** (scale + 1)
        added = abs(finer - coarser)
        assert 0.5 * most < added.max() < 1.01 * most


def test_statistics_count_the_triangles_that_are_drawn(renderer, mesh):
    camera, settings = native.Camera(**FAR), native.RenderSettings(target_pixels=3, **WHOLE)
    renderer.render(camera, settings)
    found = renderer.statistics()
    assert found["triangles"] == len(renderer.triangles("tree", camera, settings))
    assert found["dropped"] + found["plain"] + found["tessellated"] == len(mesh.quads)
    assert found["passes"]["plain"]["primitives"] == 2 * found["plain"]
    assert {"pose", "edges", "classify", "plain", "tessellated", "leaves", "meshes"} == set(found["passes"])
    assert all(one["gpu_seconds"] > 0 for name, one in found["passes"].items() if name != "meshes")
    assert found["wall_seconds"] >= sum(one["wall_seconds"] for one in found["passes"].values())


def test_nothing_is_tessellated_at_level_one(renderer, mesh):
    renderer.render(native.Camera(**FAR), native.RenderSettings(max_level=1, **WHOLE))
    assert renderer.statistics()["triangles"] == 2 * len(mesh.quads)


def test_a_pose_moves_vertices_by_their_bones(renderer, mesh):
    at = corners(renderer)
    matrices = np.tile(np.eye(4, dtype=np.float32), (len(mesh.bone_names), 1, 1))
    matrices[:, :3, 3] = (0.5, -0.25, 1)
    renderer.set_pose("tree", matrices)
    assert np.allclose(corners(renderer), at + (0.5, -0.25, 1), atol=1e-5)
    matrices[1:] = np.eye(4)
    renderer.set_pose("tree", matrices)
    share = np.where(mesh.bone_indices == 0, mesh.bone_weights, 0).sum(1)[mesh.quads]
    moved = at + share[..., None] * np.array((0.5, -0.25, 1))
    assert np.allclose(corners(renderer), moved, atol=1e-5)


def test_the_same_picture_is_the_same_bytes(mesh):
    pictures = []
    for _ in range(2):
        with native.Renderer() as renderer:
            renderer.add_tree("tree", mesh)
            pictures += [renderer.render(native.Camera(**FAR)) for _ in range(2)]
    assert all(np.array_equal(picture, pictures[0]) for picture in pictures)
    assert 0 < (pictures[0][..., 3] > 0).mean() < 0.2


def test_a_wireframe_hides_what_is_behind(renderer):
    camera = native.Camera(eye=(0.8, -1.2, 2), target=(0, 0, 2), width=300, height=300)
    wire = renderer.render(camera, native.RenderSettings(wireframe=True, **WHOLE))
    solid = renderer.render(camera, native.RenderSettings(**WHOLE))
    on_tree = wire[solid[..., 3] > 0][:, 0] < 128
    assert 0.05 < on_tree.mean() < 0.6
    assert wire[150, 0, 0] == 255


def set_leaf(renderer, image, uv=None):
    """Gives the tree a card of 2 x 2 m in front of it, which faces -Y."""
    a, b, c, d = (-1, -3, 1), (1, -3, 1), (1, -3, 3), (-1, -3, 3)
    renderer.set_leaves(
        "tree", np.array([(a, b, c), (a, c, d)], np.float32), [0, 0], uv, colors=[(1, 1, 1)], images=[image]
    )


def leaf(renderer, image, **options):
    """The picture of such a card."""
    set_leaf(renderer, image, np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], np.float32))
    camera = native.Camera(eye=(0, -9, 2), target=(0, -3, 2), width=200, height=200)
    return renderer.render(camera, native.RenderSettings(sun_direction=(0, -1, 0.5), **options))


def bark_of(mesh, color):
    """Arguments of set_bark: arbitrary coordinates, and one colour."""
    quads = len(mesh.quads)
    return np.zeros((quads, 4, 2), np.float32), np.zeros(quads, np.int32), [color]


def test_bark_shows_an_image_times_its_colour(renderer, mesh):
    green = np.full((2, 2, 4), (0, 255, 0, 255), np.uint8)
    uv, materials, _ = bark_of(mesh, None)
    settings = native.RenderSettings(**WHOLE, background=(0, 0, 0), sun_color=(0, 0, 0), sky_color=(0.2,) * 3)
    brightness = []
    for color in ((1, 1, 1), (1, 0.25, 1)):
        renderer.set_bark("tree", uv, materials, [color], [green])
        picture = renderer.render(native.Camera(**FAR), settings)[..., :3].astype(int)
        assert picture[..., 0].max() == 0 and picture[..., 2].max() == 0
        brightness.append(picture[..., 1].max())
    assert brightness[0] > 1.3 * brightness[1] > 50


@pytest.mark.parametrize(
    "wrong, complaint",
    [
        ({"uv": np.zeros((1, 4, 2), np.float32), "materials": np.zeros(1, np.int32)}, "one entry for each"),
        ({"materials": 7}, "material index 7 of quad 0 must be at least 0 and below 1"),
        ({"images": [np.zeros((2, 2, 3), np.uint8)]}, "shape"),
    ],
)
def test_bark_that_does_not_fit_the_tree_is_refused(renderer, mesh, wrong, complaint):
    uv, materials, colors = bark_of(mesh, (1, 1, 1))
    if wrong.get("materials", None) is not None and np.isscalar(wrong["materials"]):
        wrong = {"materials": np.full_like(materials, wrong["materials"])}
    given = {"uv": uv, "materials": materials, "colors": colors, **wrong}
    with pytest.raises(ValueError, match=complaint):
        renderer.set_bark("tree", **given)


def test_leaves_have_holes_where_their_image_has(renderer):
    image = np.full((8, 8, 4), 255, np.uint8)
    image[:4, :, 3] = 0
    image[4:, :, :3] = (255, 0, 0)
    picture = leaf(renderer, image, **WHOLE)
    upper, lower = picture[125, 75], picture[75, 75]
    assert upper[3] == 255 and upper[0] > 2 * upper[1]
    assert lower[3] == 0


@pytest.mark.parametrize("wall", [2, 60])
def test_leaves_cast_the_shadow_of_their_image_however_far_it_falls(renderer, wall):
    renderer.add_mesh(
        "wall", [(-3, wall, 0), (3, wall, 0), (3, wall, 5), (-3, wall, 5)], [(0, 1, 2), (0, 2, 3)]
    )
    image = np.full((8, 8, 4), 255, np.uint8)

    def shade(alpha):
        image[..., 3] = alpha
        set_leaf(renderer, image)
        camera = native.Camera(eye=(-0.7, wall - 3, 2), target=(-0.7, wall, 2), width=100, height=100)
        return renderer.render(camera, native.RenderSettings(sun_direction=(0, -1, 0)))[50, 50, 0]

    assert shade(0) > shade(255) + 40


@pytest.mark.parametrize(
    "wrong, complaint",
    [
        (lambda r, m: r.add_tree("tree", m), "already exists"),
        (lambda r, m: r.add_tree("fine", native.build_tree_mesh(small_tree(), detail="GAME")), "BASE"),
        (lambda r, m: r.add_tree("deep", m, bark_depth=2), "bark_depth"),
        (lambda r, m: r.set_pose("oak", np.zeros((1, 4, 4))), "no tree 'oak'"),
        (lambda r, m: r.set_pose("tree", np.zeros((1, 4, 4))), "bone matrices, not 1"),
        (lambda r, m: r.set_pose("tree", np.zeros((1, 3, 4))), r"shape \(N, 4, 4\)"),
        (lambda r, m: r.set_leaves("tree", np.zeros((1, 3, 3)), [999]), "bone index 999"),
        (lambda r, m: r.add_mesh("m", np.zeros((3, 3)), [(0, 1, 3)]), "vertex index 3"),
        (lambda r, m: r.remove("oak"), "no tree or mesh named 'oak'"),
        (lambda r, m: r.render(native.Camera(width=0)), "width"),
        (lambda r, m: r.render(native.Camera(eye=(0, 0, 0), target=(0, 0, 1))), "up"),
        (lambda r, m: native.RenderSettings(metric="AREA"), "THESIS, SCREEN"),
    ],
)
def test_bad_input_is_named(renderer, mesh, wrong, complaint):
    with pytest.raises(ValueError, match=complaint):
        wrong(renderer, mesh)


def test_a_setting_that_is_not_there_is_told():
    with pytest.raises(TypeError, match="'colour'"):
        native.RenderSettings(colour=1)


def test_a_closed_renderer_says_so(mesh):
    renderer = native.Renderer()
    with pytest.raises(RuntimeError, match="render a picture first"):
        renderer.statistics()
    renderer.close()
    renderer.close()
    with pytest.raises(RuntimeError, match="closed"):
        renderer.render(native.Camera())


def test_snow_and_pictures_share_a_context(renderer, mesh):
    picture = renderer.render(native.Camera(**FAR))
    plane = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
    faces = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    heights = []
    for between in (False, True):
        with native.SnowSimulation(pixel_size=0.02, engine="GL") as snow:
            snow.add_object("plane", faces, plane[faces][..., :2], resolution=64)
            snow.step({"plane": plane}, 0.01)
            if between:
                assert np.array_equal(renderer.render(native.Camera(**FAR)), picture)
            snow.step({}, 0.01)
            heights.append(snow.height("plane"))
    assert np.array_equal(*heights)


def test_a_tree_in_many_places_takes_the_calls_of_one(mesh):
    camera = native.Camera(eye=(0, -30, 8), target=(0, 0, 2), width=128, height=128)
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh)
        renderer.render(camera)
        one = renderer.statistics()
        places = np.tile(np.eye(4, dtype=np.float32), (5, 1, 1))
        places[:, 0, 3] = np.arange(-8, 12, 4)
        renderer.set_instances("tree", places)
        instanced = renderer.render(camera)
        many = renderer.statistics()
        assert [many[key] for key in ("dispatches", "draws")] == [one[key] for key in ("dispatches", "draws")]
        renderer.set_instances("tree", places[:1])
        for number in range(1, 5):
            renderer.share_tree(f"tree {number}", "tree")
            renderer.set_instances(f"tree {number}", places[number : number + 1])
        assert np.array_equal(renderer.render(camera), instanced)
        assert renderer.statistics()["buffer_bytes"] < 1.5 * many["buffer_bytes"]
        with pytest.raises(ValueError, match="no tree 'other'"):
            renderer.share_tree("twin", "other")
