# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of snow surfaces (snowbough.surface): recorded, computed from the cache alone, refused if damaged, and
unchanged if an update stops. Without Blender."""

import contextlib
import os
from types import SimpleNamespace

import numpy as np
import pytest
import snowbough_native as native
from cache_files import write_bake, written
from snowbough.cache import files
from snowbough.cache.errors import CacheError
from snowbough.surface import compute, mesh_file, neighbours, point_cache, recording
from snowbough.surface.style import DETAILS, SurfaceStyle, WantedPoints, patchy_points, shared_out

SIZE = 64
DEPTHS = (0.02, 0.05, 0.1)
CORNERS = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
UV = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
SURFACE_FILES = (files.SURFACE_FACES, files.SURFACE_POINTS, files.SURFACE)


class Topology(SimpleNamespace):
    """Of a square, or of one that is cut the other way."""

    def __init__(self, triangles=TRIANGLES, shading=None):
        super().__init__(triangles=triangles, corner_uv=UV[triangles], shading=shading)

    def is_same(self, other):
        return np.array_equal(self.triangles, other.triangles)


SQUARE = Topology()


def pose(local=CORNERS, topology=SQUARE):
    return SimpleNamespace(local=local, topology=topology)


def record(folder, poses):
    recorder = recording.ReceiverRecorder(folder)
    for frame, obj in enumerate(poses, 1):
        recorder.add(frame, obj)
    recorder.finish()
    recorder.close()
    return recorder


def baked(folder, poses=None, matrices=None, frames=DEPTHS):
    """A receiver's folder as a bake of a level square leaves it."""
    folder.mkdir(parents=True, exist_ok=True)
    record(folder, poses or [pose()] * len(frames))
    entries = []
    for index, depth in enumerate(frames):
        native.write_exr(
            str(folder / files.frame_file("height", index + 1)), np.full((SIZE, SIZE), depth, np.float32)
        )
        matrix = np.eye(4) if matrices is None else matrices[index]
        entries.append(
            {
                "frame": index + 1,
                "depth": depth,
                "to_world": matrix.ravel().tolist(),
                "direction": [0.0, 0.0, -1.0],
            }
        )
    bake = written(frames=range(1, len(frames) + 1))
    write_bake(folder, {**bake, "label": "Card"}, entries)
    return folder


@pytest.fixture
def folder(tmp_path):
    return baked(tmp_path / "card")


def content(folder, names=None):
    return {name: (folder / name).read_bytes() for name in names or sorted(os.listdir(folder))}


def mesh_of(count=3, smooth=None):
    """Quads and two triangles of random numbers."""
    numbers = np.random.default_rng(4)
    return mesh_file.FileMesh(
        numbers.random((9, 3), np.float32),
        numbers.integers(0, 9, (count, 4)).astype(np.int32),
        numbers.integers(0, 9, (2, 3)).astype(np.int32),
        numbers.random((count, 4, 2), np.float32),
        numbers.random((2, 3, 2), np.float32),
        smooth,
    )


# -- The receivers beside ---------------------------------------------------------------------------------


def beside(metres):
    return np.array([[1, 0, 0, metres], [0, 1, 0, 0], [0, 0, 1, -0.05], [0, 0, 0, 1]], np.float32)


def test_what_stands_near_is_found_with_its_snow(folder):
    baked(folder.parent / "ground", matrices=[beside(2.02)] * 3)
    baked(folder.parent / "far", matrices=[beside(9.0)] * 3)
    ((triangles, uv, positions, height),) = neighbours.near(native, folder)
    assert np.array_equal(triangles, TRIANGLES) and uv.shape == (2, 3, 2)
    assert positions[:, 0].min() == pytest.approx(1.02)
    assert (height == np.float32(DEPTHS[-1])).all()


def test_what_moves_during_the_shot_has_no_neighbours_and_is_none(folder):
    moving = baked(folder.parent / "cart", matrices=[beside(0.1 * k) for k in range(3)])
    assert neighbours.near(native, folder) == [] == neighbours.near(native, moving)


def test_a_damaged_neighbour_is_left_out(folder):
    other = baked(folder.parent / "ground", matrices=[beside(2.02)] * 3)
    (other / files.RECEIVER).write_bytes(b"ply")
    assert neighbours.near(native, folder) == []


# -- PC2 ------------------------------------------------------------------------------------------------


def test_a_point_cache_comes_back(tmp_path):
    samples = np.random.default_rng(1).random((3, 5, 3), np.float32)
    with point_cache.PointCacheWriter(tmp_path / "a.pc2", 5) as cache:
        for sample in samples:
            cache.add(sample)
        cache.publish()
    assert np.array_equal(point_cache.read_point_cache(tmp_path / "a.pc2"), samples)
    assert os.listdir(tmp_path) == ["a.pc2"]


def test_a_point_cache_is_what_blender_reads(tmp_path):
    with point_cache.PointCacheWriter(tmp_path / "a.pc2", 1) as cache:
        cache.add(np.array([(1.0, 2.0, 3.0)]))
        cache.publish()
    expected = b"POINTCACHE2\0" + np.array([1, 1], "<i4").tobytes() + np.array([0, 1], "<f4").tobytes()
    expected += np.array([1], "<i4").tobytes() + np.array([1, 2, 3], "<f4").tobytes()
    assert (tmp_path / "a.pc2").read_bytes() == expected


def test_a_point_cache_that_is_not_published_leaves_what_was_there(tmp_path):
    (tmp_path / "a.pc2").write_bytes(b"before")
    with point_cache.PointCacheWriter(tmp_path / "a.pc2", 2) as cache:
        cache.add(np.zeros((2, 3)))
    assert content(tmp_path) == {"a.pc2": b"before"}


def test_a_sample_of_another_size_is_refused_and_leaves_nothing(tmp_path):
    with (
        pytest.raises(ValueError, match="a.pc2 has 2 points, not 3"),
        point_cache.PointCacheWriter(tmp_path / "a.pc2", 2) as cache,
    ):
        cache.add(np.zeros((3, 3)))
    assert os.listdir(tmp_path) == []


def test_a_point_cache_in_a_folder_that_is_not_there_names_it(tmp_path):
    with pytest.raises(CacheError, match="gone.a.pc2 could not be written: No such file"):
        point_cache.PointCacheWriter(tmp_path / "gone" / "a.pc2", 1)


@contextlib.contextmanager
def small_files():
    """Files of this process cannot grow beyond 64 bytes, the test's own report included."""
    resource = pytest.importorskip("resource", reason="needs limits of processes")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_point_cache_that_cannot_grow_is_removed(tmp_path):
    with (
        small_files(),
        pytest.raises(CacheError, match="a.pc2 could not be written: File too large"),
        point_cache.PointCacheWriter(tmp_path / "a.pc2", 3) as cache,
    ):
        cache.add(np.zeros((3, 3)))  # 32 and 36 bytes, written at the end
        cache.publish()
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("length", [0, 10, 32, 40, 67])
def test_a_point_cache_cut_short_is_refused(tmp_path, length):
    path = tmp_path / "a.pc2"
    with point_cache.PointCacheWriter(path, 3) as cache:
        cache.add(np.zeros((3, 3)))
        cache.publish()
    whole = path.read_bytes()
    assert len(whole) == 32 + 36
    path.write_bytes(whole[:length])
    with pytest.raises(CacheError, match="a.pc2 cannot be read .*free the bake, then bake again"):
        point_cache.read_point_cache(path)


def test_a_file_of_another_kind_is_no_point_cache(tmp_path):
    (tmp_path / "a.pc2").write_bytes(b"ply\n" + bytes(64))
    with pytest.raises(CacheError, match="it is not a PC2 file"):
        point_cache.read_point_cache(tmp_path / "a.pc2")


# -- PLY ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "count, smooth", [(0, None), (3, None), (0, np.array([(0, 1, -1), (2, 1, 0)], np.int32))]
)
def test_a_mesh_comes_back(tmp_path, count, smooth):
    mesh = mesh_of(count, smooth)
    mesh_file.write_mesh(tmp_path / "a.ply", mesh)
    read = mesh_file.read_mesh(tmp_path / "a.ply")
    for name in ("positions", "quads", "triangles", "quad_uv", "triangle_uv", "smooth"):
        assert np.array_equal(getattr(read, name), getattr(mesh, name)), name
    assert os.listdir(tmp_path) == ["a.ply"]


def test_corners_and_sides_of_a_mesh_go_through_quads_first():
    mesh = mesh_of(1)
    assert mesh.sides.tolist() == [4, 3, 3]
    assert mesh.corners.tolist() == [*mesh.quads.ravel(), *mesh.triangles.ravel()]
    assert mesh.corner_uv.shape == (10, 2)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.99])
def test_a_mesh_cut_short_is_refused(tmp_path, part):
    path = tmp_path / "a.ply"
    mesh_file.write_mesh(path, mesh_of())
    whole = path.read_bytes()
    path.write_bytes(whole[: int(part * len(whole))])
    with pytest.raises(CacheError, match="a.ply cannot be read .*bake again, or use Update Surface"):
        mesh_file.read_mesh(path)


@pytest.mark.parametrize("corner", [-1, 9])
def test_a_mesh_whose_faces_name_no_points_is_refused(tmp_path, corner):
    mesh = mesh_of()
    mesh.triangles[1, 2] = corner
    mesh_file.write_mesh(tmp_path / "a.ply", mesh)
    with pytest.raises(CacheError, match="a.ply cannot be read .*a face refers to missing points"):
        mesh_file.read_mesh(tmp_path / "a.ply")


# -- recording ------------------------------------------------------------------------------------------


def test_a_receiver_that_stands_still_is_recorded_once(tmp_path):
    record(tmp_path, [pose(), pose(CORNERS.copy()), pose()])
    assert np.array_equal(point_cache.read_point_cache(tmp_path / files.POSITIONS), CORNERS[None])
    mesh = mesh_file.read_mesh(tmp_path / files.RECEIVER)
    assert np.array_equal(mesh.triangles, TRIANGLES)
    assert np.array_equal(mesh.triangle_uv, UV[TRIANGLES])


def test_a_receiver_that_deforms_later_is_recorded_in_every_frame(tmp_path):
    bent = CORNERS + np.array([(0, 0, 0.1), (0, 0, 0), (0, 0, 0), (0, 0, 0)], np.float32)
    record(tmp_path, [pose(), pose(), pose(bent)])
    assert np.array_equal(
        point_cache.read_point_cache(tmp_path / files.POSITIONS), np.stack([CORNERS, CORNERS, bent])
    )
    assert np.array_equal(mesh_file.read_mesh(tmp_path / files.RECEIVER).positions, bent)


def test_a_receiver_that_changes_its_faces_leaves_no_files(tmp_path):
    other = Topology(TRIANGLES[:1])
    recorder = record(tmp_path, [pose(), pose(2 * CORNERS), pose(topology=other), pose(topology=other)])
    assert recorder.changed_at == 3
    assert os.listdir(tmp_path) == []


def test_a_recording_that_is_not_finished_leaves_no_files(tmp_path):
    recorder = recording.ReceiverRecorder(tmp_path)
    recorder.add(1, pose())
    recorder.add(2, pose(2 * CORNERS))
    recorder.close()
    assert os.listdir(tmp_path) == []


# -- computing ------------------------------------------------------------------------------------------


def test_points_begin_with_a_sample_without_snow_and_then_have_one_a_frame(folder):
    assert compute.update(native, folder, SurfaceStyle(relief=0.0))
    samples = point_cache.read_point_cache(folder / files.SURFACE_POINTS)
    assert len(samples) == 1 + len(DEPTHS)
    inside = (abs(samples[-1, :, :2]) < 0.7).all(axis=1)
    assert inside.sum() > 50
    assert samples[0, :, 2].max() <= 0.0
    for sample, depth in zip(samples[1:], DEPTHS):
        assert sample[inside, 2] == pytest.approx(depth, abs=0.002)


def test_the_faces_are_those_of_the_points(folder):
    compute.update(native, folder, SurfaceStyle())
    mesh = mesh_file.read_mesh(folder / files.SURFACE_FACES)
    samples = point_cache.read_point_cache(folder / files.SURFACE_POINTS)
    assert np.array_equal(mesh.positions, samples[-1])
    assert compute.read_summary(folder)["points"] == len(mesh.positions)


def test_the_summary_says_with_what_a_surface_was_made(folder):
    style = SurfaceStyle("DRAFT", overhang=0.5)
    compute.update(native, folder, style)
    summary = compute.read_summary(folder)
    assert (summary["style"], summary["first"], summary["frames"]) == (style.as_dict(), 1, 3)


def test_the_same_bake_gives_the_same_bytes(tmp_path):
    written = []
    for name in "ab":
        folder = baked(tmp_path / name)
        compute.update(native, folder, SurfaceStyle())
        written.append(content(folder))
    assert written[0] == written[1]


def test_a_receiver_that_moves_as_a_whole_keeps_its_snow_in_its_own_space(tmp_path):
    moved = np.eye(4)
    moved[:2, :2] = ((0.6, -0.8), (0.8, 0.6))
    moved[:3, 3] = (5.0, 0.0, 1.0)
    still, moving = baked(tmp_path / "still"), baked(tmp_path / "moving", matrices=[moved] * 3)
    for folder in (still, moving):
        compute.update(native, folder, SurfaceStyle(hem_variation=0.0, relief=0.0))
    heights = [
        point_cache.read_point_cache(f / files.SURFACE_POINTS)[-1][:, 2].max() for f in (still, moving)
    ]
    assert heights[0] == pytest.approx(heights[1], abs=0.002)
    assert abs(point_cache.read_point_cache(moving / files.SURFACE_POINTS)[-1][:, :2]).max() < 1.1


def test_a_receiver_that_deforms_carries_its_snow_along(tmp_path):
    raised = [CORNERS + np.array((0, 0, up), np.float32) for up in (0.0, 0.5, 1.0)]
    folder = baked(tmp_path / "card", poses=[pose(local) for local in raised])
    compute.update(native, folder, SurfaceStyle(relief=0.0))
    samples = point_cache.read_point_cache(folder / files.SURFACE_POINTS)
    inside = (abs(samples[-1, :, :2]) < 0.7).all(axis=1)
    for sample, depth, up in zip(samples[1:], DEPTHS, (0.0, 0.5, 1.0)):
        assert sample[inside, 2] == pytest.approx(up + depth, abs=0.002)


def test_an_update_that_is_stopped_half_way_leaves_files_as_before(folder):
    compute.update(native, folder, SurfaceStyle())
    before = content(folder)
    asked = []

    def stop(share):
        asked.append(share)
        return len(asked) < 2

    assert compute.update(native, folder, SurfaceStyle(overhang=0.0), stop) is False
    plan = compute.PLAN
    assert asked == pytest.approx([plan / (plan + 3), (plan + 1) / (plan + 3)])
    assert content(folder) == before


def test_an_update_that_may_not_write_leaves_files_as_before(folder):
    compute.update(native, folder, SurfaceStyle())
    before = content(folder)

    def refuse():
        raise CacheError("another bake has the lock")

    with pytest.raises(CacheError, match="lock"):
        compute.update(native, folder, SurfaceStyle(overhang=0.0), check=refuse)
    assert content(folder) == before


def test_a_missing_map_stops_an_update_and_leaves_files_as_before(folder):
    compute.update(native, folder, SurfaceStyle())
    (folder / files.frame_file("height", 2)).unlink()
    before = content(folder)
    with pytest.raises(CacheError, match="height_0002.exr.*Bake again"):
        compute.update(native, folder, SurfaceStyle(overhang=0.0))
    assert content(folder) == before


def test_sliders_change_points_and_not_faces(folder):
    compute.update(native, folder, SurfaceStyle())
    before = mesh_file.read_mesh(folder / files.SURFACE_FACES)
    compute.update(native, folder, SurfaceStyle(overhang=0.0))
    after = mesh_file.read_mesh(folder / files.SURFACE_FACES)
    assert np.array_equal(before.corners, after.corners)
    assert not np.array_equal(before.positions, after.positions)


def test_a_folder_without_a_bake_says_so(tmp_path):
    with pytest.raises(compute.NoSurface, match="contains no bake: bake the snow first"):
        compute.update(native, tmp_path, SurfaceStyle())


def test_a_bake_without_a_recorded_receiver_says_what_to_do(folder):
    (folder / files.RECEIVER).unlink()
    with pytest.raises(compute.NoSurface, match="'Card' was baked by an earlier version.*bake it again"):
        compute.update(native, folder, SurfaceStyle())


def test_positions_of_another_shot_are_refused(folder):
    with point_cache.PointCacheWriter(folder / files.POSITIONS, 4) as cache:
        cache.add(CORNERS)
        cache.add(CORNERS)
        cache.publish()
    with pytest.raises(CacheError, match="positions.pc2 does not match its bake"):
        compute.update(native, folder, SurfaceStyle())


def test_a_damaged_summary_is_refused(folder):
    compute.update(native, folder, SurfaceStyle())
    path = folder / files.SURFACE
    path.write_bytes(path.read_bytes().replace(b'"frames": 3', b'"frames": 4'))
    with pytest.raises(CacheError, match=r"surface.json is damaged .*Use Update Surface"):
        compute.read_summary(folder)
    path.unlink()
    assert compute.read_summary(folder) is None


def test_every_file_of_a_surface_is_listed_by_the_bake(folder):
    compute.update(native, folder, SurfaceStyle())
    assert set(os.listdir(folder)) <= set(files.bake_files(1, 3))
    assert set(SURFACE_FILES) <= set(os.listdir(folder))


def test_while_there_are_points_for_all_a_receiver_may_have_more_than_it_wants():
    shares = shared_out({"bench": (10_000.0, 0.0), "yard": (0.0, 90_000.0)})
    assert shares["bench"].most(*DETAILS["DEFAULT"]) == 25_000
    assert shares["yard"].most(*DETAILS["DEFAULT"]) == 225_000


def test_hems_come_before_level_places():
    shares = shared_out({"bench": (200_000.0, 0.0), "yard": (0.0, 500_000.0)})
    assert shares["bench"].most(*DETAILS["DEFAULT"]) == 200_000
    assert shares["yard"].most(*DETAILS["DEFAULT"]) == 50_000


def test_the_banks_of_a_mask_get_points_beside_a_large_ground():
    wanted = {"yard": (4_000.0, 2_000.0), "ground": (0.0, 270_000.0)}
    bare = shared_out(wanted)["yard"].most(*DETAILS["DEFAULT"])
    masked = shared_out({**wanted, "yard": patchy_points(*wanted["yard"])})["yard"].most(*DETAILS["DEFAULT"])
    assert bare < 7_000 and masked > 20_000
    assert patchy_points(0.0, 1e6) == (40_000.0, 1e6)


def test_with_too_few_points_for_hems_all_receivers_have_the_same_share_of_them():
    shares = shared_out({"bench": (300_000.0, 0.0), "yard": (100_000.0, 1_900_000.0)})
    assert shares["bench"].most(*DETAILS["DEFAULT"]) == 187_500
    assert shares["yard"].most(*DETAILS["DEFAULT"]) == 62_500


def test_a_surface_has_as_many_points_as_it_wants_and_may_have():
    shares = shared_out({"bench": (10_000.0, 2_000.0), "yard": (0.0, 900_000.0)})
    assert shares["bench"].expected("DEFAULT") == shares["bench"].most(*DETAILS["DEFAULT"]) < 12_000
    assert shares["yard"].expected("DEFAULT") == shares["yard"].most(*DETAILS["DEFAULT"]) < 250_000
    assert shared_out({"bench": (10_000.0, 2_000.0)})["bench"].expected("FILM") == pytest.approx(
        12_000 / 0.36
    )


def test_a_finer_detail_wants_more_points():
    shares = shared_out({"bench": (200_000.0, 0.0), "yard": (0.0, 1_000_000.0)})
    assert shares["bench"].most(*DETAILS["FILM"]) == pytest.approx(200_000 / 0.36, abs=1)
    assert shares["bench"].most(*DETAILS["FILM"]) + shares["yard"].most(*DETAILS["FILM"]) <= 1_000_000


def test_every_receiver_may_have_some_points():
    assert WantedPoints(0.0, 0.0, 1e6, 1e6).most(*DETAILS["DRAFT"]) == 400
    assert WantedPoints().most(*DETAILS["DRAFT"]) == 60_000
