# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Blender's render evaluation into plain arrays: what snow falls on at one moment.

The hidden render engine calls SceneReader.read after each ``frame_set``. The result has only numpy arrays and texts,
nothing that Blender could free.

- It has all meshes that the render shows, with curves, texts and metaballs as meshes, except objects with
  ``snowbough.occlude`` off and Snowbough's own surfaces.
- A receiver is an object of the scene's list. If that is an empty that instances a collection, every mesh that it
  instances is a receiver. All other instances of one object form one occluder, so a lawn is one object and not ten
  thousand.
- Positions are world positions in metres: Blender units times ``unit_settings.scale_length``, computed with the same
  elementary operations on every machine, so that machines that share a bake agree in every bit.
- Triangles of mirrored objects (negative scale) are reversed, so that the outside stays outside.
- Vertices that are not finite or beyond names.FARTHEST are left out with their triangles, since one of them would
  stretch the grid.
- An enabled receiver that has no surface at a moment (it is hidden or deleted, has no faces, is collapsed, or has scale
  0) is hidden there: it keeps its snow, gets none and blocks none.
- An object that stands still is not read again; its topology is read once, and again when it changes. A receiver keeps
  the UV map of its first pose, and is refused if it loses that map.
- Frame handlers may edit or replace meshes: an object with another mesh, or whose geometry Blender has updated
  (scene.updates), is read again.
- Corners of receivers that share a smooth normal have a common number (mesh_record).
- For materials with alpha from an image, triangles have the image and its UVs (material_alpha).
"""

from dataclasses import dataclass, field

import numpy as np

from ..base.names import FARTHEST, UV_TOLERANCE, receiver_key
from ..settings.pressing import press_of
from .inputs import fingerprint
from .libraries import library_name
from .local_meshes import LocalMeshes
from .masks import MaskImages, vertex_weights
from .mesh_record import join_alphas, join_shadings
from .pose import (
    Mask,
    NotShown,
    ObjectPose,
    ReceiverSpec,
    SceneError,
    ScenePose,
    Topology,
    TopologyAlpha,
    is_flat,
    member_key,
    outliers,
    own_key,
    world_positions,
)
from .updates import SwitchedModifiers

SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@dataclass
class _Known:
    """Data of an object, or of all instances of one, that the reader keeps between poses."""

    topology: Topology = None
    counts: tuple = None
    corners: np.ndarray = None
    local: np.ndarray = None
    shape_print: str = ""
    matrices: np.ndarray = None
    transform_print: str = ""
    positions: np.ndarray = None
    lost: np.ndarray = None
    """pose.outliers of the vertices."""
    left_out: np.ndarray = None
    """The outliers when the topology was made, which lacks their triangles."""
    flips: tuple = ()
    uv_map: str = ""
    layers: list = field(default_factory=list)
    """Fingerprints of a receiver's UV map, one per record."""
    holes: list = field(default_factory=list)
    """MeshRecord.alpha_fingerprint, one per record."""
    in_parent: tuple = None
    """(positions, matrix, positions in the parent's space) of an instance."""
    mask: Mask = None
    mask_uv: np.ndarray = None
    """(T, 3, 2) float32 of a mask's image."""


@dataclass
class _Group:
    """The instances of one object that form one pose, in a fixed order."""

    label: str
    name: str
    library: str
    receiver: ReceiverSpec
    instances: list = field(default_factory=list)
    """(sort key, matrix (4, 4) float64, local positions, MeshRecord, weights of the mask's vertex group or None)"""
    press: dict = None
    occludes: bool = True
    parent: np.ndarray = None
    """(4, 4) float64 of a receiver: the matrix of the object or of its instancer."""

    @property
    def shown(self):
        """The label for the user."""
        return self.receiver.shown(self.label) if self.receiver is not None else self.label

    @property
    def receives(self):
        """Whether it is an enabled receiver."""
        return self.receiver is not None and self.receiver.enabled


def _sunlight(depsgraph, lamp):
    """Direction of the light of a sun lamp, or an object of another type that stands for one; zero without one."""
    if lamp is None:
        return (0.0, 0.0, 0.0)
    shining = lamp.evaluated_get(depsgraph).matrix_world.to_3x3().col[2].normalized()
    return tuple(-float(axis) for axis in shining)


class SceneReader:
    """Reads the poses of one scene, and keeps what does not change between them.

    receivers: list of ReceiverSpec. scale_length: metres of a Blender unit.
    """

    def __init__(self, receivers, scale_length):
        self._receivers = {(spec.name, spec.library): spec for spec in receivers}
        self._names_taken = {(spec.known_as, spec.library) for spec in receivers}
        self._scale = scale_length
        self._known = {}
        self._meshes = LocalMeshes()
        self._switched = SwitchedModifiers()
        self._mask_images = MaskImages()
        # Receivers that cannot carry snow, from their first pose on: label -> reason.
        self._refused = {}
        # Key -> the last ObjectPose of an enabled receiver.
        self._last = {}
        # Objects shown as instances: (name, library) -> [name of the object that scatters them, their number].
        self._scattered = {}

    def read(self, depsgraph, frame):
        """The pose.ScenePose that depsgraph has now. frame: a number for messages.

        A receiver without a mesh or UV map at its first pose is refused: it only blocks snow, and the pose has the
        reason. Raises SceneError for a receiver that loses them later.
        """
        self._scattered = {}
        self._switched.update(depsgraph)
        self._meshes.begin(depsgraph)
        groups = self._gather(depsgraph)
        objects, reasons = {}, {}
        for key in sorted(groups):
            group = groups[key]
            try:
                objects[key] = self._pose_or_refusal(key, group, frame)
            except NotShown as error:
                reasons[group.shown] = str(error)
        self._refuse_scattered(objects)
        hidden = {key: last for key, last in self._last.items() if key not in objects}
        self._last.update((key, obj) for key, obj in objects.items() if obj.receives)
        settings = depsgraph.scene_eval.snowbough
        return ScenePose(
            objects,
            settings.fall_angle,
            settings.bearing,
            settings.rate,
            dict(self._refused),
            hidden,
            reasons,
            _sunlight(depsgraph, settings.sun),
        )

    def _pose_or_refusal(self, key, group, frame):
        """The pose of a group; as an occluder if it is a receiver that cannot carry snow."""
        if group.shown in self._refused:
            group.receiver = None
        if not group.receives or key in self._last:
            return self._pose(key, group, frame)
        try:
            return self._pose(key, group, frame)
        except NotShown:
            self._known.pop(key, None)
            raise
        except SceneError as error:
            self._known.pop(key, None)
            self._refused[group.shown] = str(error)
            group.receiver = None
            return self._pose(key, group, frame)

    def _refuse_scattered(self, objects):
        """Refuses receivers that exist only as instances, with what to do."""
        shown = [*objects.values(), *self._last.values()]
        seen = {(o.receiver.name, o.receiver.library) for o in shown if o.receiver}
        for (name, library), (scatterer, count) in self._scattered.items():
            spec = self._receivers.get((name, library))
            if spec is not None and spec.enabled and (name, library) not in seen:
                self._refused.setdefault(  # the object's own faces may have been refused with a reason
                    name,
                    f"'{name}' exists only as {count} instances that {_scatterer(name, scatterer)}, which would all "
                    "share one map: end its geometry nodes with Realize Instances, apply them (Object > Apply > Visual "
                    "Geometry to Mesh) and add snow again (instances on faces or vertices: Object > Apply > Make "
                    "Instances Real)",
                )

    def _gather(self, depsgraph):
        """key -> _Group of all objects that the render shows."""
        groups, drifts = {}, depsgraph.scene.snowbough.drift > 0.0
        for instance in depsgraph.object_instances:
            obj = instance.object
            if obj.type not in SURFACE_TYPES:
                continue
            if not (instance.is_instance or instance.show_self):
                continue
            original = obj.original
            press = press_of(original.snowbough, drifts)
            if original.snowbough.is_shell or not (original.snowbough.occlude or press):
                continue
            group, order = self._group_of(instance, obj, original, groups)
            if group is None:
                continue
            group.press, group.occludes = press, original.snowbough.occlude
            matrix = np.array(instance.matrix_world, dtype=np.float64)
            local, mesh = self._meshes.read(obj, group.receiver is not None)
            if local is None:
                continue
            if group.receiver is not None:
                parent = instance.parent if instance.is_instance else obj
                group.parent = np.array(parent.matrix_world, dtype=np.float64)
            group.instances.append((order, matrix, local, mesh, _weights(group, obj, mesh)))
        return groups

    def _group_of(self, instance, obj, original, groups):
        name, library = original.name, library_name(original)
        if not instance.is_instance:
            receiver = self._receivers.get((name, library))
            if receiver is not None:
                name = receiver.known_as
            elif (name, library) in self._names_taken:  # the former name of a renamed receiver
                return _join(
                    groups, receiver_key(name, (library, "", "", "renamed")), name, name, library, None
                ), ()
            return _join(groups, own_key(name, library), name, name, library, receiver), ()
        parent = instance.parent.original if instance.parent else None
        if parent is not None and (parent.snowbough.is_shell or not parent.snowbough.occlude):
            return None, None
        parent_name = parent.name if parent else ""
        parent_library = library_name(parent) if parent else ""
        order = tuple(index for index in instance.persistent_id if index != 0x7FFFFFFF)
        receiver = self._receivers.get((parent_name, parent_library))
        if receiver is not None and parent.instance_type == "COLLECTION":
            parent_name = receiver.known_as
            key = member_key(name, library, parent_name, parent_library, order)
            return _join(groups, key, f"{parent_name} / {name}", name, library, receiver), order
        for shown in ((name, library), (parent_name, parent_library)):
            self._scattered.setdefault(shown, [parent_name, 0])[1] += 1
        key = receiver_key(f"{name}.instances", (library, parent_name, parent_library))
        return _join(groups, key, f"{parent_name} / {name}", name, library, None), order

    def _pose(self, key, group, frame):
        known = self._known.setdefault(key, _Known())
        group.instances.sort(key=lambda item: item[0])
        records = [item[3] for item in group.instances]
        if not records:
            if group.receives:
                raise NotShown(f"'{group.shown}' has no faces, so it cannot carry snow")
            return _empty_pose(key, group)
        matrices = np.stack([item[1] for item in group.instances])
        if group.receives and (is_flat(group.parent) or all(map(is_flat, matrices))):
            raise NotShown(f"'{group.shown}' has scale 0 along an axis: apply the scale (Ctrl+A)")
        flips = tuple(bool(np.linalg.det(matrix[:3, :3]) < 0) for matrix in matrices)

        locals_ = [item[2] for item in group.instances]
        moved = known.matrices is None or not np.array_equal(known.matrices, matrices)
        deformed = known.local is None or not _same_arrays(known.local, locals_)
        if deformed:
            known.local = locals_
            known.shape_print = fingerprint(*_each_once(locals_))
        if moved:
            known.matrices = matrices
            known.transform_print = fingerprint(matrices, np.float64(self._scale))
        if moved or deformed:
            parts = [world_positions(local, m, self._scale) for local, m in zip(locals_, matrices)]
            known.positions = np.concatenate(parts) if len(parts) > 1 else parts[0]
            known.lost = outliers(known.positions)
            if known.lost is not None and not known.lost.all():
                known.positions[known.lost] = known.positions[~known.lost][0]
            known.positions.flags.writeable = False
        if known.lost is not None and known.lost.all():
            if group.receives:
                raise SceneError(f"'{group.shown}' is beyond {FARTHEST:g} m at frame {frame}: move it closer")
            return _empty_pose(key, group)
        if group.receives and not np.ptp(known.positions, axis=0).any():
            raise NotShown(f"All vertices of '{group.shown}' are in one place")
        self._update_topology(known, group, records, flips, frame)
        prints = (
            known.transform_print, known.shape_print, known.topology.print, *known.topology.alpha_prints
        )  # fmt: skip
        mask = self._mask(known, group, frame)
        press = (
            "" if group.press is None else fingerprint(np.frombuffer(repr(group.press).encode(), np.uint8))
        )
        if mask is not None or press:
            prints = (*prints, *[""] * (4 - len(prints)), mask.print if mask is not None else "", press)
        local, to_world = self._in_parent(known, group) if group.receiver is not None else (None, None)
        return ObjectPose(key, group.label, group.name, group.library, group.receiver, known.uv_map,
                          known.topology, known.positions, prints, local, to_world, group.occludes, group.press,
                          mask)  # fmt: skip

    def _mask(self, known, group, frame):
        """The Mask of a receiver at this pose, or None."""
        if not group.receives or group.receiver.mask is None:
            return None
        if group.receiver.mask.kind == "GROUP":
            read = [item[4] for item in group.instances]
            for error in read:
                if isinstance(error, SceneError):
                    raise error
            weights = np.concatenate(read)
            values, uv = weights[known.topology.triangles], None
        else:
            values = self._mask_images.values(group.receiver.mask, group.shown, frame)
            uv = known.mask_uv
        printed = fingerprint(values) if uv is None else fingerprint(values, uv)
        if known.mask is None or known.mask.print != printed:
            known.mask = Mask(values, uv, printed)
        return known.mask

    def _in_parent(self, known, group):
        """(positions in the space of the receiver or its instancer, the matrix from there to metres in the world)."""
        to_world = group.parent * self._scale
        to_world[3, 3] = 1.0
        if known.lost is None and len(known.local) == 1 and np.array_equal(group.parent, known.matrices[0]):
            return known.local[0], to_world
        if not np.linalg.det(to_world[:3, :3]):
            return known.positions, np.eye(4)
        if (
            known.in_parent is None
            or known.in_parent[0] is not known.positions
            or not np.array_equal(known.in_parent[1], to_world)
        ):
            inverse = np.linalg.inv(to_world)
            local = (known.positions @ inverse[:3, :3].T + inverse[:3, 3]).astype(np.float32)
            known.in_parent = (known.positions, to_world, local)
        return known.in_parent[2], to_world

    def _update_topology(self, known, group, records, flips, frame):
        counts = tuple(record.counts for record in records)
        same_parts = known.counts == counts and known.flips == flips
        if known.topology is not None and same_parts and np.array_equal(known.left_out, known.lost):
            if not any(record.is_another for record in records):
                if not any(record.may_change for record in records):
                    return
                if self._has_same_faces(known, group, records, frame):
                    return
        receiver = group.receiver is not None
        triangles, uvs, alphas, shadings, mask_uvs, offset = [], [], [], [], [], 0
        known.layers, known.holes = [], [record.alpha_fingerprint for record in records]
        for record, flip in zip(records, flips):
            corner_triangles = record.triangle_corners()
            if flip:
                corner_triangles = corner_triangles[:, ::-1]
            triangles.append(record.corners()[corner_triangles] + np.int32(offset))
            if receiver:
                known.uv_map, uv = record.uv(group.receiver.uv_map, known.uv_map, group.shown, frame)
                mask_uv = _mask_layer(record, group, uv)
                known.layers.append(_layers_print(uv, mask_uv))
                uvs.append(uv[corner_triangles])
                if mask_uv is not None:
                    mask_uvs.append(mask_uv[corner_triangles])
                shadings.append(record.shading(corner_triangles))
            alphas.append(record.alpha(corner_triangles))
            offset += record.counts[0]
        triangles = np.ascontiguousarray(np.concatenate(triangles), dtype=np.int32)
        uv = np.ascontiguousarray(np.concatenate(uvs)) if receiver else np.empty((0, 3, 2), dtype=np.float32)
        if receiver and group.receiver.enabled and known.topology is not None and not _fits_map(uv):
            raise SceneError(
                f"The faces of '{group.shown}' change at frame {frame}, and do not lie on its UV map "
                f"'{known.uv_map}' from 0 to 1: apply the modifier that makes them, or remove "
                f"'{group.shown}' from the list of receivers"
            )
        known.counts, known.flips, known.left_out = counts, flips, known.lost
        known.corners = [record.corners() for record in records]
        known.mask_uv = np.ascontiguousarray(np.concatenate(mask_uvs)) if mask_uvs else None
        alpha = join_alphas(alphas)
        shading = join_shadings(shadings, [record.counts[1] for record in records])
        if known.lost is not None:
            keep = ~known.lost[triangles].any(axis=1)
            triangles, uv = triangles[keep], uv[keep] if receiver else uv
            shading = None if shading is None else shading[keep]
            known.mask_uv = None if known.mask_uv is None else known.mask_uv[keep]
            alpha = TopologyAlpha(alpha.uv[keep], alpha.image[keep], alpha.images) if alpha else None
        parts = [] if shading is None else [shading]
        parts += [alpha.uv, alpha.image] if alpha else []
        made = Topology(triangles, uv, offset, fingerprint(triangles, uv, *parts), alpha, shading)
        if known.topology is None or not known.topology.is_same(made):
            known.topology = made

    @staticmethod
    def _has_same_faces(known, group, records, frame):
        """Whether all meshes have the same corners and holes as before, and edited ones of a receiver the same UVs."""
        if not _same_arrays(known.corners, [record.corners() for record in records]):
            return False
        if known.holes != [record.alpha_fingerprint for record in records]:
            return False
        if group.receiver is None:
            return True
        arguments = (group.receiver.uv_map, known.uv_map, group.shown, frame)

        def has_layers(record, layers):
            uv = record.uv(*arguments)[1]
            return _layers_print(uv, _mask_layer(record, group, uv)) == layers

        return all(
            not record.is_edited or has_layers(record, layers)
            for record, layers in zip(records, known.layers)
        )


def _weights(group, obj, record):
    """The weights of the vertex group that masks a receiver; None without, a SceneError if they cannot be read."""
    mask = group.receiver.mask if group.receives else None
    if mask is None or mask.kind != "GROUP":
        return None
    try:
        return vertex_weights(obj, mask, group.shown, record.counts[0])
    except SceneError as error:  # raised where the receiver can be refused
        return error


def _mask_layer(record, group, snow_uv):
    """(L, 2) of the UV map of the image that masks a receiver, or None."""
    mask = group.receiver.mask if group.receives else None
    if mask is None or mask.kind != "IMAGE":
        return None
    return record.layer(mask.uv_map, group.shown) if mask.uv_map else snow_uv


def _layers_print(uv, mask_uv):
    return fingerprint(uv) if mask_uv is None or mask_uv is uv else fingerprint(uv, mask_uv)


def _join(groups, key, label, name, library, receiver):
    """The _Group of that key; made if needed."""
    group = groups.setdefault(key, _Group(label, name, library, receiver))
    if (group.label, group.library) != (label, library):
        raise SceneError(
            f"'{group.label}' and '{label}' would share a folder in the cache: rename one of them"
        )
    return group


def _scatterer(name, scatterer):
    return "it scatters itself" if name == scatterer else f"'{scatterer}' scatters"


def _fits_map(uv):
    """Whether all triangles (T, 3, 2) lie on the map and at least one has an area."""
    edge, other = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    has_area = np.abs(edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]) > 1e-12
    return bool(has_area.any() and (uv >= -UV_TOLERANCE).all() and (uv <= 1.0 + UV_TOLERANCE).all())


def _empty_pose(key, group):
    topology = Topology(np.empty((0, 3), np.int32), np.empty((0, 3, 2), np.float32), 0, "")
    positions = np.empty((0, 3), np.float32)
    return ObjectPose(
        key, group.label, group.name, group.library, None, "", topology, positions, ("", "", "")
    )


def _same_arrays(before, after):
    return (
        before is not None
        and len(before) == len(after)
        and all(a is b or np.array_equal(a, b) for a, b in zip(before, after))
    )


def _each_once(arrays):
    """The arrays without repetitions of the same object, in order."""
    seen, once = set(), []
    for array in arrays:
        if id(array) not in seen:
            seen.add(id(array))
            once.append(array)
    return once
