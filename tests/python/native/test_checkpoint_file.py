"""The checkpoint's format: reading returns the written bits, or an error."""

import numpy as np
import pytest
import snowbough_native
from checkpoints import save

EDGE = 64


def state():
    """Bare ground, deep snow, snow on a back side, the thinnest snow there is, and a negative zero."""
    height = np.zeros((EDGE, EDGE), dtype=np.float32)
    height[10:20, 5:40] = np.random.default_rng(3).random((10, 35), dtype=np.float32) - 0.5
    height[0, 0], height[63, 63] = np.float32(1e-45), np.float32(-0.0)
    return {"step_number": 70, "objects": {"ground": {"height": height, "sums": np.arange(16) / 3.0}}}


@pytest.fixture
def path(tmp_path):
    snowbough_native.write_checkpoint(str(tmp_path / "state_0010"), state(), "whose it is")
    return tmp_path / "state_0010"


def test_a_state_comes_back_bit_for_bit(path):
    read = snowbough_native.read_checkpoint(str(path))
    own, expected = read["objects"]["ground"], state()["objects"]["ground"]
    assert read["step_number"] == 70
    assert read["description"] == "whose it is"
    assert own["height"].tobytes() == expected["height"].tobytes()
    assert own["sums"].tobytes() == expected["sums"].tobytes()


def test_a_map_without_snow_takes_next_to_nothing(tmp_path):
    bare = {"height": np.zeros((1024, 1024), dtype=np.float32), "sums": np.zeros(16)}
    path = tmp_path / "state_0001"
    snowbough_native.write_checkpoint(str(path), {"step_number": 1, "objects": {"ground": bare}})
    assert path.stat().st_size < 2000
    assert not snowbough_native.read_checkpoint(str(path))["objects"]["ground"]["height"].any()


def test_the_state_of_a_simulation_comes_back(tmp_path):
    """A square metre under a step of snow: the file is read as a state of its one receiver."""
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    simulation = snowbough_native.SnowSimulation(pixel_size=0.05, engine="CPU")
    simulation.add_object("ground", triangles, corners[triangles], resolution=64)
    positions = np.column_stack([corners, np.zeros(4, dtype=np.float32)])
    simulation.step({"ground": positions}, depth=0.01, direction=(0, 0, -1), dt=0.04)
    save(simulation, tmp_path / "all")
    read = snowbough_native.read_checkpoint(str(tmp_path / "all"))
    assert read["objects"]["ground"]["height"].tobytes() == simulation.height("ground").tobytes()
    assert read["description"] == ""


@pytest.mark.parametrize("at", [20, 300, 500, -1])
def test_a_damaged_state_is_refused_by_name(path, at):
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    with pytest.raises(RuntimeError, match=r"state_0010' cannot be used"):
        snowbough_native.read_checkpoint(str(path))


def test_heights_that_are_no_square_are_refused(tmp_path):
    own = {"height": np.zeros((2, 3), dtype=np.float32), "sums": np.zeros(16)}
    with pytest.raises(ValueError, match="'ground'"):
        snowbough_native.write_checkpoint(str(tmp_path / "a"), {"step_number": 0, "objects": {"ground": own}})
    assert not (tmp_path / "a").exists()
