# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on, its native modules and its texts into zips, wheels and a repository, for tools/package.sh. Times,
permissions and order of entries are fixed, so that equal input gives equal bytes."""

import base64
import hashlib
import json
import re
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "addon" / "snowbough"
BUILD = ROOT / "build"

# For each system: Blender's name, the wheel's tag, and the suffix of its modules.
SYSTEMS = {
    "linux": ("linux-x64", "manylinux_2_28_x86_64", "-linux-gnu.so"),
    "windows": ("windows-x64", "win_amd64", "-win_amd64.pyd"),
    "macos": ("macos-arm64", "macosx_11_0_arm64", "-darwin.so"),
}

# Python versions of Blender before 4.2.
LEGACY_PYTHONS = r"\.c\w+-?3(10|11)-"

LICENCES = {
    "openmesh": "LICENSE",
    "openexr": "LICENSE.md",
    "imath": "LICENSE.md",
    "zlib": "LICENSE",
    "libepoxy": "COPYING",
    "glm": "copying.txt",
    "eigen3": "COPYING.MPL2",
}

SHIM = '''# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowbough's native core: trees from OBJ, and snow that stays where it fell."""

import {module} as _module

globals().update({{name: value for name, value in vars(_module).items() if not name.startswith("__")}})
__version__ = _module.__version__
'''


def say_made(path):
    print(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path)


def write_zip(target, files):
    """Writes a zip. files: {name in the zip: content as bytes}."""
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(target.name + ".part")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[name])
    partial.replace(target)
    say_made(target)


def version_of(manifest):
    version = re.search(r'^version = "([^"]+)"', manifest, re.MULTILINE).group(1)
    in_python = re.search(
        r'"version": \((\d+), (\d+), (\d+)\)', (ADDON / "__init__.py").read_text(encoding="utf-8")
    )
    if ".".join(in_python.groups()) != version:
        sys.exit(
            f"package: blender_manifest.toml says {version}, bl_info in __init__.py {in_python.groups()}"
        )
    return version


def addon_files():
    files = {}
    for path in sorted(ADDON.rglob("*")):
        inside = path.relative_to(ADDON)
        if path.is_file() and "__pycache__" not in inside.parts and inside.parts[0] not in {"lib", "wheels"}:
            files[inside.as_posix()] = path.read_bytes()
    files["LICENSE"] = (ROOT / "LICENSE").read_bytes()
    return files


def below(folder, files):
    return {f"{folder}/{name}": content for name, content in files.items()}


def modules_of(system, version, build):
    folder = build / system / "modules"
    found = sorted(folder.glob(f"snowbough_native_{version.replace('.', '_')}.*{SYSTEMS[system][2]}"))
    if not found:
        sys.exit(
            f"package: no modules of version {version} in {folder}; run ./tools/build_modules.sh {system} first"
        )
    return {path.name: path.read_bytes() for path in found}


def wheel_files(system, version, modules, libraries):
    """The files of one wheel for all Python versions: each version imports the module with its own suffix.

    libraries: the folder with the sources of the libraries in LICENCES."""
    module = f"snowbough_native_{version.replace('.', '_')}"
    info = f"snowbough_native-{version}.dist-info"
    readme = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## ")[0]
    files = dict(modules)
    files["snowbough_native.py"] = SHIM.format(module=module).encode()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: snowbough\nRoot-Is-Purelib: false\nTag: py3-none-{SYSTEMS[system][1]}\n"
    ).encode()
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: snowbough-native\nVersion: {version}\n"
        "Summary: Snowbough's native core: trees from OBJ as rigged meshes, and snow that stays where it fell\n"
        "License: GPL-3.0-or-later\nRequires-Python: >=3.10\nRequires-Dist: numpy>=1.22\n"
        f"Description-Content-Type: text/markdown\n\n{readme}"
    ).encode()
    files[f"{info}/licenses/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    for library, name in LICENCES.items():
        files[f"{info}/licenses/{library}.txt"] = (libraries / library / name).read_bytes()
    record = []
    for name in sorted(files):
        digest = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
        record.append(f"{name},sha256={digest},{len(files[name])}\n")
    files[f"{info}/RECORD"] = ("".join(record) + f"{info}/RECORD,,\n").encode()
    return files


def field(manifest, name):
    """The value of a field of the manifest: a text or a list of texts."""
    value = re.search(rf"^{name} = (.+)$", manifest, re.MULTILINE).group(1)
    return json.loads(value)


def develop(folder, target):
    version = version_of((ADDON / "blender_manifest.toml").read_text(encoding="utf-8"))
    native = sorted(Path(folder).glob("snowbough_native*.so"))
    if not native:
        sys.exit(f"package: no snowbough_native in {folder}; run ./tools/setup.sh first")
    files = addon_files() | below("lib", {path.name: path.read_bytes() for path in native})
    write_zip(
        Path(target).resolve() if target else BUILD / f"snowbough-{version}.zip",
        below("snowbough", files),
    )


def release(systems, build=BUILD):
    """Writes the packages of these systems to build/packages. Their modules are in build/SYSTEM/modules, the libraries'
    sources in build/third_party/sources."""
    packages, libraries = build / "packages", build / "third_party" / "sources"
    manifest = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    version = version_of(manifest)
    legacy, listed = addon_files(), []
    for system in systems:
        blender, tag, _ = SYSTEMS[system]
        modules = modules_of(system, version, build)
        legacy |= below("lib", {name: modules[name] for name in modules if re.search(LEGACY_PYTHONS, name)})
        wheel = packages / f"snowbough_native-{version}-py3-none-{tag}.whl"
        write_zip(wheel, wheel_files(system, version, modules, libraries))
        own = re.sub(
            r"^platforms = .*$",
            f'platforms = ["{blender}"]\nwheels = ["./wheels/{wheel.name}"]',
            manifest,
            flags=re.MULTILINE,
        )
        name = f"snowbough-{version}-{blender.replace('-', '_')}.zip"
        files = addon_files() | {
            "blender_manifest.toml": own.encode(),
            f"wheels/{wheel.name}": wheel.read_bytes(),
        }
        write_zip(packages / "repository" / name, files)
        listed.append(entry(manifest, blender, packages / "repository" / name))
    write_zip(packages / f"snowbough-{version}-legacy.zip", below("snowbough", legacy))
    index = {"version": "v1", "blocklist": [], "data": listed}
    (packages / "repository" / "index.json").write_text(json.dumps(index, indent=2) + "\n", encoding="utf-8")
    say_made(packages / "repository" / "index.json")


def entry(manifest, platform, archive):
    """The entry of a zip in the repository's index, in the form of Blender's server-generate."""
    content = archive.read_bytes()
    plain = ("schema_version", "id", "name", "tagline", "version", "type", "maintainer", "license")
    described = {name: field(manifest, name) for name in (*plain, "blender_version_min", "tags")}
    described |= {"platforms": [platform], "permissions": {"files": field(manifest, "files")}}
    # From the tag py3 of the wheel.
    described["python_versions"] = ["3"]
    described["archive_url"] = f"./{archive.name}"
    described["archive_size"] = len(content)
    described["archive_hash"] = f"sha256:{hashlib.sha256(content).hexdigest()}"
    return described


if __name__ == "__main__":
    if sys.argv[1] == "develop":
        develop(*sys.argv[2:])
    else:
        release(sys.argv[2:])
