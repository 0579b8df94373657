# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep Original Surface: the file's own mesh gets the skeleton, weights, and the UV map for snow."""

import json
import subprocess
import sys

import bpy
import numpy as np
import pytest
from conftest import ROOT
from exported_tree import MAPLE, assert_follows, assert_weighted, export, import_collection
from mathutils import Quaternion
from synthetic_tree import evaluated_vertices

sys.path.insert(0, str(ROOT / "tests" / "support"))
import tube_tree  # noqa: E402

SIDES = tube_tree.SIDES


@pytest.fixture
def oak(tmp_path):
    path = tmp_path / "oak.obj"
    path.write_text(tube_tree.obj_text())
    return path


def keep(path, **settings):
    """(collection, armature, bark) of a tree that keeps its surface."""
    collection = import_collection(path, keep_surface=True, up_axis="Z", **settings)
    return collection, collection.objects[path.stem], collection.objects[f"{path.stem}_bark"]


def _limb(number):
    """The vertices of a limb of tube_tree, in the file's order."""
    count = SIDES * tube_tree.RINGS
    return slice(number * count, (number + 1) * count)


def test_the_mesh_is_that_of_the_file(oak, addon):
    _collection, _rig, bark = keep(oak)
    compat, mesh = addon("base.compat"), bark.data
    # Both sides of a seam share their vertices.
    whole = [tube_tree.tube(*limb, seam=False)[0] for limb in tube_tree.LIMBS]
    assert np.abs(compat.read_positions(mesh) - np.concatenate(whole)).max() < 1e-5
    tubes = [tube_tree.tube(*limb) for limb in tube_tree.LIMBS]
    corners = np.concatenate([t[3] + 81 * k for k, t in enumerate(tubes)]).reshape(-1)
    assert len(corners) == len(mesh.loops)
    assert [layer.name for layer in mesh.uv_layers] == ["bark", "snow", "original"]
    own = compat.read_uv(mesh.uv_layers["original"], len(mesh.loops))
    assert np.abs(own - np.concatenate([t[1] for t in tubes])[corners]).max() < 1e-5
    normals = np.concatenate([t[2] for t in tubes])[corners]
    assert np.abs(compat.read_corner_normals(mesh) - normals).max() < 1e-2
    assert [material.name for material in mesh.materials] == ["bark"]


def test_it_is_weighted_follows_its_bones_and_has_levels(oak):
    collection, rig, bark = keep(oak)
    assert_weighted(bark)
    assert_follows(bark, rig)
    levels = [item.value for item in bark.data.attributes["branch_level"].data]
    quads = tube_tree.SIDES * (tube_tree.RINGS - 1)
    assert [set(levels[quads * k : quads * (k + 1)]) for k in range(4)] == [{0}, {1}, {1}, {2}]
    report = json.loads(collection["snowbough_report"])
    assert report["meshes"] == [{"detail": "ORIGINAL", "vertices": 4 * 72, "faces": 4 * 64}]
    assert report["coverage"] > 0.95


def test_a_turned_limb_takes_its_twig_along_and_leaves_the_trunk(oak):
    _collection, rig, bark = keep(oak)
    rest = evaluated_vertices(bark)
    bone = rig.pose.bones["branch1.0"]
    bone.rotation_mode = "QUATERNION"
    bone.rotation_quaternion = Quaternion((1, 0, 0), np.radians(40))
    moved = np.linalg.norm(evaluated_vertices(bark) - rest, axis=1)
    assert moved[_limb(0)].max() < 1e-5 and moved[_limb(2)].max() < 1e-5
    first = moved[_limb(1)].reshape(tube_tree.RINGS, SIDES)
    assert first[0].max() < 0.01, "the base stays in the trunk"
    assert (np.diff(first.mean(axis=1)) > 0).all() and first[-1].min() > 1.2
    assert moved[_limb(3)].min() > 0.5


def test_the_snow_map_has_no_overlap_and_even_texels(oak, addon):
    _collection, _rig, bark = keep(oak)
    mesh, compat = bark.data, addon("base.compat")
    uv = compat.read_uv(mesh.uv_layers["snow"], len(mesh.loops)).reshape(-1, 4, 2).astype(float)
    assert 0 < uv.min() and uv.max() < 1
    texels = np.zeros((1024, 1024), int)
    centres = (np.arange(1024) + 0.5) / 1024
    areas = []
    for quad, polygon in zip(uv, mesh.polygons):
        low, high = (quad.min(axis=0) * 1024).astype(int), (quad.max(axis=0) * 1024).astype(int) + 1
        x, y = np.meshgrid(centres[low[0] : high[0]], centres[low[1] : high[1]])
        inside = np.ones(x.shape, bool)
        for a, b in zip(quad, np.roll(quad, -1, axis=0)):
            inside &= (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) > 0
        texels[low[1] : high[1], low[0] : high[0]] += inside
        areas.append(0.5 * abs(np.cross(quad[2] - quad[0], quad[3] - quad[1])) / polygon.area)
    assert texels.max() == 1
    assert np.percentile(areas, 95) < 2 * np.percentile(areas, 5)


def test_it_sways_and_goes_out_as_gltf(oak, tmp_path):
    _collection, rig, bark = keep(oak, wind_attributes=True)
    rest = evaluated_vertices(bark)
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.snowbough.add_sway() == {"FINISHED"}
    bpy.context.scene.frame_set(40)
    assert np.abs(evaluated_vertices(bark) - rest).max() > 0.02
    read = export(tmp_path / "oak.glb", levels=3)
    (primitive,) = read.primitives(read.node("oak_bark_LOD0"))
    found = read.attributes(primitive)
    assert len(read.array(primitive["indices"])) == 3 * 2 * 4 * 64
    assert {"TEXCOORD_2", "_PIVOT"} <= set(found)
    assert read.lods(read.node("oak_bark_LOD0")) == [read.node("oak_bark_LOD0")]


def speedtree_xml(path, pieces=4, scale=100.0):
    """Raw XML of SpeedTree for tube_tree: bones in centimetres, Y up, with decimal commas."""
    bones = []
    for number, (root, direction, length, radius) in enumerate(tube_tree.LIMBS):
        root, direction = np.array(root, float), np.array(direction, float)
        direction *= length / np.linalg.norm(direction)
        for piece in range(pieces):
            start, end = (root + direction * ((piece + k) / pieces) for k in (0, 1))
            # Limbs 1 and 2 leave the trunk, the twig the first limb.
            parent = len(bones) - 1 if piece else (-1, 1, 2, 5)[number]
            places = {"Start": start, "End": end}
            numbers = {"Radius": radius * (1 - 0.8 * piece / pieces) * scale}
            for place, (x, y, z) in places.items():
                numbers |= {f"{place}{axis}": scale * v for axis, v in zip("XYZ", (x, z, -y))}
            text = " ".join(f'{key}="{value:.4f}"'.replace(".", ",") for key, value in numbers.items())
            bones.append(f'<Bone ID="{len(bones)}" ParentID="{parent}" {text} Generator="Limb {number}" />')
    path.write_text("\n".join(["<SpeedTreeRaw><Bones>", *bones, "</Bones></SpeedTreeRaw>"]))
    return len(bones)


def test_bones_of_speedtree_become_the_skeleton(oak, tmp_path):
    xml = tmp_path / "oak.xml"
    count = speedtree_xml(xml)
    collection = import_collection(oak, bones=str(xml), up_axis="Z", simplify="NONE")
    rig, bark = collection.objects["oak"], collection.objects["oak_bark"]
    assert json.loads(collection["snowbough_report"])["form"] == "SPEEDTREE_BONES"
    assert len(rig.data.bones) == count
    assert len([bone for bone in rig.data.bones if bone.parent is None]) == 1
    heads = np.array([bone.head_local for bone in rig.data.bones])
    for root, direction, length, _radius in tube_tree.LIMBS:
        middle = np.array(root) + 0.5 * length * np.array(direction) / np.linalg.norm(direction)
        assert np.linalg.norm(heads - middle, axis=1).min() < 1e-3
    # Each limb's tip follows its own last bone.
    assert_weighted(bark)
    for number in range(4):
        tip = bark.data.vertices[_limb(number).stop - 1]
        strongest = max(tip.groups, key=lambda group: group.weight).group
        assert bark.vertex_groups[strongest].name == f"Limb_{number}.3"
    assert_follows(bark, rig)


def test_bones_of_another_tree_are_refused(oak, tmp_path):
    xml = tmp_path / "other.xml"
    speedtree_xml(xml, scale=17.0)
    with pytest.raises(RuntimeError, match="do not lie in the wood"):
        bpy.ops.import_scene.xfrog_tree(filepath=str(oak), bones=str(xml))


def test_planes_across_limbs_are_no_surface():
    with pytest.raises(RuntimeError, match="without Keep Original Surface"):
        bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE), keep_surface=True)


def _stump():
    """A mesh object: a gnarled block, Z up."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=0.5)
    stump = bpy.context.object
    stump.name = "Stump"
    rng = np.random.default_rng(2)
    for vertex in stump.data.vertices:
        vertex.co *= rng.uniform(0.8, 1.3)
    return stump


def test_a_stump_is_refused_with_advice_and_can_be_kept():
    stump = _stump()
    with pytest.raises(RuntimeError, match="carries snow as it is"):
        bpy.ops.snowbough.build_tree_from_selected()
    assert bpy.ops.snowbough.build_tree_from_selected(keep_surface=True) == {"FINISHED"}
    bark = bpy.context.object
    rig = bark.find_armature()
    assert len(bark.data.vertices) == len(stump.data.vertices)
    assert bark.name.startswith("Stump") and {bone.name.split(".")[0] for bone in rig.data.bones} == {"trunk"}
    assert_weighted(bark)
    assert_follows(bark, rig)


def test_selected_objects_keep_their_surface_where_they_stand(oak):
    bpy.ops.wm.obj_import(filepath=str(oak), forward_axis="Y", up_axis="Z")
    for obj in bpy.context.scene.objects:
        obj.location.x += 3.0
        obj.select_set(True)
    bpy.context.view_layer.update()
    wanted = [
        np.array([obj.matrix_world @ v.co for v in obj.data.vertices]) for obj in bpy.context.scene.objects
    ]
    assert bpy.ops.snowbough.build_tree_from_selected(keep_surface=True) == {"FINISHED"}
    bark = bpy.context.object
    found = evaluated_vertices(bark)
    wanted = np.concatenate(wanted)
    away = np.linalg.norm(found[:, None] - wanted[None], axis=2)
    assert away.min(axis=1).max() < 1e-5 and away.min(axis=0).max() < 1e-5


# -- coverage -------------------------------------------------------------------------------------------


def test_short_tubes_whose_ends_coincide_are_one_limb_each(tmp_path):
    path = tmp_path / "creator.obj"
    path.write_text(tube_tree.short_tubes_text())
    report = json.loads(import_collection(path, up_axis="Z")["snowbough_report"])
    assert report["branches"] == 4 and report["height"] == pytest.approx(6.0, abs=0.01)
    assert report["coverage"] > 0.95


def _spiky(path):
    """A trunk and limbs of which most wood is a thick block that is no limb."""
    text = tube_tree.obj_text()
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (60, 3)) + (0, 0, 8)
    first = text.count("\nv ") + 1
    lines = ["v %.6f %.6f %.6f" % tuple(p) for p in points]
    lines += ["g trunk_knot_wood"]
    lines += [f"f {first + k} {first + (k * 7 + 1) % 60} {first + (k * 11 + 2) % 60}" for k in range(60)]
    path.write_text(text + "\n".join([*lines, ""]))
    return path


def test_a_tree_that_lacks_most_of_its_wood_ends_with_its_own_exit_code(tmp_path):
    path = _spiky(tmp_path / "spiky.obj")
    command = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P"]
    command += [str(ROOT / "addon" / "snowbough" / "cli.py"), "--", "import", str(path), "--up-axis", "Z"]
    if not bpy.app.binary_path:
        pytest.skip("Blender as a Python module has no program to start")
    ended = subprocess.run([*command, "--json", str(tmp_path / "r.json")], capture_output=True, text=True)
    assert ended.returncode == 8, ended.stdout + ended.stderr
    assert "the limbs represent only" in ended.stdout and "Keep Original Surface" in ended.stdout
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["coverage"] < 0.75
    kept = subprocess.run([*command, "--keep-surface"], capture_output=True, text=True)
    assert kept.returncode == 0, kept.stdout + kept.stderr
