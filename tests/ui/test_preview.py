# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview in the window: it is visible, follows timeline and settings, and leaves no data behind."""

import pytest
from PIL import ImageChops, ImageStat
from window import wait_for

# A grey square of 8 m below the view, as the only receiver; 100 frames lay 0.2 m. Lines and markers off.
SCENE = """
from mathutils import Quaternion
bpy.context.preferences.system.viewport_aa = "OFF"
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.mesh.primitive_plane_add(size=8.0)
ground = bpy.context.object
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 100
scene.snowbough.end_depth = 0.2
bpy.ops.snowbough.add_receivers()
scene.snowbough.receivers[0].resolution = 256
bpy.ops.object.select_all(action="DESELECT")
space = view3d()[1].spaces.active
space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = False
space.overlay.show_cursor = space.overlay.show_extras = space.overlay.show_text = False
space.region_3d.view_perspective = "ORTHO"
space.region_3d.view_rotation = Quaternion((0.924, 0.383, 0.0, 0.0))
space.region_3d.view_distance = 5.0
scene.frame_set(1)
bpy.ops.ed.undo_push(message="scene")
result = True
"""

TOGGLE = """
with bpy.context.temp_override(window=view3d()[0]):
    bpy.ops.snowbough.toggle_preview()
result = True
"""

STATE = "__import__('sys').modules[addon + '.base.session'].preview"


@pytest.fixture
def scene(window):
    window.run(SCENE)
    yield window
    window.run(f"if {STATE}:\n    bpy.ops.snowbough.toggle_preview()\nresult = True")


def middle(window):
    """Red, green and blue of the middle of the view, 0 to 255."""
    image = window.view().convert("RGB")
    x, y = image.size
    return ImageStat.Stat(image.crop((x // 3, y // 3, 2 * x // 3, 2 * y // 3))).mean


def is_snow(color):
    return min(color) > 200


def wait_for_snow(window, wanted, timeout=30):
    """Waits until the middle of the view shows snow, or none."""
    wait_for(lambda: is_snow(middle(window)) == wanted, "snow" if wanted else "no snow", timeout)


def test_the_button_shows_snow_and_takes_it_away_without_a_trace(scene):
    scene.open_sidebar_tab()
    scene.run("scene.frame_set(50)\nresult = True")
    names = "result = [[block.name for block in data] for data in (bpy.data.objects, bpy.data.images, bpy.data.meshes)]"
    before, there = scene.view(), scene.run(names)
    assert not is_snow(middle(scene))
    scene.press_button("snowbough.toggle_preview")
    wait_for_snow(scene, True)
    scene.screenshot("preview")
    assert scene.run(names) == there
    scene.run(TOGGLE)
    wait_for(
        lambda: ImageChops.difference(scene.view().convert("RGB"), before.convert("RGB")).getbbox() is None,
        "the picture of before",
    )


def test_it_plays_by_the_space_key(scene):
    scene.run(TOGGLE)
    x, y, width, height = scene.run(
        "area = view3d()[1]\nregion = next(r for r in area.regions if r.type == 'WINDOW')\n"
        "result = [region.x, region.y, region.width, region.height]"
    )
    scene.move(x + width / 2, 900 - y - height / 2)
    scene.settle()
    scene.key("space")
    scene.wait_until("bpy.context.scene.frame_current >= 12", timeout=60)
    scene.key("space")
    scene.wait_until("not bpy.context.screen.is_animation_playing")
    wait_for_snow(scene, True)
    frame, shown = scene.run(f"result = [bpy.context.scene.frame_current, {STATE}.simulated.frame]")
    assert shown == frame


def test_settings_show_while_the_timeline_stands_still(scene):
    scene.run("scene.snowbough.end_depth = 0.0\nscene.frame_set(50)\nresult = True")
    scene.run(TOGGLE)
    wait_for_snow(scene, False)
    scene.run("scene.snowbough.end_depth = 0.3\nresult = True")
    wait_for_snow(scene, True)
    # From the side and nearly level, in the lee of a wall.
    scene.run(
        """
import math
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-6.0, 0.0, 3.0), scale=(0.1, 20.0, 6.0))
bpy.context.object.hide_select = True
scene.snowbough.fall_angle, scene.snowbough.bearing = math.radians(75.0), math.radians(90.0)
scene.snowbough.flutter = 0.0
scene.frame_set(50)
result = True
"""
    )
    wait_for_snow(scene, False)


def test_back_and_forth_shows_the_snow_of_then(scene):
    scene.run(
        """
for frame, rate in ((1, 0.0), (5, 0.0), (8, 1.0)):
    scene.snowbough.rate = rate
    scene.snowbough.keyframe_insert("rate", frame=frame)
scene.frame_set(1)
result = True
"""
    )
    scene.run(TOGGLE)
    wait_for_snow(scene, False)
    scene.run("[scene.frame_set(frame) for frame in range(2, 21)]\nresult = True")
    wait_for_snow(scene, True)
    scene.run("scene.frame_set(4)\nresult = True")
    wait_for_snow(scene, False)
    scene.run("scene.frame_set(20)\nresult = True")
    wait_for_snow(scene, True)


def test_undo_and_saving_go_on_beside_it(scene, tmp_path):
    """Undo brings back the frame, too, although no handler runs for it."""
    scene.run("scene.frame_set(50)\nresult = True")
    scene.run(TOGGLE)
    scene.run(
        """
ground = bpy.data.objects["Plane"]
ground.location.x = 20.0
bpy.ops.ed.undo_push(message="moved")
result = True
"""
    )
    wait_for_snow(scene, False)
    scene.run("with bpy.context.temp_override(window=view3d()[0]):\n    bpy.ops.ed.undo()\nresult = True")
    wait_for_snow(scene, True)
    path = str(tmp_path / "shot.blend")
    scene.run(f"bpy.ops.wm.save_as_mainfile(filepath={path!r})\nresult = True")
    wait_for_snow(scene, True)
    scene.run(f"bpy.ops.wm.open_mainfile(filepath={path!r})\nresult = True")
    assert scene.run("result = sorted(obj.name for obj in bpy.data.objects)") == ["Camera", "Light", "Plane"]
    assert scene.run(f"result = {STATE} is None")


def test_members_of_an_instanced_collection_and_wires_are_drawn(scene):
    scene.run(
        """
ground = bpy.data.objects["Plane"]
scene.snowbough.receivers.clear()
props = bpy.data.collections.new("Props")
ground.users_collection[0].objects.unlink(ground)
props.objects.link(ground)
empty = bpy.data.objects.new("Prop", None)
empty.instance_type, empty.instance_collection = "COLLECTION", props
scene.collection.objects.link(empty)
scene.snowbough.receivers.add().object = empty
scene.frame_set(50)
result = True
"""
    )
    scene.run(TOGGLE)
    wait_for_snow(scene, True)
    scene.run("view3d()[1].spaces.active.shading.type = 'WIREFRAME'\nresult = True")
    through = middle(scene)
    scene.run(TOGGLE)
    assert min(through) > max(middle(scene)) + 30
    scene.run("view3d()[1].spaces.active.shading.type = 'SOLID'\nresult = True")


def test_undo_back_into_the_preview_does_not_hide_a_bakes_modifier(scene):
    shown = "result = bpy.data.objects['Plane'].modifiers['Snowbough Displace'].show_viewport"
    scene.run(
        "bpy.data.objects['Plane'].modifiers.new('Snowbough Displace', 'DISPLACE').strength = 0.0\nresult = True"
    )
    scene.run(TOGGLE)
    assert scene.run(shown) is False
    scene.run("bpy.ops.ed.undo_push(message='while it runs')\nresult = True")
    scene.run(TOGGLE)
    assert scene.run(shown) is True
    scene.run(
        "bpy.data.objects['Plane'].location.z = 1.0\nbpy.ops.ed.undo_push(message='later')\nresult = True"
    )
    scene.run("with bpy.context.temp_override(window=view3d()[0]):\n    bpy.ops.ed.undo()\nresult = True")
    assert scene.run("result = bpy.data.objects['Plane'].location.z") == 0.0
    assert scene.run(shown) is True


def test_snow_is_as_thick_in_the_picture_as_its_map_says(scene):
    """Seen from the side, level: 0.1 m of it lie at frame 50, on ground at 0."""
    scene.run(
        """
from bpy_extras.view3d_utils import location_3d_to_region_2d
space = view3d()[1].spaces.active
space.region_3d.view_rotation = Quaternion((0.7071, 0.7071, 0.0, 0.0))
space.region_3d.view_distance = 0.5
scene.snowbough.flutter = 0.0
scene.snowbough.surface_relief = scene.snowbough.surface_hem_variation = 0.0
scene.frame_set(50)
result = True
"""
    )
    scene.run(TOGGLE)
    scene.wait_until(f"{STATE}.simulated is not None")
    x, ground, top, y, height = scene.run(
        """
area = view3d()[1]
region = next(region for region in area.regions if region.type == "WINDOW")
places = [location_3d_to_region_2d(region, space.region_3d, (0.0, 0.0, z)) for z in (0.0, 0.1)]
result = [region.x + places[0].x, places[0].y, places[1].y, region.y, region.height]
"""
    )
    screen = scene.screenshot("preview_thickness").convert("RGB")
    # The front of the snow is shaded; the background is far darker.
    column = [
        min(screen.getpixel((int(x) + 40, 900 - int(y + up)))) > 120 for up in range(1, int(height) - 90)
    ]
    seen = [up for up, snow in enumerate(column, 1) if snow]
    assert seen, "no snow to be seen"
    pixels = top - ground
    assert pixels > 60
    assert max(seen) == pytest.approx(top, abs=2 + 0.02 * pixels)
    # The hem hangs a little below the sheet's edge.
    assert ground - 0.15 * pixels < min(seen) < ground + 2 + 0.02 * pixels
