# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves keep the normals of their file, by which game foliage is lit as one crown: in the scene, in glTF, and in trees
that are built from selected objects."""

import bpy
import numpy as np
import pytest
from exported_tree import LEAVES, export, import_tree, y_up


def _unit(rows):
    return rows / np.linalg.norm(rows, axis=-1, keepdims=True)


@pytest.fixture
def lit(leafy):
    """The leafy maple; the normals of its leaves point away from its middle."""
    lines, normals = [], []
    places = [line.split()[1:4] for line in leafy.read_text().splitlines() if line.startswith("v ")]
    places = np.array(places, float)
    for line in leafy.read_text().splitlines():
        corners = line.split()[1:] if line.startswith("f ") else []
        if not corners or "/" not in corners[0]:
            lines.append(line)
            continue
        for corner in corners:
            # The file is Y up.
            normals.append(_unit(places[int(corner.split("/")[0]) - 1] - (0.0, 0.5, 0.0)))
            lines.append("vn %.6f %.6f %.6f" % tuple(normals[-1]))
        lines.append("f " + " ".join(f"{corner}/{k - 4}" for k, corner in enumerate(corners)))
    leafy.write_text("\n".join([*lines, ""]))
    assert len(normals) == 4 * LEAVES
    return leafy


def _outwards(points):
    return _unit(np.asarray(points, float) - (0.0, 0.0, 0.5))


def _corners(addon, obj):
    """(places, normals) of the corners, in the object's space."""
    compat, mesh = addon("base.compat"), obj.data
    return compat.read_positions(mesh)[compat.read_corner_vertices(mesh)], compat.read_corner_normals(mesh)


def test_leaves_have_the_normals_of_the_file(lit, addon):
    import_tree(lit)
    places, normals = _corners(addon, bpy.data.objects["leafy_leaves"])
    assert np.abs(normals - _outwards(places)).max() < 1e-2


def test_flat_leaves_stay_flat(leafy):
    import_tree(leafy)
    mesh = bpy.data.objects["leafy_leaves"].data
    assert not mesh.has_custom_normals and not any(polygon.use_smooth for polygon in mesh.polygons)


def test_gltf_has_them_too(lit, tmp_path):
    import_tree(lit)
    read = export(tmp_path / "tree.glb", levels=2)
    for node in read.lods(read.node("leafy_leaves_LOD0")):
        (primitive,) = read.primitives(node)
        found = read.attributes(primitive)
        if node["name"] == "leafy_leaves_LOD0":  # those of coarser levels are larger
            assert np.abs(found["NORMAL"] - y_up(_outwards(y_up_back(found["POSITION"])))).max() < 1e-2
        assert np.abs(found["NORMAL"][:, 2]).min() < 0.9  # not the flat cards' own


def y_up_back(points):
    return points[:, (0, 2, 1)] * (1, -1, 1)


def test_a_tree_from_selected_turns_them_with_its_objects(lit, addon):
    import_tree(lit)
    rig = bpy.data.objects["leafy"]
    sources = [bpy.data.objects[name] for name in ("leafy_bark", "leafy_leaves")]
    for obj in sources:
        obj.modifiers.clear()
        obj.parent = None
    bpy.data.objects.remove(rig)
    turn = np.array([(0, -2, 0), (2, 0, 0), (0, 0, 2)])  # a quarter about Z, twice as large
    for obj in sources:
        obj.matrix_world = [[*row, 0] for row in turn.tolist()] + [[0, 0, 0, 1]]
        obj.select_set(True)
    bpy.context.view_layer.update()
    before = set(bpy.data.objects)
    assert bpy.ops.snowbough.build_tree_from_selected(up_axis="Z") == {"FINISHED"}
    (leaves,) = (obj for obj in set(bpy.data.objects) - before if "leaves" in obj.name.split("_")[-1])
    places, normals = _corners(addon, leaves)
    assert np.abs(normals - _outwards(places @ turn / 4) @ turn.T / 2).max() < 1e-2
