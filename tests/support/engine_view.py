# SPDX-License-Identifier: GPL-3.0-or-later
"""A small engine: draws exported trees (glb.py) with the shaders of docs/engines, without other code of the project.

Needs moderngl (package python3-moderngl) and OpenGL 4.5, such as a software renderer.
"""

import io
import re
from pathlib import Path

import moderngl
import numpy as np
from PIL import Image

SHADERS = Path(__file__).resolve().parents[2] / "docs" / "engines"
STAGES = {
    "vertex_shader": "vert",
    "tess_control_shader": "tesc",
    "tess_evaluation_shader": "tese",
    "fragment_shader": "frag",
}
# Mesa's software renderer numbers the vertices that it makes of one draw with 16 bits: level 16 makes 217 of 3.
PATCHES_A_DRAW = 256
# Vertex attributes of tree.vert.glsl: name in it, name in the file, type as moderngl spells it, width.
ATTRIBUTES = (
    ("position", "POSITION", "3f", 3),
    ("normal", "NORMAL", "3f", 3),
    ("bark_uv", "TEXCOORD_0", "2f", 2),
    ("snow_uv", "TEXCOORD_1", "2f", 2),
    ("branch_level", "_BRANCH_LEVEL", "1f", 1),
    ("joints", "JOINTS_0", "4u2", 4),
    ("weights", "WEIGHTS_0", "4f", 4),
    ("limb_width", "_LIMB_WIDTH", "1f", 1),
)

# A line lies a little before the faces that it bounds.
EDGE_VERTEX = """#version 450
in vec3 position;
layout(std140, binding = 2) uniform View { mat4 view_projection; };
void main() {
  gl_Position = view_projection * vec4(position, 1.0);
  gl_Position.z -= 3e-4 * gl_Position.w;
}
"""
EDGE_FRAGMENT = """#version 450
layout(location = 0) out vec4 color;
void main() { color = vec4(0.0, 0.0, 0.0, 1.0); }
"""


def source(stage):
    """A stage's text with its includes inserted."""
    text = (SHADERS / f"tree.{stage}.glsl").read_text()
    text = re.sub(r"#extension GL_GOOGLE_include_directive.*\n", "", text)
    while "#include" in text:
        text = re.sub(r'#include "(.*)"', lambda named: (SHADERS / named[1]).read_text(), text)
    return text


def _perspective(field_of_view, aspect, near, far):
    f = 1.0 / np.tan(field_of_view / 2)
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = f / aspect, f
    matrix[2, 2], matrix[2, 3], matrix[3, 2] = (far + near) / (near - far), 2 * far * near / (near - far), -1
    return matrix


def _look_at(eye, target):
    back = eye - target
    back = back / np.linalg.norm(back)
    right = np.cross((0.0, 1.0, 0.0), back)
    right = right / np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = right, np.cross(back, right), back
    matrix[:3, 3] = -matrix[:3, :3] @ eye
    return matrix


class EngineView:
    """One window's worth of OpenGL. Y up, metres, as in the file."""

    def __init__(self, size, sources=None):
        """sources: {stage: text}, other shaders than those of docs/engines in GLSL."""
        self.size = size
        self.context = moderngl.create_standalone_context(backend="egl", require=450)
        sources = sources or {stage: source(stage) for stage in STAGES.values()}
        self.program = self.context.program(**{name: sources[stage] for name, stage in STAGES.items()})
        self._edges = self.context.program(vertex_shader=EDGE_VERTEX, fragment_shader=EDGE_FRAGMENT)
        self.target = self.context.framebuffer(
            [self.context.texture((size, size), 4)], self.context.depth_texture((size, size))
        )
        self._counted = self.context.query(primitives=True)
        self._blank = self._texture(np.zeros((1, 1, 1)))
        self.light()
        self.primitives = 0  # that the tessellator has made since the last clear()

    def _texture(self, values):
        """float32 (H, W, channels), row 0 at the top, where v of the file is 0."""
        values = np.ascontiguousarray(values, dtype=np.float32)
        height, width, channels = values.shape
        return self.context.texture((width, height), channels, values.tobytes(), dtype="f4")

    def _uniforms(self, binding, *values):
        """A block of std140 from numbers of four bytes each, in order."""
        words = [
            np.atleast_1d(value).astype(np.int32 if np.asarray(value).dtype.kind == "i" else np.float32)
            for value in values
        ]
        data = b"".join(word.tobytes() for word in words)
        buffer = self.context.buffer(data + b"\0" * (-len(data) % 16))
        buffer.bind_to_uniform_block(binding)

    def clear(self, color=(0.93, 0.94, 0.96, 0.0)):
        self.target.use()
        self.target.clear(*color, depth=1.0)
        self.primitives = 0

    def look(
        self,
        eye,
        target,
        field_of_view=0.46,
        target_pixels=6.0,
        highest=16.0,
        snow_share=0.0,
        levels=1,
    ):
        """The viewpoint and the tessellation: see tree.tesc.glsl."""
        eye, target = np.asarray(eye, float), np.asarray(target, float)
        away = np.linalg.norm(eye - target)
        self._planes = away / 50, away * 100
        matrix = _perspective(field_of_view, 1.0, *self._planes) @ _look_at(eye, target)
        at_one_metre = self.size / (2 * np.tan(field_of_view / 2))
        self._uniforms(1, float(levels), target_pixels, highest, snow_share)
        self._uniforms(2, matrix.T.reshape(-1), eye, at_one_metre)

    def light(self, to_sun=(0.45, 0.7, 0.6), sun=1.5, sky=(0.55, 0.6, 0.68), ground=(0.0, 0.0, 0.0)):
        """See tree.frag.glsl."""
        self._light = np.array(to_sun), sun, np.array(sky), np.array(ground)

    def snow(self, said=None, folder=None, frame=0.0):
        """The file's data of an object's snow; None: no snow."""
        if said is None:
            self._uniforms(0, np.array([1, 1]), 1.0, np.array([1]), *(0.0,) * 5, *(0.0,) * 3, *(1.0,) * 4)
            heights = self._blank
        else:
            tiles = np.array([said["columns"], said["rows"]])
            height = said["height"]
            count = np.array([len(said["frames"])])
            open_depth = np.interp(frame, np.arange(len(said["frames"])), said["openDepths"])
            numbers = (height["scale"], height["offset"], float(frame), open_depth, said["lastDepth"])
            style = {
                **dict.fromkeys(("overhang", "hem_variation", "bridging", "relief"), 1.0),
                **said.get("style", {}),
            }
            # A vec4 begins at a multiple of 16 bytes.
            self._uniforms(0, tiles, float(said["tile"]), count, *numbers, *(0.0,) * 3, *style.values())
            samples = np.asarray(Image.open(folder / height["uri"])).astype(np.float32) / 65535
            heights = self._texture(samples[..., None])
        heights.use(0)
        self._heights = heights

    def _material(self, read, material):
        """Binds a material's colour; returns its cutoff, 0 without."""
        surface = material["pbrMetallicRoughness"]
        color = np.array(surface.get("baseColorFactor", (1, 1, 1, 1)), np.float32).reshape(1, 1, 4)
        if "baseColorTexture" in surface:
            data, _ = read.image(surface["baseColorTexture"]["index"])
            image = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA")).astype(np.float32) / 255
            image[..., :3] **= 2.2
            color = color * image
        self._base = self._texture(color)
        self._base.use(2)
        return material.get("alphaCutoff", 0.0)

    def draw(self, read, node, palette=None, unseen=False):
        """Draws a node. palette: (J, 4, 4) joint matrices, without: the rest pose. unseen: into the depth alone."""
        skin = read.json["skins"][node["skin"]]
        if palette is None:
            inverse = (
                read.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
            )
            world = read.world_matrices()
            palette = np.array([world[joint] for joint in skin["joints"]]) @ inverse
        columns = np.ascontiguousarray(palette.transpose(0, 2, 1), dtype=np.float32)
        bones = self.context.buffer(columns.tobytes())
        bones.bind_to_storage_buffer(0)
        self.target.use()
        self.context.enable(moderngl.DEPTH_TEST)
        self.context.patch_vertices = 3
        self.target.color_mask = (not unseen,) * 4
        for primitive in read.primitives(node):
            given = {name: read.values(number) for name, number in primitive["attributes"].items()}
            material = read.json["materials"][primitive["material"]]
            if material.get("doubleSided"):
                self.context.disable(moderngl.CULL_FACE)
            else:
                self.context.enable(moderngl.CULL_FACE)
            cutoff = self._material(read, material)
            to_sun, sun, sky, ground = self._light
            self._uniforms(3, to_sun, sun, sky, cutoff, ground)
            count = len(given["POSITION"])
            buffers = []
            for name, stored, kind, width in ATTRIBUTES:
                values = given.get(stored, np.zeros((count, width), np.float32))
                values = values.astype(np.uint16 if kind == "4u2" else np.float32)
                buffers.append((self.context.buffer(values.tobytes()), kind, name))
            indices = self.context.buffer(read.array(primitive["indices"]).astype(np.uint32).tobytes())
            shown = self.context.vertex_array(
                self.program, buffers, index_buffer=indices, index_element_size=4
            )
            whole = len(read.array(primitive["indices"]))
            for first in range(0, whole, 3 * PATCHES_A_DRAW):
                with self._counted:
                    shown.render(
                        moderngl.PATCHES, vertices=min(3 * PATCHES_A_DRAW, whole - first), first=first
                    )
                self.primitives += self._counted.primitives
        self.target.color_mask = (True,) * 4

    def draw_edges(self, read, node):
        """The edges of a node's triangles as they are in the file, hidden by earlier draws."""
        for primitive, given in zip(read.primitives(node), read.skinned(node)):
            corners = read.array(primitive["indices"]).reshape(-1, 3)
            edges = np.unique(np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
            points = self.context.buffer(np.ascontiguousarray(given[edges], np.float32).tobytes())
            self.target.use()
            self.context.vertex_array(self._edges, [(points, "3f", "position")]).render(moderngl.LINES)

    def depth(self):
        """(H, W) float32, row 0 at the top: metres along the view's axis to the surface; NaN if there is none."""
        data = np.frombuffer(self.target.depth_attachment.read(), np.float32).reshape(self.size, self.size)[
            ::-1
        ]
        near, far = self._planes
        return np.where(data < 1, near * far / (far - data * (far - near)), np.nan)

    def picture(self):
        """(H, W, 4) uint8, row 0 at the top; sRGB, alpha 255 in drawn pixels."""
        data = np.frombuffer(self.target.read(components=4), np.uint8).reshape(self.size, self.size, 4)[::-1]
        linear = data[..., :3].astype(np.float32) / 255
        shown = np.where(data[..., 3:] > 0, linear ** (1 / 2.2) * 255, data[..., :3])
        return np.concatenate(
            [np.rint(shown).astype(np.uint8), np.where(data[..., 3:] > 0, 255, 0)], axis=2
        ).astype(np.uint8)
