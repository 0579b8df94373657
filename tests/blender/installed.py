# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs a package as a user does, starts Blender again, imports a tree and bakes three frames of snow.

    python3 tests/blender/installed.py --blender BLENDER ZIP [OBJ]
    PYTHON_WITH_BPY tests/blender/installed.py ZIP [OBJ]

If all succeeds, the last line names the installed package and the snow depth, and the exit code is 0.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SHARED = HERE.parent.parent.parent / "shared" / "data" / "trees" / "tubes" / "AL06a.obj"
SMALL = HERE.parent / "data" / "small_maple.obj"
STEP, ZIP, OBJ, FOLDER = (f"SNOWBOUGH_INSTALLED_{name}" for name in ("STEP", "ZIP", "OBJ", "FOLDER"))


def install():
    import bpy
    import run

    run.install(Path(os.environ[ZIP]))
    bpy.ops.wm.save_userpref()


def bake():
    import bpy

    import addon_utils  # isort: skip: bpy brings it

    if not bpy.app.binary_path:  # a module, which starts with the factory's preferences
        addon_utils.enable("bl_ext.user_default.snowbough", default_set=True)
    name = next(name for name in bpy.context.preferences.addons.keys() if name.endswith("snowbough"))
    assert addon_utils.check(name) == (True, True), f"{name} is not enabled after the restart"
    native = sys.modules[f"{name}.base.native"]
    assert native.problem() == "", native.problem()
    module = native.load()
    bpy.ops.wm.read_homefile(use_empty=True)
    before = set(bpy.data.objects)
    bpy.ops.import_scene.xfrog_tree(filepath=os.environ[OBJ], max_bones=60)
    meshes = [obj for obj in bpy.data.objects if obj not in before and obj.type == "MESH"]
    import snow_scene

    snow_scene.receive(*meshes[:1], resolution=256)
    snow_scene.settings(Path(os.environ[FOLDER]) / "cache", frames=(1, 3), pixel_size=0.02)
    assert bpy.ops.snowbough.bake() == {"FINISHED"}
    maps = sorted(Path(os.environ[FOLDER]).rglob("height_*.exr"))
    deepest = module.read_exr(str(maps[-1]))[0].max()
    assert len(maps) == 3 and deepest > 0.05, (maps, deepest)
    print(
        f"installed: Blender {bpy.app.version_string}, Python {sys.version.split()[0]}: {name} with "
        f"{Path(module.__file__).name}; {len(meshes)} meshes, snow {deepest:.3f} m deep"
    )


def start(options, step, folder):
    import run

    environment = {
        **run.user_environment(folder),
        STEP: step,
        ZIP: str(options.zip.resolve()),
        OBJ: str(options.obj.resolve()),
        FOLDER: str(folder),
    }
    program = [sys.executable, __file__]
    if options.blender:
        program = [options.blender, "-b", "--python-exit-code", "1", "-P", __file__]
    return subprocess.run(program, env=environment, check=False).returncode


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--blender")
    parser.add_argument("zip", type=Path)
    parser.add_argument("obj", type=Path, nargs="?", default=SHARED if SHARED.is_file() else SMALL)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="snowbough-user-") as folder:
        return start(options, "install", Path(folder)) or start(options, "bake", Path(folder))


if __name__ == "__main__":
    sys.path.insert(0, str(HERE))
    if STEP not in os.environ:
        sys.exit(main())
    {"install": install, "bake": bake}[os.environ[STEP]]()
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender as a module may crash or wait for ever in its own handler at exit: 4.2.23 and 4.5.15 do.
    os._exit(0)
