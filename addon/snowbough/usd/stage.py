# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree as USD: UsdSkel, UsdPreviewSurface, and a PointInstancer for the leaves, with the attributes by which Unreal
Engine makes a Nanite assembly. No ``bpy``; needs the Python module ``pxr``, which Blender's official builds contain.

Axes and units are Blender's: Z up, metres. Sources: Pixar, USD schemas UsdSkel and UsdPreviewSurface; Epic Games,
Unreal Engine documentation, Nanite Assemblies, for the schemas NaniteAssemblyRootAPI and NaniteAssemblySkelBindingAPI.
"""

import json
from pathlib import Path

import numpy as np

from ..cache.files import write_bytes
from ..gltf.tree_data import SNOW_COLOR, SNOW_ROUGHNESS, Material, local_rests, quaternion, times
from ..gltf.triangle_mesh import corner_normals, point_normals
from .instances import kinds_of
from .materials import Materials
from .wind_json import wind_data

SUFFIXES = (".usda", ".usdc", ".usd")
TIME_CODES_PER_SECOND = 24.0
# Names of the texture coordinates, in the order of TEXCOORD_0 and so on.
UV_NAMES = ("st", "st1", "st2")
NANITE = "unreal:naniteAssembly"


def library(where=""):
    """The module pxr with the submodules that are used here. where: a folder that Blender's Python searches. Raises
    RuntimeError with advice if it is missing."""
    try:
        import pxr
        from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdShade, UsdSkel, Vt  # noqa: F401
    except ImportError as error:
        target = f" --target '{where}'" if where else ""
        raise RuntimeError(
            "USD cannot be written, because this Blender has no USD library for Python. Use a Blender from "
            f"blender.org, or install it with the command: pip install{target} usd-core"
        ) from error
    return pxr


def _unique(tf, names):
    """Valid, different names of prims."""
    made = {}
    for name in names:
        plain = tf.MakeValidIdentifier(name)
        free = next(one for n in range(len(names)) if (one := f"{plain}_{n}" if n else plain) not in made)
        made[free] = None
    return list(made)


def joint_paths(names, joints):
    """The path of each joint in the skeleton: the names of its ancestors and its own."""
    paths = []
    for name, joint in zip(names, joints):
        paths.append(name if joint.parent < 0 else f"{paths[joint.parent]}/{name}")
    return paths


class _Writer:
    """Writes a Tree to a new stage in memory. folder: name of the textures' folder; files: {name: bytes} for it."""

    def __init__(self, pxr, tree, folder):
        self._pxr, self._tree, self._normals = pxr, tree, {}
        self.stage = pxr.Usd.Stage.CreateInMemory()
        pxr.UsdGeom.SetStageUpAxis(self.stage, pxr.UsdGeom.Tokens.z)
        pxr.UsdGeom.SetStageMetersPerUnit(self.stage, 1.0)
        self._root = f"/{pxr.Tf.MakeValidIdentifier(tree.name)}"
        root = pxr.UsdGeom.Xform.Define(self.stage, self._root).GetPrim()
        self.stage.SetDefaultPrim(root)
        pxr.Usd.ModelAPI(root).SetKind("component")
        self._skeleton = f"{self._root}/Skin/Skeleton"
        self._materials = Materials(pxr, self.stage, f"{self._root}/Materials", folder, UV_NAMES)
        self.names = _unique(pxr.Tf, [joint.name for joint in tree.joints])
        self._paths = joint_paths(self.names, tree.joints)
        self.files = self._materials.files

        root.AddAppliedSchema("NaniteAssemblyRootAPI")
        uniform = pxr.Sdf.VariabilityUniform
        kind = root.CreateAttribute(f"{NANITE}:meshType", pxr.Sdf.ValueTypeNames.Token, False, uniform)
        kind.Set("skeletalMesh")
        root.CreateRelationship(f"{NANITE}:skeleton", custom=False).SetTargets([self._skeleton])

    def _matrices(self, matrices):
        # USD's matrices act on row vectors.
        return [self._pxr.Gf.Matrix4d(matrix.T.tolist()) for matrix in matrices]

    def _vectors(self, rows):
        rows = np.ascontiguousarray(rows, dtype=np.float32)
        return getattr(self._pxr.Vt, f"Vec{rows.shape[1]}fArray").FromNumpy(rows)

    def _integers(self, values):
        return self._pxr.Vt.IntArray.FromNumpy(np.ascontiguousarray(values, dtype=np.int32).reshape(-1))

    def _quaternions(self, rows, kind):
        return [kind(float(w), float(x), float(y), float(z)) for x, y, z, w in rows]

    def _add_skeleton(self, path, paths, worlds, locals_):
        skeleton = self._pxr.UsdSkel.Skeleton.Define(self.stage, path)
        skeleton.CreateJointsAttr(paths)
        skeleton.CreateBindTransformsAttr(self._matrices(worlds))
        skeleton.CreateRestTransformsAttr(self._matrices(locals_))
        return skeleton

    def _add_motion(self, motion, locals_):
        pxr, path = self._pxr, f"{self._root}/Skin/Sway"
        animation = pxr.UsdSkel.Animation.Define(self.stage, path)
        animation.CreateJointsAttr(self._paths)
        animation.CreateTranslationsAttr(self._vectors([matrix[:3, 3] for matrix in locals_]))
        animation.CreateScalesAttr([pxr.Gf.Vec3h(1.0)] * len(self._paths))
        rests = np.array([quaternion(matrix[:3, :3]) for matrix in locals_])
        rotations = animation.CreateRotationsAttr()
        for time, turns in zip(motion.times, motion.turns):
            now = self._quaternions(times(rests, turns), pxr.Gf.Quatf)
            rotations.Set(now, float(time) * TIME_CODES_PER_SECOND)
        self.stage.SetTimeCodesPerSecond(TIME_CODES_PER_SECOND)
        self.stage.SetStartTimeCode(0.0)
        self.stage.SetEndTimeCode(float(motion.times[-1]) * TIME_CODES_PER_SECOND)
        binding = pxr.UsdSkel.BindingAPI.Apply(self.stage.GetPrimAtPath(self._skeleton))
        binding.CreateAnimationSourceRel().SetTargets([path])

    def _add_shape(self, path, points, corners, normals, interpolation):
        """A Mesh of triangles: points (V, 3), corners (T, 3) as indices of points."""
        mesh = self._pxr.UsdGeom.Mesh.Define(self.stage, path)
        points = self._vectors(points)
        mesh.CreatePointsAttr(points)
        mesh.CreateFaceVertexCountsAttr(self._integers(np.full(len(corners), 3)))
        mesh.CreateFaceVertexIndicesAttr(self._integers(corners))
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateNormalsAttr(self._vectors(normals))
        mesh.SetNormalsInterpolation(interpolation)
        mesh.CreateExtentAttr(self._pxr.UsdGeom.PointBased.ComputeExtent(points))
        return mesh

    def _normals_of(self, surface):
        if id(surface) not in self._normals:
            self._normals[id(surface)] = corner_normals(surface)
        return self._normals[id(surface)]

    def _add_surface(self, path, surface, part, chosen, origin=(0, 0, 0), maps=None):
        """A Mesh of the triangles `chosen` (an index) of a Surface, without points that they do not use. maps: number
        of texture coordinates. Returns (Mesh, used points)."""
        corners = surface.triangles[chosen]
        used, index = np.unique(surface.corner_point[corners], return_inverse=True)
        normals = self._normals_of(surface)[chosen].reshape(-1, 3)
        points = surface.points[used] - np.asarray(origin, dtype=np.float32)
        mesh = self._add_shape(path, points, index.reshape(-1, 3), normals, "faceVarying")
        api, kinds = self._pxr.UsdGeom.PrimvarsAPI(mesh), self._pxr.Sdf.ValueTypeNames
        for name, uv in zip(UV_NAMES, surface.corner_uvs[:maps]):
            primvar = api.CreatePrimvar(name, kinds.TexCoord2fArray, "faceVarying")
            primvar.Set(self._vectors(uv[corners].reshape(-1, 2)))
        if surface.level is not None:
            level = api.CreatePrimvar("branchLevel", kinds.IntArray, "vertex")
            level.Set(self._integers(surface.level[used]))
        materials = [self._materials.path_of(material) for material in part.materials]
        self._materials.bind(mesh, materials, surface.material[chosen])
        mesh.CreateDoubleSidedAttr(any(material.double_sided for material in part.materials))
        return mesh, used

    def _bind(self, mesh, skeleton, joints, weights):
        """Skins a mesh: joints and weights (V, K)."""
        binding = self._pxr.UsdSkel.BindingAPI.Apply(mesh.GetPrim())
        width = joints.shape[1]
        binding.CreateSkeletonRel().SetTargets([skeleton])
        binding.CreateJointIndicesPrimvar(False, width).Set(self._integers(joints))
        weights = np.ascontiguousarray(weights, dtype=np.float32).reshape(-1)
        binding.CreateJointWeightsPrimvar(False, width).Set(self._pxr.Vt.FloatArray.FromNumpy(weights))
        binding.CreateGeomBindTransformAttr(self._pxr.Gf.Matrix4d(1.0))

    def _add_skinned(self, path, surface, part, chosen):
        mesh, used = self._add_surface(path, surface, part, chosen)
        self._bind(mesh, self._skeleton, surface.joints[used], surface.weights[used])

    def _add_prototype(self, path, surface, part, kind):
        """A prototype: a leaf skinned to one joint of its own, as Unreal expects of parts of skeletal assemblies."""
        skel = self._pxr.UsdSkel
        skel.Root.Define(self.stage, path)
        self._add_skeleton(f"{path}/Skeleton", ["leaf"], [np.eye(4)], [np.eye(4)])
        mesh, used = self._add_surface(f"{path}/Leaf", surface, part, kind.triangles, kind.origin, maps=1)
        one = np.zeros((len(used), 1), dtype=np.int32)
        self._bind(mesh, f"{path}/Skeleton", one, np.ones(one.shape))

    def _add_leaves(self, part, name):
        """The leaves of the finest level as instances; leaves of odd shapes are skinned."""
        pxr, surface = self._pxr, part.levels[0]
        kinds, left = kinds_of(surface, self._tree.joints)
        if left.any():
            self._add_skinned(f"{self._root}/Skin/{name}", surface, part, left)
        if not kinds:
            return
        instancer = pxr.UsdGeom.PointInstancer.Define(self.stage, f"{self._root}/{name}")
        pxr.UsdGeom.Scope.Define(self.stage, f"{self._root}/{name}/Prototypes")
        for number, kind in enumerate(kinds):
            path = f"{self._root}/{name}/Prototypes/Leaf{number}"
            self._add_prototype(path, surface, part, kind)
            instancer.CreatePrototypesRel().AddTarget(path)
        counts = [len(kind.scales) for kind in kinds]
        instancer.CreateProtoIndicesAttr(self._integers(np.repeat(np.arange(len(kinds)), counts)))
        instancer.CreatePositionsAttr(self._vectors(np.concatenate([kind.origins for kind in kinds])))
        rotations = [quaternion(matrix) for kind in kinds for matrix in kind.rotations]
        instancer.CreateOrientationsAttr(self._quaternions(rotations, pxr.Gf.Quath))
        scales = np.concatenate([kind.scales for kind in kinds])
        instancer.CreateScalesAttr(self._vectors(np.repeat(scales[:, None], 3, axis=1)))
        self._bind_instances(instancer.GetPrim(), np.concatenate([kind.joints for kind in kinds]))
        now = pxr.Usd.TimeCode.Default()
        instancer.CreateExtentAttr(instancer.ComputeExtentAtTime(now, now))

    def _bind_instances(self, prim, joints):
        """Binds each instance to one joint, for Unreal."""
        prim.AddAppliedSchema("NaniteAssemblySkelBindingAPI")
        kinds, uniform = self._pxr.Sdf.ValueTypeNames, self._pxr.Sdf.VariabilityUniform
        weights = self._pxr.Vt.FloatArray.FromNumpy(np.ones(len(joints), dtype=np.float32))
        for name, kind, values in (
            ("bindJoints", kinds.TokenArray, [self._paths[joint] for joint in joints]),
            ("bindJointWeights", kinds.FloatArray, weights),
        ):
            attribute = prim.CreateAttribute(f"primvars:{NANITE}:{name}", kind, False, uniform)
            attribute.Set(values)
            primvar = self._pxr.UsdGeom.Primvar(attribute)
            primvar.SetInterpolation("uniform")
            primvar.SetElementSize(1)

    def write(self):
        """Adds everything to the stage."""
        tree, skel = self._tree, self._pxr.UsdSkel
        skel.Root.Define(self.stage, f"{self._root}/Skin")
        locals_ = local_rests(tree.joints)
        self._add_skeleton(self._skeleton, self._paths, [joint.rest for joint in tree.joints], locals_)
        if tree.motion is not None:
            self._add_motion(tree.motion, locals_)
        parts = [*tree.parts, *tree.snow_meshes]
        names = _unique(self._pxr.Tf, ["Skin", "Materials", *(part.name for part in parts)])[2:]
        bark, surface = tree.parts[0], tree.parts[0].levels[0]
        every = np.ones(len(surface.triangles), dtype=bool)
        self._add_skinned(f"{self._root}/Skin/{names[0]}", surface, bark, every)
        for part, name in zip(tree.parts[1:], names[1:]):
            self._add_leaves(part, name)
        material = Material("Snow", SNOW_COLOR, SNOW_ROUGHNESS)
        for snow, name in zip(tree.snow_meshes, names[len(tree.parts) :]):
            normals = point_normals(snow.points, snow.triangles)
            mesh = self._add_shape(f"{self._root}/{name}", snow.points, snow.triangles, normals, "vertex")
            path = self._materials.path_of(material)
            self._materials.bind(mesh, [path], np.zeros(len(snow.triangles), dtype=np.int32))


def write(tree, path, _options=None):
    """Writes a Tree to `path`, its textures to the folder <stem>_textures, and <stem>_wind.json beside it. Returns all
    paths. Raises RuntimeError if the library is missing or a file cannot be written."""
    pxr, path = library(), Path(path)
    folder = path.with_name(f"{path.stem}_textures")
    writer = _Writer(pxr, tree, folder.name)
    writer.write()
    written = [path, path.with_name(f"{path.stem}_wind.json")]
    if writer.files:
        folder.mkdir(exist_ok=True)
    for name, data in writer.files.items():
        write_bytes(folder / name, data)
        written.append(folder / name)
    data = wind_data(tree.joints, writer.names)
    write_bytes(written[1], json.dumps(data, indent=1).encode() + b"\n")
    try:
        saved = writer.stage.GetRootLayer().Export(str(path))
    except pxr.Tf.ErrorException as error:
        raise RuntimeError(f"{path} could not be written: {error}") from error
    if not saved:
        raise RuntimeError(f"{path} could not be written")
    return written
