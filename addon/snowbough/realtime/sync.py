# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes to a renderer only the differences between a scene and the one before. No ``bpy``."""

from dataclasses import asdict

import numpy as np

from .records import LyingSnow


class Sync:
    """Keeps the content of a native Renderer equal to the last scene."""

    def __init__(self, renderer):
        self._renderer = renderer
        self._meshes = {}
        self._trees = {}
        # Names of trees by the prints of what they share.
        self._alike = {}

    def update(self, scene):
        """Passes a records.Scene to the renderer. Returns whether anything except the light has changed."""
        changed = self._remove_gone(scene)
        for mesh in scene.meshes:
            changed |= self._update_mesh(mesh)
        for tree in scene.trees:
            changed |= self._update_tree(tree)
        return changed

    def _remove_gone(self, scene):
        gone = self._meshes.keys() - {mesh.key for mesh in scene.meshes}
        for key in gone:
            self._renderer.remove(key)
            del self._meshes[key]
        felled = self._trees.keys() - {tree.key for tree in scene.trees}
        for key in felled:
            self._remove_tree(key)
        return bool(gone or felled)

    def _update_mesh(self, mesh):
        known = self._meshes.get(mesh.key)
        renewed = known is None or known.print != mesh.print
        if renewed:
            if known is not None:
                self._renderer.remove(mesh.key)
            self._add_mesh(mesh)
        moved = not np.array_equal(np.eye(4)[None] if renewed else known.matrices, mesh.matrices)
        if moved:
            self._renderer.set_instances(mesh.key, mesh.matrices)
        snowed = not _is_same_snow(mesh.snow, None if renewed else known.snow)
        if snowed:
            self._set_snow(mesh)
        self._meshes[mesh.key] = mesh
        return renewed or moved or snowed

    def _add_mesh(self, mesh):
        shape = mesh.shape
        if shape.is_snow:
            self._renderer.add_snow_mesh(mesh.key, shape.vertices, shape.triangles, normals=shape.normals)
            return
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

    def _set_snow(self, mesh):
        """Sets the snow map of a mesh. Snow with a surface is a separate mesh."""
        if mesh.snow is None:
            self._renderer.set_mesh_snow(mesh.key)
        else:
            self._renderer.set_mesh_snow(mesh.key, mesh.snow.heights, mesh.snow.uv)

    def _update_tree(self, tree):
        known = self._trees.get(tree.key)
        leafed = known is not None and known.leaves_print != tree.leaves_print
        # Leaves belong to all trees that share them.
        is_shared = known is not None and len(self._alike[_model_of(known)]) > 1
        renewed = known is None or known.print != tree.print or (leafed and is_shared)
        if renewed:
            if known is not None:
                self._remove_tree(tree.key)
            self._add_tree(tree)
        elif leafed:
            self._set_leaves(tree)
        posed = renewed or not np.array_equal(known.pose, tree.pose)
        if posed:
            self._renderer.set_pose(tree.key, tree.pose)
        moved = not np.array_equal(np.eye(4)[None] if renewed else known.matrices, tree.matrices)
        if moved:
            self._renderer.set_instances(tree.key, tree.matrices)
        snowed = not _is_same_snow(tree.snow, None if renewed else known.snow)
        if snowed:
            snow = tree.snow or _BARE
            sliders = snow.style.sliders()
            self._renderer.set_snow(tree.key, snow.heights, snow.open_depth, snow.last_depth, **sliders)
        if known is not None and not renewed:
            self._alike[_model_of(known)].discard(tree.key)
        self._alike.setdefault(_model_of(tree), set()).add(tree.key)
        self._trees[tree.key] = tree
        return renewed or leafed or posed or moved or snowed

    def _add_tree(self, tree):
        """Adds a tree with its bark and leaves, shared with a tree that looks the same if there is one."""
        alike = self._alike.get(_model_of(tree))
        if alike:
            self._renderer.share_tree(tree.key, min(alike))
            return
        bark = tree.bark
        self._renderer.add_tree(
            tree.key, tree.surface, bark_depth=bark.depth, bark_dark=bark.dark, bark_light=bark.light
        )
        if tree.bark_images is not None:
            self._set_bark(tree)
        if tree.leaves is not None:
            self._set_leaves(tree)

    def _remove_tree(self, key):
        self._renderer.remove(key)
        self._alike[_model_of(self._trees.pop(key))].discard(key)

    def _set_bark(self, tree):
        images = tree.bark_images
        self._renderer.set_bark(
            tree.key,
            images.uv,
            images.paint,
            colors=[paint.color for paint in images.paints],
            images=[paint.image for paint in images.paints],
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


_BARE = LyingSnow(np.zeros((1, 1), np.float32), None, 0.0, 1.0)


def _model_of(tree):
    """The prints of what trees share."""
    return tree.print, tree.leaves_print


def _is_same_snow(one, other):
    if one is None or other is None or one is other:
        return one is other
    return one.print == other.print


def camera(native, view):
    """The native Camera of a records.View."""
    return native.Camera(view=view.view, projection=view.projection, width=view.width, height=view.height)


def settings(native, light, flakes=None, **own):
    """The native RenderSettings of a records.Light and of records.Flakes or None. own: additional fields."""
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
