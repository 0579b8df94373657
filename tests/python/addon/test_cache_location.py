# SPDX-License-Identifier: GPL-3.0-or-later
"""Which folder a text in the panel or on the command line means, without Blender."""

import os
import stat
from pathlib import Path

import pytest
from snowbough.cache import files, location

posix = pytest.mark.skipif(os.name != "posix", reason="paths of POSIX")


@pytest.fixture
def blend(tmp_path, monkeypatch):
    """A .blend; the working directory and the home folder are others."""
    for name in ("shots", "home", "elsewhere"):
        (tmp_path / name).mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path / "elsewhere")
    return tmp_path / "shots" / "shot.blend"


@posix
def test_in_the_panel_two_slashes_are_the_folder_of_the_blend(blend, tmp_path):
    assert location.from_panel("//snow", str(blend)) == tmp_path / "shots" / "snow"
    assert location.from_panel("//../snow", str(blend)) == tmp_path / "snow"
    assert location.from_panel("//SERVER/share", str(blend)) == tmp_path / "shots" / "SERVER" / "share"
    with pytest.raises(ValueError, match="Save the .blend first"):
        location.from_panel("//snow", "")


@posix
def test_the_home_folder_is_meant_by_its_sign(blend, tmp_path):
    for read in (lambda text: location.from_panel(text, str(blend)), location.from_command_line):
        assert read("~/snow") == tmp_path / "home" / "snow"
        with pytest.raises(ValueError, match="names no user of this computer"):
            read("~nobody-of-this-name/snow")
    assert list((tmp_path / "elsewhere").iterdir()) == []


@posix
def test_a_relative_folder_is_for_the_command_line_only(blend, tmp_path):
    with pytest.raises(
        ValueError, match="'snow' is not absolute: write //snow for a folder beside the .blend"
    ):
        location.from_panel("snow", str(blend))
    with pytest.raises(ValueError, match="is not absolute"):
        location.from_panel("C:\\snow", str(blend))
    assert location.from_command_line("snow") == tmp_path / "elsewhere" / "snow"


@posix
def test_a_share_of_windows_is_no_folder_of_that_name(blend):
    for read in (lambda text: location.from_panel(text, str(blend)), location.from_command_line):
        with pytest.raises(ValueError, match="is a share of Windows: write the folder where"):
            read("\\\\server\\share")
        with pytest.raises(ValueError, match="is empty"):
            read(" ")


@posix
def test_on_the_command_line_two_slashes_are_the_root(blend):
    assert str(location.from_command_line("//mnt/snow")) == "/mnt/snow"


@posix
def test_a_share_is_recognised_on_windows(blend, monkeypatch, tmp_path):
    class Windows:
        """os.path of a computer that reaches one share."""

        name = "nt"
        path = type("path", (), {"isdir": staticmethod(lambda path: path == "//SERVER/share")})

    monkeypatch.setattr(location, "os", Windows)
    assert location.from_panel("//SERVER/share/snow", str(blend)) == Path("//SERVER/share/snow")
    assert location.from_panel("//SERVER/share/snow", "") == Path("//SERVER/share/snow")
    assert location.from_panel("//OTHER/share", str(blend)) == tmp_path / "shots" / "OTHER" / "share"
    (tmp_path / "shots" / "SERVER").mkdir()
    assert location.from_panel("//SERVER/share", str(blend)) == tmp_path / "shots" / "SERVER" / "share"


@posix
@pytest.mark.parametrize(
    "umask, folder, file", [(0o022, 0o755, 0o644), (0o077, 0o700, 0o600), (0o002, 0o775, 0o664)]
)
def test_folders_and_files_are_as_open_as_the_umask_says(tmp_path, umask, folder, file):
    before = os.umask(umask)
    try:
        files.make_folder(tmp_path / "a" / "b")
        files.write_bytes(tmp_path / "a" / "b" / "c", b"x")
    finally:
        os.umask(before)
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("a", "a/b", "a/b/c")]
    assert modes == [folder, folder, file]
