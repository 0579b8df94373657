# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' texture cache, from Blender 5.2 on: it writes copies of images into `blender_tx` beside them."""

import bpy
import numpy as np
import pytest
import snow_scene
from realtime_shot import rendered


@pytest.fixture
def render(tmp_path):
    """render(cached): the pixels of a small picture by Cycles, with or without its texture cache."""
    scene = bpy.context.scene
    if not hasattr(scene.render, "use_texture_cache"):
        pytest.skip("this Blender has no texture cache")
    if not hasattr(scene, "cycles"):
        pytest.skip("this Blender has no Cycles")
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.2
    camera.location = (0.0, 0.0, 4.0)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.5, 0.3, 0.0)
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.camera = camera

    def picture(cached):
        scene.render.use_texture_cache = scene.render.use_auto_generate_texture_cache = cached
        scene.render.filepath = str(tmp_path / f"cached_{cached}.exr")
        return rendered(scene)[..., :3]

    return picture


def test_snow_looks_the_same_with_the_texture_cache_and_free_bake_removes_its_files(render, tmp_path):
    ground = snow_scene.square("ground")
    snow_scene.square("roof", size=1.0, z=1.0)
    cache = tmp_path / "cache"
    snow_scene.receive(ground)
    snow_scene.settings(cache)
    bpy.data.objects["roof"].visible_camera = False
    snow_scene.bake()
    bpy.ops.snowbough.setup_material()
    bpy.context.scene.frame_set(4)
    plain = render(False)
    assert not list(tmp_path.rglob("*.tx"))
    cached = render(True)
    made = list(tmp_path.rglob("*.tx"))
    assert made and all(path.parent.name == "blender_tx" for path in made)
    assert plain.std() > 0.05, "the picture shows no border of snow"
    assert np.abs(cached - plain).mean() < 0.005
    bpy.ops.snowbough.free_bake()
    assert not list(tmp_path.rglob("*.tx"))
