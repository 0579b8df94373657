# SPDX-License-Identifier: GPL-3.0-or-later
"""Levels of detail of a tree's bark: the levels in the scene, then coarser levels that the native module builds from
the skeleton that the armature stores, then levels with fewer and fewer branches. All levels share the bones and the UV
map ``snow``, so one baked map fits all.
"""

from dataclasses import replace

import numpy as np

from ..base import native
from ..tree import kept_skeleton, wind_attributes
from ..tree.bone_names import fitting_names
from ..tree.import_options import BASE, LOD_CHAIN
from ..tree.objects import point_levels
from .thinning import Limb, kept_branches, without_branches
from .triangle_mesh import from_quads, strongest

DETAILS = ("FILM", "DEFAULT", "GAME", "DRAFT", BASE)
# A level is used only if it has at most this share of the triangles of the level before.
WORTHWHILE = 0.7
# Target share of the triangles of the level before, for levels with fewer branches.
FEWER_BRANCHES = 0.5
# Maximum distance of rest bones from those of the stored skeleton, as a share of the tree's height.
TOLERANCE = 1e-4
# The four-sided base has the volume of the limb, so its silhouette is wider by 2 / sqrt(pi) in the mean over all
# directions. A square side of pi / 2 radii has the limb's mean width (Cauchy: perimeter / pi).
NARROWER = np.sqrt(np.pi) / 2
# Values of the native face_part that are at least this large mean caps.
FIRST_CAP = 2


def _with_mean_width(base):
    """(V, 3): the points of the four-sided base, moved towards the bones so that the limbs keep their mean width."""
    points, bone = np.asarray(base.vertices, np.float64), np.asarray(base.bone_indices)[:, 0]
    head, tail = (np.asarray(ends, np.float64)[bone] for ends in (base.bone_heads, base.bone_tails))
    along = tail - head
    share = ((points - head) * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-30)
    axis = head + np.clip(share, 0.0, 1.0)[:, None] * along
    return axis + NARROWER * (points - axis)


class _Builder:
    """Builds meshes of a stored skeleton with the bones of `rig`. Raises ValueError if the bones were changed."""

    def __init__(self, skeleton, built, rig):
        self._module, self._skeleton, self._built = native.load(), skeleton, built
        self._meshes, self._points = {}, {}
        self._number = {bone.name: index for index, bone in enumerate(rig.data.bones)}
        self._check(self.mesh(BASE), rig)

    def mesh(self, detail):
        """The mesh of this detail, built once."""
        if detail not in self._meshes:
            self._meshes[detail] = self._build(detail)
        return self._meshes[detail]

    def _build(self, detail):
        built = self._built
        whole = self._module.build_tree_mesh(
            self._skeleton,
            built["width"],
            built["species"],
            detail,
            snow_resolution=built["snow_resolution"],
            root_bone=built["root_bone"],
        )
        self._points[detail] = _with_mean_width(whole) if detail == BASE else whole.vertices
        return self._module.reduce_bones(whole, built["max_bones"], built["max_bone_level"])

    def points(self, detail):
        """The points of mesh(detail); the base's limbs have the mean width of round ones."""
        self.mesh(detail)
        return self._points[detail]

    def joints(self, mesh):
        """(joints, weights) with the armature's bone indices."""
        names = fitting_names(mesh.bone_names)
        number = np.array([self._number[name] for name in names])
        return strongest(number[mesh.bone_indices], mesh.bone_weights)

    def _check(self, mesh, rig):
        names = fitting_names(mesh.bone_names)
        gone = [name for name in names if name not in self._number]
        if gone:
            raise ValueError(f"the armature no longer has a bone '{gone[0]}'")
        heads = np.array([rig.data.bones[name].head_local for name in names])
        away = np.abs(heads - mesh.bone_heads).max()
        if away > TOLERANCE * self._skeleton.height:
            raise ValueError(f"its rest bones were moved by up to {away:.3g} units since the import")


def _material_of_joints(surface, joints):
    """int (joints,): for each joint the most frequent material of the triangles whose first point follows it most."""
    first = surface.joints[surface.corner_point[surface.triangles[:, 0]], 0]
    materials = int(surface.material.max()) + 1
    counts = np.bincount(first.astype(np.int64) * materials + surface.material, minlength=joints * materials)
    counts = counts.reshape(joints, materials)
    commonest = np.bincount(surface.material).argmax()
    return np.where(counts.any(axis=1), counts.argmax(axis=1), commonest)


def _stretch(surface):
    """(u, v): factors from TEXCOORD_0 to TEXCOORD_2, the texture coordinates of the imported file. u is an integer, so
    that the texture closes around the limb."""
    bark, own = (
        np.abs(np.diff(surface.corner_uvs[k][surface.triangles], axis=1)).reshape(-1, 2) for k in (0, 2)
    )
    used = bark > 1e-6
    ratios = [
        np.median(own[used[:, k], k] / bark[used[:, k], k]) if used[:, k].any() else 1.0 for k in (0, 1)
    ]
    return np.array((max(round(float(ratios[0])), 1), max(float(ratios[1]), 1e-3)), dtype=np.float32)


def _is_cap(mesh):
    """bool (F,): the faces that close a root or a tip. They are shaded flat: if normals of a ring leaned towards its
    cap, shaders that round the surface would inflate the ring."""
    return np.asarray(mesh.face_part) >= FIRST_CAP


def _as_surface(branches, mesh, points, quads, corner_uvs, faces, joints, finest):
    """A native mesh of the branches, or a part of it, as a TriangleMesh with the materials and the number of UV maps
    of the `finest` level, and with wind attributes if that level has them.

    points: of the mesh; faces: the index of each quad in the mesh.
    """
    if len(finest.corner_uvs) > 2:
        corner_uvs = [*corner_uvs, corner_uvs[0] * _stretch(finest)]
    by_joint = _material_of_joints(finest, int(max(joints[0].max(), finest.joints.max())) + 1)
    level = point_levels(quads, np.asarray(mesh.branch_level)[faces], len(mesh.vertices))
    made = from_quads(points, quads, corner_uvs, *joints, by_joint[joints[0][quads[:, 0], 0]], level)
    wind = wind_attributes.of_bark(branches, mesh) if finest.wind is not None else None
    return replace(made, smooth=np.repeat(~_is_cap(mesh)[faces], 2), wind=wind)


def _with_flat_caps(surface, mesh):
    """A TriangleMesh of the scene with flat caps, which come from the native mesh. Unchanged if the artist has edited
    the mesh."""
    same = len(surface.points) == len(mesh.vertices) and len(surface.triangles) == 2 * len(mesh.quads)
    if not same or not np.allclose(surface.points, mesh.vertices, atol=1e-5):
        return surface
    return replace(surface, smooth=surface.smooth & np.repeat(~_is_cap(mesh), 2))


def _rebuilt(builder, branches, in_scene, finest):
    """Yields TriangleMeshes of the details coarser than `in_scene`. Each is built on demand."""
    for detail in DETAILS[DETAILS.index(in_scene) + 1 :]:
        mesh = builder.mesh(detail)
        yield _as_surface(
            branches,
            mesh,
            builder.points(detail),
            np.asarray(mesh.quads),
            [np.asarray(mesh.uv_bark), np.asarray(mesh.uv_snow)],
            np.arange(len(mesh.quads)),
            builder.joints(mesh),
            finest,
        )


def _pruned(builder, branches, finest, triangles):
    """Yields TriangleMeshes with fewer and fewer branches, the first with half of `triangles`, the last with only the
    roots."""
    mesh = builder.mesh(BASE)
    quads = np.asarray(mesh.quads)
    face_branch = np.asarray(mesh.face_branch)
    faces = np.bincount(face_branch, minlength=len(branches))
    uvs = [np.asarray(mesh.uv_bark), np.asarray(mesh.uv_snow)]
    joints = builder.joints(mesh)
    limbs = [Limb(branch.points, parent) for branch, parent in zip(branches, mesh.branch_parents.tolist())]
    while True:
        triangles = int(triangles * FEWER_BRANCHES)
        kept = kept_branches(limbs, faces, triangles // 2)
        left = without_branches(quads, uvs, face_branch, limbs, kept)
        yield _as_surface(branches, mesh, builder.points(BASE), *left, joints, finest)
        if kept.sum() == sum(branch.parent < 0 for branch in branches):
            return


def _append_worthwhile(levels, candidates, count):
    """Appends candidates with at most WORTHWHILE of the triangles of the level before, up to `count` levels."""
    while len(levels) < count:
        surface = next(candidates, None)
        if surface is None:
            return
        if len(surface.triangles) <= WORTHWHILE * len(levels[-1].triangles):
            levels.append(surface)


def complete(levels, lods, count, rig, warnings):
    """`levels` (TriangleMeshes in armature space, the finest first), completed with coarser ones up to `count`. If
    there are fewer, `warnings` receives the reason. lods: for each level its place in LOD_CHAIN, or None.
    """
    levels, lods = levels[:count], lods[:count]
    try:
        found = kept_skeleton.kept(rig.data)
        if found is None:
            raise ValueError("it was imported by a version that stores no skeleton")
        skeleton, built = found
        if built.get("keeps_surface"):
            if count > len(levels):
                warnings.append(f"'{rig.name}' keeps the surface of its file: it has one level of detail")
            return levels
        builder = _Builder(skeleton, built, rig)
    except ValueError as error:
        if len(levels) < count:
            warnings.append(
                f"'{rig.name}' has {len(levels)} of {count} levels of detail. Coarser levels cannot be built: "
                f"{error}. Import the tree again, or import it with Import LOD Chain"
            )
        return levels
    for number, lod in enumerate(lods):
        detail = built["detail"] if lod is None else LOD_CHAIN[lod]
        levels[number] = _with_flat_caps(levels[number], builder.mesh(detail))
    if len(levels) == count:
        return levels
    finest = levels[0]
    if len(finest.corner_uvs) > 2:
        warnings.append(
            "coarser levels than those in the scene use the UV map `bark`, scaled, for the texture coordinates of "
            "the imported file: use Import LOD Chain to keep these coordinates"
        )
    if len(levels) == 1:
        _append_worthwhile(levels, _rebuilt(builder, skeleton.branches, built["detail"], finest), count)
    _append_worthwhile(levels, _pruned(builder, skeleton.branches, finest, len(levels[-1].triangles)), count)
    if len(levels) < count:
        warnings.append(
            f"'{rig.name}' has {len(levels)} of {count} levels of detail: further levels would save too few triangles"
        )
    return levels
