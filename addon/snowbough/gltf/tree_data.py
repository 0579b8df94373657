# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree as plain data, which the formats write. Metres, Z up, UV origin bottom-left. No ``bpy``."""

from dataclasses import dataclass, field

import numpy as np

# Linear, the same as in the real-time renderer.
SNOW_COLOR, SNOW_ROUGHNESS = (0.86, 0.88, 0.91), 0.6
# Sine of half the angle below which a joint does not move.
STILL = 1e-5


@dataclass
class Joint:
    """A bone. parent: index of its parent, -1 for a root; parents come first. rest: its rest matrix (4, 4), only
    rotation and translation; the bone lies along its Y axis. length, radius: in metres. connected: it continues its
    parent."""

    name: str
    parent: int
    rest: np.ndarray
    length: float = 0.0
    radius: float = 0.0
    connected: bool = False


@dataclass
class Texture:
    """The bytes of an image file, sampled at uv * scale + offset of TEXCOORD_<texcoord>, with v upwards."""

    name: str
    data: bytes
    mime_type: str
    texcoord: int = 0
    scale: tuple = (1.0, 1.0)
    offset: tuple = (0.0, 0.0)


@dataclass
class Material:
    """A metallic-roughness material of glTF, not metallic. cutoff: texels with lower alpha are invisible; None:
    opaque."""

    name: str
    color: tuple = (1.0, 1.0, 1.0)
    roughness: float = 0.9
    base: Texture | None = None
    normal: Texture | None = None
    cutoff: float | None = None
    double_sided: bool = False


@dataclass
class Part:
    """Bark or leaves. levels: one TriangleMesh per level of detail, the finest first. materials: indexed by
    TriangleMesh.material."""

    name: str
    levels: list
    materials: list


@dataclass
class SnowMesh:
    """Snow as a static mesh: float32 points (V, 3) and int32 triangles (T, 3), smooth shaded."""

    name: str
    points: np.ndarray
    triangles: np.ndarray


@dataclass
class Cards:
    """Pictures of a tree that replace it from afar: float32 points, normals (V, 3) and uv (V, 2); int32 triangles
    (T, 3); material: its texture has all pictures."""

    name: str
    points: np.ndarray
    normals: np.ndarray
    uv: np.ndarray
    triangles: np.ndarray
    material: Material | None = None


@dataclass
class Motion:
    """A loop of poses: float times (K,) in seconds from 0 on, and turns (K, B, 4): for each joint the rotation
    (x, y, z, w) in its own axes, from its rest pose. The last pose is the first one."""

    times: np.ndarray
    turns: np.ndarray


@dataclass
class Tree:
    """name; joints: [Joint]; parts: [Part], the bark first; branch_levels: number of levels, including the trunk;
    extras: plain data about the snow; snow_meshes: [SnowMesh]; motion: Motion or None; cards: Cards, the last level of
    detail, or None."""

    name: str
    joints: list
    parts: list
    branch_levels: int
    extras: dict = field(default_factory=dict)
    snow_meshes: list = field(default_factory=list)
    motion: Motion | None = None
    cards: Cards | None = None


def local_rests(joints, upright=None):
    """[(4, 4)]: the rest matrix of each joint relative to its parent. upright: (4, 4), applied to all rest matrices,
    for another up axis."""
    upright = np.eye(4) if upright is None else upright
    world = [upright @ joint.rest for joint in joints]
    return [
        matrix if joint.parent < 0 else np.linalg.inv(world[joint.parent]) @ matrix
        for joint, matrix in zip(joints, world)
    ]


def quaternion(rotation):
    """(x, y, z, w) of a (3, 3) rotation. The largest component is computed first, for full precision.

    Source: S. W. Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1 (3), 1978.
    """
    m = rotation
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], m.trace()])
    largest = int(np.argmax(squares))
    if largest == 3:
        q = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1.0 + m.trace())
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q = [0.0, 0.0, 0.0, m[k, j] - m[j, k]]
        q[i] = 1.0 - m.trace() + 2.0 * m[i, i]
        q[j], q[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
    q = np.asarray(q, dtype=np.float64)
    return q / np.linalg.norm(q)


def times(p, q):
    """Products (..., 4) of quaternions (x, y, z, w): q is applied first."""
    (a, b, c, d), (e, f, g, h) = np.moveaxis(p, -1, 0), np.moveaxis(q, -1, 0)
    return np.stack(
        [
            d * e + a * h + b * g - c * f,
            d * f - a * g + b * h + c * e,
            d * g + a * f - b * e + c * h,
            d * h - a * e - b * f - c * g,
        ],
        axis=-1,
    )
