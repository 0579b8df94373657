"""Frame rates of falling and drawn snow: the thesis's table 4.2 beside our method, and frames by map and polygons.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/snow.py [--size 1280 720] [--frames 5] [--quick]

Prints markdown tables for the current driver. A frame is a step of the simulation (engine GL), the transfer of the map
to the renderer, and the picture. The map of a tree stays on the GPU and is tessellated with the branches. On a mesh,
the heights are read back, and the points of the snow surface (SnowSurface) are computed on the processor and uploaded.
GPU time is that of all passes, with the picture's share in a column of its own; wall time includes reading the picture
back; processor time is the sum over threads.

- Scenes: mapping GEOMETRY, on trees with the metric THESIS, is the thesis's method on the same card, COMPUTE with
  SCREEN is ours. The thesis's six scenes ran at 103 to 112 frames per second on a GTX 580. Its meshes are not
  available; ours have about as many polygons, so its figures give a scale only.
- Maps of 256 to 4096 texels per side on one mesh, and meshes of 1,000 to 350,000 triangles on one map. The radius of
  the output's smoothing is in metres, and the number of its rounds grows with the square of the radius in texels: with
  10 mm they dominate on large maps. Other rows have the same radius in texels everywhere (that of 10 mm at 1024).

On a software renderer the tables show how the work grows, not the speed of a card. Snow does not slide here (no repose,
which runs on the processor with either engine).
"""

import argparse
import statistics
import time
from functools import cache

import numpy as np
import scenes
import snowbough_native as native

WAYS = {"thesis": ("GEOMETRY", "THESIS"), "ours": ("COMPUTE", "SCREEN")}
DEPTH = 0.002
#: Radius of the output's smoothing in metres, and the map size for which it is converted into texels.
BLUR, BLUR_MAP = 0.01, 1024


def rolling(triangles, resolution):
    """A rolling ground with about that many triangles."""
    return scenes.ground(8.0, max(int(np.sqrt(triangles / 2)), 1), resolution)


def table_scenes():
    """Scenes by name."""
    tree, _ = maple()
    yield "ground", {"ground": rolling(5_000, 512)}
    yield "ball on the ground", {"ground": rolling(5_000, 512), "ball": scenes.ball(0.5).moved((0, 0, 0.45))}
    yield "urn", {"ground": rolling(5_000, 512), "urn": scenes.urn()}
    yield "bench", {"ground": rolling(5_000, 512), "bench": scenes.bench()}
    yield (
        "garden",
        {
            "ground": rolling(5_000, 512),
            "bench": scenes.bench().moved((0.9, -0.6, 0), -20),
            "urn": scenes.urn().moved((-1.3, -0.9, 0)),
            "ball": scenes.ball(0.3).moved((2.1, -1.5, 0.27)),
        },
    )
    yield "tree", {"ground": rolling(5_000, 512), "tree": tree}


@cache
def maple():
    return scenes.maple(512)


def camera(size):
    return native.Camera(
        eye=(0.6, -4.6, 1.7), target=(0.1, 0, 0.6), width=size[0], height=size[1], field_of_view=0.7
    )


def show(renderer, snow, name, thing, depth, surfaces):
    """Brings the snow of now to the renderer; `surfaces`: those of the frames before."""
    heights = snow.output(name, normal=False)["height"]
    if name not in surfaces:
        surfaces[name] = scenes.Surface(thing, heights, depth)
    else:
        renderer.remove(f"snow on {name}")
    surfaces[name].show(renderer, f"snow on {name}", heights, depth)


def step_and_draw(things, way, arguments, blur):
    """Medians over frames, the first of which compiles shaders and does not count: the frame's GPU s and the picture's,
    wall s, the processor's s, triangles."""
    mapping, metric = WAYS[way]
    settings = native.RenderSettings(metric=metric, **scenes.LIGHT)
    found = []
    with (
        native.SnowSimulation(
            pixel_size=0.02, repose=np.pi / 2, blur_radius=blur, engine="GL", mapping=mapping
        ) as snow,
        native.Renderer() as renderer,
    ):
        snow.measure_passes(True)
        for name, thing in things.items():
            snow.add_object(
                name, thing.triangles, thing.uv, resolution=thing.resolution, shading=thing.shading
            )
            if name == "tree":
                renderer.add_tree(name, maple()[1])
            else:
                renderer.add_mesh(name, thing.positions, thing.triangles, thing.color, thing.normals)
        surfaces = {}
        for frame in range(arguments.frames + 1):
            began = time.perf_counter(), time.process_time()
            moved = {name: thing.positions for name, thing in things.items()} if frame == 0 else {}
            snow.step(moved, DEPTH, scenes.FALL)
            for name, thing in things.items():
                if name != "tree":
                    show(renderer, snow, name, thing, (frame + 1) * DEPTH, surfaces)
                elif not renderer.take_snow(name, snow, (frame + 1) * DEPTH):
                    raise SystemExit("the map did not stay on the GPU")
            renderer.render(camera(arguments.size), settings)
            one = renderer.statistics()
            taken = time.perf_counter() - began[0], time.process_time() - began[1]
            of_snow = sum(cost["gpu_seconds"] for cost in snow.pass_costs().values())
            found.append((of_snow + one["gpu_seconds"], one["gpu_seconds"], *taken, one["triangles"]))
    return [statistics.median(column) for column in zip(*found[1:], strict=True)]


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def measured_row(first, things, way, arguments, blur=BLUR):
    gpu, picture, wall, processor, triangles = step_and_draw(things, way, arguments, blur)
    polygons = sum(len(thing.triangles) for thing in things.values())
    taken = (f"{seconds * 1e3:.1f}" for seconds in (gpu, picture, wall, processor))
    row(*first, way, polygons, int(triangles), *taken, f"{1 / wall:.1f}")


def head(*first):
    times = ("frame's GPU ms", "the picture's", "frame's wall ms", "frame's processor ms")
    cells = [*first, "way", "base polygons", "triangles drawn", *times, "1/s"]
    row(*cells)
    row(*["---"] * len(cells))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", nargs=2, type=int, default=(1280, 720), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="maps up to 1024, polygons up to 50,000")
    arguments = parser.parse_args()
    with native.Renderer() as renderer:
        print(f"{renderer.driver}; {arguments.size[0]} x {arguments.size[1]}, {arguments.frames} frames\n")
    head("scene")
    for name, things in table_scenes():
        for way in WAYS:
            measured_row([name], things, way, arguments)
    print()
    head("map", "smoothing")
    for resolution in (256, 512, 1024) if arguments.quick else (256, 512, 1024, 2048, 4096):
        for blur in dict.fromkeys((BLUR, BLUR * BLUR_MAP / resolution)):
            things = {"ground": rolling(5_000, resolution)}
            measured_row([f"{resolution}²", f"{1e3 * blur:g} mm"], things, "ours", arguments, blur)
    print()
    head("mesh")
    for triangles in (
        (1_000, 10_000, 50_000) if arguments.quick else (1_000, 10_000, 50_000, 150_000, 350_000)
    ):
        measured_row(["ground"], {"ground": rolling(triangles, 1024)}, "ours", arguments)


if __name__ == "__main__":
    main()
