# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the kit that measures the real-time tables: see gpu_kit.sh.

The folders of the kit are those of the checkout, so the scripts run unchanged.
"""

import gzip
import io
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NAME = "snowbough-gpu-kit"
PYTHON = "3.13"
NUMPY = "numpy==2.1.3"
#: What pip calls the systems, and where their Python looks for packages.
SYSTEMS = {
    "linux": ("manylinux_2_28_x86_64", "manylinux2014_x86_64", f"lib/python{PYTHON}/site-packages"),
    "windows": ("win_amd64", "win_amd64", "lib/site-packages"),
}
SCRIPTS = (
    "benchmarks/realtime/*.py",
    "benchmarks/snow/*.py",
    "blend_samples/grow_tree.py",
    "tests/python/native/snow_*.py",
    "tests/data/small_maple.obj",
    "LICENSE",
)
#: Folders of CPython and NumPy that no measurement imports.
LEFT_OUT = {
    *("test", "tests", "idlelib", "tkinter", "turtledemo", "ensurepip", "pydoc_data", "lib2to3", "pip", "setuptools"),
    *("include", "libs", "share", "cmake", "pkgconfig", "engines-3", "ossl-modules", "f2py", "__pycache__"),
}  # fmt: skip
#: -I ignores the machine's Python packages and environment, -B writes nothing into the kit.
START = {
    "measure": f"""#!/bin/sh
kit=$(dirname "$0")
exec "$kit/python/python{PYTHON}" -I -B "$kit/benchmarks/realtime/tables.py" "$@"
""",
    "measure.bat": '@"%~dp0python\\python.exe" -I -B "%~dp0benchmarks\\realtime\\tables.py" %*\r\n',
}


def fail(text):
    sys.exit(f"gpu_kit: {text}")


def left_out(_folder, names):
    return LEFT_OUT.intersection(names)


def copy_python(source, kit):
    """Copies CPython, without the folders in LEFT_OUT, to the kit."""
    shutil.copytree(source, kit / "python", ignore=left_out)


def install(system, wheel, kit):
    """Installs the native module and NumPy into the kit's Python, with this machine's pip."""
    *platforms, site = SYSTEMS[system]
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-deps"]
    command += [
        "--no-compile",
        "--only-binary",
        ":all:",
        "--python-version",
        PYTHON,
        "--implementation",
        "cp",
    ]
    for platform in platforms:
        command += ["--platform", platform]
    with tempfile.TemporaryDirectory(prefix="snowbough-kit-") as folder:
        done = subprocess.run([*command, "--target", folder, str(wheel), NUMPY], check=False)
        if done.returncode:
            fail(f"pip cannot install {wheel.name} and {NUMPY}")
        shutil.copytree(folder, kit / "python" / site, ignore=left_out, dirs_exist_ok=True)


def copy_scripts(kit):
    for pattern in SCRIPTS:
        paths = sorted(ROOT.glob(pattern))
        if not paths:
            fail(f"there is no file {pattern} in the checkout")
        for path in paths:
            to = kit / path.relative_to(ROOT)
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, to)


def start_script(system, kit):
    name = "measure.bat" if system == "windows" else "measure"
    path = kit / name
    path.write_bytes(START[name].encode())
    path.chmod(0o755)


def pack(kit, target):
    """Writes the kit as a .tar.gz and returns its size in bytes. Equal contents give equal bytes."""
    partial = target.with_name(target.name + ".part")
    with open(partial, "wb") as stream, gzip.GzipFile("", "wb", 9, stream, mtime=0) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.GNU_FORMAT) as archive:
            for path in sorted(path for path in kit.rglob("*") if path.is_file()):
                entry = tarfile.TarInfo(f"{NAME}/{path.relative_to(kit).as_posix()}")
                content = path.read_bytes()
                entry.size = len(content)
                entry.mode = 0o755 if path.stat().st_mode & 0o100 else 0o644
                archive.addfile(entry, io.BytesIO(content))
    partial.replace(target)
    return target.stat().st_size


def main(system):
    if system not in SYSTEMS:
        fail("pass linux or windows")
    python = ROOT / "build" / "third_party" / "python" / PYTHON / f"{system}-x86_64"
    wheels = list((ROOT / "build" / "packages").glob(f"snowbough_native-*{SYSTEMS[system][0]}.whl"))
    if not python.is_dir() or len(wheels) != 1:
        fail(
            f"there is no wheel for {system} in build/packages: run ./tools/package.sh release {system} first"
        )
    target = ROOT / "build" / f"{NAME}-{system}.tar.gz"
    with tempfile.TemporaryDirectory(prefix="snowbough-kit-") as folder:
        kit = Path(folder)
        copy_python(python, kit)
        install(system, wheels[0], kit)
        copy_scripts(kit)
        start_script(system, kit)
        size = pack(kit, target)
    print(f"{target}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "")
