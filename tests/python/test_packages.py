"""The packages that tools/package.py makes from the add-on and its native modules."""

import ast
import base64
import hashlib
import importlib.util
import json
import re
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHONS = ("310", "311", "313", "314")
SUFFIXES = {
    "linux": ".cpython-{}-x86_64-linux-gnu.so",
    "windows": ".cp{}-win_amd64.pyd",
    "macos": ".cpython-{}-darwin.so",
}


@pytest.fixture(scope="module")
def package():
    """tools/package.py"""
    spec = importlib.util.spec_from_file_location("package", ROOT / "tools" / "package.py")
    package = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(package)
    return package


@pytest.fixture
def release(package, tmp_path):
    """release(systems): the folder of their packages. The modules hold the name of their system and Python."""
    version = package.version_of((package.ADDON / "blender_manifest.toml").read_text()).replace(".", "_")
    for system, suffix in SUFFIXES.items():
        modules = tmp_path / system / "modules"
        modules.mkdir(parents=True)
        for python in PYTHONS:
            name = f"snowbough_native_{version}" + suffix.format(python)
            (modules / name).write_text(f"{system} {python}")
    for library, name in package.LICENCES.items():
        licence = tmp_path / "third_party" / "sources" / library / name
        licence.parent.mkdir(parents=True)
        licence.write_text(f"licence of {library}")

    def made(systems):
        package.release(systems, tmp_path)
        return tmp_path / "packages"

    return made


def bytes_below(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_equal_input_gives_equal_bytes(release):
    first = bytes_below(release(["linux", "windows"]))
    assert bytes_below(release(["linux", "windows"])) == first and len(first) == 6


def test_the_legacy_zip_holds_the_modules_of_the_pythons_before_blender_4_2(release):
    packages = release(["linux", "windows", "macos"])
    (legacy,) = packages.glob("*-legacy.zip")
    with zipfile.ZipFile(legacy) as archive:
        lib = [
            archive.read(name).decode() for name in archive.namelist() if name.startswith("snowbough/lib/")
        ]
    assert sorted(lib) == sorted(f"{system} {python}" for system in SUFFIXES for python in ("310", "311"))


def test_an_extension_names_its_system_and_the_wheel_it_holds(release):
    packages = release(["linux", "windows"])
    (extension,) = (packages / "repository").glob("*windows_x64.zip")
    with zipfile.ZipFile(extension) as archive:
        manifest = archive.read("blender_manifest.toml").decode()
        names = archive.namelist()
    assert 'platforms = ["windows-x64"]' in manifest
    (wheel,) = re.findall(r'wheels = \["\./(.*)"\]', manifest)
    assert wheel in names and wheel.endswith("-py3-none-win_amd64.whl")
    assert not [name for name in names if name.startswith("lib/")]


def test_a_wheel_records_what_it_holds(release):
    packages = release(["macos"])
    (wheel,) = packages.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        (record,) = [name for name in archive.namelist() if name.endswith("/RECORD")]
        lines = [line.split(",") for line in archive.read(record).decode().splitlines()]
        assert sorted(line[0] for line in lines) == archive.namelist()
        for name, digest, size in lines:
            if name != record:
                content = archive.read(name)
                known = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                assert (digest, int(size)) == (f"sha256={known}", len(content))


def test_the_index_lists_each_zip_with_its_checksum(release):
    packages = release(["linux", "macos"])
    repository = packages / "repository"
    data = json.loads((repository / "index.json").read_text())["data"]
    assert [entry["platforms"] for entry in data] == [["linux-x64"], ["macos-arm64"]]
    for entry in data:
        content = (repository / entry["archive_url"]).read_bytes()
        assert entry["archive_hash"] == f"sha256:{hashlib.sha256(content).hexdigest()}"
        assert entry["archive_size"] == len(content)


def test_the_tagline_fits_blenders_limit(package):
    manifest = (ROOT / "addon" / "snowbough" / "blender_manifest.toml").read_text()
    tagline = package.field(manifest, "tagline")
    assert len(tagline) <= 64 and tagline[-1].isalnum()


def test_the_version_is_that_of_the_manifest_everywhere(package):
    version = package.version_of((ROOT / "addon" / "snowbough" / "blender_manifest.toml").read_text())
    assert version not in (ROOT / "CMakeLists.txt").read_text() + (ROOT / "pyproject.toml").read_text()
    tree = ast.parse((ROOT / "addon" / "snowbough" / "__init__.py").read_text())
    (info,) = [
        node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    ]
    assert ".".join(map(str, ast.literal_eval(info)["version"])) == version
