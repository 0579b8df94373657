# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the faces and points of a receiver's snow surface from its folder in the cache. No ``bpy``.

Reads only the manifest, the maps, ``receiver.ply`` and ``positions.pc2``, also of the receivers beside it: no scene
is evaluated and nothing is simulated. Writes ``surface.ply`` (faces), ``surface.pc2`` (points: one sample without
snow, then one per frame) and ``surface.json`` (the style, the counts, and whether it lacks points).
"""

import hashlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from ..base.names import MIN_DEPTH
from ..cache import integrity
from ..cache.errors import CacheError
from ..cache.files import POSITIONS, RECEIVER, SURFACE, SURFACE_FACES, SURFACE_POINTS, frame_file
from ..cache.manifest import read_manifest
from ..cache.sealed import read_sealed, write_sealed
from ..cache.shapes import Maybe, checksums, dict_of, either, flag, frame, number, text, whole
from . import neighbours
from .mesh_file import FileMesh, read_mesh, write_mesh
from .point_cache import PointCacheWriter, read_point_cache
from .style import DETAILS, WantedPoints

# Number of frames, besides the last, whose maps determine the snow-covered area. They are spread over the shot.
LOOKED_AT = 8
# These maps stay in memory for later use if they have at most this many bytes in total.
MAX_KEPT_BYTES = 256 << 20
# Number of maps that are read ahead.
AHEAD = 3
# Tolerance within which a matrix counts as a rotation.
SAME_SCALE = 1e-4

# Time of planning a surface in frames, and seconds per point and frame, of a processor of 2020: 23 to 56 and 0.4 to
# 1.2 microseconds per point were measured.
PLAN, POINT_SECONDS = 60, 0.6e-6

# Hems that are coarser than the detail asks for by more than this factor are worth a word.
COARSENED = 1.25

_SHAPE = {
    "style": dict_of(either(number, text, flag)),
    "first": frame,
    "frames": frame,
    "points": whole,
    "coarsened": Maybe(flag),
    "checksums": Maybe(checksums(SURFACE_FACES, SURFACE_POINTS)),
}


class NoSurface(ValueError):
    """The folder lacks the inputs of a surface. The message says what to do."""


class SurfaceInputs:
    """The shape of a receiver and its maps, read from its folder."""

    def __init__(self, native, folder):
        self._native = native
        self.folder = Path(folder)
        self.manifest = read_manifest(self.folder)
        if self.manifest is None:
            raise NoSurface(f"{self.folder} contains no bake: bake the snow first")
        self.label = self.manifest["label"]
        self.frames = [entry for entry in self.manifest["frames"] if "to_world" in entry]
        if not self.frames or not (self.folder / RECEIVER).is_file():
            raise NoSurface(
                f"'{self.label}' was baked by an earlier version, or its faces change during the shot: "
                "bake it again, or choose Displacement > None"
            )
        self.mesh = read_mesh(self.folder / RECEIVER)
        self.local = read_point_cache(self.folder / POSITIONS)
        if self.local.shape[1] != len(self.mesh.positions) or self.local.shape[0] not in (
            1,
            len(self.frames),
        ):
            raise CacheError(
                f"{self.folder / POSITIONS} does not match its bake: free the bake, then bake again"
            )
        self._matrices = [
            np.array(entry["to_world"], dtype=np.float64).reshape(4, 4) for entry in self.frames
        ]

        # Index of a frame -> its map.
        self._maps = {}

    @property
    def first(self):
        return self.frames[0]["frame"]

    def height(self, index):
        """The map of the frame with that index, (R, R) float32, metres. Do not modify it."""
        if index in self._maps:
            return self._maps[index]
        path = self.folder / frame_file("height", self.frames[index]["frame"])
        try:
            return self._native.read_exr(str(path))[0]
        except RuntimeError as error:
            raise CacheError(f"{error}. Bake again") from error

    @property
    def is_pressed(self):
        """Whether objects have pressed, pushed or removed its snow."""
        return any(name in self.frames[-1] for name in ("pressed", "cleared"))

    def highest(self):
        """(the maximum thickness over the sampled frames at each texel, the maximum by which it ever lay lower than
        before), (R, R) float32, metres. Of snow that objects have pressed, over all frames; else without the second."""
        count, is_pressed = len(self.frames), self.is_pressed
        looked_at = sorted({round(i * (count - 1) / LOOKED_AT) for i in range(LOOKED_AT + 1)})
        if is_pressed:
            looked_at = range(count)
        with ThreadPoolExecutor(2) as pool:
            highest, dents = None, None
            for index, height in zip(looked_at, pool.map(self.height, looked_at)):
                if height.nbytes * len(looked_at) <= MAX_KEPT_BYTES:
                    self._maps[index] = height
                thickness = np.abs(height)
                before = highest
                highest = thickness if before is None else np.maximum(before, thickness, out=before)
                if is_pressed:
                    sunk = highest - np.abs(height)
                    dents = sunk if dents is None else np.maximum(dents, sunk, out=dents)
        return highest, dents

    def world(self, index):
        """Vertices of a frame in world space, (V, 3) float32, metres."""
        local = self.local[index if len(self.local) > 1 else 0]
        matrix = self._matrices[index]
        return (local @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)

    @property
    def is_mirrored(self):
        """Whether the space of the receiver is mirrored in the last frame."""
        return bool(np.linalg.det(self._matrices[-1][:3, :3]) < 0)

    def wind(self):
        """Mean horizontal component (x, y) of the direction of snowfall."""
        ways = np.array([entry["direction"] for entry in self.frames], dtype=np.float64)
        return tuple(float(value) for value in ways[:, :2].mean(axis=0))

    def pose(self, index):
        """Keyword arguments of the native SnowSurface.points that describe the pose of a frame."""
        matrix, planned = self._matrices[index], self._matrices[-1]
        turn = planned[:3, :3] @ np.linalg.inv(matrix[:3, :3])
        is_rigid = len(self.local) == 1 and np.allclose(turn.T @ turn, np.eye(3), atol=SAME_SCALE)
        if not is_rigid:
            return {"positions": self.world(index), "to_result": np.linalg.inv(matrix).astype(np.float32)}
        return {
            "to_result": np.linalg.inv(planned).astype(np.float32),
            "up": tuple(float(value) for value in turn @ (0.0, 0.0, 1.0)),
        }

    def depth(self, index):
        return float(self.frames[index]["depth"])


class Surface:
    """The native surface of one receiver, for all frames of its shot."""

    def __init__(self, native, folder, style):
        self.inputs = inputs = SurfaceInputs(native, folder)
        last = len(inputs.frames) - 1
        # Where snow thaws, edges of snow are those of the deepest frame.
        fullest = max(range(last + 1), key=lambda index: (inputs.frames[index]["depth"], index))
        highest, dents = inputs.highest()
        self.style = style
        self._native = native.SnowSurface(
            inputs.mesh.triangles,
            inputs.mesh.triangle_uv,
            inputs.world(last),
            inputs.height(fullest),
            highest,
            max(max(entry["depth"] for entry in inputs.frames), MIN_DEPTH),
            shading=inputs.mesh.smooth,
            scale=style.scale,
            most_points=WantedPoints(*inputs.manifest.get("wanted", ())).most(*DETAILS[style.detail]),
            seed=seed_of(inputs.label),
            wind=inputs.wind(),
            dents=dents,
            neighbours=neighbours.near(native, folder),
        )
        self.set_style(style)

    @property
    def is_coarsened(self):
        """Whether its hems are clearly coarser than its detail, for lack of points."""
        return self._native.coarsened > COARSENED

    def set_style(self, style):
        self.style = style
        self._native.set_style(**style.sliders())

    def points(self, index, height=None):
        """(P, 3) float32 points of the frame with that index, in the space of the receiver or its instancer; all in one
        place where the receiver is hidden. height: its map, if it was read already."""
        if self.inputs.frames[index].get("hidden"):
            bare = self.bare_points()
            return np.repeat(bare[:1], len(bare), axis=0)
        return self._shown_points(index, height)

    def _shown_points(self, index, height=None):
        inputs = self.inputs
        height = inputs.height(index) if height is None else height
        return self._native.points(height, inputs.depth(index), **inputs.pose(index))

    def bare_points(self):
        """Points without snow, for the time before the first frame of the shot."""
        resolution = self.inputs.manifest["settings"]["receiver"]["resolution"]
        nothing = np.zeros((resolution, resolution), np.float32)
        return self._native.points(nothing, 0.0, **self.inputs.pose(0))

    def mesh(self):
        """The FileMesh of the last frame, with faces anticlockwise in the space of the points."""
        begin, corners, uv = self._native.faces()
        sides = np.diff(begin)
        quads, triangles = np.flatnonzero(sides == 4), np.flatnonzero(sides == 3)
        # Faces run anticlockwise in the world, so clockwise in a mirrored receiver's own space.
        onward = -1 if self.inputs.is_mirrored else 1
        of_quads = begin[quads][:, None] + np.arange(4)[::onward]
        of_triangles = begin[triangles][:, None] + np.arange(3)[::onward]
        return FileMesh(
            self._shown_points(len(self.inputs.frames) - 1),
            corners[of_quads],
            corners[of_triangles],
            uv[of_quads],
            uv[of_triangles],
        )


def seed_of(label):
    """A seed for noise. It differs between receivers and is the same on every machine."""
    return int.from_bytes(hashlib.blake2b(label.encode(), digest_size=4).digest(), "little")


def expected_seconds(points, frames):
    """Rough time that the surface of a receiver takes, in processor time."""
    return POINT_SECONDS * points * (PLAN + frames)


def update(native, folder, style, progress=lambda share: True, check=lambda: None):
    """Computes and writes the surface of the receiver in `folder` for all baked frames. Returns whether it finished.

    progress(0 to 1) is called after planning and each frame. If it returns False, nothing is changed and the function
    returns False.
    check() is called before existing files are replaced. Raises NoSurface, CacheError.
    """
    folder = Path(folder)
    surface = Surface(native, folder, style)
    inputs, count = surface.inputs, len(surface.inputs.frames)
    mesh = surface.mesh()
    if not progress(PLAN / (PLAN + count)):
        return False
    with (
        PointCacheWriter(folder / SURFACE_POINTS, len(mesh.positions)) as cache,
        ThreadPoolExecutor(2) as pool,
    ):
        cache.add(surface.bare_points())
        reading = [pool.submit(inputs.height, index) for index in range(min(AHEAD, count))]
        for index in range(count):
            height = reading.pop(0).result()
            if index + AHEAD < count:
                reading.append(pool.submit(inputs.height, index + AHEAD))
            cache.add(surface.points(index, height))
            if not progress((PLAN + index + 1) / (PLAN + count)):
                return False
        check()
        # Publish the points after the mesh: the number of points reveals files of different surfaces.
        write_mesh(folder / SURFACE_FACES, mesh)
        cache.publish()
        write_sealed(
            folder / SURFACE,
            {
                "style": style.as_dict(),
                "first": inputs.first,
                "frames": count,
                "points": len(mesh.positions),
                "coarsened": surface.is_coarsened,
                "checksums": integrity.checksums_of(folder, (SURFACE_FACES, SURFACE_POINTS)),
            },
        )
    return True


def damaged(folder):
    """The name of a missing or damaged file of the surface in a folder; None if it is intact or there is none."""
    try:
        summary = read_summary(folder)
    except CacheError:
        return SURFACE
    return None if summary is None else integrity.damaged(folder, summary.get("checksums", {}))


def read_summary(folder):
    """{style, first, frames, points, coarsened} of the surface in a folder, or None. Raises CacheError for a damaged
    file."""
    return read_sealed(Path(folder) / SURFACE, "Use Update Surface", _SHAPE)
