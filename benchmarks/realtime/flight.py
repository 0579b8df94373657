"""A flight from 80 m to 2 m of a tree in the snow: docs/images/flight.png, and the difference of successive frames.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/flight.py [--out PICTURE.png] [--every N]

The picture has frames of the flight, the same frames as wireframes (with parts of edges four times as long, because
small wireframes would be black), and a curve: the mean change of a pixel from frame to frame, of 255. A level of detail
that pops would be a spike. The distance shrinks by the same factor in each frame;
`tests/python/native/test_lod_flight.py` limits the share of the levels in a frame's change.
"""

import argparse
from pathlib import Path

import numpy as np
import scenes
import snowbough_native as native

FARTHEST, NEAREST = 80.0, 2.0
#: Six seconds at 60 a second.
FRAMES = 360
#: Target and direction of the view.
TARGET = np.array((0.1, -0.1, 0.95))
FROM = np.array((0.35, -0.92, 0.16))
#: Metres: frames that the picture shows.
SHOWN = (80, 40, 20, 10, 5, 2)
CELL = (230, 260)
#: Metres of snow on open ground.
DEPTH = 0.08


def distance(number):
    return FARTHEST * (NEAREST / FARTHEST) ** (number / (FRAMES - 1))


def camera(number, size):
    eye = TARGET + FROM / np.linalg.norm(FROM) * distance(number)
    return native.Camera(
        eye=eye, target=TARGET, width=size[0], height=size[1], field_of_view=0.5, near=0.2, far=1500.0
    )


def settings(**options):
    return native.RenderSettings(**{**scenes.LIGHT, "antialias": True, **options})


def smooth_picture(renderer, number, size, samples=4, **options):
    """A frame of `samples` x `samples` pixels each, (height, width, 3), 0 to 255: edges that cross few samples would
    change in steps at every level of detail."""
    scale = {"target_pixels": 4.0, "min_pixels": 0.5, **options}
    scale = {**scale, **{key: samples * scale[key] for key in ("target_pixels", "min_pixels")}}
    large = camera(number, tuple(samples * edge for edge in size))
    fine = renderer.render(large, settings(**scale, antialias=False))[..., :3].astype(float)
    return fine.reshape(size[1], samples, size[0], samples, 3).mean(axis=(1, 3))


def scene(resolution=1024):
    """The objects, and the trees among them."""
    tree, mesh = scenes.maple(resolution)
    things = {
        "ground": scenes.ground(40.0, 32, resolution),
        "stone": scenes.boxes([((0, 0, 0.16), (0.5, 0.36, 0.34))], resolution // 4, (0.3, 0.29, 0.27)).moved(
            (0.75, -0.55, 0), 35
        ),
        "tree": tree,
    }
    return things, {"tree": mesh}


def put(renderer, heights, depth, things, trees):
    """The scene in a renderer, with a plain around it that reaches the horizon."""
    scenes.show(renderer, things, heights, depth, trees)
    g = 1000.0
    corners = [(-g, -g, -0.05), (g, -g, -0.05), (g, g, -0.05), (-g, g, -0.05)]
    renderer.add_mesh("plain", corners, [(0, 1, 2), (0, 2, 3)], (0.97, 0.99, 1.0))


def block_change(one, other, edge=8):
    """Mean absolute change of each block of edge x edge pixels."""
    change = abs(one[..., :3].astype(float) - other[..., :3]).mean(axis=2)
    rows, columns = (n // edge for n in change.shape)
    return change[: rows * edge, : columns * edge].reshape(rows, edge, columns, edge).mean(axis=(1, 3))


def changes(renderer, every):
    """Mean change of a pixel from each frame to the next, every so many frames."""
    found = []
    for number in range(0, FRAMES - 1, every):
        pair = [renderer.render(camera(number + k, (240, 180)), settings()) for k in (0, 1)]
        found.append((number, block_change(*pair).mean()))
    return np.array(found)


def curve(found, width, height=90, top=8.0):
    """The changes as a line on white paper, a grid line each 2 of 255."""
    paper = np.full((height, width, 3), 255, np.uint8)
    for level in np.arange(0, top + 0.1, 2):
        paper[min(int(level / top * (height - 1)), height - 1)] = 225
    x = np.arange(width)
    y = np.interp(x, found[:, 0] / (FRAMES - 1) * (width - 1), found[:, 1]).clip(0, top) / top * (height - 1)
    for column in x[:-1]:
        low, high = sorted((int(y[column]), int(y[column + 1])))
        paper[low : high + 2, column] = (30, 60, 120)
    return paper


def picture(every):
    things, trees = scene()
    heights = scenes.fallen(things, DEPTH, pixel_size=0.02)
    with native.Renderer() as renderer:
        put(renderer, heights, DEPTH, things, trees)
        rows = []
        for wire in (False, True):
            row = []
            for metres in SHOWN:
                number = (FRAMES - 1) * np.log(metres / FARTHEST) / np.log(NEAREST / FARTHEST)
                if wire:
                    # Parts of edges four times as long, in soft lines, otherwise the wireframe would be black.
                    row.append(smooth_picture(renderer, number, CELL, target_pixels=16.0, wireframe=True))
                else:
                    row.append(renderer.render(camera(number, CELL), settings())[..., :3])
                    counts = renderer.statistics()
                    kinds = ", ".join(
                        f"{counts[key]} {key}" for key in ("dropped", "plain", "tessellated", "triangles")
                    )
                    print(f"{metres} m: {kinds}")
            rows.append(np.concatenate(row, axis=1).astype(np.uint8))
        found = changes(renderer, every)
    print(
        f"change from frame to frame, of 255: mean {found[:, 1].mean():.2f}, most {found[:, 1].max():.2f};"
        f" largest step of it between neighbours {abs(np.diff(found[:, 1])).max(initial=0.0):.2f}"
    )
    rows.append(curve(found, rows[0].shape[1]))
    return np.concatenate(rows[::-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", default=scenes.ROOT / "docs" / "images" / "flight.png")
    parser.add_argument("--every", type=int, default=6, help="frames of the curve that are drawn")
    arguments = parser.parse_args()
    native.write_png(str(Path(arguments.out)), picture(arguments.every))


if __name__ == "__main__":
    main()
