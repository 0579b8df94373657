# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws into 3D views with Blender's ``gpu`` module (3.4 to 5.2; OpenGL, Vulkan, Metal): the live preview its meshes,
Snowbough Realtime its picture."""

from contextlib import contextmanager

import bpy
import gpu
import numpy as np

from .names import is_software

# Components of the types of attributes.
LENGTHS = {"VEC2": 2, "VEC3": 3}


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


def make_shader(vertex, fragment, attributes, varying, constants=(), samplers=(), defines=()):
    """A shader from sources without declarations; call it during a redraw. attributes: {name: type}; varying: (type,
    name); constants: (type, name) each, at most 128 bytes together; samplers: names of 2D textures; defines: (name,
    value) each. The fragment stage writes `color`."""
    info = gpu.types.GPUShaderCreateInfo()
    for location, (name, kind) in enumerate(attributes.items()):
        info.vertex_in(location, kind, name)
    for kind, name in constants:
        info.push_constant(kind, name)
    for slot, name in enumerate(samplers):
        info.sampler(slot, "FLOAT_2D", name)
    for name, value in defines:
        info.define(name, value)
    interface = gpu.types.GPUStageInterfaceInfo(f"snowbough_{varying[1]}")
    interface.smooth(*varying)
    info.vertex_out(interface)
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(vertex)
    info.fragment_source(fragment)
    return gpu.shader.create_from_info(info)


def index_buffer(triangles):
    """triangles: (T, 3) indices."""
    return gpu.types.GPUIndexBuf(type="TRIS", seq=triangles)


def make_batch(attributes, values, indices):
    """Triangles to draw. attributes: as of make_shader; values: an (N, components) array for each; indices: an
    index_buffer()."""
    vertex_format = gpu.types.GPUVertFormat()
    for name, kind in attributes.items():
        vertex_format.attr_add(id=name, comp_type="F32", len=LENGTHS[kind], fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(len=max(len(values[0]), 1), format=vertex_format)
    if len(values[0]):
        for name, of in zip(attributes, values):
            vertices.attr_fill(id=name, data=np.ascontiguousarray(of, dtype=np.float32))
    return gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=indices)


@contextmanager
def state(depth_test, depth_mask, blend):
    """Sets the state of the gpu module, and restores it afterwards."""
    before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
    _set_state(depth_test, depth_mask, blend)
    try:
        yield
    finally:
        gpu.state.color_mask_set(True, True, True, True)
        _set_state(*before)


def _set_state(depth_test, depth_mask, blend):
    gpu.state.depth_test_set(depth_test)
    gpu.state.depth_mask_set(depth_mask)
    gpu.state.blend_set(blend)
