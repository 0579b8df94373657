# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow on the receivers of a scene: baked snow, or in 3D views the snow of a running live preview."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..base import session
from ..base.names import MIN_DEPTH
from ..cache.files import frame_file
from ..cache.manifest import read_manifest
from ..result import snow_surface
from ..result.baked_images import baked_uv_map, folders_of_members, frames_on_disk
from ..scene.libraries import library_name
from ..scene.pose import member_key, metres_per_unit, own_key
from ..scene.receivers import snow_style
from . import materials
from .records import LyingSnow, Shape

# The value of unused entries of a persistent_id.
NO_INDEX = 0x7FFFFFFF


@dataclass(frozen=True)
class ReceiverId:
    """Identifies an object of the scene, or its instance in an instanced collection. It may have a snow map."""

    name: str
    library: str
    instancer: str = ""
    instancer_library: str = ""
    order: tuple = ()
    """persistent_id without unused entries."""

    @property
    def key(self):
        """The key of the receiver in SceneReader."""
        if not self.instancer:
            return own_key(self.name, self.library)
        return member_key(self.name, self.library, self.instancer, self.instancer_library, self.order)


def receiver_of(instance, original):
    """The ReceiverId of a depsgraph instance of an original object. None for instances made by geometry nodes,
    particles or faces, which cannot have their own map."""
    if not instance.is_instance:
        return ReceiverId(original.name, library_name(original))
    parent = instance.parent.original if instance.parent else None
    if parent is None or parent.instance_type != "COLLECTION":
        return None
    order = tuple(index for index in instance.persistent_id if index != NO_INDEX)
    return ReceiverId(original.name, library_name(original), parent.name, library_name(parent), order)


class SceneSnow:
    """Finds the snow on receivers. native: the module; shows_live: whether to show the snow of a running live
    preview."""

    def __init__(self, native, shows_live):
        self._baked = BakedSnow(native)
        self._live = LiveSnow() if shows_live else None

    def begin(self, scene):
        """Reads the receivers and the current frame of a scene. Call it before the other methods."""
        runs = self._live is not None and running(scene) is not None
        self._now = self._live if runs else self._baked
        self._now.begin(scene)

    def revision(self, scene):
        """A value that changes whenever the live preview's snow changes; None without a live preview."""
        preview = running(scene) if self._live is not None else None
        return None if preview is None else (id(preview), preview.revision)

    def is_drawn_otherwise(self, shell):
        """Whether the snow of a shell (snow surface object) comes from this class instead of its mesh."""
        return self._now.is_drawn_otherwise(shell)

    def is_on(self, receiver):
        """Whether the ReceiverId has a map in the current frame. False for None."""
        return receiver is not None and self._now.is_on(receiver)

    def of(self, receiver, arrays):
        """The LyingSnow of a ReceiverId for which is_on() is true; None if its mesh lacks the UV map of the snow map.
        arrays.uv(name) returns a UV map of the mesh or None."""
        return self._now.of(receiver, arrays)

    def surface_of(self, receiver):
        """(Shape, its print, [its matrix]) of the snow surface of a ReceiverId for which is_on() is true; None if there
        is only a map."""
        return self._now.surface_of(receiver)


def running(scene):
    """The running live preview of a scene, or None."""
    preview = session.preview
    is_its = preview is not None and preview.simulated is not None and preview.scene_name == scene.name
    return preview if is_its else None


class LiveSnow:
    """The snow of the running live preview, with the methods of SceneSnow: surfaces, and maps for trees."""

    def __init__(self):
        self._lying = {}
        self._surfaces = {}

    def begin(self, scene):
        self._preview = running(scene)
        self._unit = metres_per_unit(scene)
        simulated = self._preview.simulated
        self._uv_maps = {
            key: pose.uv_map for key, pose in simulated.pose.objects.items() if key in simulated.maps
        }
        self._names = {simulated.pose.objects[key].name for key in self._uv_maps}

    def is_drawn_otherwise(self, shell):
        return True

    def is_on(self, receiver):
        # Compare names first: keys take longer to compute, and forests have many instances.
        return receiver.name in self._names and receiver.key in self._uv_maps

    def of(self, receiver, arrays):
        key = receiver.key
        uv = arrays.uv(self._uv_maps[key])
        if uv is None:
            return None
        metres, style = self._preview.heights(key), self._preview.style(key)
        known = self._lying.get(key)
        if known is None or known[0] is not metres or known[1].uv is not uv or known[1].style != style:
            depths = (depth / self._unit for depth in self._preview.depths)
            known = self._lying[key] = (metres, LyingSnow(metres / self._unit, uv, *depths, style))
        return known[1]

    def surface_of(self, receiver):
        surface = self._preview.surface(receiver.key)
        known = self._surfaces.get(receiver.key)
        if known is None or known[0] is not surface.shown:
            points, normals = surface.shown
            triangles = surface.triangles
            shape = Shape(
                points,
                triangles,
                normals[triangles],
                np.zeros((len(triangles), 3, 2), np.float32),
                np.zeros(len(triangles), np.int32),
                (materials.SNOW.paint,),
                is_snow=True,
            )
            matrix = np.diag((*(1.0 / self._unit,) * 3, 1.0))
            known = self._surfaces[receiver.key] = (surface.shown, (shape, shape.print, [matrix]))
        return known[1]


class BakedSnow:
    """Height maps of a bake, with the methods of SceneSnow. It caches the last map of each receiver. native: the
    module."""

    def __init__(self, native):
        self._native = native
        self._maps = {}
        self._members = {}
        self._lying = {}

    def begin(self, scene):
        self._unit = metres_per_unit(scene)
        self._frame = scene.frame_current
        # Each folder is listed once per begin().
        self._paths = {}
        # Keys are the fields of a ReceiverId except its order: an empty shows each object of its collection once.
        self._folders = {}
        # Read the original scene: a bake writes its folders there, and the evaluated scene is not updated.
        for entry in scene.original.snowbough.receivers:
            if entry.object is None or not entry.enabled or not entry.folder:
                continue
            # Receivers with a snow surface are skipped: the surface is a mesh of the scene.
            if not snow_surface.find(entry):
                self._folders.update(self._folders_of(entry, snow_style(scene.original, entry)))

    def _folders_of(self, entry, style):
        """{fields of a ReceiverId except its order: (folder, UV map, style)} of a baked entry of the receivers."""
        obj, library = entry.object, library_name(entry.object)
        if obj.type == "MESH":
            return {(obj.name, library, "", ""): (entry.folder, entry.uv_map, style)}
        beside = Path(bpy.path.abspath(entry.folder)).parent
        stamp = beside.stat().st_mtime_ns if beside.is_dir() else None
        known = self._members.get((entry.folder, obj.name))
        if known is None or known[0] != stamp:
            members = folders_of_members(entry.folder, obj.name) if stamp is not None else {}
            known = self._members[entry.folder, obj.name] = (stamp, members)
        return {(*member, obj.name, library): (folder, "", style) for member, folder in known[1].items()}

    def is_drawn_otherwise(self, _surface):
        return False

    def is_on(self, receiver):
        return self._path(self._found(receiver)[0]) is not None

    def of(self, receiver, arrays):
        folder, uv_map, style = self._found(receiver)
        uv = arrays.uv(baked_uv_map(folder) or uv_map)
        if uv is None:
            return None
        heights, depths = self._read(self._path(folder))
        known = self._lying.get(receiver)
        if known is None or known.heights is not heights or known.uv is not uv or known.style != style:
            known = self._lying[receiver] = LyingSnow(heights, uv, *depths, style)
        return known

    def surface_of(self, _receiver):
        return None

    def _found(self, receiver):
        """(folder, UV map, SurfaceStyle) of a ReceiverId; empty texts and None if it was not baked."""
        named = (receiver.name, receiver.library, receiver.instancer, receiver.instancer_library)
        return self._folders.get(named, ("", "", None))

    def _path(self, folder):
        """The file of the current frame; after the last baked frame the last file, before the first one None."""
        if not folder:
            return None
        if folder not in self._paths:
            baked = Path(bpy.path.abspath(folder))
            frames = frames_on_disk(baked, "height")
            is_there = bool(frames) and self._frame >= frames[0]
            self._paths[folder] = (
                baked / frame_file("height", min(self._frame, frames[-1])) if is_there else None
            )
        return self._paths[folder]

    def _read(self, path):
        """((H, W) float32, (open depth, open depth at the end of the shot)) in Blender units."""
        stamp = path.stat().st_mtime_ns
        known = self._maps.get(path.parent)
        if known is None or known[:2] != (path, stamp):
            metres = self._native.read_exr(str(path))[0]
            by_file = {
                frame_file("height", entry["frame"]): entry["depth"]
                for entry in read_manifest(path.parent)["frames"]
            }
            depths = (by_file[path.name] / self._unit, max(*by_file.values(), MIN_DEPTH) / self._unit)
            self._maps[path.parent] = (path, stamp, (metres / self._unit, depths))
        return self._maps[path.parent][2]
