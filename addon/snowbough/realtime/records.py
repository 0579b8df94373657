# SPDX-License-Identifier: GPL-3.0-or-later
"""What the real-time renderer draws, as plain data: texts, numbers and numpy arrays. No ``bpy``.

Lengths are Blender's units, colours linear, angles radians. A ``print`` is a fingerprint of all arrays that are
uploaded together: records of equal prints look the same.
"""

from dataclasses import dataclass, field

import numpy as np

from ..scene.inputs import fingerprint


@dataclass(frozen=True)
class Paint:
    """A material: a colour, times an image if it has one."""

    color: tuple
    image: np.ndarray = None
    """(H, W, 4) uint8, sRGB and alpha, row 0 = v 0; holes where alpha is below a half."""

    @property
    def has_holes(self):
        return self.image is not None and bool((self.image[..., 3] < 128).any())

    @property
    def print(self):
        image = np.empty(0, np.uint8) if self.image is None else self.image
        return fingerprint(np.array(self.color, np.float64), image)


@dataclass
class Shape:
    """Triangles as they are drawn, in a space of their own."""

    vertices: np.ndarray
    """(N, 3) float32."""
    triangles: np.ndarray
    """(T, 3) int32."""
    normals: np.ndarray
    """(T, 3, 3) float32, one a corner."""
    uv: np.ndarray
    """(T, 3, 2) float32, in the paint's image."""
    paint: np.ndarray
    """(T,) int32, index into paints."""
    paints: tuple
    """At least one Paint."""
    is_snow: bool = False
    """Whether it is the surface of snow."""

    @property
    def print(self):
        arrays = (self.vertices, self.triangles, self.normals, self.uv, self.paint)
        kind = "snow" if self.is_snow else ""
        return "".join([kind, fingerprint(*arrays), *(paint.print for paint in self.paints)])


@dataclass(frozen=True)
class LyingSnow:
    """Snow of a bake or of the live simulation on a shape, by its map: what has no surface of its own."""

    heights: np.ndarray
    """(H, W) float32, Blender's units along the normal, row 0 = v 0."""
    uv: np.ndarray
    """(T, 3, 2) float32 of the shape's corners."""
    open_depth: float
    """Snow on open level ground in this frame, Blender's units."""
    last_depth: float
    """The same at the shot's end."""

    @property
    def print(self):
        depths = np.array((self.open_depth, self.last_depth))
        return fingerprint(self.heights, self.uv, depths)


@dataclass
class Mesh:
    """A shape in all of its places."""

    key: str
    shape: Shape
    print: str
    """The shape's; kept, because working it out takes as long as uploading."""
    places: np.ndarray
    """(P, 4, 4) float32."""
    snow: LyingSnow = None


@dataclass
class Leaves:
    """Leaves that hang on a tree's bones, in the rest pose."""

    triangles: np.ndarray
    """(T, 3, 3) float32."""
    bones: np.ndarray
    """(T,) int32."""
    uv: np.ndarray
    """(T, 3, 2) float32."""
    paint: np.ndarray
    """(T,) int32."""
    paints: tuple

    @property
    def print(self):
        arrays = (self.triangles, self.bones, self.uv, self.paint)
        return "".join([fingerprint(*arrays), *(paint.print for paint in self.paints)])


@dataclass(frozen=True)
class Bark:
    """How bark looks: colours of furrows and ridges, and how deep it is as a share of the limb's radius."""

    dark: tuple = (0.045, 0.03, 0.02)
    light: tuple = (0.24, 0.18, 0.13)
    depth: float = 0.06


@dataclass
class Coat:
    """Images on a tree's bark."""

    uv: np.ndarray
    """(Q, 4, 2) float32 of the corners of the surface's quads."""
    paint: np.ndarray
    """(Q,) int32."""
    paints: tuple

    @property
    def print(self):
        return "".join([fingerprint(self.uv, self.paint), *(paint.print for paint in self.paints)])


@dataclass
class Tree:
    """An imported tree, drawn from its four-sided base."""

    key: str
    surface: dict
    """What the native tree_arrays gave."""
    print: str
    """Of the surface, the bark and its coat."""
    bark: Bark
    pose: np.ndarray
    """(B, 4, 4) float32: for each bone what takes its rest pose to the world."""
    leaves: Leaves = None
    leaves_print: str = ""
    coat: Coat = None
    """What the bark shows in place of its two colours."""
    snow: LyingSnow = None
    """On the bark, its uv those of the surface's quads: (Q, 4, 2)."""


@dataclass(frozen=True)
class Light:
    """What lights the scene."""

    direction: tuple = (0.0, 0.0, 1.0)
    """Towards the sun."""
    sun: tuple = (0.0, 0.0, 0.0)
    """Light that a white surface sends back that faces it."""
    sky: tuple = (0.05, 0.05, 0.05)
    """From above."""
    ground: tuple = (0.05, 0.05, 0.05)
    """From below."""
    behind: tuple = (0.05, 0.05, 0.05)
    """Behind everything."""


@dataclass(frozen=True)
class Flakes:
    """Snow in the air, as the native Snowfall has it. Metres, seconds, radians."""

    rate: float
    direction: tuple
    speed: float
    flutter: float
    radius: float
    shutter: float
    time: float
    seed: int
    metre: float
    """Blender's units a metre."""


@dataclass
class Scene:
    """A moment."""

    meshes: list = field(default_factory=list)
    trees: list = field(default_factory=list)
    light: Light = Light()


@dataclass(frozen=True)
class View:
    """What is looked through. Matrices as OpenGL's, rows first, nested tuples of floats."""

    view: tuple
    projection: tuple
    width: int
    height: int

    def divided(self, divisor):
        """The same picture in fewer pixels."""
        size = (max(1, -(-self.width // divisor)), max(1, -(-self.height // divisor)))
        return View(self.view, self.projection, *size)

    def part(self, columns, rows):
        """The pixels of two slices as a picture of its own, row 0 at the bottom."""
        clip = np.array(self.projection, np.float64)
        for axis, span, size in ((0, columns, self.width), (1, rows, self.height)):
            # From -1 to 1 over the part: x' = stretch * x + shift, of x / w.
            stretch = size / (span.stop - span.start)
            shift = (size - span.start - span.stop) / (span.stop - span.start)
            clip[axis] = stretch * clip[axis] + shift * clip[3]
        projection = tuple(tuple(row) for row in clip.tolist())
        return View(self.view, projection, columns.stop - columns.start, rows.stop - rows.start)
