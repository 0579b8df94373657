# SPDX-License-Identifier: GPL-3.0-or-later
"""Shots whose time is stretched, stepped, divided or shown by the sequencer, and renders of their surfaces.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import os
import subprocess

import bpy
import numpy as np
import pytest
import snow_scene as s
from small_shots import straighten
from surface_scene import bake_surfaces, level, points_at


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


def test_a_picture_between_two_frames_shows_the_snow_half_way(tmp_path):
    """Frame 6.5, and frame 6 with a shutter that is open until frame 7."""
    cart, surface = rising(tmp_path / "cache")
    scene = bpy.context.scene
    cycles(scene)
    camera_above(cart)
    shine_by_height(surface)
    scene.view_settings.view_transform = "Raw"
    whole = rendered(scene, 6, tmp_path)
    half_way = pytest.approx((whole + rendered(scene, 7, tmp_path)) / 2, rel=0.003)
    assert half_way == whole * 6.5 / 6 and whole == pytest.approx(0.75, rel=0.03)
    assert rendered(scene, 6, tmp_path, subframe=0.5) == half_way
    scene.render.use_motion_blur, scene.render.motion_blur_shutter, scene.cycles.samples = True, 1.0, 64
    owner = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    owner.motion_blur_position = "START"
    assert rendered(scene, 6, tmp_path) == half_way


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


def rendered(scene, frame, folder, subframe=0.0):
    """Mean of the red pixels of a picture."""
    bpy.context.window.scene = scene  # Blender renders scene strips of the window's scene only
    scene.frame_set(frame, subframe=subframe)
    scene.render.filepath = str(folder / f"{scene.name}_{frame}_{len(bpy.data.images)}.exr")
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
