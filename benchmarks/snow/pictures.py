# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the snow core's results: simulates, displaces, renders with Cycles.

    python3 benchmarks/snow/pictures.py [--samples 24] [--only bunny,ball_before,...]

Writes build/snow/pictures/<name>.png. The pictures show the output maps: every vertex is moved along its normal by the
height at its UVs; with `split`, each corner is moved by itself, so that cracks would be visible.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from meshes import (  # noqa: E402
    BUILD,
    box,
    bunny,
    grid,
    in_blender,
    native,
    rotated,
    sphere,
    texel_size,
    tree,
    wind,
)

OUT = BUILD / "pictures"
FPS = 1.0 / 24.0


def read_map(height, uv):
    """Bilinear, (N, 2) -> (N,)."""
    size = height.shape[0]
    at = np.clip(uv * size - 0.5, 0.0, size - 1.001)
    low = at.astype(int)
    x, y = (at - low).T
    c, r = low.T
    return (height[r, c] * (1 - x) + height[r, c + 1] * x) * (1 - y) + (
        height[r + 1, c] * (1 - x) + height[r + 1, c + 1] * x
    ) * y


def vertex_normals(positions, triangles):
    corners = positions[triangles].astype(np.float64)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros((len(positions), 3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], face)
    return normals / (np.linalg.norm(normals, axis=1)[:, None] + 1e-300)


def divided(mesh, times):
    """Splits every triangle into four, `times` times, so that heights can move vertices."""
    positions, triangles, uv = mesh
    for _ in range(times):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        unique, inverse = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
        middle = inverse.reshape(-1, 3) + len(positions)
        positions = np.concatenate([positions, positions[unique].mean(axis=1)]).astype(np.float32)
        mids = 0.5 * (uv + np.roll(uv, -1, axis=1))
        a, b, c = triangles.T
        x, y, z = middle.T
        triangles = np.concatenate(
            [np.stack(t, axis=1) for t in ((a, x, z), (x, b, y), (z, y, c), (x, y, z))]
        )
        A, B, C = uv[:, 0], uv[:, 1], uv[:, 2]
        X, Y, Z = mids[:, 0], mids[:, 1], mids[:, 2]
        uv = np.concatenate([np.stack(t, axis=1) for t in ((A, X, Z), (X, B, Y), (Z, Y, C), (X, Y, Z))])
    return positions, triangles.astype(np.int32), uv.astype(np.float32)


def displaced(mesh, height, split=False):
    """Vertices moved by the map and the height at each: per corner with `split`, else the corners' mean."""
    positions, triangles, uv = mesh
    at_corner = read_map(height, uv.reshape(-1, 2))
    normals = vertex_normals(positions, triangles)
    flat = triangles.ravel()
    if split:
        return (
            positions[flat] + normals[flat] * at_corner[:, None],
            np.arange(len(flat)).reshape(-1, 3),
            at_corner,
        )
    count = np.bincount(flat, minlength=len(positions))
    mean = np.bincount(flat, at_corner, minlength=len(positions)) / np.maximum(count, 1)
    return positions + normals * mean[:, None], triangles, mean


def welded(mesh):
    """Merges vertices at one place: the sphere of the tests has two along its meridian."""
    positions, triangles, uv = mesh
    _, first, inverse = np.unique(np.round(positions, 5), axis=0, return_index=True, return_inverse=True)
    return positions[first], inverse.ravel()[triangles].astype(np.int32), uv


def write(name, parts, camera, target, lens=50.0, sun=(0.5, -0.6, 0.9), wire=0.0):
    arrays = {}
    for i, (positions, triangles, snow, colour) in enumerate(parts):
        arrays |= {
            f"p{i}": positions.astype(np.float32),
            f"t{i}": triangles.astype(np.int32),
            f"s{i}": snow.astype(np.float32),
            f"c{i}": np.float32(colour),
        }
    OUT.mkdir(parents=True, exist_ok=True)
    np.savez(OUT / f"{name}.npz", **arrays)
    return {
        "name": name,
        "count": len(parts),
        "camera": camera,
        "target": target,
        "lens": lens,
        "sun": sun,
        "wire": wire,
    }


def fall(meshes, poses, steps, depth, direction=(0, 0, -1), resolution=1024, pixel_size=0.008, **settings):
    """Simulates; poses(step) gives the positions that changed. Returns the output heights by name."""
    with native.SnowSimulation(
        pixel_size=pixel_size, **{"flutter": np.radians(3.0), "blur_radius": 0.01, **settings}
    ) as sim:
        for name, (_, triangles, uv) in meshes.items():
            sim.add_object(name, triangles, uv, resolution=resolution)
        for step in range(steps):
            sim.step({name: m[0] for name, m in meshes.items()} | poses(step), depth / steps, direction, FPS)
        return {name: sim.output(name, normal=False)["height"] for name in meshes}


GROUND, THING, BALL = (0.10, 0.09, 0.08), (0.35, 0.12, 0.08), (0.08, 0.16, 0.35)


def picture_bunny():
    rabbit = bunny()
    rabbit[0][:, 2] -= rabbit[0][:, 2].min()
    floor = grid(4.0, 4.0, 256)
    maps = fall({"bunny": rabbit, "floor": floor}, lambda step: {}, 24, 0.06)
    return [
        write(
            "bunny",
            [(*displaced(rabbit, maps["bunny"]), THING), (*displaced(floor, maps["floor"]), GROUND)],
            (2.6, -3.4, 2.3),
            (-0.15, 0.0, 0.7),
        )
    ]


def picture_ball():
    ball = welded(sphere(0.5, 256, 128))
    settings = {"resolution": 512, "max_depth": 0.3, "slide_half_life": 0.8}
    scenes = []
    for name, turn in (
        ("ball_before", 0),
        ("ball_turned_90", 12),
        ("ball_turned_180", 24),
        ("ball_later", 72),
    ):

        def pose(step, turn=turn):
            return {"ball": rotated(ball[0], "x", 7.5 * min(24, max(0, step - 23)))}

        with native.SnowSimulation(
            pixel_size=0.006,
            blur_radius=0.01,
            flutter=np.radians(3.0),
            max_depth=0.3,
            slide_half_life=settings["slide_half_life"],
        ) as sim:
            sim.add_object("ball", ball[1], ball[2], resolution=512)
            for step in range(24 + turn):
                sim.step(pose(step), 0.12 / 24 if step < 24 else 0.0, (0, 0, -1), FPS)
            height = sim.output("ball", normal=False)["height"]
        posed = (rotated(ball[0], "x", 7.5 * min(24, turn)), *ball[1:])
        scenes.append(write(name, [(*displaced(posed, height), BALL)], (1.9, -2.7, 1.0), (0, 0, 0), 55.0))
    return scenes


def picture_cart():
    cart, floor = divided(box(0.8, 0.5), 5), grid(5.0, 5.0, 320)
    lift = np.float32((0.0, 0.0, 0.15))

    def place(step):
        return np.float32((-1.3 + 2.6 * max(0, step - 24) / 23.0, 0.0, 0.0)) + lift

    maps = fall(
        {"cart": cart, "floor": floor},
        lambda step: {"cart": cart[0] + place(step)},
        48,
        0.14,
        direction=wind(15.0, 90.0),
    )
    moved = (cart[0] + place(47), *cart[1:])
    return [
        write(
            "cart",
            [(*displaced(moved, maps["cart"]), THING), (*displaced(floor, maps["floor"]), GROUND)],
            (1.0, -4.8, 3.4),
            (0.0, 0.0, 0.2),
            40.0,
        )
    ]


def picture_wind():
    scenes = []
    for angle, pixel in ((80, 0.004), (89, 0.0015)):
        floor, thing, ball = grid(5.0, 5.0, 320), divided(box(0.4, 0.25), 5), welded(sphere(0.2, 128, 64))
        thing = (thing[0] + np.float32((-0.7, -1.2, 0.0)), *thing[1:])
        ball = (ball[0] + np.float32((0.6, -1.2, 0.2)), *ball[1:])
        maps = fall(
            {"ball": ball, "floor": floor, "thing": thing},
            lambda step: {},
            16,
            0.03 if angle == 80 else 0.006,
            direction=wind(angle),
            pixel_size=pixel,
            flutter=0.0,
            blur_radius=0.004,
        )
        scenes.append(
            write(
                f"wind_{angle}",
                [
                    (*displaced(thing, maps["thing"]), THING),
                    (*displaced(ball, maps["ball"]), BALL),
                    (*displaced(floor, maps["floor"]), GROUND),
                ],
                (-2.6, -4.4, 2.6),
                (0.0, -0.4, 0.1),
                40.0,
            )
        )
    return scenes


def picture_junction():
    whole = tree()
    texel = texel_size(whole, 1024)
    maps = fall({"tree": whole}, lambda step: {}, 24, 0.05, pixel_size=texel, blur_radius=2 * texel)
    # The thickest fork over 1.5 m: the part of the tree around it.
    low = whole[0][whole[1]].mean(axis=1)
    spot = low[np.argmin(np.linalg.norm(low - (0.0, 0.0, 2.2), axis=1))]
    keep = np.linalg.norm(low - spot, axis=1) < 1.2
    part = (whole[0], whole[1][keep], whole[2][keep])
    part = divided(part, 3)
    moved = displaced(part, maps["tree"], split=True)
    eye, look = tuple(spot + (1.1, -1.5, 0.9)), tuple(spot)
    everything = displaced(whole, maps["tree"])
    return [
        write("junction", [(*moved, THING)], eye, look, 60.0),
        write("junction_wire", [(*moved, THING)], tuple(spot + (0.5, -0.7, 0.45)), look, 60.0, wire=0.0008),
        write("tree", [(*everything, THING)], (6.5, -8.0, 5.0), (0, 0, 2.8), 45.0),
    ]


PICTURES = {
    "bunny": picture_bunny,
    "ball": picture_ball,
    "cart": picture_cart,
    "wind": picture_wind,
    "junction": picture_junction,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=24)
    parser.add_argument("--only", default=",".join(PICTURES))
    given = parser.parse_args()
    for topic in given.only.split(","):
        scenes = PICTURES[topic]()
        plan = OUT / f"{topic}.json"
        plan.write_text(json.dumps({"scenes": scenes, "samples": given.samples}, default=float))
        in_blender("render.py", plan)
        for scene in scenes:
            print(OUT / f"{scene['name']}.png", flush=True)


if __name__ == "__main__":
    main()
