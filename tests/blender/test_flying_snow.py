# SPDX-License-Identifier: GPL-3.0-or-later
"""Flying snow: a point cloud a frame, and the object that shows it."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s


def scene(root, frames=(1, 10), **values):
    """A board 2 m over the ground tips over in the third frame."""
    ground, board = s.square("Ground", 3.0), s.square("Board", 0.6, z=2.0)
    s.receive(ground, board)
    for frame, angle in ((2, 0.0), (3, 80.0)):
        board.rotation_euler[1] = math.radians(angle)
        board.keyframe_insert("rotation_euler", frame=frame)
    wanted = {"points": True, "repose": math.radians(60.0), "start_depth": 0.05, "end_depth": 0.05, **values}
    return s.settings(root, frames, **wanted)


def points(addon, root, name, frame):
    return addon("cache.flying").read_points(s.folder_of(root, name) / f"points_{frame:04d}.ply")


def test_points_are_written_and_fall(addon, tmp_path):
    scene(tmp_path)
    s.bake()
    clouds = [points(addon, tmp_path, "Board", frame) for frame in range(1, 11)]
    assert len(clouds[0]) == 0 < len(clouds[2])
    assert clouds[2][:, 2].mean() > clouds[5][:, 2].mean() + 0.05
    known = s.manifest_of(tmp_path, "Board")["frames"][4]["checksums"]
    assert "points_0005.ply" in known


def test_points_do_not_change_the_snow(tmp_path):
    own = scene(tmp_path / "with")
    s.bake()
    with_points = s.files_of(tmp_path / "with")
    own.points, own.cache_directory = False, str(tmp_path / "without")
    s.bake()
    without = s.files_of(tmp_path / "without")
    assert not any(name.endswith(".ply") for name in without)
    maps = {name for name in without if name.endswith(".exr")}
    assert maps and all(with_points[name] == without[name] for name in maps)


def test_a_bake_with_points_goes_on_to_the_same_bytes(addon, tmp_path):
    scene(tmp_path / "whole", checkpoint_interval=3)
    whole = s.bake_twice(addon, tmp_path, last=5)
    assert any(name.endswith("points_0006.ply") for name in whole)


def test_the_object_follows_the_frames(addon, tmp_path):
    scene(tmp_path)
    s.bake()
    bpy.ops.snowbough.show_flying_snow()
    bpy.ops.snowbough.show_flying_snow()
    shown = [obj for obj in bpy.data.objects if obj.name.startswith("Flying Snow")]
    assert len(shown) == 1
    for frame in (4, 7):
        bpy.context.scene.frame_set(frame)
        cloud = np.concatenate([points(addon, tmp_path, name, frame) for name in ("Ground", "Board")])
        mesh = shown[0].data
        assert len(mesh.vertices) == len(cloud) > 0
        places = np.empty(3 * len(cloud), np.float32)
        mesh.vertices.foreach_get("co", places)
        assert (places.reshape(-1, 3) == cloud[:, :3]).all()
        velocity = np.empty(3 * len(cloud), np.float32)
        mesh.attributes["velocity"].data.foreach_get("vector", velocity)
        assert (velocity.reshape(-1, 3) == cloud[:, 3:6]).all()
    # Balls, which no bake takes for an object.
    evaluated = shown[0].evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert evaluated.data is not None
    s.bake()
    assert points(addon, tmp_path, "Board", 4) is not None


def test_without_points_the_operator_says_what_to_do(tmp_path):
    scene(tmp_path, points=False)
    s.bake()
    with pytest.raises(RuntimeError, match="switch Flying Snow on"):
        bpy.ops.snowbough.show_flying_snow()
