"""Where the add-on finds its native module, and its message without one."""

import importlib.machinery
import importlib.util
import os
import shutil
import sys
from types import SimpleNamespace

import pytest
from snowbough.base import native as checkout

OWN_SUFFIX = importlib.machinery.EXTENSION_SUFFIXES[0]


@pytest.fixture
def native(tmp_path, monkeypatch):
    """The module in a copy of the add-on that has no native module yet."""
    base = tmp_path / "checkout" / "addon" / "snowbough" / "base"
    base.mkdir(parents=True)
    copy = shutil.copy(checkout.__file__, base)
    monkeypatch.delitem(sys.modules, checkout.MODULE_NAME, raising=False)
    monkeypatch.delenv(checkout.ENVIRONMENT_VARIABLE, raising=False)
    monkeypatch.setattr(sys, "path", [path for path in sys.path if "build/python" not in path])
    spec = importlib.util.spec_from_file_location("copied_native", copy)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folder(native, tmp_path, monkeypatch):
    """The folder that is searched first."""
    folder = tmp_path / "modules"
    folder.mkdir()
    monkeypatch.setenv(native.ENVIRONMENT_VARIABLE, str(folder))
    return folder


def test_a_module_with_a_version_in_its_name_is_found_among_other_pythons(native, folder):
    for name in ("_0_1_0.cpython-37-x86_64-linux-gnu.so", "_0_1_0.cp37-win_amd64.pyd", "_0_1_0" + OWN_SUFFIX):
        (folder / (native.MODULE_NAME + name)).write_bytes(b"")
    assert native.module_file().name == native.MODULE_NAME + "_0_1_0" + OWN_SUFFIX


def test_of_several_versions_the_last_is_taken(native, folder):
    for version in ("0_1_0", "0_2_0"):
        (folder / f"{native.MODULE_NAME}_{version}{OWN_SUFFIX}").write_bytes(b"")
    assert "_0_2_0" in native.module_file().name


def test_an_installed_wheel_is_imported(native, folder, monkeypatch):
    site = folder / "site-packages"
    site.mkdir()
    (site / "snowbough_native.py").write_text("place = 'wheel'\n")
    monkeypatch.syspath_prepend(site)
    assert native.load().place == "wheel"
    assert native.problem() == ""


@pytest.mark.skipif(os.name == "nt", reason="the wheel is installed in this Python")
def test_a_missing_module_is_one_line_that_says_what_to_install(native, folder):
    with pytest.raises(native.NativeModuleMissing, match="is not installed. Install the add-on's zip"):
        native.load()
    assert "\n" not in native.problem() and native.problem().startswith("Snowbough's module for Python")


@pytest.mark.skipif(os.name == "nt", reason="the wheel is installed in this Python")
def test_a_python_without_a_module_is_named(native, monkeypatch):
    with monkeypatch.context() as older:
        older.setattr(sys, "version_info", SimpleNamespace(major=3, minor=7))
        assert "Python 3.7" in native.problem()
    assert "for which Snowbough has no module" in native.problem()


def test_a_module_that_does_not_load_is_one_line(native, folder):
    (folder / (native.MODULE_NAME + OWN_SUFFIX)).write_bytes(b"no library")
    assert native.problem().startswith("Snowbough's module does not load: ")
    assert "\n" not in native.problem()
