"""The real-time figures of docs/figures.md: counterparts of the thesis's 3.4, 3.6, 3.9, 4.7, 4.8, 4.19 and 4.20.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/figures.py [--only NAME,..] [--out FOLDER]

tree_levels   a tree at four levels of detail, shaded and as wireframes (3.4)
tree_close    a fork from near, shaded and as a wireframe (3.6)
tree_meadow   a tree in leaf (3.9)
snow_growing  growing snow on an urn and a bench (4.7)
snow_filter   a map as simulated and as drawn, and the snow of both (4.8)
snow_close    a bench and an urn from near, and their wireframes
snow_garden   a garden while it snows (4.19)
snow_tree     a tree that carries snow, whole and from near (4.20)

Trees are grown by blend_samples/grow_tree.py; scenes.py makes everything else. The script prints what it draws.
"""

import argparse
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import scenes
import snowbough_native as native

NAMES = (
    "tree_levels",
    "tree_close",
    "tree_meadow",
    "snow_growing",
    "snow_filter",
    "snow_close",
    "snow_garden",
    "snow_tree",
)
#: Supersampling of wireframes, per side: single lines would become black where many meet.
WIRE_SAMPLES = 3
#: Summer light for trees in leaf.
SUMMER = {
    "sun_direction": (-0.5, -0.7, 0.75),
    "sun_color": (2.6, 2.4, 2.0),
    "sky_color": (0.42, 0.58, 0.85),
    "ground_color": (0.16, 0.2, 0.1),
    "shadow_resolution": 4096,
}


# -- pictures ---------------------------------------------------------------------------------------------------


def drawn(renderer, eye, target, size, field_of_view=0.55, light=None, **options):
    """(height, width, 3) uint8; wireframes in soft lines."""
    samples = WIRE_SAMPLES if options.get("wireframe") else 1
    size = tuple(samples * edge for edge in size)
    camera = native.Camera(eye=eye, target=target, width=size[0], height=size[1], field_of_view=field_of_view)
    given = {**(light or scenes.LIGHT), "antialias": samples == 1, **options}
    for name, usual in (("target_pixels", 4.0), ("min_pixels", 0.5)):
        given[name] = samples * given.get(name, usual)
    picture = renderer.render(camera, native.RenderSettings(**given))[..., :3]
    height, width = (edge // samples for edge in picture.shape[:2])
    soft = picture.astype(float).reshape(height, samples, width, samples, 3).mean(axis=(1, 3))
    return (soft + 0.5).astype(np.uint8)


def both(renderer, eye, target, size, **options):
    """A picture and its wireframe beside it."""
    return np.concatenate(
        [drawn(renderer, eye, target, size, **options, wireframe=wire) for wire in (False, True)], axis=1
    )


def report(renderer, label):
    counts = renderer.statistics()
    kinds = ("dropped", "plain", "tessellated", "triangles")
    print(f"{label}: " + ", ".join(f"{counts[key]} {key}" for key in kinds), flush=True)


# -- trees ------------------------------------------------------------------------------------------------------


@cache
def grown(*arguments):
    """(Skeleton, its four-sided base) of a maple that was grown for this run."""
    with tempfile.TemporaryDirectory(prefix="snowbough-figures-") as folder:
        path = Path(folder) / "grown.obj"
        script = scenes.ROOT / "blend_samples" / "grow_tree.py"
        subprocess.run([sys.executable, script, "--species", "maple", *arguments, path], check=True)
        skeleton = native.read_tree(path)
    return skeleton, native.build_tree_mesh(skeleton, snow_resolution=2048)


#: Grown trees have few leaves: copies of each leaf, and their maximum distance in metres.
COPIES, AROUND = 9, 0.16


def leaves_of(renderer, skeleton, mesh):
    """Adds the leaves, each in one of four greens, with copies around it."""
    foliage = skeleton.foliage
    begin, end = np.asarray(foliage.face_begin[:-1]), np.asarray(foliage.face_begin[1:])
    # A fan of triangles per polygon: its first corner and each pair of successive corners.
    count = end - begin - 2
    face = np.repeat(np.arange(len(count)), count)
    step = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    corners = np.stack([begin[face], begin[face] + step + 1, begin[face] + step + 2], axis=1)
    leaf = np.asarray(foliage.face_leaf)[face]
    places = np.asarray(foliage.vertices)[np.asarray(foliage.corner_vertex)[corners]]
    count = leaf.max() + 1
    middle = np.stack([np.bincount(leaf, places[:, :, k].sum(axis=1), count) for k in range(3)], axis=1)
    middle = (middle / (3 * np.maximum(np.bincount(leaf, minlength=count), 1))[:, None])[leaf]
    random = np.random.default_rng(1)
    copies = []
    for copy in range(COPIES):
        turn = random.normal(size=(count, 4)) if copy else np.tile((1.0, 0, 0, 0), (count, 1))
        moved = random.uniform(-AROUND, AROUND, (count, 3)) if copy else np.zeros((count, 3))
        turned = np.einsum("tij,tcj->tci", rotations(turn)[leaf], places - middle[:, None])
        copies.append(turned + (middle + moved[leaf])[:, None])
    number = np.tile(leaf, COPIES) + np.repeat(np.arange(COPIES), len(leaf))
    renderer.set_leaves(
        "tree",
        np.concatenate(copies).astype(np.float32),
        np.tile(np.asarray(native.leaf_bones(skeleton, mesh))[leaf], COPIES),
        materials=(number % 4).astype(np.int32),
        colors=[(0.07, 0.17, 0.025), (0.1, 0.21, 0.035), (0.13, 0.25, 0.05), (0.18, 0.27, 0.05)],
    )


def rotations(quaternions):
    """(N, 3, 3) of quaternions (N, 4) of any length."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = [
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def grass(renderer, blades=3000, size=2.0):
    """A square of grass in many places."""
    random = np.random.default_rng(2)
    root = np.pad(random.uniform(-size / 2, size / 2, (blades, 2)), ((0, 0), (0, 1)))
    lean = random.normal(0.0, 0.05, root.shape) + (0.02, 0.01, 0.0)
    lean[:, 2] = random.uniform(0.05, 0.16, len(root))
    turn = random.uniform(0, 2 * np.pi, len(root))
    side = 0.006 * np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
    corners = np.stack([root - side, root + side, root + lean], axis=1).reshape(-1, 3)
    triangles = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    paint = random.integers(0, 3, len(triangles)).astype(np.int32)
    colors = [(0.07, 0.13, 0.025), (0.1, 0.16, 0.035), (0.14, 0.17, 0.05)]
    up = np.tile(np.float32((0.0, 0.0, 1.0)), (len(triangles), 3, 1))
    renderer.add_mesh(
        "grass", corners.astype(np.float32), triangles, normals=up, materials=paint, colors=colors
    )
    at = np.stack(np.meshgrid(np.arange(-24, 25, 2), np.arange(-8, 41, 2)), axis=-1).reshape(-1, 2)
    matrices = np.tile(np.eye(4, dtype=np.float32), (len(at), 1, 1))
    matrices[:, :2, 3] = at
    quarter = random.integers(0, 4, len(at)) * (np.pi / 2)
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(quarter)
    matrices[:, 1, 0], matrices[:, 0, 1] = np.sin(quarter), -np.sin(quarter)
    renderer.set_instances("grass", matrices)


def meadow(renderer):
    """Ground, and a plain around it that reaches the horizon."""
    ground = scenes.ground(60.0, 60)
    renderer.add_mesh("ground", ground.positions, ground.triangles, (0.075, 0.115, 0.03))
    g = 1000.0
    corners = [(-g, -g, -0.15), (g, -g, -0.15), (g, g, -0.15), (-g, g, -0.15)]
    renderer.add_mesh("plain", corners, [(0, 1, 2), (0, 2, 3)], (0.075, 0.115, 0.03))


def tree_levels(size=(260, 320)):
    """The same view four times, tessellated as from 5, 15, 45 and 135 m."""
    _, mesh = grown("--seed", "4", "--levels", "3")
    middle = np.array((0, 0, 0.5 * mesh.vertices[:, 2].max()))
    near = np.array((0.7, -1.45, 0.9))
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh)
        columns = []
        for metres in (5, 15, 45, 135):
            coarser = {"target_pixels": 0.8 * metres, "min_pixels": 0.02 * metres}
            light = {**SUMMER, "background": (0.75, 0.8, 0.85)}
            whole = drawn(renderer, (0, -9.5, 3.1), middle, size, 0.62, light, **coarser)
            report(renderer, f"as from {metres} m")
            close = drawn(renderer, near, (0, 0, 1.6), size, 0.5, light, **coarser)
            wire = drawn(renderer, near, (0, 0, 1.6), size, 0.5, light, wireframe=True, **coarser)
            columns.append(np.concatenate([wire, close, whole]))
    return np.concatenate(columns, axis=1)


def tree_close():
    _, mesh = grown("--seed", "4", "--levels", "3")
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh, bark_depth=0.1)
        light = {**SUMMER, "background": (0.75, 0.8, 0.85)}
        picture = both(
            renderer, (-0.75, -1.35, 1.95), (-0.05, 0, 1.8), (460, 560), light=light, target_pixels=6.0
        )
        report(renderer, "a fork")
    return picture


def tree_meadow():
    skeleton, mesh = grown("--seed", "4", "--leaves")
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh)
        leaves_of(renderer, skeleton, mesh)
        meadow(renderer)
        grass(renderer)
        picture = drawn(renderer, (2.0, -9.0, 1.5), (0.1, 0, 2.85), (900, 640), 0.72, SUMMER)
        report(renderer, "in leaf")
    return picture


# -- snow -------------------------------------------------------------------------------------------------------


def garden():
    """The objects of a garden, and the trees among them."""
    _, mesh = grown("--seed", "4", "--levels", "3", "--height", "4.5")
    quads, uv = np.asarray(mesh.quads), np.asarray(mesh.uv_snow)
    tree = scenes.Thing(
        np.asarray(mesh.vertices, np.float32),
        np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32),
        np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]]).astype(np.float32),
        2048,
        smooth=True,
    )
    things = {
        "ground": scenes.ground(),
        "bench": scenes.bench().moved((0.9, -0.6, 0.0), -20),
        "urn": scenes.urn().moved((-1.3, -0.9, 0)),
        "stone": scenes.boxes([((0, 0, 0.16), (0.5, 0.36, 0.34))], 256, (0.3, 0.29, 0.27)).moved(
            (1.75, -1.75, 0), 35
        ),
        "tree": tree,
    }
    return things, {"tree": mesh}


#: Metres of snow on the garden.
DEPTH = 0.09


@cache
def snowed():
    things, trees = garden()
    return things, trees, scenes.fallen(things, DEPTH)


def with_snow(name, picture):
    """A picture of the garden under its snow."""
    things, trees, heights = snowed()
    with native.Renderer() as renderer:
        scenes.show(renderer, things, heights, DEPTH, trees)
        made = picture(renderer)
        report(renderer, name)
    return made


BENCH = ((-0.15, -1.2, 0.95), (0.45, -0.5, 0.5))
URN = ((-1.7, -1.85, 1.22), (-1.3, -0.9, 0.76))


def snow_growing():
    """An urn and a bench under 0.3, 1, 3 and 7 cm."""
    things, _ = garden()
    things = {name: things[name] for name in ("ground", "bench", "urn")}
    columns = []
    for depth in (0.003, 0.01, 0.03, 0.07):
        with native.Renderer() as renderer:
            scenes.show(renderer, things, scenes.fallen(things, depth), depth)
            views = [drawn(renderer, *view, (280, 240)) for view in (BENCH, URN)]
            report(renderer, f"{100 * depth:g} cm")
            columns.append(np.concatenate(views))
    return np.concatenate(columns, axis=1)


def grey_map(heights, size):
    """A map as a picture, deep snow white; the nearest texels in a square of `size` pixels."""
    at = (np.arange(size) + 0.5) * len(heights) / size
    shown = heights[at.astype(int)[:, None], at.astype(int)]
    share = np.clip(shown / max(float(np.percentile(heights, 99.5)), 1e-6), 0.0, 1.0)
    low, high = np.array((28, 42, 84.0)), np.array((255, 255, 255.0))
    return (low + share[..., None] * (high - low)).astype(np.uint8)


def snow_filter(size=400):
    """An urn of one chart with a seam towards the camera: without and with the output's smoothing."""
    urn = {"urn": scenes.urn().moved((0, 0, 0), -65)}
    columns = []
    for blur in (0.0, 0.02):
        heights = scenes.fallen(urn, 0.07, steps=8, blur_radius=blur, pixel_size=0.015)["urn"]
        with native.Renderer() as renderer:
            scenes.show(renderer, urn, {"urn": heights}, 0.07)
            light = {**scenes.LIGHT, "background": (0.5, 0.6, 0.75)}
            view = drawn(renderer, (0.42, -1.05, 1.22), (0.05, -0.17, 0.77), (size, size), 0.6, light)
            # The rows of the map that snow lies in, above the view: rows run upwards.
            columns.append(np.concatenate([view, grey_map(heights, size)[7 * size // 10 :]]))
            report(renderer, f"smoothed over {1e3 * blur:g} mm")
    return np.concatenate(columns, axis=1)


def snow_close():
    def picture(renderer):
        size = (440, 330)
        return np.concatenate([both(renderer, *view, size) for view in (BENCH, URN)])

    return with_snow("from near", picture)


def snow_garden():
    flakes = native.Snowfall(rate=4e-6, direction=scenes.FALL, radius=0.004, time=1.0, seed=3)
    return with_snow(
        "garden",
        lambda renderer: drawn(renderer, (0.3, -6.4, 1.55), (0.2, 0, 1.35), (960, 600), snowfall=flakes),
    )


def snow_tree():
    def picture(renderer):
        whole = drawn(renderer, (1.6, -7.6, 2.1), (0, 0, 2.0), (430, 540))
        near = drawn(renderer, (-0.9, -1.5, 2.3), (0, 0, 1.75), (430, 540), 0.6)
        return np.concatenate([whole, near], axis=1)

    return with_snow("tree", picture)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default=",".join(NAMES))
    parser.add_argument("--out", default=scenes.ROOT / "docs" / "images")
    arguments = parser.parse_args()
    names = arguments.only.split(",")
    if not set(names) <= set(NAMES):
        parser.error(f"--only takes some of {', '.join(NAMES)}")
    for name in names:
        native.write_png(str(Path(arguments.out) / f"{name}.png"), globals()[name]())


if __name__ == "__main__":
    main()
