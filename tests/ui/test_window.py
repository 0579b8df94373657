# SPDX-License-Identifier: GPL-3.0-or-later
"""The menu entry, the panels, a bake from the button while the window lives, Esc, and a silent console."""

from snow_shot import SNOW_SCENE, START, heights, wait_for_heights

RECORD_OPERATORS = """
class Recorder:
    def __init__(self):
        self.operators = []

    def operator(self, name, **_):
        self.operators.append(name)
        return type("Properties", (), {})()

    def __getattr__(self, _):
        return lambda *arguments, **named: self


class Menu:
    layout = Recorder()


for draw in bpy.types.TOPBAR_MT_file_import.draw._draw_funcs:
    if draw.__module__.startswith(addon):
        draw(Menu, bpy.context)
result = Menu.layout.operators
"""

KEEP_JOB = "job = __import__('sys').modules[addon + '.base.session'].bake.job\nresult = True"


def test_file_import_offers_the_tree(window):
    assert window.run(RECORD_OPERATORS) == ["import_scene.xfrog_tree"]
    # The File menu stands at the left of the top bar; the letter opens its submenu.
    window.click(46, 13)
    window.wait_for_menu((60, 130, 220, 440))
    window.key("i")
    window.wait_for_menu((240, 310, 440, 480))
    window.screenshot("import_menu")
    window.key("Escape")
    window.key("Escape")


def test_sidebar_tab_shows_the_quick_actions(window):
    window.open_sidebar_tab()
    window.screenshot("sidebar")
    assert window.find_button("snowbough.add_receivers") is not None


def test_scene_properties_show_the_settings(window):
    shown = window.properties_panels("SCENE")
    window.screenshot("scene_properties")
    assert {"SNOWBOUGH_PT_scene", "SNOWBOUGH_PT_receivers", "SNOWBOUGH_PT_snowfall"} <= set(shown)


def test_physics_properties_show_the_object(window):
    shown = window.properties_panels("PHYSICS")
    window.screenshot("physics_properties")
    assert shown == ["SNOWBOUGH_PT_object"]


def test_a_bake_from_the_button_ends_with_its_files(window, tmp_path):
    assert window.run(SNOW_SCENE.format(frames=4, resolution=256, path=str(tmp_path / "shot.blend"))) == 2
    window.open_sidebar_tab()
    window.press_button("snowbough.bake")
    wait_for_heights(tmp_path, 8)
    window.wait_for_bake()
    assert [path.name for path in heights(tmp_path)] == [
        f"height_{frame:04d}.exr" for frame in (1, 2, 3, 4)
    ] * 2
    # It began on the first frame, where there is next to no snow to be seen.
    assert window.run("result = bpy.context.scene.frame_current") == 4
    window.screenshot("bake_done")


def test_esc_stops_a_bake_and_the_window_stays_alive(window, tmp_path):
    frames = 2000
    window.run(SNOW_SCENE.format(frames=frames, resolution=512, path=str(tmp_path / "shot.blend")))
    window.open_sidebar_tab()
    window.press_button("snowbough.bake")
    # The first seconds go into laying out the maps and, with OpenGL, compiling shaders.
    wait_for_heights(tmp_path, 4)
    # Each answer is a turn of the event loop.
    for _ in range(20):
        assert window.run("result = bpy.app.is_job_running('RENDER')")
    window.screenshot("bake_running")

    window.run(KEEP_JOB)
    window.key("Escape")
    computed = window.run("result = len(job.results)")
    window.wait_for_bake()
    # The frames that were begun when the key was handled: one is computed while the next one is evaluated.
    assert len(heights(tmp_path)) <= 2 * (computed + 2)
    assert list(tmp_path.rglob("*.part")) == []
    window.screenshot("bake_stopped")


def test_a_bake_in_the_window_prints_nothing(window, tmp_path):
    window.run(SNOW_SCENE.format(frames=4, resolution=256, path=str(tmp_path / "shot.blend")))
    window.open_sidebar_tab()
    window.properties_panels("SCENE")
    since = len(window.printed(0))
    window.run(START)
    window.wait_for_bake()
    assert len(heights(tmp_path)) == 8
    assert window.printed(since) == ""
