# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings as passed to a simulation and a manifest (snowbough.bake.request, .simulation), without Blender."""

import importlib
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from snowbough.bake.request import BakeRequest
from snowbough.bake.simulation import make_simulation
from snowbough.base.map_kinds import ON_REQUEST

SNOW = {"flutter": math.radians(3.0), "max_depth": 0.7, "seed": 5, "a_new_setting": "x"}


def request(**changes):
    whole = BakeRequest(
        scene_name="Scene", cache="/c", frame_start=1, frame_end=12, first=1, last=12, fps=24.0, start_depth=0.0,
        end_depth=0.1, rates=(1.0,) * 12, snow=SNOW, texel_size=0.01, pixel_size=0.0, blur_radius=2.0, substeps=1,
        directions=64, checkpoint_interval=10, receivers=(),
        maps={kind.name: False for kind in ON_REQUEST},
    )  # fmt: skip
    return replace(whole, **changes)


def test_a_snow_setting_is_part_of_the_shot_under_its_own_name():
    assert SNOW.items() <= request().shot().items()


def test_what_decides_about_all_maps_is_part_of_the_shot():
    own = {name: value for name, value in request().shot().items() if name not in SNOW}
    assert own == {
        "frame_start": 1,
        "frame_end": 12,
        "fps": 24.0,
        "start_depth": 0.0,
        "end_depth": 0.1,
        "blur_radius": 2.0,
        "substeps": 1,
        "directions": 64,
        "checkpoint_interval": 10,
        "write_normals": False,
        "wet": False,
        "points": False,
    }


@pytest.mark.parametrize(
    "changed",
    [
        {"first": 5},
        {"last": 7},
        {"cache": "/d"},
        {"objects": ("Cart",)},
        {"resume": True},
        {"texel_size": 0.5},
        {"engine": "CPU"},
    ],
)
def test_parts_of_a_shot_on_other_machines_are_the_same_shot(changed):
    assert request(**changed).shot() == request().shot()


def test_the_native_module_gets_all_snow_settings_as_they_are():
    native = SimpleNamespace(SnowSimulation=lambda **arguments: arguments)
    given = make_simulation(native, SNOW, 0.02, "CPU", wait_for_gpu=False)
    assert given == {
        "pixel_size": 0.02,
        "engine": "CPU",
        "wait_for_gpu": False,
        **SNOW,
    }


def test_the_shot_of_the_tests_of_faults_has_a_switch_for_every_kind_of_map(monkeypatch, tmp_path):
    """Those tests run at night only."""
    monkeypatch.syspath_prepend(Path(__file__).resolve().parents[2] / "faults")
    shot = importlib.import_module("shot").request(tmp_path).shot()
    assert {kind.setting for kind in ON_REQUEST} <= shot.keys()
