"""Scenes with snow for the pictures and tables of the real-time renderer, with all their meshes.

A thing has a mesh with a map layout, the size of its map, its colour (linear), and whether it is shaded smooth.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[2]
MAPLE = ROOT / "tests" / "data" / "small_maple.obj"
#: Low winter sun from the left, and a sky that fills its shadows with blue.
LIGHT = {
    "sun_direction": (-0.8, -0.25, 0.5),
    "sun_color": (2.3, 2.0, 1.65),
    "sky_color": (0.36, 0.48, 0.72),
    "ground_color": (0.24, 0.25, 0.28),
    "shadow_resolution": 2048,
}
FALL = (0.12, 0.08, -1.0)


@dataclass
class Thing:
    positions: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray
    resolution: int = 512
    color: tuple = (0.3, 0.3, 0.3)
    smooth: bool = False

    def moved(self, by, turn=0.0):
        """The thing turned around z by degrees, then moved."""
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        x, y, z = self.positions.T
        places = np.stack([c * x - s * y, s * x + c * y, z], axis=1) + np.asarray(by)
        return Thing(
            places.astype(np.float32), self.triangles, self.uv, self.resolution, self.color, self.smooth
        )

    @property
    def normals(self):
        """Shading normals for the renderer: None where it is smooth."""
        if self.smooth:
            return None
        corners = self.positions[self.triangles].astype(np.float64)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return np.repeat((across / np.linalg.norm(across, axis=1)[:, None])[:, None], 3, axis=1)

    @property
    def shading(self):
        """The same for the simulation."""
        return self.triangles if self.smooth else None


def ground(size=10.0, cells=40, resolution=1024, color=(0.10, 0.13, 0.06)):
    """Gently rolling, the map from border to border."""
    steps = np.linspace(0.0, 1.0, cells + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps))
    x, y = (u - 0.5) * size, (v - 0.5) * size
    hill = 0.12 * np.sin(0.9 * x + 0.4) * np.cos(0.7 * y) * np.clip(np.hypot(x, y) / 2 - 0.7, 0, 1)
    low = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    quads = np.stack([low, low + 1, low + cells + 2, low + cells + 1], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    uv = np.stack([u, v], axis=1)
    return Thing(
        np.stack([x, y, hill], axis=1).astype(np.float32),
        triangles,
        uv[triangles].astype(np.float32),
        resolution,
        color,
        True,
    )


def packed(sizes, gap=0.006):
    """Lower left corners and the scale at which rectangles (N, 2) fill the unit square in rows, `gap` apart."""
    order = np.lexsort((sizes[:, 0], -sizes[:, 1]))

    def rows(scale):
        corners, x, y, high = np.zeros_like(sizes), gap, gap, 0.0
        for index in order:
            width, height = scale * sizes[index]
            if x + width > 1.0 - gap:
                x, y, high = gap, y + high + gap, 0.0
            corners[index] = x, y
            x, high = x + width + gap, max(high, height)
        return corners, y + high <= 1.0 - gap

    # Rows change in steps: take the largest of many scales at which everything fits on the map.
    scales = np.geomspace(0.1, 1.0 - 2 * gap, 400)[::-1] / sizes.max()
    return next((corners, scale) for scale in scales for corners, fits in [rows(scale)] if fits)


def boxes(of, resolution=512, color=(0.25, 0.13, 0.06)):
    """Boxes by (middle, size), one chart per side, all at one scale: oblong texels would show in the snow."""
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    places, quads = [], []
    for number, (middle, size) in enumerate(of):
        corner = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
        places.append(np.asarray(middle) + corner * size)
        quads += [[8 * number + corner for corner in side] for side in sides]
    places, quads = np.concatenate(places), np.array(quads, np.int32)
    edges = np.stack(
        [places[quads[:, 1]] - places[quads[:, 0]], places[quads[:, 3]] - places[quads[:, 0]]], 1
    )
    sizes = np.linalg.norm(edges, axis=2)
    upright = sizes[:, 1] > sizes[:, 0]
    sizes[upright] = sizes[upright, ::-1]
    low, scale = packed(sizes)
    high = low + scale * sizes
    along = np.stack(
        [low, np.stack([high[:, 0], low[:, 1]], 1), high, np.stack([low[:, 0], high[:, 1]], 1)], 1
    )
    across = along[:, [3, 0, 1, 2]]  # turned by a quarter
    uv = np.where(upright[:, None, None], across, along)
    return Thing(
        places.astype(np.float32),
        np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], 1).reshape(-1, 3),
        np.stack([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]], 1).reshape(-1, 3, 2).astype(np.float32),
        resolution,
        color,
    )


def bench():
    """Three planks to sit on, two to lean on, and legs."""
    planks = [((0, y, 0.45), (1.5, 0.12, 0.05)) for y in (-0.17, 0.0, 0.17)]
    back = [((0, 0.27, z), (1.5, 0.05, 0.12)) for z in (0.66, 0.84)]
    legs = [((x, y, 0.21), (0.07, 0.07, 0.42)) for x in (-0.62, 0.62) for y in (-0.15, 0.15)]
    posts = [((x, 0.32, 0.46), (0.07, 0.05, 0.92)) for x in (-0.62, 0.62)]
    return boxes([*planks, *back, *legs, *posts], 1024, (0.22, 0.11, 0.045))


def turned(profile, around=48, resolution=512, color=(0.35, 0.32, 0.28)):
    """A closed body of revolution: profile (N, 2) of radius and height, its ends on the axis; one chart."""
    profile = np.asarray(profile, np.float64)
    rings = len(profile) - 2
    turn = 2 * np.pi * np.arange(around) / around
    radius, height = profile[1:-1].T
    places = np.stack(
        [
            radius[:, None] * np.cos(turn),
            radius[:, None] * np.sin(turn),
            np.repeat(height[:, None], around, axis=1),
        ],
        axis=2,
    ).reshape(-1, 3)
    places = np.concatenate([places, [(0, 0, profile[0, 1]), (0, 0, profile[-1, 1])]])
    along = np.cumsum(np.concatenate([[0], np.linalg.norm(np.diff(profile, axis=0), axis=1)]))
    v = 0.02 + 0.96 * along / along[-1]
    u = 0.02 + 0.96 * np.arange(around + 1) / around
    triangles, uv = [], []
    for i in range(around):
        j, middle = (i + 1) % around, 0.5 * (u[i] + u[i + 1])
        triangles.append((len(places) - 2, j, i))
        uv.append(((middle, v[0]), (u[i + 1], v[1]), (u[i], v[1])))
        top = (rings - 1) * around
        triangles.append((len(places) - 1, top + i, top + j))
        uv.append(((middle, v[-1]), (u[i], v[-2]), (u[i + 1], v[-2])))
        for r in range(rings - 1):
            a, b, c, d = r * around + i, r * around + j, (r + 1) * around + j, (r + 1) * around + i
            q = [(u[i], v[r + 1]), (u[i + 1], v[r + 1]), (u[i + 1], v[r + 2]), (u[i], v[r + 2])]
            triangles += [(a, b, c), (a, c, d)]
            uv += [(q[0], q[1], q[2]), (q[0], q[2], q[3])]
    return Thing(
        places.astype(np.float32),
        np.array(triangles, np.int32),
        np.array(uv, np.float32),
        resolution,
        color,
        True,
    )


def rounded(profile):
    """Twice as many points on the way to a profile's cubic B-spline, the ends stay (J. M. Lane, R. F. Riesenfeld, A
    Theoretical Development for the Computer Generation and Display of Piecewise Polynomial Surfaces, 1980).

    Cubic, because deep snow shows jumps of a surface's curvature: snow in a hollow stands higher than on the hump
    beside it, as a ring.
    """
    at = np.asarray(profile, np.float64)
    refined = np.empty((2 * len(at) - 1, 2))
    refined[::2] = at
    refined[1::2] = 0.5 * (at[:-1] + at[1:])
    refined[2:-1:2] = 0.5 * at[1:-1] + 0.25 * (refined[1:-2:2] + refined[3::2])
    return refined


def ball(radius=0.4, rings=24, around=48, **options):
    rise = np.linspace(-0.5 * np.pi, 0.5 * np.pi, rings + 1)
    return turned(radius * np.stack([np.cos(rise), np.sin(rise)], axis=1), around, **options)


def urn():
    """A stone urn on its foot."""
    profile = [
        (0, 0),
        (0.27, 0),
        (0.28, 0.03),
        (0.27, 0.06),
        (0.16, 0.09),
        (0.11, 0.15),
        (0.11, 0.22),
        (0.2, 0.3),
        (0.3, 0.42),
        (0.34, 0.55),
        (0.32, 0.68),
        (0.3, 0.72),
        (0.36, 0.77),
        (0.37, 0.8),
        (0.35, 0.82),
        (0.28, 0.805),
        (0.2, 0.775),
        (0.1, 0.757),
        (0, 0.752),
    ]
    return turned(rounded(rounded(profile)), 96, 512, (0.38, 0.35, 0.31))


def maple(resolution=1024):
    """The small maple as a thing for the simulation, and its mesh for the renderer."""
    mesh = native.build_tree_mesh(native.read_tree(MAPLE), snow_resolution=resolution)
    quads, uv = np.asarray(mesh.quads), np.asarray(mesh.uv_snow)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    return (
        Thing(
            np.asarray(mesh.vertices, np.float32),
            triangles,
            np.concatenate([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]]).astype(np.float32),
            resolution,
            smooth=True,
        ),
        mesh,
    )


def fallen(things, depth, steps=24, blur_radius=0.012, pixel_size=0.01, engine="AUTO"):
    """Heights by name after a snowfall of `depth` metres and some time to come to rest."""
    with native.SnowSimulation(
        cohesion=0.005,
        pixel_size=pixel_size,
        flutter=np.radians(10.0),
        blur_radius=blur_radius,
        engine=engine,
    ) as snow:
        for name, thing in things.items():
            snow.add_object(
                name, thing.triangles, thing.uv, resolution=thing.resolution, shading=thing.shading
            )
        for step in range(steps + steps // 2):
            moved = {name: thing.positions for name, thing in things.items()} if step == 0 else {}
            snow.step(moved, depth / steps if step < steps else 0.0, FALL)
        return {name: snow.output(name, normal=False)["height"] for name in things}


class Surface:
    """The snow's surface on a thing: its faces are planned for these heights, its points follow others."""

    def __init__(self, thing, heights, depth):
        self._surface = native.SnowSurface(
            thing.triangles, thing.uv, thing.positions, heights, abs(heights), depth, shading=thing.shading
        )
        begin, corners, _ = self._surface.faces()
        quads = begin[:-1][np.diff(begin) == 4][:, None]
        first = corners[begin[:-1][:, None] + (0, 1, 2)]
        self.triangles = np.concatenate([first, corners[quads + (0, 2, 3)]]).astype(np.int32)

    def points(self, heights, depth):
        return self._surface.points(heights, depth)

    def show(self, renderer, name, heights, depth):
        """Adds it to a renderer under a name."""
        if len(self.triangles):
            renderer.add_snow_mesh(name, self.points(heights, depth), self.triangles)


def show(renderer, things, heights, depth, trees=None):
    """Puts things with their snow into a renderer; `depth`: metres on open ground; `trees`: meshes of the trees by
    name."""
    for name, thing in things.items():
        if trees and name in trees:
            renderer.add_tree(name, trees[name])
            renderer.set_snow(name, heights[name], depth)
        else:
            renderer.add_mesh(name, thing.positions, thing.triangles, thing.color, thing.normals)
            Surface(thing, heights[name], depth).show(renderer, f"snow on {name}", heights[name], depth)
