# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at one moment as plain data: texts, numbers and numpy arrays. No ``bpy``.

SceneReader makes it of Blender's evaluation; simulations and fingerprints are made of it.
"""

from dataclasses import dataclass, field

import numpy as np

from ..names import FARTHEST, receiver_key
from .inputs import fingerprint


class SceneError(ValueError):
    """The scene cannot be baked as it is; names the object, the frame and what to do."""


class TopologyChanged(ValueError):
    """An object's vertices or triangles are others than before, and its snow cannot go on with them."""


@dataclass(frozen=True)
class TopologyAlpha:
    """Where snow falls through a mesh."""

    uv: np.ndarray
    """(T, 3, 2) float32, in the triangle's image."""
    image: np.ndarray
    """(T,) int32 index into images; -1 = opaque."""
    images: tuple
    """material_alpha.AlphaImage."""

    @property
    def print(self):
        """Fingerprint of the images."""
        prints = (np.frombuffer(image.print.encode(), dtype=np.uint8) for image in self.images)
        return fingerprint(*prints)

    def argument(self):
        """What the native add_object takes as ``alpha``."""
        return {
            "uv": self.uv,
            "image": self.image,
            "images": [image.pixels for image in self.images],
            "extensions": [image.extension for image in self.images],
        }


@dataclass(frozen=True)
class ReceiverSpec:
    """A line of the scene's list, without references into the scene."""

    name: str
    library: str
    uv_map: str = ""
    """Empty: the map named ``snow``, else the active one."""
    resolution: int = 0
    enabled: bool = True
    sides: str = "AUTO"
    """Which take snow: AUTO, FRONT or BOTH, as the native add_object takes it."""
    surface: object = None
    """surface.style.SurfaceStyle of the snow surface that its bake ends with; None for none."""
    baked_as: str = ""
    """The name that it was first baked under, which its folder, fingerprints and manifest keep; empty: its name."""

    @property
    def known_as(self):
        return self.baked_as or self.name

    def shown(self, label):
        """A label that begins with known_as, for people, who know it by its name of today."""
        return self.name + label[len(self.known_as) :] if label.startswith(self.known_as) else label


@dataclass(frozen=True)
class Topology:
    """What stays the same while an object moves and deforms."""

    triangles: np.ndarray
    """(T, 3) int32, outside is where they run counter-clockwise."""
    corner_uv: np.ndarray
    """(T, 3, 2) float32; an empty (0, 3, 2) for occluders."""
    vertex_count: int
    print: str
    alpha: TopologyAlpha = None
    """None where all of it is opaque."""
    shading: np.ndarray = None
    """(T, 3) int32: corners of one number share a smooth normal, -1 is flat; None for flat ones and occluders."""

    def is_same(self, other):
        """Whether a mesh with the one topology can go on with the other's positions."""
        return self is other or (
            self.print == other.print
            and self.vertex_count == other.vertex_count
            and self.alpha_prints == other.alpha_prints
        )

    @property
    def alpha_prints(self):
        """Fingerprint of the alpha images, in a tuple; an empty one without any."""
        return (self.alpha.print,) if self.alpha else ()


@dataclass(frozen=True)
class ObjectPose:
    """One object at one moment."""

    key: str
    """Unique and the same on every machine; a receiver's folder name in the cache."""
    label: str
    """For people."""
    name: str
    library: str
    receiver: ReceiverSpec
    """None for occluders."""
    uv_map: str
    """The UV map that is used; empty for occluders."""
    topology: Topology
    """The same object again while nothing changes."""
    positions: np.ndarray
    """(V, 3) float32, metres. The same array again while the object stands still; never written to."""
    prints: tuple
    """Fingerprints of transform, shape, topology and, where there are some, alpha images (scene.inputs)."""
    local: np.ndarray = None
    """(V, 3) float32, Blender units in the object's own space, of an instance in its instancer's. The same array again
    while it does not change; None for occluders."""
    to_world: np.ndarray = None
    """(4, 4) float64 from there to metres in the world."""


@dataclass(frozen=True)
class ScenePose:
    """The scene at one moment."""

    objects: dict
    """key -> ObjectPose, sorted by key."""
    fall_angle: float
    bearing: float
    rate: float
    refused: dict = field(default_factory=dict)
    """Receiver's label -> why it cannot carry snow; it only blocks it."""


def library_path(id_block):
    """The library file that an ID was linked from, as it is written in the .blend; empty for local ones."""
    return id_block.library.filepath if id_block.library else ""


def own_key(name, library):
    """The ObjectPose.key of an object that stands for itself."""
    return receiver_key(name, (library, "", ""))


def member_key(name, library, instancer, instancer_library, order):
    """The ObjectPose.key of what an empty shows of the collection that it instances. order: the instance's
    persistent_id, without what is not set."""
    return receiver_key(f"{instancer}.{name}", (library, instancer_library, *order))


def metres_per_unit(scene):
    """Metres a Blender unit."""
    return scene.unit_settings.scale_length


def outliers(positions):
    """Which of the vertices (V, 3) in metres lie beyond names.FARTHEST or nowhere: (V,) bool, None where none does."""
    inside = (np.abs(positions) <= FARTHEST).all(axis=1)
    return None if inside.all() else ~inside


def world_positions(local, matrix, scale_length):
    """local (V, 3) float32 through matrix (4, 4) float64, in metres, as float32. Element by element: a
    matrix product would leave the order of additions to the linear algebra library."""
    x, y, z = (local[:, axis].astype(np.float64) for axis in range(3))
    world = np.empty_like(local)
    with np.errstate(invalid="ignore", over="ignore"):  # outliers() finds them
        for row in range(3):
            a, b, c, d = matrix[row]
            world[:, row] = (((x * a + y * b) + z * c) + d) * scale_length
    return world
