# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the snow core against what was asked of it and prints a table: item, asked, measured, holds.

    python3 benchmarks/snow/acceptance.py [--only conservation,place,...] [--engine GL] [--json FILE]

References come from formulas and from ray casting (tests/python/native/snow_rays.py), never from the core itself.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from meshes import (  # noqa: E402
    box,
    bunny,
    grid,
    native,
    rotated,
    sphere,
    spot,
    texel_size,
    tree,
    use_engine,
    wind,
)
from place import place  # noqa: E402
from rows import ROWS, row  # noqa: E402
from snow_meshes import STAYS  # noqa: E402
from snow_rays import outline_area  # noqa: E402

DOWN = (0.0, 0.0, -1.0)


def percent(value):
    return f"{100.0 * value:+.3f} %"


def volume(height, area):
    return float((height.astype(np.float64) * area).sum())


def bake(mesh, steps, depth, direction, resolution, dt=1.0 / 24.0, max_depth=1e6, **settings):
    positions, triangles, uv = mesh
    with native.SnowSimulation(repose=STAYS, max_depth=max_depth, **settings) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution)
        for step in range(steps):
            sim.step({"it": positions} if step == 0 else {}, depth / steps, direction, dt)
        return sim.height("it"), sim.texel_area("it"), sim.statistics()["total"]


def conserve(name, mesh, visible, resolution, pixel_size, direction=DOWN, steps=48, flutter=0.0):
    depth = 0.001 * steps
    height, area, total = bake(
        mesh, steps, depth, direction, resolution, pixel_size=pixel_size, flutter=flutter
    )
    down = -direction[2] / np.linalg.norm(direction)
    expected = depth * visible / down
    error = (volume(height, area) + total["slid_volume"]) / expected - 1.0
    held = total["held_volume"] + total["slid_volume"]
    own = held / (depth / steps * total["visible_area"] / down) - 1.0
    row(
        f"2 {name}, {resolution}, pixel {pixel_size * 1000:.3g} mm",
        "1 %; own area 0.1 %",
        f"{percent(error)}; {percent(own)}, slid {total['slid_volume'] / held:.1%}",
        abs(error) < 0.01 and abs(own) < 0.001,
    )


def conservation():
    for tilt in (0, 30, 60):
        plane = grid()
        plane = (rotated(plane[0], "x", tilt), *plane[1:])
        for resolution in (256, 1024):
            conserve(f"plane at {tilt}", plane, np.cos(np.radians(tilt)), resolution, 0.004)
    disc = 24.0 * np.sin(2.0 * np.pi / 48.0) * 0.25
    for resolution in (256, 512, 1024, 2048):
        conserve("sphere", sphere(), disc, resolution, 0.004)
    texel = texel_size(sphere(), 256)
    for ratio in (0.1, 0.3, 1.0, 3.0, 10.0):
        conserve(f"sphere, pixel {ratio} of a texel", sphere(), disc, 256, ratio * texel)
    for angle in (45, 80, 89):
        conserve(
            f"level ground, wind {angle}",
            grid(cells=2),
            np.cos(np.radians(angle)),
            256,
            0.005 * np.cos(np.radians(angle)) ** 0.5,
            wind(angle, 30.0),
        )
    for name, mesh in (("bunny", bunny()), ("spot", spot()), ("AL06a", tree())):
        if mesh is None:
            row(f"2 {name}", "1 %", "mesh or Blender absent", False)
            continue
        visible = outline_area(mesh[0][mesh[1]], DOWN, 2000)
        texel = texel_size(mesh, 1024)
        for ratio in (1.0, 3.0):
            conserve(f"{name}, pixel {ratio:.0f} texels", mesh, visible, 1024, ratio * texel)
    mesh = bunny()
    if mesh is not None:
        visible = outline_area(mesh[0][mesh[1]], DOWN, 2000)
        for ratio in (0.2, 10.0):
            conserve(f"bunny, pixel {ratio} texels", mesh, visible, 256, ratio * texel_size(mesh, 256))
    layouts(disc)


def layouts(disc):
    """One sphere, many layouts: stretched, turned, scaled, cut into single triangles."""
    positions, triangles, uv = sphere()
    for name, scale in (
        ("stretched 3:1", (0.9, 0.3)),
        ("stretched 1:9", (0.1, 0.9)),
        ("scaled to 0.2", (0.2, 0.2)),
    ):
        changed = (uv * np.float32(scale) + np.float32(0.03)).astype(np.float32)
        conserve(f"sphere, UVs {name}", (positions, triangles, changed), disc, 256, 0.005)
    turn = np.radians(27.0)
    spun = (uv - 0.5) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) * 0.7 + 0.5
    conserve("sphere, UVs turned by 27", (positions, triangles, spun.astype(np.float32)), disc, 256, 0.005)
    # Every triangle a chart of its own, in a cell of a 47 x 47 grid.
    cell = np.stack(np.divmod(np.arange(len(triangles)), 47), axis=1)[:, None, :] / 48.0
    flat = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]]) / 48.0 + cell
    conserve(
        "sphere, every triangle cut off", (positions, triangles, flat.astype(np.float32)), disc, 512, 0.005
    )
    strip, strip_triangles, _ = grid(size_x=0.2)
    corners = (strip[:, :2] + (0.1, 0.5)) / (0.2, 1.0) * (1.5 / 64.0, 0.9) + (10.3 / 64.0, 0.05)
    conserve(
        "UV strip 1.5 texels wide",
        (strip, strip_triangles, corners[strip_triangles].astype(np.float32)),
        0.2,
        64,
        0.005,
    )


def evenness():
    """Open planes after one step and after many: how much thickness varies, worst over sizes of pixels."""
    for steps, flutter in ((1, 0.0), (8, 3.0), (48, 3.0)):
        for tilt, angle in ((0, 0), (30, 0), (60, 0), (0, 45), (0, 80), (0, 89), (20, 80)):
            worst, at = 0.0, 0.0
            for texels in (0.1, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 5.0, 10.0):
                plane = grid(cells=3)
                plane = (rotated(plane[0], "x", tilt), *plane[1:])
                height, _, _ = bake(
                    plane,
                    steps,
                    0.01,
                    wind(angle, 30.0),
                    128,
                    pixel_size=texels * texel_size(plane, 128),
                    flutter=np.radians(flutter),
                )
                lain = height[height > 0.0]
                spread = float(lain.std() / lain.mean())
                worst, at = max((worst, at), (spread, texels))
            row(
                f"1 plane at {tilt}, wind {angle}, {steps} steps, flutter {flutter:.0f}",
                "std / mean <= 0.002",
                f"{worst:.1e} (pixel {at} texels)",
                worst <= 0.002,
            )


def spikes():
    """The largest thickness beside the median on a tree of thin twigs."""
    mesh = tree()
    if mesh is None:
        return
    for pixel_size in (0.005, 0.01, 0.02):
        height, area, _ = bake(
            mesh,
            20,
            0.1 * 20 / 48,
            wind(30.0),
            1024,
            pixel_size=pixel_size,
            max_depth=1.0,
            flutter=np.radians(3.0),
        )
        lain = height[height > 0.0]
        row(
            f"- AL06a, largest thickness, pixel {pixel_size * 1000:.0f} mm",
            "no spike (< 20 x median)",
            f"median {np.median(lain) * 1000:.1f}, p99.9 {np.percentile(lain, 99.9) * 1000:.0f}, "
            f"max {lain.max() * 1000:.0f} mm",
            lain.max() < 20 * np.median(lain),
        )


def largest_read(height, uv):
    """The highest of the four texels that a bilinear reader looks at."""
    size = height.shape[0]
    low = np.floor(uv * size - 0.5).astype(int)
    x0, y0 = np.clip(low, 0, size - 1).T
    x1, y1 = np.clip(low + 1, 0, size - 1).T
    return np.max([height[y0, x0], height[y0, x1], height[y1, x0], height[y1, x1]], axis=0)


def seam_gap(mesh, resolution, sigma_texels, direction=DOWN, steps=12):
    """What the sides of seams differ by: in metres; as a part of the highest texel read there; as a part of
    the height at the point itself, and that over 1 cm. The last two say little where snow ends: within its last
    texel the height falls to 0, and two readers of texels that lie otherwise differ by any part of it."""
    from test_seams import read_map, seam_points

    positions, triangles, uv = mesh
    texel = texel_size(mesh, resolution)
    with native.SnowSimulation(
        repose=STAYS,
        pixel_size=texel,
        max_depth=1.0,
        flutter=np.radians(3.0),
        blur_radius=sigma_texels * texel,
    ) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution)
        for step in range(steps):
            sim.step({"it": positions} if step == 0 else {}, 0.1 / steps, direction, 1.0 / 24.0)
        height = sim.output("it", normal=False)["height"]
    sides = seam_points(triangles, uv, resolution)
    first, second = (read_map(height, side) for side in sides)
    around = np.maximum(*(largest_read(height, side) for side in sides))
    local = 0.5 * (first + second)
    covered = local > 0.0
    # Relative to the local height, where there is height to speak of: a thousandth of what fell.
    gap = abs(first - second)
    relative = gap[covered] / np.maximum(around[covered], 1e-4)
    pointwise = gap[covered] / np.maximum(local[covered], 1e-4)
    deep = local > 0.01
    return gap, relative, pointwise, gap[deep] / local[deep], texel


def seams():
    for name, mesh in (("bunny, Smart UV", bunny()), ("AL06a", tree())):
        if mesh is None:
            row(f"7 seams of {name}", "p99 < 1 %", "mesh or Blender absent", False)
            continue
        gap, relative, pointwise, deep, texel = seam_gap(mesh, 1024, 3.0)
        row(
            f"7 seams of {name}, sigma 3 texels",
            "p99 < 1 %",
            f"p99 {np.percentile(relative, 99):.2%} of the snow within a texel; of that at the point "
            f"{np.percentile(pointwise, 99):.2%}, over 1 cm {np.percentile(deep, 99):.2%}",
            np.percentile(relative, 99) < 0.01,
        )
        row(
            f"7 {name}, crack when displaced",
            "none to be seen",
            f"p99 {np.percentile(gap, 99) * 1000:.3f}, max {gap.max() * 1000:.2f} mm of {texel * 1000:.1f}",
            np.percentile(gap, 99) < 0.25 * texel,
        )


def extreme_wind():
    """How far snow spills into a post's shadow, in footprints of a pixel on the ground."""
    for angle in (80, 89):
        tangent = np.tan(np.radians(angle))
        pixel = 0.004 if angle == 80 else 0.0008
        top = 0.3 if angle == 80 else 0.03
        ground, post = grid(4.0, 4.0), box(0.2, top)
        with native.SnowSimulation(repose=STAYS, pixel_size=pixel, max_depth=1e6) as sim:
            sim.add_object("ground", ground[1], ground[2], resolution=1024)
            sim.add_object("post", post[1], post[2], resolution=256)
            shift = np.float32((0.0, -1.0, 0.0))
            for step in range(16):
                sim.step(
                    {"ground": ground[0], "post": post[0] + shift} if step == 0 else {},
                    0.01,
                    wind(angle),
                    0.0,
                )
            height, on_post = sim.height("ground"), sim.height("post")
        places = (np.arange(1024) + 0.5) / 1024.0
        x, y = np.meshgrid(*([(places - 0.02) / 0.96 * 4.0 - 2.0] * 2))
        texel, footprint = 4.0 / (0.96 * 1024), pixel / np.cos(np.radians(angle))
        across = (0.1 - abs(x) - 0.5 * texel) / pixel
        along = (np.minimum(y + 1.1, -0.9 + top * tangent - y) - 0.5 * texel) / footprint
        spill = np.minimum(across, along)[height > 0.0].max()
        row(
            f"8 wind {angle}: spill into the shadow",
            "<= 0.5 of a footprint",
            f"{spill:.2f} (half a texel allowed)",
            spill <= 0.5,
        )
        lit = (abs(x) < 0.3) & (abs(x) > 0.12) & (abs(y) < 1.5)
        row(
            f"8 wind {angle}: beside the shadow",
            "depth as on open ground",
            f"{height[lit].mean() / 0.16:.4f} of it, p5 {np.percentile(height[lit], 5) / 0.16:.2f}",
            abs(height[lit].mean() / 0.16 - 1.0) < 0.02,
        )
        third = 256 // 3
        windward = on_post[8:120, 2 * third + 10 : 3 * third - 6]
        lee = on_post[136:248, 10 : third - 10]
        row(
            f"8 wind {angle}: windward wall / lee wall",
            f"{0.16 * tangent:.2f} m / 0",
            f"{windward.mean():.3f} m / {lee.max():.3f}",
            abs(windward.mean() / (0.16 * tangent) - 1.0) < 0.05 and lee.max() == 0.0,
        )


def persistence():
    ground, plate = grid(), grid(size_x=0.5, size_y=2.0)
    with native.SnowSimulation(repose=STAYS, pixel_size=0.004, max_depth=1e6) as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=256)
        sim.add_object("plate", plate[1], plate[2], receive=False)
        for step in range(24):
            x = 0.25 if step < 12 else 5.0
            sim.step({"ground": ground[0], "plate": plate[0] + np.float32((x, 0.0, 1.0))}, 0.01)
        height = sim.height("ground")
    left, right = height[12:-12, 12:120].mean(), height[12:-12, 136:-12].mean()
    row(
        "4 an occluder leaves half-way",
        "step 0.24 / 0.12, 2 %",
        f"{left:.4f} / {right:.4f}",
        abs(left / 0.24 - 1) < 0.02 and abs(right / 0.12 - 1) < 0.02,
    )
    # A limb that bends like one with an armature, under falling snow.
    limb = grid(0.4, 2.0, 16)
    with native.SnowSimulation(repose=STAYS, pixel_size=0.004, max_depth=1e6) as sim:
        sim.add_object("limb", limb[1], limb[2], resolution=256)
        sim.step({"limb": limb[0]}, 0.05, DOWN, 0.0)
        before = sim.height("limb")
        for step in range(12):
            turn = np.radians(2.0 * step) * np.clip(limb[0][:, 1], 0.0, 1.0)
            bent = limb[0].copy()
            bent[:, 1] = np.where(limb[0][:, 1] > 0, limb[0][:, 1] * np.cos(turn), limb[0][:, 1])
            bent[:, 2] = np.where(limb[0][:, 1] > 0, limb[0][:, 1] * np.sin(turn), 0.0)
            sim.step({"limb": bent}, 0.0)
        kept = np.array_equal(sim.height("limb"), before)
        sim.step({}, 0.05, DOWN, 0.0)
        gained = volume(sim.height("limb") - before, sim.texel_area("limb"))
    expected = 0.05 * outline_area(bent[limb[1]], DOWN, 600)
    row(
        "4 a bending mesh keeps its snow",
        "bit for bit; then gains",
        f"kept {kept}; {percent(gained / expected - 1)}",
        kept and abs(gained / expected - 1) < 0.01,
    )
    thing = box()
    with native.SnowSimulation(repose=STAYS, pixel_size=0.005, max_depth=1e6) as sim:
        sim.add_object("box", thing[1], thing[2], resolution=256)
        for bearing in (0.0, 180.0):
            for _ in range(8):
                sim.step({"box": thing[0]}, 0.01, wind(45.0, bearing), 0.0)
        height = sim.height("box")
    from snow_meshes import chart_of_box

    walls = [chart_of_box(height, face).mean() for face in (2, 3, 5)]
    row(
        "4 a wind that turns leaves both layers",
        "0.08 / 0.08 / 0.16",
        " / ".join(f"{w:.4f}" for w in walls),
        np.allclose(walls, (0.08, 0.08, 0.16), rtol=0.03),
    )


def turning(rotate_to=180.0):
    ball = sphere(around=96, rings=48)
    with native.SnowSimulation(repose=STAYS, pixel_size=0.005, max_depth=0.3, slide_half_life=0.5) as sim:
        sim.add_object("ball", ball[1], ball[2], resolution=256)
        for _ in range(24):
            sim.step({"ball": ball[0]}, 0.1 / 24.0)
        first = sim.statistics()["held_volume"]
        held = []
        for frame in range(1, 49):
            sim.step({"ball": rotated(ball[0], "x", rotate_to * min(1.0, frame / 24))}, 0.0)
            held.append(sim.statistics()["held_volume"])
        for _ in range(96):
            sim.step({}, 0.0)
        last, total = sim.statistics()["held_volume"], sim.statistics()["total"]
    row(
        "6 ball turned over: at 90 deg, 180 deg, 5 s later",
        "keeps, then sheds",
        f"{held[11] / first:.2f}, {held[23] / first:.2f}, {last / first:.4f}",
        held[11] / first > 0.5 and last < 0.01 * first,
    )
    books = (total["held_volume"] + total["slid_volume"]) / total["deposited_volume"] - 1.0
    row("6 ball: held + slid = deposited", "0.1 %", percent(books), abs(books) < 1e-3)


def independence():
    for max_depth, kind in ((1e6, "without sliding"), (0.05, "with sliding")):
        for name, mesh in (("plane at 40", (rotated(grid()[0], "x", 40), *grid()[1:])), ("sphere", sphere())):
            held, middle = [], []
            for rate in (24, 30, 60, 240):
                height, area, _ = bake(
                    mesh,
                    rate,
                    0.1,
                    DOWN,
                    128,
                    dt=1.0 / rate,
                    max_depth=max_depth,
                    slide_half_life=0.5,
                    pixel_size=0.005,
                )
                held.append(volume(height, area))
                middle.append(np.median(height[height > 0]))
            spread = max(held) / min(held) - 1.0
            depth = max(middle) / min(middle) - 1.0
            row(
                f"5 24, 30, 60, 240 steps a second, {name}, {kind}",
                "1 %",
                f"{percent(spread)}, median {percent(depth)}",
                spread < 0.01 and depth < 0.01,
            )
    pictures = []
    ball = sphere()
    for scale in (0.01, 1.0, 100.0):
        height, _, _ = bake(
            (ball[0] * np.float32(scale), *ball[1:]),
            16,
            0.16 * scale,
            wind(20.0),
            256,
            pixel_size=0.005 * scale,
            max_depth=0.1 * scale,
        )
        pictures.append(height / scale)
    for picture, scale in ((pictures[0], "1/100"), (pictures[2], "100")):
        mean = abs(picture - pictures[1]).mean() / pictures[1].mean()
        same = (abs(picture - pictures[1]) > 0.01 * pictures[1].max()).mean()
        row(
            f"5 scale {scale}",
            "the same picture",
            f"mean difference {percent(mean)}, texels off {percent(same)}",
            mean < 1e-3,
        )


def stability():
    for tilt in (0, 30, 60):
        mesh = (rotated(grid()[0], "x", tilt), *grid()[1:])
        height, _, _ = bake(
            mesh, 60, 0.5, DOWN, 64, dt=1.0, max_depth=0.2, slide_half_life=0.01, pixel_size=0.01
        )
        wanted = 0.2 * np.cos(np.radians(tilt))
        row(
            f"6 capacity at {tilt}",
            f"{wanted:.4f} m",
            f"{np.median(height):.4f} m",
            abs(np.median(height) / wanted - 1) < 0.01,
        )


def thin():
    for name, width, angle in (
        ("a third of a pixel", 0.01, 0),
        ("a tenth of a pixel", 0.003, 0),
        ("a third, slanting", 0.01, 30),
    ):
        twig = grid(size_x=width)
        twig = (rotated(rotated(twig[0], "z", 17.0), "x", angle), *twig[1:])
        visible = outline_area(twig[0][twig[1]], DOWN, 1000)
        height, area, _ = bake(twig, 96, 0.96, DOWN, 64, pixel_size=0.03)
        row(
            f"9 twig {name}",
            "10 %",
            percent(volume(height, area) / (0.96 * visible) - 1.0),
            abs(volume(height, area) / (0.96 * visible) - 1.0) < 0.1,
        )


def many():
    tile = grid(0.1, 0.1)
    started = time.perf_counter()
    with native.SnowSimulation(repose=STAYS, pixel_size=0.01, max_depth=1e6) as sim:
        placed = {}
        for i in range(1000):
            sim.add_object(f"{i:04}", tile[1], tile[2], resolution=128)
            placed[f"{i:04}"] = tile[0] + np.float32((0.15 * (i % 40), 0.15 * (i // 40), 0.0))
        text = sim.memory_estimate()["text"]
        for step in range(12):
            sim.step(placed if step == 0 else {}, 0.01)
        books = sim.statistics()["objects"]
        volumes = np.array([books[name]["total"]["deposited_volume"] for name in placed]) / (0.12 * 0.01)
    row(
        "10 1,000 receivers at 128",
        "runs; 1 % on average",
        f"mean {percent(volumes.mean() - 1)}, {volumes.min():.2f} to {volumes.max():.2f}, "
        f"{time.perf_counter() - started:.1f} s",
        abs(volumes.mean() - 1) < 0.01,
    )
    print("   ", text)
    for resolution in (4096, 8192):
        started = time.perf_counter()
        try:
            with native.SnowSimulation(repose=STAYS, pixel_size=0.002, max_depth=1e6) as sim:
                sim.add_object("big", tile[1], tile[2], resolution=resolution)
                sim.add_object("small", tile[1], tile[2], resolution=64)
                print("   ", sim.memory_estimate()["text"])
                sim.step({"big": tile[0], "small": tile[0] + np.float32((1.0, 0.0, 0.0))}, 0.01)
                held = sim.statistics()["objects"]["big"]["held_volume"]
            row(
                f"10 a map of {resolution} beside one of 64",
                "1 %",
                f"{percent(held / 1e-4 - 1)}, {time.perf_counter() - started:.1f} s",
                abs(held / 1e-4 - 1) < 0.01,
            )
        except RuntimeError as error:
            row(f"10 a map of {resolution} beside one of 64", "1 %", f"RuntimeError: {error}"[:150], False)
    with native.SnowSimulation(repose=STAYS, pixel_size=0.002) as sim:
        try:
            for i in range(24):
                sim.add_object(f"{i}", tile[1], tile[2], resolution=4096)
            sim.step({f"{i}": tile[0] for i in range(24)}, 0.01)
            row("10 a scene that does not fit", "refused with figure", "was taken (24 maps of 4096)", False)
        except RuntimeError as error:
            row(
                "10 a scene that does not fit",
                "refused, figure and hint",
                str(error)[:160],
                "MiB" in str(error) and "lower" in str(error),
            )


TOPICS = {
    "evenness": evenness,
    "conservation": conservation,
    "place": place,
    "spikes": spikes,
    "persistence": persistence,
    "independence": independence,
    "stability": stability,
    "turning": turning,
    "seams": seams,
    "wind": extreme_wind,
    "thin": thin,
    "many": many,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default=",".join(TOPICS))
    parser.add_argument("--engine", choices=("AUTO", "GL", "CPU"), default="AUTO")
    parser.add_argument("--json")
    given = parser.parse_args()
    use_engine(given.engine)
    for topic in given.only.split(","):
        started = time.perf_counter()
        TOPICS[topic]()
        print(f"    ({topic}: {time.perf_counter() - started:.0f} s)", flush=True)
    failed = [entry["item"] for entry in ROWS if not entry["holds"]]
    print(f"{len(ROWS) - len(failed)} of {len(ROWS)} hold" + "".join(f"\n  not: {item}" for item in failed))
    if given.json:
        Path(given.json).write_text(json.dumps(ROWS, indent=1))


if __name__ == "__main__":
    main()
