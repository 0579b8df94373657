# SPDX-License-Identifier: GPL-3.0-or-later
"""The room `realtime` without Blender: calls of the renderer, light, the frame rate of a viewport, frames."""

import math

import numpy as np
import pytest
from snowbough.realtime import frame_code, lights, pacing, records, sync
from snowbough.surface import style


class Recorder:
    """A mock of a native Renderer: records the calls and their names."""

    def __init__(self):
        self.calls = []

    def __getattr__(self, name):
        def note(key, *_given, **_named):
            self.calls.append((name, key))

        return note

    def take(self):
        calls, self.calls = self.calls, []
        return calls


MATRIX = np.eye(4, dtype=np.float32)[None]


def shape(size=1.0, color=(1, 0, 0)):
    vertices = size * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32)
    normals = np.tile(np.float32((0, 0, 1)), (1, 3, 1))
    return records.Shape(
        vertices,
        np.array([(0, 1, 2)], np.int32),
        normals,
        np.zeros((1, 3, 2), np.float32),
        np.zeros(1, np.int32),
        (records.Paint(color),),
    )


def mesh(key="a", matrices=MATRIX, snow=None, **of_shape):
    made = shape(**of_shape)
    return records.Mesh(key, made, made.print, matrices, snow)


def tree(key="t", pose=0.0, print_="p", leaves=None, leaves_print="", snow=None, matrices=MATRIX):
    poses = np.full((2, 4, 4), pose, np.float32)
    return records.Tree(key, {}, print_, records.Bark(), poses, matrices, leaves, leaves_print, snow=snow)


@pytest.fixture
def renderer():
    return Recorder()


def test_what_is_new_is_added_once(renderer):
    keeper = sync.Sync(renderer)
    assert keeper.update(records.Scene([mesh()], [tree()]))
    assert renderer.take() == [("add_mesh", "a"), ("add_tree", "t"), ("set_pose", "t")]
    assert not keeper.update(records.Scene([mesh()], [tree()]))
    assert renderer.take() == []


def test_what_moves_is_not_uploaded_again(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([mesh()], [tree()]))
    renderer.take()
    assert keeper.update(records.Scene([mesh(matrices=2 * MATRIX)], [tree(pose=1.0)]))
    assert renderer.take() == [("set_instances", "a"), ("set_pose", "t")]


@pytest.mark.parametrize("other", [{"size": 2.0}, {"color": (0, 1, 0)}])
def test_what_has_another_shape_or_colour_is_replaced(renderer, other):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([mesh()]))
    renderer.take()
    keeper.update(records.Scene([mesh(**other)]))
    assert renderer.take() == [("remove", "a"), ("add_mesh", "a")]


def test_what_is_replaced_goes_back_to_its_place(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([mesh(matrices=2 * MATRIX)]))
    renderer.take()
    keeper.update(records.Scene([mesh(matrices=2 * MATRIX, size=3.0)]))
    assert renderer.take() == [("remove", "a"), ("add_mesh", "a"), ("set_instances", "a")]


def test_what_is_gone_is_removed(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([mesh(), mesh("b")], [tree()]))
    renderer.take()
    assert keeper.update(records.Scene([mesh("b")]))
    assert renderer.take() == [("remove", "a"), ("remove", "t")]


def snow(depth, **sliders):
    uv = np.zeros((1, 3, 2), np.float32)
    return records.LyingSnow(
        np.full((4, 4), depth, np.float32), uv, depth, 0.2, style.SurfaceStyle(**sliders)
    )


def test_painted_snow_comes_changes_and_goes_without_the_mesh(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([mesh()]))
    renderer.take()
    keeper.update(records.Scene([mesh(snow=snow(0.1))]))
    assert renderer.take() == [("set_mesh_snow", "a")]
    keeper.update(records.Scene([mesh(snow=snow(0.1))]))
    assert renderer.take() == []
    keeper.update(records.Scene([mesh(snow=snow(0.2), matrices=2 * MATRIX)]))
    assert renderer.take() == [("set_instances", "a"), ("set_mesh_snow", "a")]
    keeper.update(records.Scene([mesh(matrices=2 * MATRIX)]))
    assert renderer.take() == [("set_mesh_snow", "a")]


def test_a_surface_of_snow_is_added_as_snow(renderer):
    keeper = sync.Sync(renderer)
    of = mesh("snow on a", size=2.0)
    of.shape.is_snow = True
    of.print = of.shape.print
    keeper.update(records.Scene([of]))
    assert renderer.take() == [("add_snow_mesh", "snow on a")]
    keeper.update(records.Scene([mesh("snow on a", size=2.0)]))
    assert renderer.take() == [("remove", "snow on a"), ("add_mesh", "snow on a")]


def test_snow_on_a_tree_comes_changes_stays_and_goes_with_the_tree(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene(trees=[tree()]))
    renderer.take()
    assert keeper.update(records.Scene(trees=[tree(snow=snow(0.1))]))
    assert renderer.take() == [("set_snow", "t")]
    assert not keeper.update(records.Scene(trees=[tree(snow=snow(0.1))]))
    assert keeper.update(records.Scene(trees=[tree(snow=snow(0.1, relief=0.0))]))
    assert renderer.take() == [("set_snow", "t")]
    keeper.update(records.Scene(trees=[tree(snow=snow(0.1))]))
    renderer.take()
    keeper.update(records.Scene(trees=[tree(pose=1.0, snow=snow(0.1))]))
    assert renderer.take() == [("set_pose", "t")]
    keeper.update(records.Scene(trees=[tree(pose=1.0, snow=snow(0.1), print_="q")]))
    assert renderer.take() == [("remove", "t"), ("add_tree", "t"), ("set_pose", "t"), ("set_snow", "t")]
    assert keeper.update(records.Scene(trees=[tree(pose=1.0, print_="q")]))
    assert renderer.take() == [("set_snow", "t")]


def test_a_tree_is_given_its_barks_images(renderer):
    paints = (records.Paint((1, 1, 1)),)
    bark_images = records.BarkImages(np.zeros((1, 4, 2), np.float32), np.zeros(1, np.int32), paints)
    of = tree()
    of.bark_images = bark_images
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([], [of]))
    assert renderer.take() == [("add_tree", "t"), ("set_bark", "t"), ("set_pose", "t")]
    keeper.update(records.Scene([], [of]))
    assert renderer.take() == []


def one_leaf():
    triangles = np.zeros((1, 3, 3), np.float32)
    number = np.zeros(1, np.int32)
    return records.Leaves(triangles, number, triangles[..., :2], number, (records.Paint((0, 1, 0)),))


def test_trees_that_look_the_same_share_a_base(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([], [tree("a"), tree("b", pose=1.0), tree("c", print_="q")]))
    assert [name for name, _ in renderer.take() if name != "set_pose"] == [
        "add_tree",
        "share_tree",
        "add_tree",
    ]
    keeper.update(records.Scene([], [tree("b", pose=1.0), tree("c", print_="q"), tree("d")]))
    assert renderer.take() == [("remove", "a"), ("share_tree", "d"), ("set_pose", "d")]
    # A tree that gets its own leaves no longer shares data.
    leafed = tree("d", leaves=one_leaf(), leaves_print="l")
    keeper.update(records.Scene([], [tree("b", pose=1.0), tree("c", print_="q"), leafed]))
    assert renderer.take() == [("remove", "d"), ("add_tree", "d"), ("set_leaves", "d"), ("set_pose", "d")]


def test_matrices_of_a_tree_are_passed_on_when_they_change(renderer):
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([], [tree()]))
    renderer.take()
    assert keeper.update(records.Scene([], [tree(matrices=2 * MATRIX)]))
    assert renderer.take() == [("set_instances", "t")]
    assert not keeper.update(records.Scene([], [tree(matrices=2 * MATRIX)]))


def test_a_tree_of_other_wood_is_replaced_with_its_leaves(renderer):
    leaves = one_leaf()
    keeper = sync.Sync(renderer)
    keeper.update(records.Scene([], [tree(leaves=leaves, leaves_print="l")]))
    assert renderer.take() == [("add_tree", "t"), ("set_leaves", "t"), ("set_pose", "t")]
    keeper.update(records.Scene([], [tree(print_="q", leaves=leaves, leaves_print="l")]))
    assert renderer.take() == [("remove", "t"), ("add_tree", "t"), ("set_leaves", "t"), ("set_pose", "t")]
    keeper.update(records.Scene([], [tree(print_="q")]))
    assert renderer.take() == [("set_leaves", "t")]


# -- light ------------------------------------------------------------------------------------------------


def lamp(kind="SUN", energy=math.pi, location=(0, 0, 2), direction=(0, 0, -1), color=(1.0, 0.5, 0.25)):
    return lights.Lamp(kind, location, direction, color, energy)


def test_a_sun_of_pi_watts_makes_white_white():
    light = lights.light_of([lamp()], (0.1, 0.2, 0.4))
    assert light.direction == (0, 0, 1)
    assert light.sun == pytest.approx((1.0, 0.5, 0.25))
    assert light.sky == (0.1, 0.2, 0.4)
    assert light.ground == pytest.approx((0.05, 0.1, 0.2))
    assert light.behind == (0.1, 0.2, 0.4)


def test_the_brightest_sun_shines_and_lamps_only_without_one():
    weak, strong = lamp(energy=1.0), lamp(energy=2.0, direction=(0, -1, 0))
    near = lamp("POINT", energy=1e6)
    assert lights.light_of([weak, near, strong], (0, 0, 0)).direction == (0, 1, 0)
    assert lights.light_of([near], (0, 0, 0)).direction == pytest.approx((0, 0, 1))


def test_further_suns_light_from_above_or_below_what_lies_level():
    slanting = lamp(energy=0.5 * math.pi, direction=(0.8, 0.0, -0.6), color=(1, 1, 1))
    below = lamp(energy=0.1 * math.pi, direction=(0, 0, 1), color=(1, 1, 1))
    light = lights.light_of([slanting, lamp(), below, lamp("POINT", energy=1e6)], (0.1, 0.2, 0.4))
    assert light.direction == (0, 0, 1) and light.sun == pytest.approx((1.0, 0.5, 0.25))
    assert light.sky == pytest.approx((0.4, 0.5, 0.7))
    assert light.ground == pytest.approx((0.15, 0.2, 0.3))
    assert light.behind == (0.1, 0.2, 0.4)


@pytest.mark.parametrize(
    ("kind", "watts"), [("POINT", 16 * math.pi**2), ("SPOT", 16 * math.pi**2), ("AREA", 4 * math.pi**2)]
)
def test_a_lamp_two_metres_off_spreads_its_watts_over_the_sphere(kind, watts):
    light = lights.light_of([lamp(kind, watts, color=(1, 1, 1))], (0, 0, 0))
    assert light.sun == pytest.approx((1, 1, 1))


def test_an_area_lamp_lights_nothing_behind_it():
    light = lights.light_of([lamp("AREA", 100.0, direction=(0, 0, 1))], (0, 0, 0))
    assert light.sun == (0.0, 0.0, 0.0)


def test_a_view_may_leave_out_lamps_or_world():
    light = lights.light_of([lamp()], (0.1, 0.2, 0.4))
    assert lights.shown(light, True, True) == light
    assert lights.shown(light, False, True).sun == lights.STUDIO_SUN.sun
    assert lights.shown(light, False, True).sky == light.sky
    assert lights.shown(light, True, False).direction == light.direction
    assert lights.shown(light, True, False).sky == lights.STUDIO_SKY


# -- pace -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("software", "divisor"), [(False, 2), (True, 4)])
def test_pictures_are_coarse_until_the_view_has_stood_still(software, divisor):
    pace = pacing.Pacing()
    pace.software = software
    pace.changed(10.0)
    assert pace.wanted(10.14) == pacing.Quality(divisor, False)
    assert pace.wanted(10.16) == pacing.FULL
    assert not pace.is_done()


def test_smooth_edges_come_after_the_whole_picture_is_shown():
    pace = pacing.Pacing()
    pace.changed(10.0)
    pace.shown(pacing.Quality(2, False))
    assert pace.wanted(11.0) == pacing.FULL
    pace.shown(pacing.FULL)
    assert pace.wanted(11.0) == pacing.FINE
    pace.shown(pacing.FINE)
    assert pace.is_done()
    pace.changed(12.0)
    assert not pace.is_done() and pace.wanted(12.0).divisor == 2


def test_a_coarse_view_covers_the_region():
    view = records.View((), (), 1001, 3).divided(4)
    assert (view.width, view.height) == (251, 1)


# -- frames -------------------------------------------------------------------------------------------------


def test_a_frames_bytes_become_light():
    words = np.array([[0x3F000000, 0x3F000000 + (254 << 16) + (128 << 8) + 1]], np.uint32)
    light = frame_code.light(words.view(np.float32))
    assert light.shape == (1, 2, 3)
    assert light[0, 0].tolist() == [0, 0, 0]
    share = np.array([254, 128, 1]) / 255
    assert light[0, 1] == pytest.approx(share**2.2 / (1 - share**2.2), rel=1e-4)
