# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at one moment as plain data: texts, numbers and numpy arrays. No ``bpy``.

Made by SceneReader from Blender's evaluation; the input of simulations and fingerprints.
"""

from dataclasses import dataclass, field

import numpy as np

from ..base.names import FARTHEST, receiver_key
from .inputs import fingerprint


class SceneError(ValueError):
    """The scene cannot be baked as it is; the message names the object, the frame and what to do."""


class NotShown(SceneError):
    """A receiver has no surface at this moment; the message says why and what to do."""


class TopologyChanged(ValueError):
    """An object's vertices or triangles have changed, and its snow cannot follow."""


@dataclass(frozen=True)
class TopologyAlpha:
    """Where snow falls through a mesh."""

    uv: np.ndarray
    """(T, 3, 2) float32, in the image of the triangle."""
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
        """The argument ``alpha`` of the native add_object."""
        return {
            "uv": self.uv,
            "image": self.image,
            "images": [image.pixels for image in self.images],
            "extensions": [image.extension for image in self.images],
        }


@dataclass(frozen=True)
class MaskSpec:
    """Where a receiver's mask comes from."""

    kind: str
    """GROUP or IMAGE."""
    name: str
    """Of the vertex group or of the image; empty if none is chosen."""
    library: str
    """Of the image."""
    uv_map: str
    """Of the image; empty for the UV map of the snow."""
    inverted: bool

    @property
    def text(self):
        """For messages and manifests."""
        what = "vertex group" if self.kind == "GROUP" else "image"
        place = f" on '{self.uv_map}'" if self.uv_map else ""
        return f"{what} '{self.name}'{place}{', inverted' if self.inverted else ''}"


@dataclass(frozen=True)
class Mask:
    """How much of the snow a receiver takes at one moment, 0 to 1."""

    values: np.ndarray
    """(T, 3) float32 of the triangles' corners; or with uv an image (H, W), row 0 = v 0."""
    uv: np.ndarray
    """(T, 3, 2) float32 in the image, or None."""
    print: str


@dataclass(frozen=True)
class ReceiverSpec:
    """An entry of the scene's list, without references into the scene."""

    name: str
    library: str
    uv_map: str = ""
    """Empty for the map named ``snow``, or else the active one."""
    resolution: int = 0
    enabled: bool = True
    sides: str = "AUTO"
    """Sides that receive snow: AUTO, POSITIVE or BOTH, as in the native add_object."""
    surface: object = None
    """surface.style.SurfaceStyle of the snow surface at the end of its bake; None for no surface."""
    members: tuple = ()
    """(name, library) of the objects that an instancer may show on some frame."""
    mask: MaskSpec = None
    """None: it takes all snow."""
    shed_half_life: float = 0.0
    """Seconds in which half of its snow lets go; 0: it stays."""
    baked_as: str = ""
    """Its name at its first bake, which its folder, fingerprints and manifest keep; empty for its current name."""

    @property
    def known_as(self):
        return self.baked_as or self.name

    def shown(self, label):
        """A label that begins with known_as, with the current name instead, for the user."""
        return self.name + label[len(self.known_as) :] if label.startswith(self.known_as) else label


@dataclass(frozen=True)
class Topology:
    """The part of an object that stays the same while it moves and deforms."""

    triangles: np.ndarray
    """(T, 3) int32, counter-clockwise seen from outside."""
    corner_uv: np.ndarray
    """(T, 3, 2) float32; an empty (0, 3, 2) for occluders."""
    vertex_count: int
    print: str
    alpha: TopologyAlpha = None
    """None if it is opaque."""
    shading: np.ndarray = None
    """(T, 3) int32: corners with one number share a smooth normal, -1 is flat. None for flat objects and occluders."""

    def is_same(self, other):
        """Whether a mesh with one topology can take positions of the other."""
        return self is other or (
            self.print == other.print
            and self.vertex_count == other.vertex_count
            and self.alpha_prints == other.alpha_prints
        )

    @property
    def alpha_prints(self):
        """The fingerprint of the alpha images in a tuple, which is empty without any."""
        return (self.alpha.print,) if self.alpha else ()


@dataclass(frozen=True)
class ObjectPose:
    """One object at one moment."""

    key: str
    """Unique and the same on every machine; a receiver's folder name in the cache."""
    label: str
    """For the user."""
    name: str
    library: str
    receiver: ReceiverSpec
    """None for occluders."""
    uv_map: str
    """Name of the UV map in use; empty for occluders."""
    topology: Topology
    """Stays the same Python object while nothing changes."""
    positions: np.ndarray
    """(V, 3) float32, metres. The same array while the object stands still; never written to."""
    prints: tuple
    """Fingerprints of transform, shape, topology and, if there are any, alpha images, mask and effect on snow
    (scene.inputs)."""
    local: np.ndarray = None
    """(V, 3) float32, Blender units in the space of the object, or of the instancer of an instance. The same array
    while it does not change; None for occluders."""
    to_world: np.ndarray = None
    """(4, 4) float64 from there to metres in the world."""
    occludes: bool = True
    press: dict = None
    """Arguments of the native set_presser; None if it does nothing to snow."""
    mask: Mask = None
    """The same object while it does not change; None: it takes all snow."""

    @property
    def receives(self):
        """Whether it is an enabled receiver."""
        return self.receiver is not None and self.receiver.enabled


@dataclass(frozen=True)
class ScenePose:
    """The scene at one moment."""

    objects: dict
    """key -> ObjectPose, sorted by key."""
    fall_angle: float
    bearing: float
    rate: float
    refused: dict = field(default_factory=dict)
    """Receiver's label -> reason why it cannot carry snow; it only blocks snow."""
    hidden: dict = field(default_factory=dict)
    """key -> ObjectPose of enabled receivers that are not shown now, at another moment. They keep their snow, get none
    and block none."""
    reasons: dict = field(default_factory=dict)
    """Receiver's label -> reason why it is not shown, if it is in the scene."""
    sun: tuple = (0.0, 0.0, 0.0)
    """Direction of the light of the sun that thaws snow; zero without one."""

    @property
    def weather(self):
        """Direction of the wind, and of the sun if there is one: numbers that the snow depends on."""
        return (self.fall_angle, self.bearing, *(self.sun if any(self.sun) else ()))

    @property
    def known(self):
        """key -> ObjectPose of all objects, hidden ones included, sorted by key."""
        return dict(sorted({**self.hidden, **self.objects}.items()))

    def known_at(self, key):
        """The ObjectPose of a key in `known`."""
        return self.objects.get(key) or self.hidden[key]


def own_key(name, library):
    """The ObjectPose.key of an object that is no instance."""
    return receiver_key(name, (library, "", ""))


def member_key(name, library, instancer, instancer_library, order):
    """The ObjectPose.key of an object of a collection that an empty instances. order: the instance's persistent_id,
    without unused entries."""
    return receiver_key(f"{instancer}.{name}", (library, instancer_library, *order))


def metres_per_unit(scene):
    """Metres of a Blender unit."""
    return scene.unit_settings.scale_length


def is_flat(matrix):
    """Whether a matrix (4, 4) scales an axis to 0, or nearly: a millionth of the largest."""
    scales = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(scales[2] <= 1e-6 * scales[0])


def outliers(positions):
    """(V,) bool: the vertices (V, 3) in metres that lie beyond names.FARTHEST or are not finite; None if there are
    none."""
    inside = (np.abs(positions) <= FARTHEST).all(axis=1)
    return None if inside.all() else ~inside


def world_positions(local, matrix, scale_length):
    """local (V, 3) float32 through matrix (4, 4) float64, in metres, as float32. Computed element by element: the order
    of additions in a matrix product depends on the linear algebra library."""
    x, y, z = (local[:, axis].astype(np.float64) for axis in range(3))
    world = np.empty_like(local)
    with np.errstate(invalid="ignore", over="ignore"):  # outliers() finds them
        for row in range(3):
            a, b, c, d = matrix[row]
            world[:, row] = (((x * a + y * b) + z * c) + d) * scale_length
    return world
