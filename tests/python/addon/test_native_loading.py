"""Where the add-on finds its native module, and what it says where there is none."""

import importlib.machinery
import sys

import pytest
from snowbough.base import native

OWN_SUFFIX = importlib.machinery.EXTENSION_SUFFIXES[0]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The only folder that is looked into; nothing is loaded yet."""
    monkeypatch.delitem(sys.modules, native.MODULE_NAME, raising=False)
    monkeypatch.setattr(native, "_folders", lambda: [tmp_path])
    monkeypatch.setattr(native, "_problem", None)
    monkeypatch.setattr(sys, "path", [path for path in sys.path if "build/python" not in path])
    return tmp_path


def test_a_module_with_its_version_in_its_name_is_found_among_those_of_other_pythons(folder):
    for name in ("_0_1_0.cpython-37-x86_64-linux-gnu.so", "_0_1_0.cp37-win_amd64.pyd", "_0_1_0" + OWN_SUFFIX):
        (folder / (native.MODULE_NAME + name)).write_bytes(b"")
    assert native._module_file().name == native.MODULE_NAME + "_0_1_0" + OWN_SUFFIX


def test_of_several_versions_the_last_is_taken(folder):
    for version in ("0_1_0", "0_2_0"):
        (folder / f"{native.MODULE_NAME}_{version}{OWN_SUFFIX}").write_bytes(b"")
    assert "_0_2_0" in native._module_file().name


def test_an_installed_wheel_is_imported(folder, monkeypatch):
    site = folder / "site-packages"
    site.mkdir()
    (site / "snowbough_native.py").write_text("place = 'wheel'\n")
    monkeypatch.syspath_prepend(site)
    assert native.load().place == "wheel"
    assert native.problem() == ""


def test_a_missing_module_is_one_line_that_says_what_to_install(folder):
    with pytest.raises(native.NativeModuleMissing, match="is not installed. Install the add-on's zip"):
        native.load()
    assert "\n" not in native.problem() and native.problem().startswith("Snowbough's module for Python")


def test_a_python_without_a_module_is_named(folder, monkeypatch):
    monkeypatch.setattr(native, "PACKAGED_PYTHONS", ())
    assert "for which Snowbough has no module" in native.problem()


def test_a_module_that_does_not_load_is_one_line(folder):
    (folder / (native.MODULE_NAME + OWN_SUFFIX)).write_bytes(b"no library")
    assert native.problem().startswith("Snowbough's module does not load: ")
    assert "\n" not in native.problem()
