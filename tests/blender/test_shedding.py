# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow that leaves shed: from the list of receivers to the baked map, the preview and resuming."""

import bpy
import pytest
import snow_scene as s


def shot(folder, half_life, **values):
    """16 leaves of 0.2 m under 5 cm of snow, a metre over a ground."""
    corners, faces = [], []
    for i in range(16):
        x, y = 0.5 * (i % 4) - 0.75, 0.5 * (i // 4) - 0.75
        faces.append(tuple(range(4 * i, 4 * i + 4)))
        corners += [(x + 0.1 * a, y + 0.1 * b, 1.0) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    uv = [(0.5 + 0.48 * x, 0.5 + 0.48 * y) for x, y, _ in corners]
    leaves = s.mesh_object("Leaves", corners, faces, uv)
    s.receive(leaves, resolution=128)
    entry = bpy.context.scene.snowbough.receivers[0]
    entry.shed_half_life = half_life
    s.settings(folder, (1, 12), **{"start_depth": 0.05, "end_depth": 0.05, **values})
    return entry


def leaf_snow(native, folder, frame):
    return float(abs(s.height(native, folder, "Leaves", frame)).sum())


def test_leaves_shed_in_the_bake(native, tmp_path):
    shot(tmp_path / "sheds", 0.1)
    s.bake()
    assert leaf_snow(native, tmp_path / "sheds", 12) < 0.25 * leaf_snow(native, tmp_path / "sheds", 1)


def test_without_a_half_life_they_keep_it(native, tmp_path):
    shot(tmp_path, 0.0)
    s.bake()
    assert leaf_snow(native, tmp_path, 1) > 1.0
    assert leaf_snow(native, tmp_path, 12) == pytest.approx(leaf_snow(native, tmp_path, 1), rel=0.05)


def test_another_half_life_makes_a_bake_outdated(addon, tmp_path):
    entry = shot(tmp_path, 0.1, checkpoint_interval=2)
    s.bake_part(addon, last=4)
    entry.shed_half_life = 2.0
    with pytest.raises(RuntimeError, match="shed half life: 0.1"):
        s.bake(resume=True)
    changes = addon("bake.changes_since_bake").settings_changes(bpy.context.scene)
    assert changes == ["Leaves: sheds in 2 s, was 0.1 s"]


def test_what_cannot_land_is_named(addon, tmp_path):
    shot(tmp_path, 0.1, landing=False)
    scene = bpy.context.scene
    texts = [
        issue.text for issue in addon("bake.preflight").check(scene, bpy.context.evaluated_depsgraph_get())
    ]
    assert "'Leaves' sheds its snow, but Landing is off: what lets go lands nowhere" in texts


def test_leaves_shed_in_the_preview(addon):
    shot("//", 0.1)
    scene, live = bpy.context.scene, addon("preview.live")
    scene.frame_set(1)
    live.start(scene, bpy.context.evaluated_depsgraph_get(), draws=False)
    try:
        preview = addon("base.session").preview
        (key,) = preview.simulated.maps
        before = abs(preview.heights(key)).sum()
        for frame in range(2, 13):
            scene.frame_set(frame)
        assert abs(preview.heights(key)).sum() < 0.25 * before
    finally:
        live.stop()
