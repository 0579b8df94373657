# SPDX-License-Identifier: GPL-3.0-or-later
"""After switching off and on, or reloading scripts, the code that runs is that on disk."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import bpy
import child
import pytest

import addon_utils  # isort: skip: bpy brings it

# Run in a Blender of its own with a copy of the add-on, whose files it changes.
PROGRAM = """
import json
import sys
from pathlib import Path
import bpy

def look():
    handlers = [function.__module__ for name in ("load_pre", "load_post", "save_pre", "save_post")
                for function in getattr(bpy.app.handlers, name)]
    return {
        "button": bpy.ops.snowbough.bake.get_rna_type().name,
        "setting": bpy.context.scene.snowbough.bl_rna.properties["end_depth"].name,
        "steps": sys.modules["snowbough.bake.job"].plan.PREROLL_STEPS,
        "resolution": sys.modules["snowbough.bake.plan"].MOST,
        "handlers": sorted(name for name in handlers if name.startswith("snowbough")),
        "menu": [draw.__module__ for draw in bpy.types.TOPBAR_MT_file_import.draw._draw_funcs
                 if draw.__module__.startswith("snowbough")],
        "outcome": sys.modules["snowbough.base.session"].last_outcome,
        "folders": len(bpy.utils.preset_paths("operator/import_scene.xfrog_tree")),
    }

def change(name, old, new):
    path = folder / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))

scripts = Path(SCRIPTS)
folder = scripts / "addons" / "snowbough"
change("bake/plan.py", "PREROLL_STEPS = 32", "from ..base.names import MAX_RESOLUTION as MOST\\nPREROLL_STEPS = 32")
bpy.ops.preferences.addon_enable(module="snowbough")
assert Path(sys.modules["snowbough"].__file__).parent == folder
sys.modules["snowbough.base.session"].last_outcome = ("INFO", "kept")
before = look()
# Of other lengths than before, since Python distinguishes compiled files by second and size.
change("ui/bake_operators.py", 'bl_label = "Bake Snow"', 'bl_label = "Bake Much Snow"')
change("settings/scene.py", '_depth("End Depth"', '_depth("Depth at the End"')
change("bake/plan.py", "PREROLL_STEPS = 32", "PREROLL_STEPS = 164")
change("base/names.py", "MAX_RESOLUTION = 8192", "MAX_RESOLUTION = 16384")
RELOAD
Path(RESULT).write_text(json.dumps([before, look()]))
"""

WAYS = {
    "switched off and on": """
bpy.ops.preferences.addon_disable(module="snowbough")
assert not hasattr(bpy.types.Scene, "snowbough")
bpy.ops.preferences.addon_enable(module="snowbough")
""",
    # As script.reload (F8), when no operator is running.
    "scripts reloaded": "bpy.utils.load_scripts(reload_scripts=True)",
}


@pytest.mark.parametrize("way", WAYS)
def test_changed_code_runs_after_a_reload(addon, tmp_path, way):
    source = Path(addon("cli").__file__).parent
    scripts, result = tmp_path / "scripts", tmp_path / "result.json"
    shutil.copytree(source, scripts / "addons" / "snowbough", ignore=shutil.ignore_patterns("__pycache__"))
    program = PROGRAM.replace("SCRIPTS", repr(str(scripts))).replace("RESULT", repr(str(result)))
    program = program.replace("RELOAD", WAYS[way])
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(scripts)}
    done = subprocess.run(
        child.command(program), env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stdout + done.stderr
    before, after = json.loads(result.read_text())
    assert (before["button"], before["setting"]) == ("Bake Snow", "End Depth")
    assert (before["steps"], before["resolution"]) == (32, 8192)
    assert (after["button"], after["setting"]) == ("Bake Much Snow", "Depth at the End")
    assert (after["steps"], after["resolution"]) == (164, 16384)
    # Nothing is registered twice, and the session's data is kept.
    assert len(before["handlers"]) >= 8 and before["menu"] == ["snowbough.ui.import_operators"]
    for name in ("handlers", "menu", "folders"):
        assert after[name] == before[name], name
    assert after["outcome"] == ["INFO", "kept"]


DISABLED = """
import sys
from pathlib import Path
import bpy
sys.path.insert(0, TESTS)
import snow_scene
bpy.ops.preferences.addon_enable(module="snowbough")
bpy.ops.wm.read_homefile(use_empty=True)
bpy.ops.preferences.addon_enable(module="snowbough")
snow_scene.receive(snow_scene.square("Ground"))
snow_scene.settings(Path(CACHE), frames=(1, 8))

def switch_off(scene, _depsgraph=None):
    if scene.frame_current == 4:
        bpy.app.handlers.frame_change_post.remove(switch_off)
        bpy.ops.preferences.addon_disable(module="snowbough")
        AGAIN

bpy.app.handlers.frame_change_post.append(switch_off)
try:
    bpy.ops.snowbough.bake()
except RuntimeError as error:
    print(error)
print("the script goes on")
bpy.context.scene.frame_set(2)
"""


@pytest.mark.parametrize("again", ["pass", 'bpy.ops.preferences.addon_enable(module="snowbough")'])
def test_the_add_on_may_be_switched_off_in_the_middle_of_a_bake(addon, tmp_path, again):
    source, scripts = Path(addon("cli").__file__).parent, tmp_path / "scripts"
    shutil.copytree(source, scripts / "addons" / "snowbough", ignore=shutil.ignore_patterns("__pycache__"))
    program = DISABLED.replace("TESTS", repr(str(Path(__file__).parent))).replace("AGAIN", again)
    program = program.replace("CACHE", repr(str(tmp_path / "cache")))
    if not bpy.app.binary_path:
        pytest.skip("needs a Blender program")
    if not addon("base.native").module_file():
        pytest.skip("an extension's folder does not contain its module")
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(scripts)}
    done = subprocess.run(
        child.command(program), env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stdout + done.stderr
    assert "the script goes on" in done.stdout
    assert list(tmp_path.glob("cache/*/v001/*/height_0003.exr"))
    assert not list(tmp_path.glob("cache/*/v001/*/height_0008.exr"))


def test_blender_finds_nothing_that_extensions_may_not_do(addon):
    """What its list of add-ons shows as violations of its policies, from 4.2 on."""
    if not hasattr(addon_utils, "_extensions_warnings_get"):
        pytest.skip("this Blender has no policies")
    native = addon("base.native").load()
    addon_utils._extensions_warnings_get._is_first = True
    found = addon_utils._extensions_warnings_get().get(os.environ["SNOWBOUGH_TEST_ADDON"], [])
    if Path(native.__file__).parent.name == "lib":  # the package of a checkout has no wheel
        found.remove("Policy violation with top level module: snowbough_native")
    assert found == []
