# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow on one mesh, for tests of its distribution."""

from contextvars import ContextVar

import numpy as np
import snowbough_native as native
from snow_meshes import STAYS

DOWN = (0.0, 0.0, -1.0)


# The engine of simulations that name none.
ENGINE = ContextVar("engine", default="AUTO")


def new_simulation(**settings):
    return native.SnowSimulation(**{"engine": ENGINE.get(), **settings})


def simulation(pixel_size=0.02, max_depth=100.0, repose=STAYS, **settings):
    return new_simulation(pixel_size=pixel_size, max_depth=max_depth, repose=repose, **settings)


def snow_on(
    mesh, steps=8, depth=0.08, direction=DOWN, resolution=64, dt=1.0 / 24.0, sides="AUTO", **settings
):
    """Height, texel area and statistics after `depth` fell on one mesh in `steps` steps."""
    positions, triangles, uv = mesh
    with simulation(**settings) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution, sides=sides)
        for _ in range(steps):
            sim.step({"it": positions}, depth / steps, direction, dt)
        return sim.height("it"), sim.texel_area("it"), sim.statistics()


def volume(height, area):
    return float((height.astype(np.float64) * area).sum())
