# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the snow core against its requirements and prints a table: item, required, measured, holds.

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
from amounts import conservation, evenness, spikes, stability, thin  # noqa: E402
from fallen import percent  # noqa: E402
from meshes import box, grid, native, use_engine, wind  # noqa: E402
from place import place  # noqa: E402
from rows import ROWS, row  # noqa: E402
from seam_gaps import seams  # noqa: E402
from snow_meshes import STAYS  # noqa: E402
from time_and_motion import independence, persistence, turning  # noqa: E402


def extreme_wind():
    """Distance that snow spills into a post's shadow, in footprints of a pixel on the ground."""
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
