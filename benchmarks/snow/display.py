# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of snow after its maps are baked: seconds until it is visible, each change of the frame, points, files.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/display.py -- [--scene monkeys] [--frames 24]
        [--root CHECKOUT]

SCENE: monkeys (three of them and a plane), car (15 parts and a plane), hundred (receivers of 100 faces, 512 texels).
--root: another built checkout, whose add-on is measured instead, such as an earlier commit. The comparison is a Mesh
Cache modifier on a plain grid with as many points: Blender's time for reading that many points from a file.
"""

import argparse
import math
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np


def arguments():
    parser = argparse.ArgumentParser(prog="display.py")
    parser.add_argument("--scene", choices=sorted(SCENES), default="monkeys")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--root", default=str(Path(__file__).resolve().parents[2]))
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])


def plane(size=6.0):
    bpy.ops.mesh.primitive_plane_add(size=size)
    bpy.context.object.name = "Ground"
    return bpy.context.object


def monkeys():
    made = [plane()]
    for i in range(3):
        bpy.ops.mesh.primitive_monkey_add(size=1.0, location=(1.6 * (i - 1), 0.0, 0.6))
        monkey = bpy.context.object
        monkey.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
        monkey.modifiers[0].levels = 1
        bpy.ops.object.shade_smooth()
        made.append(monkey)
    return made, 0.12, 0


def _block(name, size, at, bevel=0.0):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=at)
    made = bpy.context.object
    made.name, made.scale = name, size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    if bevel:
        modifier = made.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 4
        bpy.ops.object.shade_smooth()
    return made


def car():
    made = [plane(7.0), _block("Body", (4.2, 1.7, 0.6), (0.0, 0.0, 0.7), 0.12)]
    made.append(_block("Cabin", (2.0, 1.5, 0.55), (-0.2, 0.0, 1.25), 0.18))
    for x in (-1.3, 1.3):
        for y in (-0.8, 0.8):
            bpy.ops.mesh.primitive_cylinder_add(
                radius=0.33, depth=0.2, location=(x, y, 0.33), rotation=(math.pi / 2.0, 0.0, 0.0)
            )
            made.append(bpy.context.object)
    for y in (-0.9, 0.9):
        made.append(_block("Mirror", (0.12, 0.2, 0.13), (0.7, y, 1.1), 0.03))
    for y in (-0.3, 0.3):
        made.append(_block("Wiper", (0.02, 0.5, 0.02), (0.9, y, 1.05)))
    for x in (-2.15, 2.15):
        made.append(_block("Bumper", (0.15, 1.6, 0.2), (x, 0.0, 0.5), 0.05))
    for y in (-0.6, 0.6):
        made.append(_block("Lamp", (0.08, 0.25, 0.12), (2.08, y, 0.8), 0.03))
    return made, 0.10, 0


def hundred():
    made = []
    for i in range(100):
        bpy.ops.mesh.primitive_grid_add(
            x_subdivisions=10, y_subdivisions=10, size=0.5, location=(0.6 * (i % 10), 0.6 * (i // 10), 0.0)
        )
        made.append(bpy.context.object)
    return made, 0.05, 512


SCENES = {"monkeys": monkeys, "car": car, "hundred": hundred}


def frame_changes(scene, rounds=2):
    """Median seconds of a change of the frame."""
    seconds = []
    for _ in range(rounds):
        for frame in range(scene.frame_start, scene.frame_end + 1):
            began = time.perf_counter()
            scene.frame_set(frame)
            bpy.context.evaluated_depsgraph_get().update()
            seconds.append(time.perf_counter() - began)
    return statistics.median(seconds)


def peer_frame_changes(scene, points, folder):
    """The same with a grid of about as many points that reads them from a file."""
    side = max(2, int(math.sqrt(points)))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side - 1, y_subdivisions=side - 1)
    grid = bpy.context.object
    count = len(grid.data.vertices)
    path = Path(folder) / "peer.pc2"
    positions = np.empty((count, 3), np.float32)
    grid.data.vertices.foreach_get("co", positions.ravel())
    frames = scene.frame_end - scene.frame_start + 1
    with open(path, "wb") as stream:
        stream.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, count, 0.0, 1.0, frames))
        for frame in range(frames):
            positions[:, 2] = 0.001 * frame
            stream.write(positions.tobytes())
    modifier = grid.modifiers.new("Cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", str(path)
    for obj in snow_objects(scene):
        obj.hide_viewport = True
    seconds = frame_changes(scene)
    for obj in snow_objects(scene):
        obj.hide_viewport = False
    bpy.data.objects.remove(grid)
    return seconds


def cycles_peak(scene):
    """Peak memory in MB of another Blender that renders the last frame of the saved file, small."""
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.camera.location, scene.camera.rotation_euler = (0.0, -8.0, 3.0), (1.25, 0.0, 0.0)
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    scene.frame_set(scene.frame_end)
    bpy.ops.wm.save_mainfile()
    # The child reads its own peak: what the operating system says of children includes their parent's memory before
    # exec.
    report = "print([line for line in open('/proc/self/status') if line.startswith('VmHWM')][0])"
    command = [bpy.app.binary_path, "-b", bpy.data.filepath, "-o", f"{bpy.data.filepath}_"]
    command += ["-f", str(scene.frame_end), "--python-expr", report]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    line = next(line for line in done.stdout.splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def snow_objects(scene):
    return [obj for obj in scene.objects if obj.snowbough.is_shell]


def point_counts(scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    counts = {}
    for obj in snow_objects(scene):
        data = obj.evaluated_get(depsgraph).data
        counts[obj.name] = len(data.vertices)
    return counts


def main():
    options = arguments()
    sys.path.insert(0, str(Path(options.root) / "addon"))
    import snowbough

    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, options.frames
    made, depth, resolution = SCENES[options.scene]()
    for obj in made:
        obj.select_set(True)
    with tempfile.TemporaryDirectory() as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "scene.blend"))
        bpy.ops.snowbough.add_receivers()
        for entry in scene.snowbough.receivers:
            entry.resolution = resolution
        scene.snowbough.end_depth = depth
        scene.snowbough.cache_directory = str(Path(folder) / "cache")
        without = frame_changes(scene)
        began = time.perf_counter()
        bpy.ops.snowbough.bake()
        baked = time.perf_counter() - began
        frames = float(snowbough.base.session.last_outcome[1].split(" s")[0].rsplit(" ", 1)[1])
        with_snow = frame_changes(scene)
        counts = point_counts(scene)
        total = sum(counts.values())
        rows = [
            ("receivers", f"{len(scene.snowbough.receivers)}"),
            ("button to picture, s", f"{baked:.2f}"),
            ("of that frames, s", f"{frames:.2f}"),
            ("of that until snow is seen, s", f"{baked - frames:.2f}"),
            ("frame change without snow, ms", f"{1e3 * without:.1f}"),
            ("frame change with snow, ms", f"{1e3 * with_snow:.1f}"),
            ("points", f"{total}"),
            (
                "frame change, Mesh Cache of as many points, ms",
                f"{1e3 * peer_frame_changes(scene, total, folder):.1f}",
            ),
        ]
        if hasattr(bpy.ops.snowbough, "update_surface") and "SNOWBOUGH_OT_update_surface" in dir(bpy.types):
            began = time.perf_counter()
            bpy.ops.snowbough.update_surface()
            rows.append(("Update Surface, all frames, s", f"{time.perf_counter() - began:.2f}"))
            scene.snowbough.surface_overhang = 1.2
            began = time.perf_counter()
            scene.snowbough.surface_overhang = 1.1
            rows.append(("a slider's next movement, s", f"{time.perf_counter() - began:.3f}"))
            files = list(Path(folder).glob("cache/**/surface.pc2"))
            rows.append(
                (
                    "surface.pc2, MB a frame",
                    f"{sum(f.stat().st_size for f in files) / 1e6 / (options.frames + 1):.2f}",
                )
            )
        rows.append(("peak memory with Cycles, MB", f"{cycles_peak(scene):.0f}"))
        rows.append((".blend, MB", f"{Path(bpy.data.filepath).stat().st_size / 1e6:.1f}"))
    print(f"\n{options.scene}, {options.frames} frames, Blender {bpy.app.version_string}, {options.root}")
    for name, value in rows:
        print(f"  {name:48s} {value:>10s}")
    for name, count in sorted(counts.items(), key=lambda item: -item[1])[:20]:
        print(f"    {name:46s} {count:>10d}")


main()
