# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences of height between the two sides of a seam: the part "seams" of acceptance.py."""

import numpy as np
from fallen import DOWN
from meshes import bunny, native, texel_size, tree
from rows import row
from snow_meshes import STAYS
from test_seams import read_map, seam_points


def largest_read(height, uv):
    """The highest of the four texels of a bilinear sample."""
    size = height.shape[0]
    low = np.floor(uv * size - 0.5).astype(int)
    x0, y0 = np.clip(low, 0, size - 1).T
    x1, y1 = np.clip(low + 1, 0, size - 1).T
    return np.max([height[y0, x0], height[y0, x1], height[y1, x0], height[y1, x1]], axis=0)


def seam_gap(mesh, resolution, sigma_texels, direction=DOWN, steps=12):
    """Differences between the sides of seams: in metres; as a share of the highest texel read there; as a share of the
    height at the point itself, and the same above 1 cm. The last two mean little where snow ends: within the last
    texel the height falls to 0, so two differently placed samples may differ by any share of it."""
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
    # Relative to the local height, if that is more than a thousandth of the snowfall.
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
