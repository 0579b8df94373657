# SPDX-License-Identifier: GPL-3.0-or-later
"""Receivers with maps that are written by hand, and the geometry of their shells."""

import bpy
import numpy as np


def write_maps(native, folder, heights, covered=None, first=1):
    """A bake's files: `heights` is a list of (H, W) maps in metres, one a frame."""
    folder.mkdir(parents=True)
    for frame, height in enumerate(heights, first):
        native.write_exr(str(folder / f"height_{frame:04d}.exr"), np.asarray(height, dtype=np.float32))
    ever = np.max([np.abs(h) > 0 for h in heights], axis=0) if covered is None else covered
    native.write_exr(str(folder / "ever_covered.exr"), np.asarray(ever, dtype=np.float32))
    return folder


def write_depth(addon, folder, depth):
    """The manifest of a bake of frame 1 under snow that is `depth` metres deep on open ground."""
    settings = {"receiver": {"uv_map": "snow"}}
    addon("cache.manifest").write_manifest(
        folder, {"settings": settings, "frames": [{"frame": 1, "depth": depth}]}
    )


def shell_of(obj, folder):
    """Puts obj on the list with those files and gives it a shell, which is returned."""
    entry = bpy.context.scene.snowbough.receivers.add()
    entry.object = obj
    entry.folder = str(folder)
    bpy.context.view_layer.update()
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    return bpy.data.objects[f"{obj.name} snow"]


def set_slider(addon, shell, name, value):
    assert addon("compat_nodes").set_modifier_input(shell.modifiers[0], name, float(value))
    shell.update_tag()


def set_relief(addon, shell, strength):
    set_slider(addon, shell, "Relief", strength)


class Geometry:
    """The evaluated mesh of a shell in the current frame: points (V, 3), height and place of every point."""

    def __init__(self, obj):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        mesh = obj.evaluated_get(depsgraph).to_mesh()
        self.points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        mesh.vertices.foreach_get("co", self.points.ravel())
        self._edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
        mesh.edges.foreach_get("vertices", self._edges.ravel())
        corner_edges = np.empty(len(mesh.loops), dtype=np.int32)
        mesh.loops.foreach_get("edge_index", corner_edges)
        self._edge_faces = np.bincount(corner_edges, minlength=len(self._edges))
        self.height = np.empty(len(mesh.vertices), dtype=np.float32)
        mesh.attributes["snow_height"].data.foreach_get("value", self.height)
        self.place = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        mesh.attributes["snow_position"].data.foreach_get("vector", self.place.ravel())

    def border(self):
        """The points of open edges (N, 3)."""
        return self.points[np.unique(self._edges[self._edge_faces == 1])]

    def contour(self, height):
        """Where edges pass that height (N, 3)."""
        low, high = np.sort(self.height[self._edges], axis=1).T
        order = np.argsort(self.height[self._edges], axis=1)
        ends = np.take_along_axis(self._edges, order, axis=1)
        passing = (low < height) & (high > height)
        part = ((height - low) / np.maximum(high - low, 1e-12))[passing, None]
        first, second = self.points[ends[passing]].transpose(1, 0, 2)
        return first + part * (second - first)
