# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow of a bake, for the receivers of a scene."""

from pathlib import Path

import bpy

from ..cache.files import frame_file
from ..result import snow_shell
from ..result.baked_images import baked_uv_map, frames_on_disk
from ..scene.pose import library_path, metres_per_unit
from .records import LyingSnow


class BakedSnow:
    """Height maps of a scene's receivers. The last one of each is kept; native: the module."""

    def __init__(self, native):
        self._native = native
        self._maps = {}
        self._folders = {}
        self._lying = {}

    def begin(self, scene):
        """Looks up the receivers of a scene and its frame."""
        self._shells = set()
        self._unit = metres_per_unit(scene)
        self._frame = scene.frame_current
        self._folders = {
            (entry.object.name, library_path(entry.object)): (entry.folder, entry.uv_map)
            for entry in scene.snowbough.receivers
            if entry.object is not None and entry.enabled and entry.folder
        }

        for entry in scene.snowbough.receivers:
            if (
                entry.object is not None
                and entry.object.type == "MESH"
                and self._path(entry.object) is not None
            ):
                self._shells |= {shell.name for shell in snow_shell.find(entry)}

    def is_drawn_otherwise(self, shell):
        """Whether a shell shows what this draws: that of a mesh which has a map."""
        return shell.name in self._shells

    def is_on(self, obj):
        """Whether there is a map for an original object and the frame."""
        return self._path(obj) is not None

    def of(self, obj, arrays):
        """The LyingSnow on an object whose evaluated mesh has these MeshArrays, or None."""
        path = self._path(obj)
        if path is None:
            return None
        folder, uv_map = self._folders[obj.name, library_path(obj)]
        uv = arrays.uv(baked_uv_map(folder) or uv_map)
        if uv is None:
            return None
        heights = self._heights(path)
        known = self._lying.get((obj.name, library_path(obj)))
        if known is None or known.heights is not heights or known.uv is not uv:
            known = self._lying[obj.name, library_path(obj)] = LyingSnow(heights, uv)
        return known

    def _path(self, obj):
        """The file that shows the frame: of a frame behind the last one, the last; None before the first."""
        folder, _ = self._folders.get((obj.name, library_path(obj)), ("", ""))
        if not folder:
            return None
        folder = Path(bpy.path.abspath(folder))
        frames = frames_on_disk(folder, "height")
        if not frames or self._frame < frames[0]:
            return None
        return folder / frame_file("height", min(self._frame, frames[-1]))

    def _heights(self, path):
        """(H, W) float32 in Blender's units."""
        stamp = path.stat().st_mtime_ns
        known = self._maps.get(path.parent)
        if known is None or known[:2] != (path, stamp):
            metres = self._native.read_exr(str(path))[0]
            self._maps[path.parent] = (path, stamp, metres / self._unit)
        return self._maps[path.parent][2]
