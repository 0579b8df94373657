# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the kit that measures the real-time tables: see gpu_kit.sh.

The kit is a zip that Python runs (PEP 441). Its folders are those of the checkout, so the scripts run unchanged.
Libraries find each other by $ORIGIN, as in a wheel repaired by auditwheel.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MODULE_FOLDER = Path("build/python")
LIBRARIES = "snowbough_native.libs"
# Used only if the machine's own are missing or too old. Drivers link these libraries, too, and may need newer ones.
RUNTIME = "runtime"
RUNTIME_LIBRARIES = ("libstdc++.so.6", "libgcc_s.so.1")
# Libraries of the machine: the C library and its parts, and the driver's libraries.
SYSTEM = re.compile(
    r"(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|util|resolv)|lib(EGL|GL|GLX|OpenGL|GLdispatch|GLESv2|drm|gbm|X.*|xcb.*)"
    r"(_.*)?)\.so(\..*)?"
)
CONTENTS = (
    "benchmarks/realtime/*.py",
    "benchmarks/snow/*.py",
    "blend_samples/grow_tree.py",
    "tests/python/native/snow_*.py",
    "tests/data/small_maple.obj",
    "LICENSE",
)
# Parts of numpy that measurements do not import.
NUMPY_LEFT_OUT = re.compile(
    r"(^|/)(tests|f2py|distutils|doc|include|testing|__pycache__)/|\.(pyi|a|c|h|md|rst)$"
)
MOST_BYTES = 60e6


def fail(text):
    sys.exit(f"gpu_kit: {text}")


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode:
        fail(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return done.stdout


def linked(path):
    """{soname: file} of all libraries that a library links directly or indirectly and that the kit must contain."""
    found = {}
    for line in run("ldd", path).splitlines():
        named = re.match(r"\s*(\S+) => (\S+|not found)", line)
        if named and not SYSTEM.fullmatch(named[1]):
            if named[2] == "not":
                fail(f"{path.name} links {named[1]}, which is not on this machine")
            found[named[1]] = Path(named[2])
    return found


def needs(path):
    """Sonames of the libraries that a library links directly."""
    return re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", path))


def point_to(path, folder):
    """Sets a library's search path to `folder`, relative to the library."""
    way = os.path.relpath(folder, path.parent)
    path.chmod(0o755)
    run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN" if way == "." else f"$ORIGIN/{way}", path)


def copy_module(kit):
    """Copies the native module, numpy and all their libraries. Returns the file name of the module."""
    import numpy

    target = kit / MODULE_FOLDER
    libraries = target / LIBRARIES
    (libraries / RUNTIME).mkdir(parents=True)
    built = sorted((ROOT / MODULE_FOLDER).glob("snowbough_native*.so"))
    if not built:
        fail(f"no snowbough_native in {MODULE_FOLDER}: run ./tools/setup.sh first")
    binaries = [Path(shutil.copy2(path, target)) for path in built]
    source = Path(numpy.__file__).parent
    for path in sorted(source.rglob("*")):
        inside = path.relative_to(source.parent)
        if path.is_file() and not NUMPY_LEFT_OUT.search(inside.as_posix()):
            (target / inside).parent.mkdir(parents=True, exist_ok=True)
            copied = Path(shutil.copy2(path, target / inside))
            if ".so" in path.suffixes:
                binaries.append(copied)
    wanted = {}
    for path in binaries:
        wanted.update(linked(path))
    for soname, path in sorted(wanted.items()):
        own = libraries / RUNTIME if soname in RUNTIME_LIBRARIES else libraries
        copied = Path(shutil.copy2(path.resolve(), own / soname))
        if soname not in RUNTIME_LIBRARIES:
            binaries.append(copied)
    for path in binaries:
        run("strip", "--strip-debug", path)
        if set(needs(path)) & set(wanted):
            point_to(path, libraries)
    return built[0].name


def copy_scripts(kit, module):
    for pattern in CONTENTS:
        paths = sorted(ROOT.glob(pattern))
        if not paths:
            fail(f"there is no file {pattern} in the checkout")
        for path in paths:
            to = kit / path.relative_to(ROOT)
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, to)
    shutil.copy2(ROOT / "tools" / "gpu_kit_main.py", kit / "__main__.py")
    (kit / "module.txt").write_text(module + "\n")


def pack(kit, target):
    """Writes the kit to `target` and returns its size in bytes. Equal contents give equal bytes."""
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(target.name + ".part")
    with open(partial, "wb") as stream:
        stream.write(b"#!/usr/bin/env python3.11\n")
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for path in sorted(path for path in kit.rglob("*") if path.is_file()):
                entry = zipfile.ZipInfo(path.relative_to(kit).as_posix(), date_time=(1980, 1, 1, 0, 0, 0))
                entry.external_attr = (path.stat().st_mode & 0o777) << 16
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, path.read_bytes())
    size = partial.stat().st_size
    if size > MOST_BYTES:
        partial.unlink()
        fail(f"the kit has {size / 1e6:.0f} MB, more than {MOST_BYTES / 1e6:.0f}")
    partial.chmod(0o755)
    partial.replace(target)
    return size


def main():
    target = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "snowbough-gpu-kit.pyz").resolve()
    for tool in ("patchelf", "readelf", "strip", "ldd"):
        if shutil.which(tool) is None:
            fail(f"{tool} is missing: run ./tools/setup.sh")
    with tempfile.TemporaryDirectory(prefix="snowbough-kit-") as folder:
        kit = Path(folder) / "kit"
        module = copy_module(kit)
        copy_scripts(kit, module)
        size = pack(kit, target)
    print(f"{target}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
