# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo from end to end, inside Blender in the background.

    blender -b --factory-startup --python-exit-code 1 -P blend_samples/demo.py -- TREE.obj FOLDER

Imports the tree, rigs it, lets it sway, and puts it on the stage of demo_scene.py. Bakes 48 frames of snow on bark,
ground, bench and cart with 1024 x 1024 maps, adds the result to the scene, and renders five frames and a fork from
close by. Writes to FOLDER: snowbough.blend, the EXR sequences in snowbough_cache, frame_NNNN.png, close_up.png, and
demo.json for contact_sheet.py. Uses only the add-on's operators, as an artist does.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "blend_samples"), str(ROOT / "addon")]

import demo_scene  # noqa: E402  (both folders are known from here on)
import snowbough  # noqa: E402

RESOLUTION, WHEEL_RESOLUTION = 1024, 256
RENDERED_FRAMES = (1, 12, 22, 34, 48)
CLOSE_UP_SAMPLES = 24
# Offset of the close-up camera from the fork, in metres.
CLOSE_UP = Vector((-0.42, -0.85, 0.05))
# (frame, strength): no snow at first, then full strength, then little while the cart leaves its dry patch.
SNOWFALL = ((1, 0.0), (6, 1.0), (29, 1.0), (38, 0.06), (48, 0.03))
END_DEPTH = 0.12
RELIEF = 0.6
# The stage suits a tree of this height and this radius, in metres.
TREE_HEIGHT, TREE_REACH = 6.0, 3.6


def say(message):
    print(f"demo: {message}", flush=True)


def import_tree(path):
    """Imports the tree, lets it sway and fits it to the stage. Returns (armature, list of its meshes)."""
    before = set(bpy.data.objects)
    started = time.perf_counter()
    # Every joint of the export, for the flare at the root.
    bpy.ops.import_scene.xfrog_tree(filepath=str(path), simplify="NONE")
    seconds = time.perf_counter() - started
    new = [candidate for candidate in bpy.data.objects if candidate not in before]
    armature = next(candidate for candidate in new if candidate.type == "ARMATURE")
    meshes = [candidate for candidate in new if candidate.type == "MESH"]
    bark = next(mesh for mesh in meshes if mesh.name.endswith("_bark"))
    say(
        f"imported {path.name} in {seconds:.2f} s: {len(armature.data.bones)} bones, "
        f"{len(bark.data.vertices)} vertices, {len(bark.data.polygons)} faces"
    )

    points = np.empty(len(bark.data.vertices) * 3, dtype=np.float32)
    bark.data.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    foot = points[points[:, 2] < low[2] + 0.02 * (high[2] - low[2])].mean(axis=0)
    reach = np.abs(points[:, :2] - foot[:2]).max()
    fit = float(min(TREE_HEIGHT / (high[2] - low[2]), TREE_REACH / reach))
    armature.scale = (fit, fit, fit)
    # The ground is not level: the tree stands a little inside it.
    armature.location = (-fit * foot[0], -fit * foot[1], -fit * low[2] - 0.04)

    bpy.ops.object.select_all(action="DESELECT")
    armature.select_set(True)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.snowbough.add_sway()
    return armature, meshes, seconds


def strength(frame):
    """How hard it snows in a frame, 0 to 1."""
    return float(np.interp(frame, *zip(*SNOWFALL)))


def depth_of(frame):
    """Snow on open level ground after a frame, in metres."""
    fallen = np.cumsum([strength(each) for each in range(1, demo_scene.FRAMES + 1)])
    return END_DEPTH * float(fallen[frame - 1] / fallen[-1])


def list_receivers(receivers):
    """Puts objects on the scene's list of receivers; returns the scene's settings."""
    bpy.ops.object.select_all(action="DESELECT")
    for receiver in receivers:
        receiver.select_set(True)
    bpy.context.view_layer.objects.active = receivers[0]
    bpy.ops.snowbough.add_receivers()
    return bpy.context.scene.snowbough


def prepare_snowfall(receivers, backdrop):
    """Puts the receivers on the scene's list and says how it snows."""
    settings = list_receivers(receivers)
    for entry in settings.receivers:
        entry.resolution = WHEEL_RESOLUTION if entry.object.name.startswith("wheel") else RESOLUTION
    for scenery in backdrop:
        scenery.snowbough.occlude = False
    settings.end_depth = END_DEPTH
    for frame in range(1, demo_scene.FRAMES + 1):
        settings.rate = strength(frame)
        settings.keyframe_insert("rate", frame=frame)
    # From the left: windward sides become white, lee sides keep their material.
    settings.fall_angle = np.radians(14.0)
    settings.bearing = np.radians(70.0)
    settings.pixel_size = 0.016
    settings.seed = 7
    # More relief looks rough in the light of the low sun.
    settings.surface_relief = RELIEF


def simplify_snow():
    """Snow that few samples render without noise: no light inside it and no glitter."""
    for material in bpy.data.materials:
        if material.node_tree is None:
            continue
        for node in material.node_tree.nodes:
            if node.type == "GROUP" and node.node_tree and node.node_tree.name.startswith("Snowbough Snow"):
                node.inputs["Subsurface"].default_value = 0.0
                node.inputs["Sparkle"].default_value = 0.0


def close_up(armature, camera):
    """A camera close to a fork of the lower crown on the side of `camera`."""
    bones = armature.data.bones
    at_forks = [
        bone for bone in bones if bone.parent and bone.name.split(".")[0] != bone.parent.name.split(".")[0]
    ]
    # A tree of one limb has no fork: use any joint.
    forks = [armature.matrix_world @ bone.head_local for bone in at_forks or bones]
    top = max(fork.z for fork in forks)
    low = [fork for fork in forks if 0.3 * top < fork.z < 0.6 * top] or forks
    fork = min(low, key=lambda fork: (fork - camera.location).length)
    return demo_scene.make_camera(bpy.context.scene, "close up", fork + CLOSE_UP, fork, focal_length=50.0)


def render(name):
    scene = bpy.context.scene
    scene.render.filepath = str(name)
    bpy.ops.render.render(write_still=True)


def rig_for_the_sheet(armature):
    """Bones in the world at rest: [[head, tail, depth in the hierarchy], ...]."""
    world = armature.matrix_world
    bones = []
    for bone in armature.data.bones:
        level = bone.name.split(".")[0].rstrip("0123456789")
        bones.append([list(world @ bone.head_local), list(world @ bone.tail_local), level])
    return bones


def main(tree, folder):
    started = time.perf_counter()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    stage = demo_scene.build_stage()
    armature, meshes, import_seconds = import_tree(tree)
    bark = next(mesh for mesh in meshes if mesh.name.endswith("_bark"))
    prepare_snowfall([bark, stage.ground, stage.bench, stage.cart, *stage.wheels], stage.backdrop)
    blend = folder / "snowbough.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)

    say(
        f"baking {demo_scene.FRAMES} frames of snow on {len(scene.snowbough.receivers)} objects, "
        f"{RESOLUTION} x {RESOLUTION} each ({WHEEL_RESOLUTION} x {WHEEL_RESOLUTION} for wheels)"
    )
    began = time.perf_counter()
    bpy.ops.snowbough.bake()
    bake_seconds = time.perf_counter() - began
    bpy.ops.snowbough.setup_material()
    bpy.ops.snowbough.setup_displacement()
    simplify_snow()
    near = close_up(armature, stage.camera)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)

    began = time.perf_counter()
    for number, frame in enumerate(RENDERED_FRAMES, 1):
        scene.frame_set(frame)
        render(folder / f"frame_{frame:04d}.png")
        say(f"rendered frame {frame} ({number} of {len(RENDERED_FRAMES)})")
    scene.camera = near
    scene.cycles.samples = CLOSE_UP_SAMPLES
    render(folder / "close_up.png")
    say("rendered a fork from close by")
    scene.camera = stage.camera
    render_seconds = time.perf_counter() - began

    scene.frame_set(1)
    (folder / "demo.json").write_text(
        json.dumps(
            {
                "tree": str(tree),
                "bones": rig_for_the_sheet(armature),
                "vertices": len(bark.data.vertices),
                "faces": len(bark.data.polygons),
                "frames": RENDERED_FRAMES,
                "last_frame": demo_scene.FRAMES,
                "depths": [depth_of(frame) for frame in RENDERED_FRAMES],
                "resolution": RESOLUTION,
                "receivers": len(scene.snowbough.receivers),
                "import_seconds": round(import_seconds, 2),
                "bake_seconds": round(bake_seconds, 1),
                "render_seconds": round(render_seconds, 1),
            }
        )
    )
    say(
        f"import {import_seconds:.1f} s, bake {bake_seconds:.1f} s, renders {render_seconds:.1f} s, "
        f"all in Blender {time.perf_counter() - started:.1f} s"
    )


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(given[0]).resolve(), Path(given[1]).resolve())
