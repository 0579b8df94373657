# SPDX-License-Identifier: GPL-3.0-or-later
"""Receivers and roofs that are not shown on all frames, or not in all view layers.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import bpy
import pytest
import snow_scene as s
from conftest import addon_module
from small_shots import QUARTER, hide_by_key, hide_by_scale, quarters, sizes, spread
from surface_scene import bake_surfaces, level, points_at


def hide_by_collection(obj, frames):
    """A frame handler hides the object's collection in renders."""
    collection = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.app.handlers.frame_change_pre.append(
        lambda scene, *_: setattr(
            bpy.data.collections["Hidden"], "hide_render", scene.frame_current in frames
        )
    )


def hide_by_exclusion(obj, frames):
    """A frame handler excludes the object's collection from the view layer."""
    hide_by_collection(obj, ())
    bpy.app.handlers.frame_change_pre[-1] = lambda scene, *_: setattr(
        scene.view_layers[0].layer_collection.children["Hidden"], "exclude", scene.frame_current in frames
    )


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


@pytest.mark.parametrize("old", [100, 200])
@pytest.mark.parametrize("hide", [hide_by_key, hide_by_scale])
def test_snow_of_a_hidden_receiver_does_not_shrink_between_frames(tmp_path, hide, old):
    """As motion blur sees it: whole around the frames on which it shows. Also if the shot is stretched later."""
    roof = s.square("Roof", z=1.0)
    hide(roof, {3})
    for curve in addon_module("base.compat").curves_of(roof):
        for key in curve.keyframe_points:
            key.interpolation = "CONSTANT"
    (surface,) = bake_surfaces(tmp_path / "cache", roof)
    bpy.context.scene.render.frame_map_old = old
    for curve in addon_module("base.compat").curves_of(
        roof
    ):  # the receiver follows its keys, which are moved
        for key in curve.keyframe_points:
            key.co.x *= old / 100
    around = [(1, 0.75), (2, 0.25), (2, 0.4), (3, 0.6), (3, 0.75), (4, 0.25)]
    surface.parent = None
    assert sizes(surface, *around) == pytest.approx([2.03] * 6, abs=0.03)
    assert sizes(surface, (2, 0.75), (3, 0.0), (3, 0.25)) == [0.0] * 3
    assert len(set(sizes(surface, (1, 0.0), (1, 0.25), (1, 0.5)))) == 3  # it grows steadily elsewhere


@pytest.mark.parametrize("method", ["KEYS", "CACHE"])
def test_applied_snow_of_a_hidden_receiver_does_not_shrink_between_frames(tmp_path, method):
    """Also in a stretched shot that begins at frame 11."""
    roof = s.square("Roof", z=1.0)
    hide_by_key(roof, ())
    scene = bpy.context.scene
    scene.render.frame_map_new = 200
    for frame, is_hidden in ((5.5, False), (6.5, True), (7.0, False)):
        roof.hide_render = is_hidden
        roof.keyframe_insert("hide_render", frame=frame)
    (surface,) = bake_surfaces(tmp_path / "cache", roof, frames=(11, 14))
    assert sizes(surface, (12, 0.0), (13, 0.0), (14, 0.0))[1] == 0.0
    bpy.ops.snowbough.apply_snow(frames=method, directory=str(tmp_path / "applied"))
    applied = bpy.data.objects["Roof Snow Applied"]
    for time in ((11, 0.0), (11, 0.5), (12, 0.0), (12, 0.25), (12, 0.75), (13, 0.0), (13, 0.75), (14, 0.0)):
        assert points_at(applied, *time) == pytest.approx(points_at(surface, *time), abs=1e-5), time


def test_a_receiver_may_grow_from_scale_0(tmp_path, native):
    """Its map and texels are those of its full size: 2 m in 256 texels."""
    cart = s.square("Cart")
    s.key(cart, "scale", (1, (0.0,) * 3), (2, (0.01,) * 3), (3, (0.5,) * 3), (4, (1.0,) * 3), (6, (1.0,) * 3))
    s.receive(cart, resolution=0)
    s.settings(tmp_path, frames=(1, 6), pixel_size=0.0, texel_size=2.0 / 256.0)
    s.bake()
    assert s.height(native, tmp_path, "Cart", 6).shape == (256, 256)
    manifest = s.manifest_of(tmp_path, "Cart")
    assert manifest["settings"]["snowfall"]["pixel_size"] == pytest.approx(2.0 / 256.0)
    assert [entry.get("hidden", False) for entry in manifest["frames"]] == [True] + [False] * 5


def test_a_member_of_a_collection_may_pop_in(tmp_path, ground_of):
    """The roof appears in frame 3 above the ground of the collection."""
    roof = s.square("Roof", z=1.0)
    hide_by_key(roof, {1, 2})
    s.receive(s.instanced(roof, s.square("Ground")))
    s.settings(tmp_path / "cache")
    s.bake()
    assert ground_of("Empty.Roof") == quarters(0, 0, 1, 2)
    assert ground_of("Empty.Ground") == quarters(1, 2, 2, 2)


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
    assert "'Roof' is on the list of receivers, but not rendered on any frame of the shot" in str(
        refused.error
    )


def test_the_check_names_the_frames_on_which_a_receiver_is_hidden(addon, tmp_path):
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    hide_by_key(roof, {2, 3})
    hide_by_scale(ground, {4})
    s.receive(roof, ground)
    s.settings(tmp_path)
    found = s.issues(addon, "INFO")
    assert "'Roof' is hidden, or its scale is 0, in frames 2-3" in found
    assert "'Ground' is hidden, or its scale is 0, in frames 4" in found


def test_the_check_names_the_parent_driver_or_collection_that_hides_a_receiver(addon, tmp_path):
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    roof.parent = parent
    hide_by_scale(parent, {3, 4})
    ground.driver_add("hide_render").driver.expression = "frame == 3"
    member = s.square("Member")
    hide_by_key(member, {2})
    empty = s.instanced(member)
    s.receive(roof, ground, empty)
    s.settings(tmp_path)
    found = s.issues(addon, "INFO")
    assert "'Roof' is hidden, or its scale is 0, in frames 3-4" in found
    assert "A driver hides 'Ground' in renders on some frames" in found
    assert "'Member' in 'Empty' is hidden, or its scale is 0, in frames 2" in found


# -- view layers ------------------------------------------------------------------------------------------------


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
    assert "Only in 1 view layer of 2 (FX): 'Roof'" in s.issues(addon, "INFO")


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("own_name", ["Main", "FX"])
def test_a_layer_whose_collection_a_handler_excludes_lets_snow_fall_through(tmp_path, ground_of, own_name):
    """Only this layer shows the roof, and not in frame 3."""
    main, _ = layer_with_roof(tmp_path / "cache")
    if own_name == "Main":
        main.layer_collection.children["Effects"].exclude = False
        bpy.context.scene.view_layers["FX"].layer_collection.children["Effects"].exclude = True
    bpy.app.handlers.frame_change_pre.append(
        lambda scene, *_: setattr(
            scene.view_layers[own_name].layer_collection.children["Effects"],
            "exclude",
            scene.frame_current == 3,
        )
    )
    s.bake()
    assert ground_of() == quarters(0, 0, 1, 1)
    assert [layer.name for layer in bpy.context.scene.view_layers] == ["Main", "FX"]


def test_layers_that_do_not_render_do_not_count(tmp_path, ground_of, addon):
    main, effects = layer_with_roof(tmp_path / "cache")
    effects.use = False
    s.bake()
    assert ground_of() == quarters(1, 2, 3, 4)
    main.use, effects.use = False, True
    s.bake()
    assert ground_of(version=2) == quarters(0, 0, 0, 0)
    assert (main.use, effects.use) == (False, True)
    assert "view layer of" not in s.issues(addon, "INFO")


def test_a_receiver_in_no_rendered_layer_is_named(tmp_path, addon):
    main, effects = layer_with_roof(tmp_path / "cache")
    effects.use = False
    s.receive(bpy.data.objects["Roof"])
    assert "'Roof' is in no collection that a view layer renders" in s.issues(addon, "WARNING")
