# SPDX-License-Identifier: GPL-3.0-or-later
"""Repose gives the same snow whatever the UV layout does to a surface: turns, stretches, shears or cuts it."""

import functools
import math

import numpy as np
import pytest
import snowbough_native as native
from snow_layouts import LAYOUTS, SHAPES, laid_out

DEPTH = 0.1


@functools.cache
def snow_on(name, layout):
    """(heights, texel areas, m3 that fell on it) of a shape at rest."""
    smooth = name == "ball"
    resolution = 2048 if smooth else 1024  # the ball has 512 faces, the others 32 at most
    positions, triangles, uv, _ = laid_out(SHAPES[name](), LAYOUTS[layout])
    with native.SnowSimulation(
        repose=math.radians(65.0), cohesion=0.0, pixel_size=0.01, max_depth=100.0, engine="CPU"
    ) as sim:
        sim.add_object("shape", triangles, uv, resolution=resolution, shading=triangles if smooth else None)
        for step in range(8):
            sim.step({"shape": positions} if step == 0 else {}, DEPTH / 8, (0.0, 0.0, -1.0), 1.0 / 24.0)
        for _ in range(3):
            sim.step({}, 0.0, (0.0, 0.0, -1.0), 1.0)
        fallen = sim.statistics()["total"]["deposited_volume"]
        return np.abs(sim.height("shape").astype(float)), sim.texel_area("shape"), fallen


@pytest.mark.parametrize("name", SHAPES)
def test_five_layouts_carry_the_same_snow(name):
    volumes = {}
    for layout in LAYOUTS:
        heights, areas, fallen = snow_on(name, layout)
        volumes[layout] = float((heights * areas).sum())
    print(name, volumes, "of", fallen)
    # For a cone too steep to hold snow: fractions of the fallen snow.
    most = fallen * 1e-3 if name == "cone" else 0.02 * np.mean(list(volumes.values()))
    assert max(volumes.values()) - min(volumes.values()) < most


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_cone_steeper_than_repose_is_bare_in_every_layout(layout):
    heights, areas, fallen = snow_on("cone", layout)
    # The remaining snow is in the row of texels at its foot.
    assert float((heights * areas).sum()) < 1e-3 * fallen
    assert float(areas[heights > 1e-3].sum()) < 0.02 * float(areas.sum())
