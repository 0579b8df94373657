# SPDX-License-Identifier: GPL-3.0-or-later
"""Detailed trees as the benchmark measures them: limbs turn little from face to face."""

import subprocess
import sys
from pathlib import Path

import pytest
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[3]
TREES = ROOT.parent / "shared" / "data" / "trees"
sys.path.append(str(ROOT / "benchmarks" / "tree"))
import detail  # noqa: E402


def sharpest_turn(path):
    skeleton = native.read_tree(str(path))
    mesh = native.build_tree_mesh(skeleton, detail="DEFAULT")
    return detail.turn_angles(mesh, detail.Forks(list(skeleton.branches))).max()


@pytest.mark.parametrize("name", ["squares/BL02A_squares_tris", "tubes/BL02A_Betula_lenta", "tubes/AL06a"])
def test_limbs_of_real_trees_turn_by_less_than_25_degrees(name):
    path = TREES / f"{name}.obj"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    assert sharpest_turn(path) < 25


@pytest.mark.parametrize("seed", [1, 2])
def test_dense_whorls_leave_no_steps_between_them(tmp_path, seed):
    path = tmp_path / "spruce.obj"
    grow = [sys.executable, str(ROOT / "blend_samples" / "grow_tree.py"), "--species", "spruce"]
    subprocess.run([*grow, "--seed", str(seed), str(path)], check=True, stdout=subprocess.DEVNULL)
    assert sharpest_turn(path) < 25
