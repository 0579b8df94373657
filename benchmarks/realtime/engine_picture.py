# SPDX-License-Identifier: GPL-3.0-or-later
"""A snowed-in scene in one frame of the render engine Snowbough Realtime: docs/images/realtime_engine.png.

blender -b --factory-startup --python-exit-code 1 -P benchmarks/realtime/engine_picture.py [-- PICTURE.png]
"""

import math
import sys
import tempfile
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))
import snowbough  # noqa: E402

TREE = ROOT / "tests" / "data" / "small_maple.obj"
FRAMES = 4


def paint(obj, color, image=None):
    material = bpy.data.materials.new(obj.name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    if image is not None:
        texture = material.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    obj.data.materials.append(material)


def build():
    """The scene, its receivers selected."""
    scene = bpy.context.scene
    bpy.ops.import_scene.xfrog_tree(filepath=str(TREE), height=4.5)
    bark = bpy.data.objects["small_maple_bark"]
    bpy.ops.mesh.primitive_plane_add(size=12.0)
    ground = bpy.context.object
    paint(ground, (0.25, 0.3, 0.12))
    bpy.ops.mesh.primitive_monkey_add(size=1.5, location=(1.7, -1.6, 0.75), rotation=(0, 0, 0.4))
    monkey = bpy.context.object
    bpy.ops.object.shade_smooth()
    # With 500 faces alone, facets would be visible.
    round_ = monkey.modifiers.new("Subdivision", "SUBSURF")
    round_.levels = round_.render_levels = 2
    paint(monkey, (0.6, 0.05, 0.03))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-1.8, -1.2, 0.5), rotation=(0, 0, 0.5))
    cube = bpy.context.object
    grid = bpy.data.images.new("grid", 256, 256)
    grid.generated_type = "COLOR_GRID"
    paint(cube, (1.0, 1.0, 1.0), grid)

    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 2.4
    sun.rotation_euler = (math.radians(50), 0.0, math.radians(40))
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = (0.35, 0.5, 0.75, 1.0), 0.6
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location = (3.3, -10.4, 2.5)
    scene.camera.rotation_euler = (math.radians(87), 0.0, math.radians(17))
    scene.collection.objects.link(scene.camera)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in (bark, ground, monkey, cube):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = ground
    return scene


def snow(scene, cache):
    scene.frame_start, scene.frame_end = 1, FRAMES
    bpy.ops.snowbough.add_receivers()
    scene.snowbough.cache_directory = cache
    scene.snowbough.end_depth = 0.12
    scene.snowbough.flutter = math.radians(2)
    for entry in scene.snowbough.receivers:
        entry.resolution = 512
    bpy.ops.snowbough.bake()
    # The engine draws the maps itself, so Blender need not evaluate the snow surfaces.
    for obj in scene.objects:
        obj.hide_render = obj.hide_render or obj.snowbough.is_shell
    scene.frame_set(FRAMES)


def main():
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    out = Path(given[0]) if given else ROOT / "docs" / "images" / "realtime_engine.png"
    snowbough.register()
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = build()
    with tempfile.TemporaryDirectory() as cache:
        snow(scene, cache)
        render = scene.render
        render.engine = "SNOWBOUGH_REALTIME"
        render.resolution_x, render.resolution_y = 840, 560
        scene.view_settings.view_transform = "Standard"
        render.filepath = str(out.resolve())
        bpy.ops.render.render(write_still=True)


main()
