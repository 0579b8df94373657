# SPDX-License-Identifier: GPL-3.0-or-later
"""From a receiver's folder in the cache to the faces and points of its snow. No ``bpy``.

The manifest, the maps, ``receiver.ply`` and ``positions.pc2`` are all that is read: no scene is evaluated, and nothing
is simulated. Written are ``surface.ply`` (faces), ``surface.pc2`` (points: one sample without snow, then one a frame)
and ``surface.json`` (what they were made with).
"""

import hashlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from ..cache.errors import CacheError
from ..cache.files import POSITIONS, RECEIVER, SURFACE, SURFACE_FACES, SURFACE_POINTS, frame_file
from ..cache.manifest import read_manifest
from ..cache.sealed import FORMAT, dict_of, read_sealed, whole, write_sealed
from .mesh_file import FileMesh, read_mesh, write_mesh
from .point_cache import PointCacheWriter, read_point_cache

# Frames whose maps say where snow ever lies: so many, spread over the shot, and the last.
LOOKED_AT = 8
# Their maps are kept for the frames themselves while they are no more than so many bytes.
MOST_KEPT_BYTES = 256 << 20
# Maps that are read ahead.
AHEAD = 3
# Two linear maps whose scales differ by less are a turn of one another.
SAME_SCALE = 1e-4

_SHAPE = {"style": dict_of(lambda value: True), "first": whole, "frames": whole, "points": whole}


class NoSurface(ValueError):
    """The folder does not hold what a surface is computed from; says what to do."""


class SurfaceInputs:
    """What a receiver's folder says of its shape, and its maps."""

    def __init__(self, native, folder):
        self._native = native
        self.folder = Path(folder)
        self.manifest = read_manifest(self.folder)
        if self.manifest is None:
            raise NoSurface(f"{self.folder} holds no bake: bake the snow first")
        self.label = self.manifest["label"]
        self.frames = [entry for entry in self.manifest["frames"] if "to_world" in entry]
        if not self.frames or not (self.folder / RECEIVER).is_file():
            raise NoSurface(
                f"'{self.label}' was baked by an earlier version, or has other faces during the shot than at its end: "
                "bake it again, or show its snow with Material"
            )
        self.mesh = read_mesh(self.folder / RECEIVER)
        self.local = read_point_cache(self.folder / POSITIONS)
        if self.local.shape[1] != len(self.mesh.positions) or self.local.shape[0] not in (
            1,
            len(self.frames),
        ):
            raise CacheError(
                f"{self.folder / POSITIONS} does not fit its bake: free the bake, then bake again"
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
        """The map of the frame of that index, (R, R) float32 metres; not to be written to."""
        if index in self._maps:
            return self._maps[index]
        path = self.folder / frame_file("height", self.frames[index]["frame"])
        try:
            return self._native.read_exr(str(path))[0]
        except RuntimeError as error:
            raise CacheError(f"{error}. Bake again") from error

    def highest(self):
        """The greatest thickness of some frames at each texel, (R, R) float32."""
        count = len(self.frames)
        looked_at = sorted({round(i * (count - 1) / LOOKED_AT) for i in range(LOOKED_AT + 1)})
        with ThreadPoolExecutor(2) as pool:
            highest = None
            for index, height in zip(looked_at, pool.map(self.height, looked_at)):
                if height.nbytes * len(looked_at) <= MOST_KEPT_BYTES:
                    self._maps[index] = height
                thickness = np.abs(height)
                highest = thickness if highest is None else np.maximum(highest, thickness, out=highest)
        return highest

    def world(self, index):
        """Vertices of a frame in metres in the world, (V, 3) float32."""
        local = self.local[index if len(self.local) > 1 else 0]
        matrix = self._matrices[index]
        return (local @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)

    def wind(self):
        """Horizontal part of the direction in which snow falls, on average."""
        ways = np.array([entry["direction"] for entry in self.frames], dtype=np.float64)
        return tuple(float(value) for value in ways[:, :2].mean(axis=0))

    def pose(self, index):
        """What the native SnowSurface.points needs to know of a frame besides the map, a dict."""
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
        highest = inputs.highest()
        self.style = style
        self._native = native.SnowSurface(
            inputs.mesh.triangles,
            inputs.mesh.triangle_uv,
            inputs.world(last),
            inputs.height(last),
            highest,
            max(max(entry["depth"] for entry in inputs.frames), 1e-4),
            shading=inputs.mesh.smooth,
            scale=style.scale,
            most_points=style.most_points(inputs.manifest.get("share", 1.0)),
            seed=seed_of(inputs.label),
            wind=inputs.wind(),
        )
        self.set_style(style)

    def set_style(self, style):
        self.style = style
        self._native.set_style(**style.sliders())

    def points(self, index, height=None):
        """(P, 3) float32 of the frame of that index, in the space of the receiver or its instancer. height: its map,
        where it was read already."""
        inputs = self.inputs
        height = inputs.height(index) if height is None else height
        return self._native.points(height, inputs.depth(index), **inputs.pose(index))

    def bare_points(self):
        """The points before the shot's first frame, without snow."""
        resolution = self.inputs.manifest["settings"]["receiver"]["resolution"]
        nothing = np.zeros((resolution, resolution), np.float32)
        return self._native.points(nothing, 0.0, **self.inputs.pose(0))

    def mesh(self):
        """The FileMesh of the last frame."""
        begin, corners, uv = self._native.faces()
        sides = np.diff(begin)
        quads, triangles = np.flatnonzero(sides == 4), np.flatnonzero(sides == 3)
        of_quads = begin[quads][:, None] + np.arange(4)
        of_triangles = begin[triangles][:, None] + np.arange(3)
        return FileMesh(
            self.points(len(self.inputs.frames) - 1),
            corners[of_quads],
            corners[of_triangles],
            uv[of_quads],
            uv[of_triangles],
        )


def seed_of(label):
    """A number for noise that differs from receiver to receiver and is the same everywhere."""
    return int.from_bytes(hashlib.blake2b(label.encode(), digest_size=4).digest(), "little")


def update(native, folder, style, progress=lambda share: True, check=lambda: None):
    """Computes the surface of the receiver in `folder` for all baked frames, and writes it.

    progress(0 to 1) is asked after each frame whether to go on; where it says no, nothing is changed and False is
    returned. check() is called before files are put in their place. Raises NoSurface, CacheError.
    """
    folder = Path(folder)
    surface = Surface(native, folder, style)
    inputs, count = surface.inputs, len(surface.inputs.frames)
    mesh = surface.mesh()
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
            if not progress((index + 1) / count):
                return False
        check()
        # The points go last: their number of points tells a mesh and points of different surfaces apart.
        write_mesh(folder / SURFACE_FACES, mesh)
        cache.publish()
        write_sealed(
            folder / SURFACE,
            {
                "style": style.as_dict(),
                "first": inputs.first,
                "frames": count,
                "points": len(mesh.positions),
            },
        )
    return True


def read_summary(folder):
    """{style, first, frames, points} of the surface in a folder, or None. Raises CacheError for a damaged file."""
    shapes = {FORMAT: _SHAPE}
    return read_sealed(Path(folder) / SURFACE, "Use Update Surface", shapes.get)
