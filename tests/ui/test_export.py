# SPDX-License-Identifier: GPL-3.0-or-later
"""Export through the file browser and its options; the menu has an entry."""

from test_import import BROWSER, MAPLE

OPEN_BROWSER = """
bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
window, area = view3d()
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.export_scene.snowbough_tree("INVOKE_DEFAULT")
result = True
"""

CHOOSE = """
window, area = browser()
options = area.spaces.active.active_operator
options.levels, options.cards, options.texture_size = 2, False, 0
params = area.spaces.active.params
params.directory, params.filename = {folder!r}.encode(), "maple.gltf"
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.file.execute()
result = True
"""


def test_a_tree_is_exported_through_the_file_browser(window, tmp_path):
    window.run(BROWSER)
    window.run(f"bpy.ops.import_scene.xfrog_tree(filepath={str(MAPLE)!r}, max_bones=50)\nresult = True")
    window.run(OPEN_BROWSER)
    window.wait_until("browser()[1] is not None and browser()[1].spaces.active.params is not None")
    window.screenshot("export_browser")
    assert window.run("result = browser()[1].spaces.active.params.filename") == "small_maple.glb"
    window.run(CHOOSE.format(folder=str(tmp_path)))
    window.wait_until(f"__import__('os').path.exists({str(tmp_path / 'maple.gltf')!r})")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["maple.bin", "maple.gltf"]
    assert '"small_maple_bark_LOD1"' in (tmp_path / "maple.gltf").read_text()
