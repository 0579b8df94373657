#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of the manual in docs/images, from our own sample trees.

    ./tools/demo.sh
    PYTHONPATH=build/python /usr/bin/python3 tools/guide_pictures.py [NAME ...]

tree               the maple as exported, its branches, its rig
demo, close_up     the demo's last frame, and a close-up of a fork, from build/demo
shot               three frames of the demo
detail             a piece of the tree at the four levels of detail
viewport           Blender's window under Xvfb: direction dials, a live preview, the sidebar
scene_properties   the Scene properties in that window
panels             the sidebar in all its states, from build/panels (tests/ui/panel_states.py)
panels_newest      the same in Debian sid's Blender
preferences        the extension in the preferences of that Blender, from build/panels
windy              the sheet of tools/windy_shot.sh, from build/windy

Without names it makes all. Every picture is a PNG of less than 150 KB; single renders are JPEGs.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import snowbough_native
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
DEMO = ROOT / "build" / "demo"
IMAGES = ROOT / "docs" / "images"
MAX_BYTES = 150_000

sys.path[:0] = [str(ROOT / "blend_samples"), str(ROOT / "tests" / "ui")]
import contact_sheet  # noqa: E402
import grow_tree  # noqa: E402
import window as ui  # noqa: E402
from panel_states import SHOW_SCENE, side_by_side  # noqa: E402

# A maple on a ground plane, in the live preview of a snowfall with wind.
PREVIEWED_SCENE = """
import math
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.import_scene.xfrog_tree(filepath={tree!r})
tree = next(obj for obj in bpy.data.objects if obj.name.endswith("_bark"))
bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=7.0)
ground = bpy.context.object
bpy.ops.object.select_all(action="DESELECT")
for obj in (ground, tree):
    obj.select_set(True)
bpy.ops.snowbough.add_receivers()
for obj in bpy.data.objects:
    obj.hide_set(obj.type in {{"ARMATURE", "LIGHT", "CAMERA"}})
scene = bpy.context.scene
scene.frame_end = 40
scene.snowbough.fall_angle, scene.snowbough.bearing = math.radians(35.0), math.radians(110.0)
scene.snowbough.end_depth = 0.15
window, area = view3d()
space = area.spaces.active
space.shading.light, space.shading.color_type = "STUDIO", "OBJECT"
overlay = space.overlay
overlay.show_relationship_lines = overlay.show_floor = overlay.show_cursor = overlay.show_object_origins = False
overlay.show_axis_x = overlay.show_axis_y = False
ground.color, tree.color = (0.16, 0.13, 0.09, 1.0), (0.12, 0.07, 0.04, 1.0)
space.region_3d.view_distance, space.region_3d.view_location = 21.0, (1.6, 0.0, 6.2)
space.region_3d.view_rotation = (0.80, 0.55, 0.13, 0.19)
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.snowbough.toggle_preview()
result = True
"""


# A receiver, a 3D view split for a column of properties, and Blender's own panels closed.
SETTINGS_ALONE = """
bpy.ops.snowbough.add_receivers()
for name in dir(bpy.types):
    if name.startswith("SCENE_PT_"):
        bpy.utils.unregister_class(getattr(bpy.types, name))
window, area = view3d()
known = set(window.screen.areas)
with bpy.context.temp_override(window=window, area=area):
    bpy.ops.screen.area_split(direction="VERTICAL", factor=0.38)
column = next(area for area in window.screen.areas if area not in known)
column.type = "PROPERTIES"
result = True
"""
# Region of the picture of the levels of detail: the maple's trunk between its fourth and eighth branch.
DETAIL_MIDDLE, DETAIL_REACH = np.array((-0.24, 0.0, 2.12)), np.array((0.36, 0.6, 0.45))

# Renders, which have too many colours for a palette.
PHOTOGRAPHS = {"demo", "close_up"}
# The few red pixels of the flag must stay red.
RARE_COLOURS = {"windy"}


def keep(image, name):
    """Writes docs/images/<name>.png with as many colours as its size allows; photographs as .jpg."""
    if name in PHOTOGRAPHS:
        image.convert("RGB").save(IMAGES / f"{name}.jpg", quality=88, optimize=True)
        return
    method = Image.Quantize.MAXCOVERAGE if name in RARE_COLOURS else Image.Quantize.MEDIANCUT
    target = IMAGES / f"{name}.png"
    for colours in (256, 192, 128, 96, 64, 32):
        image.convert("RGB").quantize(colours, method=method).save(target, optimize=True)
        if target.stat().st_size < MAX_BYTES:
            print(
                f"{target.relative_to(ROOT)}: {image.width} x {image.height}, {target.stat().st_size} bytes"
            )
            return
    raise SystemExit(f"{target} is larger than {MAX_BYTES} bytes: reduce its width and height")


def maple():
    """Grows the demo's tree. Returns its path."""
    path = ROOT / "build" / "guide" / "maple.obj"
    path.parent.mkdir(parents=True, exist_ok=True)
    grow_tree.main(["--species", "maple", "--seed", "1", str(path)])
    return path


def tree():
    path = maple()
    skeleton = snowbough_native.read_tree(str(path))
    polygons = [
        np.stack([polygon[:, 0], -polygon[:, 2], polygon[:, 1]], axis=1)
        for polygon in contact_sheet.read_polygons(path)
    ]
    levels = {branch.name.rstrip("0123456789"): branch.level for branch in skeleton.branches}
    rig = snowbough_native.reduce_bones(snowbough_native.build_tree_mesh(skeleton), 1000, -1)
    names = [name.split(".")[0].rstrip("0123456789") for name in rig.bone_names]
    size = (330, 420)
    return side_by_side(
        [
            contact_sheet.raw_plate(polygons, size),
            contact_sheet.skeleton_plate(skeleton.branches, size),
            contact_sheet.rig_plate(list(zip(rig.bone_heads, rig.bone_tails, names)), levels, size),
        ]
    )


def demo_frames():
    frames = sorted(DEMO.glob("frame_*.png"))
    if len(frames) < 3:
        raise SystemExit("build/demo contains no rendered frames: run ./tools/demo.sh first")
    return frames


def demo():
    return Image.open(demo_frames()[-1])


def close_up():
    demo_frames()
    return Image.open(DEMO / "close_up.png")


def shot():
    frames = demo_frames()
    chosen = (frames[0], frames[len(frames) // 2], frames[-1])
    return side_by_side([Image.open(frame).resize((330, 206), Image.LANCZOS) for frame in chosen])


def detail():
    """A piece of the trunk with its first branches, lit from the upper left, every face drawn."""
    skeleton = snowbough_native.read_tree(str(maple()))
    away = np.array((0.0, np.cos(contact_sheet.PITCH), -np.sin(contact_sheet.PITCH)))
    light = np.array((-0.65, -0.55, 0.52))
    plates = []
    for level, name in enumerate(("DRAFT", "GAME", "DEFAULT", "FILM")):
        mesh = snowbough_native.build_tree_mesh(skeleton, detail=name)
        corners = mesh.vertices[mesh.quads]
        corners = corners[(np.abs(corners.mean(axis=1) - DETAIL_MIDDLE) < DETAIL_REACH).all(axis=1)]
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        corners, normals = corners[normals @ away < 0], normals[normals @ away < 0]
        plate = contact_sheet.Plate(
            244, 330, DETAIL_MIDDLE + DETAIL_REACH * np.array([(-1, 0, -1), (1, 0, 1)])
        )
        tones = (105 + 140 * np.maximum(normals @ light, 0)).astype(int)
        # Far faces first. Finer faces get fainter edges, otherwise the edges would cover the picture.
        for face in np.argsort(-(corners.mean(axis=1) @ away)):
            tone = int(tones[face])
            edge = int(tone * (0.55 + 0.13 * level))
            plate.polygon(corners[face], fill=(tone,) * 3, outline=(edge,) * 3)
        plates.append(plate.finished())
    return side_by_side(plates)


def with_window(work):
    """Calls work(window) on a Blender window with the add-on installed."""
    with tempfile.TemporaryDirectory(prefix="snowbough-guide-") as folder:
        window = ui.BlenderWindow(folder, ui.addon_zip())
        try:
            return work(window)
        finally:
            window.close()


def viewport():
    path = maple()

    def work(window):
        window.open_sidebar_tab()
        window.run(PREVIEWED_SCENE.format(tree=str(path)), timeout=300)
        # The preview simulates skipped frames only up to playback.MAX_SKIPPED.
        for frame in (8, 15, 22, 29):
            window.run(f"bpy.context.scene.frame_set({frame})\nresult = True", timeout=120)
        time.sleep(3.0)
        area = window.run("area = view3d()[1]\nresult = [area.x, area.y, area.width, area.height]")
        return cropped(window, "guide_viewport", area)

    return with_window(work)


def scene_properties():
    def work(window):
        window.run(SETTINGS_ALONE)
        time.sleep(2.0)
        window.run(SHOW_SCENE)
        time.sleep(4.0)
        area = window.run("result = [column.x, column.y, column.width, column.height]")
        return cropped(window, "guide_scene", area)

    return with_window(work)


def panels():
    return panel_states(0)


def windy():
    sheet = ROOT / "build" / "windy" / "sheet.png"
    if not sheet.exists():
        raise SystemExit(f"there is no {sheet}: run ./tools/windy_shot.sh first")
    image = Image.open(sheet)
    return image.resize((1200, round(1200 * image.height / image.width)), Image.LANCZOS)


def panels_newest():
    return panel_states(-1)


def preferences():
    return Image.open(sorted((ROOT / "build" / "panels").glob("*/preferences.png"))[-1])


def panel_states(which):
    made = sorted((ROOT / "build" / "panels").glob("*/sidebars.png"))
    if len(made) < 2:
        raise SystemExit(
            "build/panels does not contain two versions: make them as tests/ui/panel_states.py describes"
        )
    image = Image.open(made[which])
    return image.resize((1400, round(1400 * image.height / image.width)), Image.LANCZOS)


def cropped(window, name, area):
    x, y, width, height = area
    return window.screenshot(name).crop((x, ui.HEIGHT - y - height, x + width, ui.HEIGHT - y))


PICTURES = {
    "tree": tree,
    "demo": demo,
    "close_up": close_up,
    "shot": shot,
    "detail": detail,
    "viewport": viewport,
    "scene_properties": scene_properties,
    "panels": panels,
    "panels_newest": panels_newest,
    "preferences": preferences,
    "windy": windy,
}

if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    for picture in sys.argv[1:] or PICTURES:
        keep(PICTURES[picture](), picture)
