# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for export: converts corners with several UVs to vertices with one UV per map. No ``bpy``."""

from dataclasses import dataclass, field, replace

import numpy as np

# Maximum number of bones per vertex, the size of JOINTS_0.
INFLUENCES = 4


@dataclass
class TriangleMesh:
    """A mesh with UVs at its corners. Metres, Z up, UV origin bottom-left.

    points float32 (V, 3); joints int32 and weights float32 (V, 4), unused weights are 0, the others sum to 1;
    corner_point int32 (C,); corner_uvs: float32 (C, 2) each, in the order of TEXCOORD_0, _1 and so on;
    triangles int32 (T, 3): corners, anticlockwise seen from outside; material int32 (T,);
    smooth bool (T,): shaded with the points' normals, otherwise with the triangle's normal;
    level int32 (V,): branch level, None for leaves;
    normals: float32 (C, 3), unit vectors that replace those of `smooth`, or None;
    wind: float32 pivots (V, 3), axes (V, 3), lengths (V,) and phases (V,) of tree.wind_attributes, or None.
    """

    points: np.ndarray
    joints: np.ndarray
    weights: np.ndarray
    corner_point: np.ndarray
    corner_uvs: list
    triangles: np.ndarray
    material: np.ndarray
    smooth: np.ndarray
    level: np.ndarray | None = field(default=None)
    wind: tuple | None = field(default=None)
    normals: np.ndarray | None = field(default=None)


def from_quads(points, quads, corner_uvs, joints, weights, material, level):
    """The TriangleMesh of a native tree mesh: quads int (F, 4); corner_uvs: (F, 4, 2) each; material int (F,)."""
    corners = np.arange(len(quads) * 4, dtype=np.int32).reshape(-1, 4)
    return TriangleMesh(
        points=np.asarray(points, dtype=np.float32),
        joints=np.asarray(joints),
        weights=np.asarray(weights),
        corner_point=np.asarray(quads, dtype=np.int32).reshape(-1),
        corner_uvs=[np.asarray(uv, dtype=np.float32).reshape(-1, 2) for uv in corner_uvs],
        triangles=corners[:, (0, 1, 2, 0, 2, 3)].reshape(-1, 3),
        material=np.repeat(np.asarray(material, dtype=np.int32), 2),
        smooth=np.ones(2 * len(quads), dtype=bool),
        level=level,
    )


def transformed(surface, linear):
    """The TriangleMesh with its points multiplied by a (3, 3) matrix. A matrix that mirrors flips the triangles."""
    linear = np.asarray(linear, dtype=np.float64)

    def moved(vectors):
        return (np.asarray(vectors, dtype=np.float64) @ linear.T).astype(np.float32)

    triangles = surface.triangles[:, ::-1] if np.linalg.det(linear) < 0 else surface.triangles
    wind = surface.wind
    if wind is not None:
        pivot, axis, length, phase = wind
        stretched = np.linalg.norm(moved(axis), axis=1)
        axis = unit(moved(axis)).astype(np.float32)
        wind = (moved(pivot), axis, (length * stretched).astype(np.float32), phase)
    normals = surface.normals
    if normals is not None:
        normals = unit(normals.astype(np.float64) @ np.linalg.inv(linear)).astype(np.float32)
    return replace(surface, points=moved(surface.points), triangles=triangles, wind=wind, normals=normals)


def strongest(indices, weights):
    """(indices, weights) of the four largest influences: int32 and float32 (V, 4). Weights sum to 1; unused ones are 0
    with index 0.

    Points without weights follow bone 0.
    """
    indices, weights = np.asarray(indices), np.asarray(weights, dtype=np.float64)
    if indices.shape[1] < INFLUENCES:
        spare = ((0, 0), (0, INFLUENCES - indices.shape[1]))
        indices, weights = np.pad(indices, spare), np.pad(weights, spare)
    order = np.argsort(-weights, axis=1, kind="stable")[:, :INFLUENCES]
    indices, weights = np.take_along_axis(indices, order, 1), np.take_along_axis(weights, order, 1)
    weights = np.maximum(weights, 0.0)
    weights[weights.sum(axis=1) <= 0, 0] = 1.0
    weights = (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)
    return np.where(weights > 0, indices, 0).astype(np.int32), weights


def unit(vectors):
    """Normalises vectors. Zero vectors become (0, 0, 1)."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > 0, vectors / np.maximum(length, 1e-300), (0.0, 0.0, 1.0))


def corner_normals(surface):
    """float32 (T, 3, 3): the normal at each triangle's corners. Without custom normals, a point's is the mean of the
    normals of its smooth triangles, weighted by their angles at the point.

    Source: G. Thuermer, C. A. Wuethrich, Computing Vertex Normals from Polygonal Facets, JGT 3 (1), 1998.
    """
    if surface.normals is not None:
        return surface.normals[surface.triangles]
    points = surface.corner_point[surface.triangles]
    place = surface.points.astype(np.float64)[points]
    face = unit(np.cross(place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]))
    onward, backward = unit(np.roll(place, -1, 1) - place), unit(np.roll(place, 1, 1) - place)
    angle = np.arccos(np.clip((onward * backward).sum(axis=-1), -1.0, 1.0))
    sums = np.zeros((len(surface.points), 3))
    smooth = surface.smooth
    weighted = face[smooth, None] * angle[smooth, :, None]
    for axis in range(3):
        sums[:, axis] = np.bincount(
            points[smooth].reshape(-1), weighted[..., axis].reshape(-1), minlength=len(sums)
        )
    normals = np.repeat(face[:, None], 3, axis=1)
    normals[smooth] = unit(sums)[points[smooth]]
    return normals.astype(np.float32)


def point_normals(points, triangles):
    """(V, 3): normals of a smooth mesh, weighted by the areas of its triangles."""
    a, b, c = (points[triangles[:, k]].astype(np.float64) for k in range(3))
    normals = np.zeros(points.shape)
    for k in range(3):
        np.add.at(normals, triangles[:, k], np.cross(b - a, c - a))
    return unit(normals)


def limb_widths(surface):
    """float32 (V,): the width of the limb at each point, in metres. TEXCOORD_0 goes once around a limb and keeps its
    aspect, so an area on the limb is the square of the circumference times the area in TEXCOORD_0."""
    points, uv = surface.corner_point[surface.triangles], surface.corner_uvs[0].astype(np.float64)
    sides = np.diff(surface.points.astype(np.float64)[points], axis=1)
    turns = np.diff(uv[surface.triangles], axis=1)
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1), np.abs(np.linalg.det(turns))
    on_limb, on_map = (
        np.bincount(points.reshape(-1), np.repeat(area, 3), len(surface.points)) for area in areas
    )
    return (np.sqrt(on_limb / np.maximum(on_map, 1e-30)) / np.pi).astype(np.float32)


@dataclass
class Vertices:
    """The vertices of a glTF primitive, each with one normal and one UV per map. Row k comes from point `point[k]`."""

    point: np.ndarray
    normals: np.ndarray
    uvs: list
    triangles: np.ndarray


def split(surface, chosen, labels=None):
    """The Vertices of the triangles `chosen` (bool (T,)). A point becomes one vertex for each different combination of
    UVs, normal and label, in the order in which the triangles use them. labels: float32 for each chosen triangle."""
    normals = corner_normals(surface)[chosen].reshape(-1, 3)
    corners = surface.triangles[chosen].reshape(-1)
    point = surface.corner_point[corners]
    uvs = [uv[corners] for uv in surface.corner_uvs]
    # Compared bit by bit; adding 0 turns -0 into 0.
    parts = [point[:, None].astype(np.int32)]
    parts += [np.ascontiguousarray(part + np.float32(0.0)).view(np.int32) for part in (normals, *uvs)]
    if labels is not None:
        parts.append(np.repeat(labels, 3)[:, None].view(np.int32))
    key = np.ascontiguousarray(np.concatenate(parts, axis=1))
    rows = key.view(np.dtype((np.void, key.dtype.itemsize * key.shape[1]))).reshape(-1)
    _, first, inverse = np.unique(rows, return_index=True, return_inverse=True)
    # np.unique sorts by bytes, but engines fetch vertices faster in the order of the triangles.
    order = np.argsort(first, kind="stable")
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    kept = first[order]
    return Vertices(
        point=point[kept],
        normals=normals[kept],
        uvs=[uv[kept] for uv in uvs],
        triangles=number[inverse.reshape(-1)].reshape(-1, 3),
    )
