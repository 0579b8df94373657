# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends a tree under the snow of the shot: a small simulation on the tree at rest, the load of its bones, keyframes.

One round suffices: bent limbs hold nearly the same snow as straight ones.
"""

from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..base import compat, native
from ..base.names import LEAF_BONE_ATTRIBUTE, counted
from ..preview.playback import PreviewSettings
from ..result.displacement import Muted
from ..scene import receivers
from ..scene.libraries import library_name
from ..scene.pose import metres_per_unit
from ..scene.reader import SceneReader
from ..tree import sway, wind
from . import keys, load
from .cantilevers import Cantilevers, turned
from .small_bake import bake_heights

# Largest difference of an armature's axes in length, and of their angles from right ones.
EVEN = 1e-3


@dataclass(frozen=True)
class Report:
    """A bend. weight: kg; sag: largest, in metres; broken: names of the bones that would break, the thickest first."""

    weight: float
    sag: float
    broken: tuple

    def text(self):
        text = f"{self.weight:.4g} kg of snow; largest sag {self.sag:.3g} m"
        if self.broken:
            bones = counted(len(self.broken), "bone")
            text += f". {bones} would break, the thickest is {self.broken[0]}: lower Weight or raise Strength"
        return text


@dataclass
class _Snow:
    """What fell on the tree at rest."""

    meshes: list
    """load.SnowyMesh of the receivers."""
    foliage: list
    """(triangles, positions) of leaves."""
    to_world: np.ndarray
    """(4, 4) of the armature."""
    frame_start: int
    totals: tuple
    """Depth in metres after each frame."""


def snowy_meshes(scene, rig):
    """The enabled receivers of the scene that the armature deforms."""
    return [
        entry.object
        for entry in scene.snowbough.receivers
        if entry.enabled and entry.object is not None and sway.rig_of(entry.object) == rig
    ]


@contextmanager
def _at_rest(scene, rig):
    """The last frame of the shot with the tree at rest and without baked snow; restores the scene."""
    frame, subframe, pose = scene.frame_current, scene.frame_subframe, rig.data.pose_position
    try:
        rig.data.pose_position = "REST"
        with Muted(scene, "show_viewport"):
            scene.frame_set(scene.snowbough.frame_end)
            yield
    finally:
        rig.data.pose_position = pose
        scene.frame_set(frame, subframe=subframe)


def _vertex_bones(obj, mesh, number):
    """(int (V, K), float (V, K)): the bones of the vertices of an evaluated mesh and their weights. number: {name of a
    bone: its index}."""
    entries = [[(entry.group, entry.weight) for entry in vertex.groups] for vertex in mesh.vertices]
    width = max(map(len, entries), default=0) or 1
    padded = np.array([own + [(0, 0.0)] * (width - len(own)) for own in entries]).reshape(-1, width, 2)
    groups, weights = padded[:, :, 0].astype(int), np.maximum(padded[:, :, 1], 0.0)
    bone_of = np.full(max(len(obj.vertex_groups), groups.max(initial=0) + 1), -1)
    for group in obj.vertex_groups:
        bone_of[group.index] = number.get(group.name, -1)
    bones = bone_of[groups]
    weights[bones < 0] = 0.0
    if not weights.any():
        raise ValueError(f"'{obj.name}' has no weights for the bones of its armature: assign them (Ctrl+P)")
    weights /= np.maximum(weights.sum(axis=1, keepdims=True), 1e-12)
    return np.maximum(bones, 0), weights


def _leaves(obj, topology):
    """The triangles of an object that are leaves: all of an imported tree's leaves, or those with holes."""
    if LEAF_BONE_ATTRIBUTE in obj.data.attributes:
        return topology.triangles
    return topology.triangles[topology.alpha.image >= 0] if topology.alpha else topology.triangles[:0]


def _let_it_snow(context, rig):
    """The _Snow of the whole shot on the tree."""
    scene, scale = context.scene, metres_per_unit(context.scene)
    tree = {
        (obj.name, library_name(obj)): obj
        for obj in scene.objects
        if obj.type == "MESH" and sway.rig_of(obj) == rig
    }
    receiving = {(obj.name, library_name(obj)) for obj in snowy_meshes(scene, rig)}
    specs = [spec for spec in receivers.receiver_specs(scene) if (spec.name, spec.library) in receiving]
    number = {bone.name: index for index, bone in enumerate(rig.data.bones)}
    falling = PreviewSettings.from_scene(scene)
    with _at_rest(scene, rig):
        depsgraph = context.evaluated_depsgraph_get()
        pose = SceneReader(specs, scale).read(depsgraph, scene.frame_current)
        refused = [*pose.refused.values(), *pose.reasons.values()]
        snowy = [key for key, obj in pose.objects.items() if obj.receives]
        if not snowy:
            raise ValueError(
                refused[0] if refused else f"The meshes of the tree '{rig.name}' are hidden: show them"
            )
        to_world = np.array(rig.evaluated_get(depsgraph).matrix_world, dtype=float)
        bones = {
            key: _vertex_bones(obj, obj.evaluated_get(depsgraph).data, number)
            for key, obj in ((key, tree[pose.objects[key].name, pose.objects[key].library]) for key in snowy)
        }
    totals = falling.snowfall.totals
    heights = bake_heights(
        native.load(), pose, snowy, falling.snow, falling.texel_size, totals[-1], len(totals) / falling.fps
    )
    meshes, foliage = [], []
    for key in snowy:
        obj, topology = pose.objects[key], pose.objects[key].topology
        table = native.load().texel_table(topology.triangles, topology.corner_uv, len(heights[key]))
        meshes.append(load.SnowyMesh(heights[key], table, topology.triangles, obj.positions, *bones[key]))
    for obj in pose.objects.values():
        if (obj.name, obj.library) in tree:
            foliage.append((_leaves(tree[obj.name, obj.library], obj.topology), obj.positions))
    return _Snow(meshes, foliage, to_world, scene.snowbough.frame_start, totals)


def _check(scene, rig):
    if not len(rig.data.bones):
        raise ValueError(f"The armature '{rig.name}' has no bones")
    if rig.library or rig.data.library and not rig.override_library:
        raise ValueError(f"'{rig.name}' is linked: make a library override to bend it")
    if not snowy_meshes(scene, rig):
        raise ValueError(
            f"No mesh of the tree '{rig.name}' receives snow: select its meshes and add snow to them"
        )
    keys.check(rig)


def bend_under_snow(context, rig):
    """Bends a tree by the settings `rig.snowbough.bending` and returns its Report. Replaces an earlier bend.

    Raises ValueError, saying what to do, and the errors of reading the scene.
    """
    scene, settings = context.scene, rig.snowbough.bending
    _check(scene, rig)
    snow = _let_it_snow(context, rig)

    matrix = snow.to_world[:3, :3]
    size = np.cbrt(abs(np.linalg.det(matrix)))
    turn = matrix / max(size, 1e-12)
    if np.abs(turn.T @ turn - np.eye(3)).max() > EVEN:
        raise ValueError(f"The armature '{rig.name}' is stretched: apply its scale (Ctrl+A)")
    metres = size * metres_per_unit(scene)
    parents, connected, heads, tails, radii, axes = sway.bone_arrays(rig.data)
    tail_radii = np.empty(len(radii), np.float32)
    rig.data.bones.foreach_get("tail_radius", tail_radii)
    lengths = np.linalg.norm(tails - heads, axis=1) * metres
    limbs = wind.find_chains(parents, connected, lengths, radii).limb
    thick = load.plausible_radii(radii * metres, tail_radii * metres, lengths, limbs)
    chain = Cantilevers(heads * metres, tails * metres, parents, *thick, limbs)

    volumes, centres = load.held_snow(snow.meshes, len(parents))
    held = volumes.sum()
    if held <= 0.0:
        raise ValueError(f"No snow lies on the tree '{rig.name}' at the end of the shot: raise End Depth")
    weight = settings.weight
    if weight <= 0.0:
        area, density = load.crown_area(snow.foliage), settings.snow_density
        weight = load.intercepted(area, snow.totals[-1], density) if area else held * density
    # From metres in the world to metres in the armature's own axes.
    origin = snow.to_world[:3, 3] * metres_per_unit(scene)
    places = np.where(volumes[:, None] > 0.0, turned(turn.T, centres - origin), chain.heads)
    down = turned(turn.T, np.array((0.0, 0.0, -1.0)))

    frames, shares = zip(*load.load_keys(snow.frame_start, snow.totals))
    modulus, strength = settings.wood()
    bent = chain.bend(volumes * (weight / held), places, down, modulus, strength, shares)
    columns = np.swapaxes(axes, 1, 2)
    angles = np.stack([keys.euler_angles(chain.local_rotations(own, columns)) for own in bent.vectors])
    sag = ((chain.bent_tails(bent.vectors[-1]) - chain.tails) @ down).max()
    broken = sorted(np.nonzero(bent.stress > 1.0)[0].tolist(), key=lambda bone: -radii[bone])
    report = Report(weight, max(0.0, float(sag)), tuple(rig.data.bones[bone].name for bone in broken))
    stretched = np.array(frames) * compat.frame_length(scene)
    keys.write(rig, stretched, np.unwrap(angles, axis=0), report.text())
    return report
