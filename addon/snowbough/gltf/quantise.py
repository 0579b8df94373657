# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex attributes in few bytes, as the extension KHR_mesh_quantization of glTF 2.0 allows (Khronos Group's registry
of extensions). No ``bpy``.
"""

import numpy as np

# Largest values of 16-bit positions and of 8-bit normals.
POSITION_STEPS, NORMAL_STEPS = 32767, 127


class Grid:
    """A cubic grid that contains points (N, 3): position = offset + step * whole numbers."""

    def __init__(self, points):
        low, high = points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64)
        self.offset = (low + high) / 2
        self.step = max(float((high - low).max()) / 2, 1e-6) / POSITION_STEPS

    def numbers(self, points):
        """int16 (N, 3). Equal points have equal numbers, so closed meshes stay closed."""
        return np.rint((points - self.offset) / self.step).astype(np.int16)

    @property
    def matrix(self):
        """(4, 4): from numbers to positions."""
        matrix = np.diag((self.step, self.step, self.step, 1.0))
        matrix[:3, 3] = self.offset
        return matrix

    @property
    def transform(self):
        """The same as properties of a node."""
        return {"translation": self.offset.tolist(), "scale": [self.step] * 3}


def normals(vectors):
    """int8 of unit vectors (N, 3) or tangents (N, 4)."""
    return np.rint(np.asarray(vectors, np.float64) * NORMAL_STEPS).astype(np.int8)


def weights(shares):
    """uint8 (N, 4) of rows that sum to 1. The sum of each row is exactly 255; rounding errors go to the largest."""
    numbers = np.rint(np.asarray(shares, np.float64) * 255).astype(np.int64)
    rows = np.arange(len(numbers))
    numbers[rows, numbers.argmax(axis=1)] += 255 - numbers.sum(axis=1)
    return numbers.astype(np.uint8)


def texture_coordinates(uv):
    """uint16 of coordinates from 0 to 1, for normalised accessors; others unchanged."""
    if len(uv) and uv.min() >= 0.0 and uv.max() <= 1.0:
        return np.rint(np.asarray(uv, np.float64) * 65535).astype(np.uint16)
    return uv


def rotations(quaternions):
    """int16 (..., 4) of unit quaternions, for normalised accessors."""
    return np.rint(np.asarray(quaternions, np.float64) * POSITION_STEPS).astype(np.int16)
