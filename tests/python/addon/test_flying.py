# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of flying snow."""

import numpy as np
import pytest
from snowbough.cache import flying
from snowbough.cache.errors import CacheError


def points(count=5):
    return np.random.default_rng(3).random((count, 8), dtype=np.float32)


def test_points_come_back_to_the_bit(tmp_path):
    path = tmp_path / "points_0001.ply"
    for own in (points(), points(0)):
        flying.write_points(path, own)
        assert (flying.read_points(path) == own).all()


def test_a_file_begins_as_a_ply_of_named_columns(tmp_path):
    path = tmp_path / "points_0001.ply"
    flying.write_points(path, points(2))
    head = path.read_bytes().partition(b"end_header\n")[0].decode().splitlines()
    assert head[:3] == ["ply", "format binary_little_endian 1.0", "element vertex 2"]
    assert [line.split()[2] for line in head[3:]] == list(flying.COLUMNS)


def test_a_missing_file_has_no_points(tmp_path):
    assert len(flying.read_points(tmp_path / "points_0001.ply")) == 0


def test_a_damaged_file_is_refused(tmp_path):
    path = tmp_path / "points_0001.ply"
    flying.write_points(path, points())
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(CacheError, match="not a point cloud"):
        flying.read_points(path)


def test_points_fall_and_land():
    one = np.float32([[0, 0, 2, 1, 0, 0, 0.001, 0.6], [0, 0, 2, 0, 0, 0, 0.001, 0.1]])
    later = flying.moved(one, 0.2)
    assert later == pytest.approx(
        np.float32([[0.2, 0, 2 - 0.5 * 9.81 * 0.04, 1, 0, -1.962, 0.001, 0.4]]), abs=1e-6
    )
