# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a sample scene, inside Blender in the background:

    blender -b --factory-startup --python-exit-code 1 -P blend_samples/sample.py -- NAME FOLDER [ARGUMENTS]

A scene is a script in blend_samples/scenes: a function that adds objects and returns the receivers of snow, and a call
of `run`. Here is what the scenes share: ground, light, snowfall, the bake and the picture.
"""

import importlib
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

SAMPLES = Path(__file__).resolve().parent
sys.path[:0] = [str(SAMPLES), str(SAMPLES.parent / "addon")]

import demo  # noqa: E402  (both folders are known from here on)
import demo_scene  # noqa: E402
import grow_tree  # noqa: E402
import snowbough  # noqa: E402

NAME, FOLDER, *ARGUMENTS = sys.argv[sys.argv.index("--") + 1 :]
FOLDER = Path(FOLDER).resolve()


def painted(name, colour, **look):
    return demo_scene.make_material(name, colour, **look)


def finish(material, smooth=True, subdivisions=0):
    """Shades and unwraps the active object; returns it."""
    made = bpy.context.view_layer.objects.active
    if subdivisions:
        made.modifiers.new("fine", "SUBSURF").levels = subdivisions
        bpy.ops.object.modifier_apply(modifier="fine")
    if smooth:
        for polygon in made.data.polygons:
            polygon.use_smooth = True
    demo_scene.unwrap(made)
    made.data.materials.clear()
    made.data.materials.append(material)
    return made


def block(name, material, place, size):
    """A box with sharp edges."""
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    bpy.context.view_layer.objects.active.scale = size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    made = finish(material, smooth=False)
    made.name, made.location = name, place
    return made


def board(name, material, size, place, cells=32):
    """A level square with a UV map for snow."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size, location=place)
    made = bpy.context.view_layer.objects.active
    made.name = name
    made.data.uv_layers.active.name = "snow"
    made.data.materials.append(material)
    return made


def turn(target, axis, degrees, frames):
    """Turns an object about an axis (0, 1, 2) between two frames."""
    for frame, angle in zip(frames, (0.0, math.radians(degrees))):
        target.rotation_euler[axis] = angle
        target.keyframe_insert("rotation_euler", index=axis, frame=frame)


def tree(species, *options):
    """Grows a tree, imports and rigs it; returns its meshes."""
    obj = FOLDER / f"{species}.obj"
    grow_tree.main(["--species", species, *options, str(obj)])
    _armature, meshes, _seconds = demo.import_tree(obj)
    return meshes


def snow_on(receivers, depth, angle, bearing, resolution, **settings):
    own = demo.list_receivers(receivers)
    for entry in own.receivers:
        entry.resolution = resolution
    own.end_depth, own.pixel_size, own.seed = depth, 0.016, 7
    own.fall_angle, own.bearing = math.radians(angle), math.radians(bearing)
    own.surface_relief = demo.RELIEF
    for name, value in settings.items():
        setattr(own, name, value)


def run(
    build,
    eye,
    target,
    lens=40.0,
    frames=24,
    depth=0.12,
    angle=0.0,
    bearing=70.0,
    resolution=512,
    name=NAME,
    prepare=None,
    present=None,
    **settings,
):
    """Builds the scene on snowy ground, bakes it, and renders the last frame to FOLDER/<name>.png.

    eye, target: the camera's place and what it looks at, in metres. depth: snow on level ground at the end, in metres.
    angle, bearing: the wind, in degrees. prepare: called with the scene's settings before the bake; present: called
    after it, on the last frame. settings: further settings of the snowfall.
    """
    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    demo_scene.make_sky(scene)
    demo_scene.make_sun(scene)
    ground = demo_scene.make_ground(painted("earth", (0.085, 0.066, 0.038), mottle=0.45, scale=2.3))
    forest = demo_scene.make_forest(75.0, 11.0, (0.30, 0.34, 0.42), 3)
    receivers = [*build(), ground]
    forest.snowbough.occlude = False
    snow_on(receivers, depth, angle, bearing, resolution, **settings)
    scene.camera = demo_scene.make_camera(scene, "camera", Vector(eye), Vector(target), lens)
    demo_scene.set_render(scene, 640, 400, 20)
    scene.frame_set(1)
    if prepare is not None:
        prepare(scene.snowbough)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / f"{name}.blend"), compress=True)
    if bpy.ops.snowbough.bake() != {"FINISHED"}:
        raise RuntimeError("the bake did not finish")
    demo.simplify_snow()
    scene.frame_set(frames)
    if present is not None:
        present()
    bpy.ops.wm.save_mainfile(compress=True)
    demo.render(FOLDER / f"{name}.png")
    print(f"sample: {FOLDER / name}.png", flush=True)


if __name__ == "__main__":
    importlib.import_module(f"scenes.{NAME}")
