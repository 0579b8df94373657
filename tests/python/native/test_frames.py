"""The renderer as a viewport uses it: cameras by matrices, meshes with images, linear light, and asynchronous
frames."""

import time

import numpy as np
import pytest
import snowbough_native as native
from snowbough.realtime import frame_code
from test_tree_mesh import small_tree

SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
HALVES = np.array([(0, 1, 2), (0, 2, 3)])
CORNERS = (0.5 * SQUARE[:, :2] + 0.5)[HALVES]
SUN = {"sun_direction": (0, 0, 1), "sun_color": (0.5, 0.25, 0.125), "shadow_resolution": 0}
SKY = {"sky_color": (0.25, 0.5, 1.0), "ground_color": (0, 0, 0)}


def look_at(eye, target, up):
    """OpenGL's view matrix."""
    forward = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(right, forward), -forward])
    view = np.eye(4)
    view[:3, :3] = rotation
    view[:3, 3] = -rotation @ np.asarray(eye, float)
    return view


def perspective(angle, aspect, near, far):
    f = 1 / np.tan(angle / 2)
    depth = near - far
    return np.array(
        [
            (f / aspect, 0, 0, 0),
            (0, f, 0, 0),
            (0, 0, (far + near) / depth, 2 * far * near / depth),
            (0, 0, -1, 0),
        ]
    )


def orthographic(half_width, half_height, near, far):
    depth = far - near
    return np.array(
        [
            (1 / half_width, 0, 0, 0),
            (0, 1 / half_height, 0, 0),
            (0, 0, -2 / depth, -(far + near) / depth),
            (0, 0, 0, 1),
        ]
    )


#: From above, a metre is ten pixels.
ABOVE = {
    "view": look_at((0, 0, 5), (0, 0, 0), (0, 1, 0)),
    "projection": orthographic(2, 2, 0.1, 10),
    "width": 40,
    "height": 40,
}


@pytest.fixture
def renderer():
    with native.Renderer() as made:
        yield made


def light(renderer, samples=1, camera=ABOVE, **settings):
    return renderer.render_light(
        native.Camera(**camera), native.RenderSettings(**{**SUN, **SKY, **settings}), samples
    )


def test_a_camera_by_matrices_shows_what_the_same_pinhole_shows(renderer):
    renderer.add_tree("tree", native.build_tree_mesh(small_tree()))
    size = {"width": 160, "height": 120}
    lens = {"field_of_view": 0.7, "near": 0.5, "far": 50}
    by_eye = renderer.render(native.Camera(eye=(9, -12, 3), target=(0, 0, 2.5), **lens, **size))
    by_matrices = renderer.render(
        native.Camera(
            view=look_at((9, -12, 3), (0, 0, 2.5), (0, 0, 1)),
            projection=perspective(0.7, 4 / 3, 0.5, 50),
            **size,
        )
    )
    drawn = by_eye[..., 3] > 0
    assert drawn.mean() > 0.005
    assert (drawn != (by_matrices[..., 3] > 0)).mean() < 0.001


def test_an_orthographic_camera_counts_pixels_by_its_matrix(renderer):
    renderer.add_mesh("square", SQUARE, HALVES)
    drawn = light(renderer)[..., 3] > 0
    assert np.array_equal(np.argwhere(drawn).min(0), (10, 10))
    assert np.array_equal(np.argwhere(drawn).max(0), (29, 29))


def test_trees_under_an_orthographic_camera_are_cut_by_their_size_on_the_picture(renderer):
    renderer.add_tree("tree", native.build_tree_mesh(small_tree()), bark_depth=0.0)
    found = []
    for half in (4, 8):
        camera = native.Camera(
            view=look_at((0, -20, 2.5), (0, 0, 2.5), (0, 0, 1)),
            projection=orthographic(half, half, 0.1, 40),
            width=256,
            height=256,
        )
        renderer.render(camera, native.RenderSettings(min_pixels=0, shadow_resolution=0, max_level=64))
        found.append(renderer.levels("tree")["edge"])
    both = (found[1] > 1) & (found[0] < 64)
    more = found[0][both] / found[1][both]
    # Lengths are cut into twice as many pixels; an outline is round to a pixel with the root of that.
    by_length = np.isclose(more, 2.0, rtol=0.01)
    assert by_length.sum() > 50
    assert more.min() > 0.99 * np.sqrt(2.0) and more.max() < 2.02


@pytest.mark.parametrize(
    "matrices", [{"view": np.eye(4)}, {"view": np.zeros((4, 4)), "projection": np.eye(4)}]
)
def test_half_a_camera_and_one_without_an_inverse_are_told(renderer, matrices):
    with pytest.raises(ValueError, match="matrix"):
        renderer.render(native.Camera(**matrices))


def test_light_is_linear_and_the_background_has_no_alpha(renderer):
    renderer.add_mesh("square", SQUARE, HALVES, color=(0.5, 0.5, 0.5))
    picture = light(renderer, background=(2.0, 3.0, 4.0))
    assert np.allclose(picture[20, 20], (0.5 * 0.75, 0.5 * 0.75, 0.5 * 1.125, 1), rtol=2e-3)
    assert np.allclose(picture[2, 2], (2, 3, 4, 0), rtol=2e-3)


def test_samples_smooth_edges_and_the_same_bytes_come_again(renderer):
    renderer.add_mesh("square", SQUARE + np.float32(0.03), HALVES)
    once, again = light(renderer, samples=16), light(renderer, samples=16)
    assert once.tobytes() == again.tobytes()
    assert len(np.unique(light(renderer)[..., 3])) == 2
    edge = once[15, :, 3]
    assert np.count_nonzero((edge > 0) & (edge < 1)) >= 2


def test_an_image_lies_on_its_coordinates_bottom_row_first(renderer):
    image = np.full((4, 4, 4), 255, np.uint8)
    image[:2, :2, :3], image[:2, 2:, :3], image[2:, :2, :3] = (255, 0, 0), (0, 255, 0), (0, 0, 255)
    renderer.add_mesh("square", SQUARE, HALVES, uv=CORNERS, colors=[(0.5, 0.5, 0.5)], images=[image])
    white = {"sun_color": (0, 0, 0), "sky_color": (1, 1, 1)}
    picture = light(renderer, **white)[..., :3]
    assert np.allclose(picture[14, 14], (0.5, 0, 0), atol=1e-3)
    assert np.allclose(picture[14, 25], (0, 0.5, 0), atol=1e-3)
    assert np.allclose(picture[25, 14], (0, 0, 0.5), atol=1e-3)
    assert np.allclose(picture[25, 25], (0.5, 0.5, 0.5), atol=1e-3)


def test_an_image_less_than_half_there_is_a_hole(renderer):
    image = np.full((1, 2, 4), 255, np.uint8)
    image[0, 0, 3] = 0
    renderer.add_mesh("square", SQUARE, HALVES, uv=CORNERS, colors=[(1, 1, 1)], images=[image])
    drawn = light(renderer)[..., 3] > 0
    assert drawn[20, 27] and not drawn[20, 12]


def test_a_mesh_is_in_all_of_its_places_with_upright_normals(renderer):
    renderer.add_mesh("square", SQUARE, HALVES, color=(1, 1, 1))
    flat = np.diag([0.25, 0.25, 0.01, 1]).astype(np.float32)
    turned = np.array([(0, 0, 0.25, 1), (0, 0.25, 0, 1), (-0.25, 0, 0, 0), (0, 0, 0, 1)])
    left = flat.copy()
    left[:2, 3] = -1
    right = flat.copy()
    right[:2, 3] = 1
    renderer.set_instances("square", [left, right])
    picture = light(renderer)
    assert np.allclose(picture[10, 10, :3], (0.75, 0.75, 1.125), rtol=2e-3)
    assert np.allclose(picture[10, 10], picture[30, 30])
    assert not picture[20, 20].any() or picture[20, 20, 3] == 0
    renderer.set_instances("square", [turned])  # on edge: nothing to be seen from above
    assert light(renderer)[..., 3].max() == 0


def test_triangles_take_the_materials_that_they_name(renderer):
    renderer.add_mesh("square", SQUARE, HALVES, materials=[0, 1], colors=[(1, 0, 0), (0, 0, 1)])
    picture = light(renderer, sun_color=(0, 0, 0), sky_color=(1, 1, 1))
    assert np.allclose(picture[12, 27, :3], (1, 0, 0), atol=1e-3)
    assert np.allclose(picture[27, 12, :3], (0, 0, 1), atol=1e-3)


def test_what_does_not_fit_together_is_told(renderer):
    with pytest.raises(ValueError, match="vertex index 4 of a triangle must be at least 0 and below 4"):
        renderer.add_mesh("a", SQUARE, [(0, 1, 4)])
    with pytest.raises(ValueError, match="material index 2 of a triangle must be at least 0 and below 1"):
        renderer.add_mesh("a", SQUARE, HALVES, materials=[0, 2])
    with pytest.raises(ValueError, match="no mesh 'a'"):
        renderer.set_instances("a", [np.eye(4)])


def test_snow_whitens_what_it_covers(renderer):
    renderer.add_mesh("square", SQUARE, HALVES, color=(0, 0, 0))
    heights = np.zeros((64, 64), np.float32)
    heights[:, 32:] = 0.1
    renderer.set_mesh_snow("square", heights, CORNERS)
    picture = light(renderer, sun_color=(0, 0, 0), sky_color=(1, 1, 1))[..., :3]
    assert picture[20, 13].max() == 0
    assert picture[20, 27].min() > 0.8
    renderer.set_mesh_snow("square")
    assert light(renderer)[10:30, 10:30, :3].max() == 0


def test_a_tree_carried_away_by_its_pose_keeps_its_shadow(renderer):
    mesh = native.build_tree_mesh(small_tree())
    renderer.add_tree("tree", mesh)
    away = np.array([(1, 0, 0, 300), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
    renderer.set_pose("tree", np.repeat(away[None], len(mesh.bone_parents), axis=0))
    ground = 50 * SQUARE + np.float32((300, 0, 0))
    renderer.add_mesh("ground", ground, HALVES, color=(1, 1, 1))
    camera = {
        **ABOVE,
        "view": look_at((300, 0, 20), (300, 0, 0), (0, 1, 0)),
        "projection": orthographic(4, 4, 1, 40),
    }
    lit = light(renderer, camera=camera, shadow_resolution=1024, sun_direction=(1, 0, 1), sky_color=(0, 0, 0))
    assert (lit[..., 0] < 0.1).mean() > 0.01
    assert (lit[..., 0] > 0.3).mean() > 0.5


def test_a_trees_arrays_make_the_same_tree(renderer):
    mesh = native.build_tree_mesh(small_tree())
    camera = native.Camera(eye=(9, -12, 3), target=(0, 0, 2.5), width=160, height=120)
    renderer.add_tree("tree", mesh)
    picture = renderer.render(camera)
    arrays = native.tree_arrays(mesh)
    renderer.remove("tree")
    renderer.add_tree("tree", arrays)
    assert np.array_equal(renderer.render(camera), picture)
    del arrays["kind"]
    with pytest.raises(ValueError, match="lack 'kind'"):
        renderer.add_tree("other", arrays)


# -- frames -------------------------------------------------------------------------------------------------


def newest(renderer, ticket, seconds=30):
    """Polls until the frame with that ticket arrives. Counts the polls: a pause of the machine fails no test."""
    for _ in range(round(seconds / 0.002)):
        frame = renderer.take_frame()
        if frame is not None and frame[0] == ticket:
            return frame[1]
        time.sleep(0.002)
    raise AssertionError(f"frame {ticket} did not arrive")


def test_a_frame_is_the_picture_in_numbers_that_every_driver_keeps(renderer):
    renderer.add_mesh("square", SQUARE, HALVES, color=(1, 1, 1))
    settings = {**SUN, **SKY, "background": (0.02, 0.18, 7.0)}
    ticket = renderer.request_frame(native.Camera(**ABOVE), native.RenderSettings(**settings))
    frame = newest(renderer, ticket)
    assert frame.shape == (40, 40) and frame.dtype == np.float32
    assert frame.min() >= 0.5 and frame.max() < 2
    expected = light(renderer, background=(0.02, 0.18, 7.0))[..., :3]
    found = frame_code.light(frame)
    # A step of a byte, and dithering around it.
    assert np.allclose(found, expected, rtol=0.08, atol=0.002)
    corner = found[:8, :8].reshape(-1, 3).mean(axis=0)
    assert np.allclose(corner, (0.02, 0.18, 7.0), rtol=0.01)


def test_a_draft_keeps_the_shadows_only_while_nothing_but_the_camera_moves(renderer):
    renderer.add_mesh("roof", 0.5 * SQUARE + np.float32((0, 0, 1)), HALVES)
    renderer.add_mesh("ground", SQUARE, HALVES, color=(1, 1, 1))
    sun = {**SUN, "sun_direction": (1, 0, 1), "sky_color": (0, 0, 0), "shadow_resolution": 256}

    def shaded(**others):
        camera = native.Camera(**ABOVE)
        ticket = renderer.request_frame(camera, native.RenderSettings(**{**sun, **others}))
        return frame_code.light(newest(renderer, ticket))[20, :, 0] < 0.01

    first = shaded()
    assert first[11:15].all() and not first[16:29].any()  # a metre beside the roof, away from the sun
    assert np.array_equal(shaded(draft=True), first)
    renderer.set_instances("roof", [np.eye(4) + 0.5 * np.eye(4, k=3)])
    moved = shaded(draft=True)
    assert moved[16:19].all()
    turned = shaded(draft=True, sun_direction=(-1, 0, 1))
    assert not turned[16:19].any()


def test_of_many_requests_the_last_one_is_shown_and_nobody_waits(renderer):
    renderer.add_tree("tree", native.build_tree_mesh(small_tree()))
    longest = 0.0
    for step in range(60):
        begun = time.perf_counter()
        camera = native.Camera(eye=(12, -12, 3 + 0.1 * step), target=(0, 0, 2.5), width=800, height=600)
        ticket = renderer.request_frame(camera)
        renderer.take_frame()
        longest = max(longest, time.perf_counter() - begun)
    begun = time.perf_counter()
    renderer.render(camera)
    whole = time.perf_counter() - begun
    print(f"longest call {1e3 * longest:.2f} ms, a picture {1e3 * whole:.1f} ms")
    newest(renderer, ticket)
    assert longest < max(0.5 * whole, 0.05)
    assert ticket == 60
    assert not renderer.is_busy
    assert renderer.take_frame() is None


def test_a_renderer_that_does_not_wait_says_later_what_went_wrong():
    with native.Renderer(waits=False) as renderer:
        renderer.add_mesh("square", SQUARE, HALVES)
        renderer.remove("circle")
        ticket = renderer.request_frame(native.Camera(**ABOVE), native.RenderSettings(**SUN))
        with pytest.raises(ValueError, match="no tree or mesh named 'circle'"):
            newest(renderer, ticket)
        settings = native.RenderSettings(**SUN, background=(0, 0, 0))
        ticket = renderer.request_frame(native.Camera(**ABOVE), settings)
        found = frame_code.light(newest(renderer, ticket))
        assert found[20, 20].min() > 0.1 and found[2, 2].max() < 0.01


def test_a_device_that_is_not_there_is_told_by_the_first_look_for_a_frame():
    with native.Renderer("/dev/dri/none", waits=False) as renderer:
        renderer.request_frame(native.Camera(**ABOVE))
        with pytest.raises(RuntimeError, match="/dev/dri/none"):
            newest(renderer, 1)


def test_a_closed_renderer_makes_no_frames():
    renderer = native.Renderer(waits=False)
    renderer.request_frame(native.Camera(**ABOVE))
    renderer.close()
    with pytest.raises(RuntimeError, match="closed"):
        renderer.take_frame()
