# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowbough Realtime in a 3D view: it shows the scene, follows the view and the scene, and leaves no data behind."""

from pathlib import Path

import window as ui
from PIL import Image, ImageChops, ImageStat

MAPLE = Path(__file__).resolve().parent.parent / "data" / "small_maple.obj"

# A red cube on a green ground, a tree behind it, a sun, and a view from the front.
SCENE = """
import math
import sys
from mathutils import Euler

def paint(obj, color):
    material = bpy.data.materials.new(obj.name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    obj.data.materials.clear()
    obj.data.materials.append(material)

scene = bpy.context.scene
bpy.ops.import_scene.xfrog_tree(filepath={tree!r})
bpy.data.objects["small_maple"].location = (2.5, 2.0, 0.0)
bpy.ops.mesh.primitive_plane_add(size=40.0)
paint(bpy.context.object, (0.05, 0.4, 0.05))
cube = bpy.data.objects["Cube"]
cube.location.z = 1.0
paint(cube, (0.8, 0.02, 0.02))
light = bpy.data.objects["Light"]
light.data.type = "SUN"
light.data.energy = 3.0
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
scene.view_settings.view_transform = "Standard"
for obj in bpy.context.selected_objects:
    obj.select_set(False)
scene.render.engine = {engine!r}
area = view3d()[1]
space = area.spaces.active
space.overlay.show_overlays = False
space.show_gizmo = False
view = space.region_3d
view.view_location, view.view_distance = (0.0, 0.0, 1.5), 14.0
view.view_rotation = Euler((math.radians(78), 0, 0)).to_quaternion()
view.view_perspective = "PERSP"
space.shading.type = "RENDERED"
result = True
"""

VIEWPORTS = "__import__('sys').modules[addon + '.realtime.viewport']._open"
SHOWN = f"[v.error or v.shown for v in {VIEWPORTS}] == [__import__('sys').modules[addon + '.realtime.pacing'].FINE]"


def show(window, engine="SNOWBOUGH_REALTIME"):
    window.run(SCENE.format(tree=str(MAPLE), engine=engine), timeout=120)


def settled(window):
    """The 3D view once its picture has all of its pixels and smooth edges."""
    window.settle()
    window.wait_until(SHOWN, timeout=120)
    return window.view()


def color(image, x, y):
    """Mean colour around a place, in shares of the picture from its upper left."""
    at = int(x * image.width), int(y * image.height)
    return ImageStat.Stat(image.convert("RGB").crop((at[0] - 3, at[1] - 3, at[0] + 3, at[1] + 3))).mean


def difference(first, second):
    return sum(ImageStat.Stat(ImageChops.difference(first.convert("RGB"), second.convert("RGB"))).mean)


def test_the_view_shows_the_scene_and_follows_an_orbit(window):
    show(window)
    before = settled(window)
    window.screenshot("realtime")
    red, green, blue = color(before, 0.5, 0.5)
    assert red > 2 * green and red > 2 * blue  # the cube
    red, green, blue = color(before, 0.5, 0.95)
    assert green > 1.5 * red and green > 1.5 * blue  # the ground
    # The sky is the world's colour: 0.2, 0.4 and 0.8 as sRGB.
    assert all(abs(a - b) <= 4 for a, b in zip(color(before, 0.05, 0.04), (124, 170, 231)))

    x, y = window.run("a = view3d()[1]\nresult = [a.x + a.width // 2, a.y + a.height // 2]")
    window.move(x, 900 - y)
    for _ in range(3):
        window.key("KP_4")
    after = settled(window)
    window.screenshot("realtime_orbit")
    assert difference(before, after) > 5


def test_the_view_follows_the_scene(window):
    show(window)
    before = settled(window)
    window.run("cube.location.x = 4.0\nresult = True")
    moved = settled(window)
    red, green, _blue = color(moved, 0.5, 0.5)
    assert red < green  # the cube is gone from the middle
    window.run("cube.location.x = 0.0\nresult = True")
    assert difference(settled(window), before) < 0.5


def test_the_windows_thread_goes_on_while_a_picture_is_drawn(window):
    show(window)
    settled(window)
    window.run(
        f"""
viewport = {VIEWPORTS}[0]
shown, draw = [], viewport.draw

def noting(*given):
    draw(*given)
    shown.append(viewport.shown == sys.modules[addon + ".realtime.pacing"].FINE)

viewport.draw = noting
result = True
"""
    )
    for angle in (0.2, 0.4, 0.6):
        window.run(
            f"view.view_rotation = Euler((1.3, 0, {angle})).to_quaternion()\narea.tag_redraw()\nresult = True"
        )
        settled(window)
    finished = window.run("result = shown")
    print(
        f"{len(finished)} draws, of which {finished.count(False)} returned before the whole picture was there"
    )
    # A draw that waited for its picture would find it whole each time.
    assert finished.count(False) >= 3
    assert finished[-1]


def test_another_shading_and_switching_the_addon_off_end_it(window):
    show(window)
    settled(window)
    window.run("space.shading.type = 'SOLID'\nresult = True")
    window.wait_until(f"len({VIEWPORTS}) == 0")
    window.run("space.shading.type = 'RENDERED'\nresult = True")
    settled(window)
    window.run("bpy.ops.preferences.addon_disable(module=addon)\nresult = True")
    # The view falls to Blender's own engine, whose shaders take minutes to compile on a busy software renderer.
    assert window.run("result = bpy.context.scene.render.engine", timeout=300) != "SNOWBOUGH_REALTIME"
    window.run("bpy.ops.preferences.addon_enable(module=addon)\nresult = True")
    window.run("bpy.context.scene.render.engine = 'SNOWBOUGH_REALTIME'\nresult = True")
    settled(window)


def test_the_key_f12_renders_a_picture(window, tmp_path):
    show(window)
    settled(window)
    window.run(
        """
scene.camera.location, scene.camera.rotation_euler = (0, -9, 2), (math.radians(85), 0, 0)
scene.render.resolution_x, scene.render.resolution_y = 64, 48
bpy.context.preferences.view.render_display_type = "NONE"
rendered = []
bpy.app.handlers.render_complete.append(lambda *_: rendered.append(scene.render.engine))
result = True
"""
    )
    x, y, width, height = window.run("result = [area.x, area.y, area.width, area.height]")
    window.move(x + width // 2, ui.HEIGHT - y - height // 2)
    window.settle()
    window.key("F12")
    window.wait_until("rendered == ['SNOWBOUGH_REALTIME'] and not bpy.app.is_job_running('RENDER')")
    path = str(tmp_path / "f12.png")
    window.run(f"bpy.data.images['Render Result'].save_render({path!r})\nresult = True")
    picture = Image.open(path).convert("RGB")
    assert picture.size == (64, 48)
    red, green, blue = picture.getpixel((32, 24))
    assert red > 2 * max(green, blue) and red > 80  # the cube


# The ground as the only receiver: 0.2 m in 20 frames.
PREVIEW = """
scene.frame_start, scene.frame_end = 1, 20
scene.snowbough.end_depth = 0.2
bpy.context.view_layer.objects.active = bpy.data.objects["Plane"]
bpy.data.objects["Plane"].select_set(True)
bpy.ops.snowbough.add_receivers()
scene.snowbough.receivers[0].resolution = 256
scene.frame_set(1)
with bpy.context.temp_override(window=view3d()[0]):
    bpy.ops.snowbough.toggle_preview()
result = True
"""
STOP = "with bpy.context.temp_override(window=view3d()[0]):\n    bpy.ops.snowbough.toggle_preview()\nresult = True"


def test_the_view_shows_the_live_previews_snow_as_the_timeline_plays(window):
    show(window)
    bare = color(settled(window), 0.5, 0.95)
    window.run(PREVIEW, timeout=60)
    for frame in range(2, 16):
        window.run(f"scene.frame_set({frame})\nresult = True")
    snowy = settled(window)
    window.screenshot("realtime_live")
    window.run(STOP)
    red, green, blue = bare
    assert green > 1.5 * red
    red, green, blue = color(snowy, 0.5, 0.95)
    assert min(red, green, blue) > 150
    red, green, blue = color(settled(window), 0.5, 0.95)
    assert green > 1.5 * red  # gone with the preview
