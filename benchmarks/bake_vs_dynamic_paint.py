# SPDX-License-Identifier: GPL-3.0-or-later
"""Time per frame of a whole bake, compared with Blender's Dynamic Paint, in one run on one machine. Prints a table.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/bake_vs_dynamic_paint.py -- [--frames 48]
        [--sizes 1024,2048] [--scene turning|still] [--json FILE]

Both bake the same shot: a monkey of 1,968 faces under falling snow, into one EXR height map per frame. `turning`: it
turns once, and the particles' brush has a radius of 0.05. `still`: it stands over a plane, and the radius is 0.02.

Dynamic Paint: an image sequence surface of type Displace, incremental, written as OpenEXR, painted by a particle system
that rains on it; baking that particle system is not counted. Snowbough: the add-on's operator, once with its defaults,
and once ("deposit only") without the two features that Dynamic Paint lacks: the angle of repose, and 64 directions of
flutter per shot.

The time is the wall-clock time from the call until the last map is whole, divided by the frames; it includes set-up,
evaluation of the scene and writing maps. The processor's time is the sum over threads; its ratio says more on a busy
machine. Snowbough makes no mesh of the snow here, since Dynamic Paint makes none (benchmarks/snow/display.py measures
it). Dynamic Paint takes seconds to set a surface up, so the ratio falls with the number of frames; the default is a
shot of two seconds. ``bpy.ops.dpaint.bake()`` returns before its files exist, so the script waits for the last one. The
script checks the last maps: a bake that leaves the monkey bare ends the run.
"""

import argparse
import json
import math
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "addon"))
import snowbough  # noqa: E402

PARTICLES_A_FRAME = 500
# Early enough that the rain has reached the ground by frame 1.
RAIN_BEGINS = -20
GIVE_UP_SECONDS = 600.0
STILL_SECONDS = 1.0
# The value that Dynamic Paint writes for no displacement.
NEUTRAL = 0.5
# Snow lies on about a quarter of the monkey's map; Dynamic Paint's particles go through the monkey.
MIN_PAINTED = 0.1
SCENES = {"turning": 0.05, "still": 0.02}
GOALS = {1024: 10.0, 2048: 15.0}


def arguments():
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="bake_vs_dynamic_paint.py")
    parser.add_argument("--frames", type=int, default=48)
    parser.add_argument("--sizes", default="1024,2048")
    parser.add_argument("--scene", choices=SCENES, default="turning")
    parser.add_argument("--json")
    return parser.parse_args(given)


def build_shot(frames, name):
    """The scene `name` with a monkey of 1,968 faces, unwrapped without overlaps; returns it."""
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    if name == "still":
        bpy.ops.mesh.primitive_plane_add(size=4.0, location=(0, 0, -1))
    bpy.ops.mesh.primitive_monkey_add(size=2.0)
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    assert len(monkey.data.polygons) == 1968
    monkey.data.uv_layers.remove(monkey.data.uv_layers[0])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=0.004)
    bpy.ops.object.mode_set(mode="OBJECT")
    for frame, angle in ((1, 0.0), (frames, 6.28)) if name == "turning" else ():
        monkey.rotation_euler.z = angle
        monkey.keyframe_insert("rotation_euler", frame=frame)
    return monkey


def pixels_of(path):
    """Red and alpha of an image file, as two arrays."""
    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels[0::4], pixels[3::4]


def require_paint(name, share):
    if share < MIN_PAINTED:
        raise SystemExit(f"{name} has painted only {share:.0%} of its map: there is nothing to compare")


def bake_deposit_only(monkey, size, frames, folder, radius):
    settings = bpy.context.scene.snowbough
    settings.repose, settings.flutter = math.radians(90.0), 0.0
    return bake_snowbough(monkey, size, frames, folder, radius)


def bake_snowbough(monkey, size, frames, folder, _radius):
    """Seconds from the call until the last map is whole, and the processor's."""
    bpy.ops.object.select_all(action="DESELECT")
    monkey.select_set(True)
    bpy.context.view_layer.objects.active = monkey
    bpy.ops.snowbough.add_receivers()
    bpy.ops.snowbough.setup_displacement(mode="NONE")
    settings = bpy.context.scene.snowbough
    settings.receivers[0].resolution = size
    settings.cache_directory = str(folder)
    began, processor = time.time_ns(), time.process_time()
    bpy.ops.snowbough.bake()
    processor = time.process_time() - processor
    heights = sorted(Path(folder).rglob("height_*"))
    assert len(heights) == frames
    red, _ = pixels_of(heights[-1])
    require_paint("Snowbough", (red > 0.0).mean())
    return (max(file.stat().st_ctime_ns for file in heights) - began) / 1e9, processor


def add_rain(frames, radius):
    """A plane above the monkey that rains particles, as Dynamic Paint's brush of `radius`."""
    bpy.ops.mesh.primitive_plane_add(size=3.0, location=(0, 0, 2))
    cloud = bpy.context.object
    cloud.modifiers.new("Rain", "PARTICLE_SYSTEM")
    rain = cloud.particle_systems[0].settings
    rain.count = PARTICLES_A_FRAME * frames
    rain.frame_start, rain.frame_end, rain.lifetime = RAIN_BEGINS, frames, 60
    rain.normal_factor = 0.0
    rain.object_align_factor = (0, 0, -3)
    cache = cloud.particle_systems[0].point_cache
    cache.frame_start, cache.frame_end = RAIN_BEGINS, frames
    with bpy.context.temp_override(point_cache=cache):
        bpy.ops.ptcache.bake(bake=True)
    bpy.ops.object.modifier_add(type="DYNAMIC_PAINT")
    paint = cloud.modifiers[-1]
    # A modifier is a canvas by default, even if it has only a brush.
    paint.ui_type = "BRUSH"
    bpy.ops.dpaint.type_toggle(type="BRUSH")
    brush = paint.brush_settings
    brush.paint_source = "PARTICLE_SYSTEM"
    brush.particle_system = cloud.particle_systems[0]
    brush.use_particle_radius = False
    brush.solid_radius = radius


def bake_dynamic_paint(monkey, size, frames, folder, radius):
    """Seconds from the call until the last file is whole, and the processor's, without waiting for the files."""
    add_rain(frames, radius)
    bpy.ops.object.select_all(action="DESELECT")
    monkey.select_set(True)
    bpy.context.view_layer.objects.active = monkey
    bpy.ops.object.modifier_add(type="DYNAMIC_PAINT")
    bpy.ops.dpaint.type_toggle(type="CANVAS")
    surface = monkey.modifiers[-1].canvas_settings.canvas_surfaces[0]
    surface.surface_format = "IMAGE"
    surface.surface_type = "DISPLACE"
    surface.use_incremental_displace = True
    surface.image_fileformat = "OPENEXR"
    surface.image_resolution = size
    surface.uv_layer = monkey.data.uv_layers[0].name
    surface.frame_start, surface.frame_end = 1, frames
    surface.image_output_path = str(folder)
    surface.use_antialiasing = False
    began, processor = time.perf_counter(), time.process_time()
    bpy.ops.dpaint.bake()
    waiting = time.thread_time()
    last_change, seen = time.perf_counter(), None
    while time.perf_counter() - began < GIVE_UP_SECONDS:
        files = sorted(Path(folder).rglob("*.exr"))
        now = (len(files), sum(file.stat().st_size for file in files))
        if now != seen:
            last_change, seen = time.perf_counter(), now
        if len(files) >= frames and time.perf_counter() - last_change > STILL_SECONDS:
            processor = time.process_time() - processor - (time.thread_time() - waiting)
            red, alpha = pixels_of(files[-1])
            require_paint("Dynamic Paint", (red[alpha > 0.0] != NEUTRAL).mean())
            return last_change - began, processor
        time.sleep(0.005)
    raise SystemExit(f"Dynamic Paint wrote {seen[0]} of {frames} files in {GIVE_UP_SECONDS:.0f} s")


BAKES = {"snowbough": bake_snowbough, "deposit_only": bake_deposit_only, "dynamic_paint": bake_dynamic_paint}


def main():
    options = arguments()
    snowbough.register()
    rows = []
    for size in (int(text) for text in options.sizes.split(",")):
        row = {"size": size, "frames": options.frames}
        for name, bake in BAKES.items():
            with tempfile.TemporaryDirectory() as folder:
                monkey = build_shot(options.frames, options.scene)
                seconds, processor = bake(monkey, size, options.frames, folder, SCENES[options.scene])
                row[name], row[f"{name}_processor"] = seconds / options.frames, processor / options.frames
        for name in ("snowbough", "deposit_only"):
            row[f"{name}_factor"] = row["dynamic_paint"] / row[name]
            row[f"{name}_processor_factor"] = row["dynamic_paint_processor"] / row[f"{name}_processor"]
        rows.append(row)
    print(
        f"\nSeconds a frame, whole bake of the {options.scene} monkey, {options.frames} frames, EXR files included"
    )
    print(
        f"{'time':>10} {'size':>6} {'Dynamic Paint':>14} {'Snowbough':>10} {'times faster':>13} {'deposit only':>13} "
        f"{'times faster':>13} {'goal':>6}"
    )
    for row in rows:
        goal = GOALS.get(row["size"])
        for clock, of in (("wall", ""), ("processor", "_processor")):
            print(
                f"{clock:>10} {row['size']:>6} {row['dynamic_paint' + of]:>14.4f} {row['snowbough' + of]:>10.4f} "
                f"{row[f'snowbough{of}_factor']:>13.1f} {row['deposit_only' + of]:>13.4f} "
                f"{row[f'deposit_only{of}_factor']:>13.1f} {f'{goal:.0f}' if goal else '-':>6}"
            )
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=1) + "\n")


main()
