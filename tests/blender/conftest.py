# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests inside Blender. They run through run.py only, which installs the add-on."""

import importlib
import os
import sys
import types
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
SHARED_DATA = ROOT.parent / "shared" / "data"

sys.path.insert(0, str(Path(__file__).resolve().parent))


def addon_module(name):
    """A module of the installed add-on: addon_module("bake.job")."""
    return importlib.import_module(f"{os.environ['SNOWBOUGH_TEST_ADDON']}.{name}")


@pytest.fixture
def addon():
    """Loads modules of the installed add-on: addon("bake.job")."""
    return addon_module


@pytest.fixture
def native():
    """The native module of the installed add-on."""
    return addon_module("base.native").load()


@pytest.fixture
def stand_in(monkeypatch):
    """stand_in(SnowSimulation=...): a copy of the native module with these attributes replaced takes its place in
    sys.modules, where the add-on looks it up."""
    real = addon_module("base.native").load()

    def put(**names):
        module = types.ModuleType(real.__name__)
        vars(module).update({**vars(real), **names})
        monkeypatch.setitem(sys.modules, "snowbough_native", module)

    return put


@pytest.fixture
def leafy(tmp_path, addon):
    """See exported_tree.leafy_file."""
    from exported_tree import leafy_file

    return leafy_file(tmp_path, addon("base.native").load())


@pytest.fixture
def ground_of(tmp_path, native):
    """Mean heights of a receiver's open parts in the frames 1 to `last`, from its maps in the folder cache."""
    import snow_scene as s

    def heights(name="Ground", last=4, version=1):
        maps = [s.height(native, tmp_path / "cache", name, frame, version) for frame in range(1, last + 1)]
        return [s.open_ground(map_) for map_ in maps]

    return heights


@pytest.fixture
def points_in(tmp_path):
    """points_in(receiver, frame): the points of its surface in the files of the folder cache, in its own space."""
    import snow_scene as s

    read = addon_module("surface.point_cache").read_point_cache
    return lambda name, frame: read(s.folder_of(tmp_path / "cache", name) / "surface.pc2")[frame].astype(
        float
    )


@pytest.fixture
def handlers():
    """Removes the frame handlers of a test."""
    before = list(bpy.app.handlers.frame_change_pre)
    yield
    bpy.app.handlers.frame_change_pre[:] = before


@pytest.fixture(autouse=True)
def empty_scene():
    """Every test starts in an empty file, with the add-on enabled."""
    bpy.ops.wm.read_homefile(use_empty=True)
    yield


@pytest.fixture
def shared_tree():
    """Path of a tree made by another program: shared_tree("tubes/AL06a.obj"); skips where it is absent."""

    def find(name):
        path = SHARED_DATA / "trees" / name
        if not path.is_file():
            pytest.skip(f"{name} is not there: shared data is absent")
        return path

    return find
