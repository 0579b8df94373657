# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every benchmark that the manual names in its smallest form: whether it runs, not how fast."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "benchmarks"
BLENDER = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P"]
WINDOW = [
    "xvfb-run", "-a", "-s", "-screen 0 640x400x24",
    "blender", "--factory-startup", "--window-geometry", "0", "0", "640", "400", "-P",
]  # fmt: skip
PYTHON = [sys.executable]

# Program that runs it, its arguments, and a pattern in its output. OUT is a folder for its files.
SMALLEST = {
    "realtime/tables.py": (PYTHON, ["--quick", "--size", "160", "90"], r"\| \d"),
    "realtime/flight.py": (PYTHON, ["--every", "100", "--out", "OUT/flight.png"], r"\d"),
    "realtime/figures.py": (PYTHON, ["--only", "tree_levels", "--out", "OUT"], r""),
    "realtime/preview.py": (WINDOW, ["--", "--resolution", "64", "--frames", "3"], r"\| draw handler \| \d"),
    "snow/thesis_mapping.py": (PYTHON, ["--steps", "1", "--only", "plane"], r"\| .*\d"),
    "snow/receivers.py": (PYTHON, ["--count", "2", "--resolution", "64"], r"[0-9a-f]{64}"),
    "snow/reacting.py": (PYTHON, ["--steps", "3", "--only", "Granular"], r"\| .*\d"),
    "snow/real_shapes.py": (BLENDER, ["--", "--depth", "0.05", "--only", "slats"], r"\| slats .*\d"),
    "snow/ledger.py": (BLENDER, ["--", "--frames", "2"], r"error on any frame: \d.*e-(0[789]|1\d)"),
    "snow/beside_real_snow.py": (
        BLENDER,
        ["--", "wall", "ours", "0.1", "--out", "OUT", "--views", "wide", "--size", "32x18", "--samples", "1"],
        r"wall ours 0\.1 m: \d",
    ),
    "snow/display.py": (BLENDER, ["--", "--frames", "2"], r"\| .*\d"),
    "tree/read_benchmark.py": (PYTHON, ["--megabytes", "1", "--repeats", "1"], r"generated\.obj .*\d"),
    "tree/size_table.py": (PYTHON, ["--branches", "200", "--corners", "200"], r"\| 200 \| .*\d"),
    "bake_vs_dynamic_paint.py": (BLENDER, ["--", "--frames", "2", "--sizes", "256"], r"256 +\d"),
    "bakes/against_commit.py": (PYTHON, [str(ROOT), "--rounds", "1", "--shots", "monkey-1024"], r"\| .*\d"),
}  # fmt: skip
# Parts of tables.py, a library, and a sheet that needs a tree exported with a baked scene.
COVERED = {
    "realtime/forest.py",
    "realtime/scenes.py",
    "realtime/snow.py",
    "realtime/step_and_output.py",
    "realtime/trees.py",
    "snow/speed.py",
    "tree/engine_sheet.py",
}


def documented():
    texts = [*ROOT.glob("docs/**/*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    return {
        name for text in texts for name in re.findall(r"benchmarks/([\w/]+\.py)", text.read_text("utf-8"))
    }


def test_every_benchmark_of_the_manual_is_run_here():
    assert documented() == set(SMALLEST) | COVERED


@pytest.mark.parametrize("name", sorted(SMALLEST))
def test_a_benchmark_runs(name, tmp_path):
    program, arguments, pattern = SMALLEST[name]
    if shutil.which(program[0]) is None:
        pytest.skip(f"there is no {program[0]}")
    command = [*program, str(BENCHMARKS / name), *(text.replace("OUT", str(tmp_path)) for text in arguments)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "build" / "python")}
    if program is not PYTHON:
        environment.pop("PYTHONPATH")
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout[-2000:] + ended.stderr[-2000:]
    assert "Traceback" not in ended.stdout + ended.stderr
    assert re.search(pattern, ended.stdout), ended.stdout
    if "OUT" in " ".join(arguments):
        assert list(tmp_path.glob("*.png"))
