# SPDX-License-Identifier: GPL-3.0-or-later
"""An import through the file browser: its options under headings, Adjust Last Operation and undo."""

import pytest
from window import ROOT

MAPLE = ROOT / "tests" / "data" / "small_maple.obj"

OPEN_BROWSER = """
bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
window, area = view3d()
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.import_scene.xfrog_tree("INVOKE_DEFAULT")
result = True
"""

BROWSER = """
def browser():
    window = bpy.context.window_manager.windows[0]
    area = next((area for area in window.screen.areas if area.type == "FILE_BROWSER"), None)
    return window, area
result = True
"""

CHOOSE = """
window, area = browser()
params = area.spaces.active.params
params.directory = {folder!r}.encode()
params.filename = {name!r}
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.file.execute()
result = True
"""

LOOK = """
result = [
    sorted(collection.name for collection in bpy.data.collections if collection.name != "Collection"),
    sum(len(obj.data.polygons) for obj in bpy.data.objects if obj.name.endswith("_bark")),
    [operator.bl_idname for operator in bpy.context.window_manager.operators][-1:],
]
"""

# What the panel Adjust Last Operation does when an option is changed there.
ADJUST = """
window, area = view3d()
region = next(region for region in area.regions if region.type == "WINDOW")
last = bpy.context.window_manager.operators[-1]
last.properties.detail = {detail!r}
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)  # with its step to undo, as the panel leaves it
result = True
"""


@pytest.fixture
def browser(window):
    """The import's file browser, over the whole window."""
    window.run(BROWSER)
    window.run(OPEN_BROWSER)
    window.wait_until("browser()[1] is not None and browser()[1].spaces.active.params is not None")
    return window


def import_from(browser, folder, name, trees):
    browser.run(CHOOSE.format(folder=str(folder), name=name))
    browser.wait_until(
        f"len([c for c in bpy.data.collections if c.name != 'Collection']) == {trees} "
        "and bpy.context.window_manager.operators"
    )
    return browser.run(LOOK)


def test_options_stand_in_panels_beside_the_file_browser(browser):
    shown = browser.run(
        """
window, area = browser()
operator = area.spaces.active.active_operator
from importlib import import_module
panels = import_module(addon + ".ui.import_panels").CLASSES
with bpy.context.temp_override(window=window, area=area):
    result = [operator.bl_idname, [panel.bl_label for panel in panels if panel.poll(bpy.context)]]
"""
    )
    browser.screenshot("import_browser")
    assert shown == ["IMPORT_SCENE_OT_xfrog_tree", ["File", "Surface", "Bones", "Foliage", "Maps and Extras"]]
    browser.move(500, 500)
    browser.key("Escape")
    browser.wait_until("browser()[1] is None")


def test_an_import_can_be_adjusted_afterwards_and_is_one_step_to_undo(browser):
    trees, faces, last = import_from(browser, MAPLE.parent, MAPLE.name, 1)
    assert (trees, last) == (["small_maple"], ["SNOWBOUGH_OT_import_tree_job"])
    browser.screenshot("import_done")
    browser.run(ADJUST.format(detail="DRAFT"))
    trees, fewer, _ = browser.run(LOOK)
    assert trees == ["small_maple"] and fewer < faces
    browser.run(ADJUST.format(detail="DEFAULT"))
    assert browser.run(LOOK)[:2] == [["small_maple"], faces]
    browser.move(500, 500)
    browser.key("ctrl+z")
    browser.wait_until("not [c for c in bpy.data.collections if c.name != 'Collection']")
    assert browser.run("result = sorted(obj.name for obj in bpy.data.objects)") == ["Camera", "Cube", "Light"]


def test_a_folder_is_imported_where_no_file_is_chosen(browser, tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.obj").write_bytes(MAPLE.read_bytes())
    trees, _, _ = import_from(browser, tmp_path, "", 2)
    assert trees == ["one", "two"]
