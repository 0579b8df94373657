# SPDX-License-Identifier: GPL-3.0-or-later
"""``state_NNNN``: what is read is what was written, to the last bit, or nothing."""

import numpy as np
import pytest

EDGE = 64


def state():
    """Bare ground, deep snow, the thinnest snow there is, and a negative zero."""
    height = np.zeros((EDGE, EDGE), dtype=np.float32)
    height[10:20, 5:40] = np.random.default_rng(3).random((10, 35), dtype=np.float32)
    height[0, 0], height[63, 63] = np.float32(1e-45), np.float32(-0.0)
    return {"height": height, "sums": np.arange(16) / 3.0}


@pytest.fixture
def path(addon, tmp_path):
    addon("cache.checkpoint").write(tmp_path / "state_0010", 70, state())
    return tmp_path / "state_0010"


def test_a_state_comes_back_bit_for_bit(addon, path):
    step_number, own = addon("cache.checkpoint").read(path)
    assert step_number == 70
    assert own["height"].tobytes() == state()["height"].tobytes()
    assert own["sums"].tobytes() == state()["sums"].tobytes()


def test_a_map_without_snow_comes_back(addon, tmp_path):
    bare = {"height": np.zeros((EDGE, EDGE), dtype=np.float32), "sums": np.zeros(16)}
    addon("cache.checkpoint").write(tmp_path / "state_0001", 1, bare)
    assert not addon("cache.checkpoint").read(tmp_path / "state_0001")[1]["height"].any()


@pytest.mark.parametrize("at", [300, 500, -1])
def test_a_damaged_state_is_refused_by_name(addon, path, at):
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    with pytest.raises(addon("cache.errors").CacheError, match="state_0010 cannot be read .it is damaged"):
        addon("cache.checkpoint").read(path)


def test_a_truncated_state_is_refused(addon, path):
    path.write_bytes(path.read_bytes()[:-4])
    with pytest.raises(addon("cache.errors").CacheError, match="it is damaged"):
        addon("cache.checkpoint").read(path)
