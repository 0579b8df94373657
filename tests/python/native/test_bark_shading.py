"""The light on bark: no outlines around the holes of forks, no dashes along furrows, no sunlight behind the limb."""

import numpy as np
import pytest
import snowbough_native as native
from test_tree_mesh import branch

#: One colour, so that a picture shows light alone.
GREY = {"bark_dark": (0.5, 0.5, 0.5), "bark_light": (0.5, 0.5, 0.5)}
LIGHT = {"shadow_resolution": 0, "sky_color": (0.1, 0.1, 0.1), "ground_color": (0.1, 0.1, 0.1)}
SIZE = 200

TRUNK = branch("trunk", 0, -1, [(0, 0, z) for z in range(6)], 0.2)
#: Upwards, and down to the right of a camera in front of the trunk.
SIDE = {
    "up": branch("side", 1, 0, [(0, 0, 2.5), (-1, -0.3, 3), (-2, -0.5, 3.2)], 0.1),
    "down": branch("side", 1, 0, [(0, 0, 2.6), (1, -0.5, 2.2), (2, -0.8, 2)], 0.07),
}


def camera_at(eye, target, field_of_view):
    size = {"width": SIZE, "height": SIZE, "near": 0.1, "far": 10.0}
    return native.Camera(eye=eye, target=target, field_of_view=field_of_view, **size)


def front():
    """A camera before the trunk."""
    return camera_at((0, -1.3, 2.55), (0, 0, 2.55), field_of_view=0.5)


def drawn(branches, camera, sun, samples=1, bark_depth=0.0, **of_settings):
    """(light, depth) of a tree: (height, width) each."""
    with native.Renderer() as renderer:
        mesh = native.build_tree_mesh(native.Skeleton.from_branches(branches))
        renderer.add_tree("tree", mesh, bark_depth=bark_depth, **GREY)
        settings = native.RenderSettings(sun_direction=sun, **LIGHT, **of_settings)
        light = renderer.render_light(camera, settings, samples)[..., 0]
        return light, renderer.render_depth(camera, settings)


@pytest.mark.parametrize("side", ["up", "down"])
def test_the_trunk_is_lit_beside_a_hole_as_without_it(side):
    camera = front()
    sun = (-0.7, -0.6, 0.4)
    without, depth = drawn([TRUNK], camera, sun)
    shown, there = drawn([TRUNK, SIDE[side]], camera, sun)
    trunk = (depth < 1.0) & (np.abs(there - depth) < 2e-3 * (1 - depth))
    assert trunk.sum() > 0.25 * SIZE**2 and (depth < 1.0).sum() - trunk.sum() > 100
    off = np.abs(shown - without)[trunk] / without.max()
    assert off.mean() < 0.002
    # A few pixels at the rim show the branch.
    assert np.percentile(off, 99) < 0.02


def test_furrows_are_lines_not_dashes():
    camera = camera_at((1, -1.3, 2), (0, 0, 2.5), field_of_view=1.0)
    sun = (0.9, -0.5, 0.3)
    # Few vertices: the furrows are in the pixels' normals.
    bark = {"bark_depth": 0.15, "target_pixels": 40}
    one, depth = drawn([TRUNK], camera, sun, **bark)
    mean, _ = drawn([TRUNK], camera, sun, 32, **bark)
    # Away from outlines.
    inside = np.lib.stride_tricks.sliding_window_view(depth < 1.0, (5, 5)).all(axis=(2, 3))
    one, mean = one[2:-2, 2:-2][inside], mean[2:-2, 2:-2][inside]
    assert np.sqrt(np.mean((one - mean) ** 2)) < 0.04 * mean.mean()
    assert mean.std() > 0.2 * mean.mean()  # there are furrows


def test_bark_behind_the_limb_has_no_sun():
    # All of the trunk's left half faces away from the sun.
    lit, depth = drawn([TRUNK], front(), (1.0, 0.05, 0.0), bark_depth=0.15)
    left = depth[:, : SIZE // 2 - 3] < 1.0
    assert left.sum() > 4000
    # Light of the sky on a colour of one half.
    assert lit[:, : SIZE // 2 - 3][left].max() < 0.0502
    right = lit[:, SIZE // 2 :][depth[:, SIZE // 2 :] < 1.0]
    assert right.max() > 0.8
