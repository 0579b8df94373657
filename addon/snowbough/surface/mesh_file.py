# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as binary PLY files: quads first, then triangles, with a texture coordinate for each corner. No ``bpy``."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..cache.errors import CacheError
from ..cache.files import open_regular, write_bytes


@dataclass
class FileMesh:
    """A mesh of quads and triangles."""

    positions: np.ndarray
    """(V, 3) float32."""
    quads: np.ndarray
    """(Q, 4) int32."""
    triangles: np.ndarray
    """(T, 3) int32."""
    quad_uv: np.ndarray
    """(Q, 4, 2) float32."""
    triangle_uv: np.ndarray
    """(T, 3, 2) float32."""
    smooth: np.ndarray = None
    """(T, 3) int32: corners with equal numbers share a normal, -1 is flat; None if all are flat or it is unknown."""

    @property
    def corners(self):
        """(L,) int32 vertex indices of the corners of all faces, quads first."""
        return np.concatenate([self.quads.ravel(), self.triangles.ravel()])

    @property
    def corner_uv(self):
        """(L, 2) float32, in the order of `corners`."""
        return np.concatenate([self.quad_uv.reshape(-1, 2), self.triangle_uv.reshape(-1, 2)])

    @property
    def sides(self):
        """(F,) int32, the number of corners of each face."""
        return np.repeat(np.array([4, 3], np.int32), [len(self.quads), len(self.triangles)])


def _record(sides, smooth):
    fields = [
        ("n", "u1"), ("corner", "<i4", (sides,)), ("m", "u1"), ("uv", "<f4", (2 * sides,)),
    ]  # fmt: skip
    if smooth:
        fields += [("s", "u1"), ("smooth", "<i4", (sides,))]
    return np.dtype(fields)


def _rows(faces, uv, smooth):
    sides = faces.shape[1]
    rows = np.zeros(len(faces), _record(sides, smooth is not None))
    rows["n"], rows["corner"] = sides, faces
    rows["m"], rows["uv"] = 2 * sides, uv.reshape(len(faces), 2 * sides)
    if smooth is not None:
        rows["s"], rows["smooth"] = sides, smooth
    return rows.tobytes()


def write_mesh(path, mesh):
    """Writes a FileMesh atomically. Raises CacheError."""
    header = [
        "ply", "format binary_little_endian 1.0",
        f"comment quads {len(mesh.quads)}",
        f"element vertex {len(mesh.positions)}", "property float x", "property float y", "property float z",
        f"element face {len(mesh.quads) + len(mesh.triangles)}",
        "property list uchar int vertex_indices", "property list uchar float texcoord",
        *(["property list uchar int smooth"] if mesh.smooth is not None else []),
        "end_header", "",
    ]  # fmt: skip
    data = "\n".join(header).encode() + np.ascontiguousarray(mesh.positions, "<f4").tobytes()
    data += _rows(mesh.quads, mesh.quad_uv, None if mesh.smooth is None else np.zeros((0, 4), np.int32))
    write_bytes(path, data + _rows(mesh.triangles, mesh.triangle_uv, mesh.smooth))


def read_mesh(path):
    """The FileMesh that write_mesh wrote. Raises CacheError for a missing or damaged file."""
    path = Path(path)
    try:
        with open_regular(path) as stream:
            raw = stream.read()
        end = raw.index(b"end_header\n") + len(b"end_header\n")
        header = raw[:end].decode("ascii")
        quads, points, faces = (
            int(re.search(rf"^{name} (\d+)$", header, re.M).group(1))
            for name in ("comment quads", "element vertex", "element face")
        )
        smooth = "list uchar int smooth" in header
        records = (_record(4, smooth), quads), (_record(3, smooth), faces - quads)
        if len(raw) != end + 12 * points + sum(record.itemsize * count for record, count in records):
            raise ValueError("it is truncated")
        positions = np.frombuffer(raw, "<f4", 3 * points, end).reshape(-1, 3)
        end += 12 * points
        four = np.frombuffer(raw, records[0][0], quads, end)
        three = np.frombuffer(raw, records[1][0], faces - quads, end + four.nbytes)
        if any(
            len(rows) and not 0 <= rows["corner"].min() <= rows["corner"].max() < points
            for rows in (four, three)
        ):
            raise ValueError("a face refers to missing points")
    except (OSError, ValueError, AttributeError) as error:
        raise CacheError(f"{path} cannot be read ({error}): bake again, or use Update Surface") from error
    return FileMesh(
        positions,
        four["corner"],
        three["corner"],
        four["uv"].reshape(-1, 4, 2),
        three["uv"].reshape(-1, 3, 2),
        three["smooth"] if smooth else None,
    )
