# SPDX-License-Identifier: GPL-3.0-or-later
"""Five shapes of flat faces, and five UV layouts of any of them, for tests that compare the snow on them.

A shape is positions (N, 3) and a list of faces, each a tuple of vertices that go round it.
"""

import numpy as np

MARGIN = 0.15  # part of a face's cell on the map that stays free


def _ring(radius, z, around):
    turn = 2.0 * np.pi * np.arange(around) / around
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(around, z)])


def cone(degrees=66.1, radius=0.5, around=32):
    """An upright cone whose faces all rise by that angle, closed below."""
    rise = radius * np.cos(np.pi / around) * np.tan(np.radians(degrees))
    positions = np.vstack([_ring(radius, 0.0, around), [[0.0, 0.0, rise]]])
    sides = [(i, (i + 1) % around, around) for i in range(around)]
    return positions, [*sides, tuple(range(around))[::-1]]


def ball(radius=0.5, around=32, rings=16):
    """A ball of quads, with triangles at its poles."""
    rise = np.pi * np.arange(1, rings) / rings - 0.5 * np.pi
    circles = [_ring(radius * np.cos(a), radius * np.sin(a), around) for a in rise]
    positions = np.vstack([*circles, [[0.0, 0.0, -radius], [0.0, 0.0, radius]]])
    south, faces = len(positions) - 2, []
    for i in range(around):
        j = (i + 1) % around
        faces += [(j, i, south), (south - around + i, south - around + j, south + 1)]
        for ring in range(0, south - around, around):
            faces.append((ring + i, ring + j, ring + around + j, ring + around + i))
    return positions, faces


def box(size=1.0):
    h = 0.5 * size
    positions = np.array([(x, y, z) for z in (0.0, size) for y in (-h, h) for x in (-h, h)])
    return positions, [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]


def roof(degrees=36.0, width=1.0, length=1.0):
    """A gable roof: two slopes over a level floor, and its gables."""
    w, half = 0.5 * width, 0.5 * length
    z = w * np.tan(np.radians(degrees))
    positions = np.array(
        [(-w, -half, 0), (w, -half, 0), (w, half, 0), (-w, half, 0), (0, -half, z), (0, half, z)]
    )
    return positions, [(0, 4, 5, 3), (1, 2, 5, 4), (0, 1, 4), (2, 3, 5), (0, 3, 2, 1)]


def post(radius=0.15, height=0.6, around=24):
    positions = np.vstack([_ring(radius, 0.0, around), _ring(radius, height, around)])
    sides = [(i, (i + 1) % around, around + (i + 1) % around, around + i) for i in range(around)]
    ring = tuple(range(around))
    return positions, [*sides, ring[::-1], tuple(around + i for i in ring)]


SHAPES = {"cone": cone, "ball": ball, "box": box, "roof": roof, "post": post}


def _flat(corners):
    """A face unfolded into its own plane, its first edge along u; (corners, 2) in metres."""
    edges = corners - corners[0]
    normal = sum(np.cross(edges[k], edges[k + 1]) for k in range(1, len(corners) - 1))
    along = edges[1] / np.linalg.norm(edges[1])
    across = np.cross(normal / np.linalg.norm(normal), along)
    return np.column_stack([edges @ along, edges @ across])


def _turned(flat, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return flat @ np.array([[c, s], [-s, c]])


def _packed(charts, scale=None):
    """Charts side by side in cells of a map, as large as fits; all by one scale, or each by its own."""
    side = int(np.ceil(np.sqrt(len(charts))))
    room = (1.0 - MARGIN) / side
    sizes = [np.ptp(chart, axis=0) for chart in charts]
    largest = np.max(sizes)
    uv = []
    for i, (chart, size) in enumerate(zip(charts, sizes)):
        low = np.array([i % side, i // side]) / side + 0.5 * MARGIN / side
        own = room / (size if scale == "fill" else largest)
        uv.append(low + (chart - chart.min(axis=0)) * own)
    return uv


def each_face(positions, faces):
    """Each face as it is, its first edge along u."""
    return _packed([_flat(positions[list(face)]) for face in faces])


def rotated(positions, faces):
    """Each face as it is, turned by an angle of its own."""
    return _packed([_turned(_flat(positions[list(face)]), 22.5 + 37.0 * i) for i, face in enumerate(faces)])


def stretched(positions, faces):
    """Each face turned, then four times as long along u as along v."""
    charts = [_turned(_flat(positions[list(face)]), 30.0 + 11.0 * i) for i, face in enumerate(faces)]
    return _packed([chart * (1.0, 0.25) for chart in charts])


def squares(positions, faces):
    """As Lightmap Pack does: each face fills a square of its own, whatever its shape."""
    corners = {
        3: np.array([(0, 0), (1, 0), (0, 1)], float),
        4: np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float),
    }
    return _packed([corners.get(len(face), _flat(positions[list(face)])) for face in faces], "fill")


def projected(positions, faces):
    """As Smart UV Project does: faces that look the same of six ways are one chart, seen from there, turned by 20
    degrees. Returns UVs as the others do."""
    charts = [[] for _ in range(6)]
    uv = [None] * len(faces)
    for i, face in enumerate(faces):
        corners = positions[list(face)]
        normal = sum(
            np.cross(corners[k] - corners[0], corners[k + 1] - corners[0]) for k in range(1, len(face) - 1)
        )
        axis = int(np.argmax(np.abs(normal)))
        # Faces that are steeper than 66 degrees are projected from a side.
        level = np.abs(normal[:2]).max()
        if axis == 2 and level > np.cos(np.radians(66.0)) * np.linalg.norm(normal) * 0.7 and len(face) < 5:
            axis = int(np.argmax(np.abs(normal[:2])))
        charts[2 * axis + (normal[axis] > 0)].append(i)
    seen = []
    for way, members in enumerate(charts):
        axis, front = divmod(way, 2)
        keep = [k for k in range(3) if k != axis]
        flip = np.array([1.0 if front != (axis == 1) else -1.0, 1.0])
        seen.append([_turned(positions[list(faces[i])][:, keep] * flip, 20.0) for i in members])
    used = [(m, s) for m, s in zip(charts, seen) if m]
    for (members, parts), packed in zip(used, _packed([np.vstack(s) for _, s in used])):
        ends = np.cumsum([len(part) for part in parts])[:-1]
        for i, own in zip(members, np.split(packed, ends)):
            uv[i] = own
    return uv


LAYOUTS = {
    "each face": each_face,
    "squares": squares,
    "projected": projected,
    "stretched": stretched,
    "rotated": rotated,
}


def laid_out(shape, layout):
    """(positions, triangles, uv) as SnowSimulation takes them, and the face of each triangle."""
    positions, faces = shape
    triangles, uv, numbers = [], [], []
    for i, (face, own) in enumerate(zip(faces, layout(positions, faces))):
        for k in range(1, len(face) - 1):
            triangles.append((face[0], face[k], face[k + 1]))
            uv.append((own[0], own[k], own[k + 1]))
            numbers.append(i)
    return (
        positions.astype(np.float32),
        np.array(triangles, np.int32),
        np.array(uv, np.float32),
        np.array(numbers),
    )
