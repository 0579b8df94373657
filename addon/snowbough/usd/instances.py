# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds leaves of the same shape: each kind becomes one prototype, each leaf an instance of it. No ``bpy``.

Leaves have the same shape if a rotation and one scale turn one into the other. The rotation is the best one in the
sense of least squares. Custom normals must turn with the leaf: those of a crown that is lit as one ball do not.

Source: S. Umeyama, Least-Squares Estimation of Transformation Parameters Between Two Point Patterns, IEEE Transactions
on Pattern Analysis and Machine Intelligence 13 (4), 1991.
"""

from dataclasses import dataclass

import numpy as np

from ..gltf.thinning import leaf_of_points

# Maximum distance of a leaf's points from those of its prototype, as a share of the leaf's radius.
TOLERANCE = 0.02
# Maximum number of prototypes; leaves of further shapes are no instances.
MAX_KINDS = 64
# Cosine of the largest angle between a custom normal and its prototype's. Leaves with custom normals become instances
# in groups of at least MIN_ALIKE; after MAX_MISSES smaller groups, the rest of their shape is left.
SAME_NORMAL, MIN_ALIKE, MAX_MISSES = np.cos(np.radians(10.0)), 4, 8
# Texture coordinates of leaves of one kind agree within 1 / UV_STEPS.
UV_STEPS = 1024


@dataclass
class Kind:
    """A prototype and its instances. triangles: of the prototype, as indices (T,); origin (3,): its attach point, where
    its own space begins; instances: origins (M, 3), rotations (M, 3, 3), scales (M,) and
    joints (M,). The prototype itself is one of them."""

    triangles: np.ndarray
    origin: np.ndarray
    origins: np.ndarray
    rotations: np.ndarray
    scales: np.ndarray
    joints: np.ndarray


def _alike(surface, leaf, triangles):
    """Yields (points (L, N), triangles (L, T)): groups of leaves with equal connections, materials and texture
    coordinates, as indices of points and of triangles. leaf (V,): see leaf_of_points; triangles: their leaf (T,)."""
    used = np.flatnonzero(leaf >= 0)
    used = used[np.argsort(leaf[used], kind="stable")]
    counts = np.bincount(leaf[used])
    rank = np.zeros(len(leaf), dtype=np.int64)
    rank[used] = np.arange(len(used)) - np.repeat(np.cumsum(counts) - counts, counts)
    order = np.argsort(triangles, kind="stable")
    faces = np.bincount(triangles, minlength=len(counts))
    begin_point, begin_face = np.cumsum(counts) - counts, np.cumsum(faces) - faces
    sizes = np.stack([counts, faces], axis=1)
    for size in np.unique(sizes, axis=0):
        leaves = np.flatnonzero((sizes == size).all(axis=1))
        points = used[begin_point[leaves, None] + np.arange(size[0])]
        own = order[begin_face[leaves, None] + np.arange(size[1])]
        corners = surface.triangles[own]
        uv = np.rint(surface.corner_uvs[0][corners] * UV_STEPS).astype(np.int64)
        parts = (rank[surface.corner_point[corners]], surface.material[own], uv)
        rows = np.concatenate([part.reshape(len(leaves), -1) for part in parts], axis=1)
        _, kind = np.unique(rows, axis=0, return_inverse=True)
        kind = kind.reshape(-1)
        for number in range(kind.max() + 1):
            yield points[kind == number], own[kind == number]


def _fitted(model, shapes):
    """(rotations (L, 3, 3), scales (L,), errors (L,)) from centred points model (N, 3) to shapes (L, N, 3). errors:
    largest distance of a point, as a share of the shape's radius."""
    u, _, v = np.linalg.svd(np.einsum("nj,lni->lij", model, shapes))
    u[:, :, 2] *= np.sign(np.linalg.det(u @ v))[:, None]
    rotations = u @ v
    scales = np.sqrt((shapes**2).sum(axis=(1, 2)) / max((model**2).sum(), 1e-30))
    away = scales[:, None, None] * np.einsum("lij,nj->lni", rotations, model) - shapes
    radius = np.linalg.norm(shapes, axis=2).max(axis=1)
    return rotations, scales, np.linalg.norm(away, axis=2).max(axis=1) / np.maximum(radius, 1e-30)


def _turn_along(surface, triangles, rotations):
    """bool (L,): leaves (L, T) whose custom normals are those of the first leaf, turned by rotations (L, 3, 3)."""
    normals = surface.normals[surface.triangles[triangles]].reshape(len(triangles), -1, 3)
    turned = np.einsum("lij,nj->lni", rotations, normals[0])
    return ((turned * normals).sum(axis=2) >= SAME_NORMAL).all(axis=1)


def _attach(points, joint):
    """The point of points (N, 3) that is nearest to a Joint's bone."""
    head, along = joint.rest[:3, 3], joint.rest[:3, 1] * joint.length
    share = np.clip((points - head) @ along / max(along @ along, 1e-30), 0.0, 1.0)
    return points[np.linalg.norm(points - head - share[:, None] * along, axis=1).argmin()]


def kinds_of(surface, joints):
    """([Kind], bool (T,): triangles of leaves that are no instances) of a Surface of leaves. joints: [Joint]."""
    count, leaf = leaf_of_points(surface)
    own = leaf[surface.corner_point[surface.triangles[:, 0]]]
    left = np.ones(len(own), dtype=bool)
    kinds = []
    for points, triangles in _alike(surface, leaf, own) if count else ():
        misses = 0
        while len(points) and len(kinds) < MAX_KINDS and misses < MAX_MISSES:
            shapes = surface.points[points].astype(np.float64)
            middles = shapes.mean(axis=1)
            centred = shapes - middles[:, None]
            rotations, scales, errors = _fitted(centred[0], centred)
            fits = errors <= TOLERANCE
            if surface.normals is not None:
                fits &= _turn_along(surface, triangles, rotations)
            fits[0] = True
            if surface.normals is not None and fits.sum() < MIN_ALIKE:
                points, triangles = points[~fits], triangles[~fits]
                misses += 1
                continue
            bones = surface.joints[points[:, 0], 0]
            origin = _attach(shapes[0], joints[bones[0]])
            origins = middles + scales[:, None] * np.einsum("lij,j->li", rotations, origin - middles[0])
            kinds.append(
                Kind(
                    triangles[0],
                    origin,
                    *(v[fits] for v in (origins, rotations, scales, bones)),
                )
            )
            left[triangles[fits]] = False
            points, triangles = points[~fits], triangles[~fits]
    return kinds, left
