"""Time to draw a tree from near and far, measured as in the tables 3.1 and 3.2 of the thesis.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/trees.py [TREE.obj] [--size 1280 720] [--frames 20]

Prints a markdown table for the current driver: GPU time, wall time and processor time of a frame (the last two include
reading the picture back; processor time is the sum over threads, and is comparable on a busy machine), patches by class
and triangles, by distance, for both metrics; the same tree without tessellation; and the same tree as a plain mesh
subdivided in advance. `THESIS, A.1` has the constants of the thesis's appendix A.1 (20 m, 5 levels). The thesis's frame
rates stand beside its metric: they are from a GTX 460 with another tree, and give a scale only. On a software renderer
the table shows how the work grows, not the speed of a card.
"""

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[2]
#: Metres from the tree: frames a second and polygons of table 3.1, on a GTX 460.
THESIS = {
    10: (279.7, 195_353),
    20: (527.4, 26_782),
    40: (696.8, 6_776),
    60: (791.0, 1_624),
    80: (791.3, 1_624),
}
FIELD_OF_VIEW = 0.8
#: Detail of the static mesh: the finest of an imported chain.
STATIC_DETAIL = "FILM"


def camera_at(mesh, away, size):
    middle = (mesh.vertices.min(0) + mesh.vertices.max(0)) / 2
    eye = middle + (0, -away, 0)
    return native.Camera(eye=eye, target=middle, width=size[0], height=size[1], field_of_view=FIELD_OF_VIEW)


def ways(arguments):
    """The compared methods: name, whether the tree is a plain mesh, settings."""
    common = {"shadow_resolution": 0 if arguments.no_shadows else 1024}
    yield "SCREEN", False, native.RenderSettings(**common)
    yield "THESIS", False, native.RenderSettings(metric="THESIS", max_area=0.02, **common)
    yield (
        "THESIS, A.1",
        False,
        native.RenderSettings(metric="THESIS", max_distance=20, max_level=5, max_area=0.02, **common),
    )
    yield "nothing tessellated", False, native.RenderSettings(max_level=1, min_pixels=0, **common)
    yield f"mesh of detail {STATIC_DETAIL}", True, native.RenderSettings(**common)


def measured(renderer, camera, settings, frames):
    """Medians over frames, the first of which compiles shaders and does not count."""
    found = []
    for _ in range(frames + 1):
        began = time.process_time()
        renderer.render(camera, settings)
        taken = time.process_time() - began
        found.append({**renderer.statistics(), "processor_seconds": taken})
    found = found[1:]
    keys = ("gpu_seconds", "wall_seconds", "processor_seconds")
    return found[-1], *(statistics.median(one[key] for one in found) for key in keys)


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def table(renderer, mesh, arguments, static):
    row(
        "way",
        "metres",
        "dropped",
        "plain",
        "tessellated",
        "triangles",
        "GPU ms",
        "wall ms",
        "processor ms",
        "thesis: 1/s, polygons",
    )
    row(*["---"] * 10)
    for name, is_static, settings in ways(arguments):
        if is_static != static:
            continue
        for away, (rate, polygons) in THESIS.items():
            camera = camera_at(mesh, away, arguments.size)
            one, *taken = measured(renderer, camera, settings, arguments.frames)
            patches = ["-"] * 3 if static else [one[key] for key in ("dropped", "plain", "tessellated")]
            said = f"{rate}, {polygons}" if name == "THESIS" else ""
            row(name, away, *patches, one["triangles"], *(f"{t * 1e3:.2f}" for t in taken), said)
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree", nargs="?", default=ROOT / "tests" / "data" / "small_maple.obj")
    parser.add_argument("--size", nargs=2, type=int, default=(1280, 720), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--no-shadows", action="store_true")
    arguments = parser.parse_args()
    skeleton = native.read_tree(arguments.tree)
    mesh = native.build_tree_mesh(skeleton)
    fine = native.build_tree_mesh(skeleton, detail=STATIC_DETAIL)
    with native.Renderer() as renderer:
        print(
            f"{Path(arguments.tree).name}: {len(skeleton.branches)} branches, {len(mesh.quads)} patches; ",
            end="",
        )
        print(f"{arguments.size[0]} x {arguments.size[1]}, {arguments.frames} frames; {renderer.driver}\n")
        renderer.add_tree("tree", mesh)
        table(renderer, mesh, arguments, static=False)
        renderer.remove("tree")
        halves = np.concatenate([fine.quads[:, [0, 1, 2]], fine.quads[:, [0, 2, 3]]])
        renderer.add_mesh("tree", fine.vertices, halves, (0.2, 0.15, 0.1))
        table(renderer, mesh, arguments, static=True)


if __name__ == "__main__":
    main()
