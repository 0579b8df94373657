# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of against_commit.py that runs inside Blender: makes a shot, or bakes it and measures the time.

    blender -b --factory-startup -P in_blender.py -- make CHECKOUT SHOT FILE.blend [--tree FILE.obj]
        [--tree-options JSON]
    blender -b --factory-startup FILE.blend -P in_blender.py -- bake CHECKOUT TIMES.json [--only-deposit]
        [--first-frame]

It uses only names that the add-on has had since its first bake, so it works with any checkout. Shots: `monkey-SIZE`,
which turns once in 24 frames, with maps of SIZE; `tree`, TREE imported with the given options and swaying, one map of
1024, 12 frames; `demo`, the checkout's own demo with TREE.
"""

import argparse
import json
import math
import sys
import tempfile
import time
from pathlib import Path

import bpy

MONKEY_FRAMES, TREE_FRAMES, TREE_RESOLUTION = 24, 12, 1024


def add_receiver(receiver, resolution):
    bpy.ops.object.select_all(action="DESELECT")
    receiver.select_set(True)
    bpy.context.view_layer.objects.active = receiver
    bpy.ops.snowbough.add_receivers()
    bpy.context.scene.snowbough.receivers[0].resolution = resolution


def make_monkey(size):
    """1,968 faces, unwrapped without overlaps."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, MONKEY_FRAMES
    bpy.ops.mesh.primitive_monkey_add(size=2.0)
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    monkey.data.uv_layers.remove(monkey.data.uv_layers[0])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=0.004)
    bpy.ops.object.mode_set(mode="OBJECT")
    for frame, angle in ((1, 0.0), (MONKEY_FRAMES, 6.28)):
        monkey.rotation_euler.z = angle
        monkey.keyframe_insert("rotation_euler", frame=frame)
    add_receiver(monkey, size)


def make_tree(path, options):
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, TREE_FRAMES
    bpy.ops.import_scene.xfrog_tree(filepath=path, **options)
    armature = next(each for each in bpy.data.objects if each.type == "ARMATURE")
    bark = next(each for each in bpy.data.objects if each.name.endswith("_bark"))
    bpy.ops.object.select_all(action="DESELECT")
    armature.select_set(True)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.snowbough.add_sway()
    add_receiver(bark, TREE_RESOLUTION)


def make_demo(checkout, path):
    """Prepares the checkout's demo up to its bake."""
    sys.path.insert(0, str(checkout / "blend_samples"))
    import demo
    import demo_scene

    stage = demo_scene.build_stage()
    _, meshes, _ = demo.import_tree(Path(path))
    demo.clothe(meshes)
    bark = next(mesh for mesh in meshes if mesh.name.endswith("_bark"))
    demo.prepare_snowfall([bark, stage.ground, stage.bench, stage.cart], stage.backdrop)


def make(given):
    bpy.ops.wm.read_homefile(use_empty=True)
    if given.shot.startswith("monkey-"):
        make_monkey(int(given.shot.partition("-")[2]))
    elif given.shot == "tree":
        make_tree(given.tree, json.loads(given.tree_options))
    else:
        make_demo(given.checkout, given.tree)
    for entry in bpy.context.scene.snowbough.receivers:
        print(
            f"{given.shot}: {entry.object.name}, {len(entry.object.data.polygons)} faces, {entry.resolution}"
        )
    bpy.ops.wm.save_as_mainfile(filepath=str(given.file))


def set_only_deposit(settings):
    """Switches off the features that the first bakes did not have: see against_commit.py."""
    settings.flutter = 0.0
    if hasattr(settings, "repose"):
        settings.repose = math.radians(90.0)


def bake(given):
    scene = bpy.context.scene
    settings = scene.snowbough
    if given.only_deposit:
        set_only_deposit(settings)
    if given.first_frame:
        scene.frame_end = scene.frame_start
        scene.animation_data_clear()  # of the rate, which may begin with 0
        settings.rate = 1.0
    with tempfile.TemporaryDirectory() as folder:
        settings.cache_directory = folder
        began = time.perf_counter(), time.process_time()
        bpy.ops.snowbough.bake()
        times = {"wall": time.perf_counter() - began[0], "processor": time.process_time() - began[1]}
        written = len(list(Path(folder).rglob("height_*.exr")))
        # Missing if the add-on did not log its engine.
        engines = [line for log in Path(folder).rglob("*.log") for line in log.read_text().splitlines()]
    wanted = (scene.frame_end - scene.frame_start + 1) * len(settings.receivers)
    assert written == wanted, f"{written} maps instead of {wanted}"
    times["engine"] = engines[0] if engines else ""
    Path(given.file).write_text(json.dumps(times))


def main():
    parser = argparse.ArgumentParser(prog="in_blender.py")
    verbs = parser.add_subparsers(dest="verb", required=True)
    for name in ("make", "bake"):
        verb = verbs.add_parser(name)
        verb.add_argument("checkout", type=Path)
        if name == "make":
            verb.add_argument("shot")
            verb.add_argument("--tree")
            verb.add_argument("--tree-options", default="{}")
        else:
            verb.add_argument("--only-deposit", action="store_true")
            verb.add_argument("--first-frame", action="store_true")
        verb.add_argument("file", type=Path)
    given = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    sys.path.insert(0, str(given.checkout / "addon"))
    import snowbough

    snowbough.register()
    {"make": make, "bake": bake}[given.verb](given)


main()
