# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees that are imported, exported and read back (tests/support/glb.py)."""

import sys

import bpy
import numpy as np
from conftest import ROOT
from mathutils import Vector
from synthetic_tree import evaluated_vertices

sys.path.insert(0, str(ROOT / "tests" / "support"))
import glb  # noqa: E402

MAPLE = ROOT / "tests" / "data" / "small_maple.obj"
LEAVES = 40
# Vertices as in the scene, without slow options.
PLAIN = {"vertices": "FLOAT", "cards": False, "texture_size": 0, "snow_cell": 0.0}


def leafy_file(folder, native):
    """Path of the maple with leaves: 40 cards on its branches, textured, with a separate mask image."""
    green = np.full((8, 8, 3), (40, 120, 20), np.uint8)
    green[:, 4:] = 255  # white where the mask is 0
    mask = np.zeros((8, 8), np.uint8)
    mask[:, :4] = 255
    native.write_png(str(folder / "green.png"), green)
    native.write_png(str(folder / "mask.png"), mask)
    (folder / "leafy.mtl").write_text("newmtl leaf\nKd 1 1 1\nmap_Kd green.png\nmap_d mask.png\n")
    text = MAPLE.read_text()
    places = [line.split()[1:] for line in text.splitlines() if line.startswith("v ")]
    places = np.array(places, float)[:, :3]
    points, cards = len(places), []
    for k, at in enumerate(places[np.linspace(400, points - 1, LEAVES).astype(int)]):
        corners = at + np.array([(0, 0, 0), (0.04, 0, 0), (0.04, 0.04, 0), (0, 0.04, 0)])
        cards += ["v %.6f %.6f %.6f" % tuple(corner) for corner in corners]
        first = points + 4 * k + 1
        cards.append("f " + " ".join(f"{first + c}/{c - 4}" for c in range(4)))
    head = ["mtllib leafy.mtl", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    path = folder / "leafy.obj"
    path.write_text("\n".join([text, *head, "g leaves", "usemtl leaf", *cards, ""]))
    return path


def import_collection(path=MAPLE, **settings):
    """The collection of an imported tree."""
    assert bpy.ops.import_scene.xfrog_tree(filepath=str(path), **settings) == {"FINISHED"}
    return bpy.data.collections[path.stem]


def assert_weighted(bark):
    for vertex in bark.data.vertices:
        assert 1 <= len(vertex.groups) <= 4
        assert abs(sum(entry.weight for entry in vertex.groups) - 1) < 1e-6


def assert_follows(bark, rig):
    """The whole bark moves with the root bone."""
    rest = evaluated_vertices(bark)
    root = next(bone for bone in rig.pose.bones if bone.parent is None)
    root.location = root.bone.matrix_local.to_3x3().inverted() @ Vector((1, 2, 3))
    assert np.allclose(evaluated_vertices(bark) - rest, (1, 2, 3), atol=1e-4)


def import_tree(path=MAPLE, **options):
    """(armature, finest bark) of an imported tree."""
    bpy.ops.import_scene.xfrog_tree(filepath=str(path), **{"max_bones": 120, **options})
    bark = bpy.context.object
    return bark.find_armature(), bark


def export(path, **options):
    options = {**PLAIN, **options}
    assert bpy.ops.export_scene.snowbough_tree(filepath=str(path), **options) == {"FINISHED"}
    assert glb.errors(path) == []
    return glb.Gltf(path)


def y_up(points):
    return np.asarray(points)[:, (0, 2, 1)] * (1, 1, -1)


def rest_points(obj):
    return np.array([vertex.co for vertex in obj.data.vertices])


def rows(*arrays):
    """A set of rows, rounded: for comparing corners that are in another order."""
    return set(map(tuple, np.round(np.concatenate(arrays, axis=1).astype(float), 4).tolist()))
