# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures by the engine Snowbough Realtime, read back as linear light."""

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

WIDTH, HEIGHT = 160, 120
WORLD = (0.1, 0.2, 0.4)


def material(name, color, image=None):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    base = made.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    base.default_value = (*color, 1.0)
    if image is not None:
        node = made.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        made.node_tree.links.new(node.outputs["Color"], base)
    return made


def camera_at(location, target=(0, 0, 0)):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = location
    camera.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def set_up(tmp_path):
    """A vertical sun, a world of one colour, the engine, small pictures of linear light."""
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 2.0
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*WORLD, 1.0)
    render = scene.render
    render.engine = "SNOWBOUGH_REALTIME"
    render.resolution_x, render.resolution_y = WIDTH, HEIGHT
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.filepath = str(tmp_path / "picture.exr")
    scene.snowbough_realtime.samples = 4
    return scene


def rendered(scene):
    """(height, width, 4) of linear light, row 0 at the bottom."""
    bpy.ops.render.render(write_still=True)
    return read(scene.render.filepath)


def read(path):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    shape = (image.size[1], image.size[0], image.channels)
    bpy.data.images.remove(image)
    return flat.reshape(shape)


def pixel(picture, scene, point):
    """The picture's value at a point of the scene."""
    at = world_to_camera_view(scene, scene.camera, Vector(point))
    return picture[int(at.y * picture.shape[0]), int(at.x * picture.shape[1])]
