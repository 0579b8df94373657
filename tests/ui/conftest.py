# SPDX-License-Identifier: GPL-3.0-or-later
"""One Blender window for all the tests of this folder; each starts from the default scene."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import window as ui  # noqa: E402

# The grid and the outline of the selection take half of the time in which software draws the window.
FAST_VIEW = """
overlay = view3d()[1].spaces.active.overlay
overlay.show_floor = overlay.show_axis_x = overlay.show_axis_y = overlay.show_outline_selected = False
result = True
"""


@pytest.fixture(scope="session")
def addon_zip():
    return ui.addon_zip()


@pytest.fixture(scope="session")
def blender(addon_zip, tmp_path_factory):
    window = ui.BlenderWindow(tmp_path_factory.mktemp("ui"), addon_zip)
    yield window
    window.close()


@pytest.fixture
def window(blender):
    blender.restart_if_ended()
    # Blender 4.3's first window with Vulkan on a busy processor may not answer for a minute, with hardly any work done.
    blender.run(f"bpy.ops.wm.read_homefile(app_template='')\n{FAST_VIEW}", timeout=300)
    return blender


@pytest.fixture(autouse=True)
def nothing_failed_behind_the_window(blender):
    """Blender only prints exceptions of panels: checks its output after every test."""
    before = len(blender.messages())
    yield
    assert "Traceback" not in blender.messages()[before:]
