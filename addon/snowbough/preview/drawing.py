# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the snow of receivers over a 3D view with Blender's ``gpu`` module (3.4 to 5.2; OpenGL, Vulkan, Metal).

Heights are a texture of one float a texel, positions and normals of the receiver's own vertices two textures, and the
points of its surface_mesh look up in them where they are: nothing as fine as the snow is made or sent again while the
timeline plays. What is handed over is sent when it is next drawn.
"""

import bpy
import gpu
import numpy as np
from mathutils import Matrix, Vector

from . import interface, surface_mesh
from .normals import NormalTable

# Texels that an edge of what is drawn is long.
TEXELS_PER_EDGE = 2.0
MOST_TRIANGLES = 1_000_000
# Where the processor draws: so many take about a fifth of the time in which it draws Blender's window without them.
MOST_TRIANGLES_SOFTWARE = 30_000
SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swiftshader", "software")
# Where light comes from, in the view: left, above and from behind the one who looks.
LIGHT_IN_VIEW = Vector((-0.45, 0.55, 0.70))
LIGHT_IN_WORLD = Vector((-0.2, -0.2, 0.9))
# What of the snow is there in the Wireframe view, through which one looks.
ALPHA_IN_WIREFRAME = 0.45


def why_not():
    """Why nothing can be drawn in this Blender, as a sentence that says what to do; empty where it can."""
    if not bpy.app.background:
        return ""
    try:
        gpu.init()  # from 5.2 on; before, nothing of the module may be touched without a window
        return ""
    except (AttributeError, SystemError, RuntimeError):
        return (
            "The live preview is drawn into 3D views, and this Blender runs without a window: open the file in "
            "Blender's window, or bake"
        )


def is_software():
    """Whether the processor draws."""
    renderer = gpu.platform.renderer_get().lower()
    return any(name in renderer for name in SOFTWARE_RENDERERS)


def _shader():
    info = gpu.types.GPUShaderCreateInfo()
    for location, (name, kind, _, _) in enumerate(interface.ATTRIBUTES):
        info.vertex_in(location, kind, name)
    for slot, name in enumerate(interface.TABLES):
        info.sampler(slot, "FLOAT_2D", name)
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


def _texture(values, width, format):
    """A texture of (N, C) float32 in rows of `width` texels, filled up with zeros."""
    channels = values.shape[1]
    height = max(1, -(-len(values) // width))
    filled = np.zeros(height * width * channels, dtype=np.float32)
    filled[: values.size] = values.reshape(-1)
    buffer = gpu.types.Buffer("FLOAT", filled.size, filled)
    return gpu.types.GPUTexture((width, height), format=format, data=buffer)


def _table(values):
    """A texture of (N, 3) or (N, 4) values, one a texel."""
    padded = np.zeros((max(len(values), 1), 4), dtype=np.float32)
    padded[: len(values), : values.shape[1]] = values
    return _texture(padded, interface.ROW, "RGBA32F")


def _further_rows(entries):
    """(4 N, 4): four texels an entry, as add_further in the vertex shader reads them."""
    rows = np.zeros((len(entries), 4, 4), dtype=np.float32)
    rows[:, 0, :3], rows[:, 0, 3] = entries.corners, entries.weights[:, 0]
    rows[:, 1, :3], rows[:, 1, 3] = entries.normals, entries.weights[:, 1]
    rows[:, 2, :2] = entries.uv
    rows[:, 3] = entries.tangents
    return rows.reshape(-1, 4)


class ReceiverDrawing:
    """The snow of one receiver: what is known of it, and what of that the driver has.

    topology: scene.pose.Topology; positions (V, 3) metres of its first pose; resolution: of its map; most_triangles:
    that it may take.
    """

    def __init__(self, topology, positions, resolution, most_triangles):
        self.topology = topology
        self.resolution = resolution
        self.is_there = True
        """Whether the object is in the view."""
        self._most_triangles = most_triangles
        self._normals = NormalTable(topology)
        self.mesh = surface_mesh.build(
            topology, positions, self._normals.corners, TEXELS_PER_EDGE, resolution, most_triangles
        )
        self._batch = None
        self._textures = {}
        self._unsent = {"further": _further_rows(self.mesh.more)}
        self._positions = None
        self.set_positions(positions)
        self.set_heights(np.zeros((resolution, resolution), dtype=np.float32))

    def set_positions(self, positions):
        """The pose to draw on, (V, 3) metres; the same array again costs nothing."""
        if positions is not self._positions:
            self._positions = positions
            self._unsent["positions"] = positions

    def with_topology(self, topology, positions):
        """The same snow on another mesh."""
        other = ReceiverDrawing(topology, positions, self.resolution, self._most_triangles)
        other.set_heights(self._heights)
        return other

    def set_heights(self, heights):
        """(H, H) metres along the normal, row 0 = v 0, negative on the back."""
        self._heights = self._unsent["heights"] = heights

    def _send(self):
        """Hands over to the driver what it does not have yet."""
        if "positions" in self._unsent:
            self._textures["normals"] = _table(self._normals.compute(self._positions))
            self._textures["positions"] = _table(self._unsent.pop("positions"))
        if "heights" in self._unsent:
            heights = np.ascontiguousarray(self._unsent.pop("heights"), dtype=np.float32)
            self._textures["heights"] = _texture(heights.reshape(-1, 1), self.resolution, "R32F")
        if "further" in self._unsent:
            self._textures["further"] = _table(self._unsent.pop("further"))
        if self._batch is None:
            self._batch = self._make_batch()

    def _make_batch(self):
        mesh, first = self.mesh, self.mesh.first
        vertex_format = gpu.types.GPUVertFormat()
        for name, _, component, length in interface.ATTRIBUTES:
            fetch = "INT" if component == "I32" else "FLOAT"
            vertex_format.attr_add(id=name, comp_type=component, len=length, fetch_mode=fetch)
        values = {
            "corners": first.corners,
            "corner_normals": first.normals,
            "weights": np.concatenate([first.weights, mesh.inside[:, None]], axis=1),
            "uv": first.uv,
            "tangents": first.tangents,
            "more": mesh.more_range,
        }
        vertices = gpu.types.GPUVertBuf(len=len(first), format=vertex_format)
        for name, array in values.items():
            vertices.attr_fill(id=name, data=np.ascontiguousarray(array))
        return gpu.types.GPUBatch(
            type="TRIS", buf=vertices, elem=gpu.types.GPUIndexBuf(type="TRIS", seq=mesh.triangles)
        )

    def draw(self, shader):
        """With the shader bound and its view set."""
        self._send()
        for name in interface.TABLES:
            shader.uniform_sampler(name, self._textures[name])
        shader.uniform_float("map_size", float(self.resolution))
        self._batch.draw(shader)


class Drawing:
    """The snow of all receivers. metres: a Blender unit."""

    def __init__(self, metres):
        self._metres = metres
        self._shader = None
        self.receivers = {}
        """Key -> ReceiverDrawing."""

    def draw(self, wireframe):
        """Into the view that is being drawn. wireframe: nothing in it hides what is behind."""
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
            if wireframe:  # what lies nearest first, or snow behind snow would shine through
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
            if receiver.is_there:
                receiver.draw(self._shader)
