# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of the scene as USD, read back with USD's own library where it is installed."""

import bpy
import numpy as np
import pytest
from exported_tree import LEAVES, PLAIN, import_tree, rest_points, rows


def test_usd_has_the_tree_of_the_scene_or_says_what_is_missing(tmp_path, leafy):
    rig, bark = import_tree(leafy)
    path = tmp_path / "tree.usda"
    try:
        from pxr import Usd, UsdGeom
    except ImportError:
        with pytest.raises(RuntimeError, match="pip install --target .* usd-core"):
            bpy.ops.export_scene.snowbough_tree(filepath=str(path), **PLAIN)
        assert not path.exists()
        return
    assert bpy.ops.export_scene.snowbough_tree(filepath=str(path), **PLAIN) == {"FINISHED"}
    stage = Usd.Stage.Open(str(path))
    points = np.array(UsdGeom.Mesh.Get(stage, "/leafy/Skin/leafy_bark").GetPointsAttr().Get())
    assert rows(points) == rows(rest_points(bark))
    assert len(stage.GetPrimAtPath("/leafy/Skin/Skeleton").GetAttribute("joints").Get()) == len(
        rig.data.bones
    )
    instancer = UsdGeom.PointInstancer.Get(stage, "/leafy/leafy_leaves")
    assert len(instancer.GetPositionsAttr().Get()) == LEAVES
