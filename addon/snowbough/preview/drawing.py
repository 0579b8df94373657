# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the snow of receivers over a 3D view.

After a change, the points and normals of a receiver's surface (receiver_surface) are uploaded at the next redraw.
"""

import gpu
from mathutils import Matrix, Vector

from ..base import view_drawing
from . import interface

# (maximum number of points of all surfaces, factor on edge lengths), for a GPU and for a software renderer.
BUDGET, SOFTWARE_BUDGET = (200_000, 1.0), (30_000, 1.0)
# Direction to the light in the view: left, above and behind the viewer.
LIGHT_IN_VIEW = Vector((-0.45, 0.55, 0.70))
LIGHT_IN_WORLD = Vector((-0.2, -0.2, 0.9))
# Opacity of the snow in the Wireframe view.
ALPHA_IN_WIREFRAME = 0.45


class ReceiverDrawing:
    """The GPU buffers of the snow of one receiver. surface: its ReceiverSurface, or None while the object is not in
    the view."""

    def __init__(self):
        self.surface = None
        self._sent = None
        self._triangles = self._indices = self._batch = None

    def _send(self):
        """Uploads the surface if it has changed since the last upload."""
        if self._sent is self.surface.shown:
            return
        self._sent = self.surface.shown
        if self._triangles is not self.surface.triangles:
            self._triangles = self.surface.triangles
            self._indices = view_drawing.index_buffer(self._triangles)
        self._batch = view_drawing.make_batch(interface.INPUTS["attributes"], self._sent, self._indices)

    def draw(self, shader):
        """The shader must be bound and its view set."""
        self._send()
        if self._batch is not None and len(self._triangles):
            self._batch.draw(shader)


class Drawing:
    """Draws the snow of all receivers. metres: metres per Blender unit."""

    def __init__(self, metres):
        self._metres = metres
        self._shader = None
        self.receivers = {}
        """Key -> ReceiverDrawing."""

    def show(self, key, surface):
        """Sets the ReceiverSurface that the next redraws show for a receiver; None shows nothing."""
        self.receivers.setdefault(key, ReceiverDrawing()).surface = surface

    def draw(self, wireframe):
        """Draws into the current view. wireframe: the view shows objects through each other."""
        if self._shader is None:
            self._shader = view_drawing.make_shader(
                interface.source("vert"), interface.source("frag"), **interface.INPUTS
            )
        view = gpu.matrix.get_model_view_matrix()
        to_clip = gpu.matrix.get_projection_matrix() @ view @ Matrix.Scale(1.0 / self._metres, 4)
        light = view.to_3x3().normalized().transposed() @ LIGHT_IN_VIEW.normalized() + LIGHT_IN_WORLD
        with view_drawing.state("LESS_EQUAL", True, "ALPHA"):
            self._shader.bind()
            self._shader.uniform_float("view_projection", to_clip)
            self._shader.uniform_float(
                "light", (*light.normalized(), ALPHA_IN_WIREFRAME if wireframe else 1.0)
            )
            if wireframe:  # draw only depth first, otherwise snow would show through snow
                gpu.state.color_mask_set(False, False, False, False)
                self._draw_receivers()
                gpu.state.color_mask_set(True, True, True, True)
            self._draw_receivers()

    def _draw_receivers(self):
        for receiver in self.receivers.values():
            if receiver.surface is not None:
                receiver.draw(self._shader)
