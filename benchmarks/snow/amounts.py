# SPDX-License-Identifier: GPL-3.0-or-later
"""Amount and evenness of the snow: the parts "conservation", "evenness", "spikes", "stability" and "thin" of
acceptance.py.
"""

import numpy as np
from fallen import DOWN, bake, percent, volume
from meshes import bunny, grid, rotated, sphere, spot, texel_size, tree, wind
from rows import row
from snow_rays import outline_area


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
    # Every triangle is a chart of its own, in a cell of a 47 x 47 grid.
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
    """Open planes after one step and after many: variation of thickness, worst case over pixel sizes."""
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
