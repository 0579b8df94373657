# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree for a game engine: imported, with 16 frames of snow, exported with its levels of detail and an atlas of its
snow.

    blender -b --factory-startup --python-exit-code 1 -P blend_samples/engine_files.py -- TREE.obj FOLDER

Writes to FOLDER: tree.glb, the snow's images, tree.blend and the bake. benchmarks/tree/engine_sheet.py draws tree.glb.
"""

import sys
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "addon"))

import snowbough  # noqa: E402

FRAMES = 16
ATLAS_FRAMES = 4
END_DEPTH = 0.08


def main(tree, folder):
    snowbough.register()
    bpy.ops.wm.read_homefile(use_empty=True)
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.import_scene.xfrog_tree(filepath=str(tree), height=5.0)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "tree.blend"))
    bark = bpy.context.object
    for obj in bpy.context.selected_objects:
        obj.select_set(obj.type == "MESH")
    bpy.ops.snowbough.add_receivers()
    settings = scene.snowbough
    settings.cache_directory = str(folder / "snow")
    settings.end_depth = END_DEPTH
    settings.write_normals = True
    bpy.ops.snowbough.bake()
    bpy.context.view_layer.objects.active = bark
    bpy.ops.export_scene.snowbough_tree(
        filepath=str(folder / "tree.glb"), levels=4, snow="ATLAS", atlas_frames=ATLAS_FRAMES
    )
    bpy.ops.wm.save_mainfile()


if __name__ == "__main__":
    main(*(Path(argument).resolve() for argument in sys.argv[sys.argv.index("--") + 1 :]))
