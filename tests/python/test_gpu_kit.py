# SPDX-License-Identifier: GPL-3.0-or-later
"""The kit of tools/gpu_kit.sh runs where nothing of the checkout is: an empty folder, no environment, no packages."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ("patchelf", "readelf", "strip", "ldd")
missing = [tool for tool in TOOLS if shutil.which(tool) is None]
pytestmark = pytest.mark.skipif(
    bool(missing), reason=f"the kit is packed with {', '.join(missing)}: not installed"
)


@pytest.fixture(scope="module")
def kit(tmp_path_factory):
    path = tmp_path_factory.mktemp("kit") / "kit.pyz"
    made = subprocess.run([ROOT / "tools" / "gpu_kit.sh", path], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    return path


def run_kit(kit, folder, *arguments, python=("-I", "-S")):
    """The kit as one runs it elsewhere: nothing of this process's environment."""
    return subprocess.run(
        [sys.executable, *python, kit, *arguments],
        cwd=folder,
        env={},
        capture_output=True,
        text=True,
        timeout=300,
    )


def dynamic(path, key):
    said = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True).stdout
    return re.findall(rf"\({key}\).*\[(.*)\]", said)


@pytest.fixture(scope="module")
def printed(kit, tmp_path_factory):
    """What the kit prints in an empty folder, which stays empty."""
    folder = tmp_path_factory.mktemp("empty")
    done = run_kit(kit, folder, "--quick", "--only", "trees,step")
    assert done.returncode == 0, done.stdout + done.stderr
    assert list(folder.iterdir()) == []
    return done.stdout


def test_one_command_prints_the_tables(printed):
    assert re.search(r"^\| THESIS \| 80 \|", printed, re.MULTILINE)
    assert re.search(r"^\| 512 x 512 \| [\d.]+ \|", printed, re.MULTILINE)
    assert "GTX 1060" in printed and "not whole" not in printed


def test_what_the_module_links_is_the_kits_and_the_driver_is_the_machines(printed):
    own, machine = (
        re.search(rf"^- {whose}: (.*)$", printed, re.MULTILINE)[1] for whose in ("the kit's", "the machine's")
    )
    for name in ("snowbough_native", "_multiarray_umath", "libOpenEXR", "libOpenMeshCore", "libepoxy"):
        assert name in own and name not in machine, name
    for name in ("libEGL", "libc.so.6", "ld-linux"):
        assert name in machine and name not in own, name


def test_a_section_that_is_not_there_is_refused(kit, tmp_path):
    done = run_kit(kit, tmp_path, "--only", "stars")
    assert done.returncode == 2 and "there is no section stars; there are trees, forest, step" in done.stderr


def test_no_library_of_the_system_or_the_driver_is_packed(kit):
    with zipfile.ZipFile(kit) as archive:
        names = [Path(name).name for name in archive.namelist()]
    forbidden = re.compile(r"lib(EGL|GL|GLX|OpenGL|GLdispatch|c|m|dl|rt|pthread|drm)(_.*)?\.so|ld-linux")
    assert [name for name in names if forbidden.match(name)] == []
    assert kit.stat().st_size < 60e6


def test_every_library_finds_its_own_by_origin(kit, tmp_path):
    with zipfile.ZipFile(kit) as archive:
        archive.extractall(tmp_path)
    libraries = tmp_path / "build" / "python" / "snowbough_native.libs"
    packed = {path.name for path in libraries.glob("*.so*")}
    checked = 0
    for path in (tmp_path / "build" / "python").rglob("*.so*"):
        if path.is_file() and set(dynamic(path, "NEEDED")) & packed:
            (found,) = dynamic(path, "RPATH")
            assert (
                found.startswith("$ORIGIN")
                and (path.parent / found.replace("$ORIGIN", ".")).resolve() == libraries
            )
            checked += 1
    assert checked >= 3 and dynamic(libraries / "libOpenEXR-3_1.so.30", "RUNPATH") == []


def test_another_python_is_told_which_one_to_take(kit, tmp_path):
    text = zipfile.ZipFile(kit).read("__main__.py").decode()
    program = tmp_path / "main.py"
    program.write_text(text.replace("sys.version_info[:2] != wanted", "(3, 99) != wanted"))
    shutil.copy(kit, tmp_path / "kit.pyz")
    called = f"import sys; sys.argv = [{str(tmp_path / 'kit.pyz')!r}]; exec(open({str(program)!r}).read())"
    done = subprocess.run([sys.executable, "-c", called], capture_output=True, text=True, env={**os.environ})
    assert done.returncode == 1 and re.search(r"run it with python3\.\d+", done.stderr)


def test_equal_input_gives_an_equal_kit(kit, tmp_path):
    subprocess.run([ROOT / "tools" / "gpu_kit.sh", tmp_path / "again.pyz"], check=True, capture_output=True)
    assert (tmp_path / "again.pyz").read_bytes() == kit.read_bytes()
