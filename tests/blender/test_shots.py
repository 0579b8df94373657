# SPDX-License-Identifier: GPL-3.0-or-later
"""Small production shots: each is a script of a few lines whose right answer is computed by hand.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import bake_surfaces, inner

QUARTER = 0.025


@pytest.fixture
def ground_of(tmp_path, native):
    """Mean heights of a receiver's open parts in the frames 1 to `last`, from its maps."""

    def heights(name="Ground", last=4, version=1):
        maps = [s.height(native, tmp_path / "cache", name, frame, version) for frame in range(1, last + 1)]
        return [s.open_ground(map_) for map_ in maps]

    return heights


def quarters(*counts):
    """That many quarters of the snow, each within 1 %."""
    return pytest.approx([QUARTER * count for count in counts], rel=0.01, abs=1e-6)


@pytest.fixture
def points_in(tmp_path, addon):
    """points_in(receiver, frame): the points of its surface in the files, in its own space."""
    read = addon("surface.point_cache").read_point_cache
    return lambda name, frame: np.array(
        read(s.folder_of(tmp_path / "cache", name) / "surface.pc2")[frame], float
    )


def spread(points):
    """Largest extent of points along an axis."""
    return float(np.ptp(points, axis=0).max())


def level(points):
    """Mean height of level snow away from rims."""
    return float(inner(points)[:, 2].mean())


# -- receivers that are not shown on all frames -----------------------------------------------------------------


def hide_by_key(obj, frames):
    for frame in range(1, 5):
        obj.hide_render = frame in frames
        obj.keyframe_insert("hide_render", frame=frame)


def hide_by_collection(obj, frames):
    """A frame handler hides the object's collection in renders."""
    collection = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.app.handlers.frame_change_pre.append(
        lambda scene, *_: setattr(bpy.data.collections["Hidden"], "hide_render", scene.frame_current in frames)
    )


def hide_by_exclusion(obj, frames):
    """A frame handler excludes the object's collection from the view layer."""
    hide_by_collection(obj, ())
    bpy.app.handlers.frame_change_pre[-1] = lambda scene, *_: setattr(
        scene.view_layers[0].layer_collection.children["Hidden"], "exclude", scene.frame_current in frames
    )


def hide_by_scale(obj, frames):
    s.key(obj, "scale", *((frame, (0.0 if frame in frames else 1.0,) * 3) for frame in range(1, 5)))


def hide_by_flattening(obj, frames):
    s.key(obj, "scale", *((frame, (1.0, 0.0 if frame in frames else 1.0, 1.0)) for frame in range(1, 5)))


def hide_by_shape(obj, frames):
    """A shape key moves all vertices to one place."""
    obj.shape_key_add(name="Basis")
    point = obj.shape_key_add(name="Point")
    for vertex in point.data:
        vertex.co = (0, 0, 0)
    s.key(point, "value", *((frame, 1.0 if frame in frames else 0.0) for frame in range(1, 5)))


HIDING = [
    hide_by_key, hide_by_collection, hide_by_exclusion, hide_by_scale, hide_by_flattening, hide_by_shape
]  # fmt: skip


@pytest.fixture
def handlers():
    """Removes the frame handlers of a test."""
    before = list(bpy.app.handlers.frame_change_pre)
    yield
    bpy.app.handlers.frame_change_pre[:] = before


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("hide", HIDING)
def test_a_hidden_receiver_keeps_its_snow_and_shelters_nothing(tmp_path, ground_of, points_in, hide):
    """The roof is hidden in frame 3: only then does the ground get snow."""
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    hide(roof, {3})
    bake_surfaces(tmp_path / "cache", roof, ground)
    assert ground_of("Roof") == quarters(1, 2, 2, 3)
    assert ground_of("Ground") == quarters(0, 0, 1, 1)
    for frame, count in ((2, 2), (4, 3)):
        assert level(points_in("Roof", frame)) == pytest.approx(1.0 + QUARTER * count, abs=0.002)
    assert spread(points_in("Roof", 3)) == 0.0


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("hide", HIDING)
def test_a_receiver_may_pop_in_after_the_first_frame(tmp_path, ground_of, points_in, hide):
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    hide(roof, {1, 2})
    bake_surfaces(tmp_path / "cache", roof, ground)
    assert ground_of("Roof") == quarters(0, 0, 1, 2)
    assert ground_of("Ground") == quarters(1, 2, 2, 2)
    assert spread(points_in("Roof", 2)) == 0.0
    assert level(points_in("Roof", 4)) == pytest.approx(1.0 + 2 * QUARTER, abs=0.002)


def test_a_bake_that_stops_while_a_receiver_is_hidden_resumes_to_the_same_files(tmp_path, addon):
    def shot(folder):
        roof, ground = s.square("Roof", z=1.0), s.square("Ground")
        hide_by_key(roof, {2, 3})
        s.receive(roof, ground)
        s.settings(folder, checkpoint_interval=1)

    shot(tmp_path / "whole")
    assert s.bake_part(addon).error is None
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    assert s.bake_part(addon, last=3).error is None
    assert s.bake_part(addon, resume=True).error is None
    assert s.files_of(tmp_path / "parts") == s.files_of(tmp_path / "whole")


@pytest.mark.usefixtures("handlers")
def test_a_receiver_that_a_handler_deletes_keeps_its_maps(tmp_path, ground_of):
    s.receive(s.square("Roof", z=1.0), s.square("Ground"))
    s.settings(tmp_path / "cache")

    def delete(scene, *_):
        if scene.frame_current == 3 and "Roof" in bpy.data.objects:
            bpy.data.objects.remove(bpy.data.objects["Roof"])

    bpy.app.handlers.frame_change_pre.append(delete)
    s.bake()
    assert ground_of("Roof") == quarters(1, 2, 2, 2)
    assert ground_of("Ground") == quarters(0, 0, 1, 2)


def test_a_receiver_that_is_hidden_throughout_is_left_out(tmp_path, addon):
    roof = s.square("Roof", z=1.0)
    hide_by_key(roof, {1, 2, 3, 4})
    s.receive(roof, s.square("Ground"))
    s.settings(tmp_path / "cache")
    refused = s.bake_part(addon, strict=True)
    assert "'Roof' is on the list of receivers, but not rendered on any frame of the shot" in str(refused.error)


def test_the_check_names_the_frames_on_which_a_receiver_is_hidden(addon, tmp_path):
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    hide_by_key(roof, {2, 3})
    hide_by_scale(ground, {4})
    s.receive(roof, ground)
    s.settings(tmp_path)
    found = issues(addon, "INFO")
    assert "'Roof' is hidden, or its scale is 0, in frames 2-3" in found
    assert "'Ground' is hidden, or its scale is 0, in frames 4" in found


# -- view layers ------------------------------------------------------------------------------------------------


def issues(addon, severity):
    found = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    return "\n".join(issue.text for issue in found if issue.severity == severity)


def layer_with_roof(folder, **flags):
    """A ground in the view layers Main and FX, and a roof in a collection that only FX shows, with these flags."""
    scene = bpy.context.scene
    scene.view_layers[0].name = "Main"
    effects = bpy.data.collections.new("Effects")
    scene.collection.children.link(effects)
    roof = s.square("Roof", z=1.0)
    effects.objects.link(roof)
    scene.collection.objects.unlink(roof)
    s.receive(s.square("Ground"))
    s.settings(folder)
    layer = scene.view_layers.new("FX")
    scene.view_layers["Main"].layer_collection.children["Effects"].exclude = True
    for name, value in flags.items():
        setattr(layer.layer_collection.children["Effects"], name, value)
    return scene.view_layers["Main"], layer


@pytest.mark.parametrize("flags", [{}, {"holdout": True}, {"indirect_only": True}])
def test_objects_of_all_rendered_layers_stop_snow(tmp_path, ground_of, addon, flags):
    """Whichever layer is active: the scene's first one is in the background."""
    main, effects = layer_with_roof(tmp_path / "cache", **flags)
    layers = [layer.name for layer in bpy.context.scene.view_layers]
    s.bake()
    assert ground_of() == quarters(0, 0, 0, 0)
    assert [layer.name for layer in bpy.context.scene.view_layers] == layers and main.use and effects.use
    assert "Only in 1 view layer of 2 (FX): 'Roof'" in issues(addon, "INFO")


def test_layers_that_do_not_render_do_not_count(tmp_path, ground_of, addon):
    main, effects = layer_with_roof(tmp_path / "cache")
    effects.use = False
    s.bake()
    assert ground_of() == quarters(1, 2, 3, 4)
    main.use, effects.use = False, True
    s.bake()
    assert ground_of(version=2) == quarters(0, 0, 0, 0)
    assert (main.use, effects.use) == (False, True)
    assert "view layer of" not in issues(addon, "INFO")


def test_a_receiver_in_no_rendered_layer_is_named(tmp_path, addon):
    main, effects = layer_with_roof(tmp_path / "cache")
    effects.use = False
    s.receive(bpy.data.objects["Roof"])
    assert "'Roof' is in no collection that a view layer renders" in issues(addon, "WARNING")
