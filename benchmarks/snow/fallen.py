# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the parts of acceptance.py: one mesh under falling snow, and the snow on it."""

import numpy as np
from meshes import native
from snow_meshes import STAYS

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
