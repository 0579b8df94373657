# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow on the bones of a tree: how much each one carries, and where. Pure numpy, no Blender.

Maps say how snow is distributed over a tree, but hold far less than foliage carries: snow bridges the gaps between
needles, where no texel is. So the weight of a tree with foliage follows from its crown, as interception does, and maps
distribute it.
"""

from dataclasses import dataclass

import numpy as np

# Share of the snow above a crown that stays in it in light snowfall (N. R. Hedstrom, J. W. Pomeroy, Measurements and
# modelling of snow interception in the boreal forest, Hydrological Processes 12, 1998, pages 1611-1625: unloading 0.68
# times canopy cover 0.9), and the most that it holds in kg/m2: our round number for spruces.
INTERCEPTED = 0.6
MAX_INTERCEPTED = 15.0
# Metres: gaps in a crown that snow bridges.
CROWN_CELL = 0.1
# Keyframes along the depth of the snow, besides the first.
KEYS = 8


# A limb is at least this share of the length beyond a place thick there, and MIN_RADIUS metres: exports draw twigs as
# hairs, which could not stand. Real limbs have 1/100 to 1/200.
SLENDEREST = 1.0 / 150.0
MIN_RADIUS = 0.001


@dataclass
class SnowyMesh:
    """A mesh of a tree with its snow.

    heights float (H, H): its map, metres, negative on the back; table: native texel_table of the map; triangles int32
    (T, 3); positions float (V, 3): at rest, metres; bones int (V, K), weights float (V, K): bones that move each
    vertex, weights 0 where unused.
    """

    heights: np.ndarray
    table: dict
    triangles: np.ndarray
    positions: np.ndarray
    bones: np.ndarray
    weights: np.ndarray


def triangle_areas(triangles, positions):
    a, b, c = (positions[triangles[:, corner]].astype(float) for corner in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def held_snow(meshes, bone_count):
    """(volumes float (B,) in m3, centres float (B, 3) in metres at rest) of the snow on each bone.

    Each part of a triangle in a texel carries the texel's height; its corners share it by its place in the triangle,
    and their bones by their weights. Vertices without weights carry nothing.
    """
    volumes, moments = np.zeros(bone_count), np.zeros((bone_count, 3))
    for mesh in meshes:
        table = mesh.table
        counts = np.diff(table["fragment_begin"])
        heights = np.repeat(np.abs(mesh.heights.reshape(-1)[table["texel"]]).astype(float), counts)
        triangle = table["fragment_triangle"]
        volume = heights * table["fragment_share"] * triangle_areas(mesh.triangles, mesh.positions)[triangle]
        snowy = volume > 0.0
        volume, corners = volume[snowy], mesh.triangles[triangle[snowy]]
        second, third = table["fragment_barycentric"][snowy].astype(float).T
        corner_shares = np.stack([1.0 - second - third, second, third], axis=1)
        places = (corner_shares[:, :, None] * mesh.positions[corners]).sum(axis=1)
        shares = (volume[:, None] * corner_shares)[:, :, None] * mesh.weights[corners]
        bones = mesh.bones[corners].reshape(-1)
        volumes += np.bincount(bones, shares.reshape(-1), bone_count)
        for axis in range(3):
            weighted = shares * places[:, axis, None, None]
            moments[:, axis] += np.bincount(bones, weighted.reshape(-1), bone_count)
    return volumes, moments / np.maximum(volumes, 1e-30)[:, None]


def crown_area(meshes):
    """Area in m2 of the foliage seen from above, with gaps of up to a CROWN_CELL closed. meshes: [(triangles, positions
    in metres), ...]."""
    cells = [np.empty((0, 2), np.int64)]
    for triangles, positions in meshes:
        a, b, c = (positions[triangles[:, corner], :2].astype(float) for corner in range(3))
        b, c = b - a, c - a
        longest = np.sqrt(np.max([(b**2).sum(1), (c**2).sum(1), ((c - b) ** 2).sum(1)], axis=0, initial=0.0))
        parts = np.maximum(1, np.ceil(2.0 * longest / CROWN_CELL)).astype(int)
        for count in np.unique(parts).tolist():
            own = parts == count
            for i in range(count):
                # Centroids of the row's smaller triangles.
                j = np.arange(count - i)
                u, v = np.full(len(j), i + 1 / 3) / count, (j + 1 / 3) / count
                points = a[own, None] + u[:, None] * b[own, None] + v[:, None] * c[own, None]
                cells.append(np.unique(np.floor(points.reshape(-1, 2) / CROWN_CELL).astype(np.int64), axis=0))
    return len(np.unique(np.concatenate(cells), axis=0)) * CROWN_CELL**2


def intercepted(area, depth, density):
    """Mass in kg that a crown of `area` m2 keeps of snow `depth` metres deep with `density` kg/m3."""
    return area * min(INTERCEPTED * depth * density, MAX_INTERCEPTED)


def plausible_radii(head_radii, tail_radii, lengths, limbs):
    """(head radii, tail radii) float (B,) of bones, raised to what a living limb has. lengths float (B,), metres; limbs
    int (B,): the limb of each bone, whose bones are in order."""
    beyond_tails, reached = np.zeros(len(lengths)), np.zeros(max(limbs, default=0) + 1)
    for bone in range(len(lengths) - 1, -1, -1):
        beyond_tails[bone] = reached[limbs[bone]]
        reached[limbs[bone]] += lengths[bone]
    at_heads, at_tails = (SLENDEREST * beyond for beyond in (beyond_tails + lengths, beyond_tails))
    return np.maximum(head_radii, np.maximum(at_heads, MIN_RADIUS)), np.maximum(
        tail_radii, np.maximum(at_tails, MIN_RADIUS)
    )


def load_keys(frame_start, totals):
    """[(frame, share of the load), ...] along the depth of the snow, ascending. totals: depth in metres after each
    frame from frame_start on; the last is positive. The first key is the last frame before more snow falls."""
    totals = np.asarray(totals, float)
    first = totals[0] / totals[-1]
    shares = np.linspace(first, 1.0, KEYS + 1) if first < 1.0 else np.ones(1)
    depths = shares * totals[-1]
    # Between the frames before and after each depth, so that a key is never within a pause of the snowfall.
    after = np.minimum(np.searchsorted(totals, depths), len(totals) - 1)
    after[0] = np.searchsorted(totals, totals[0], side="right") - 1
    before = np.maximum(after - 1, 0)
    rise = totals[after] - totals[before]
    frames = after - np.where(rise > 0.0, (totals[after] - depths) / np.where(rise > 0.0, rise, 1.0), 0.0)
    return list(zip((frame_start + frames).tolist(), shares.tolist()))
