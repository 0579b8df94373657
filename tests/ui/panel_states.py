#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the panels in all their states, in Blender's real window, to be looked at.

    /usr/bin/python3 tests/ui/panel_states.py                                       Debian 12's Blender
    tools/blender_debian.sh 5.2 --run /usr/bin/python3 tests/ui/panel_states.py     Debian sid's

Writes build/panels/<Blender's version>/<state>.png, each with the sidebar at the left and the Scene
properties beside it, all.png with all states, and sidebars.png with the sidebars alone. The states are those
of a small scene that is set up, baked, changed and broken:

empty     nothing is set up
ready     two receivers, nothing baked
baking    in the middle of it
stopped   stopped half-way: it can be resumed
done      baked
stale     baked, then settings were changed
error     messages of Check Scene for a broken scene, and of a refused bake
tree      a tree is selected

And preferences.png: the add-on in Blender's preferences.
"""

import sys
import tempfile
import time
from pathlib import Path

import window as ui
from PIL import Image, ImageDraw, ImageFont
from snow_shot import wait_for_heights
from window import ROOT

GAP = 10
# Of the 3D view's width that stays with it: properties are read in a column of usual width.
COLUMN_SHARE = 0.52
LABEL_FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"

# The 3D view split for a column of properties, with Blender's own Scene panels put away.
COLUMN = """
for name in dir(bpy.types):
    if name.startswith("SCENE_PT_"):
        bpy.utils.unregister_class(getattr(bpy.types, name))
window, area = view3d()
known = set(window.screen.areas)
with bpy.context.temp_override(window=window, area=area):
    bpy.ops.screen.area_split(direction="VERTICAL", factor={share})
# Nothing behind the sidebar that would distract from it.
area.spaces.active.overlay.show_overlays = False
area.spaces.active.region_3d.view_location = (1000.0, 0.0, 0.0)
column = next(area for area in window.screen.areas if area not in known)
column.type = "PROPERTIES"
result = True
"""
SHOW_SCENE = """
column.spaces.active.context = "SCENE"
column.tag_redraw()
result = [column.x, column.y, column.width, column.height]
"""
REDRAW = """
for area in bpy.context.window_manager.windows[0].screen.areas:
    area.tag_redraw()
result = True
"""
SCENE = """
bpy.ops.mesh.primitive_plane_add(size=8.0)
ground = bpy.context.object
ground.name = "Ground"
bench = bpy.data.objects["Cube"]
bench.name, bench.location.z = "Bench", 1.5
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, {frames}
bpy.ops.object.select_all(action="DESELECT")
for mesh in (ground, bench):
    mesh.select_set(True)
bpy.context.view_layer.objects.active = bench
bpy.ops.snowbough.add_receivers()
for entry in scene.snowbough.receivers:
    entry.resolution = 512
bpy.ops.wm.save_as_mainfile(filepath={path!r})
result = True
"""
BAKE = """
window, area = view3d()
with bpy.context.temp_override(window=window, area=area, region=area.regions[-1]):
    bpy.ops.snowbough.bake("INVOKE_DEFAULT")
result = True
"""
CHANGE = """
scene.snowbough.end_depth = 0.35
scene.snowbough.flutter = 0.2
scene.snowbough.receivers[0].resolution = 256
result = True
"""
# A receiver that no render shows, one whose UV map overlaps, one scaled unevenly; the cache where no folder is.
SPOIL = """
ground.hide_render = True
corners = bench.data.uv_layers.active.data
for index, corner in enumerate(corners):
    corner.uv = corners[index % 4].uv
bench.scale.z = 2.0
scene.snowbough.cache_directory = "/dev/null/snow"
bpy.context.view_layer.update()
bpy.ops.snowbough.preflight()
result = True
"""
TREE = """
bpy.ops.import_scene.xfrog_tree(filepath={tree!r})
rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
bpy.context.view_layer.objects.active = rig
result = True
"""
# The editor shows one add-on of many if a search names it.
PREFERENCES = """
window, area = view3d()
area.type = "PREFERENCES"
bpy.context.preferences.active_section = "ADDONS"
bpy.context.window_manager.addon_search = "Snowbough"
bpy.ops.preferences.addon_expand(module=addon)
result = [area.x, area.y, area.width, area.height]
"""


class Camera:
    """Takes the pictures of one Blender window."""

    def __init__(self, window, folder):
        self.window, self.folder = window, folder
        self.taken = []  # (state, the sidebar's picture, that of both)

    def shoot(self, state):
        # The pointer rests where it shows no tooltip.
        self.window.move(300, ui.HEIGHT // 2)
        for _ in range(4):  # panels slide to their places
            self.window.run(REDRAW)
            time.sleep(0.5)
        screen = self.window.screenshot(f"panels_{state}")
        column = self.window.run(SHOW_SCENE)
        sidebar = trimmed(self._crop(screen, *self.window.sidebar()))
        picture = side_by_side([sidebar, trimmed(self._crop(screen, *self._from_top(column)))])
        picture.save(self.folder / f"{state}.png")
        self.taken.append((state, sidebar, picture))

    @staticmethod
    def _from_top(region):
        x, y, width, height = region
        return x, ui.HEIGHT - y - height, width, height

    def shoot_preferences(self):
        """Turns the 3D view into the preferences; the last picture of a window."""
        area = self.window.run(PREFERENCES)
        self.window.move(5, ui.HEIGHT - 5)
        time.sleep(2.0)
        screen = self.window.screenshot("panels_preferences")
        left, top, width, height = self._from_top(area)
        # Without the arrow that shows a hidden region at the bottom.
        trimmed(self._crop(screen, left, top, width, height - 30)).save(self.folder / "preferences.png")

    @staticmethod
    def _crop(screen, left, top, width, height):
        return screen.crop((left, top, left + width, top + height))


def trimmed(image):
    """Without the rows at the bottom that are all of one colour along their middle."""
    pixels = image.convert("L")
    margin = image.width // 12
    bottom = image.height - 1
    while bottom > 40:
        low, high = pixels.crop((margin, bottom - 1, image.width - margin, bottom)).getextrema()
        if high - low > 40:
            break
        bottom -= 1
    return image.crop((0, 0, image.width, min(image.height, bottom + 8)))


def side_by_side(images):
    width = sum(image.width for image in images) + GAP * (len(images) - 1)
    row = Image.new("RGB", (width, max(image.height for image in images)), (255, 255, 255))
    left = 0
    for image in images:
        row.paste(image, (left, 0))
        left += image.width + GAP
    return row


def overview(taken, a_row):
    """(state, picture) in rows of so many, each with its name above it."""
    font = ImageFont.truetype(LABEL_FONT, 18)
    rows = [taken[start : start + a_row] for start in range(0, len(taken), a_row)]
    width = max(sum(image.width + GAP for _, image in row) for row in rows)
    heights = [max(image.height for _, image in row) + 34 for row in rows]
    sheet = Image.new("RGB", (width, sum(heights)), (255, 255, 255))
    draw, top = ImageDraw.Draw(sheet), 0
    for row, height in zip(rows, heights):
        left = 0
        for state, image in row:
            draw.text((left + 4, top + 6), state, font=font, fill=(30, 30, 30))
            sheet.paste(image, (left, top + 30))
            left += image.width + GAP
        top += height
    return sheet


def wait_for_the_end(window):
    window.wait_for_bake()
    time.sleep(1.0)


def take(window, folder, work):
    """Walks through the states and takes each one's picture."""
    window.open_sidebar_tab()
    window.run(COLUMN.format(share=COLUMN_SHARE))
    time.sleep(1.0)
    window.run(SHOW_SCENE)
    camera = Camera(window, folder)

    camera.shoot("empty")
    window.run(SCENE.format(frames=400, path=str(work / "shot.blend")))
    camera.shoot("ready")

    window.run(BAKE)
    wait_for_heights(work, 24)
    camera.shoot("baking")
    window.key("Escape")
    wait_for_the_end(window)
    camera.shoot("stopped")

    window.run("bpy.context.scene.frame_end = 4\nbpy.ops.wm.save_mainfile()\nresult = True")
    window.run(BAKE)
    wait_for_the_end(window)
    camera.shoot("done")

    window.run(CHANGE)
    camera.shoot("stale")

    window.run(SPOIL)
    window.run(BAKE)
    wait_for_the_end(window)
    window.key("Escape")  # the pop-up with the same text
    camera.shoot("error")

    window.run("bpy.ops.wm.read_homefile(app_template='')\nresult = True")
    window.run(COLUMN.format(share=COLUMN_SHARE).replace("bpy.utils.unregister_class", "lambda _: _"))
    window.open_sidebar_tab()
    window.run(SHOW_SCENE)
    window.run(TREE.format(tree=str(ROOT / "tests" / "data" / "small_maple.obj")))
    camera.shoot("tree")

    window.run("bpy.ops.wm.read_homefile(app_template='')\nresult = True")
    camera.shoot_preferences()
    return camera.taken


def main():
    ui.HEIGHT = 1300  # all panels are to be seen at once
    with tempfile.TemporaryDirectory(prefix="snowbough-panels-") as folder:
        window = ui.BlenderWindow(folder, ui.addon_zip(), log="panels.log")
        try:
            version = window.run("result = '.'.join(map(str, bpy.app.version))")
            pictures = ROOT / "build" / "panels" / version
            pictures.mkdir(parents=True, exist_ok=True)
            work = Path(folder) / "shot"
            work.mkdir()
            taken = take(window, pictures, work)
            overview([(state, both) for state, _, both in taken], 3).save(pictures / "all.png")
            overview([(state, sidebar) for state, sidebar, _ in taken], len(taken)).save(
                pictures / "sidebars.png"
            )
            print(f"panels: {pictures}")
        finally:
            window.close()


if __name__ == "__main__":
    sys.exit(main())
