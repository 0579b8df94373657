# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees as USD (snowbough.usd): files are read back with USD's own library and checked by its validators. Needs the
Python module pxr (package usd-core)."""

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from snowbough.gltf import tree_data, triangle_mesh
from snowbough.usd import instances, stage, wind_json

# A grey PNG of one pixel.
PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
    "0000000a49444154789c636000000002000148afa4710000000049454e44ae426082"
)
LEAF = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.2, 1.0, 0.1), (0.0, 1.0, 0.3)])
JOINTS = [
    tree_data.Joint("trunk1.001", -1, np.eye(4), 1.0, 0.1),
    tree_data.Joint("trunk1_001", 0, np.eye(4), 1.0, 0.02, True),
    tree_data.Joint("twig", 1, np.eye(4), 0.5, 0.002),
]
for _height, _joint in enumerate(JOINTS):
    _joint.rest = np.array([(1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, _height), (0, 0, 0, 1.0)])


def random_rotation(rng):
    x, y, z, w = (lambda q: q / np.linalg.norm(q))(rng.normal(size=4))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quads_surface(points, level=None, joint=2):
    """A Surface of separate quads, points (N, 4, 3), that follow one joint."""
    count = len(points)
    uv = np.tile(np.float32([(0, 0), (1, 0), (1, 1), (0, 1)]), (count, 1, 1))
    joints, weights = triangle_mesh.strongest(np.full((4 * count, 1), joint), np.ones((4 * count, 1)))
    quads, material = np.arange(4 * count).reshape(-1, 4), np.zeros(count)
    return triangle_mesh.from_quads(points.reshape(-1, 3), quads, [uv, uv], joints, weights, material, level)


def leaves(count, shape=LEAF, seed=1):
    """(count, 4, 3): the leaf, turned, scaled and moved."""
    rng = np.random.default_rng(seed)
    made = [
        rng.uniform(0.5, 2.0) * shape @ random_rotation(rng).T + rng.normal(size=3) * 3 for _ in range(count)
    ]
    return np.array(made, dtype=np.float32)


def placed(kind, prototype):
    """(M, N, 3): the points of a Kind's instances; prototype (N, 3)."""
    turned = np.einsum("lij,nj->lni", kind.rotations, prototype - kind.origin)
    return kind.origins[:, None] + kind.scales[:, None, None] * turned


# -- leaves ---------------------------------------------------------------------------------------------


def test_leaves_of_one_shape_are_instances_of_one_prototype():
    points = leaves(200)
    (kind,), left = instances.kinds_of(quads_surface(points), JOINTS)
    assert not left.any() and len(kind.scales) == 200
    assert np.abs(placed(kind, points[0]) - points).max() < 1e-5
    assert (kind.joints == 2).all() and kind.triangles.tolist() == [0, 1]


def test_flat_leaves_are_turned_and_never_mirrored():
    flat = LEAF * (1, 1, 0)
    points = leaves(50, flat)
    (kind,), _left = instances.kinds_of(quads_surface(points), JOINTS)
    assert np.abs(placed(kind, points[0]) - points).max() < 1e-5
    assert np.linalg.det(kind.rotations) == pytest.approx(np.ones(50))


def test_two_shapes_are_two_prototypes():
    points = np.concatenate([leaves(30), leaves(20, LEAF * (1, 3, 1), seed=2)])
    kinds, left = instances.kinds_of(quads_surface(points), JOINTS)
    assert sorted(len(kind.scales) for kind in kinds) == [20, 30] and not left.any()


def lit(points, normals):
    """The Surface of leaves (N, 4, 3) whose corners have these normals (N, 3)."""
    made = quads_surface(points)
    made.normals = np.repeat(normals, 4, axis=0).astype(np.float32)
    return made


def test_leaves_lit_as_one_ball_are_no_instances():
    points = leaves(40)
    middle = points.mean(axis=(0, 1))
    outwards = triangle_mesh.unit(points.mean(axis=1) - middle)
    kinds, left = instances.kinds_of(lit(points, outwards), JOINTS)
    assert kinds == [] and left.all()


def test_normals_that_turn_with_their_leaves_keep_the_instances():
    points = leaves(40)
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    (kind,), left = instances.kinds_of(lit(points, triangle_mesh.unit(across)), JOINTS)
    assert len(kind.scales) == 40 and not left.any()


def many_shapes(count):
    """Five leaves of each shape."""
    shapes = np.random.default_rng(1).uniform(size=(count, 4, 3))
    return np.concatenate([leaves(5, shape, seed) for seed, shape in enumerate(shapes)])


def test_leaves_beyond_the_limit_of_shapes_are_left():
    most = instances.MAX_KINDS
    kinds, left = instances.kinds_of(quads_surface(many_shapes(most + 1)), JOINTS)
    assert len(kinds) == most and left.sum() == 10 and left[10 * most :].all()


def test_a_prototype_begins_at_the_point_nearest_to_its_bone():
    shape = LEAF + (0.0, 0.0, 2.1)  # the bone of joint 2 goes from (0, 0, 2) to (0, 0, 2.5)
    (kind,), _left = instances.kinds_of(quads_surface(shape[None].astype(np.float32)), JOINTS)
    assert kind.origin == pytest.approx((0.0, 0.0, 2.1))


# -- wind -----------------------------------------------------------------------------------------------


def test_wind_groups_are_the_levels_of_limbs():
    said = wind_json.wind_data(JOINTS, ["a", "b", "c"])
    assert said["Joints"] == [
        {"JointName": "a", "SimulationGroupIndex": 0},
        {"JointName": "b", "SimulationGroupIndex": 0},
        {"JointName": "c", "SimulationGroupIndex": 1},
    ]
    trunk, twigs = said["SimulationGroups"]
    assert (trunk["bIsTrunkGroup"], twigs["bIsTrunkGroup"]) == (True, False)
    assert 0.0 < trunk["Influence"] < twigs["Influence"] == 1.0  # slender limbs bend further
    assert said["bIsGroundCover"] is False and said["GustAttenuation"] == 0.0


def test_a_missing_library_is_named_with_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(RuntimeError, match=r"pip install --target '/some/folder' usd-core"):
        stage.library("/some/folder")
    with pytest.raises(RuntimeError, match="usd-core"):
        stage.write(SimpleNamespace(), tmp_path / "t.usda")
    assert list(tmp_path.iterdir()) == []


# -- files ----------------------------------------------------------------------------------------------


def some_tree():
    """Three bones, a quad of bark on each, 40 leaves of one shape, a textured mask, snow, and a motion."""
    bark = quads_surface(np.float32([LEAF, LEAF + (0, 0, 1), LEAF + (0, 0, 2)]), level=np.arange(12) // 4 % 2)
    bark.joints[:, 0] = np.arange(12) // 4
    texture = tree_data.Texture("a leaf", PNG, "image/png", scale=(2.0, 3.0), offset=(0.1, 0.2))
    leaf = tree_data.Material("leaf", base=texture, normal=texture, cutoff=0.5, double_sided=True)
    turns = np.zeros((5, 3, 4))
    turns[..., 3] = 1.0
    turns[1, 2] = (0.0, 0.0, np.sin(0.2), np.cos(0.2))
    parts = [
        tree_data.Part("tree bark", [bark], [tree_data.Material("bark")]),
        tree_data.Part("leaves", [quads_surface(leaves(40))], [leaf]),
    ]
    snow_meshes = [tree_data.SnowMesh("tree bark_snow", np.eye(3, dtype=np.float32), np.array([(0, 1, 2)]))]
    motion = tree_data.Motion(np.linspace(0.0, 2.0, 5), turns)
    return tree_data.Tree("a tree", JOINTS, parts, 2, snow_meshes=snow_meshes, motion=motion)


def complaints(pxr, path):
    """The errors that USD's validators find."""
    try:
        from pxr import UsdValidation
    except ImportError:  # before 24.11
        from pxr import UsdUtils

        checker = UsdUtils.ComplianceChecker()
        checker.CheckCompliance(str(path))
        return checker.GetErrors() + checker.GetFailedChecks()
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    return [error.GetMessage() for error in context.Validate(pxr.Usd.Stage.Open(str(path)))]


@pytest.fixture
def written(tmp_path):
    """(pxr, stage, path) of some_tree as text."""
    pxr = pytest.importorskip("pxr", reason="usd-core reads USD (pip install usd-core)")
    from pxr import Usd, UsdGeom, UsdShade, UsdSkel  # noqa: F401

    path = tmp_path / "t.usda"
    files = stage.write(some_tree(), path)
    assert sorted(files) == sorted(p for p in tmp_path.rglob("*") if p.is_file())
    return pxr, Usd.Stage.Open(str(path)), path


@pytest.mark.parametrize("suffix", stage.SUFFIXES)
def test_usds_own_checks_find_nothing(tmp_path, suffix):
    pxr = pytest.importorskip("pxr", reason="usd-core reads USD (pip install usd-core)")
    stage.write(some_tree(), tmp_path / f"t{suffix}")
    assert complaints(pxr, tmp_path / f"t{suffix}") == []


def test_the_skin_at_rest_leaves_every_point_where_it_is(written):
    pxr, opened, _path = written
    skeleton = pxr.UsdSkel.Skeleton.Get(opened, "/a_tree/Skin/Skeleton")
    assert list(skeleton.GetJointsAttr().Get()) == [
        "trunk1_001",
        "trunk1_001/trunk1_001_1",
        "trunk1_001/trunk1_001_1/twig",
    ]
    cache = pxr.UsdSkel.Cache()
    cache.Populate(pxr.UsdSkel.Root.Get(opened, "/a_tree/Skin"), pxr.Usd.PrimDefaultPredicate)
    query = cache.GetSkinningQuery(opened.GetPrimAtPath("/a_tree/Skin/tree_bark"))
    rest = cache.GetSkelQuery(skeleton).ComputeSkinningTransforms(0.0)
    points = pxr.UsdGeom.Mesh.Get(opened, "/a_tree/Skin/tree_bark").GetPointsAttr().Get()
    moved = pxr.Vt.Vec3fArray(points)
    assert query.ComputeSkinnedPoints(rest, moved, 0.0)
    assert np.abs(np.array(moved) - np.array(points)).max() < 1e-6
    # A quarter of the loop later, the twig has turned about its bone, the others have not.
    posed = cache.GetSkelQuery(skeleton).ComputeSkinningTransforms(0.5 * stage.TIME_CODES_PER_SECOND)
    moved = pxr.Vt.Vec3fArray(points)
    query.ComputeSkinnedPoints(posed, moved, 0.0)
    away = np.linalg.norm(np.array(moved) - np.array(points), axis=1)
    assert away[:8].max() < 1e-6 and away[8:].max() > 0.3


def test_leaves_are_where_the_scene_has_them(written):
    pxr, opened, _path = written
    instancer = pxr.UsdGeom.PointInstancer.Get(opened, "/a_tree/leaves")
    now = pxr.Usd.TimeCode.Default()
    matrices = np.array(instancer.ComputeInstanceTransformsAtTime(now, now))
    (prototype,) = instancer.GetPrototypesRel().GetTargets()
    mesh = pxr.UsdGeom.Mesh.Get(opened, f"{prototype}/Leaf")
    points = np.c_[np.array(mesh.GetPointsAttr().Get()), np.ones(4)]
    found = (points @ matrices)[..., :3]
    # Rotations have 16 bits.
    assert np.abs(found - leaves(40)).max() < 5e-3
    joints = instancer.GetPrim().GetAttribute("primvars:unreal:naniteAssembly:bindJoints").Get()
    assert list(joints) == ["trunk1_001/trunk1_001_1/twig"] * 40


def test_leaves_that_are_no_instances_are_skinned(tmp_path):
    pxr = pytest.importorskip("pxr", reason="usd-core reads USD (pip install usd-core)")
    from pxr import Usd, UsdGeom

    tree = some_tree()
    tree.parts[1].levels[0] = quads_surface(many_shapes(instances.MAX_KINDS + 1))
    stage.write(tree, tmp_path / "t.usda")
    opened = Usd.Stage.Open(str(tmp_path / "t.usda"))
    counts = len(UsdGeom.PointInstancer.Get(opened, "/a_tree/leaves").GetPositionsAttr().Get())
    skinned = np.array(UsdGeom.Mesh.Get(opened, "/a_tree/Skin/leaves").GetPointsAttr().Get())
    assert (counts, len(skinned)) == (5 * instances.MAX_KINDS, 5 * 4)
    assert complaints(pxr, tmp_path / "t.usda") == []


def test_materials_have_their_textures_and_their_place(written):
    pxr, opened, path = written
    mesh = opened.GetPrimAtPath("/a_tree/leaves/Prototypes/Leaf0/Leaf")
    material, _ = pxr.UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
    surface_node = pxr.UsdShade.Shader(material.ComputeSurfaceSource()[0])
    assert surface_node.GetInput("opacityThreshold").Get() == 0.5
    texture = pxr.UsdShade.Shader(surface_node.GetInput("diffuseColor").GetConnectedSources()[0][0].source)
    file = texture.GetInput("file").Get()
    assert (path.parent / file.path).read_bytes() == PNG and file.resolvedPath
    place = pxr.UsdShade.Shader(texture.GetInput("st").GetConnectedSources()[0][0].source)
    assert tuple(place.GetInput("scale").Get()) == (2, 3)
    assert tuple(place.GetInput("translation").Get()) == pytest.approx((0.1, 0.2))


def test_unreal_finds_the_assembly_and_the_winds_joints(written):
    pxr, opened, path = written
    root = opened.GetDefaultPrim()
    assert root.GetMetadata("apiSchemas").GetAppliedItems() == ["NaniteAssemblyRootAPI"]
    assert root.GetAttribute("unreal:naniteAssembly:meshType").Get() == "skeletalMesh"
    (skeleton,) = root.GetRelationship("unreal:naniteAssembly:skeleton").GetTargets()
    names = [
        joint.rpartition("/")[2] for joint in opened.GetPrimAtPath(skeleton).GetAttribute("joints").Get()
    ]
    said = json.loads(path.with_name("t_wind.json").read_text())
    assert [joint["JointName"] for joint in said["Joints"]] == names


def test_units_and_snow(written):
    pxr, opened, _path = written
    assert pxr.UsdGeom.GetStageUpAxis(opened) == "Z" and pxr.UsdGeom.GetStageMetersPerUnit(opened) == 1.0
    snow = pxr.UsdGeom.Mesh.Get(opened, "/a_tree/tree_bark_snow")
    assert np.array(snow.GetPointsAttr().Get()).tolist() == np.eye(3).tolist()
    assert (opened.GetStartTimeCode(), opened.GetEndTimeCode()) == (0.0, 48.0)
