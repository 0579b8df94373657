# SPDX-License-Identifier: GPL-3.0-or-later
"""The material of shells, as it is rendered."""

import bpy
import numpy as np
import snow_scene as s

SIZE = 32
# Of the shell over the ground, metres.
ABOVE = 0.0015


def brightness(path):
    """Of a render of what lies in the origin, seen from above."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 64, False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(-1, 4)[:, :3].mean()


def light_and_camera(scene):
    """A low sun, the sky, and a camera that sees 10 cm."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 0.1, (0.0, 0.0, 1.0)
    camera.data.clip_start = 0.01
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2.0, (1.0, 0.0, 0.0)
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.camera = camera


def sheet_of_snow(addon, thickness):
    shell = s.square("Snow", 1.0, ABOVE)
    mesh = shell.data
    mesh.attributes.new("snow_height", "FLOAT", "POINT").data.foreach_set("value", [thickness] * 4)
    places = np.array([vertex.co for vertex in mesh.vertices], np.float32)
    mesh.attributes.new("snow_position", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", places.ravel())
    mesh.materials.append(addon("result.shell_material").make_material(bpy.context.scene, "Snow"))


def test_a_dusting_does_not_darken_what_shows_through_it(addon, tmp_path):
    """Snow is brighter than this ground, so a mix of both is."""
    bpy.ops.wm.read_homefile(use_empty=True)
    light_and_camera(bpy.context.scene)
    ground = s.square("Ground", 1.0)
    material = bpy.data.materials.new("white")
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.85, 0.85, 0.85, 1.0)
    ground.data.materials.append(material)
    bare = brightness(tmp_path / "bare.exr")
    sheet_of_snow(addon, 0.0022)
    assert brightness(tmp_path / "dusted.exr") > bare


def test_deep_snow_throws_a_shadow(addon, tmp_path):
    bpy.ops.wm.read_homefile(use_empty=True)
    light_and_camera(bpy.context.scene)
    s.square("Ground", 1.0)
    sheet_of_snow(addon, 0.05)
    bpy.data.objects["Snow"].location = (0.0, -0.6, 0.5)  # between the sun and what the camera sees
    shadowed = brightness(tmp_path / "shadowed.exr")
    bpy.data.objects.remove(bpy.data.objects["Snow"])
    assert shadowed < 0.5 * brightness(tmp_path / "lit.exr")
