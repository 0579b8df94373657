# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of many pieces for the snow tests: tile courses, paving and slats, as modellers make them."""

import math

import numpy as np
from snow_meshes import box, rotated

TEXEL = 0.01


def pieces(boxes):
    """One mesh of boxes (centre, size, pitch in degrees about x), in metres: positions, triangles, uv, resolution.
    Every face has a chart of its own, side by side with the others; texels are 1 cm wide."""
    corners, faces, _ = box(1.0, 1.0)
    positions, triangles, sizes = [], [], []
    for number, (centre, size, pitch) in enumerate(boxes):
        local = (corners - np.array([0.0, 0.0, 0.5])) * size
        positions.append(rotated(local, "x", pitch) + np.array(centre))
        triangles.append(faces + 8 * number)
        for face in faces.reshape(6, 6):
            a, b, d = local[face[0]], local[face[1]], local[face[5]]
            sizes.append((np.linalg.norm(b - a) / TEXEL, np.linalg.norm(d - a) / TEXEL))
    resolution = 128
    while (places := shelves(sizes, resolution)) is None:
        resolution *= 2
    uv = [
        [(x, y), (x + w, y), (x + w, y + h), (x, y), (x + w, y + h), (x, y + h)]
        for (x, y), (w, h) in zip(places, sizes)
    ]
    return (
        np.concatenate(positions).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        (np.array(uv).reshape(-1, 3, 2) / resolution).astype(np.float32),
        resolution,
    )


def shelves(sizes, resolution):
    """Lower left corners of rectangles, packed in rows; None if they do not fit."""
    places, x, y, shelf = {}, 2, 2, 0
    for i in sorted(range(len(sizes)), key=lambda i: -sizes[i][1]):
        width, height = (math.ceil(size) for size in sizes[i])
        if x + width + 2 > resolution:
            x, y, shelf = 2, y + shelf + 2, 0
        if x + width + 2 > resolution or y + height + 2 > resolution:
            return None
        places[i] = (x, y)
        x, shelf = x + width + 2, max(shelf, height)
    return [places[i] for i in range(len(sizes))]


def tile_courses(count=8, width=0.6, pitch=40.0, step=0.03, length=0.22):
    """A roof of courses that lie on each other; the lower end of each is a step above the course below."""
    turn = rotated(np.eye(3), "x", pitch)
    tilt = math.degrees(math.atan2(step, length))
    boxes = []
    for i in range(count):
        along = rotated(np.eye(3), "x", pitch - tilt)
        long = 1.25 * length
        lower_end = turn[1] * i * length + turn[2] * step
        boxes.append(
            (lower_end + along[1] * 0.5 * long - along[2] * 0.5 * step, (width, long, step), pitch - tilt)
        )
    return boxes


def slab(count=8, width=0.6, pitch=40.0, length=0.22):
    """A roof of the same size in one piece."""
    centre = rotated(np.array([[0.0, 0.5 * count * length, -0.02]]), "x", pitch)[0]
    return [(centre, (width, count * length, 0.04), pitch)]


def paving(count=3, stone=0.5, joint=0.015):
    """Stones side by side; their tops are at z = 0."""
    way = stone + joint
    steps = [(i - 0.5 * (count - 1)) * way for i in range(count)]
    return [((x, y, -0.05), (stone, stone, 0.1), 0.0) for y in steps for x in steps]


def slats(places, width=0.06, length=1.0, top=0.5):
    """Slats along x with their middles at these y."""
    return [((0.0, y, top - 0.0125), (length, width, 0.025), 0.0) for y in places]


def bevelled_slats(
    places, segments, bevel=0.006, width=0.06, length=1.0, height=0.025, texel=0.005, with_walls=None
):
    """The same slats with bevels: walls, bevels and top lie side by side in one chart; or only so many faces of each
    side, `with_walls`, in the chart of the walls, and the others in that of the top."""
    turn = np.linspace(0.0, np.pi / 2, segments + 1)
    corner = bevel * np.stack([1 - np.cos(turn), np.sin(turn)], axis=1)
    left = np.array([[0.0, 0.0], *(corner + (0.0, height - bevel))]) - (width / 2, height)
    outline = np.concatenate([left, (left * (-1, 1))[::-1]])
    around = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(outline, axis=0), axis=1))])
    count, row = len(outline), math.ceil(around[-1] / texel) + 2
    resolution = 128
    while resolution < max(length / texel + 2, 3 * row * len(places)):
        resolution *= 2
    quads = [(i, i + 1, count + i + 1, count + i) for i in range(count - 1)] + [
        (count - 1, 0, count, 2 * count - 1)
    ]
    inner = range(1, count - 1)
    ends = [(0, i, i + 1) for i in inner] + [(count, count + i + 1, count + i) for i in inner]
    faces = np.array([(a, d, c) for a, _, c, d in quads] + [(a, c, b) for a, b, c, _ in quads] + ends)
    positions, triangles, uv = [], [], []
    for number, y in enumerate(places):
        for x in (-length / 2, length / 2):
            positions += [(x, y + across, 0.5 + up) for across, up in outline]
        triangles.append(faces + 2 * count * number)
        low = (1, 1 + 3 * row * number)
        for face in faces:
            # The ends take no snow; their chart is a point.
            is_end = len(set(face // count)) == 1
            on = [(0 if is_end else (v // count) * length, around[v % count]) for v in face]
            # The underside's chart is beside.
            along = sorted(v % count for v in face)
            up = row if along[0] == 0 and along[-1] == count - 1 else 0
            if with_walls is not None and with_walls <= along[0] and along[-1] < count - with_walls:
                up = 2 * row
            shown = [(low[0] + a / texel, low[1] + up + (0 if is_end else b / texel)) for a, b in on]
            uv.append(shown)
    return (
        np.array(positions, np.float32),
        np.concatenate(triangles).astype(np.int32),
        (np.array(uv) / resolution).astype(np.float32),
        resolution,
    )


def top_chart(mesh, piece, values):
    """The texels of a piece's top."""
    uv, resolution = mesh[2][12 * piece + 10 : 12 * piece + 12].reshape(-1, 2), mesh[3]
    low = np.rint(uv.min(axis=0) * resolution).astype(int)
    high = np.rint(uv.max(axis=0) * resolution).astype(int)
    return values[low[1] : high[1], low[0] : high[0]]
