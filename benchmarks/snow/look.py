# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the look of the snow and prints a table: item, required, measured, holds.

    python3 benchmarks/snow/look.py [--only box,twig,...] [--json FILE]

Heights are the simulation's output (smoothed, as for displacement). A displaced point is a texel's point plus its
height along the displacement's normal. acceptance.py measures place and amount of snow; look_scenes.py renders whole
scenes.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent.parent / "addon")]
from meshes import box, grid, native, rotated, sphere  # noqa: E402
from rows import ROWS, row  # noqa: E402
from snow_meshes import chart_of_box, cylinder  # noqa: E402
from snowbough.bake import plan  # noqa: E402

DOWN = (0.0, 0.0, -1.0)
REPOSE = np.radians(65.0)
# Metres: fresh snow's, as the add-on has it.
COHESION = 0.005
# Snow stays where it falls.
NONE = 0.5 * np.pi
SECOND = 24


def shared_corners(positions, triangles):
    """Numbers of corners that share a smooth normal: those at one point."""
    _, number = np.unique(np.round(positions, 6), axis=0, return_inverse=True)
    return number.reshape(-1)[triangles].astype(np.int32)


class Scene:
    """Objects of one shot: name -> (positions, triangles, uv); those in `receivers` have maps."""

    def __init__(self, receivers, occluders=None, shading=None, sides=None, **settings):
        settings = {"pixel_size": 0.004, "max_depth": 10.0, "cohesion": COHESION, **settings}
        settings.setdefault("blur_radius", settings["pixel_size"])  # 0 would switch smoothing off
        self.sim = native.SnowSimulation(**settings)
        self.meshes = {name: mesh for name, (mesh, _) in receivers.items()}
        for name, (mesh, resolution) in receivers.items():
            own = {"shading": (shading or {}).get(name), "sides": (sides or {}).get(name, "AUTO")}
            self.sim.add_object(name, mesh[1], mesh[2], resolution=resolution, **own)
        for name, mesh in (occluders or {}).items():
            self.meshes[name] = mesh
            self.sim.add_object(name, mesh[1], mesh[2], resolution=64, receive=False)

    def fall(self, depth, steps, direction=DOWN, seconds=None):
        dt = (seconds or steps / 24.0) / steps
        for step in range(steps):
            moved = {name: mesh[0] for name, mesh in self.meshes.items()} if step == 0 else {}
            self.sim.step(moved, depth / steps, direction, dt)
        return self

    def height(self, name):
        return np.asarray(self.sim.output(name)["height"], np.float64)

    def held(self, name):
        return np.asarray(self.sim.height(name), np.float64)

    def area(self, name):
        return np.asarray(self.sim.texel_area(name), np.float64)

    def balance(self):
        total = self.sim.statistics()["total"]
        fallen = total["deposited_volume"]
        return (total["held_volume"] + total["slid_volume"] - fallen) / max(fallen, 1e-9)


def displaced(mesh, height, shading=None):
    """(bare points, displaced points, heights) of every texel, with smooth normals according to `shading`."""
    positions, triangles, uv = mesh
    table = native.texel_table(triangles, uv, len(height))
    corners = positions.astype(np.float64)[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = np.repeat(face[:, None], 3, axis=1)
    if shading is not None:
        smooth = shading >= 0
        sums = np.zeros((shading.max() + 1, 3))
        np.add.at(sums, shading[smooth], normal[smooth])
        normal[smooth] = sums[shading[smooth]]
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    b = table["barycentric"]
    weights = np.stack([1.0 - b[:, 0] - b[:, 1], b[:, 0], b[:, 1]], axis=1)
    of = table["triangle"]
    points = (weights[:, :, None] * corners[of]).sum(1)
    along = (weights[:, :, None] * normal[of]).sum(1)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    values = height.ravel()[table["texel"]]
    return points, points + along * values[:, None], values


def balances(name, scene):
    error = scene.balance()
    row(f"{name}: held + slid = fallen", "1e-6", f"{error:+.1e}", abs(error) < 1e-6)


def planes():
    for tilt in (0, 30, 60):
        mesh = grid()
        mesh = (rotated(mesh[0], "x", tilt), *mesh[1:])
        for steps in (1, 24):
            scene = Scene({"it": (mesh, 512)}, flutter=np.radians(3.0), repose=NONE).fall(0.05, steps)
            inner = scene.height("it")[40:-40, 40:-40]
            spread = inner.std() / inner.mean()
            row(f"plane at {tilt}, {steps} steps: std / mean", "0.002", f"{spread:.1e}", spread < 0.002)


def ball():
    mesh = sphere(0.4, 32, 16)
    shading = shared_corners(*mesh[:2])
    scene = Scene({"it": (mesh, 1024)}, shading={"it": shading}, repose=NONE).fall(0.06, 1)
    points, _, values = displaced(mesh, scene.held("it"), shading)
    cosine = points[:, 2] / np.linalg.norm(points, axis=1)
    lit = cosine > 0.5
    off = np.abs(values[lit] - 0.06 * cosine[lit]) / 0.06
    row("ball 32 x 16, smooth: from depth x cosine", "2 %", f"{off.max():.2%} at most", off.max() < 0.02)
    flat = np.pi * 0.4**2 * (32 / (2 * np.pi)) * np.sin(2 * np.pi / 32)
    volume = (scene.held("it") * scene.area("it")).sum() / (0.06 * flat) - 1.0
    row("ball 32 x 16, smooth: volume", "1 %", f"{volume:+.2%}", abs(volume) < 0.01)
    balances("ball", scene)


def slopes():
    """A ball's cap at rest: alternation of height between neighbouring texels, which shows as grit at its edge."""
    mesh = sphere(0.4, 64, 32)
    scene = Scene({"it": (mesh, 256)}).fall(0.1, 24).fall(0.0, 4, seconds=4.0)
    held = scene.held("it")[:, 20:236]
    middle = (held[:-2] + held[1:-1] + held[2:]) / 3.0
    teeth = np.abs(held[:-2] - 2.0 * held[1:-1] + held[2:])
    share = np.percentile((teeth / np.maximum(middle, 1e-9))[2:-2][middle[2:-2] > 0.02], 95)
    row("ball's cap at rest: teeth of its slopes", "10 % of the snow", f"{share:.1%}", share < 0.1)
    balances("ball's cap", scene)


def shoulder_radius(profile, step):
    """The least radius of curvature where a profile is convex; its lowest fifth, the foot at the rim, is
    left out."""
    first = np.gradient(profile, step)
    second = np.gradient(first, step)
    bend = np.maximum(-second, 0.0) / (1.0 + first**2) ** 1.5
    return 1.0 / max(bend[profile > 0.2 * profile.max()].max(), 1e-9)


def capped_box():
    mesh, depth = box(0.5, 0.5), 0.15
    scene = Scene({"it": (mesh, 1024)}).fall(depth, 48)
    height = scene.height("it")
    _, moved, values = displaced(mesh, height)
    out = np.abs(moved[values != 0.0][:, :2]).max() - 0.25
    row("box 0.5 m under 0.15: reaches out", "50 mm", f"{out * 1000:.1f} mm", out < depth / 3.0)
    u = np.array([1.0 / 3.0 * 2 + 0.02, 0.52]) * len(height)
    size = np.array([1.0 / 3.0 - 0.04, 0.46]) * len(height)
    top = height[int(u[1]) + 1 : int(u[1] + size[1]) - 1, int(u[0]) + 1 : int(u[0] + size[0]) - 1]
    rim = max(top[0].max(), top[-1].max(), top[:, 0].max(), top[:, -1].max())
    row("box: height at the rim", "50 mm", f"{rim * 1000:.1f} mm", rim < depth / 3.0)
    radius = min(
        shoulder_radius(top[len(top) // 2], 0.5 / top.shape[1]),
        shoulder_radius(top[:, top.shape[1] // 2], 0.5 / top.shape[0]),
    )
    row("box: radius of the shoulder", "30 mm", f"{radius * 1000:.1f} mm", radius > depth / 5.0)
    middle = top[len(top) // 2, top.shape[1] // 2]
    row(
        "box: height in the middle",
        "within 5 % of 150 mm",
        f"{middle * 1000:.1f} mm",
        abs(middle / depth - 1) < 0.05,
    )
    walls = max(np.abs(chart_of_box(scene.held("it"), face)).max() for face in range(4))
    row("box: snow on its walls", "0 mm", f"{walls * 1000:.3f} mm", walls < 1e-6)
    balances("box", scene)


def post():
    mesh, depth = cylinder(0.05, 0.6, 48), 0.15
    shading = shared_corners(*mesh[:2])
    shading[np.arange(len(shading)) % 4 >= 2] = -1
    scene = Scene({"it": (mesh, 512)}, shading={"it": shading}, pixel_size=0.002).fall(depth, 48)
    bare, moved, values = displaced(mesh, scene.height("it"), shading)
    there = values > 0.0005
    width = 2.0 * np.linalg.norm(moved[there][:, :2], axis=1).max() / 0.1
    rise = moved[there][:, 2].max() - 0.3
    row("post 0.1 m under 0.15: width", "1.5 x the post's", f"{width:.2f} x", width < 1.5)
    row("post: height", "1.5 x its width", f"{rise / 0.1:.2f} x", rise < 0.15)
    centre = np.linalg.norm(bare[:, :2], axis=1)
    top = there & (bare[:, 2] > 0.2999)
    drop = values[top & (centre < 0.01)].mean() - values[top & (centre > 0.04)].mean()
    row("post: a rounded cap, not a lid", "drop of 10 mm", f"{drop * 1000:.1f} mm", drop > 0.01)
    balances("post", scene)


def twig():
    mesh, depth = cylinder(0.01, 0.3, 24, "x"), 0.05
    shading = shared_corners(*mesh[:2])
    shading[np.arange(len(shading)) % 4 >= 2] = -1
    scene = Scene({"it": (mesh, 512)}, shading={"it": shading}, pixel_size=0.001).fall(depth, 48)
    bare, moved, values = displaced(mesh, scene.height("it"), shading)
    there = (values > 0.0005) & (np.abs(bare[:, 0]) < 0.1)
    width = np.ptp(moved[there][:, 1]) / 0.02
    rise = (moved[there][:, 2].max() - 0.01) / 0.02
    row("twig 1 cm under 5 cm: cap's width", "1.5 x the twig's", f"{width:.2f} x", width < 1.5)
    row("twig: cap's height", "2.5 x the twig's", f"{rise:.2f} x", rise < 2.5)
    row("twig: carries snow at all", "0.25 x the twig's", f"{rise:.2f} x", rise > 0.25)
    balances("twig", scene)


def steepest(height, step, edge=8):
    """Degrees: the steepest slope of a level map's surface, its border left out."""
    dy, dx = np.gradient(height, step)
    return np.degrees(np.arctan(np.hypot(dx, dy)))[edge:-edge, edge:-edge]


def shelter():
    plate = grid(1.0, 1.0)
    plate[0][:, 2] = 1.0
    scene = Scene({"it": (grid(4.0, 4.0), 512)}, {"roof": plate}).fall(0.25, 48)
    slope = steepest(scene.height("it"), 4.0 / (0.96 * 512)).max()
    row("shelter's bank: steepest slope", "65 degrees", f"{slope:.1f}", slope < 65.5)
    under = scene.height("it")[256 - 20 : 256 + 20, 256 - 20 : 256 + 20].max()
    row("shelter: dry in the middle", "0 mm", f"{under * 1000:.2f} mm", under < 1e-5)
    balances("shelter", scene)


def pile():
    hole, size = 0.3, 3.0
    plates = {}
    width = 0.5 * (size - hole)
    for name, sx, sy, x, y in (
        ("west", width, size, -0.5 * (size - width), 0.0),
        ("east", width, size, 0.5 * (size - width), 0.0),
        ("south", hole, width, 0.0, -0.5 * (size - width)),
        ("north", hole, width, 0.0, 0.5 * (size - width)),
    ):
        plate = grid(sx, sy)
        plate[0][:] += (x, y, 2.0)
        plates[name] = plate
    scene = Scene({"it": (grid(2.0, 2.0), 512)}, plates, repose=np.radians(40.0)).fall(0.6, 96)
    height = scene.held("it")
    step = 2.0 / (0.96 * 512)
    slope = steepest(height, step)
    inner = height[8:-8, 8:-8]
    flank = slope[(inner > 0.25 * inner.max()) & (inner < 0.75 * inner.max())]
    row(
        "pile: flanks against repose of 40",
        "2 degrees",
        f"{np.median(flank):.1f}",
        abs(np.median(flank) - 40.0) < 2.0,
    )
    row(
        "pile: steepest", "42 degrees", f"{np.percentile(slope, 99.9):.1f}", np.percentile(slope, 99.9) < 42.0
    )
    balances("pile", scene)


def gable():
    """A wall under the open sky: flutter puts a thin veil on it, which does not stay."""
    wall = grid(2.0, 1.0)
    wall = (rotated(wall[0], "x", 90), *wall[1:])
    scene = Scene({"it": (wall, 256)}, flutter=np.radians(3.0), sides={"it": "FRONT"}).fall(0.12, 24)
    scene.fall(0.0, SECOND, seconds=1.0)
    veil = np.abs(scene.held("it")).max()
    row("gable, a second after straight fall", "0 mm", f"{veil * 1000:.4f} mm", veil < 1e-7)
    balances("gable", scene)


def both_sides():
    """A card that faces down: it must carry as much snow, on its back, as one that faces up."""
    card = grid(0.2, 0.2)
    down = (rotated(card[0], "x", 180), *card[1:])
    heights = {}
    for name, mesh in (("up", card), ("down", down)):
        heights[name] = Scene({"it": (mesh, 64)}).fall(0.01, 4).held("it")
    up, back = heights["up"].sum(), -heights["down"].sum()
    row(
        "a card that faces down, its snow",
        "as one facing up",
        f"{back / up:.4f} x",
        abs(back / up - 1.0) < 1e-3,
    )


def steps():
    """The edge of a shadow with flutter: difference between a few frames and 250, as a share of the depth."""
    plate = grid(1.0, 1.0)
    plate[0][:, 2] = 1.0
    edges = {}
    for frames in (1, 12, 48, 250):
        scene = Scene({"it": (grid(3.0, 3.0), 256)}, {"roof": plate}, flutter=np.radians(3.0), repose=NONE)
        # A bake divides few frames in this way.
        snowfall = plan.plan_snowfall(1, frames, 0.0, 0.1, [1] * frames)
        for frame in range(1, frames + 1):
            scene.fall(0.1 / frames, plan.frame_directions(snowfall, frame, 64))
        edges[frames] = scene.held("it")[20:-20, 20:-20]
    for frames in (1, 12, 48):
        off = np.abs(edges[frames] - edges[250]).max() / 0.1
        row(f"shadow's edge, {frames} frames against 250", "5 % of the depth", f"{off:.1%}", off < 0.05)


def cost():
    """A step and an output, in ms: a ball over open ground; with repose off, and with both sides and repose."""
    for resolution in (1024, 2048):
        measured = {}
        for name, settings in (("plain", {"repose": NONE}), ("all", {"repose": REPOSE})):
            ball, floor = sphere(0.5, 96, 48), grid(3.0, 3.0)
            ball[0][:, 2] += 0.6
            sides = {
                "ball": "BOTH" if name == "all" else "FRONT",
                "floor": "BOTH" if name == "all" else "FRONT",
            }
            scene = Scene({"ball": (ball, resolution), "floor": (floor, resolution)}, sides=sides, **settings)
            scene.fall(0.005, 2)
            began = time.perf_counter()
            scene.fall(0.02, 8)
            scene.sim.statistics()
            step = (time.perf_counter() - began) / 8
            scene.height("ball")
            began = time.perf_counter()
            scene.height("floor")
            measured[name] = (step, time.perf_counter() - began)
        text = ", ".join(f"{k} {a * 1000:.0f} + {b * 1000:.0f} ms" for k, (a, b) in measured.items())
        ratio = sum(measured["all"]) / sum(measured["plain"])
        row(f"{resolution}: a step + one output", "-", f"{text} ({ratio:.2f} x)", True)


TOPICS = {
    "planes": planes,
    "ball": ball,
    "slopes": slopes,
    "box": capped_box,
    "post": post,
    "twig": twig,
    "shelter": shelter,
    "pile": pile,
    "gable": gable,
    "sides": both_sides,
    "steps": steps,
    "cost": cost,
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default=",".join(TOPICS))
    parser.add_argument("--json")
    options = parser.parse_args()
    for topic in options.only.split(","):
        TOPICS[topic]()
    print(f"{sum(r['holds'] for r in ROWS)} of {len(ROWS)} rows hold")
    if options.json:
        Path(options.json).write_text(json.dumps(ROWS, indent=1) + "\n")


if __name__ == "__main__":
    main()
