# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that the preview raises to the snow's surface: a receiver's triangles cut into ones as fine as its map.
No ``bpy``.

**Cut.** Every edge that is too long on the map is halved, pass by pass, and every triangle is cut by those of its edges
that are (red-green refinement: R. E. Bank, A. H. Sherman, A. Weiser, Refinement Algorithms and Data Structures for
Regular Local Mesh Refinement, 1983). How often an edge of the mesh is halved is settled beforehand, by the triangle
that wants it most often, so that triangles that share it cut it alike and no gap can open between them. Lengths are
the larger of those along u and v: the two triangles of a square are cut into squares.

**Points.** A point of the surface is one vertex, whatever number of triangles meet there. What lies at it may be
stored at several places of the map, along several normals: at seams and at sharp edges. Each such pair is an entry of
the point, and the shader takes the mean of what they say, as the shell of a bake does (result.shell_nodes).

Nothing here changes while a mesh moves and bends; positions and normals are looked up by the numbers of the mesh's
own vertices and normals.
"""

from dataclasses import dataclass

import numpy as np

# Halvings of an edge, at most.
MOST_PASSES = 14
# Entries of a point, at most: the corner of a box has three.
MOST_ENTRIES = 6
# Texels by which entries beside seams and rims keep off the rim of their chart, and the share of the way to their
# triangle's middle that this is at most.
INSET = 1.0
MOST_INSET = 0.5
# Normals that differ by less count as one (parts of their length).
SAME_NORMAL = 1.0 / 8.0
# Vertices closer than this share of the mesh's extent are one point.
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class Entries:
    """Places in a triangle of the mesh that say how much snow lies at a point; N of them."""

    corners: np.ndarray
    """(N, 3) int32: the triangle's vertices."""
    normals: np.ndarray
    """(N, 3) int32: the normals of its corners (normals.NormalTable)."""
    weights: np.ndarray
    """(N, 2) float32: of the second and the third corner."""
    uv: np.ndarray
    """(N, 2) float32: on the map."""
    tangents: np.ndarray
    """(N, 4) float32: the surface's way along u is t[0] e1 + t[1] e2 and along v t[2] e1 + t[3] e2, for edges e1
    and e2 from the triangle's first corner to its others; zero for triangles without a place on the map."""

    def __len__(self):
        return len(self.uv)

    def chosen(self, index):
        """Those of an index array."""
        return Entries(
            self.corners[index],
            self.normals[index],
            self.weights[index],
            self.uv[index],
            self.tangents[index],
        )


@dataclass(frozen=True)
class SurfaceMesh:
    """P points in K triangles."""

    triangles: np.ndarray
    """(K, 3) int32."""
    first: Entries
    """Every point's first entry; its place is that of the point."""
    inside: np.ndarray
    """(P,) float32: 0 on the rim of an open mesh, where snow ends on the surface, else 1."""
    more: Entries
    """All further entries, by point."""
    more_range: np.ndarray
    """(P, 2) int32: the first of a point's further entries, and their number."""


@dataclass
class _Cut:
    """Triangles on their way: local points belong to one triangle of the mesh each."""

    triangles: np.ndarray
    origin: np.ndarray
    """(L,): the triangle of the mesh."""
    weights: np.ndarray
    """(L, 3) float64, exact: multiples of a power of two."""
    uv: np.ndarray
    """(L, 2) float64; equal to the bit for triangles that share an edge and its place on the map."""


@dataclass
class _Edges:
    """Edges of the mesh, by welded vertices."""

    ends: np.ndarray
    """(T, 3): the welded vertices of every triangle; edge k runs from corner k to the next."""
    low: np.ndarray
    """(T, 3): of the two ends of edge k, the lower."""
    number: np.ndarray
    """(T, 3): edge k."""
    open: np.ndarray
    """(E,) whether only one triangle has it."""


def build(topology, positions, normal_corners, edge, resolution, most_triangles):
    """The SurfaceMesh of a scene.pose.Topology.

    positions (V, 3): its first pose. normal_corners (T, 3): NormalTable.corners. edge: the length of edges that is
    wished for (texels); longer where there would be more than about most_triangles. resolution: of the map.
    """
    edges = _edges(_welded(positions)[topology.triangles])
    cut = _cut(topology.corner_uv.astype(np.float64), edges, edge / resolution, most_triangles)
    points, on_rim = _points(edges, cut)
    return _joined(
        topology, cut, points, on_rim, normal_corners, _flat_normals(positions, topology), resolution
    )


def _welded(positions):
    """(V,) int: vertices at one place have one number."""
    extent = float(np.abs(positions).max()) if len(positions) else 1.0
    grid = np.round(positions.astype(np.float64) / max(extent * SAME_PLACE, 1e-7)).astype(np.int64)
    _, number = np.unique(grid, axis=0, return_inverse=True)
    return number.reshape(-1)


def _edges(ends):
    following = np.roll(ends, -1, axis=1)
    low, high = np.minimum(ends, following), np.maximum(ends, following)
    vertices = int(ends.max()) + 1 if ends.size else 0
    keys, number = np.unique(low * vertices + high, return_inverse=True)
    number = number.reshape(-1, 3)
    return _Edges(ends, low, number, np.bincount(number.reshape(-1), minlength=len(keys)) == 1)


# -- cutting -------------------------------------------------------------------------------------------


def _cut(corner_uv, edges, edge, most_triangles):
    """The mesh's triangles, cut. corner_uv (T, 3, 2) float64; edge: on the map, 1 is its whole side."""
    count = len(corner_uv)
    edge, halvings = _affordable(corner_uv, edges, edge, most_triangles)
    # Of an edge of the mesh opposite of a corner: the share of it that is short enough.
    short = np.roll(np.exp2(-halvings), -1, axis=1)
    cut = _Cut(
        np.arange(count * 3).reshape(-1, 3),
        np.repeat(np.arange(count), 3),
        np.tile(np.eye(3), (count, 1)),
        corner_uv.reshape(-1, 2),
    )
    for _ in range(MOST_PASSES):
        ends = np.stack([cut.triangles, np.roll(cut.triangles, -1, axis=1)], axis=2)
        long = _is_long(cut, ends, edge, short)
        if not long.any():
            break
        _halve(cut, ends, long)
    return cut


def _is_long(cut, ends, edge, short):
    """(K, 3) whether the edges with those ends (K, 3, 2) are too long."""
    a, b = ends[..., 0], ends[..., 1]
    weight_a, weight_b = cut.weights[a], cut.weights[b]
    beside = (weight_a == 0.0) & (weight_b == 0.0)
    share = np.abs(weight_a - weight_b).max(axis=2)
    on_edge = share > np.where(beside, short[cut.origin[a]], 0.0).max(axis=2)
    within = np.abs(cut.uv[a] - cut.uv[b]).max(axis=2) > edge
    return np.where(beside.any(axis=2), on_edge, within)


def _affordable(corner_uv, edges, edge, most_triangles):
    """(length of edges, halvings (T, 3) of the mesh's edges): as wished for, or with which about most_triangles come
    out."""
    length = np.abs(corner_uv - np.roll(corner_uv, -1, axis=1)).max(axis=2)
    longest = np.zeros(len(edges.open))
    np.maximum.at(longest, edges.number, length)
    length = longest[edges.number]
    while True:
        # A little over the length does not count: squares are rarely exact.
        halvings = np.ceil(np.log2(np.maximum(length / edge, 1.0)) - 0.02)
        parts = np.exp2(halvings)
        if (parts * np.roll(parts, -1, axis=1)).sum() / 3.0 <= most_triangles or not halvings.any():
            return edge * 1.02, np.minimum(halvings, MOST_PASSES)
        edge *= 1.1


def _halve(cut, ends, long):
    """Cuts the long edges (K, 3) in their middles, and the triangles along them."""
    low, high = ends[long].min(axis=1), ends[long].max(axis=1)
    key, middle = np.unique(low * len(cut.origin) + high, return_inverse=True)
    a, b = key // len(cut.origin), key % len(cut.origin)
    middles = np.full(long.shape, -1)
    middles[long] = len(cut.origin) + middle.reshape(-1)
    cut.origin = np.concatenate([cut.origin, cut.origin[a]])
    for name in ("weights", "uv"):
        values = getattr(cut, name)
        setattr(cut, name, np.concatenate([values, (values[a] + values[b]) * 0.5]))
    cut.triangles = _children(cut.triangles, middles, long)


def _children(triangles, middles, long):
    number = long.sum(axis=1)
    made = [triangles[number == 0]]
    # Turned so that one cut edge is the first, and two are the first and the second.
    turn = np.where(number == 1, long.argmax(axis=1), (long.argmin(axis=1) + 1) % 3)
    turn[(number == 0) | (number == 3)] = 0
    order = (turn[:, None] + np.arange(3)) % 3
    corner, middle = (np.take_along_axis(array, order, axis=1) for array in (triangles, middles))

    def add(chosen, *corners):
        made.append(np.stack([array[chosen] for array in corners], axis=1))

    (a, b, c), (ab, bc, ca) = corner.T, middle.T
    one, two, three = (number == n for n in (1, 2, 3))
    add(one, a, ab, c)
    add(one, ab, b, c)
    add(two, ab, b, bc)
    add(two, a, ab, bc)
    add(two, a, bc, c)
    for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)):
        add(three, *corners)
    return np.concatenate(made)


# -- points --------------------------------------------------------------------------------------------


def _points(edges, cut):
    """(number (L,) of the point of every local point, whether the point lies on the rim (P,))."""
    vertices = int(edges.ends.max()) + 1 if edges.ends.size else 0
    used = (cut.weights > 0.0).sum(axis=1)
    corner = cut.weights.argmax(axis=1)
    # Beside which corner an edge begins: the one without a weight lies opposite of it.
    begin = (cut.weights.argmin(axis=1) + 1) % 3
    own_edge = edges.number[cut.origin, begin]
    share = np.take_along_axis(cut.weights, begin[:, None], axis=1)[:, 0]
    forward = edges.ends[cut.origin, begin] == edges.low[cut.origin, begin]
    share = np.where(forward, share, 1.0 - share)
    # Vertices, then points of edges, then those within triangles.
    scale = 1 << MOST_PASSES
    on_edge = vertices + own_edge * scale + np.rint(share * scale).astype(np.int64)
    within = vertices + (len(edges.open) + 1) * scale + np.arange(len(used))
    key = np.where(used == 1, edges.ends[cut.origin, corner], np.where(used == 2, on_edge, within))
    _, number = np.unique(key, return_inverse=True)
    number = number.reshape(-1)

    on_rim = np.zeros(int(number.max()) + 1 if len(number) else 0, dtype=bool)
    is_open = edges.open[edges.number]
    on_rim[number[(used == 2) & edges.open[own_edge]]] = True
    beside = is_open | np.roll(is_open, 1, axis=1)
    on_rim[number[(used == 1) & beside[cut.origin, corner]]] = True
    return number, on_rim


def _flat_normals(positions, topology):
    corners = positions[topology.triangles].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-30)


def _joined(topology, cut, points, on_rim, normal_corners, flat, resolution):
    """Gathers the entries of every point, each once."""
    entry_normal = _interpolated_normals(cut, normal_corners, flat)
    key = _mixed(points, cut.uv.astype(np.float32).view(np.int32), np.rint(entry_normal / SAME_NORMAL))
    _, entry = np.unique(key, return_index=True)
    entry = entry[np.argsort(points[entry], kind="stable")]
    of_point = points[entry]
    number = np.bincount(of_point, minlength=len(on_rim))
    start = np.concatenate([[0], np.cumsum(number)[:-1]]).astype(np.int64)

    beside_seam = (number > 1) | on_rim
    entries = _entries(topology, cut, entry, normal_corners, beside_seam[of_point], resolution)
    rank = np.arange(len(entry)) - start[of_point]
    further = np.flatnonzero((rank > 0) & (rank < MOST_ENTRIES))
    more = np.minimum(number, MOST_ENTRIES) - 1
    more_start = np.concatenate([[0], np.cumsum(more)[:-1]])
    return SurfaceMesh(
        triangles=np.ascontiguousarray(points[cut.triangles], dtype=np.int32),
        first=entries.chosen(start),
        inside=np.where(on_rim, np.float32(0.0), np.float32(1.0)),
        more=entries.chosen(further),
        more_range=np.ascontiguousarray(np.stack([more_start, more], axis=1), dtype=np.int32),
    )


def _interpolated_normals(cut, normal_corners, flat):
    """(L, 3): about the normal of every local point, to tell entries apart by."""
    count = int(normal_corners.max()) + 1 if normal_corners.size else 0
    sums = np.zeros((count, 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(normal_corners.reshape(-1), np.repeat(flat[:, axis], 3), count)
    sums /= np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    return (cut.weights[:, :, None] * sums[normal_corners[cut.origin]]).sum(axis=1)


def _entries(topology, cut, index, normal_corners, inset, resolution):
    origin = cut.origin[index]
    uv = cut.uv[index]
    middle = topology.corner_uv[origin].astype(np.float64).mean(axis=1)
    most = INSET / resolution
    way = np.clip((middle - uv) * MOST_INSET, -most, most)
    return Entries(
        corners=topology.triangles[origin].astype(np.int32),
        normals=normal_corners[origin].astype(np.int32),
        weights=cut.weights[index][:, 1:].astype(np.float32),
        uv=np.where(inset[:, None], uv + way, uv).astype(np.float32),
        tangents=_tangents(topology.corner_uv)[origin],
    )


def _tangents(corner_uv):
    """(T, 4): see Entries."""
    uv = corner_uv.astype(np.float64)
    (u1, v1), (u2, v2) = (uv[:, 1] - uv[:, 0]).T, (uv[:, 2] - uv[:, 0]).T
    area = u1 * v2 - u2 * v1
    scale = np.where(np.abs(area) > 1e-20, 1.0 / np.where(area == 0.0, 1.0, area), 0.0)
    return (np.stack([v2, -v1, -u2, u1], axis=1) * scale[:, None]).astype(np.float32)


def _mixed(points, uv_bits, normal):
    """(L,) uint64: one number for equal rows; the chance that unequal ones share one is 1e-7 for a million."""
    columns = [points, uv_bits[:, 0], uv_bits[:, 1], *normal.astype(np.int64).T]
    mixed = np.zeros(len(points), dtype=np.uint64)
    for column in columns:
        mixed ^= column.astype(np.int64).view(np.uint64)
        # The finalizer of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, 2014).
        mixed += np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed ^= mixed >> np.uint64(31)
    return mixed
