# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow on the receivers of a scene: that of a bake, and in 3D views that of the live preview while it runs."""

from pathlib import Path

import bpy

from .. import session
from ..cache.files import frame_file
from ..result import snow_shell
from ..result.baked_images import baked_uv_map, frames_on_disk
from ..scene.pose import library_path, metres_per_unit
from .records import LyingSnow


class SceneSnow:
    """Says which snow lies on objects. native: the module; shows_live: whether the live preview's counts."""

    def __init__(self, native, shows_live):
        self._baked = BakedSnow(native)
        self._live = LiveSnow() if shows_live else None

    def begin(self, scene):
        """Looks up the receivers of a scene and its frame."""
        runs = self._live is not None and running(scene) is not None
        self._now = self._live if runs else self._baked
        self._now.begin(scene)

    def revision(self, scene):
        """What differs once the live simulation's snow has changed; None without one."""
        preview = running(scene) if self._live is not None else None
        return None if preview is None else (id(preview), preview.revision)

    def is_drawn_otherwise(self, shell):
        """Whether a shell shows what this draws: that of a mesh which has a map."""
        return self._now.is_drawn_otherwise(shell)

    def is_on(self, obj):
        """Whether there is a map for an original object and the frame."""
        return self._now.is_on(obj)

    def of(self, obj, arrays):
        """The LyingSnow on an object whose evaluated mesh has these MeshArrays, or None."""
        return self._now.of(obj, arrays)


def running(scene):
    """The live preview of a scene, or None."""
    preview = session.preview
    is_its = preview is not None and preview.simulated is not None and preview.scene_name == scene.name
    return preview if is_its else None


class LiveSnow:
    """The snow of the running live preview, as SceneSnow's. Of instances, which have a map each, it shows none."""

    def __init__(self):
        self._lying = {}

    def begin(self, scene):
        self._preview = running(scene)
        self._unit = metres_per_unit(scene)
        found = {}
        for key, pose in self._preview.simulated.pose.objects.items():
            if key in self._preview.simulated.maps:
                found.setdefault((pose.name, pose.library), []).append((key, pose.uv_map))
        self._keys = {name: keys[0] for name, keys in found.items() if len(keys) == 1}

    def is_drawn_otherwise(self, shell):
        return True

    def is_on(self, obj):
        return obj.type == "MESH" and (obj.name, library_path(obj)) in self._keys

    def of(self, obj, arrays):
        if not self.is_on(obj):
            return None
        key, uv_map = self._keys[obj.name, library_path(obj)]
        uv = arrays.uv(uv_map)
        if uv is None:
            return None
        metres = self._preview.heights(key)
        known = self._lying.get(key)
        if known is None or known[0] is not metres or known[1].uv is not uv:
            known = self._lying[key] = (metres, LyingSnow(metres / self._unit, uv))
        return known[1]


class BakedSnow:
    """Height maps of a bake, as SceneSnow's. The last one of each receiver is kept; native: the module."""

    def __init__(self, native):
        self._native = native
        self._maps = {}
        self._folders = {}
        self._lying = {}

    def begin(self, scene):
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
        return shell.name in self._shells

    def is_on(self, obj):
        return self._path(obj) is not None

    def of(self, obj, arrays):
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
