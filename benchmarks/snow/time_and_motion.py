# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow over time and on moving objects: the parts "persistence", "turning" and "independence" of acceptance.py."""

import numpy as np
from fallen import DOWN, bake, percent, volume
from meshes import box, grid, native, rotated, sphere, wind
from rows import row
from snow_meshes import STAYS, chart_of_box
from snow_rays import outline_area


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
