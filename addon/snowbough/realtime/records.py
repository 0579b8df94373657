# SPDX-License-Identifier: GPL-3.0-or-later
"""The input of the real-time renderer as plain data: texts, numbers and numpy arrays. No ``bpy``.

Lengths are in Blender units, colours are linear, angles are in radians. A ``print`` is a fingerprint of all arrays that
are uploaded together: records with equal prints look the same.
"""

from dataclasses import dataclass, field

import numpy as np

from ..scene.inputs import fingerprint
from ..surface.style import SurfaceStyle


@dataclass(frozen=True)
class Paint:
    """A material: a colour, multiplied by an image if there is one."""

    color: tuple
    image: np.ndarray = None
    """(H, W, 4) uint8, sRGB and alpha, row 0 = v 0. Texels with alpha below 0.5 are holes."""

    @property
    def print(self):
        image = np.empty(0, np.uint8) if self.image is None else self.image
        return fingerprint(np.array(self.color, np.float64), image)


@dataclass
class Shape:
    """Triangles in object space."""

    vertices: np.ndarray
    """(N, 3) float32."""
    triangles: np.ndarray
    """(T, 3) int32."""
    normals: np.ndarray
    """(T, 3, 3) float32, one per corner."""
    uv: np.ndarray
    """(T, 3, 2) float32, coordinates in the paint's image."""
    paint: np.ndarray
    """(T,) int32, index into paints."""
    paints: tuple
    """At least one Paint."""
    is_snow: bool = False
    """Whether it is a snow surface."""

    @property
    def print(self):
        arrays = (self.vertices, self.triangles, self.normals, self.uv, self.paint)
        kind = "snow" if self.is_snow else ""
        return "".join([kind, fingerprint(*arrays), *(paint.print for paint in self.paints)])


@dataclass(frozen=True)
class LyingSnow:
    """Snow on a shape that has no snow surface, as a height map from a bake or from the live preview."""

    heights: np.ndarray
    """(H, W) float32, Blender units along the normal, row 0 = v 0."""
    uv: np.ndarray
    """(T, 3, 2) float32, coordinates of the shape's corners in the map."""
    open_depth: float
    """Snow depth on open level ground in this frame, Blender units."""
    last_depth: float
    """The same at the end of the shot."""
    style: SurfaceStyle = SurfaceStyle()
    """Its sliders shape the snow on trees."""

    @property
    def print(self):
        sliders = self.style.sliders().values()
        return fingerprint(self.heights, self.uv, np.array((self.open_depth, self.last_depth, *sliders)))


@dataclass
class Mesh:
    """A shape and all its instances."""

    key: str
    shape: Shape
    print: str
    """The shape's print, stored because computing it takes as long as an upload."""
    matrices: np.ndarray
    """(P, 4, 4) float32, the matrix of each instance."""
    snow: LyingSnow = None


@dataclass
class Leaves:
    """Leaves in the rest pose. Each leaf follows one bone of the tree."""

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
    """The look of bark: colours of furrows and of ridges, and its depth as a share of the limb's radius."""

    dark: tuple = (0.045, 0.03, 0.02)
    light: tuple = (0.24, 0.18, 0.13)
    depth: float = 0.06


@dataclass
class BarkImages:
    """Images on a tree's bark."""

    uv: np.ndarray
    """(Q, 4, 2) float32, coordinates of the corners of the surface's quads."""
    paint: np.ndarray
    """(Q,) int32."""
    paints: tuple

    @property
    def print(self):
        return "".join([fingerprint(self.uv, self.paint), *(paint.print for paint in self.paints)])


@dataclass
class Tree:
    """An imported tree, tessellated from its four-sided base, and all its instances. Trees with equal prints share a
    base on the GPU."""

    key: str
    surface: dict
    """The result of the native tree_arrays."""
    print: str
    """Fingerprint of the surface, the bark and its images."""
    bark: Bark
    pose: np.ndarray
    """(B, 4, 4) float32: for each bone the matrix from its rest pose to the pose, in the space of the bark's object."""
    matrices: np.ndarray
    """(P, 4, 4) float32, the matrix of each instance."""
    leaves: Leaves = None
    leaves_print: str = ""
    bark_images: BarkImages = None
    """Images that the bark shows instead of its two colours."""
    snow: LyingSnow = None
    """Snow on the bark. Its uv are those of the surface's quads: (Q, 4, 2)."""


@dataclass(frozen=True)
class Light:
    """The light of a scene."""

    direction: tuple = (0.0, 0.0, 1.0)
    """Unit vector towards the sun."""
    sun: tuple = (0.0, 0.0, 0.0)
    """Radiance of a white diffuse surface that faces the sun."""
    sky: tuple = (0.05, 0.05, 0.05)
    """Light from above."""
    ground: tuple = (0.05, 0.05, 0.05)
    """Light from below."""
    behind: tuple = (0.05, 0.05, 0.05)
    """Colour of the background."""


@dataclass(frozen=True)
class Flakes:
    """Snow in the air: the fields of the native Snowfall. Metres, seconds, radians."""

    rate: float
    direction: tuple
    speed: float
    flutter: float
    radius: float
    shutter: float
    time: float
    seed: int
    metre: float
    """Blender units per metre."""


@dataclass
class Scene:
    """The content of one frame."""

    meshes: list = field(default_factory=list)
    trees: list = field(default_factory=list)
    light: Light = Light()


@dataclass(frozen=True)
class View:
    """A camera. Matrices in OpenGL's convention, row-major, as nested tuples of floats."""

    view: tuple
    projection: tuple
    width: int
    height: int

    def divided(self, divisor):
        """The same view with width and height divided, rounded up."""
        size = (max(1, -(-self.width // divisor)), max(1, -(-self.height // divisor)))
        return View(self.view, self.projection, *size)

    def part(self, columns, rows):
        """The view of the pixels in two slices. Row 0 is at the bottom."""
        clip = np.array(self.projection, np.float64)
        for axis, span, size in ((0, columns, self.width), (1, rows, self.height)):
            # Clip coordinates from -1 to 1 over the part: x' = stretch * x + shift * w.
            stretch = size / (span.stop - span.start)
            shift = (size - span.start - span.stop) / (span.stop - span.start)
            clip[axis] = stretch * clip[axis] + shift * clip[3]
        projection = tuple(tuple(row) for row in clip.tolist())
        return View(self.view, projection, columns.stop - columns.start, rows.stop - rows.start)
