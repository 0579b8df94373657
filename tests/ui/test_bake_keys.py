# SPDX-License-Identifier: GPL-3.0-or-later
"""Actions of an artist or another add-on during a bake do no harm, and the bake can be resumed."""

import pytest
from PIL import ImageChops, ImageStat
from snow_shot import START, assert_resumable, bake_in_the_background, make_long_shot, wait_for_heights
from window import BlenderWindow, wait_for


def change(before, after):
    return ImageStat.Stat(ImageChops.difference(before, after).convert("L")).mean[0]


def test_the_view_is_drawn_and_can_be_turned_while_a_bake_runs(window, tmp_path):
    bake_in_the_background(window, tmp_path, substeps=4)
    before = window.view()
    assert ImageStat.Stat(before.convert("L")).mean[0] > 30
    window.move(500, 500)
    for _ in range(4):
        window.xdotool("click", "4")
    wait_for(lambda: change(before, window.view()) > 1, "another view")
    assert ImageStat.Stat(window.view().convert("L")).mean[0] > 30
    window.key("Escape")
    window.wait_for_bake()


def test_keys_that_edit_do_nothing_while_a_bake_runs_and_the_button_stops_it(window, tmp_path):
    window.open_sidebar_tab()
    bake_in_the_background(window, tmp_path)
    state = (
        "result = [sorted(o.name for o in bpy.data.objects), bpy.context.mode, "
        "len(bpy.context.scene.snowbough.receivers)]"
    )
    before = window.run(state)
    window.move(500, 500)
    for key in ("ctrl+z", "x", "Return", "Delete", "Tab", "ctrl+s", "shift+d"):
        window.key(key)
    window.click(60, 13)
    assert window.run(state) == before
    assert window.run("result = bpy.app.is_job_running('RENDER')")
    window.press_button("snowbough.stop_bake")
    window.wait_for_bake()
    assert window.run("result = bpy.context.scene.render.engine") == "BLENDER_EEVEE"
    assert_resumable(window, tmp_path)
    # The lock has gone with the bake.
    window.move(500, 500)
    window.key("Tab")
    window.wait_until("bpy.context.mode == 'EDIT_MESH'")
    window.key("Tab")


def test_undo_after_a_bake_does_not_harm_its_files(window, tmp_path):
    bake_in_the_background(window, tmp_path)
    window.key("Escape")
    window.wait_for_bake()
    window.move(500, 500)
    window.key("ctrl+z")
    window.key("ctrl+shift+z")
    assert window.run("result = len(bpy.context.scene.snowbough.receivers)") == 2
    assert_resumable(window, tmp_path)


# What other add-ons may try meanwhile. Blender refuses most of it while an engine renders; what it lets
# through has to end well.
SCRIPTS = {
    "undo": "bpy.ops.ed.undo_push(message='Now')\n    bpy.ops.ed.undo()",
    "reload": "bpy.ops.wm.revert_mainfile()",
    "delete": "bpy.data.objects.remove(bpy.data.objects['Cube'])",
    "switch_off": "bpy.ops.preferences.addon_disable(module=addon)",
}


@pytest.mark.parametrize("script", sorted(SCRIPTS))
def test_a_script_in_the_middle_of_a_bake_does_no_harm(window, tmp_path, script):
    bake_in_the_background(window, tmp_path)
    outcome = window.run(
        f"""
try:
    {SCRIPTS[script]}
    result = "done"
except RuntimeError as error:
    result = str(error)
""",
        timeout=120,
    )
    print(script, outcome)
    assert outcome == "done" or "can't modify blend data" in outcome
    window.settle()
    if window.run("result = bpy.app.is_job_running('RENDER')"):
        window.key("Escape")
    window.wait_for_bake()
    assert window.run("result = bpy.context.scene.render.engine") == "BLENDER_EEVEE"
    window.run(
        "addon in bpy.context.preferences.addons or bpy.ops.preferences.addon_enable(module=addon)\nresult = 1"
    )
    window.run(f"bpy.ops.wm.open_mainfile(filepath={str(tmp_path / 'shot.blend')!r})\nresult = True")
    if script == "delete" and outcome == "done":  # then the frames since lack the object, and Resume says so
        assert [
            path.name for path in tmp_path.rglob("*") if path.name.startswith("lock") or ".tmp" in path.name
        ] == []
        return
    assert_resumable(window, tmp_path)


# The cube is in a collection that only a second view layer shows.
TWO_LAYERS = """
scene = bpy.context.scene
effects = bpy.data.collections.new("Effects")
scene.collection.children.link(effects)
cube = bpy.data.objects["Cube"]
for collection in list(cube.users_collection):
    collection.objects.unlink(cube)
effects.objects.link(cube)
scene.view_layers.new("FX")
bpy.context.window.view_layer = scene.view_layers["ViewLayer"]
scene.view_layers["ViewLayer"].layer_collection.children["Effects"].exclude = True
bpy.ops.ed.undo_push(message="Layers")
bpy.ops.wm.save_mainfile()
result = True
"""
LAYERS = "result = [(layer.name, layer.use) for layer in bpy.context.scene.view_layers]"


def test_the_view_layers_are_as_before_after_an_undo_in_the_middle_of_a_bake(window, tmp_path):
    make_long_shot(window, tmp_path)
    window.run(TWO_LAYERS)
    before = window.run(LAYERS)
    window.run(START)
    wait_for_heights(tmp_path, 6)
    assert len(window.run(LAYERS)) == 3
    window.run(f"try:\n    {SCRIPTS['undo']}\nexcept RuntimeError:\n    pass\nresult = True", timeout=120)
    window.settle()
    if window.run("result = bpy.app.is_job_running('RENDER')"):
        window.key("Escape")
    window.wait_for_bake()
    assert window.run(LAYERS) == before


def test_quitting_ends_the_bake_and_leaves_it_resumable(window, addon_zip, tmp_path):
    (tmp_path / "user").mkdir()
    other = BlenderWindow(tmp_path / "user", addon_zip, log="quit.log")
    try:
        (tmp_path / "shot").mkdir()
        bake_in_the_background(other, tmp_path / "shot")
        other.move(500, 500)
        other.xdotool("key", "ctrl+q")
        wait_for(lambda: other.blender.poll() is not None, "the end of Blender")
        assert other.blender.returncode == 0
        assert "Traceback" not in other.messages()
    finally:
        other.close()
    window.run(f"bpy.ops.wm.open_mainfile(filepath={str(tmp_path / 'shot' / 'shot.blend')!r})\nresult = True")
    assert_resumable(window, tmp_path / "shot")


# -- keys that would replace the scene -----------------------------------------------------------------

# Blender has no keys for these two: F8 and F9 get them, as an artist may do in the preferences.
KEYS = """
keymap = bpy.context.window_manager.keyconfigs.user.keymaps["Window"]
made = [
    keymap.keymap_items.new("wm.revert_mainfile", "F8", "PRESS"),
    keymap.keymap_items.new("preferences.addon_disable", "F9", "PRESS"),
]
made[1].properties.module = addon
bpy.context.preferences.view.use_save_prompt = False
result = True
"""
# Data that must not remain after a bake: its engine, its camera, its threads, its lock.
LEFT = """
import os
import threading
result = [
    [cls.__name__ for cls in bpy.types.RenderEngine.__subclasses__()
     if "bl_rna" in cls.__dict__ and cls.bl_idname == "SNOWBOUGH_BAKE"],
    [camera.name for camera in bpy.data.cameras if camera.name.startswith("Snowbough")],
    [thread.name for thread in threading.enumerate() if thread.name.startswith("snowbough")],
    bpy.context.scene.render.engine == "SNOWBOUGH_BAKE",
]
"""


@pytest.fixture
def keys(window):
    window.run(KEYS)
    yield
    window.run("for item in made:\n    keymap.keymap_items.remove(item)\nresult = True")


def begin_with_keys(window, folder):
    """A bake of a scene whose last step, after saving, moved the cube; the pointer is over the 3D view."""
    make_long_shot(window, folder)
    window.run(
        "cube = bpy.data.objects['Cube']\n"
        "bpy.ops.ed.undo_push(message='Scene')\n"
        "bpy.ops.object.select_all(action='DESELECT')\n"
        "cube.select_set(True)\nbpy.context.view_layer.objects.active = cube\ncube.location.x = 1.0\n"
        "bpy.ops.ed.undo_push(message='Move')\nresult = True"
    )
    window.run(START)
    wait_for_heights(folder, 6)
    window.move(500, 500)


def stop(window):
    window.key("Escape")
    window.wait_for_bake()
    window.wait_until("'Snowbough Bake Camera' not in bpy.data.cameras")
    wait_for(lambda: window.run(LEFT) == [[], [], [], False], "no trace of the bake")


SCENE_NOW = "result = [bpy.data.objects['Cube'].location.x, addon in bpy.context.preferences.addons]"


def test_reload_delete_undo_and_switching_off_wait_for_the_end_of_the_bake(window, keys, tmp_path):
    begin_with_keys(window, tmp_path)
    for key in ("F8", "Return", "ctrl+z", "Delete", "F9", "ctrl+o"):
        window.key(key)
    assert window.run(SCENE_NOW) == [1.0, True]
    assert window.run("result = [len(w.screen.areas) for w in bpy.context.window_manager.windows][1:]") == []
    assert window.run("result = bpy.app.is_job_running('RENDER')")
    stop(window)
    assert_resumable(window, tmp_path)

    # The same keys work now, one after the other.
    window.move(500, 500)
    window.key("Delete")
    window.wait_until("'Cube' not in bpy.data.objects or not bpy.data.objects['Cube'].users_scene")
    window.key("ctrl+z")
    window.wait_until("'Cube' in bpy.context.scene.objects")
    for _ in range(4):  # the bake, what the test resumed, and the move
        if window.run("result = bpy.data.objects['Cube'].location.x") == 0.0:
            break
        window.key("ctrl+z")
    assert window.run(SCENE_NOW) == [0.0, True]
    assert window.run("bpy.data.objects['Cube'].location.x = 2.0\nresult = True")
    window.key("F8")
    window.screenshot("revert")
    window.key("Return")
    window.wait_until("bpy.data.objects['Cube'].location.x == 0.0")
    window.move(500, 500)
    window.key("F9")
    window.wait_until("addon not in bpy.context.preferences.addons")
    window.run("bpy.ops.preferences.addon_enable(module=addon)\nresult = True")
    assert window.run("result = len(bpy.context.scene.snowbough.receivers)") == 2
