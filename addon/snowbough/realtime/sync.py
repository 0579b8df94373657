# SPDX-License-Identifier: GPL-3.0-or-later
"""Hands scenes to a renderer: what is new, other or gone since the scene before, and nothing else. No ``bpy``."""

from dataclasses import asdict

import numpy as np


class Sync:
    """Keeps a native Renderer's content as that of the last scene."""

    def __init__(self, renderer):
        self._renderer = renderer
        self._meshes = {}
        self._trees = {}
        # Keys of meshes with a layer of snow.
        self._layers = set()

    def update(self, scene):
        """Makes the renderer hold a records.Scene. Returns whether anything but the light had to be changed."""
        changed = self._remove_gone(scene)
        for mesh in scene.meshes:
            changed |= self._update_mesh(mesh)
        for tree in scene.trees:
            changed |= self._update_tree(tree)
        return changed

    def _remove_gone(self, scene):
        gone = False
        for known, now in ((self._meshes, scene.meshes), (self._trees, scene.trees)):
            for key in known.keys() - {thing.key for thing in now}:
                self._renderer.remove(key)
                if key in self._layers:
                    self._drop_layer(key)
                del known[key]
                gone = True
        return gone

    def _update_mesh(self, mesh):
        known = self._meshes.get(mesh.key)
        renewed = known is None or known.print != mesh.print
        if renewed:
            if known is not None:
                self._renderer.remove(mesh.key)
            self._add_mesh(mesh)
        moved = not np.array_equal(np.eye(4)[None] if renewed else known.places, mesh.places)
        if moved:
            self._renderer.set_places(mesh.key, mesh.places)
        snowed = not _is_same_snow(mesh.snow, None if renewed else known.snow)
        if snowed or (mesh.key in self._layers and (moved or renewed)):
            self._set_snow(mesh, known, renewed, moved)
        self._meshes[mesh.key] = mesh
        return renewed or moved or snowed

    def _add_mesh(self, mesh):
        shape = mesh.shape
        self._renderer.add_mesh(
            mesh.key,
            shape.vertices,
            shape.triangles,
            normals=shape.normals,
            uv=shape.uv,
            materials=shape.paint,
            colors=[paint.color for paint in shape.paints],
            images=[paint.image for paint in shape.paints],
        )

    def _set_snow(self, mesh, known, renewed, moved):
        """The one place that says how snow is drawn: as a layer of its own, tessellated and raised along the
        normals; where that cannot be, painted on the mesh.

        It cannot on cut-out leaves, whose cards have no edges to bear it, on what several places share, and where
        Blender has raised the surface already.
        """
        layered = mesh.key in self._layers
        if mesh.snow is None or not _can_bear_a_layer(mesh):
            if layered:
                self._drop_layer(mesh.key)
            self._paint_snow(mesh)
            return
        layer = _layer_of(mesh.key)
        world, normals = in_place(mesh.shape, mesh.places[0])
        same_uv = known is not None and known.snow is not None and _is_same_uv(known.snow, mesh.snow)
        if renewed or not layered or not same_uv:
            if layered:
                self._drop_layer(mesh.key)
            try:
                self._renderer.add_snow_mesh(
                    layer,
                    world,
                    mesh.shape.triangles,
                    np.clip(mesh.snow.uv, 0.0, 1.0),
                    normals,
                    resolution=max(mesh.snow.heights.shape),
                    draws_base=False,
                )
            except ValueError:  # edges of three faces, say
                self._paint_snow(mesh)
                return
            self._layers.add(mesh.key)
        elif moved:
            self._renderer.set_snow_pose(layer, world, normals)
        self._renderer.set_snow(layer, mesh.snow.heights)

    def _paint_snow(self, mesh):
        if mesh.snow is None:
            self._renderer.set_mesh_snow(mesh.key)
        else:
            self._renderer.set_mesh_snow(mesh.key, mesh.snow.heights, mesh.snow.uv)

    def _drop_layer(self, key):
        self._renderer.remove(_layer_of(key))
        self._layers.discard(key)

    def _update_tree(self, tree):
        known = self._trees.get(tree.key)
        renewed = known is None or known.print != tree.print
        if renewed:
            if known is not None:
                self._renderer.remove(tree.key)
            bark = tree.bark
            self._renderer.add_tree(
                tree.key, tree.surface, bark_depth=bark.depth, bark_dark=bark.dark, bark_light=bark.light
            )
            if tree.coat is not None:
                self._set_bark(tree)
        leafed = tree.leaves_print != ("" if renewed else known.leaves_print)
        if leafed:
            self._set_leaves(tree)
        posed = renewed or not np.array_equal(known.pose, tree.pose)
        if posed:
            self._renderer.set_pose(tree.key, tree.pose)
        snowed = not _is_same_snow(tree.snow, None if renewed else known.snow)
        if snowed:
            self._renderer.set_snow(tree.key, _BARE if tree.snow is None else tree.snow.heights)
        self._trees[tree.key] = tree
        return renewed or leafed or posed or snowed

    def _set_bark(self, tree):
        coat = tree.coat
        self._renderer.set_bark(
            tree.key,
            coat.uv,
            coat.paint,
            colors=[paint.color for paint in coat.paints],
            images=[paint.image for paint in coat.paints],
        )

    def _set_leaves(self, tree):
        leaves = tree.leaves
        if leaves is None:
            none = np.empty((0, 3, 3), np.float32)
            self._renderer.set_leaves(tree.key, none, np.empty(0, np.int32))
            return
        self._renderer.set_leaves(
            tree.key,
            leaves.triangles,
            leaves.bones,
            uv=leaves.uv,
            materials=leaves.paint,
            colors=[paint.color for paint in leaves.paints],
            images=[paint.image for paint in leaves.paints],
        )


# A map without snow.
_BARE = np.zeros((1, 1), np.float32)


def _is_same_snow(one, other):
    if one is None or other is None or one is other:
        return one is other
    return one.print == other.print


def _is_same_uv(one, other):
    return one.uv is other.uv or np.array_equal(one.uv, other.uv)


def _can_bear_a_layer(mesh):
    holes = any(paint.has_holes for paint in mesh.shape.paints)
    return len(mesh.places) == 1 and not holes and not mesh.shape.is_displaced


def _layer_of(key):
    """The renderer's name of a mesh's layer of snow."""
    return f"snow on {key}"


def in_place(shape, place):
    """(positions, normals by corner) of a shape in the world."""
    linear = place[:3, :3].astype(np.float64)
    positions = shape.vertices @ linear.T + place[:3, 3]
    # By the matrix of cofactors, which keeps normals upright whatever the scale.
    cofactors = np.stack(
        [np.cross(linear[1], linear[2]), np.cross(linear[2], linear[0]), np.cross(linear[0], linear[1])]
    )
    normals = shape.normals @ cofactors.T
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    return positions.astype(np.float32), normals.astype(np.float32)


def camera(native, view):
    """The native Camera of a records.View."""
    return native.Camera(view=view.view, projection=view.projection, width=view.width, height=view.height)


def settings(native, light, flakes=None, **own):
    """The native RenderSettings under a records.Light, with records.Flakes in the air; own: further fields."""
    if flakes is not None:
        own["snowfall"] = native.Snowfall(**asdict(flakes))
    return native.RenderSettings(
        sun_direction=light.direction,
        sun_color=light.sun,
        sky_color=light.sky,
        ground_color=light.ground,
        background=light.behind,
        cull_back_faces=False,
        **own,
    )
