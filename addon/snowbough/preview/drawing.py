# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the snow of receivers over a 3D view with Blender's ``gpu`` module (3.4 to 5.2; OpenGL, Vulkan, Metal).

After a change, the points and normals of a receiver's surface (receiver_surface) are uploaded at the next redraw.
"""

import bpy
import gpu
import numpy as np
from mathutils import Matrix, Vector

from ..base.names import is_software
from . import interface

# (maximum number of points of all surfaces, factor on edge lengths), for a GPU and for a software renderer.
BUDGET, SOFTWARE_BUDGET = (200_000, 1.0), (15_000, 2.0)
# Direction to the light in the view: left, above and behind the viewer.
LIGHT_IN_VIEW = Vector((-0.45, 0.55, 0.70))
LIGHT_IN_WORLD = Vector((-0.2, -0.2, 0.9))
# Opacity of the snow in the Wireframe view.
ALPHA_IN_WIREFRAME = 0.45


def unavailable_reason():
    """Why this Blender cannot draw, as a sentence that says what to do; empty if it can."""
    if not bpy.app.background:
        return ""
    try:
        gpu.init()  # exists from 5.2 on; older versions must not use the module without a window
        return ""
    except (AttributeError, SystemError, RuntimeError):
        return (
            "The live preview draws into 3D views, but this Blender runs without a window: open the file in "
            "Blender's window, or bake"
        )


def draws_in_software():
    """Whether Blender draws with a software renderer."""
    return is_software(gpu.platform.renderer_get())


def _shader():
    info = gpu.types.GPUShaderCreateInfo()
    for location, (name, kind, _, _) in enumerate(interface.ATTRIBUTES):
        info.vertex_in(location, kind, name)
    for kind, name in interface.CONSTANTS:
        info.push_constant(kind, name)
    varyings = gpu.types.GPUStageInterfaceInfo("snowbough_preview")
    for kind, name in interface.VARYINGS:
        varyings.smooth(kind, name)
    info.vertex_out(varyings)
    info.fragment_out(0, "VEC4", "fragment_color")
    for name, value in interface.DEFINES.items():
        info.define(name, value)
    info.vertex_source(interface.source("vert"))
    info.fragment_source(interface.source("frag"))
    return gpu.shader.create_from_info(info)


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
        self._sent = places, normals = self.surface.shown
        vertex_format = gpu.types.GPUVertFormat()
        for name, _, component, length in interface.ATTRIBUTES:
            vertex_format.attr_add(id=name, comp_type=component, len=length, fetch_mode="FLOAT")
        vertices = gpu.types.GPUVertBuf(len=max(len(places), 1), format=vertex_format)
        if len(places):
            for name, values in (("place", places), ("normal", normals)):
                vertices.attr_fill(id=name, data=np.ascontiguousarray(values, dtype=np.float32))
        if self._triangles is not self.surface.triangles:
            self._triangles = self.surface.triangles
            self._indices = gpu.types.GPUIndexBuf(type="TRIS", seq=self._triangles)
        self._batch = gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=self._indices)

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
            self._shader = _shader()
        view = gpu.matrix.get_model_view_matrix()
        to_clip = gpu.matrix.get_projection_matrix() @ view @ Matrix.Scale(1.0 / self._metres, 4)
        light = view.to_3x3().normalized().transposed() @ LIGHT_IN_VIEW.normalized() + LIGHT_IN_WORLD
        before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.depth_mask_set(True)
        gpu.state.blend_set("ALPHA")
        self._shader.bind()
        self._shader.uniform_float("view_projection", to_clip)
        self._shader.uniform_float("light", (*light.normalized(), ALPHA_IN_WIREFRAME if wireframe else 1.0))
        try:
            if wireframe:  # draw only depth first, otherwise snow would show through snow
                gpu.state.color_mask_set(False, False, False, False)
                self._draw_receivers()
                gpu.state.color_mask_set(True, True, True, True)
            self._draw_receivers()
        finally:
            gpu.state.color_mask_set(True, True, True, True)
            gpu.state.depth_test_set(before[0])
            gpu.state.depth_mask_set(before[1])
            gpu.state.blend_set(before[2])

    def _draw_receivers(self):
        for receiver in self.receivers.values():
            if receiver.surface is not None:
                receiver.draw(self._shader)
