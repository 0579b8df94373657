# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray casting with numpy: an independent reference of where parallel snow lands.

Rays are parallel, so triangles and origins are projected along them onto a plane and binned there: an exact
answer for every point, in a few seconds for a million points.
"""

import numpy as np


def plane_axes(direction):
    """Two unit vectors perpendicular to `direction` and to each other, and its unit vector."""
    d = np.asarray(direction, np.float64)
    d = d / np.linalg.norm(d)
    x = np.cross(d, (0.0, 1.0, 0.0) if abs(d[1]) < 0.9 else (1.0, 0.0, 0.0))
    x /= np.linalg.norm(x)
    return x, np.cross(x, d), d


def candidate_pairs(low, high, cells, counts):
    """Pairs (triangle, cell) for integer cell rectangles low..high (N, 2), sorted by cell."""
    spans = high - low + 1
    sizes = spans[:, 0] * spans[:, 1]
    triangle = np.repeat(np.arange(len(low)), sizes)
    within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    width = spans[triangle, 0]
    cell = (low[triangle, 1] + within // width) * cells + low[triangle, 0] + within % width
    order = np.argsort(cell, kind="stable")
    return triangle[order], np.searchsorted(cell[order], np.arange(counts + 1))


def first_hits(points, triangles, direction, backwards=True, margin=0.0, chunk=400_000):
    """Depth along `direction`, from each point (N, 3), of the triangle (T, 3, 3) that lies furthest towards
    where snow comes from (`backwards`): (N,) negative when something is in front, +inf when nothing is there.

    Only hits with depth < -margin count.
    """
    x, y, d = plane_axes(direction)
    basis = np.stack([x, y, d], axis=1)
    tri = triangles.reshape(-1, 3).astype(np.float64) @ basis
    tri = tri.reshape(-1, 3, 3)
    own = np.asarray(points, np.float64) @ basis
    flat = tri[:, :, :2]
    double_area = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    keep = abs(double_area) > 1e-18
    tri, flat, double_area = tri[keep], flat[keep], double_area[keep]
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    cells = int(np.clip(np.sqrt(len(tri)) * 2, 4, 1024))
    size = (high - low).max() / cells * (1 + 1e-9) + 1e-30
    first = np.clip(((flat.min(axis=1) - low) / size).astype(np.int64), 0, cells - 1)
    last = np.clip(((flat.max(axis=1) - low) / size).astype(np.int64), 0, cells - 1)
    pair_triangle, begin = candidate_pairs(first, last, cells, cells * cells)
    depth = np.full(len(own), np.inf)
    for start in range(0, len(own), chunk):
        part = own[start : start + chunk]
        at = np.floor((part[:, :2] - low) / size).astype(np.int64)
        inside = ((at >= 0) & (at < cells)).all(axis=1)
        cell = np.where(inside, at[:, 1] * cells + at[:, 0], 0)
        count = np.where(inside, begin[cell + 1] - begin[cell], 0)
        # Rays with many candidates are worked through in slices, so that memory stays bounded.
        done = np.zeros(len(part), np.int64)
        while (done < count).any():
            take = np.minimum(count - done, max(1, 4_000_000 // max(1, (done < count).sum())))
            ray = np.repeat(np.arange(len(part)), take)
            offset = np.arange(take.sum()) - np.repeat(np.cumsum(take) - take, take)
            t = pair_triangle[begin[cell[ray]] + done[ray] + offset]
            done += take
            a = flat[t, 0]
            ab, ac, ap = flat[t, 1] - a, flat[t, 2] - a, part[ray, :2] - a
            v = np.cross(ap, ac) / double_area[t]
            w = np.cross(ab, ap) / double_area[t]
            hit = (v >= 0) & (w >= 0) & (v + w <= 1)
            z = tri[t, 0, 2] + v * (tri[t, 1, 2] - tri[t, 0, 2]) + w * (tri[t, 2, 2] - tri[t, 0, 2])
            z = z - part[ray, 2]
            hit &= z < -margin
            np.minimum.at(depth, start + ray[hit], z[hit])
    return depth


def sees_the_fall(points, normals, triangles, direction, margin):
    """Whether a point on a surface faces the fall and nothing (T, 3, 3) is before it: (N,) bool."""
    d = np.asarray(direction, np.float64)
    facing = np.asarray(normals, np.float64) @ d < 0.0
    lit = np.zeros(len(points), bool)
    lit[facing] = np.isinf(first_hits(points[facing], triangles, direction, margin=margin))
    return lit


def outline_area(triangles, direction, samples=1000, seed=1):
    """Area of the union of `triangles` (T, 3, 3) seen along `direction`, by one random ray in each cell of a
    samples x samples grid."""
    x, y, d = plane_axes(direction)
    flat = triangles.reshape(-1, 3) @ np.stack([x, y], axis=1)
    low, high = flat.min(axis=0), flat.max(axis=0)
    jitter = np.random.default_rng(seed).random((samples, samples, 2))
    grid = np.stack(np.meshgrid(np.arange(samples), np.arange(samples)), axis=2)
    place = ((grid + jitter) / samples).reshape(-1, 2) * (high - low) + low
    points = place[:, :1] * x + place[:, 1:] * y + d * ((triangles.reshape(-1, 3) @ d).max() + 1.0)
    hit = np.isfinite(first_hits(points, triangles, direction))
    return float(hit.mean() * np.prod(high - low))


def texel_points(native, positions, triangles, uv, resolution):
    """Sample point, unit normal, map index and covered area of every owned texel of a mesh."""
    table = native.texel_table(triangles, uv, resolution)
    corners = positions[triangles[table["triangle"]]].astype(np.float64)
    b, c = table["barycentric"].T.astype(np.float64)
    points = (np.stack([1 - b - c, b, c], axis=1)[:, :, None] * corners).sum(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None] + 1e-300
    return points, normals, table["texel"], table


def fragment_samples(table, uv, resolution, which, per_edge):
    """Sub-samples of texels `which` (indices into the owned ones), per_edge x per_edge in each square: only
    those that the texel's own chart covers. Owned index, triangle, weights of its second and third corner."""
    begin, end = table["fragment_begin"][which], table["fragment_begin"][which + 1]
    count = end - begin
    owned = np.repeat(which, count)
    fragment = np.repeat(begin, count) + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    triangle = table["fragment_triangle"][fragment]
    places = (np.arange(per_edge) + 0.5) / per_edge
    steps = np.stack([axis.ravel() for axis in np.meshgrid(places, places)], axis=1)
    parts = [(np.zeros(0, np.int64), np.zeros(0), np.zeros(0))]
    chunk = max(1, 2_000_000 // per_edge**2)
    for start in range(0, len(owned), chunk):
        texel = table["texel"][owned[start : start + chunk]]
        corner = uv[triangle[start : start + chunk]].astype(np.float64) * resolution
        ab, ac = (corner[:, k, None] - corner[:, 0, None] for k in (1, 2))
        at = np.stack([texel % resolution, texel // resolution], axis=1)[:, None] + steps - corner[:, 0, None]
        double_area = ab[..., 0] * ac[..., 1] - ab[..., 1] * ac[..., 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            b = (at[..., 0] * ac[..., 1] - at[..., 1] * ac[..., 0]) / double_area
            c = (ab[..., 0] * at[..., 1] - ab[..., 1] * at[..., 0]) / double_area
        row, sample = np.nonzero((b >= 0.0) & (c >= 0.0) & (b + c <= 1.0))
        parts.append((row + start, b[row, sample], c[row, sample]))
    row, b, c = (np.concatenate(column) for column in zip(*parts))
    return owned[row], triangle[row], b, c


def lit_shares(table, mesh, resolution, which, scene, direction, margin, per_edge):
    """The fraction of its surface that rays reach, for every texel of `which`, by per_edge x per_edge rays on
    the texel's square: fractions of the owned texels (N,), 0 for others; and the number of rays of each."""
    positions, triangles, uv = mesh
    owned, triangle, b, c = fragment_samples(table, uv, resolution, which, per_edge)
    total, lit = (np.zeros(len(table["texel"])) for _ in range(2))
    normal = np.cross(*(positions[triangles[:, k]] - positions[triangles[:, 0]] for k in (1, 2)))
    facing = (normal @ np.asarray(direction) < 0.0)[triangle]
    np.add.at(total, owned, 1.0)
    owned, triangle, b, c = owned[facing], triangle[facing], b[facing, None], c[facing, None]
    corners = positions[triangles[triangle]].astype(np.float64)
    points = corners[:, 0] * (1.0 - b - c) + corners[:, 1] * b + corners[:, 2] * c
    reached = np.isinf(first_hits(points, scene, direction, margin=margin))
    np.add.at(lit, owned, reached.astype(np.float64))
    return lit / np.maximum(total, 1.0), total


def near_any(points, others, distance):
    """Whether one of `others` lies in a point's own or a neighbouring voxel of edge `distance`: (N,) bool."""
    low = np.minimum(points.min(axis=0), others.min(axis=0)) - 2.0 * distance
    a, b = (np.floor((p - low) / distance).astype(np.int64) for p in (points, others))
    size = np.maximum(a.max(axis=0), b.max(axis=0)) + 2

    def key(cells):
        return (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]

    taken = np.unique(key(b))
    near = np.zeros(len(points), bool)
    for shift in np.ndindex(3, 3, 3):
        near |= np.isin(key(a + np.array(shift) - 1), taken)
    return near
