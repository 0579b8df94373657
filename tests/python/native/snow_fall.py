# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow on one mesh or several, for tests of where it lies."""

import math
from contextvars import ContextVar

import numpy as np
import snowbough_native as native
from snow_meshes import STAYS, grid

DOWN = (0.0, 0.0, -1.0)
FRAME = 1.0 / 24.0


# The engine of simulations that name none.
ENGINE = ContextVar("engine", default="AUTO")


def new_simulation(**settings):
    return native.SnowSimulation(**{"engine": ENGINE.get(), **settings})


def simulation(pixel_size=0.02, max_depth=100.0, repose=STAYS, **settings):
    return new_simulation(pixel_size=pixel_size, max_depth=max_depth, repose=repose, **settings)


def snow_on(mesh, steps=8, depth=0.08, direction=DOWN, resolution=64, dt=FRAME, sides="AUTO", **settings):
    """Height, texel area and statistics after `depth` fell on one mesh in `steps` steps."""
    positions, triangles, uv = mesh
    with simulation(**settings) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution, sides=sides)
        for _ in range(steps):
            sim.step({"it": positions}, depth / steps, direction, dt)
        return sim.height("it"), sim.texel_area("it"), sim.statistics()


def volume(height, area):
    return float((height.astype(np.float64) * area).sum())


def sheet(size=2.0, z=0.0, resolution=256):
    positions, triangles, uv = grid(size, size)
    return positions + np.float32([0.0, 0.0, z]), triangles, uv, resolution


def snow_over(meshes, shade=(), **settings):
    """A simulation of meshes with the resolutions of their maps; those in `shade` have none."""
    settings = {
        "pixel_size": 0.01,
        "max_depth": 1.0,
        "repose": math.radians(65.0),
        "engine": "CPU",
        **settings,
    }
    sim = native.SnowSimulation(**settings)
    for name, (_, triangles, uv, resolution) in meshes.items():
        sim.add_object(name, triangles, uv, resolution=resolution, receive=name not in shade)
    return sim


def fall(sim, meshes, depth=0.2, steps=32, direction=DOWN, begin=0):
    for step in range(begin, begin + steps):
        positions = {name: mesh[0] for name, mesh in meshes.items()} if step == 0 else {}
        sim.step(positions, depth / steps, direction, FRAME)


def fallen(mesh, depth, name="it", resolution=128, **settings):
    """The map that is drawn of a mesh after a fall."""
    with native.SnowSimulation(pixel_size=0.02, blur_radius=0.02, engine="CPU", **settings) as sim:
        sim.add_object(name, mesh[1], mesh[2], resolution=resolution)
        fall(sim, {name: mesh}, depth, 8)
        return sim.output(name, normal=False)["height"]
