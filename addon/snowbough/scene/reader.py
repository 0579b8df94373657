# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's render evaluation to plain arrays: what snow falls on at one moment.

SceneReader.read is called by the hidden render engine after each of its ``frame_set``. What it returns
holds numpy arrays and texts only, nothing that Blender could free.

- All meshes that the render would show are there, and curves, texts and metaballs as the meshes that
  the render makes of them. Objects with ``snowbough.occlude`` off and Snowbough's own shells are not.
- A receiver is an object of the scene's list. Where that is an empty that instances a collection, every
  mesh instanced by it is a receiver of its own. All other instances of one object are gathered into one
  occluder, so that a lawn is one object and not ten thousand.
- Positions are world positions in metres: Blender units times ``unit_settings.scale_length``, worked out
  with the same elementary operations everywhere, so that machines that share a bake agree in every bit.
- Mirrored objects (negative scale) have their triangles turned, so that outside stays outside.
- Vertices beyond names.FARTHEST or nowhere are left out with their triangles: one would stretch the grid.
- An object that stands still is not read again; topology is read once and again when it changes. A
  receiver keeps the UV map of its first pose: one that has lost it is refused.
- Receivers say which corners of theirs share a smooth normal (mesh_record).
- Where materials have alpha from an image, triangles carry the image and the UVs in it (material_alpha).
"""

from dataclasses import dataclass, field

import numpy as np

from ..names import FARTHEST, OWN_MODIFIERS, UV_TOLERANCE, receiver_key
from . import material_alpha
from .inputs import fingerprint
from .mesh_record import MeshRecord, join_alphas, join_shadings, materials_of
from .pose import (
    ObjectPose,
    ReceiverSpec,
    SceneError,
    ScenePose,
    Topology,
    TopologyAlpha,
    library_path,
    member_key,
    outliers,
    own_key,
    world_positions,
)

SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

# These only move vertices: where an object has no others, its topology cannot change.
DEFORMING_MODIFIERS = {
    "ARMATURE", "CAST", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LATTICE", "MESH_DEFORM",
    "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "CORRECTIVE_SMOOTH", "LAPLACIANSMOOTH", "SURFACE_DEFORM",
    "WARP", "WAVE", "CLOTH", "COLLISION", "SOFT_BODY", "MESH_CACHE", "NORMAL_EDIT", "WEIGHTED_NORMAL",
    "UV_PROJECT", "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY",
    "SUBSURF", "MULTIRES", "MIRROR", "ARRAY", "SOLIDIFY", "TRIANGULATE",
}  # fmt: skip


@dataclass
class _Known:
    """What the reader keeps of an object (or of all instances of one) from pose to pose."""

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
    """The same of those whose triangles the topology lacks."""
    flips: tuple = ()
    uv_map: str = ""


@dataclass
class _Group:
    """The instances of one object that make one pose, in a fixed order."""

    label: str
    name: str
    library: str
    receiver: ReceiverSpec
    instances: list = field(default_factory=list)
    """(sort key, matrix (4, 4) float64, local positions, evaluated mesh's data)"""


def _is_deforming_only(obj):
    return all(modifier.type in DEFORMING_MODIFIERS for modifier in obj.modifiers)


def _is_rigid(obj, switch):
    """The object's mesh in its own space is the same on every frame: nothing can deform it, since our own
    displacement is off while a bake or preview reads. switch: what of a modifier counts, as in Muted."""
    original = obj.original
    data = original.data
    return (
        original.type == "MESH"
        and all(
            modifier.name in OWN_MODIFIERS and not getattr(modifier, switch)
            for modifier in original.modifiers
        )
        and data.shape_keys is None
        and data.animation_data is None
        and not original.is_evaluated
    )


class SceneReader:
    """Reads poses of one scene; keeps what does not change between them.

    receivers: list of ReceiverSpec. scale_length: metres a Blender unit.
    """

    def __init__(self, receivers, scale_length):
        self._receivers = {(spec.name, spec.library): spec for spec in receivers}
        self._scale = scale_length
        self._known = {}
        self._rigid = {}
        self._switch = ""
        # Material's (name, library) -> material_alpha.AlphaImage or None; images are read once.
        self._alphas = {}
        # Receivers that cannot be ones from their first pose on: label -> why.
        self._refused = {}
        # Objects that are shown as instances of their own: (name, library) -> who scatters them.
        self._scattered = {}

    def read(self, depsgraph, frame):
        """The pose.ScenePose that depsgraph holds. frame: a number for messages.

        A receiver that has no mesh or no UV map when it is first read is refused: it only blocks snow, and the pose
        says why. Raises SceneError for one that loses them later.
        """
        self._switch = "show_render" if depsgraph.mode == "RENDER" else "show_viewport"
        groups = self._gather(depsgraph)
        objects = {}
        for key in sorted(groups):
            objects[key] = self._pose_or_refusal(key, groups[key], frame)
        self._refuse_scattered(objects)
        settings = depsgraph.scene_eval.snowbough
        return ScenePose(objects, settings.fall_angle, settings.bearing, settings.rate, dict(self._refused))

    def _pose_or_refusal(self, key, group, frame):
        """The pose of a group; of a receiver that cannot be one, as an occluder."""
        if group.label in self._refused:
            group.receiver = None
        if group.receiver is None or not group.receiver.enabled or key in self._known:
            return self._pose(key, group, frame)
        try:
            return self._pose(key, group, frame)
        except SceneError as error:
            self._known.pop(key, None)
            self._refused[group.label] = str(error)
            group.receiver = None
            return self._pose(key, group, frame)

    def _refuse_scattered(self, objects):
        """Says of receivers that are only seen as instances what can be done about it."""
        seen = {(o.receiver.name, o.receiver.library) for o in objects.values() if o.receiver}
        for (name, library), scatterer in self._scattered.items():
            spec = self._receivers.get((name, library))
            if spec is not None and spec.enabled and (name, library) not in seen:
                self._refused[name] = (
                    f"'{name}' is only seen as instances that {_scatterer(name, scatterer)}, which would all share "
                    "one map: end its geometry nodes with Realize Instances and make it a receiver with a UV map of "
                    "its own (instances on faces or vertices: Object > Apply > Make Instances Real)"
                )

    def _gather(self, depsgraph):
        """key -> _Group of everything that the render shows."""
        groups = {}
        shared = {}
        for instance in depsgraph.object_instances:
            obj = instance.object
            if obj.type not in SURFACE_TYPES:
                continue
            if not (instance.is_instance or instance.show_self):
                continue
            original = obj.original
            if original.snowbough.is_shell or not original.snowbough.occlude:
                continue
            group, order = self._group_of(instance, obj, original, groups)
            if group is None:
                continue
            matrix = np.array(instance.matrix_world, dtype=np.float64)
            local, mesh = self._local_mesh(obj, shared, group.receiver is not None)
            if local is None:
                continue
            group.instances.append((order, matrix, local, mesh))
        return groups

    def _group_of(self, instance, obj, original, groups):
        name, library = original.name, library_path(original)
        if not instance.is_instance:
            key = own_key(name, library)
            receiver = self._receivers.get((name, library))
            group = groups.setdefault(key, _Group(name, name, library, receiver))
            return group, ()
        parent = instance.parent.original if instance.parent else None
        if parent is not None and (parent.snowbough.is_shell or not parent.snowbough.occlude):
            return None, None
        parent_name = parent.name if parent else ""
        parent_library = library_path(parent) if parent else ""
        order = tuple(index for index in instance.persistent_id if index != 0x7FFFFFFF)
        receiver = self._receivers.get((parent_name, parent_library))
        if receiver is not None and parent.instance_type == "COLLECTION":
            key = member_key(name, library, parent_name, parent_library, order)
            return groups.setdefault(key, _Group(f"{parent_name} / {name}", name, library, receiver)), order
        for shown in ((name, library), (parent_name, parent_library)):
            self._scattered.setdefault(shown, parent_name)
        key = receiver_key(f"{name}.instances", (library, parent_name, parent_library))
        return groups.setdefault(key, _Group(f"{parent_name} / {name}", name, library, None)), order

    def _local_mesh(self, obj, shared, receives):
        """(positions in the object's space, a record of its mesh). Both are shared between the instances
        of one evaluated mesh within a pose, and between poses while nothing can deform the object.
        receives: its shading matters."""
        pointer = (obj.original.as_pointer(), obj.data.as_pointer() if obj.data else 0, receives)
        if pointer in shared:
            return shared[pointer]
        rigid_key = (obj.original.name, library_path(obj.original), receives)
        if rigid_key in self._rigid:
            shared[pointer] = self._rigid[rigid_key]
            return shared[pointer]
        temporary = obj.type != "MESH"
        mesh = obj.to_mesh() if temporary else obj.data
        if mesh is None or not len(mesh.polygons):
            shared[pointer] = (None, None)
            return shared[pointer]
        try:
            record = MeshRecord(
                mesh, temporary or not _is_deforming_only(obj.original), self._alphas_of(obj, mesh)
            )
            if temporary:
                record.detach(receives)
            found = (record.positions, record)
        finally:
            if temporary:
                obj.to_mesh_clear()
        if not temporary and _is_rigid(obj, self._switch):
            record.detach(receives)
            self._rigid[rigid_key] = found
        shared[pointer] = found
        return found

    def _alphas_of(self, obj, mesh):
        """AlphaImage or None for each material index of an object's evaluated mesh."""
        return [self._alpha_of(material) for material in materials_of(obj, mesh)]

    def _alpha_of(self, material):
        if material is None:
            return None
        known = (material.name, library_path(material))
        if known not in self._alphas:
            try:
                self._alphas[known] = material_alpha.of_material(material)
            except material_alpha.UnknownAlpha:  # opaque then; preflight tells
                self._alphas[known] = None
        return self._alphas[known]

    def _pose(self, key, group, frame):
        known = self._known.setdefault(key, _Known())
        group.instances.sort(key=lambda item: item[0])
        records = [item[3] for item in group.instances]
        if not records:
            if group.receiver is not None:
                raise SceneError(
                    f"'{group.label}' has no faces at frame {frame}: there is nothing to snow on"
                )
            return _empty_pose(key, group)
        matrices = np.stack([item[1] for item in group.instances])
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
            if group.receiver is not None:
                raise SceneError(f"'{group.label}' is beyond {FARTHEST:g} m at frame {frame}: move it nearer")
            return _empty_pose(key, group)
        self._update_topology(known, group, records, flips, frame)
        prints = (
            known.transform_print, known.shape_print, known.topology.print, *known.topology.alpha_prints
        )  # fmt: skip
        return ObjectPose(key, group.label, group.name, group.library, group.receiver, known.uv_map,
                          known.topology, known.positions, prints)  # fmt: skip

    def _update_topology(self, known, group, records, flips, frame):
        counts = tuple(record.counts for record in records)
        same_parts = known.counts == counts and known.flips == flips
        if known.topology is not None and same_parts and np.array_equal(known.left_out, known.lost):
            if not any(record.may_change for record in records):
                return
            corners = [record.corners() for record in records]
            if _same_arrays(known.corners, corners):
                return
        receiver = group.receiver is not None
        triangles, uvs, alphas, shadings, offset = [], [], [], [], 0
        for record, flip in zip(records, flips):
            corner_triangles = record.triangle_corners()
            if flip:
                corner_triangles = corner_triangles[:, ::-1]
            triangles.append(record.corners()[corner_triangles] + np.int32(offset))
            if receiver:
                known.uv_map, uv = record.uv(group.receiver.uv_map, known.uv_map, group.label, frame)
                uvs.append(uv[corner_triangles])
                shadings.append(record.shading(corner_triangles))
            alphas.append(record.alpha(corner_triangles))
            offset += record.counts[0]
        triangles = np.ascontiguousarray(np.concatenate(triangles), dtype=np.int32)
        uv = np.ascontiguousarray(np.concatenate(uvs)) if receiver else np.empty((0, 3, 2), dtype=np.float32)
        if receiver and group.receiver.enabled and known.topology is not None and not _fits_map(uv):
            raise SceneError(
                f"'{group.label}' has other faces at frame {frame} than before, and they do not lie on its UV "
                f"map '{known.uv_map}' from 0 to 1: apply the modifier that makes them, or take "
                f"'{group.label}' off the list of receivers"
            )
        known.counts, known.flips, known.left_out = counts, flips, known.lost
        known.corners = [record.corners() for record in records]
        alpha = join_alphas(alphas)
        shading = join_shadings(shadings, [record.counts[1] for record in records])
        if known.lost is not None:
            keep = ~known.lost[triangles].any(axis=1)
            triangles, uv = triangles[keep], uv[keep] if receiver else uv
            shading = None if shading is None else shading[keep]
            alpha = TopologyAlpha(alpha.uv[keep], alpha.image[keep], alpha.images) if alpha else None
        parts = [] if shading is None else [shading]
        parts += [alpha.uv, alpha.image] if alpha else []
        made = Topology(triangles, uv, offset, fingerprint(triangles, uv, *parts), alpha, shading)
        if known.topology is None or not known.topology.is_same(made):
            known.topology = made


def _scatterer(name, scatterer):
    return "it scatters itself" if name == scatterer else f"'{scatterer}' scatters"


def _fits_map(uv):
    """Whether all of the triangles (T, 3, 2) lie on the map and at least one has room there."""
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
    """The arrays without those that are the very same object again, in order."""
    seen, once = set(), []
    for array in arrays:
        if id(array) not in seen:
            seen.add(id(array))
            once.append(array)
    return once
