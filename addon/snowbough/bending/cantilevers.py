# SPDX-License-Identifier: GPL-3.0-or-later
"""How the bones of a tree bend under weights: a chain of rigid bones with elastic joints. Pure numpy, no Blender.

Each limb is a cantilever on its parent limb, with round sections and linear elastic wood (I = pi r^4 / 4, any table of
beams). A joint has the compliance of half its own bone and of half the bone before it on the same limb. Deflections are
large: moments belong to the bent pose, found by fixed-point rounds under a load that grows in steps. Limbs bend and do
not twist. Where the outer fibre would exceed the strength of the wood, the joint takes no more moment: the limb would
break there. The tree's own weight is part of its rest pose.

With 16 bones, the sag under an even small load is 0.4 % above w L^4 / (8 E I). Under a large load at the tip, a chain
of 24 bones is within 0.15 % of the elastica (K. E. Bisshopp, D. C. Drucker, Large Deflection of Cantilever Beams,
Quarterly of Applied Mathematics 3, 1945, pages 272-275; K. Mattiasson, Numerical results from large deflection beam and
frame problems, International Journal for Numerical Methods in Engineering 17, 1981, pages 145-153).
"""

import math
from dataclasses import dataclass

import numpy as np

GRAVITY = 9.81
# The load grows in at least these parts. In one part, soft limbs do not converge.
LOAD_STEPS = (0.25, 0.5, 0.75, 1.0)
MAX_ROUNDS = 200
# Largest change of a joint in the last round, as a share of the largest angle.
TOLERANCE = 1e-4
# Share of a round's change that a joint applies: at first and at most, at least, and its factors where the change turns
# back and where it does not, as in resilient propagation (M. Riedmiller, H. Braun 1993). One share for all joints does
# not converge on overloaded trees.
RELAXATION, MIN_RELAXATION = 0.8, 1e-3
SLOWER, FASTER = 0.5, 1.2
THINNEST = 1e-5


@dataclass
class Bent:
    """A bend. vectors float (S, B, 3): rotation vector of each joint at each of the S asked shares of the load, in the
    space of the bones, radians; stress float (B,): at full load, as a multiple of the strength: above 1, the limb would
    break at the bone; rounds: their number; error: change in the last round, as a share of the largest angle."""

    vectors: np.ndarray
    stress: np.ndarray
    rounds: int
    error: float


def elementwise(function, *arrays):
    """function of math on arrays of one shape. numpy's own sine and arc functions round differently from one place in
    memory to the next."""
    flat = (array.reshape(-1).tolist() for array in arrays)
    return np.fromiter(map(function, *flat), float, arrays[0].size).reshape(arrays[0].shape)


def turned(matrices, vectors):
    """(..., 3): matrices (..., 3, 3) times vectors (..., 3), in one order of additions on all machines."""
    x, y, z = (vectors[..., None, axis] for axis in range(3))
    return (matrices[..., 0] * x + matrices[..., 1] * y) + matrices[..., 2] * z


def _product(one, other):
    return np.stack([turned(one, other[..., column]) for column in range(3)], axis=-1)


def _transposed(matrices):
    return np.swapaxes(matrices, -1, -2)


def rotation_matrices(vectors):
    """(B, 3, 3) matrices of rotation vectors (B, 3)."""
    angle = np.linalg.norm(vectors, axis=1)
    axis = vectors / np.maximum(angle, 1e-12)[:, None]
    x, y, z = axis.T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    sine, cosine = (elementwise(function, angle)[:, None, None] for function in (math.sin, math.cos))
    along = (1.0 - cosine) * (axis[:, :, None] * axis[:, None, :])
    return cosine * np.eye(3) + sine * cross + along


class Cantilevers:
    """The bones of a tree at rest.

    heads, tails float (B, 3), metres; parents int (B,), -1 for roots, parents before children; head_radii, tail_radii
    float (B,), metres; limbs int (B,): the limb of each bone.
    """

    def __init__(self, heads, tails, parents, head_radii, tail_radii, limbs):
        self.heads, self.tails = np.asarray(heads, float), np.asarray(tails, float)
        self.parents, limbs = np.asarray(parents), np.asarray(limbs)
        along = self.tails - self.heads
        lengths = np.maximum(np.linalg.norm(along, axis=1), 1e-9)
        self._directions = along / lengths[:, None]
        a, b = (np.maximum(np.asarray(radii, float), THINNEST) for radii in (head_radii, tail_radii))
        self._radii = a
        # The mean of r^-4 over a linear taper: the thin end decides.
        softness = (a * a + a * b + b * b) / (3.0 * a**3 * b**3)
        half = 0.5 * lengths * softness * 4.0 / np.pi
        self._has_parent = self.parents >= 0
        self._before = np.maximum(self.parents, 0)
        continues = self._has_parent & (limbs[self._before] == limbs)
        self._compliance = half + np.where(continues, half[self._before], 0.0)
        depth = np.zeros(len(self.parents), int)
        for bone, parent in enumerate(self.parents.tolist()):
            depth[bone] = depth[parent] + 1 if parent >= 0 else 0
        self._levels = [np.nonzero(depth == level)[0] for level in range(depth.max() + 1)]

    def pose(self, vectors):
        """((B, 3, 3) rotation of each bone from its rest pose, (B, 3) its head) for joint rotation vectors (B, 3)."""
        joints = rotation_matrices(vectors)
        turns, heads = np.empty_like(joints), self.heads.copy()
        for rows in self._levels:
            if not self._has_parent[rows[0]]:  # the roots
                turns[rows] = joints[rows]
                continue
            parents = self.parents[rows]
            turns[rows] = _product(joints[rows], turns[parents])
            heads[rows] = heads[parents] + turned(turns[parents], self.heads[rows] - self.heads[parents])
        return turns, heads

    def bent_tails(self, vectors):
        """(B, 3) the tails of the bones in that pose."""
        turns, heads = self.pose(vectors)
        return heads + turned(turns, self.tails - self.heads)

    def local_rotations(self, vectors, axes):
        """(B, 3, 3): the rotation of each bone in its own rest frame, as of a pose bone. axes (B, 3, 3): the frames'
        axes as columns."""
        turns, _heads = self.pose(vectors)
        parent_turns = np.where(self._has_parent[:, None, None], turns[self._before], np.eye(3))
        joints = _product(_transposed(parent_turns), turns)
        return _product(_transposed(axes), _product(joints, axes))

    def bend(self, masses, places, down, modulus, strength, shares=(1.0,)):
        """The Bent of a load. masses float (B,): kg on each bone; places float (B, 3): centre of that load at rest;
        down: unit vector of gravity; modulus, strength: Young's modulus and modulus of rupture of the wood, Pa;
        shares: ascending shares of the load from 0 to 1, 1 last."""
        down = np.asarray(down, float)
        most = strength * np.pi * self._radii**3 / 4.0  # sigma I / r
        compliance = self._compliance / modulus
        vectors, rounds, error = np.zeros_like(self.heads), 0, 0.0
        kept = {0.0: vectors}
        for share in sorted({*LOAD_STEPS, *shares} - {0.0}):
            relaxation, before = np.full(len(most), RELAXATION), np.zeros_like(vectors)
            for _ in range(MAX_ROUNDS):
                moments = self._moments(vectors, masses * share, places, down)
                size = np.linalg.norm(moments, axis=1)
                moments *= np.minimum(1.0, most / np.maximum(size, 1e-30))[:, None]
                target = compliance[:, None] * moments
                change = target - vectors
                error = np.linalg.norm(change, axis=1).max()
                error /= max(np.linalg.norm(target, axis=1).max(), 1e-12)
                turns_back = (change * before).sum(axis=1) < 0.0
                relaxation = relaxation * np.where(turns_back, SLOWER, FASTER)
                relaxation = np.clip(relaxation, MIN_RELAXATION, RELAXATION)
                vectors, before = vectors + relaxation[:, None] * change, change
                rounds += 1
                if error < TOLERANCE:
                    break
            kept[share] = vectors
        return Bent(np.stack([kept[share] for share in shares]), size / most, rounds, float(error))

    def _moments(self, vectors, masses, places, down):
        """(B, 3) bending moment at each joint, N m, in the pose of `vectors`."""
        turns, heads = self.pose(vectors)
        weight = masses.copy()
        first = masses[:, None] * (heads + turned(turns, places - self.heads))
        for rows in self._levels[:0:-1]:
            np.add.at(weight, self.parents[rows], weight[rows])
            np.add.at(first, self.parents[rows], first[rows])
        moments = GRAVITY * np.cross(first - weight[:, None] * heads, down)
        along = turned(turns, self._directions)
        return moments - (moments * along).sum(axis=1)[:, None] * along
