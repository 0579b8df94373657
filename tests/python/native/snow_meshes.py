# SPDX-License-Identifier: GPL-3.0-or-later
"""Small literal meshes for the snow tests: positions (N, 3), triangles (T, 3), uv (T, 3, 2)."""

import numpy as np

# The angle of repose at which snow stays where it fell, for tests of the deposit alone.
STAYS = np.pi / 2


def grid(size_x=1.0, size_y=1.0, cells=1, margin=0.02):
    """A level rectangle around the origin, facing up, its UVs filling the map but for a margin."""
    steps = np.linspace(0.0, 1.0, cells + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps))
    positions = np.stack([(u - 0.5) * size_x, (v - 0.5) * size_y, np.zeros_like(u)], axis=1)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    low = np.stack([corner, corner + 1, corner + cells + 2], axis=1)
    high = np.stack([corner, corner + cells + 2, corner + cells + 1], axis=1)
    triangles = np.concatenate([low, high]).astype(np.int32)
    uv = np.stack([u, v], axis=1) * (1.0 - 2.0 * margin) + margin
    return positions.astype(np.float32), triangles, uv[triangles].astype(np.float32)


def sphere(radius=0.5, around=48, rings=24):
    """A UV sphere around the origin; its map is one chart with a seam along one meridian."""
    turn = np.linspace(0.0, 2.0 * np.pi, around + 1)
    rise = np.linspace(-0.5 * np.pi, 0.5 * np.pi, rings + 1)
    t, r = (axis.ravel() for axis in np.meshgrid(turn, rise))
    positions = radius * np.stack([np.cos(r) * np.cos(t), np.cos(r) * np.sin(t), np.sin(r)], axis=1)
    uv = np.stack([t / (2.0 * np.pi), r / np.pi + 0.5], axis=1) * 0.96 + 0.02
    triangles = []
    for ring in range(rings):
        for i in range(around):
            a = ring * (around + 1) + i
            c = a + around + 1
            if ring > 0:
                triangles.append((a, a + 1, c + 1))
            if ring < rings - 1:
                triangles.append((a, c + 1, c))
    triangles = np.array(triangles, np.int32)
    return positions.astype(np.float32), triangles, uv[triangles].astype(np.float32)


def turned_over(mesh):
    """The mesh with flipped triangles: its sides swap."""
    positions, triangles, uv = mesh
    return positions, triangles[:, ::-1].copy(), uv[:, ::-1].copy()


def smooth(positions, triangles):
    """Shading numbers (T, 3) that join the corners in one place: a mesh without sharp edges."""
    places = np.unique(np.round(positions, 5), axis=0, return_inverse=True)[1]
    return places.reshape(-1)[triangles].astype(np.int32)


def box(size=1.0, height=1.0):
    """An axis-aligned box standing on z = 0; charts in a 3 x 2 arrangement: -x +x -y / +y bottom top."""
    h = 0.5 * size
    corners = np.array([(x, y, z) for z in (0.0, height) for y in (-h, h) for x in (-h, h)], np.float32)
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles, uv = [], []
    for index, (a, b, c, d) in enumerate(faces):
        low = np.array([(index % 3) / 3.0, (index // 3) / 2.0]) + 0.02
        size_uv = np.array([1.0 / 3.0, 0.5]) - 0.04
        q = [low, low + size_uv * (1, 0), low + size_uv, low + size_uv * (0, 1)]
        triangles += [(a, b, c), (a, c, d)]
        uv += [(q[0], q[1], q[2]), (q[0], q[2], q[3])]
    return corners, np.array(triangles, np.int32), np.array(uv, np.float32)


def chart_of_box(map_values, index):
    """The part of a box's map that holds face `index`, its border texels left out."""
    size = map_values.shape[0]
    u = (index % 3) / 3.0 + 0.02
    v = (index // 3) / 2.0 + 0.02
    columns = slice(int(u * size) + 2, int((u + 1.0 / 3.0 - 0.04) * size) - 2)
    rows = slice(int(v * size) + 2, int((v + 0.5 - 0.04) * size) - 2)
    return map_values[rows, columns]


def rotated(positions, axis, degrees):
    """Positions turned around the x, y or z axis through the origin."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turned = np.array(positions, np.float64)
    turned[:, i] = c * positions[:, i] - s * positions[:, j]
    turned[:, j] = s * positions[:, i] + c * positions[:, j]
    return turned.astype(np.float32)


def wind(degrees, bearing=0.0):
    """The direction of a fall at an angle from vertical that blows to a bearing (0 = +Y, 90 = +X)."""
    a, b = np.radians(degrees), np.radians(bearing)
    return (np.sin(a) * np.sin(b), np.sin(a) * np.cos(b), -np.cos(a))


def cylinder(radius, length, around=32, axis="z"):
    """A closed cylinder around the origin along an axis: its side unrolled over the lower half of the map, the two
    ends as discs above it (the end towards +axis on the right)."""
    turn = np.linspace(0.0, 2.0 * np.pi, around + 1)
    circle = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)[:-1]
    half = np.full(around, 0.5 * length)
    positions = np.concatenate(
        [
            np.column_stack([circle, -half]),
            np.column_stack([circle, half]),
            [[0, 0, -half[0]], [0, 0, half[0]]],
        ]
    )
    u = 0.02 + 0.96 * turn / (2.0 * np.pi)
    disc = 0.2 * circle / radius
    triangles, uv = [], []
    for i in range(around):
        j = (i + 1) % around
        triangles += [(i, j, around + j), (i, around + j, around + i)]
        a, b, c, d = (u[i], 0.02), (u[i + 1], 0.02), (u[i + 1], 0.48), (u[i], 0.48)
        uv += [(a, b, c), (a, c, d)]
        for end, centre, order in ((0, (0.25, 0.75), (j, i)), (around, (0.75, 0.75), (i, j))):
            triangles.append((2 * around + (end > 0), end + order[0], end + order[1]))
            uv.append(
                (centre, *(tuple(np.add(centre, disc[k] * (1.0 if end else (-1.0, 1.0)))) for k in order))
            )
    x, y, z = {"z": (0, 1, 2), "x": (2, 0, 1)}[axis]
    return (
        positions[:, [x, y, z]].astype(np.float32),
        np.array(triangles, np.int32),
        np.array(uv, np.float32),
    )


def bevelled_box(bevel, segments, size=1.0, height=1.0, texel=0.01):
    """A box around the z axis on z = 0 whose upper and upright edges are rounded with that radius, by that many faces
    each; and the resolution at which a texel has that size. Its map has a chart for each face."""
    inner, middle = 0.5 * size - bevel, 0.5 * np.pi / segments
    rings = []
    for k in range(segments + 1):
        out, down = bevel * np.sin(k * middle), bevel * (1.0 - np.cos(k * middle))
        turn = (np.arange(4)[:, None] * segments + np.arange(segments + 1)).ravel() * middle
        corner = np.repeat([(1, 1), (-1, 1), (-1, -1), (1, -1)], segments + 1, axis=0) * inner
        ring = corner + out * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        rings.append(np.column_stack([ring, np.full(len(ring), height - down)]))
    rings.append(rings[-1] * (1.0, 1.0, 0.0))
    faces = [rings[0][:: segments + 1], rings[-1][::-1]]
    for upper, lower in zip(rings, rings[1:]):
        for i in range(len(upper)):
            j = (i + 1) % len(upper)
            face = np.array([upper[j], upper[i], lower[i], lower[j]])
            keep = [not np.allclose(face[k], face[k - 1], atol=1e-9) for k in range(4)]
            if sum(keep) > 2:
                faces.append(face[keep])
    return unfolded(faces, texel)


def lathe(profile, sides=20):
    """Faces of a body around the z axis. profile: radius and height of each ring."""
    rings = [
        [(r * np.cos(t), r * np.sin(t), z) for t in np.linspace(0, 2 * np.pi, sides + 1)] for r, z in profile
    ]
    return [
        np.array([low[k], low[k + 1], high[k + 1], high[k]])
        for low, high in zip(rings, rings[1:])
        for k in range(sides)
    ]


def unfolded(faces, texel):
    """Positions, triangles, uv and the resolution of flat polygons, each with a chart of its own, side by side in
    rows."""
    charts = []
    for face in faces:
        along = (face[1] - face[0]) / np.linalg.norm(face[1] - face[0])
        normal = sum(np.cross(face[k] - face[0], face[k + 1] - face[0]) for k in range(1, len(face) - 1))
        across = np.cross(normal / np.linalg.norm(normal), along)
        chart = np.stack([(face - face[0]) @ along, (face - face[0]) @ across], axis=1)
        charts.append((chart - chart.min(axis=0)) / texel)
    sizes = [np.ceil(chart.max(axis=0)) + 6 for chart in charts]
    edge = int(np.ceil(max(1.1 * np.sqrt(sum(w * h for w, h in sizes)), *(max(size) for size in sizes))))
    places, resolution = {}, 0
    x = y = row = 0
    for i in sorted(range(len(charts)), key=lambda i: -sizes[i][1]):
        w, h = sizes[i]
        if x + w > edge:
            x, y, row = 0, y + row, 0
        places[i] = (x + 3, y + 3)
        x, row = x + w, max(row, h)
        resolution = max(resolution, int(y + h), edge)
    numbers, positions, triangles, uv = {}, [], [], []
    for i, face in enumerate(faces):
        own = [numbers.setdefault(tuple(np.round(point, 6)), len(numbers)) for point in face]
        for point, number in zip(face, own):
            if number == len(positions):
                positions.append(point)
        chart = (charts[i] + places[i]) / resolution
        for k in range(1, len(face) - 1):
            triangles.append((own[0], own[k], own[k + 1]))
            uv.append((chart[0], chart[k], chart[k + 1]))
    return (
        np.array(positions, np.float32),
        np.array(triangles, np.int32),
        np.array(uv, np.float32),
        resolution,
    )
