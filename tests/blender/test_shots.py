# SPDX-License-Identifier: GPL-3.0-or-later
"""Small production shots: each is a script of a few lines whose right answer is computed by hand.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import os
import subprocess

import bpy
import numpy as np
import pytest
import snow_scene as s
from conftest import addon_module
from surface_scene import bake_surfaces, box, level, points_at

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


def sizes(surface, *times):
    """Extents of a surface at (frame, subframe)."""
    return [spread(points_at(surface, frame, subframe)) for frame, subframe in times]


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
    collection = bpy.data.collections.new("Set")
    for name, z in (("Roof", 1.0), ("Ground", 0.0)):
        obj = s.square(name, z=z)
        collection.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    hide_by_key(bpy.data.objects["Roof"], {1, 2})
    empty = bpy.data.objects.new("Empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    s.receive(empty)
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


def test_the_check_names_what_hides_a_receiver_through_its_parent_its_driver_or_its_collection(
    addon, tmp_path
):
    roof, ground = s.square("Roof", z=1.0), s.square("Ground")
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    roof.parent = parent
    hide_by_scale(parent, {3, 4})
    ground.driver_add("hide_render").driver.expression = "frame == 3"
    member = s.square("Member")
    hide_by_key(member, {2})
    empty = mirrored_by_instancer(member)
    s.receive(roof, ground, empty)
    s.settings(tmp_path)
    found = s.issues(addon, "INFO")
    assert "'Roof' is hidden, or its scale is 0, in frames 3-4" in found
    assert "A driver hides 'Ground' in renders on some frames" in found
    assert "'Member' in 'Empty' is hidden, or its scale is 0, in frames 2" in found


# -- mirrored receivers -----------------------------------------------------------------------------------------


def mirrored_itself(obj):
    obj.scale = (1.0, 1.0, -1.0)
    return obj


def mirrored_by_parent(obj):
    """The parent shears it, too."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, obj.rotation_euler = (-1.0, 1.0, 1.5), (0.0, 0.0, 0.4)
    obj.parent = parent
    return obj


def mirrored_by_instancer(obj):
    collection = bpy.data.collections.new("Set")
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    empty = bpy.data.objects.new("Empty", None)
    empty.instance_type, empty.instance_collection, empty.scale = "COLLECTION", collection, (1.0, -1.0, 1.0)
    bpy.context.scene.collection.objects.link(empty)
    return empty


def upward_share(surface):
    """Share of the faces on level snow whose outside faces up, as renderers see it: a mirroring matrix turns the order
    of corners around."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = evaluated.matrix_world
    sign = -1.0 if matrix.determinant() < 0 else 1.0
    places = [matrix @ vertex.co for vertex in evaluated.data.vertices]
    up = []
    for polygon in evaluated.data.polygons:
        a, b, c = (places[index] for index in list(polygon.vertices)[:3])
        if max(abs(a.x), abs(a.y)) < 0.5:
            up.append(sign * (b - a).cross(c - a).z > 0)
    return np.mean(up)


@pytest.mark.parametrize("mirror", [mirrored_itself, mirrored_by_parent, mirrored_by_instancer])
def test_the_faces_of_a_mirrored_receivers_surface_look_outwards(tmp_path, mirror):
    obj = mirror(box("Thing", 2.0, z=-1.0))
    receiver = obj if obj.type == "MESH" else obj.instance_collection.objects[0]
    s.receive(obj)
    s.settings(tmp_path / "cache")
    bpy.context.view_layer.update()
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    surface = bpy.data.objects[f"{receiver.name} Snow"]
    bpy.context.scene.frame_set(4)
    assert upward_share(surface) == 1.0
    bpy.ops.snowbough.apply_snow()
    assert upward_share(bpy.data.objects[f"{surface.name} 0004"]) == 1.0


# -- what frame handlers change -------------------------------------------------------------------------------


def hole(name="Hole"):
    """A material whose alpha comes from an image that is transparent everywhere."""
    image = bpy.data.images.new(name, 4, 4, alpha=True)
    image.pixels[:] = [0.0] * 64
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    links.new(texture.outputs["Alpha"], nodes["Principled BSDF"].inputs["Alpha"])
    return material


def switch_mask(roof):
    roof.vertex_groups.new(name="None")
    modifier = roof.modifiers.new("Switched", "MASK")
    modifier.vertex_group, modifier.show_render = "None", False
    return lambda is_open: setattr(bpy.data.objects["Roof"].modifiers["Switched"], "show_render", is_open)


def switch_displacement(roof):
    """The modifier moves the roof away; it keeps its faces."""
    modifier = roof.modifiers.new("Switched", "DISPLACE")
    modifier.direction, modifier.strength, modifier.mid_level, modifier.show_render = "X", 5.0, 0.0, False
    return lambda is_open: setattr(bpy.data.objects["Roof"].modifiers["Switched"], "show_render", is_open)


def switch_slot(roof):
    roof.data.materials.append(bpy.data.materials.new("Whole"))
    hole()
    return lambda is_open: setattr(
        bpy.data.objects["Roof"].material_slots[0],
        "material",
        bpy.data.materials["Hole" if is_open else "Whole"],
    )


def switch_slot_of_an_object(roof):
    """The same on a roof with modifiers, which is read on every frame."""
    roof.modifiers.new("Thick", "SUBSURF").subdivision_type = "SIMPLE"
    return switch_slot(roof)


def switch_image(roof):
    roof.data.materials.append(hole())
    bpy.data.images.new("Whole", 4, 4, alpha=True).pixels[:] = [1.0] * 64
    return lambda is_open: setattr(
        bpy.data.materials["Hole"].node_tree.nodes["Image Texture"],
        "image",
        bpy.data.images["Hole" if is_open else "Whole"],
    )


def switch_faces_material(roof):
    roof.data.materials.append(bpy.data.materials.new("Whole"))
    roof.data.materials.append(hole())

    def switch(is_open):
        bpy.data.meshes["Roof"].polygons[0].material_index = int(is_open)
        bpy.data.meshes["Roof"].update()

    return switch


SWITCHES = [
    switch_mask, switch_displacement, switch_slot, switch_slot_of_an_object, switch_image, switch_faces_material
]  # fmt: skip


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("switch", SWITCHES)
def test_a_roof_that_a_handler_opens_lets_snow_fall_through(tmp_path, ground_of, switch):
    """It is open in frames 2 and 3."""
    set_open = switch(s.square("Roof", z=1.0))
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    bpy.app.handlers.frame_change_pre.append(lambda scene, *_: set_open(scene.frame_current in (2, 3)))
    s.bake()
    assert ground_of() == quarters(0, 1, 2, 2)


@pytest.mark.usefixtures("handlers")
def test_a_roof_with_animated_mesh_data_whose_vertices_a_handler_reorders_stays_closed(tmp_path, ground_of):
    """With the old faces and the new order, the two halves of the roof would be two crossed ribbons."""
    points = [
        (x, y, 1.0) for left in (-1, 0) for x, y in ((left, -1), (left + 1, -1), (left + 1, 1), (left, 1))
    ]
    roof = s.mesh_object("Roof", points, [(0, 1, 2, 3), (4, 5, 6, 7)])
    roof.data["number"] = 0.0
    roof.data.keyframe_insert('["number"]', frame=1)
    order = [0, 2, 4, 6, 1, 3, 5, 7]

    def reorder(scene, *_):
        mesh = bpy.data.meshes["Roof"]
        if scene.frame_current == 3:
            mesh.vertices.foreach_set("co", np.array([points[index] for index in order], np.float32).ravel())
            mesh.loops.foreach_set("vertex_index", [order.index(corner) for corner in range(8)])
            mesh.update(calc_edges=True)

    bpy.app.handlers.frame_change_pre.append(reorder)
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    s.bake()
    assert ground_of() == quarters(0, 0, 0, 0)


# -- time -------------------------------------------------------------------------------------------------------


def straighten(animated):
    """Makes all keys linear."""
    for curve in addon_module("base.compat").curves_of(animated):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def rising(folder, mode="SHELL", frames=(1, 8), **settings):
    """A square that its keys move by 1 m along X a frame, and its baked surface."""
    cart = s.square("Cart", 1.0)
    s.key(cart, "location", (0, (0.0, 0.0, 0.0)), (100, (100.0, 0.0, 0.0)))
    straighten(cart)
    (surface,) = bake_surfaces(folder, cart, frames=frames, **settings)
    return cart, surface


@pytest.mark.parametrize(("old", "new"), [(100, 200), (100, 50), (100, 120)])
def test_a_stretched_shot_shows_the_snow_of_its_rendered_frames(tmp_path, ground_of, old, new):
    """At 100 to 200, rendered frame 6 has the keys of frame 3, and 6 of 8 frames of snow."""
    scene = bpy.context.scene
    scene.render.frame_map_old, scene.render.frame_map_new = old, new
    _, surface = rising(tmp_path / "cache")
    maps = ground_of("Cart", last=8)
    for frame in (1, 6, 8):
        points = points_at(surface, frame)
        assert (
            level(points)
            == pytest.approx(maps[frame - 1], rel=0.02)
            == pytest.approx(0.0125 * frame, rel=0.02)
        )
        assert points[:, 0].mean() == pytest.approx(frame * old / new, abs=0.02)


def test_a_shot_that_is_stretched_after_its_bake_says_so_and_shows_its_frames(tmp_path, ground_of, addon):
    _, surface = rising(tmp_path / "cache")
    scene = bpy.context.scene
    scene.render.frame_map_new = 200
    for frame in (3, 6):
        assert level(points_at(surface, frame)) == pytest.approx(0.0125 * frame, rel=0.02)
    changes = addon("bake.changes_since_bake").settings_changes
    assert changes(scene) == ["time stretching: 0.5, was 1"]
    scene.render.frame_map_new, scene.render.fps = 100, 30
    assert changes(scene) == ["fps: 30, was 24"]
    assert level(points_at(surface, 6)) == pytest.approx(0.0125 * 6, rel=0.02)


def test_the_rate_of_a_stretched_shot_comes_from_its_keys(tmp_path, ground_of):
    """At 100 to 200, rendered frames 1 to 4 have the keys of 0.5 to 2: the snow of frame 1 is 0."""
    scene = bpy.context.scene
    scene.render.frame_map_new = 200
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    s.key(scene.snowbough, "rate", (1, 0.0), (2, 1.0))
    straighten(scene)
    s.bake()
    assert ground_of() == pytest.approx([0.0, 0.0, 0.1 / 3, 0.1], rel=0.01, abs=1e-6)


@pytest.mark.parametrize("mode", ["MODIFIER", "NONE"])
def test_a_stretched_shot_is_refused_where_blender_shows_other_images(tmp_path, addon, mode):
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    scene = bpy.context.scene
    bpy.ops.snowbough.setup_displacement(mode=mode)
    scene.render.frame_map_new = 200
    with pytest.raises(
        RuntimeError, match="Time Stretching .* choose Displacement > Snow Surface for 'Ground'"
    ):
        s.bake()
    assert "Time Stretching" in s.issues(addon, "ERROR")


@pytest.mark.parametrize(("old", "new"), [(100, 100), (100, 200), (100, 50)])
def test_snow_follows_a_receiver_with_a_mesh_cache_in_a_stretched_shot(tmp_path, addon, old, new):
    """The receiver's own Mesh Cache raises it by 0.1 m a frame of its keys."""
    cart = s.square("Cart")
    points = np.array([vertex.co for vertex in cart.data.vertices], np.float32)
    with addon("surface.point_cache").PointCacheWriter(tmp_path / "own.pc2", 4) as cache:
        for sample in range(20):
            cache.add(points + np.float32([0.0, 0.0, 0.1 * sample]))
        cache.publish()
    own = cart.modifiers.new("Own", "MESH_CACHE")
    own.cache_format, own.filepath, own.frame_start = "PC2", str(tmp_path / "own.pc2"), 0
    scene = bpy.context.scene
    scene.render.frame_map_old, scene.render.frame_map_new = old, new
    (surface,) = bake_surfaces(tmp_path / "cache", cart, frames=(1, 8))
    for frame in (1, 3, 8):
        expected = 0.1 * frame * old / new + 0.0125 * frame
        assert level(points_at(surface, frame)) == pytest.approx(expected, abs=0.002)


def test_a_frame_step_bakes_every_frame(tmp_path, ground_of):
    bpy.context.scene.frame_step = 2
    _, surface = rising(tmp_path / "cache")
    assert ground_of("Cart", last=8) == pytest.approx([0.0125 * frame for frame in range(1, 9)], rel=0.01)
    assert level(points_at(surface, 4, 0.5)) == pytest.approx(0.0125 * 4.5, rel=0.02)


def test_a_strip_of_the_sequencer_shows_the_frame_of_its_scene(tmp_path):
    """Frame 16 of the edit shows frame 6 of the shot."""
    cart, surface = rising(tmp_path / "cache")
    shot = bpy.context.scene
    edit = bpy.data.scenes.new("Edit")
    add_strip(edit, shot, 11)
    cycles(shot, edit)
    camera_above(cart)
    shine_by_height(surface)
    shot.view_settings.view_transform = edit.view_settings.view_transform = "Raw"
    edit.sequencer_colorspace_settings.name = linear_name(edit)
    assert rendered(shot, 6, tmp_path) == pytest.approx(0.75, rel=0.03)
    assert rendered(edit, 16, tmp_path) == pytest.approx(0.75, rel=0.03)


def linear_name(scene):
    """The linear colour space of the sequencer: its name differs between versions."""
    names = scene.sequencer_colorspace_settings.bl_rna.properties["name"].enum_items.keys()
    return next(name for name in ("Linear Rec.709", "Linear") if name in names)


def add_strip(edit, shot, frame):
    """A strip with a scene in the sequencer of another one."""
    editor = edit.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strips.new_scene("Shot", shot, channel=1, frame_start=frame)


def cycles(*scenes):
    """Sets scenes up for tiny pictures."""
    for scene in scenes:
        scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
        scene.render.resolution_x = scene.render.resolution_y = 8
        scene.render.image_settings.file_format = "OPEN_EXR"


def camera_above(parent):
    """The scene's camera, 5 m above an object, with a picture 0.5 m wide."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.5
    camera.parent, camera.location.z = parent, 5.0
    bpy.context.scene.camera = camera


def shine_by_height(obj):
    """Gives an object a material that emits ten times its height."""
    material = bpy.data.materials.new("Height")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    split, tenfold = nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeMath")
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Position"], split.inputs[0])
    tenfold.operation, tenfold.inputs[1].default_value = "MULTIPLY", 10.0
    links.new(split.outputs["Z"], tenfold.inputs[0])
    glow = nodes.new("ShaderNodeEmission")
    links.new(tenfold.outputs[0], glow.inputs["Strength"])
    links.new(glow.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    obj.data.materials[0] = material


def rendered(scene, frame, folder):
    """Mean of the red pixels of a picture."""
    bpy.context.window.scene = scene  # Blender renders scene strips of the window's scene only
    scene.frame_set(frame)
    scene.render.filepath = str(folder / f"{scene.name}_{frame}.exr")
    bpy.ops.render.render(write_still=True)
    return float(np.mean(bpy.data.images.load(scene.render.filepath).pixels[:][::4]))


def test_a_render_reads_the_surfaces_of_its_strips(tmp_path, addon):
    bake_surfaces(tmp_path / "cache", s.square("Ground"))
    shot, edit = bpy.context.scene, bpy.data.scenes.new("Edit")
    add_strip(edit, shot, 1)
    scenes = addon("result.surface_files")._rendered_scenes
    assert scenes(edit) == [edit, shot] and scenes(shot) == [shot]


def test_a_render_in_the_background_without_a_surfaces_file_ends_with_an_error(tmp_path):
    if not bpy.app.binary_path:
        pytest.skip("this Blender is a Python module, which nothing may end")
    ground = s.square("Ground")
    bake_surfaces(tmp_path / "cache", ground)
    cycles(bpy.context.scene)
    camera_above(ground)
    blend = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))

    def render():
        command = [bpy.app.binary_path, "-b", "--addons", os.environ["SNOWBOUGH_TEST_ADDON"], str(blend)]
        command += ["-o", str(tmp_path / "picture_"), "-f", "1"]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    assert render().returncode == 0
    (s.folder_of(tmp_path / "cache", "Ground") / "surface.pc2").unlink()
    failed = render()
    assert failed.returncode == 1 and "'Ground Snow' shows no snow" in failed.stderr


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


# -- ways to move and to deform ---------------------------------------------------------------------------------

# Each moves a level square of 2 m and returns {frame: its height}.


def sheared(cart):
    """A parent that is scaled unevenly and turned shears a square that stays level."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, cart.rotation_euler = (2.0, 0.5, 1.0), (0.0, 0.0, 0.6)
    cart.parent = parent
    s.key(parent, "location", (1, (0.0, 0.0, 0.0)), (4, (0.0, 0.0, 0.9)))
    return {1: 0.0, 4: 0.9}


def by_shape_key(cart):
    cart.shape_key_add(name="Basis")
    up = cart.shape_key_add(name="Up")
    for vertex in up.data:
        vertex.co.z += 0.5
    s.key(up, "value", (1, 0.0), (4, 1.0))
    return {1: 0.0, 4: 0.5}


def by_a_driven_bone(cart):
    """A driver lifts the only bone by a tenth of the frame."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)  # its Y points up
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["Bone"].driver_add("location", 1).driver.expression = "frame / 10"
    cart.vertex_groups.new(name="Bone").add(range(4), 1.0, "REPLACE")
    cart.modifiers.new("Armature", "ARMATURE").object = rig
    return {1: 0.1, 4: 0.4}


def by_a_path(cart):
    """The path rises by 3 m in 3 frames."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions, curve.use_path, curve.path_duration = "3D", True, 100
    line = curve.splines.new("POLY")
    line.points.add(1)
    line.points[0].co, line.points[1].co = (0.0, 0.0, 0.0, 1.0), (3.0, 0.0, 3.0, 1.0)
    path = bpy.data.objects.new("Path", curve)
    bpy.context.scene.collection.objects.link(path)
    follow = cart.constraints.new("FOLLOW_PATH")
    follow.target, follow.use_fixed_location = path, True
    s.key(follow, "offset_factor", (1, 0.0), (4, 1.0))
    return {1: 0.0, 4: 3.0}


def by_geometry_nodes(cart):
    """Set Position lifts it by 0.3 m; the faces stay."""
    tree, begin, end = s.node_tree()
    lift = tree.nodes.new("GeometryNodeSetPosition")
    lift.inputs["Offset"].default_value = (0.0, 0.0, 0.3)
    tree.links.new(begin.outputs[0], lift.inputs["Geometry"])
    tree.links.new(lift.outputs[0], end.inputs[0])
    cart.modifiers.new("Nodes", "NODES").node_group = tree
    return {1: 0.3, 4: 0.3}


def by_animated_scale(cart):
    """From 1 to 3 in the plane; the depth of snow stays in metres."""
    s.key(cart, "scale", (1, (1.0, 1.0, 1.0)), (4, (3.0, 2.0, 1.0)))
    return {1: 0.0, 4: 0.0}


WAYS = [sheared, by_shape_key, by_a_driven_bone, by_a_path, by_geometry_nodes, by_animated_scale]


@pytest.mark.parametrize("way", WAYS)
def test_snow_follows_its_receiver(tmp_path, way):
    cart = s.square("Cart")
    heights = way(cart)
    (surface,) = bake_surfaces(tmp_path, cart)
    for (
        frame,
        height,
    ) in heights.items():  # within a third of a frame's snow: it is lower near the sheared corners
        assert level(points_at(surface, frame)) == pytest.approx(height + QUARTER * frame, abs=QUARTER / 3)


def test_snow_follows_a_collection_that_an_empty_instances(tmp_path):
    cart = s.square("Cart")
    empty = mirrored_by_instancer(cart)
    empty.scale = (1.0, 1.0, 1.0)
    s.key(empty, "location", (1, (0.0, 0.0, 0.0)), (4, (0.0, 6.0, 1.2)))
    s.receive(empty)
    s.settings(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    points = points_at(bpy.data.objects["Cart Snow"], 4)
    assert level(points) == pytest.approx(1.3, abs=0.004) and points[:, 1].mean() == pytest.approx(
        6.0, abs=0.05
    )


def test_snow_follows_a_linked_and_overridden_object(tmp_path):
    s.write_library(tmp_path / "props.blend", "Rock")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    override = s.link(tmp_path / "props.blend", "Rock").override_create(remap_local_usages=True)
    override.location.z = 2.0
    (surface,) = bake_surfaces(tmp_path / "cache", override)
    assert level(points_at(surface, 4)) == pytest.approx(2.1, abs=0.004)


def test_a_shot_may_begin_at_frame_1001(tmp_path):
    cart = s.square("Cart")
    s.key(cart, "location", (1001, (0.0, 0.0, 0.0)), (1004, (0.0, 0.0, 3.0)))
    (surface,) = bake_surfaces(tmp_path, cart, frames=(1001, 1004))
    for frame, height in ((1001, 0.0), (1004, 3.0)):
        assert level(points_at(surface, frame)) == pytest.approx(height + QUARTER * (frame - 1000), abs=0.004)


@pytest.mark.parametrize("unit", [0.01, 10.0])
def test_depth_is_in_metres_whatever_a_unit_is(tmp_path, unit):
    """A square of 2 m."""
    bpy.context.scene.unit_settings.scale_length = unit
    (surface,) = bake_surfaces(tmp_path, s.square("Ground", 2.0 / unit))
    assert level(points_at(surface, 4)) * unit == pytest.approx(0.1, rel=0.03)
