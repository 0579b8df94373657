# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that tools/gpu_kit.py packs; tools/check_packages.sh runs a whole kit."""

import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import gpu_kit  # noqa: E402


def _write(path, text="", mode=0o644):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(mode)


def test_what_no_measurement_imports_stays_outside(tmp_path):
    source = tmp_path / "source"
    _write(source / "python3.13", "program", 0o755)
    for name in (
        "json/decoder.py",
        "test/test_json.py",
        "site-packages/pip/main.py",
        "json/__pycache__/a.pyc",
    ):
        _write(source / "lib" / name)
    gpu_kit.copy_python(source, tmp_path / "kit")
    copied = sorted(path.relative_to(tmp_path).as_posix() for path in (tmp_path / "kit").rglob("*.*"))
    assert copied == ["kit/python/lib/json/decoder.py", "kit/python/python3.13"]


def test_the_scripts_of_the_tables_are_inside(tmp_path):
    gpu_kit.copy_scripts(tmp_path)
    for name in ("benchmarks/realtime/tables.py", "benchmarks/snow/speed.py", "tests/data/small_maple.obj"):
        assert (tmp_path / name).read_bytes() == (ROOT / name).read_bytes()


def test_a_kit_keeps_names_contents_and_programs(tmp_path):
    kit = tmp_path / "kit"
    _write(kit / "python" / "python3.13", "program", 0o755)
    gpu_kit.start_script("linux", kit)
    size = gpu_kit.pack(kit, tmp_path / "kit.tar.gz")
    assert size == (tmp_path / "kit.tar.gz").stat().st_size
    with tarfile.open(tmp_path / "kit.tar.gz") as archive:
        modes = {entry.name: oct(entry.mode) for entry in archive}
        assert archive.extractfile("snowbough-gpu-kit/python/python3.13").read() == b"program"
    assert modes == {"snowbough-gpu-kit/measure": "0o755", "snowbough-gpu-kit/python/python3.13": "0o755"}
    assert not list(tmp_path.glob("*.part"))


def test_equal_contents_give_equal_bytes(tmp_path):
    packed = []
    for name in ("one", "two"):
        for file in ("b", "a") if name == "one" else ("a", "b"):
            _write(tmp_path / name / file, file)
        gpu_kit.pack(tmp_path / name, tmp_path / f"{name}.tar.gz")
        packed.append((tmp_path / f"{name}.tar.gz").read_bytes())
    assert packed[0] == packed[1]
