# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders: F12, animations, and ``blender -b``."""

import numpy as np

from . import sync
from .flakes import flakes_of
from .reader import Reader
from .records import View

# Maximum side of a tile, in pixels. A float texture of that size takes 256 MiB.
LARGEST_TILE = 4096


class FinalRenderer:
    """Renders scenes that Blender has evaluated for rendering. Unchanged data stays on the GPU between frames."""

    def __init__(self, native):
        self._native = native
        self._renderer = native.Renderer()
        self._sync = sync.Sync(self._renderer)
        self.left_out = set()
        """Reader.left_out of the last image."""

    def render(self, depsgraph, camera):
        """Returns the image, (height, width, 4) float32, row 0 at the bottom: scene-linear, premultiplied, as Blender
        expects it.

        camera: the evaluated camera object. If the render has a border, the image contains only the border.
        """
        scene = depsgraph.scene_eval
        reader = Reader(self._native)
        content = reader.read(depsgraph)
        self.left_out = reader.left_out
        self._sync.update(content)
        options = scene.snowbough_realtime
        settings = sync.settings(
            self._native, content.light, flakes_of(scene), **options.as_render_settings()
        )
        transparent = scene.render.film_transparent
        if transparent:
            settings.background = (0.0, 0.0, 0.0)
        view = final_view(scene.render, camera, depsgraph)
        columns, rows = border_of(scene.render, view.width, view.height)
        rgba = np.empty((rows.stop - rows.start, columns.stop - columns.start, 4), np.float32)
        for low in range(rows.start, rows.stop, LARGEST_TILE):
            for left in range(columns.start, columns.stop, LARGEST_TILE):
                wide = slice(left, min(left + LARGEST_TILE, columns.stop))
                high = slice(low, min(low + LARGEST_TILE, rows.stop))
                part = sync.camera(self._native, view.part(wide, high))
                drawn = self._renderer.render_light(part, settings, options.samples)
                at = (high.start - rows.start, wide.start - columns.start)
                rgba[at[0] : at[0] + drawn.shape[0], at[1] : at[1] + drawn.shape[1]] = drawn
        if not transparent:
            rgba[..., 3] = 1.0
        return rgba

    def close(self):
        self._renderer.close()


def picture_size(render):
    """(width, height) of the whole image in pixels, without a border."""
    share = render.resolution_percentage / 100.0
    return max(1, int(render.resolution_x * share)), max(1, int(render.resolution_y * share))


def border_of(render, width, height):
    """Slices of the columns and rows inside the render border, or of all pixels if there is no border."""
    if not render.use_border:
        return slice(0, width), slice(0, height)

    def pixel(share, size):
        return int(np.float32(share) * np.float32(size))  # Blender rounds as float32

    left, right = pixel(render.border_min_x, width), pixel(render.border_max_x, width)
    low, high = pixel(render.border_min_y, height), pixel(render.border_max_y, height)
    return slice(left, max(right, left + 1)), slice(low, max(high, low + 1))


def final_view(render, camera, depsgraph):
    """The records.View of a camera. Blender computes the projection from lens, shift, sensor and pixel aspect."""
    width, height = picture_size(render)
    projection = camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
    )
    # Blender ignores the scale of a camera.
    view = camera.matrix_world.normalized().inverted()
    rows = [tuple(tuple(row) for row in matrix) for matrix in (view, projection)]
    return View(*rows, width, height)
