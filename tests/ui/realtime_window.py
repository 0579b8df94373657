#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of Snowbough Realtime in Blender's real window, and what orbiting in it takes.

    /usr/bin/python3 tests/ui/realtime_window.py                                        Debian 12's Blender
    tools/blender_debian.sh 5.2 --run /usr/bin/python3 tests/ui/realtime_window.py      Debian sid's

SNOWBOUGH_TEST_BLENDER_ARGUMENTS="--gpu-backend vulkan" in front of it draws Blender's window with Vulkan. A tree, a
monkey, a box that a collection instances, and their ground are snowed in and seen through the camera. Writes
build/ui/realtime_<version>_<backend>.png and beside it what F12's operator renders (_f12.png) and the 3D view while it
orbits and after it (_orbit.png); prints their names and, of the orbit's 24 turns, how long the window's thread was held
by each redraw, how many pictures came meanwhile, and when the whole one came.
"""

import tempfile
import time

import window as ui
from PIL import Image

TREE = ui.ROOT / "tests" / "data" / "small_maple.obj"

BUILD = """
import math

scene = bpy.context.scene
for obj in list(bpy.data.objects):
    bpy.data.objects.remove(obj)
bpy.ops.import_scene.xfrog_tree(filepath={tree!r}, height=4.5)
bpy.ops.mesh.primitive_plane_add(size=14.0)
ground = bpy.context.object
bpy.ops.mesh.primitive_monkey_add(size=1.5, location=(1.7, -1.6, 0.75), rotation=(0, 0, 0.4))
monkey = bpy.context.object
bpy.ops.object.shade_smooth()
round_ = monkey.modifiers.new("Subdivision", "SUBSURF")
round_.levels = round_.render_levels = 2
red = bpy.data.materials.new("red")
red.use_nodes = True
red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.6, 0.05, 0.03, 1)
monkey.data.materials.append(red)
bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0, 0, 0.45))
box = bpy.context.object
parts = bpy.data.collections.new("Parts")
for home in box.users_collection:
    home.objects.unlink(box)
parts.objects.link(box)
empty = bpy.data.objects.new("Instance", None)
empty.instance_type, empty.instance_collection = "COLLECTION", parts
empty.location, empty.rotation_euler = (-1.9, -1.4, 0), (0, 0, 0.4)
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
sun.data.energy, sun.rotation_euler = 2.6, (math.radians(50), 0, math.radians(40))
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location, camera.rotation_euler = (3.3, -10.4, 2.5), (math.radians(87), 0, math.radians(17))
for obj in (empty, sun, camera):
    scene.collection.objects.link(obj)
scene.camera = camera
sky = scene.world.node_tree.nodes["Background"].inputs
sky["Color"].default_value, sky["Strength"].default_value = (0.35, 0.5, 0.75, 1), 0.6
scene.view_settings.view_transform = "Standard"
scene.frame_start, scene.frame_end = 1, 4
bpy.context.view_layer.update()
for obj in bpy.data.objects:
    obj.select_set(obj in (bpy.data.objects["small_maple_bark"], ground, monkey))
bpy.context.view_layer.objects.active = ground
bpy.ops.snowbough.add_receivers()
scene.snowbough.receivers.add().object = empty
for entry in scene.snowbough.receivers:
    entry.resolution = 512
scene.snowbough.end_depth = 0.12
scene.snowbough.cache_directory = {cache!r}
result = True
"""
BAKE = """
with bpy.context.temp_override(window=view3d()[0]):
    bpy.ops.snowbough.bake()
scene.frame_set(4)
scene.render.engine = "SNOWBOUGH_REALTIME"
area = view3d()[1]
space = area.spaces.active
space.overlay.show_overlays = space.show_gizmo = False
space.region_3d.view_perspective = "CAMERA"
space.shading.type = "RENDERED"
result = True
"""
RENDER = """
scene.render.resolution_x, scene.render.resolution_y = 840, 560
scene.render.filepath = {path!r}
with bpy.context.temp_override(window=view3d()[0]):
    bpy.ops.render.render(write_still=True)
result = True
"""
MODULES = "__import__('sys').modules[addon + '.realtime.{}']"
VIEWPORTS = MODULES.format("viewport") + "._open"
SHOWN = f"[v.error or v.shown for v in {VIEWPORTS}] == [{MODULES.format('pacing')}.FINE]"
WATCH = f"""
import time
from mathutils import Euler

viewport = {VIEWPORTS}[0]
held, draw, texture = [], viewport.draw, viewport._texture
pictures = 0

def timed(*given):
    begun = time.perf_counter()
    draw(*given)
    held.append(time.perf_counter() - begun)
    global pictures, texture
    pictures += viewport._texture is not texture
    texture = viewport._texture

viewport.draw = timed
space.region_3d.view_perspective = "PERSP"
space.region_3d.view_location, space.region_3d.view_distance = (0.3, -0.8, 1.6), 9.0
result = True
"""
TURN = "space.region_3d.view_rotation = Euler((1.4, 0, {angle})).to_quaternion()\narea.tag_redraw()\nresult = True"


def orbit(window, name):
    """Turns the view by small steps; prints what it took. Returns the 3D view at a third, two thirds and the end of the
    way, and when all of it is there, as pictures."""
    window.run(WATCH)
    seen = []
    began, looked = time.monotonic(), 0.0
    for step in range(24):
        window.run(TURN.format(angle=0.05 * step))
        if step % 8 == 7:
            begun = time.monotonic()
            seen.append(view3d(window, name))
            looked += time.monotonic() - begun
    moved = time.monotonic() - began - looked
    began += looked
    window.wait_until(SHOWN, timeout=300)
    settled = time.monotonic() - began - moved
    held, pictures = window.run("viewport.draw = draw\nresult = [held, pictures]")
    held.sort()
    print(
        f"orbit: {len(held)} redraws and {pictures} pictures while and after 24 turns in {moved:.2f} s, each redraw "
        f"held the window's thread for {1e3 * held[len(held) // 2]:.1f} ms (median), {1e3 * held[-1]:.1f} ms at most; "
        f"the whole picture {settled:.2f} s after the last turn"
    )
    time.sleep(1.0)
    return [*seen, view3d(window, name)]


def view3d(window, name):
    """The 3D view's part of a screenshot, which is kept under that name."""
    x, y, width, height = window.run("result = [area.x, area.y, area.width, area.height]")
    return window.screenshot(name).crop((x, ui.HEIGHT - y - height, x + width, ui.HEIGHT - y))


def side_by_side(pictures, height=300):
    """One picture of several, scaled to a height."""
    small = [each.resize((round(each.width * height / each.height), height)) for each in pictures]
    sheet = Image.new("RGB", (sum(each.width for each in small), height))
    x = 0
    for each in small:
        sheet.paste(each, (x, 0))
        x += each.width
    return sheet


def main():
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as cache:
        window = ui.BlenderWindow(folder, ui.addon_zip(), log="realtime_window.log")
        try:
            version, backend = window.run(
                "result = ['.'.join(map(str, bpy.app.version)), gpu.platform.backend_type_get().lower()]"
            )
            name = f"realtime_{version}_{backend}"
            window.run(BUILD.format(tree=str(TREE), cache=cache), timeout=300)
            window.run(BAKE, timeout=600)
            time.sleep(1.0)
            window.wait_until(SHOWN, timeout=300)
            time.sleep(1.0)
            window.screenshot(name)
            rendered = str(ui.SCREENSHOTS / f"{name}_f12.png")
            window.run(RENDER.format(path=rendered), timeout=600)
            orbited = ui.SCREENSHOTS / f"{name}_orbit.png"
            side_by_side(orbit(window, f"{name}_orbit")[1:]).save(orbited)
            print(ui.SCREENSHOTS / f"{name}.png", rendered, orbited, sep="\n")
        finally:
            window.close()


if __name__ == "__main__":
    main()
