# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview: snow in the viewport while the timeline plays, and nothing left of it afterwards."""

import bpy
import numpy as np
import pytest


@pytest.fixture
def ground():
    """A 2 m square in the ground as the only receiver; 10 frames lay 0.1 m."""
    mesh = bpy.data.meshes.new("Ground")
    mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    for corner, uv in zip(mesh.uv_layers.new(name="snow").data, [(0, 0), (1, 0), (1, 1), (0, 1)]):
        corner.uv = uv
    obj = bpy.data.objects.new("Ground", mesh)
    scene = bpy.context.scene
    scene.collection.objects.link(obj)
    scene.frame_start, scene.frame_end = 1, 10
    scene.snowbough.flutter = 0.0
    scene.snowbough.receivers.add().object = obj
    yield obj
    if bpy.data.objects.get("Ground snow preview"):
        bpy.ops.snowbough.toggle_preview()


def shown_height():
    shell = bpy.data.objects["Ground snow preview"]
    mesh = shell.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    return float(np.median(points[:, 2]))


def play(first, last):
    for frame in range(first, last + 1):
        bpy.context.scene.frame_set(frame)


def test_snow_grows_in_the_viewport_as_frames_pass(ground):
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    play(2, 6)
    assert shown_height() == pytest.approx(0.05, rel=0.02)
    play(7, 10)
    assert shown_height() == pytest.approx(0.09, rel=0.02)


def test_dropped_frames_are_made_up_for(ground):
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    bpy.context.scene.frame_set(6)
    assert shown_height() == pytest.approx(0.05, rel=0.02)


def test_going_back_starts_anew(ground):
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    play(2, 8)
    bpy.context.scene.frame_set(1)
    play(2, 3)
    assert shown_height() == pytest.approx(0.02, rel=0.05)


def test_nothing_is_left_when_it_ends(ground):
    def everything():
        return {
            name: sorted(block.name for block in getattr(bpy.data, name))
            for name in ("objects", "meshes", "materials", "images")
        }

    before = everything()
    bpy.ops.snowbough.toggle_preview()
    assert everything() != before
    bpy.ops.snowbough.toggle_preview()
    assert everything() == before


def test_the_outliner_gets_one_collection_and_snow_is_white(ground):
    before = [obj.name for obj in bpy.context.scene.collection.objects]
    bpy.ops.snowbough.toggle_preview()
    assert [obj.name for obj in bpy.context.scene.collection.objects] == before
    (collection,) = bpy.context.scene.collection.children
    assert collection.hide_render and collection.hide_select
    (shell,) = collection.objects
    assert tuple(shell.material_slots[0].material.diffuse_color) == (1.0, 1.0, 1.0, 1.0)
    bpy.ops.snowbough.toggle_preview()
    assert not bpy.context.scene.collection.children and not bpy.data.collections


def test_baked_snow_is_out_of_sight_meanwhile(ground, tmp_path):
    bpy.context.scene.snowbough.cache_directory = str(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    bpy.ops.snowbough.bake()
    baked = bpy.data.objects["Ground snow"]
    bpy.ops.snowbough.toggle_preview()
    assert baked.hide_viewport
    bpy.ops.snowbough.toggle_preview()
    assert not baked.hide_viewport


def test_bare_ground_shows_no_preview_snow(ground):
    """Faces without snow are cut, so nothing flickers through the surface."""
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    bpy.context.scene.snowbough.receivers[0].object.rotation_euler.x = 3.0
    play(2, 3)
    shell = bpy.data.objects["Ground snow preview"]
    bpy.context.scene.frame_set(1)
    bpy.data.images["Ground snow preview"].pixels.foreach_set(np.zeros(256 * 256 * 4, dtype=np.float32))
    bpy.data.images["Ground snow preview"].update()
    shell.update_tag()
    mesh = shell.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert len(mesh.polygons) == 0


def test_a_saved_file_holds_nothing_of_the_preview(ground, tmp_path):
    bpy.ops.snowbough.toggle_preview()
    path = str(tmp_path / "shot.blend")
    # A copy: Blender does not read from the file that is open.
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    with bpy.data.libraries.load(path) as (content, _):
        assert list(content.objects) == ["Ground"]


def test_without_anything_to_snow_on_it_says_so(ground):
    bpy.context.scene.snowbough.receivers[0].enabled = False
    with pytest.raises(RuntimeError, match="nothing for snow to lie on"):
        bpy.ops.snowbough.toggle_preview()


def test_it_sets_its_simulation_up_as_the_bake_does(addon, ground, tmp_path, monkeypatch):
    """The same grid, the same objects, the same map and blur, from one function."""
    real, made = addon("native").load(), []

    class Recorded(real.SnowSimulation):
        def __init__(self, **settings):
            super().__init__(**settings)
            made.append((settings["pixel_size"], []))

        def add_object(self, name, triangles, uv, **options):
            super().add_object(name, triangles, uv, **options)
            made[-1][1].append((name, triangles.tolist(), uv.tolist(), options["resolution"], options["receive"],
                                options["blur_radius"], options["alpha"]))  # fmt: skip

    class Native:
        SnowSimulation = Recorded

        def __getattr__(self, name):
            return getattr(real, name)

    monkeypatch.setattr(addon("native"), "load", Native)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, 2))
    snow = bpy.context.scene.snowbough
    snow.receivers[0].resolution = addon("bake.preview").RESOLUTION
    snow.cache_directory = str(tmp_path)
    bpy.ops.snowbough.bake()
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    bpy.ops.snowbough.toggle_preview()
    assert len(made) == 2 and len(made[0][1]) == 2
    assert made[0] == made[1]


def test_snow_stays_when_the_mesh_gets_finer(ground):
    modifier = ground.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    for frame, levels in ((1, 0), (4, 2)):
        modifier.levels = levels
        modifier.keyframe_insert("levels", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.ops.snowbough.toggle_preview()
    play(2, 6)
    assert shown_height() == pytest.approx(0.05, rel=0.02)


def test_where_things_are_is_known_after_the_shots_end_too(addon, ground):
    bpy.context.scene.frame_set(10)
    bpy.ops.snowbough.toggle_preview()
    for frame, scale in ((12, 2.0), (13, 3.0)):
        ground.scale = (scale, scale, scale)
        bpy.context.scene.frame_set(frame)
    running = addon("session").preview
    (key,) = running.receivers
    assert running.simulation.texel_area(key).sum() == pytest.approx(36.0, rel=1e-3)
